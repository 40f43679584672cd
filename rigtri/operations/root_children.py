"""What stands below a root besides the hips stays where it is when the root takes over their motion."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.adaptive_sampling import adaptive_key_times
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import Timeline, steps_only, times_and_jumps
from rigtri.maths.quaternions import angle_between, conjugate, make_continuous, normalise, rotate, slerp
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Interpolation, Path, Track
from rigtri.model.rig import Rig
from rigtri.operations.ground_motion import WITHIN, rests
from rigtri.operations.ik_bones import IK_BONES
from rigtri.operations.skin_joints import placed_by_skin

# What stands where the root does, and goes with it.
_GROUPS = {name for bones in IK_BONES.values() for name, (_, bone) in bones.items() if not bone}
# Frames that differ by no more, as a share of the size, are one.
_SAME = 1e-6
_PLACES: tuple[Path, ...] = ("translation", "rotation")


def besides(rig: Rig, hips: int, root: int) -> tuple[list[int], list[int]]:
    """What goes with a root: itself and groups of IK bones; and what stays, their children but the hips.

    A node that its skin places goes, too: nothing shows where it is.
    """
    going, found = [root], list[int]()
    drawn = any(rig.attachment[child] >= 0 for child in rig.children[root])
    placed = placed_by_skin(rig, rig.content) if drawn else set()
    moving = {t.node for clip in rig.clips for t in clip.tracks if t.path != "weights" and not rests(t, rig)}
    for child in rig.children[root]:
        apart = np.abs(rig.local[child] - np.eye(4)).max(axis=1) * (1.0, 1.0, 1.0, 1.0 / skeleton_size(rig))
        group = rig.names[child] in _GROUPS and child not in moving and apart.max() <= _SAME
        going += [child] if group or child in placed else []
        found += rig.children[child] if group or child in placed else [child]
    return going, [child for child in found if child != hips]


def keeping_children(rig: Rig, clip: Clip, made: Clip, hips: int, nodes: list[int]) -> Clip:
    """``made``, in which the hips moved as in ``clip``, with nodes that stand to them as they did.

    What the hips lost over the ground, the nodes lose, too. Where a node has the keys of the hips, or none,
    it is exact; else it gets linear keys, as many as it takes.
    """
    was, now = (_driving(each, hips) for each in (clip, made))
    tracks = {(track.node, track.path): track for track in made.tracks}
    for node in nodes:
        for track in _exact(rig, clip, was, now, node) or _sampled(rig, clip, was, now, node):
            tracks[node, track.path] = track
    return replace(made, tracks=tuple(tracks.values()))


def _driving(clip: Clip, node: int) -> dict[Path, Track]:
    return {track.path: track for track in clip.tracks if track.node == node and track.path in _PLACES}


def _exact(
    rig: Rig, clip: Clip, was: dict[Path, Track], now: dict[Path, Track], node: int
) -> list[Track] | None:
    """The translation of a node where it has the keys of the hips or none, and these did not turn."""
    if was.get("rotation") is not now.get("rotation"):
        return None
    one, other = was["translation"], now["translation"]
    old = _driving(clip, node).get("translation")
    lost = one.values - other.values
    if old is None or rests(old, rig):
        values = np.zeros(lost.shape)
        (values if lost.ndim == 2 else values[:, 1])[:] = rig.translation[node]
        old = replace(one, node=node, values=values, key=None if old is None else old.key)
    elif old.interpolation != one.interpolation or not np.array_equal(old.times, one.times):
        return None
    return [old.having(old.values - lost)]


def _sampled(
    rig: Rig, clip: Clip, was: dict[Path, Track], now: dict[Path, Track], node: int
) -> Iterator[Track]:
    old = _driving(clip, node)
    moving = Timeline(Clip(clip.name, (*old.values(), *was.values(), *now.values())), (0,))
    hips = next(iter(now.values())).node
    size = skeleton_size(rig)

    def value(tracks: dict[Path, Track], of: int, path: Path, times: Floats) -> Floats:
        if path in tracks:
            return sample(tracks[path], times)
        return np.tile(getattr(rig, path)[of], (len(times), 1))

    def seats(times: Floats) -> Floats:
        """Position and rotation of the node, (f, 7)."""
        (place, turn), (place_now, turn_now), (own, own_turn) = (
            [value(tracks, of, path, times) for path in _PLACES]
            for tracks, of in ((was, hips), (now, hips), (old, node))
        )
        back = normalise(product(turn_now, conjugate(turn)))
        stays = place_now + rotate(back, own - place)
        return np.concatenate([stays, normalise(product(back, own_turn))], axis=1)

    def error(values: Floats, left: Floats, right: Floats, share: Floats, _times: Floats) -> Floats:
        place = left[:, :3] + (right[:, :3] - left[:, :3]) * share[:, np.newaxis]
        turn = slerp(left[:, 3:], right[:, 3:], share)
        return np.asarray(length(values[:, :3] - place) + 0.5 * size * angle_between(values[:, 3:], turn))

    times, holds = times_and_jumps(moving, None, rig.rules.per_second), steps_only(moving)
    if not holds:
        of = f"'{rig.title(node)}' in clip '{clip.name}'"
        times = adaptive_key_times(seats, error, times, within=WITHIN * size, of=of)
    values = seats(times)
    way: Interpolation = "STEP" if holds else "LINEAR"
    if was.get("rotation") is not now.get("rotation"):
        turns = make_continuous(values[:, 3:])
        yield Track(node, "rotation", way, times, turns, old["rotation"].key if "rotation" in old else None)
    key = old["translation"].key if "translation" in old else None
    yield Track(node, "translation", way, times, values[:, :3], key)
