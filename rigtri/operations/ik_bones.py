"""The joints below a root that an engine's own rigs have: they follow hands and feet, in every clip.

Source: Unreal Engine, the mannequin's skeleton (ik_foot_root, ik_hand_gun …), "IK Setups".
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rigtri.errors import UsageError
from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.adaptive_sampling import adaptive_key_times
from rigtri.evaluation.pose_cache import blocks
from rigtri.evaluation.sampling import Motion, sorted_unique, worlds
from rigtri.evaluation.timelines import (
    Timeline,
    as_float32,
    keys_and_between,
    put_tracks,
    steps_only,
    timelines,
    times_and_jumps,
)
from rigtri.maths.matrices import compose, inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import NEARLY_UNIT, angle_between, from_axes, make_continuous, off_unit, slerp
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Interpolation, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_socket import stood, with_joint
from rigtri.operations.body_pose import sure_bones
from rigtri.operations.joint_records import joint_record
from rigtri.progress import counted
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.text import and_more

# By name: the joint above, "" for the root, and the bone of the humanoid that is followed, "" for the root.
IK_BONES: Mapping[str, Mapping[str, tuple[str, str]]] = {
    "unreal": {
        "ik_foot_root": ("", ""),
        "ik_foot_l": ("ik_foot_root", "leftFoot"),
        "ik_foot_r": ("ik_foot_root", "rightFoot"),
        "ik_hand_root": ("", ""),
        "ik_hand_gun": ("ik_hand_root", "rightHand"),
        "ik_hand_l": ("ik_hand_gun", "leftHand"),
        "ik_hand_r": ("ik_hand_gun", "rightHand"),
    }
}
# Between keys a joint is off what it follows by no more of the size: 0.2 mm of a body.
_WITHIN = 1e-4
# Scales along an axis below this are as good as none, and leave no axes.
_FLAT = 1e-6
# How far from it what it rotates may be, of the size.
_ARM = 0.1
# No way from the joint above.
_STILL = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])


class _Follower(NamedTuple):
    """A joint, the one above it, and the one whose place it has."""

    node: int
    parent: int
    leader: int


def with_ik_bones(rig: Rig, root: int, profile: str, report: Report) -> Rig:
    """The rig with the joints of a profile below its root, where hands and feet are, at rest and in clips.

    What follows a bone that is not known is left out, with a warning. Raises UsageError for a name that is
    taken.
    """
    bones = {bone: node for body in recognise(rig).characters for bone, node in sure_bones(body).items()}
    nodes, leaders, left_out = {"": root}, {"": root}, []
    followers, moved = list[_Follower](), set[int]()
    kept = _kept(rig, profile, bones)
    for name, (above, bone) in IK_BONES[profile].items():
        if above not in nodes or name in kept or (bone and bone not in bones):
            left_out.append(f"{name} ({bone})" if bone else name)
            continue
        leader, parent = bones.get(bone, root), nodes[above]
        still = leader == leaders[above]
        place = _STILL if still else _seen(rig.world[leader], rig.world[parent])
        before = rig
        rig, nodes[name] = _placed(rig, name, parent, leader, place, report)
        leaders[name] = leader
        if rig is not before or parent in moved:
            moved.add(nodes[name])
            rig = _bound(rig, nodes[name], root)
        if not still:
            followers.append(_Follower(nodes[name], parent, leader))
    if left_out:
        report.warn(
            "no-bones",
            f"{and_more(left_out, 8)} left out: the bones that they, or joints below them, follow are not "
            "recognised with confidence",
        )
    for timeline in counted(timelines(rig) if followers else (), "clips"):
        # Keys that follow already stay to the bit: the rounding of what they were made of is in them.
        if not _farthest(rig, timeline, followers, enough=2.0 * _WITHIN) <= 2.0 * _WITHIN:
            only = _only_times(timeline.clip)
            made = _tracks(rig, timeline, followers, root, only)
            if only is not None:
                _warn_at_keys(rig, timeline, followers, made, report)
            rig = put_tracks(rig, timeline, made)
            report.rekeyed = True
            known = {record["joint"] for record in report.joints}
            for node, _, leader in followers:
                if rig.title(node) not in known:
                    report.joints.append(joint_record(rig, node, "posed", follows=rig.title(leader)))
    report.moves |= {rig.keys[node] for node in nodes.values()} - {rig.keys[root], None}
    return rig


def _kept(rig: Rig, profile: str, bones: Container[str]) -> set[str]:
    """The joints of a profile that stay, for one that is below them here would go along and cannot follow."""
    kept = set[str]()
    for name, (above, bone) in reversed([*IK_BONES[profile].items()]):
        if name in rig.names and (name in kept or (bone and bone not in bones)):
            kept.add(above)
    return kept


def _placed(rig: Rig, name: str, parent: int, leader: int, place: Floats, report: Report) -> tuple[Rig, int]:
    """The rig with a joint of a name in a place seen from its parent, (7,); and which it is."""
    known = [node for node in rig.children[parent] if rig.names[node] == name]
    if not known and name in rig.names_beside(parent):
        raise UsageError(
            f"Another node has the name {name}, and is not a child of '{rig.title(parent)}': rename it"
        )
    if known:
        node, made = known[0], stood(rig, known[0], place[:3], place[3:], skeleton_size(rig))
        if made is rig:
            return rig, node
        report.rekeyed = True
    else:
        node = len(rig)
        made = rig.with_nodes([name], [parent], place[np.newaxis, :3], place[np.newaxis, 3:])
    status = "posed" if known else "added"
    report.joints.append(joint_record(made, node, status, follows=rig.title(leader)))
    return made, node


def _bound(rig: Rig, node: int, root: int) -> Rig:
    """The rig with a joint in the skins of its root, bound to that as it rests; it weighs nothing."""
    seen = multiply(rig.world[root], inverse(rig.world[node]))
    skins = []
    for skin in rig.skins:
        rows = skin.joints.tolist()
        if root in rows:
            bind = multiply(skin.inverse_bind[rows.index(root)], seen)
            if node not in rows:
                skin = with_joint(skin, node, np.concatenate([skin.inverse_bind, bind[np.newaxis]]))
            else:
                binds = skin.inverse_bind.copy()
                binds[rows.index(node)] = bind
                skin = replace(skin, inverse_bind=binds)
        skins.append(skin)
    return replace(rig, skins=tuple(skins))


def _seen(world: Floats, parent: Floats) -> Floats:
    """Position and rotation xyzw, (..., 7), of frames that have a parent: of that, no scale but in place."""
    local = multiply(world, inverse(parent))
    own = np.zeros(local.shape)
    own[..., 3, 3] = 1.0
    own[..., :3, :3] = orthonormal_axes(world)
    above = own.copy()
    above[..., :3, :3] = orthonormal_axes(np.broadcast_to(parent, world.shape))
    turned = multiply(own, inverse(above))
    return np.concatenate([local[..., 3, :3], from_axes(orthonormal_axes(turned))], axis=-1)


def _part(rig: Rig, clip: Clip, nodes: Sequence[int]) -> tuple[Rig, dict[int, int]]:
    """Some nodes and all above them, with one clip: all that these have to be posed by; and their indices."""
    return replace(rig, clips=(clip,)).subset(sorted(rig.with_ancestors(nodes)))


def _farthest(rig: Rig, timeline: Timeline, followers: Sequence[_Follower], enough: float = np.inf) -> float:
    """How far joints are from their leaders, of the size, at all keys of these and between them.

    enough: where it is farther somewhere, nobody looks on.
    """
    nodes, _, leaders = np.array(followers).T.tolist()
    small, place = _part(rig, timeline.clip, [*nodes, *leaders])
    nodes, leaders = ([place[node] for node in some] for some in (nodes, leaders))
    motion = Motion(small, *small.clips)
    times = keys_and_between(times_and_jumps(timeline, None, rig.rules.per_second))
    size, found = skeleton_size(rig), 0.0
    for rows in blocks(len(times)):
        world = worlds(small, motion.locals_at(times[rows]))
        one, other = world[:, nodes], world[:, leaders]
        turned = angle_between(*(from_axes(orthonormal_axes(each)) for each in (one, other)))
        off = length(one[..., 3, :3] - other[..., 3, :3]) + _ARM * size * turned
        found = float(np.maximum(found, off.max() / size))
        if not found <= enough:
            break
    return found


def _only_times(clip: Clip) -> Floats | None:
    """The only times, (k,), at which a clip may have rotation keys, None where it may have some at any time.

    Where joints share their times, all get a key where one does, and OpenUSD plays quaternions that are not
    unit otherwise on both sides of one more key, whatever that is.
    """
    turns = [column for column in clip.columns if column.raw and len(column.times) > 1]
    if all(off_unit(column.key_values) <= NEARLY_UNIT for column in turns):
        return None
    return sorted_unique(np.concatenate([column.times for column in turns]))


def _warn_at_keys(
    rig: Rig, timeline: Timeline, followers: Sequence[_Follower], made: Sequence[Track], report: Report
) -> None:
    """A warning where joints follow at keys alone, and how far off they are between these."""
    nodes = {one.node for one in followers}
    others = tuple(t for t in timeline.clip.tracks if t.node not in nodes)
    played = replace(timeline, clip=replace(timeline.clip, tracks=(*others, *made)))
    off = _farthest(rig, played, followers)
    if off > 2.0 * _WITHIN:
        names = and_more([rig.title(one.node) for one in followers], 3)
        report.warn(
            "ik-bones-at-keys",
            f"In clip '{timeline.name}' {names} follow at the keys of rotations, and between them are up to "
            f"{off:.2g} of the size off: rotations there are not unit, and with more keys OpenUSD would play "
            "the other joints otherwise. Normalise them in the program that wrote the file",
        )


def _spread(track: Track) -> Track:
    """The track without scales of 0, by which clips hide hands and which leave no axes."""
    if track.path != "scale" or (np.abs(track.values) >= _FLAT).all():
        return track
    return track.having(np.where(np.abs(track.values) < _FLAT, _FLAT, track.values))


def _layers(followers: Sequence[_Follower]) -> list[list[int]]:
    """The numbers of followers, those below others after these, so that each layer is found at once."""
    layers, layer_of = dict[int, list[int]](), dict[int, int]()
    for number, one in enumerate(followers):
        layer_of[one.node] = layer = layer_of.get(one.parent, -1) + 1
        layers.setdefault(layer, []).append(number)
    return list(layers.values())


def _tracks(
    rig: Rig, timeline: Timeline, followers: Sequence[_Follower], root: int, only: Floats | None
) -> list[Track]:
    """Translation and rotation of joints over a timeline, with as many keys as they need; none for none.

    only: the times that these may have, None for any. What is above a follower and is none itself stands as
    the root does.
    """
    line = {node for one in followers for node in rig.path_to_root(one.leader)}
    tracks = tuple(
        _spread(track) for track in timeline.clip.tracks if track.node in line and track.path != "weights"
    )
    if not tracks:
        return []
    moving, size = replace(timeline, clip=Clip(timeline.clip.name, tracks)), skeleton_size(rig)
    small, place = _part(rig, moving.clip, [*line, root])
    motion = Motion(small, *small.clips)
    layers = _layers(followers)

    def some(times: Floats) -> Floats:
        world = worlds(small, motion.locals_at(times))
        stands: dict[int, Floats] = {}
        found = np.empty((len(world), len(followers), 7))
        for rows in layers:
            mine = [followers[row] for row in rows]
            above = np.stack([stands.get(one.parent, world[:, place[root]]) for one in mine], axis=1)
            found[:, rows] = _seen(world[:, [place[one.leader] for one in mine]], above)
            # Without the scale that its leader may have.
            local = compose(found[:, rows, :3], found[:, rows, 3:], np.ones(3))
            there = multiply(local, above)
            stands |= {one.node: there[:, k] for k, one in enumerate(mine)}
        return found

    def seats(times: Floats) -> Floats:
        found = [some(times[rows]) for rows in blocks(len(times))]
        return np.concatenate(found) if found else some(times)

    def error(values: Floats, left: Floats, right: Floats, share: Floats, _times: Floats) -> Floats:
        """How far lines between two keys are off in between, (f,): in place, or a tenth of the size away."""
        shares = share[:, np.newaxis]
        place = left[..., :3] + (right[..., :3] - left[..., :3]) * shares[..., np.newaxis]
        turned = angle_between(values[..., 3:], slerp(left[..., 3:], right[..., 3:], shares))
        return np.asarray((length(values[..., :3] - place) + _ARM * size * turned).max(axis=1))

    times, holds = times_and_jumps(moving, None, rig.rules.per_second), steps_only(moving)
    if only is not None:
        times = only
    elif not holds:
        of = f"What follows in clip '{timeline.name}'"
        times = adaptive_key_times(seats, error, times, within=_WITHIN * size, of=of)
    values = as_float32(seats(times))
    way: Interpolation = "STEP" if holds or len(times) == 1 else "LINEAR"
    return [
        track
        for k, (node, _, _) in enumerate(followers)
        for track in (
            Track(node, "translation", way, times, values[:, k, :3]),
            Track(node, "rotation", way, times, make_continuous(values[:, k, 3:])),
        )
    ]
