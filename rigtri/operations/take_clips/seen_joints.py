"""Joints of two files seen from the joint above each, in RIG's axes; worlds are (f, n, 4, 4)."""

from __future__ import annotations

from rigtri.maths.matrices import inverse, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.operations.take_clips.axis_mapping import Counterparts


def joint_above(both: Counterparts, joint: int) -> int:
    """The nearest joint above that both files have, or −1."""
    above = both.line(joint)[2]
    while above >= 0 and not both.rig.is_joint[above]:
        above = both.line(above)[2]
    return above


def seen_ours(both: Counterparts, joint: int, worlds: Floats) -> Floats:
    """A joint of RIG seen from the joint above, or from the world, (f, 4, 4)."""
    above = joint_above(both, joint)
    world: Floats = worlds[:, joint]
    return world if above < 0 else multiply(world, inverse(worlds[:, above]))


def seen_theirs(both: Counterparts, joint: int, worlds: Floats) -> Floats:
    """The same of EDITED."""
    above = joint_above(both, joint)
    world = multiply(both.turns[joint], worlds[:, both.of[joint]])
    if above < 0:
        return multiply(world, both.space)
    return multiply(world, inverse(multiply(both.turns[above], worlds[:, both.of[above]])))
