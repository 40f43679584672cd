"""What the bends of fingers show of the axis about which a hand closes.

Source: docs/presets.md, "One body, one sense".
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from rigtri.maths.angle_limits import cosine_below, radians_below
from rigtri.maths.triangle import bend_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise
from rigtri.recognition.thumb_bends import SIMILAR_BEND

# The first of its four joints or more may be a metacarpal, which is set aside by up to this (radians); it is
# none where its plane is as near as this (a cosine) to that of the others.
SET_ASIDE, WITH_OTHERS = radians_below(30), cosine_below(30)
# Fingers that all bend to one side by more than this (radians) say which side the palm is on.
SHOWN = radians_below(2)


class Curl(NamedTuple):
    """What the bends of fingers show at rest.

    hinge: that they have in common, unit, (3,). bend: of most of them, radians. agreement: of their own
    hinges, 0 to 1. closes: the cosine between the hinge and that about which they close by their places.
    """

    hinge: Floats
    bend: float = 0.0
    agreement: float = 0.0
    closes: float = 0.0


def mean_of_pair(curls: Sequence[Curl]) -> list[Curl]:
    """The same, with the mean numbers of two hands that are bent alike, so that one rule applies to both."""
    if len(curls) != 2 or abs(curls[0].bend - curls[1].bend) > SIMILAR_BEND:
        return list(curls)
    mean = [0.5 * (one + other) for one, other in zip(curls[0][1:], curls[1][1:], strict=True)]
    return [Curl(curl.hinge, *mean) for curl in curls]


def is_set_aside(a: Floats, b: Floats, c: Floats) -> bool:
    """Whether the first triple of a finger, (k, 3) each, shows where its metacarpal is, not how it closes."""
    if len(a) < 2 or float(bend_angle(a[0], b[0], c[0])) > SET_ASIDE:
        return False
    first, *others = cross(b - a, c - b)
    common = normalise(np.array(others).cumsum(axis=0)[-1])
    straight = float(bend_angle(a[1:], b[1:], c[1:]).max()) < SHOWN
    return straight or not float(dot(normalise(first), common)) > WITH_OTHERS


def shown_by_all(fingers: Sequence[Sequence[int]], at: Floats) -> Floats | None:
    """The hinge about which all fingers bend a little, unit, (3,); None where they do not agree."""
    found = []
    for finger in (finger for finger in fingers if len(finger) > 2):
        a, b, c = (at[joint] for joint in finger[:3])
        if float(bend_angle(a, b, c)) < SHOWN:
            return None
        found.append(normalise(cross(b - a, c - b)))
    if not found:
        return None
    common = np.array(found).cumsum(axis=0)[-1]
    return normalise(common) if length(common) > 0.9 * len(found) else None
