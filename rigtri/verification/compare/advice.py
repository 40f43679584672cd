"""What a user can do where a result looks a little different: the joints whose scale it is, or rounding."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rigtri.errors import FileError
from rigtri.frames.error_bounds import LeverArm
from rigtri.frames.half_scales import rounding
from rigtri.frames.nonuniform_scale import ROUNDING, ScaleTable
from rigtri.limits import TOLERANCE
from rigtri.maths.matrices import SKEW, multiply, skew, transform_points
from rigtri.maths.quaternions import off_unit
from rigtri.maths.vectors import length
from rigtri.model.animation import key_values
from rigtri.model.metadata import ControlRecord, PoseReaderRecord, TwistRecord
from rigtri.model.rig import Rig
from rigtri.text import and_more
from rigtri.verification.compare.compare import Comparison
from rigtri.verification.compare.verdict import UNIT

# A joint of which less than this share of the tolerance can come is not to blame.
_BLAME = 0.1
# Rounding is what differs where it comes to this share of that: keys of several joints, and of one in several
# places, add up.
_NEAR = 0.01
# A turned node of which the rounding at most comes to this share of what was found is to blame.
_ROUNDED = 0.3
# Clips that scale joints may hold what is attached there up to so many times as large as it is at rest.
_GROWN = 2.0


def why_near(before: Rig, after: Rig, result: Comparison, tolerance: float) -> str:
    """What to do about a deviation above or near the tolerance, with a space before it; else "".

    Turning a joint whose scale is nearly uniform moves what is attached there; else only the rounding
    of stored numbers can be what differs, near the tolerance or as far as that rounding reaches.
    """
    if result.lost or result.different:
        return ""
    largest = result.largest_deviation
    allow = f"allow more with --tolerance {_rounded_up(largest):g}"
    if words := why_displaced(before, largest):
        return words
    not_unit = why_not_unit(before, largest)
    weights = after.pending.joint_merges or after.pending.weight_limits
    if not not_unit and weights and not _poses_apart(before, after) > _BLAME * largest:
        return f" Other weights move the skin: {allow}"
    if rough := rough_scales(before, after, largest):
        names = ", ".join(f"'{before.title(node)}'" for node in rough[:4])
        return (
            f" A SkelAnimation holds scales as 16-bit numbers, which cannot say the new ones of {names} "
            f"closely enough. {_other_scales(before, after, rough)}or {allow}"
        )
    if not_unit:
        return why_far(before, result) or not_unit
    near = largest < 10 * tolerance
    noisy = nearly_uniform(before, after, tolerance if near else largest)
    if noisy:
        scale = " ".join(f"{x:.8g}" for x in before.scale[noisy[0]])
        names = ", ".join(f"'{before.title(node)}'" for node in noisy[:4])
        return (
            f" The scale of {names} is nearly uniform but not quite ({scale}), and what they move "
            f"reaches far. Leave {'it' if len(noisy) == 1 else 'them'} out with --exclude "
            f"{before.title(noisy[0])}, or {allow}"
        )
    depth = max(before.depth) + 1
    far = float(np.abs(before.world[:, 3, :3]).max(initial=0.0)) / (result.diagonal or 1.0)
    floor = depth * max(far, 1.0) * float(np.finfo(np.float32).eps) / 2
    if not (near or floor >= _NEAR * largest):
        return why_far(before, result)
    return (
        f" Numbers in the file are float32: with {depth} nodes below each other, up to {far:.3g} sizes from "
        f"the origin, their rounding alone may reach {floor:.1g} per turned joint. Leave out what is "
        f"named with --exclude, or {allow}"
    )


def _poses_apart(before: Rig, after: Rig) -> float:
    """How far an edit moves nodes and what joints hold at rest, whatever the weights, as a share of the size.

    Joints hold what is bound where any joint of their skin is.
    """
    there = {key: node for node, key in enumerate(after.keys) if key is not None}
    nodes = [node for node, key in enumerate(before.keys) if key in there and not before.is_joint[node]]
    now = [there[before.keys[node]] for node in nodes]
    found = [before.world[nodes, 3, :3] - after.world[now, 3, :3]]
    for old, new in zip(before.skins, after.skins, strict=False):
        rows = {joint: row for row, joint in enumerate(new.joints.tolist())}
        joints = [there.get(before.keys[joint], -1) for joint in old.joints.tolist()]
        kept = [row for row, joint in enumerate(joints) if joint in rows]
        one, other = (
            transform_points(
                old.bind[np.newaxis, kept, 3, :3],
                multiply(skin.inverse_bind[held], rig.world[skin.joints[held]])[:, np.newaxis],
            )
            for skin, held, rig in ((old, kept, before), (new, [rows[joints[k]] for k in kept], after))
        )
        found.append((one - other).reshape(-1, 3))
    size = float(length(np.ptp(before.world[:, 3, :3], axis=0)))
    apart = length(np.concatenate(found))
    return float(apart[np.isfinite(apart)].max(initial=0.0)) / (size or 1.0)


def why_displaced(rig: Rig, shown: float) -> str:
    """The twist joints with weight that somebody has moved or turned at rest, so that it may be all of
    ``shown``; else "". Their bones, to which their weight goes back, are bound elsewhere against them.
    """
    records, names = rig.records(TwistRecord), dict[str, None]()
    extent = float(length(np.ptp(rig.world[rig.is_joint, 3, :3], axis=0))) if rig.is_joint.any() else 0.0
    for skin in (skin for skin in rig.skins if records and skin.weigh is not None):
        rows = {joint: row for row, joint in enumerate(skin.joints.tolist())}
        weighted = set(skin.joints[skin.weighted].tolist())
        for node, record in records.items():
            bone = rig.known(record.joint)
            if (
                bone is None
                or not {node, bone} <= rows.keys()
                or node not in weighted
                or record.standing is not None
            ):
                continue  # else an operation has changed its rest pose, which the record says
            mine, its = (multiply(skin.inverse_bind[rows[k]], rig.world[k]) for k in (node, bone))
            # A turn of its axes by so much, or a way that is such a share of the size.
            off = max(np.abs(mine - its)[:3, :3].max(), np.abs(mine - its)[3].max() / (extent or 1.0))
            if off > max(TOLERANCE, _BLAME * shown):
                names[f"'{rig.title(node)}' (along '{rig.title(bone)}')"] = None
    if not names:
        return ""
    return (
        f" Twist joints with weight do not rest as they are bound to their bones: {and_more(list(names), 4)}"
        ". Put them back in the program that moved or turned them, or a node above them"
    )


def why_sheared(rig: Rig) -> str:
    """What to do about joints of a USD file that rest sheared, which glTF cannot say; "" for none."""
    joints = np.flatnonzero(rig.is_joint & rig.has_matrix)
    if not rig.rules.raw_quaternions or not (found := joints[skew(rig.local[joints]) > SKEW].tolist()):
        return ""
    names = and_more([f"'{rig.title(node)}'" for node in found], 4)
    return (
        f" The rest pose of {names} is sheared, which glTF cannot say of joints that move. Let them rest as "
        "they are bound: rigtri set-rest --pose bind"
    )


def why_not_unit(rig: Rig, shown: float) -> str:
    """The nodes of a USD file with rotations so far off unit length that it may be all of ``shown``; else "".

    USD makes no rotations of them: they scale and shear, each in its own axes.
    """
    if not rig.rules.raw_quaternions:
        return ""
    off = {node: off_unit(rig.rotation[node]) for node in np.flatnonzero(~rig.has_matrix).tolist()}
    worst = max(off.values(), default=0.0)
    place = ""
    for clip in rig.clips:
        for track in clip.tracks:
            if track.path == "rotation" and track.node >= 0:
                values = key_values(track)
                found = off_unit(values)
                off[track.node] = max(off.get(track.node, 0.0), found)
                if found > worst:
                    time = max(zip(map(off_unit, values), track.times, strict=True))[1]
                    worst, place = found, f" (the key at {time:g} in clip '{clip.name}')"
    if not worst > max(UNIT, _BLAME * shown):
        return ""
    names = and_more([f"'{rig.title(node)}'" for node in sorted(off) if off[node] > _BLAME * worst], 4)
    return (
        f" Rotations of {names} are off unit length by up to {worst:.2g}{place}, of which USD makes scaled "
        "and sheared axes. Normalise them in the program that wrote the file"
    )


def why_far(rig: Rig, result: Comparison) -> str:
    """The number of a clip whose rounding alone comes near what was found; "" where none does."""
    largest, found = 0.0, ""
    for clip in rig.clips:
        for track in clip.tracks:
            value = float(np.abs(key_values(track)).max(initial=0.0))
            moves = {
                "translation": value / (result.diagonal or 1.0),
                "scale": value,
                "rotation": value * value if rig.rules.raw_quaternions else 0.0,
            }.get(track.path, 0.0) * float(np.finfo(np.float32).eps)
            if moves > largest and track.node >= 0:
                largest = moves
                found = f" The {track.path} of '{rig.title(track.node)}' in clip '{clip.name}' is {value:.2g}"
    # The rounding of ordinary numbers is nothing to remove keys for, however small the tolerance.
    if not largest >= max(_NEAR * result.largest_deviation, TOLERANCE):
        return ""
    return (
        f"{found}: the float32 of the file rounds what they move by {largest:.1g} sizes. Remove those "
        "keys, or export the clip again with the program that wrote it"
    )


def why_levered(rig: Rig, result: Comparison, grains: Mapping[int, float]) -> str:
    """The node with rotation keys that moves what is so far from it that their rounding may be what was
    found, and what to do; else "". grains: how far the source's own library rounds angles, in radians.
    """
    turned = sorted({t.node for clip in rig.clips for t in clip.tracks if t.path == "rotation"})
    if not turned:
        return ""
    arm = LeverArm(rig)
    far = arm.at_most * arm.sizes / (result.diagonal or 1.0)
    float32 = float(np.finfo(np.float32).eps)
    off, node = max((far[node] * (float32 + grains.get(node, 0.0)), -node) for node in turned)
    if not _ROUNDED * result.largest_deviation <= off < np.inf:
        return ""
    node = -node
    rounds, write = "rotation keys", ""
    if grains.get(node, 0.0) > float32:
        rounds, write = "its angles and of rotation keys", "Write its angles as doubles, p"
    return (
        f" '{rig.title(node)}' turns what is {far[node]:.2g} sizes from its origin: there the float32 of "
        f"{rounds} comes to as much as {off:.1g}. {write or 'P'}ut its origin nearer to what it turns, or "
        f"allow more with --tolerance {_rounded_up(result.largest_deviation):g}"
    )


def _other_scales(before: Rig, after: Rig, joints: list[int]) -> str:
    """What to do about scales of joints that half floats cannot hold: about what keys of controls or pose
    readers make them, else freeze.

    Controls that the source does not know of are of another file (bake --rig): a DCC has made joints of them.
    """
    records = before.records(ControlRecord)
    if not records and after.records(ControlRecord):
        return "Transfer the keys with rigtri take-clips instead, export glTF in place of USD, "
    there = {key: node for node, key in enumerate(before.keys) if key is not None}
    scaled = {track.node for clip in before.clips for track in clip.tracks if track.path == "scale"}
    # take-clips brings new ones.
    fresh = {track.node for clip in after.clips for track in clip.tracks if track.path == "scale"}
    scaled |= {there[after.keys[node]] for node in fresh if after.keys[node] in there}
    controls = [
        node for node in sorted(scaled & records.keys()) if before.known(records[node].joint) in joints
    ]
    readers = [
        f"'{record.name}'"
        for record in after.records(PoseReaderRecord).values()
        if any(each.scale is not None and before.known(each.joint) in joints for each in record.outputs)
    ]
    if readers:
        return f"They come from what {and_more(readers, 4)} drives: let it drive no scale, "
    if not controls:
        return f"Keep {'its' if len(joints) == 1 else 'their'} scale (freeze: --only above), "
    names = and_more([f"'{before.title(node)}'" for node in controls], 4)
    return f"They come from the scale keys of {names}: take these keys out, "


def rough_scales(before: Rig, after: Rig, shown: float) -> list[int]:
    """The joints of a USD file whose new scales are rounded to 16 bits by so much that it may be all of
    ``shown``, a share of the size: those that count most come first.

    Source: UsdSkelAnimation, `scales` are half3[].
    """
    known = {id(track) for clip in before.clips for track in clip.tracks}
    there = {key: node for node, key in enumerate(before.keys) if key is not None}
    off = np.zeros(len(before))
    for track in (
        t for clip in after.clips for t in clip.tracks if after.rules.raw_quaternions and id(t) not in known
    ):
        node = there.get(after.keys[track.node], -1) if track.path == "scale" else -1
        if node >= 0 and before.is_joint[node]:
            off[node] = max(off[node], rounding(key_values(track)))
    if not off.any():
        return []
    try:
        reach = LeverArm(before).exact.copy()
    except FileError:
        return []
    # The whole frames of what rigtri has added are compared, with three axes as long as the rig.
    own = {there[after.keys[node]] for node in after.own if after.keys[node] in there}  # bake --rig knows it
    reach[list(before.with_ancestors(before.own | own))] += 3.0**0.5
    effect = off * reach
    # A reach is that of bones in one line; in a pose they are not.
    whole = _GROWN * sum(effect.tolist())
    found = np.flatnonzero((effect > _BLAME * shown) & (whole > shown)).tolist()
    return sorted(found, key=lambda node: -float(effect[node]))


def nearly_uniform(before: Rig, after: Rig, tolerance: float) -> list[int]:
    """The nodes that an edit turned although their scale is not quite uniform, by what that can move."""
    scales = ScaleTable.of(before)
    spread = np.where(scales.uneven | (scales.spread <= ROUNDING), 0.0, scales.spread)
    try:
        effect = spread * LeverArm(before).exact
    except FileError:
        return []
    there = {key: node for node, key in enumerate(after.keys) if key is not None}
    suspects = np.flatnonzero(effect > _BLAME * tolerance).tolist()
    moved = [
        node
        for node in suspects
        if before.keys[node] in there
        and not np.array_equal(before.local[node, :3, :3], after.local[there[before.keys[node]], :3, :3])
    ]
    return sorted(moved, key=lambda node: -float(effect[node]))


def _rounded_up(value: float) -> float:
    """A little more, with one digit."""
    return float(f"{value * 1.5:.0e}")
