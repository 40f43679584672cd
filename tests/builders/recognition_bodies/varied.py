"""Held-out bodies: proportions, poses, orders and extra joints by the numbers of a seed."""

from __future__ import annotations

import numpy as np
from figure import Figure, about

from recognition_bodies.bodies import FINGERS, SIDES, Body, Extra, Places, build, ordered, parents, standing
from rigtri.maths.quaternions import IDENTITY, rotate, unit
from rigtri.maths.trigonometry import Floats

_STANCES = (IDENTITY, about((0, 1, 0), 90), about((0, 1, 0), 180), about((1, 0, 0), -90))
_PARTS = ("leg", "arm", "trunk", "finger", "wide")
_LEAST, _MOST = (0.5, 0.6, 0.7, 0.7, 0.7), (1.4, 1.5, 1.4, 1.3, 1.3)
# How far limbs stand off their usual pose, in degrees.
_SWING = 12.0


def varied(seed: int) -> Body:
    """A person of some proportions in some pose, with what rigs have or have not."""
    random = np.random.default_rng(seed)
    places = standing(arms=random.uniform(-10, 80), fingers=bool(random.random() < 0.6))
    places = _posed(random, _proportioned(random, places))
    missing = _missing(random)
    places = {bone: at for bone, at in places.items() if bone not in missing}
    figure, top, stance = Figure("varied", crooked=float(random.choice([0.0, 0.3, 1.0]))), -1, IDENTITY
    if random.random() < 0.5:
        stance, size = _STANCES[random.integers(4)], float(random.choice([1, 0.01, 100]))
        top = figure.space("above", axes=stance, scale=(size, size, size))
        figure.modelled_in = top
    root = "root" if random.random() < 0.6 else ""
    body = build(places, extras=_extras(random, places), figure=figure, top=top, root=root)
    (said,) = body.said["characters"]
    said |= {word: rotate(stance, np.array(said[word], float)).tolist() for word in ("facing", "up")}
    said["loose"] = [bone for bone in places if any(finger in bone for finger in FINGERS)]
    return body


def _proportioned(random: np.random.Generator, places: Places) -> Places:
    """The same body with longer or shorter limbs and trunk, and broader or narrower."""
    sizes = dict(zip(_PARTS, random.uniform(_LEAST, _MOST), strict=True))
    sizes["wide"] *= sizes["arm"]  # long arms hang on broad shoulders
    above, found = parents(places), dict[str, Floats]()
    for bone in ordered(above):
        parent = above[bone]
        way = places[bone] - places[parent] if parent else places[bone]
        found[bone] = found[parent] + way * sizes[_kind(bone)] if parent else way
    return found


def _kind(bone: str) -> str:
    if bone.endswith(("UpperLeg", "UpperArm", "Shoulder")):
        return "wide"
    if any(finger in bone for finger in FINGERS):
        return "finger"
    if any(word in bone for word in ("Leg", "Foot", "Toes")):
        return "leg"
    return "arm" if any(word in bone for word in ("Arm", "Hand")) else "trunk"


def _posed(random: np.random.Generator, places: Places) -> Places:
    """The same body with its limbs swung, of most bodies both sides alike: rest poses mostly are."""
    above, found = parents(places), dict(places)
    alike = random.random() < 0.7
    for limb in ("UpperArm", "UpperLeg"):
        first = random.normal(0, _SWING, 3)
        other = first * [1, -1, -1] if alike else random.normal(0, _SWING, 3)
        for (side, _), degrees in zip(SIDES, (first, other), strict=True):
            start, swing = side + limb, unit(np.append(np.radians(degrees) / 2, 1.0))
            for bone in found:
                if bone != start and _is_below(above, bone, start):
                    found[bone] = found[start] + rotate(swing, found[bone] - found[start])
    return found


def _is_below(above: dict[str, str], bone: str, other: str) -> bool:
    while bone and bone != other:
        bone = above[bone]
    return bool(bone)


def _missing(random: np.random.Generator) -> set[str]:
    """Bones that this rig does not have."""
    kinds = ((0.3, ["upperChest"]), (0.2, ["neck"]), (0.25, _both("Shoulder")), (0.3, _both("Toes")))
    return {bone for share, bones in kinds if random.random() < share for bone in bones}


def _both(bone: str) -> list[str]:
    return [side + bone for side, _ in SIDES]


def _extras(random: np.random.Generator, places: Places) -> list[Extra]:
    """Ends, twist joints, hair and IK targets, some of them."""
    kinds = [[Extra("head_end", "head", (places["head"] + [0, 0.2, 0]).tolist(), "end")], [], [], []]
    for number in range(4):
        at = places["head"] + [0.08 * number - 0.12, 0.15, -0.08]
        kinds[1].append(Extra(f"hair_{number}", "head", at.tolist(), "attachment"))
    for side, _ in SIDES:
        for upper, lower in (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("UpperLeg", "LowerLeg")):
            name = f"{side}_{upper}_twist"
            kinds[2].append(Extra(name, side + upper, side + lower, "twist", share=0.5))
        kinds[3] += [Extra(f"ik_{side}_{end}", "", side + end, "control") for end in ("Foot", "Hand")]
    return [extra for extras in kinds if random.random() < 0.3 for extra in extras]
