"""Characters made for the test, of which we know what they are because we put them together.

A body is a tree of bones, called as in VRM 1.0, at places in metres: y is up, +z forward, +x the left.
`build` gives them the names of a scheme, skin, and whatever else a rig has among its bones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from figure import Figure, about

from rigtri.maths.quaternions import rotate
from rigtri.maths.trigonometry import Floats

SIDES = (("left", 1.0), ("right", -1.0))
FINGERS = {
    "Thumb": ("Metacarpal", "Proximal", "Distal"),
    "Index": ("Proximal", "Intermediate", "Distal"),
    "Middle": ("Proximal", "Intermediate", "Distal"),
    "Ring": ("Proximal", "Intermediate", "Distal"),
    "Little": ("Proximal", "Intermediate", "Distal"),
}
_LIMBS = {
    "arm": ("UpperArm", "LowerArm", "Hand"),
    "leg": ("UpperLeg", "LowerLeg", "Foot"),
}
Places = dict[str, Floats]


@dataclass(frozen=True)
class Extra:
    """A joint that is no bone. below: the bone that it hangs under, "" for the root.

    at: a place, or a bone to stand on, or with ``share`` a place on the way from ``below`` to that bone.
    inside: it stands in the chain, so that the bone at ``at`` hangs under it.
    """

    name: str
    below: str
    at: str | Sequence[float]
    role: str
    share: float = 1.0
    inside: bool = False


@dataclass
class Body:
    """A figure with what is true of it, as ``truth/*.json`` has it, and what its bones are called."""

    figure: Figure
    said: dict[str, Any]
    calls: dict[str, str] = field(default_factory=dict)


def standing(*, arms: float = 40.0, fingers: bool = True) -> Places:
    """Places of a body that stands, its arms so many degrees below the horizontal."""
    places = {
        name: np.array(at, float)
        for name, at in {
            "hips": (0, 0.96, 0),
            "spine": (0, 1.06, 0.012),
            "chest": (0, 1.2, 0.0),
            "upperChest": (0, 1.33, -0.012),
            "neck": (0, 1.47, -0.03),
            "head": (0, 1.56, -0.01),
        }.items()
    }
    for side, sign in SIDES:
        down = rotate(about((0, 0, 1), -arms), np.array([1.0, 0.0, 0.0]))
        bent = rotate(about((0, 1, 0), -8), down)
        wrist = np.array([0.18, 1.43, -0.02]) + down * 0.28 + bent * 0.25
        arm = {
            "Shoulder": np.array([0.04, 1.42, 0.0]),
            "UpperArm": np.array([0.18, 1.43, -0.02]),
            "LowerArm": np.array([0.18, 1.43, -0.02]) + down * 0.28,
            "Hand": wrist,
        }
        leg = {"UpperLeg": (0.095, 0.92, 0), "LowerLeg": (0.1, 0.51, 0.02), "Foot": (0.105, 0.09, -0.015)}
        leg["Toes"] = (0.11, 0.025, 0.12)
        own = arm | {name: np.array(at, float) for name, at in leg.items()}
        if fingers:
            own |= _fingers(wrist, bent)
        places |= {side + name: at * np.array([sign, 1, 1]) for name, at in own.items()}
    return places


def _fingers(wrist: Floats, along: Floats) -> Places:
    found = {}
    for number, (finger, bones) in enumerate(FINGERS.items()):
        if finger == "Thumb":
            at, step = wrist + along * 0.025 + [0, -0.005, 0.025], along * 0.02 + [0, 0, 0.022]
        else:
            at, step = wrist + along * 0.09 + [0, 0, 0.055 - 0.022 * number], along * 0.032
        for bone in bones:
            found[finger + bone] = at
            at = at + step
            step = rotate(about((0, 0, 1), -6), step) * 0.85
    return found


def sitting() -> Places:
    """A body on a chair, its hands in its lap."""
    places = standing()
    for name in list(places):
        places[name] = places[name] - [0, 0.42, 0]
    for side, sign in SIDES:
        for name, at in {
            "UpperLeg": (0.095, 0.5, 0.02),
            "LowerLeg": (0.12, 0.52, 0.43),
            "Foot": (0.12, 0.1, 0.4),
            "Toes": (0.125, 0.03, 0.53),
        }.items():
            places[side + name] = np.array(at) * [sign, 1, 1]
        elbow, wrist = np.array([0.24, 0.76, -0.03]), np.array([0.14, 0.66, 0.19])
        places[f"{side}LowerArm"], places[f"{side}Hand"] = elbow * [sign, 1, 1], wrist * [sign, 1, 1]
        along = (wrist - elbow) / np.sqrt(((wrist - elbow) ** 2).sum())
        places |= {side + n: at * [sign, 1, 1] for n, at in _fingers(wrist, along).items()}
    return places


def parents(places: Mapping[str, Any]) -> dict[str, str]:
    """For each bone the one that it hangs under, "" for the hips; missing ones are passed over."""
    above = {"hips": ""} | dict(_pairs("hips", "spine", "chest", "upperChest", "neck", "head"))
    for side, _ in SIDES:
        arm = ("Shoulder", "UpperArm", "LowerArm", "Hand")
        above |= dict(_pairs("upperChest", *(side + bone for bone in arm)))
        leg = ("UpperLeg", "LowerLeg", "Foot", "Toes")
        above |= dict(_pairs("hips", *(side + bone for bone in leg)))
        for finger, bones in FINGERS.items():
            above |= dict(_pairs(f"{side}Hand", *(side + finger + bone for bone in bones)))
    found = {}
    for bone in places:
        parent = above.get(bone, "")
        while parent and parent not in places:
            parent = above[parent]
        found[bone] = parent
    return found


def _pairs(*names: str) -> Iterator[tuple[str, str]]:
    return zip(names[1:], names, strict=False)


def build(
    places: Places,
    call: Callable[[str], str] | Mapping[str, str] = str,
    *,
    extras: Sequence[Extra] = (),
    figure: Figure | None = None,
    top: int = -1,
    root: str = "",
    above: Mapping[str, str] | None = None,
    skin: bool = True,
) -> Body:
    """A body of bones at their places; bones without a name in ``call`` are left out.

    root: a joint on the ground that all hang under. above: bones that hang under others than usual.
    """
    if isinstance(call, Mapping):
        places = {bone: at for bone, at in places.items() if bone in call}
        calls = {bone: call[bone] for bone in places}
    else:
        calls = {bone: call(bone) for bone in places}
    figure = figure or Figure("body", crooked=0.3)
    if root:
        top = figure.joint(root, top, (0, 0, 0))
    hangs = parents(places) | dict(above or {})
    made: dict[str, int] = {"": top}
    inside = {str(extra.at): [e for e in extras if e.inside and e.at == extra.at] for extra in extras}
    for bone in ordered(hangs):
        parent = made[hangs[bone]]
        for extra in inside.get(bone, ()):
            parent = figure.joint(extra.name, parent, _at(extra, places))
        made[bone] = figure.joint(calls[bone], parent, places[bone])
    for extra in extras:
        if not extra.inside:
            figure.joint(extra.name, made[extra.below], _at(extra, places))
    if skin:
        _dress(figure, calls, inside)
    roles: dict[str, list[str]] = {}
    for extra in extras:
        roles.setdefault(extra.role, []).append(extra.name)
    said: dict[str, Any] = {"form": "biped", "facing": [0, 0, 1], "up": [0, 1, 0], "parts": told(calls)}
    said |= {"roles": {role: names for role, names in roles.items() if role}}
    if root:
        said["parts"]["root"] = [root]
    return Body(figure, {"characters": [said]}, calls)


def ordered(hangs: Mapping[str, str]) -> list[str]:
    """Bones, each after the one that it hangs under."""
    order = [""]
    for bone in order:
        order += [other for other, parent in hangs.items() if parent == bone]
    return order[1:]


def _at(extra: Extra, places: Places) -> Floats:
    if not isinstance(extra.at, str):
        return np.asarray(extra.at, float)
    if not extra.below:
        return places[extra.at]
    return places[extra.below] + (places[extra.at] - places[extra.below]) * extra.share


def told(calls: Mapping[str, str]) -> dict[str, list[str]]:
    """The parts of a body whose bones are called so."""
    parts: dict[str, list[str]] = {}

    def tell(name: str, *bones: str, least: int = 1) -> None:
        has = [calls[bone] for bone in bones if bone in calls]
        if len(has) >= least:
            parts[name] = has

    tell("hips", "hips")
    tell("spine", "spine", "chest", "upperChest")
    tell("neck", "neck")
    tell("head", "head")
    for side, _ in SIDES:
        for limb, bones in _LIMBS.items():
            tell(f"{side} {limb}", *(side + bone for bone in bones), least=3)
        tell(f"{side} foot", f"{side}Foot", f"{side}Toes", least=2)
        for finger, bones in FINGERS.items():
            tell(f"{side} {finger.lower()} finger", *(side + finger + bone for bone in bones))
    return parts


def _dress(figure: Figure, calls: Mapping[str, str], inside: Mapping[str, Sequence[Extra]]) -> None:
    """Tubes of skin around trunk and limbs; joints inside their chains have a share of it."""

    def chain(*bones: str) -> list[str]:
        names = []
        for bone in bones:
            if bone in calls:
                names += [extra.name for extra in inside.get(bone, ())] + [calls[bone]]
        return names

    def tube(joints: Sequence[str], radius: float, *, over: Sequence[float]) -> None:
        if joints:
            tip = figure.at(joints[-1]) + np.asarray(over, float)
            figure.wrap(joints, [radius] * (len(joints) + 1), side=(0, 0.3, 1), tip=tip)

    tube(chain("hips", "spine", "chest", "upperChest"), 0.15, over=(0, 0.08, 0))
    tube(chain("neck", "head"), 0.07, over=(0, 0.2, 0.03))
    for side, sign in SIDES:
        tube(
            chain(*(side + bone for bone in ("Shoulder", "UpperArm", "LowerArm", "Hand"))),
            0.04,
            over=(0.08 * sign, 0, 0.02),
        )
        tube(
            chain(*(side + bone for bone in ("UpperLeg", "LowerLeg", "Foot", "Toes"))),
            0.06,
            over=(0, 0, 0.08),
        )
        for finger, bones in FINGERS.items():
            tube(chain(*(side + finger + bone for bone in bones)), 0.009, over=(0.02 * sign, 0, 0.005))


def joined(*bodies: Body) -> Body:
    """What is true of several bodies of one figure."""
    characters = [character for body in bodies for character in body.said["characters"]]
    return Body(bodies[0].figure, {"characters": characters})


def with_truth(body: Body, **changes: Any) -> Body:
    """A body of whose only character something else is true."""
    (character,) = body.said["characters"]
    return replace(body, said=body.said | {"characters": [character | changes]})
