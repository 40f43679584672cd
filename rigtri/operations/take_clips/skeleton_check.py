"""Whether two files have one skeleton: where its bones point and how long they are, whatever the pose.

The rotation of a joint means the same in both files only where its bones point the same way in its axes.
So the offset of each joint from the joint above is compared: EDITED's, in the axes that C gives, with
RIG's. Joints of skins of both files are compared in their bind poses, all others at rest, as an animated
node of a file without a skin has no bind pose.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.maths.matrices import inverse, multiply, transform_directions
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length
from rigtri.model.animation import Path, key_values
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.armature_motion import bind_poses
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.messages import list_names
from rigtri.operations.take_clips.retargeting import rest_parts

# Degrees. One skeleton after a DCC is off by 0.1 at most (joints that move a little against their parents),
# other characters with the same names by up to 157. At 5, the end of a limb is a tenth of its length beside.
MOST_DEGREES = 5.0
# Of the size: so far bind poses may be apart beside turn, size and place, while bones still point alike.
# Joints then move as in EDITED about RIG's own bind pose. Beyond half of the size no joint is near its own
# counterpart, so what the motion reaches for is elsewhere.
MOST_APART = 0.5
# How many times as long, or as large, keys may make the bone of a joint without a bind pose. A DCC keeps both
# to float32; units that were mistaken are off by 2.54 and more.
MOST_STRETCH = 1.1
# Of the size; shorter bones have no direction that counts. Of its length: a joint that moves by more against
# the joint above is no end of a bone, such as the target of an IK.
_SHORT, _SLIDES = 1e-2, 1e-2


@dataclass(frozen=True, eq=False)
class _Bone:
    """A joint and what its bone is off: degrees, and how many times as long or short, at least 1."""

    joint: int
    degrees: float
    stretch: float


def refuse_other_skeleton(both: Counterparts, moved: Collection[int]) -> None:
    """GeometryError where bones or bind poses differ by more than the bounds; ``moved``: nodes of RIG."""
    rig = both.rig
    bones = _bones(both, moved)
    turned = sorted((bone for bone in bones if bone.degrees > MOST_DEGREES), key=lambda b: -b.degrees)
    long = sorted((bone for bone in bones if bone.stretch > MOST_STRETCH), key=lambda b: -b.stretch)
    why = ""
    if turned:
        names = list_names(f"{rig.title(bone.joint)}: {bone.degrees:.3g}°" for bone in turned)
        why = f"bones point elsewhere in the axes of their joints ({names}; limit {MOST_DEGREES:g}°)"
    elif long:
        names = list_names(f"{rig.title(bone.joint)}: {bone.stretch:.3g}" for bone in long)
        why = f"its keys would make bones so many times longer or shorter ({names}; limit {MOST_STRETCH:g})"
    elif bones and both.proportions > MOST_APART:
        why = f"bind poses differ by {both.proportions:.2g} of the size (limit {MOST_APART:g})"
    if why:
        raise GeometryError(
            f"EDITED has another skeleton than RIG, or other axes without a skin that shows them: {why}. "
            "Its rotations would give another motion: retarget it in a DCC, or export EDITED with its skin"
        )


def _bones(both: Counterparts, moved: Collection[int]) -> list[_Bone]:
    rig, keys, scales = both.rig, _keys(both.other, "translation"), _keys(both.other, "scale")
    other = _as_keyed(both.other, keys)
    ours, theirs = bind_poses(rig), bind_poses(other)
    sliding = _varying(_keys(rig, "translation")), _varying(keys)
    steady = scales.keys() - _varying(scales)
    found = []
    for node in sorted(both.of):
        between, own, above = both.line(node)
        if above not in moved or not (rig.is_joint[node] and rig.is_joint[above]):
            continue
        here, there = both.of[node], both.of[above]
        if sliding[0] & {node, *own} or sliding[1] & {here, *between}:
            continue
        bound = {node, above} <= both.bound
        mine = _offset(rig, ours if bound else {}, node, above)
        seen = transform_directions(
            _offset(other, theirs if bound else {}, here, there), inverse(both.turns[above])
        )
        sizes = float(length(mine)), float(length(seen))
        if np.isfinite(sizes).all() and min(sizes) > _SHORT * both.size:
            stretch = sizes[1] / sizes[0] if here in keys and not bound else 1.0
            grown = _growth(both, node, scales[here][0]) if here in steady and not bound else 1.0
            far = max(stretch, grown, 1.0 / stretch, 1.0 / grown)
            found.append(_Bone(node, float(np.degrees(angle(mine, seen))), far))
    return found


def _growth(both: Counterparts, node: int, scale: Floats) -> float:
    """How many times as large as at rest keys of a scale, (3,), make a node here."""
    left, right = both.turns[node], both.between(node)
    now = float(length(scale)) * float(length(left[0, :3])) * float(length(right[0, :3]))
    rest = float(length(rest_parts(both.rig, node)["scale"])[0])
    return now / rest if now > 0 and rest > 0 else 1.0


def _offset(rig: Rig, bind: dict[int, Floats], node: int, above: int) -> Floats:
    """Where a node stands in the axes of another, (3,): in the bind pose, or at rest."""
    place, seen_from = (bind.get(k, rig.world[k]) for k in (node, above))
    return np.asarray(multiply(place, inverse(seen_from))[3, :3])


def _keys(rig: Rig, path: Path) -> dict[int, Floats]:
    """The translations or scales, (k, 3), that nodes have in all clips."""
    found: dict[int, list[Floats]] = {}
    for track in (t for clip in rig.clips for t in clip.tracks if t.path == path):
        found.setdefault(track.node, []).append(key_values(track))
    return {node: np.concatenate(values) for node, values in found.items()}


def _varying(keys: Mapping[int, Floats]) -> set[int]:
    """The nodes whose keys, (k, 3), differ by more than a share of their size."""
    return {
        node
        for node, values in keys.items()
        if float(np.ptp(values, axis=0).max()) > _SLIDES * float(length(values).max())
    }


def _as_keyed(rig: Rig, keys: Mapping[int, Floats]) -> Rig:
    """The rig with nodes where its clips hold them, which is not always where they rest."""
    translation = rig.translation.copy()
    for node in keys.keys() - _varying(keys):
        translation[node] = keys[node][0]
    return replace(rig, translation=translation)
