"""Whether two files have one skeleton: where its bones point and how long they are, whatever the pose.

The rotation of a joint means the same in both files only where its bones point the same way in its axes.
So the offset of each joint from the joint above is compared: EDITED's, in the axes that C gives, with
RIG's. Joints of skins of both files are compared in their bind poses, all others at rest, as an animated
node of a file without a skin has no bind pose.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.maths.matrices import determinant
from rigtri.maths.ranking import SAME_SHARE, ranked
from rigtri.maths.similarity_fit import OTHER_SHAPE, SAME_SIZE
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length
from rigtri.model.dataclass import dataclass
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.bind_space import MOST_DEGREES, SHORT
from rigtri.operations.take_clips.bones import Bone, keys, varying
from rigtri.operations.take_clips.clip_matching import Taken
from rigtri.operations.take_clips.infinite_motion import refuse_infinite_motion
from rigtri.operations.take_clips.messages import warn_differences, warn_facing
from rigtri.operations.take_clips.proportions import Proportions, warn_lengths
from rigtri.operations.take_clips.retargeting import rest_parts
from rigtri.operations.take_clips.standard_rest import SAME_AXES, standard_rest
from rigtri.operations.take_clips.standing import stood_up
from rigtri.recognition.one_character import titles
from rigtri.report import Report
from rigtri.text import and_more, list_names

# Of the size: so far bind poses may be apart beside turn, size and place, while bones still point alike.
# Joints then move as in EDITED about RIG's own bind pose. Beyond half of the size no joint is near its own
# counterpart, so what the motion reaches for is elsewhere.
MOST_APART = 0.5
# How many times as long as at rest keys of EDITED may make the bone of a joint without a bind pose, or as
# large the joint. A DCC keeps both to float32; units that were mistaken are off by 2.54 and more.
MOST_STRETCH = 1.1


@dataclass(frozen=True, eq=False)
class _Off:
    """A joint and what its bone is off: degrees, and how many times as long or short, at least 1."""

    joint: int
    degrees: float
    stretch: float


def checked_bodies(both: Counterparts, every: Sequence[Taken], report: Report) -> Proportions:
    """The bones of both files, EDITED set upright, with warnings of what else differs.

    Raises GeometryError where EDITED's motion would be another one here.
    """
    _refuse_other_nodes(both, every)
    refuse_infinite_motion(both, every)
    driven = {track.node for taken in every for track in taken.clip.tracks if track.path != "weights"}
    try:
        bodies = _of_one_skeleton(both, {both.back[node] for node in driven if node in both.back})
        stood = stood_up(bodies.both, every, report)
    except GeometryError as error:
        if why := _mirrored(both):  # bones that point elsewhere, or a body that lies, is what follows
            raise GeometryError(why) from error
        raise
    if stood is not bodies.both:
        bodies = Proportions(stood)
    both = bodies.both
    warn_differences(both, report)
    warn_facing(both, report)
    warn_lengths(bodies, report)
    return bodies


def _refuse_other_nodes(both: Counterparts, every: Sequence[Taken]) -> None:
    """GeometryError where clips move only nodes that RIG lacks, and that nothing of it is below."""
    driven = {track.node for taken in every for track in taken.clip.tracks}
    if driven and not any(driven.intersection(both.other.path_to_root(node)) for node in both.back):
        names, ours = (
            list_names(rig.names[n] for n in nodes)
            for rig, nodes in ((both.other, sorted(driven)), (both.rig, np.flatnonzero(both.rig.is_joint)))
        )
        known = titles(both.rig)
        if len(known) > 1 and any(both.other.names[node] in both.rig.names for node in driven):
            raise GeometryError(
                f"RIG has several characters with the nodes that EDITED's clips move, {names}, so it is not "
                f"clear which of them is meant. Name it with --character: {and_more(known, 6)}"
            )
        raise GeometryError(
            f"EDITED's clips move nothing that RIG has: they move {names}, and RIG has {ours}. "
            "Is one an export of the other?"
        )


def _mirrored(both: Counterparts) -> str:
    """Which file is mirrored against the other, and from where on, in words; "" where none is."""
    ours, theirs = np.array([*both.of]), np.array([*both.of.values()])
    rigs = (both.rig.normalised_world[ours], both.other.normalised_world[theirs])
    mine, other = (np.sign(determinant(worlds)) for worlds in rigs)
    apart = mine * other < 0
    if 2 * np.count_nonzero(apart) <= len(apart):
        return ""
    theirs_is = 2 * np.count_nonzero(other[apart] < 0) > np.count_nonzero(apart)
    files = ("EDITED", "RIG") if theirs_is else ("RIG", "EDITED")
    return (
        f"{files[0]} is mirrored by a negative scale from '{both.rig.title(int(ours[apart].min()))}' on, and "
        f"{files[1]} is not, so motion of the one is another in the other. Apply that scale in the DCC, and "
        f"export {files[0]} again"
    )


def _of_one_skeleton(both: Counterparts, moved: Collection[int]) -> Proportions:
    """The bones of both files, by their rest poses where these are one standard pose. moved: nodes of RIG.

    Raises GeometryError where bones or bind poses, and rest poses, differ by more than the bounds.
    """
    bodies = Proportions(both)
    found = [*_measured(both, bodies.bones, moved), *_other_axes(both, bodies.at_rest, moved)]
    why = _other_bones(both, found)
    if not why and found and both.proportions > MOST_APART:
        why = f"bind poses differ by {both.proportions:.2g} of the size (limit {MOST_APART:g})"
    if not why and both.proportions <= OTHER_SHAPE:
        return bodies
    rest, remedy = standard_rest(both), "conform both files to one skeleton (rigtri conform)"
    if rest.fits and (why or max(rest.axes.values()) <= SAME_AXES):
        bodies = Proportions(rest.counterparts())
        stretched = [replace(bone, degrees=0.0) for bone in found]
        why = _other_bones(both, [*stretched, *_other_axes(bodies.both, bodies.at_rest, moved)])
    elif why and rest.same_axes and rest.aside:
        names = list_names(f"{both.rig.title(node)}: {each:.3g}°" for node, each in rest.aside.items())
        why += f"; and limbs point elsewhere at rest ({names})"
        remedy = "let both files rest in one pose (rigtri set-rest)"
    if why:
        unseen = "" if both.bound else ", or other axes, which only skins of both files show"
        skin = "" if both.bound else "export EDITED with its skin, "
        raise GeometryError(
            f"EDITED has another skeleton than RIG{unseen}: {why}. Its rotations would give another motion: "
            f"{skin}{remedy}, or retarget it in a DCC"
        )
    return bodies


def _other_bones(both: Counterparts, found: Sequence[_Off]) -> str:
    """Which bones or nodes differ by more than the bounds; "" where none do."""
    rig = both.rig
    turned = ranked((b for b in found if b.degrees > MOST_DEGREES), lambda b: b.degrees, SAME_SHARE)
    long = ranked((b for b in found if b.stretch > MOST_STRETCH), lambda b: b.stretch, SAME_SHARE)
    if turned:
        names = list_names(f"{rig.title(bone.joint)}: {bone.degrees:.3g}°" for bone in turned)
        return (
            f"bones point in other directions in the axes of their joints ({names}; limit {MOST_DEGREES:g}°)"
        )
    if long:
        names = list_names(f"{rig.title(bone.joint)}: {bone.stretch:.3g}" for bone in long)
        return f"its keys would make bones so many times longer or shorter ({names}; limit {MOST_STRETCH:g})"
    return ""


def _measured(both: Counterparts, bones: Mapping[int, Bone], moved: Collection[int]) -> list[_Off]:
    held, scales = keys(both.other, "translation"), keys(both.other, "scale")
    steady = scales.keys() - varying(scales)
    found = []
    for node, bone in bones.items():
        if bone.slides or both.line(node)[2] not in moved or min(bone.sizes) <= SHORT * both.size:
            continue
        here, far = both.of[node], 1.0
        if not bone.bound:
            rest = rest_parts(both.other, here)["translation"]
            stretch = _ratio(held[here][0], rest) if here in held else 1.0
            grown = _growth(both, node, scales[here][0]) if here in steady else 1.0
            far = max(stretch, grown, 1.0 / stretch, 1.0 / grown)
        found.append(_Off(node, float(np.degrees(angle(bone.ours, bone.theirs))), far))
    return found


def _other_axes(both: Counterparts, bones: Mapping[int, Bone], moved: Collection[int]) -> list[_Off]:
    """What is off of bones at rest, where most are: anybody may put one node elsewhere in its parent."""
    found = _measured(both, bones, moved)
    off = [replace(each, stretch=1.0) for each in found if each.degrees > MOST_DEGREES]
    return off if 2 * len(off) > len(found) > 1 else []


def _growth(both: Counterparts, node: int, scale: Floats) -> float:
    """How many times as large as at rest keys of a scale, (3,), make a node here."""
    left, right = both.turns[node], both.between(node)
    now = scale * float(length(left[0, :3])) * float(length(right[0, :3]))
    return _ratio(now, rest_parts(both.rig, node)["scale"])


def _ratio(one: Floats, other: Floats) -> float:
    """How long a vector, (3,), is for another, (1, 3); 1 where one of them has no length.

    What keys make next to nothing is hidden by them, and no other unit.
    """
    a, b = float(length(one)), float(length(other)[0])
    return a / b if b > 0 and a > SAME_SIZE * b else 1.0
