"""Noise of joints, measured by the bones of twins, and how far it bends what is straight."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import acos, cos, fsum, sqrt

from rigtri.maths.angle_limits import radians_below
from rigtri.recognition.joint_tree import Tree

# The cosine above which a joint does not bend: a twist joint within a bone, 6°.
STRAIGHT = 0.9945
# Noise of less than this part of a chain is none; it explains bends of so many deviations, and up to 25°.
_NOISE, _DEVIATIONS, _AT_MOST = 2e-3, 2.0, radians_below(25)


def noise_of(twins: Iterable[tuple[float, float]]) -> float:
    """The noise of a place along each axis, by the lengths of the same bones on both sides, file units.

    Lengths of twins differ by twice that.
    """
    squares = [(one - other) ** 2 for one, other in twins]
    return 0.5 * sqrt(fsum(squares) / max(1, len(squares)))


def straight_within(
    tree: Tree, paths: Sequence[Sequence[int]], bones: Sequence[float], least: float
) -> list[float]:
    """The cosine of how far each joint of a limb may bend within a bone; least: that of one without noise.

    paths: of the limb and its twin. bones: the length of each bone of the first joints of the limb, file
    units. A joint bends by what noise is of the bones on both sides.
    """
    noise = noise_of(zip(bones[1:], (tree.bone[node] for node in paths[-1][1:]), strict=False))
    if len(paths) < 2 or noise < _NOISE * fsum(bones[1:]):
        return [least] * len(bones)
    found = [1.0]
    for one, other in pairwise(bones[1:]):
        turn = noise * sqrt(2.0 * (one * one + other * other + one * other)) / max(one * other, 1e-30)
        found.append(cos(min(_AT_MOST, acos(least) + _DEVIATIONS * turn)))
    return [*found, 1.0]
