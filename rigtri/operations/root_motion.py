"""root-motion: what hips move over the ground goes to the root, or out of the clip."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.active_controls import controls_at_work, skeleton_size
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import Timeline, chosen_timelines
from rigtri.maths.quaternions import conjugate, rotate
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.vectors import perpendicular
from rigtri.model.animation import Clip, Track, values_minus
from rigtri.model.rig import Rig
from rigtri.operations.bake.dependents import rebake_followers
from rigtri.operations.bake.unbaked import UNBAKED, away_from_keys
from rigtri.operations.ground_motion import is_none, over_ground, rests, turned, twist, up_of
from rigtri.operations.operation import operation
from rigtri.operations.options.root_motion import RootMotionOptions as RootMotionOptions
from rigtri.operations.root_children import besides, keeping_children
from rigtri.recognition.limbs import upright
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.text import and_more, list_names


@operation(RootMotionOptions)
def root_motion(rig: Rig, *, options: RootMotionOptions, report: Report) -> Rig:
    """The rig whose root moves over the ground as its hips did, so that no other joint moves; or none does.

    Exact for every interpolation: both get keys at the times that the hips have; with ``yaw`` both get linear
    keys, as many as it takes, as do other children of the root. What was done in each clip is in
    ``report.added``. Raises GeometryError where there is no root above the hips, or it rotates or moves at
    other times, or with ``yaw`` has a scale that turning about the up axis would shear.
    """
    if options.axis is not None and upright(rig)["xyz".index(options.axis)]:
        raise UsageError(f"--axis {options.axis}: this is up, and height stays with the hips")
    hips, root = _joints(rig, options)
    going, others = besides(rig, hips, root)
    chosen = {k: each for each in chosen_timelines(rig, options.clip) for k in each.members}
    clips = []
    for k, clip in enumerate(rig.clips):
        requested = k in chosen and not clip.idle
        if requested:
            _warn_still_moving(rig, clip, root, report)
        move = turned if options.yaw else _moved
        if not requested:
            clips.append(clip)
            continue
        if options.mode == "extract":
            _refuse_unbaked(rig, chosen[k], hips, options)
        still = _without_roots_own(rig, clip, root, options) if options.mode == "remove" else clip
        made = move(rig, still, hips, root, options, report)
        if made is not clip:
            _refuse_driven(rig, chosen[k], [root] if options.mode == "extract" else [root, hips])
        if made is not still and options.mode == "extract":
            _refuse_skinned(rig, root)
        if made is not still:
            made = keeping_children(rig, still, made, hips, others)
        if made is still and still is not clip:
            report.added.append({"type": "moved", "clip": clip.name, "mode": options.mode})
        clips.append(made)
    if not report.added:
        return rig
    moved = replace(rig.with_parts([root, *others]), clips=tuple(clips))
    if options.mode == "extract":
        report.rekeyed = True
        report.moves |= {rig.keys[node] for node in going}
        return moved
    report.reposed = True
    changed = frozenset(
        k for k, (was, now) in enumerate(zip(rig.clips, clips, strict=True)) if now is not was
    )
    return rebake_followers(moved, changed, report)


def _warn_still_moving(rig: Rig, clip: Clip, root: int, report: Report) -> None:
    """Say which nodes above the root have keys that move the character over the ground besides."""
    above = rig.path_to_root(root)[1:]
    moving = {t.node for t in clip.tracks if t.node in above and t.path != "weights" and not rests(t, rig)}
    if moving:
        names = and_more([rig.title(node) for node in sorted(moving)], 6)
        text = f"In clip '{clip.name}', {names} above the hips move, too, and keep their keys"
        report.warn("still-moving", f"{text}: key the hips for that in a DCC")


def _refuse_driven(rig: Rig, timeline: Timeline, nodes: list[int]) -> None:
    """GeometryError where controls move one of the nodes in a clip, so that its own keys would not count."""
    driven = controls_at_work(rig, timeline)
    sets = Solver(rig, driven).sets if driven else ()
    if lost := [node for node in nodes if node in sets]:
        raise GeometryError(
            f"Controls move '{rig.title(lost[0])}' in clip '{timeline.name}': other keys of its own would be "
            "lost with the next bake. Take the motion to the joints and the controls out before, with: "
            "rigtri bake --to joints, then rigtri strip"
        )


def _refuse_skinned(rig: Rig, root: int) -> None:
    """GeometryError where points have weight of the root: what moves it would move them."""
    skins = [skin for skin in rig.skins if skin.weigh is not None and root in skin.joints]
    if any(skin.weighted[skin.joints == root].any() for skin in skins):
        raise GeometryError(
            f"Points have weight of the root '{rig.title(root)}', and would move over the ground with it: "
            "give their weight to other joints in a DCC, or name another root with --to"
        )


def _refuse_unbaked(rig: Rig, timeline: Timeline, hips: int, options: RootMotionOptions) -> None:
    """GeometryError where controls move the hips over the ground in a clip as their own keys do not."""
    away = away_from_keys(rig, timeline, hips)
    over = perpendicular(away[:, 3, :3], upright(rig))
    far = max(np.abs(over).max() / skeleton_size(rig), np.abs(away[:, :3, :3]).max() if options.yaw else 0.0)
    if not far <= UNBAKED:
        raise GeometryError(
            f"Controls or constraints move '{rig.title(hips)}' in clip '{timeline.name}' as its own keys "
            f"do not ({far:.2g} of the size), and the root gets what these do. Take that motion to the "
            "joints first, with: rigtri bake --to joints"
        )


def _without_roots_own(rig: Rig, clip: Clip, root: int, options: RootMotionOptions) -> Clip:
    """The clip without what the root itself moves over the ground (with ``yaw``, turns about up)."""
    rest, up = rig.rotation[root], up_of(rig, root)

    def still(track: Track) -> Track:
        plain = track.interpolation != "CUBICSPLINE"
        if track.node != root or rests(track, rig):
            return track
        if track.path == "translation":
            away = values_minus(track, rig.translation[root])
            along = rotate(rest, over_ground(rig, root, rotate(conjugate(rest), away), options.axis))
            return track if is_none(track, along) else track.having(track.values - along)
        if track.path == "rotation" and options.yaw and plain:
            yaw = twist(product(conjugate(rest), track.values), up)
            return track.having(product(track.values, conjugate(yaw)))
        return track

    tracks = tuple(map(still, clip.tracks))
    same = all(a is b for a, b in zip(tracks, clip.tracks, strict=True))
    return clip if same else replace(clip, tracks=tracks)


def _joints(rig: Rig, options: RootMotionOptions) -> tuple[int, int]:
    """The hips and the root above them."""
    if options.hips is not None:
        hips = rig.find(options.hips)
    else:
        found = [body.hips for body in recognise(rig).characters if body.hips >= 0]
        if not found:
            raise GeometryError("No hips of a character are recognised here: name them with --hips")
        if len(found) > 1:
            titles = list_names(rig.title(node) for node in found)
            raise GeometryError(
                f"There are {len(found)} characters here: name one's hips ({titles}) with --hips"
            )
        hips = found[0] if options.to is not None else _mover(rig, found[0])
    above = [node for node in rig.path_to_root(hips)[1:] if rig.is_joint[node]]
    root = rig.find(options.to) if options.to is not None else (above or [-1])[0]
    if root < 0 or root not in rig.path_to_root(hips)[1:]:
        text = f"'{rig.title(hips)}' has no root joint above it"
        if rig.skins:
            raise GeometryError(f"{text}: add one with rigtri add-root")
        parent = int(rig.parents[hips])
        its = f" (its parent is '{rig.title(parent)}')" if parent >= 0 else ""
        raise GeometryError(
            f"{text}, for no skin here lists joints: name the node above it that is to move with --to{its}, "
            "or take the clips to their character (rigtri take-clips) and move its root"
        )
    if (between := int(rig.parents[hips])) != root:
        raise GeometryError(
            f"'{rig.title(hips)}' is not a child of '{rig.title(root)}': '{rig.title(between)}' is "
            "between them. Remove it in a DCC, or give others with --to or --hips"
        )
    return hips, root


def _mover(rig: Rig, hips: int) -> int:
    """The joint whose keys carry the body below its root: hips, or one above them, such as Bip01 of Biped."""
    path = [node for node in rig.path_to_root(hips) if rig.is_joint[node]]
    moving = {
        track.node
        for clip in rig.clips
        for track in clip.tracks
        if track.path == "translation" and not rests(track, rig)
    }
    if len(path) > 1 and path[-1] in moving:  # it has what it is to get, as after a first run
        return path[-2]
    return next((node for node in reversed(path[:-1]) if node in moving), hips)


def _moved(rig: Rig, clip: Clip, hips: int, root: int, options: RootMotionOptions, report: Report) -> Clip:
    mine = [t for t in clip.tracks if t.node == hips and t.path == "translation"]
    if not mine:
        return clip
    (track,) = mine
    theirs = {t.path: t for t in clip.tracks if t.node == root}
    along = over_ground(rig, root, values_minus(track, rig.translation[hips]), options.axis)
    if is_none(track, along):
        return clip
    if any(not rests(theirs[path], rig) for path in ("rotation", "scale") if path in theirs):
        raise GeometryError(
            f"The root '{rig.title(root)}' rotates or scales in clip '{clip.name}': key the hips for that in "
            "a DCC"
        )
    report.added.append({"type": "moved", "clip": clip.name, "mode": options.mode, "keys": len(track.times)})
    tracks = [track.having(track.values - along) if t is track else t for t in clip.tracks]
    if options.mode == "extract":
        shift = rotate(rig.rotation[root], along * rig.scale[root])
        old = theirs.get("translation")
        if old is None or rests(old, rig):
            key = None if old is None else old.key
            made = Track(root, "translation", track.interpolation, track.times, shift, key)
            made = made.having(values_minus(made, -rig.translation[root]))
            tracks = [made if t is old else t for t in tracks] + ([made] if old is None else [])
        elif old.interpolation == track.interpolation and np.array_equal(old.times, track.times):
            tracks[tracks.index(old)] = old.having(old.values + shift)
        else:
            raise GeometryError(
                f"The root '{rig.title(root)}' moves at other times than its hips in clip '{clip.name}': "
                "give both the same keys in a DCC, or take it out first with --mode remove"
            )
    return replace(clip, tracks=tuple(tracks))
