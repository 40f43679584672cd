"""Adding joints to skins: new joints have no weight, so no vertex moves."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import FileError, UsageError
from rigtri.evaluation.sampling import world_of
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import from_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Track
from rigtri.model.content import Content
from rigtri.model.metadata import Record
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.option_kinds import EndKind
from rigtri.operations.rigtri_nodes import add, stand

# Inverse binds that differ by less, as a share of the largest number, differ by float32 rounding.
_SAME_BIND = 1e-6
# Places and axes, too: of the distances from the origin and the parent, and absolute.
_SAME_POSITION, _SAME_AXES = 5e-7, 2e-6
# A track that is off the rest pose by no more holds it: float32 rounding, as a share.
_STILL = 1e-6


def add_joint(
    rig: Rig,
    name: str,
    parent: int,
    record: Record,
    position: Floats,
    axes: Floats,
    *,
    like: int | None = None,
) -> tuple[Rig, int]:
    """A new joint below ``parent`` in every skin that holds it, behind their last joints; and its index.

    position (3,), axes (3, 3): where it stands in the world, as rows. In a bind pose it stands
    to its parent as it does at rest. Below a node of no skin it is a plain node: see `new_skin`.
    like: the joint whose skins it joins instead, where the parent is none.
    """
    rig, node = add(rig, name, parent, record)
    rig = stand(rig, node, position, axes)
    return join_skins(rig, {node: parent if like is None else like}), node


def join_skins(rig: Rig, kin: Mapping[int, int]) -> Rig:
    """The rig with nodes as joints of every skin that holds their kin, without weight.

    kin: by the new joint. They come behind the last joints, in the order of the nodes.
    """
    if not kin:
        return rig
    new: dict[int, list[int]] = {}
    for node, like in kin.items():
        new.setdefault(like, []).append(node)

    def grown(skin: Skin) -> Skin:
        nodes = sorted(node for joint in skin.joints.tolist() for node in new.get(joint, ()))
        return _grown(rig, skin, nodes) if nodes else skin

    return replace(rig, skins=tuple(map(grown, rig.skins)))


def skin_sibling_parent(rig: Rig, joint: int) -> tuple[int, int]:
    """The parent of a joint that is in the skins of ``joint`` but does not follow it; and what it is like.

    Below the topmost joint above it; beside it where it is the topmost itself. UsageError where
    there is no skin, or nothing above its only root.
    """
    skins = [skin for skin in rig.skins if _row(skin, joint) is not None]
    if not skins:
        raise UsageError(f"--as joint: '{rig.title(joint)}' is not in a skin that a joint could join")
    if all(skin.drawn is False for skin in skins):
        raise UsageError(
            f"--as joint: the skin of '{rig.title(joint)}' draws nothing, so a control in it would be taken "
            "for a bone of an exporter's armature; take locators"
        )
    mine, top, node = set(skins[0].joints.tolist()), joint, joint
    while node >= 0:
        top = node if node in mine else top
        node = int(rig.parents[node])
    if top != joint:
        return top, top
    if rig.parents[joint] < 0:
        raise UsageError(
            f"--as joint: '{rig.title(joint)}' has no parent, so a new joint would follow it; give "
            "the skeleton a root joint, or take a locator"
        )
    return int(rig.parents[joint]), joint


def is_joint_kind(rig: Rig, node: int, kind: EndKind | None) -> bool:
    """Whether a node of ours is a joint; UsageError where another kind is wanted than it is."""
    found: EndKind = "joint" if rig.is_joint[node] else "locator"
    if kind not in (None, found):
        raise UsageError(
            f"'{rig.title(node)}' is a {found} since an earlier run; take it out with rigtri strip, then add "
            f"it --as {kind}"
        )
    return found == "joint"


def new_skin(rig: Rig, name: str, joints: Sequence[int]) -> Rig:
    """The rig with a skin of its own for new joints (parents first), bound where they stand at rest."""
    binds = np.stack([inverse(world_of(rig, joint)) for joint in joints])
    skin = Skin(name, np.asarray(joints, dtype=np.int64), binds)
    return replace(rig, skins=(*rig.skins, skin))


def move_joint(rig: Rig, node: int, position: Floats, axes: Floats) -> Rig:
    """Put a joint of ours elsewhere, at rest and in the bind poses of its skins, as `add_joint` would.

    Its children go along. Bits that only rounding would change stay. Formats that key all of a
    joint or nothing (UsdSkel) have its place in clips, too: what stood still there stands here now.
    """
    moved = stand(rig, node, position, axes)
    if not _stands(rig, moved, node, position):
        rig = _still_in_clips(moved, rig, node)
    return bind_joint(rig, node, [skin for skin in rig.skins if skin.stored])


def bind_joint(rig: Rig, node: int, skins: Sequence[Skin]) -> Rig:
    """Bind a joint of ours where it stands in those of ``skins`` that hold it.

    In skins without inverse binds, too, where they are named: there a joint without weight needs none.
    """
    rows = {id(skin): row for skin in skins if (row := _row(skin, node)) is not None}

    def bound(skin: Skin) -> Skin:
        return _set_row(skin, rows[id(skin)], _bind(rig, skin, node)) if id(skin) in rows else skin

    every = tuple(map(bound, rig.skins))
    same = all(a is b for a, b in zip(every, rig.skins, strict=True))
    return rig if same else replace(rig, skins=every)


def _still_in_clips(rig: Rig, before: Rig, node: int) -> Rig:
    """The rig with a joint that moved at rest moved in each clip, where tracks held it at its old rest."""
    rest, old = ({"translation": r.local[node, 3, :3], "rotation": _turn(r, node)} for r in (rig, before))

    def moved(track: Track) -> Track:
        if track.node != node or track.path not in rest or track.interpolation == "CUBICSPLINE":
            return track
        least = _STILL * max(float(np.abs(old[track.path]).max()), 1e-30)
        off = np.abs(track.values - old[track.path]).max(initial=0.0)
        if track.path == "rotation":  # q and −q are one rotation
            off = min(off, np.abs(track.values + old[track.path]).max(initial=0.0))
        if off > least:
            return track
        return replace(track, values=np.broadcast_to(rest[track.path], track.values.shape).copy())

    clips = []
    for clip in rig.clips:
        tracks = tuple(map(moved, clip.tracks))
        same = all(a is b for a, b in zip(tracks, clip.tracks, strict=True))
        clips.append(clip if same else replace(clip, tracks=tracks))
    return replace(rig, clips=tuple(clips))


def _turn(rig: Rig, node: int) -> Floats:
    """The rotation of a node at rest, (4,), also where a matrix holds it."""
    return from_axes(orthonormal_axes(rig.local[node])) if rig.has_matrix[node] else rig.rotation[node]


def _stands(rig: Rig, moved: Rig, node: int, position: Floats) -> bool:
    """Whether a joint is there already, up to the rounding of a file."""
    above, off = world_of(rig, int(rig.parents[node])), np.abs(moved.local[node] - rig.local[node])
    # Where the parent stands far from the origin, the rounding of its place is that of the bone.
    far = max(float(length(position)), float(length(above[3, :3]))) / float(length(above[:3, :3]).max())
    size = max(far, float(length(rig.local[node, 3, :3])))
    axes = float(length(rig.local[node, :3, :3]).max())
    return bool(off[:3].max() <= _SAME_AXES * axes and off[3].max() <= _SAME_POSITION * size)


def _grown(rig: Rig, skin: Skin, nodes: Sequence[int]) -> Skin:
    binds = np.stack([_bind(rig, skin, node) for node in nodes])
    return replace(
        skin,
        joints=np.append(skin.joints, nodes),
        inverse_bind=np.concatenate([skin.inverse_bind, binds]),
        weigh=None if skin.weigh is None else _without_weight(skin.weigh, len(nodes)),
    )


def _without_weight(weigh: Callable[[], Booleans], count: int) -> Callable[[], Booleans]:
    return lambda: np.append(weigh(), np.zeros(count, dtype=bool))


def _bind(rig: Rig, skin: Skin, node: int) -> Floats:
    """The inverse bind matrix of a joint of ours, (4, 4): it stands to its parent as it does at rest.

    To the skin's first joint where its parent is none; the first of a skin of ours is bound at rest.
    """
    above = _row(skin, int(rig.parents[node]))
    if above is not None:
        return multiply(skin.inverse_bind[above], inverse(rig.local[node]))
    own, first = world_of(rig, node), int(skin.joints[0])
    if first == node:
        return inverse(own)
    return multiply(skin.inverse_bind[0], multiply(world_of(rig, first), inverse(own)))


def _set_row(skin: Skin, row: int, inverse_bind: Floats) -> Skin:
    size = float(np.abs(inverse_bind).max())
    if np.abs(skin.inverse_bind[row] - inverse_bind).max() <= _SAME_BIND * size:
        return skin
    binds = skin.inverse_bind.copy()
    binds[row] = inverse_bind
    return replace(skin, inverse_bind=binds)


def _row(skin: Skin, node: int) -> int | None:
    found = np.flatnonzero(skin.joints == node)
    return int(found[0]) if len(found) else None


def placed_by_skin(rig: Rig, content: Content) -> set[int]:
    """Nodes without keys that show nothing but skinned meshes, and that glTF lets their skin alone place.

    content: that of the file, for a rig that has another. Validators warn of transforms there.
    """
    if rig.rules.sized_binding:
        return set()
    try:
        meshes = content.outlines
    except FileError:  # which the comparison with the source reports
        return set()
    moved = {track.node for clip in rig.clips for track in clip.tracks if track.path != "weights"}
    shown = {mesh.node for mesh in meshes if mesh.skin is not None} - moved
    return {node for node in shown if not rig.children[node] and not rig.is_joint[node]}
