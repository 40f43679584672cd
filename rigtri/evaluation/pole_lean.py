"""Limbs that rest bent a little beside their pole: they rest as they are, and turn to it as they bend more.

Their bones swing to the pole and do not roll. If they turned with the plane of the limb instead, IK would
turn them round by up to half a turn where they rest, and twist joints with them.
"""

from __future__ import annotations

import numpy as np

from rigtri.maths.trigonometry import Floats, arc_tangent, sin_cos
from rigtri.maths.vectors import cross, dot, length

# As a share of the limb: a pole nearer than this to the line to the target gives no side: files hold
# float32, some nodes deep.
ON_LINE = 1e-5
# How near to straight a limb is whose bend is rounding, as a share of its length.
STRAIGHT = 1e-5
# Below this sine of the bend a limb's plane is the rounding of its positions; then its pole defines it.
NEARLY_STRAIGHT = 2e-3
# Radians between pole and plane that rounding may make; a pole that somebody moved is farther off.
SAME_SIDE = 1e-3
# Up to this sine (15° of bones as long) a limb is bent so little that its pole may say otherwise.
_SLIGHT = 0.0653
# A limb that rests bent beside its pole has turned to it once its end is this many times as far from where
# the limb would be straight as at rest, about three times as bent, and one that rests straight as `STRAIGHT`.
_TURNS_BY = 9.0


def lean_at_rest(bend: Floats, pole: Floats, line: Floats, size: float) -> float:
    """By how much a limb of length ``size`` that is bent a little is bent beside its pole, in radians.

    bend, pole: (3,), to the mid joint and to the pole, square to ``line``, (3,), unit, from root to end.
    0 where the pole or the bend has no side, and where a limb that is nearly straight is bent to the
    pole's half.
    """
    height = length(bend)
    if not ON_LINE * size < height <= _SLIGHT * size or not length(pole) > ON_LINE * size:
        return 0.0
    near = float(dot(pole, bend))
    if near > 0 and height <= NEARLY_STRAIGHT * size:
        return 0.0
    lean = float(arc_tangent(dot(cross(pole, bend), line), near))
    return abs(lean) if abs(lean) > np.pi - SAME_SIDE else lean if abs(lean) > SAME_SIDE else 0.0


def leaning(reach: Floats, total: Floats, at_rest: float, lean: float) -> Floats | None:
    """By how much limbs are bent beside the pole, radians, (f,), counted about the line from root to end.

    reach: from the root to the end as it is solved, (f,): a soft limb is bent where its target is far.
    As much as at rest, so that they rest where they do in the file, and no longer where they are bent more.
    None where they bend to the pole.
    """
    if not lean:
        return None
    with np.errstate(invalid="ignore", divide="ignore"):
        nearer = (at_rest - reach / total) / turning_way(at_rest)
    share = np.clip(np.where(np.isfinite(nearer), nearer, 1.0), 0.0, 1.0)
    return lean * (0.5 + 0.5 * sin_cos(share * np.pi)[1])


def turning_way(at_rest: float) -> float:
    """How much nearer to the root, as a share of the limb, its end is than at rest where it has turned."""
    return (_TURNS_BY - 1.0) * max(1.0 - at_rest, STRAIGHT)


def leaned(bends: Floats, along: Floats, leans: Floats | None) -> Floats:
    """Directions square to ``along``, (f, 3) both, turned about it by ``leans``, radians, (f,)."""
    if leans is None:
        return bends
    sines, cosines = (part[..., np.newaxis] for part in sin_cos(leans))
    return cosines * bends + sines * cross(along, bends)
