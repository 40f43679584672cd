"""Joints of two files seen from a node above each, in RIG's axes; worlds are (f, n, 4, 4)."""

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


def seen_ours(joint: int, above: int, worlds: Floats) -> Floats:
    """A joint of RIG seen from one above, or from the world where that is −1, (f, 4, 4)."""
    world: Floats = worlds[:, joint]
    return world if above < 0 else multiply(world, inverse(worlds[:, above]))


def seen_theirs(both: Counterparts, joint: int, above: int, worlds: Floats) -> Floats:
    """The same of EDITED."""
    world = multiply(both.turns[joint], worlds[:, both.of[joint]])
    if above < 0:
        return multiply(world, both.space)
    return multiply(world, inverse(multiply(both.turns[above], worlds[:, both.of[above]])))
