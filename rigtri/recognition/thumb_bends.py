"""Whether the bend of a thumb says about which axis it flexes, or only the noise of its joints.

A thumb has the shortest bones of a body that may say so alone: a bend of 12° of two bones of 2 cm is 2 mm
that its middle joint stands off the line of its neighbours.

Source: docs/presets.md, "One body, one sense".
"""

from __future__ import annotations

from collections.abc import Sequence
from math import fsum, sqrt
from typing import NamedTuple

from rigtri.maths.angle_limits import radians_below
from rigtri.maths.trigonometry import Floats
from rigtri.recognition.bone_noise import noise_of

# A thumb that bends by less than this at rest (radians) shows nothing.
BENT = radians_below(10)
# One that bends by less than this (radians), and aside of how it closes over the palm, has only such a shape.
SHAPE = radians_below(30)
# A bend that noise may have turned is believed within this of how a thumb closes (radians), and from the
# second on only where that of the other hand mirrors it within the third. As for limbs.
NATURAL, ALIKE, MIRRORED = radians_below(60), radians_below(30), radians_below(30)
# Two thumbs that bend alike within this (radians) are of one body in one pose, and one rule is for both.
SIMILAR_BEND = radians_below(10)
# A bend that is further aside than this (radians) opens the hand.
OPENS = radians_below(90)
# The least noise of places, as a part of the lower arm: 0.6 mm of a grown person.
NOISE = 1 / 400
# The middle of three joints stands by this many deviations of one place off the line of the others …
_OFF_LINE = sqrt(1.5)
# … and if that is less than this part of its height over the line (22°), the plane of the three is known.
_KNOWN = 0.4


class ThumbBend(NamedTuple):
    """What the first two bones of a thumb show.

    hinge: their own, unit, (3,). bend: radians. height: of the middle joint over the line between the others,
    file units. aside: of the hinge that closes the thumb over the palm, radians, mirrored on the right hand.
    """

    hinge: Floats
    bend: float
    height: float
    aside: float


def own_hinges_count(bends: Sequence[ThumbBend], noise: float) -> list[bool]:
    """Of one thumb, or those of two hands, whether its own bend decides, and not the palm alone.

    noise: of the places of joints along each axis, file units.
    """
    both = len(bends) == 2
    mirrored = both and abs(bends[0].aside - bends[1].aside) < MIRRORED
    if both and abs(bends[0].bend - bends[1].bend) <= SIMILAR_BEND:
        # What is mirrored but for rounding has one rule on both sides.
        height = min(bend.height for bend in bends)
        aside = max(abs(bend.aside) for bend in bends)
        pair = ThumbBend(bends[0].hinge, 0.5 * (bends[0].bend + bends[1].bend), height, aside)
        bends = [pair, pair]
    return [_counts(bend, noise, mirrored=mirrored) for bend in bends]


def _counts(thumb: ThumbBend, noise: float, *, mirrored: bool) -> bool:
    if not thumb.bend > BENT:
        return False
    known = not hides(noise, thumb.height)
    if known and thumb.bend > SHAPE:
        return abs(thumb.aside) < OPENS
    return abs(thumb.aside) < (NATURAL if known or mirrored else ALIKE)


def hides(noise: float, height: float) -> bool:
    """Whether noise of places may have turned the plane of three joints, whose middle one is at a height."""
    return not _OFF_LINE * noise < _KNOWN * height


def noise_of_twins(one: Sequence[float], other: Sequence[float]) -> float:
    """See `noise_of`; that two sides are of other sizes is no noise."""
    total, twin = fsum(one), fsum(other)
    if not (total > 0 and twin > 0):
        return 0.0
    larger = sqrt(total / twin)
    return noise_of((a / larger, b * larger) for a, b in zip(one, other, strict=True))
