"""What the bends of fingers show of the axis about which a hand closes.

Source: docs/presets.md, "One body, one sense".
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import NamedTuple

import numpy as np

from rigtri.maths.angle_limits import cosine_below, radians_below
from rigtri.maths.triangle import bend_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise
from rigtri.recognition.layout import PHALANGES
from rigtri.recognition.thumb_bends import MIRRORED, NATURAL, SHAPE, SIMILAR_BEND, hides

# The first of its four joints or more may be a metacarpal, which is set aside by up to this (radians); it is
# none where its plane is as near as this (a cosine) to that of the others.
SET_ASIDE, WITH_OTHERS = radians_below(30), cosine_below(30)
# Fingers that all bend to one side by more than this (radians) say which side the palm is on.
SHOWN = radians_below(2)
# A finger with a metacarpal that bends by less than this part of what the most bent one does shows how it is
# spread, not how it closes.
HARDLY = 0.25


class Curl(NamedTuple):
    """What the bends of fingers show at rest.

    hinge: that they have in common, unit, (3,). bend: of most of them, radians. agreement: of their own
    hinges, 0 to 1. closes: the cosine between the hinge and that about which they close by their places.
    height: of the middle joints of most of them over the lines between those beside them, file units.
    """

    hinge: Floats
    bend: float = 0.0
    agreement: float = 0.0
    closes: float = 0.0
    height: float = 0.0


def curl_of(fingers: Sequence[Sequence[int]], wrist: int, at: Floats, palm: Floats | None) -> Curl:
    """What the fingers show; those that are straight, or only spread, have no vote.

    at: the places of all nodes, (n, 3). palm: about which they close by their places, unit, (3,).
    """
    shown, most, heights = list[tuple[Floats, bool]](), list[float](), list[float]()
    for finger in fingers:
        triples = list(zip(finger, finger[1:], finger[2:], strict=False))
        if triples:
            a, b, c = (at[[triple[k] for triple in triples]] for k in range(3))
            if len(fingers) < 2 and is_set_aside(a, b, c):
                a, b, c = a[1:], b[1:], c[1:]
            most.append(float(bend_angle(a, b, c).max()))
            across = cross(b - a, c - b)
            span = length(c - a)
            heights.append(float((length(across)[span > 0] / span[span > 0]).max(initial=0.0)))
            plane = normalise(across.cumsum(axis=0)[-1])
            shown.append((plane, _has_metacarpal(finger, wrist, at)))
    least = max(SHOWN, HARDLY * max(most, default=0.0))
    normals = [
        plane
        for bend, (plane, has_metacarpal) in zip(most, shown, strict=True)
        if bend > (least if has_metacarpal else SHOWN)
    ]
    if not normals:
        return Curl(np.full(3, np.nan))
    common = np.nan_to_num(np.array(normals)).cumsum(axis=0)[-1]
    hinge, half = normalise(common), len(most) // 2
    closes = 0.0 if palm is None else float(dot(hinge, palm))
    agreement = float(length(common)) / len(normals)
    return Curl(hinge, sorted(most)[half], agreement, closes, sorted(heights)[half])


def _has_metacarpal(finger: Sequence[int], wrist: int, at: Floats) -> bool:
    """Whether the first joint of a finger is in the palm: it is one of four, or nearer to the wrist."""
    to_first, first = length(at[finger[0]] - at[wrist]), length(at[finger[1]] - at[finger[0]])
    return len(finger) > len(PHALANGES) or bool(first > to_first)


def mean_of_pair(curls: Sequence[Curl]) -> list[Curl]:
    """The same, with the mean numbers of two hands that are bent alike, so that one rule applies to both."""
    if len(curls) != 2 or abs(curls[0].bend - curls[1].bend) > SIMILAR_BEND:
        return list(curls)
    mean = [0.5 * (one + other) for one, other in zip(curls[0][1:], curls[1][1:], strict=True)]
    return [Curl(curl.hinge, *mean) for curl in curls]


def lone_bends_count(curls: Sequence[Curl], asides: Sequence[float | None], noise: float) -> list[bool]:
    """Of hands of one finger each, one or a pair, whether its own bend decides, and not the arm or a thumb.

    asides: by how much each bend turns off what the arm says, radians, mirrored on the right; None where it
    says nothing. noise: of the places of joints along each axis, file units.
    """
    off = [aside for aside in asides if aside is not None]
    is_pair = len(off) == 2 and abs(curls[0].bend - curls[1].bend) <= SIMILAR_BEND
    apart = abs(off[0] - off[1]) if is_pair else 0.0
    mirrored = min(apart, 2.0 * pi - apart) < MIRRORED
    # Twins that bend alike, and are no mirror images, are bent by noise; one alone has none to show it.
    natural = [mirrored if is_pair else aside is None or abs(aside) < NATURAL for aside in asides]
    return [
        not hides(noise, curl.height) and (curl.bend > SHAPE or fits)
        for curl, fits in zip(curls, natural, strict=True)
    ]


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
