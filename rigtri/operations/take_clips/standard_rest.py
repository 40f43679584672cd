"""Two bodies that rest in one standard pose with the same axes, as conform leaves them.

Their bind poses are what their makers posed, and compare nothing. At rest they are alike: a rotation means
the same in both from there, whatever their lengths. So the rest poses take the place of the bind poses.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise

import numpy as np

from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import (
    determinant,
    from_frame,
    inverse,
    multiply,
    nearest_rotation,
    transform_directions,
)
from rigtri.maths.similarity_fit import snapped_turn, upright_turn
from rigtri.maths.trigonometry import Floats, sin_cos
from rigtri.maths.vectors import angle, length
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.body_pose import sure_bones
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.bind_space import MOST_DEGREES
from rigtri.recognition.layout import BENDS, FINGER_BONES
from rigtri.recognition.recognise import recognise

# Whose directions a T-pose or A-pose says, from the joint to the next; trunk, clavicles and feet are as each
# body has them.
_POSED = (
    *BENDS.values(),
    ("Hand", "MiddleProximal"),
    *FINGER_BONES.values(),
)
# Degrees by which axes of one standard skeleton differ at most: float32 leaves a hundredth of it.
SAME_AXES = 0.1


@dataclass(frozen=True, eq=False)
class StandardRest:
    """How two files rest. turn: the rotation, (3, 3), that takes EDITED's world to RIG's.

    axes: by how many degrees the axes of each joint differ from EDITED's otherwise than those of most joints,
    by node of RIG. limbs: by how many the bone that ends at a joint points elsewhere, of the bones whose
    directions a standard pose says.
    """

    both: Counterparts
    turn: Floats
    axes: Mapping[int, float]
    limbs: Mapping[int, float]

    @property
    def same_axes(self) -> bool:
        """Whether the axes of most joints differ alike, if at all, and limbs show that there are bodies."""
        off = sum(degrees > MOST_DEGREES for degrees in self.axes.values())
        return bool(self.limbs) and 2 * off <= len(self.axes)

    @property
    def aside(self) -> dict[int, float]:
        """The limbs that point elsewhere at rest, with their degrees, the farthest first."""
        found = sorted(self.limbs.items(), key=lambda item: -item[1])
        return {joint: degrees for joint, degrees in found if degrees > MOST_DEGREES}

    @property
    def fits(self) -> bool:
        """Whether rotations mean the same in both files, counted from rest."""
        return self.same_axes and not self.aside

    def counterparts(self) -> Counterparts:
        """The pairs of both files, with their rest poses for bind poses."""
        both = self.both
        rig = _bound_at_rest(both.rig, np.flatnonzero(both.rig.is_joint))
        joints = {*np.flatnonzero(both.other.is_joint).tolist(), *(both.of[n] for n in self.axes)}
        other = _bound_at_rest(both.other, np.array(sorted(joints), dtype=np.intp))
        # A file may lie at rest and stand in its clips: then its format says what is up.
        stands = self.turn if both.stands(self.turn) else None
        return Counterparts(rig, other, stands, at_rest=self.turn)


def standard_rest(both: Counterparts) -> StandardRest:
    """How the bodies of both files rest, compared by the joints that both have."""
    rig, other = both.rig, both.other
    joints = [n for n in both.of if rig.is_joint[n] and _has_axes(rig, n) and _has_axes(other, both.of[n])]
    ours, theirs = _turned(rig, joints), _turned(other, [both.of[n] for n in joints])
    bones = list(_posed_bones(both, set(joints)))
    found = []
    # One standard has the same axes in the body; or those of the world, whose up may be another one.
    for standard in (np.eye(3), upright_turn(other.rules.up, rig.rules.up)):
        turns = multiply(multiply(inverse(theirs), from_frame(standard, np.zeros(3))), ours)
        turn = _most_common(turns)
        off = {joint: _apart(each, turn) for joint, each in zip(joints, turns, strict=True)}
        world = from_frame(turn, np.zeros(3))
        limbs = {
            joint: float(np.degrees(angle(here, transform_directions(there, world))))
            for joint, here, there in bones
        }
        found.append(StandardRest(both, turn, off, limbs))
    return min(found, key=lambda rest: (len(rest.aside), sum(d > MOST_DEGREES for d in rest.axes.values())))


def _apart(turn: Floats, other: Floats) -> float:
    """The largest angle, in degrees, between axes of a matrix, (4, 4), and those of another, (3, 3)."""
    return float(np.degrees(angle(turn[:3, :3], other)).max())


def _has_axes(rig: Rig, node: int) -> bool:
    world = rig.world[node]
    return bool(np.isfinite(world).all() and float(determinant(world)) > 0)


def _turned(rig: Rig, nodes: list[int]) -> Floats:
    return from_frame(nearest_rotation(rig.world[nodes]), np.zeros((len(nodes), 3)))


def _most_common(turns: Floats) -> Floats:
    """The rotation, (3, 3), that most of matrices, (k, 4, 4), are near to; one of the 24 where it is one."""
    if not len(turns):
        return np.eye(3)
    # Ends of unit vectors that are this far apart, as an angle.
    limits = [2.0 * float(sin_cos(0.5 * np.radians(degrees))[0]) for degrees in (MOST_DEGREES, SAME_AXES)]

    def score(turn: Floats) -> int:
        # That of many to rounding counts more than one amid some that are a little off.
        apart = length(turns[:, :3, :3] - turn).max(axis=-1)
        return sum(int(np.count_nonzero(apart <= limit)) for limit in limits)

    return snapped_turn(max(turns[:, :3, :3], key=score))


def _posed_bones(both: Counterparts, joints: set[int]) -> Iterator[tuple[int, Floats, Floats]]:
    """The ends of bones that a standard pose sets, and where these point in the worlds of both files."""
    for body in recognise(both.rig).characters:
        bones = sure_bones(body)
        for side in ("left", "right"):
            for start, end in (pair for chain in _POSED for pair in pairwise(chain)):
                here, there = (bones.get(side + bone, -1) for bone in (start, end))
                if not {here, there} <= joints:
                    continue
                ours = both.rig.world[there, 3, :3] - both.rig.world[here, 3, :3]
                theirs = both.other.world[both.of[there], 3, :3] - both.other.world[both.of[here], 3, :3]
                if min(float(length(ours)), float(length(theirs))) > 0:
                    yield there, ours, theirs


def _bound_at_rest(rig: Rig, joints: Integers) -> Rig:
    """The rig with one skin of these joints, bound where they are. Meshes, of other skins, are left out."""
    content = rig.content.without_skins(range(len(rig.skins)))
    return replace(rig, skins=(Skin("", joints, inverse(rig.world[joints])),), content=content)
