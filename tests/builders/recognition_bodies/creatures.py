"""Hard cases: bodies with other limbs, part of a body, two of them, and things that are no character."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from figure import Figure, about

from recognition_bodies.bodies import (
    SIDES,
    Body,
    Extra,
    build,
    joined,
    parents,
    sitting,
    standing,
    with_truth,
)


def quadruped() -> Body:
    """A dog: four legs, a tail, a head in front; the trunk lies."""
    figure = Figure("dog", crooked=0.3)
    trunk = ("pelvis", (0, 0.62, -0.3)), ("spine1", (0, 0.65, -0.15)), ("spine2", (0, 0.66, 0.02))
    figure.chain(figure.joint("root", -1, (0, 0, 0)), *trunk, ("chest", (0, 0.64, 0.2)))
    figure.chain("chest", ("neck1", (0, 0.72, 0.34)), ("head", (0, 0.86, 0.46)), ("jaw", (0, 0.82, 0.52)))
    figure.chain("pelvis", *((f"tail{k}", (0, 0.64 - 0.03 * k, -0.38 - 0.09 * k)) for k in range(1, 6)))
    parts = {"hips": ["pelvis"], "spine": ["spine1", "spine2", "chest"], "neck": ["neck1"], "head": ["head"]}
    parts["tail"] = [f"tail{k}" for k in range(1, 6)]
    for side, sign in SIDES:
        s, x = side[0].upper(), np.array([sign, 1, 1])
        front = [
            ("scapula", (0.07, 0.68, 0.22)),
            ("upperarm", (0.09, 0.52, 0.3)),
            ("forearm", (0.09, 0.4, 0.18)),
        ]
        front += [("frontpaw", (0.09, 0.1, 0.22)), ("fronttoe", (0.09, 0.03, 0.28))]
        back = [("thigh", (0.08, 0.56, -0.3)), ("shin", (0.1, 0.36, -0.2)), ("hindpaw", (0.1, 0.2, -0.4))]
        back += [("hindfoot", (0.1, 0.06, -0.36)), ("hindtoe", (0.1, 0.02, -0.28))]
        for above, bones in (("chest", front), ("pelvis", back)):
            figure.chain(above, *((f"{name}_{s}", np.array(at) * x) for name, at in bones))
            figure.wrap([f"{name}_{s}" for name, _ in bones], [0.04] * len(bones))
        parts[f"{side} front arm|leg"] = [f"upperarm_{s}", f"forearm_{s}", f"frontpaw_{s}"]
        parts[f"{side} back leg"] = [f"thigh_{s}", f"shin_{s}", f"hindpaw_{s}|hindfoot_{s}"]
    figure.wrap(
        ["pelvis", "spine1", "spine2", "chest", "neck1", "head"],
        [0.14, 0.13, 0.13, 0.15, 0.08, 0.08],
        side=(1, 0, 0),
    )
    loose = [
        "jaw",
        *(
            f"{n}_{s}"
            for s in "LR"
            for n in ("scapula", "frontpaw", "fronttoe", "hindpaw", "hindfoot", "hindtoe")
        ),
    ]
    said = {"form": "quadruped", "facing": [0, 0, 1], "up": [0, 1, 0], "parts": parts, "loose": loose}
    return Body(figure, {"characters": [said]})


def insect() -> Body:
    """Six legs on a thorax, a head in front, an abdomen behind."""
    figure = Figure("insect", crooked=0.3)
    figure.chain(-1, ("thorax", (0, 0.2, 0)), ("head", (0, 0.22, 0.15)))
    figure.chain("thorax", ("abdomen1", (0, 0.21, -0.12)), ("abdomen2", (0, 0.2, -0.26)))
    parts: dict[str, list[str]] = {}
    for place, z in (("front", 0.08), ("middle", 0.0), ("back", -0.08)):
        for side, sign in SIDES:
            s = side[0].upper()
            points = [(0.04, 0.19, z), (0.16, 0.28, z * 1.8), (0.26, 0.1, z * 2.6), (0.32, 0.0, z * 3)]
            names = [f"{place}_leg_{k}_{s}" for k in range(1, 5)]
            figure.chain(
                "thorax", *((n, np.array(p) * [sign, 1, 1]) for n, p in zip(names, points, strict=True))
            )
            figure.wrap(names, [0.015] * 4)
            parts[f"{side} {place} leg"] = [names[0], names[1], f"{names[2]}|{names[3]}"]
    figure.wrap(["abdomen1", "abdomen2"], [0.06] * 3, tip=(0, 0.18, -0.4), side=(1, 0, 0))
    figure.wrap(["thorax", "head"], [0.06] * 3, tip=(0, 0.22, 0.22), side=(1, 0, 0))
    loose = [
        "thorax",
        "head",
        "abdomen1",
        "abdomen2",
        *(f"{p}_leg_{k}_{s}" for p in ("front", "middle", "back") for k in (3, 4) for s in "LR"),
    ]
    said = {"form": "creature", "facing": [0, 0, 1], "up": [0, 1, 0], "parts": parts, "loose": loose}
    return Body(figure, {"characters": [said]})


def dragon() -> Body:
    """A biped with wings on its back and a tail."""
    body = build(standing(fingers=False), root="root")
    figure, parts = body.figure, body.said["characters"][0]["parts"]
    figure.chain("hips", *((f"tail_{k}", (0, 0.92 - 0.1 * k, -0.12 - 0.13 * k)) for k in range(1, 7)))
    parts["tail"] = [f"tail_{k}" for k in range(1, 7)]
    figure.wrap(parts["tail"], [0.05] * 7, tip=(0, 0.25, -1.1), side=(1, 0, 0))
    for side, sign in SIDES:
        points = [(0.08, 1.4, -0.12), (0.45, 1.75, -0.3), (0.95, 1.6, -0.4), (1.4, 1.35, -0.45)]
        names = [f"{side}Wing{k}" for k in range(1, 5)]
        figure.chain(
            "upperChest", *((n, np.array(p) * [sign, 1, 1]) for n, p in zip(names, points, strict=True))
        )
        figure.wrap(names, [0.04] * 4)
        parts[f"{side} wing"] = names
    return with_truth(body, form="creature|biped")


def upper_body() -> Body:
    """A bust with arms and hands: nothing below the spine."""
    places = {
        bone: at for bone, at in standing().items() if "Leg" not in bone and bone[-4:] not in ("Foot", "Toes")
    }
    body = build({bone: at for bone, at in places.items() if bone != "hips"})
    return with_truth(body, form="partial")


def sitter() -> Body:
    return build(sitting(), _blender)


def tpose() -> Body:
    return build(standing(arms=0.0), _blender, root="root")


def mirrored() -> Body:
    """A body under a node that mirrors it: what is called left stands where the right should."""
    figure = Figure("mirrored", crooked=0.3)
    top = figure.space("mirror", scale=(-1, 1, 1))
    figure.modelled_in = top
    body = build(standing(), _blender, figure=figure, top=top)
    body.said["sides"] = "mirrored"
    return body


def scaled() -> Body:
    """A body in centimetres with z up, below a node that makes it metres with y up."""
    figure = Figure("scaled", crooked=0.3)
    top = figure.space("scaled", axes=about((1, 0, 0), -90), scale=(0.01, 0.01, 0.01))
    figure.modelled_in = top
    places = {bone: np.array([x, -z, y]) * 100 for bone, (x, y, z) in standing().items()}
    body = build(places, _blender, figure=figure, top=top, skin=False)
    for s in "LR":
        figure.wrap([f"{bone}.{s}" for bone in ("upper_arm", "forearm", "hand")], [4.0] * 3, side=(0, 1, 0))
        figure.wrap([f"{bone}.{s}" for bone in ("thigh", "shin", "foot")], [6.0] * 3, side=(1, 0, 0))
    figure.wrap(["hips", "spine", "chest", "upperChest", "neck", "head"], [12.0] * 6, side=(1, 0, 0))
    return body


def flat() -> Body:
    """A game rig: hands and feet hang under the root, beside the poles of elbows and knees."""
    places = standing(fingers=False)
    above = {f"{side}{bone}": "" for side, _ in SIDES for bone in ("Hand", "Foot")}
    extras = []
    for side, sign in SIDES:
        s = side[0].upper()
        extras += [
            Extra(f"PoleKnee.{s}", "", (0.1 * sign, 0.5, 0.7), "control"),
            Extra(f"PoleElbow.{s}", "", (0.4 * sign, 1.2, -0.7), "control"),
        ]
    return build(places, _blender, extras=extras, above=above, root="root")


def with_controls() -> Body:
    """Controls beside every bone, twist joints beside limbs, correctives, IK targets: all of them joints."""
    places = standing(fingers=False)
    extras = [Extra("ctrl_master", "", (0, 0, 0), "control"), Extra("ctrl_cog", "", "hips", "control")]
    extras += [
        Extra(f"ctrl_{bone}", parents(places)[bone], bone, "control") for bone in ("spine", "chest", "head")
    ]
    for side, _ in SIDES:
        s = side[0].upper()
        arm, fore, hand = (f"{side}{bone}" for bone in ("UpperArm", "LowerArm", "Hand"))
        thigh, shin, foot = (f"{side}{bone}" for bone in ("UpperLeg", "LowerLeg", "Foot"))
        for upper, lower in ((arm, fore), (fore, hand), (thigh, shin), (shin, foot)):
            name = _blender(upper)[:-2]
            extras.append(Extra(f"{name}_twist_{s}", upper, lower, "twist", share=0.5))
        extras += [
            Extra(f"elbow_fix_{s}", arm, fore, "helper", share=0.97),
            Extra(f"knee_fix_{s}", thigh, shin, "helper", share=0.97),
            Extra(f"ik_hand_{s}", "", hand, "control"),
            Extra(f"ik_foot_{s}", "", foot, "control"),
        ]
    return build(places, _blender, extras=extras, root="root")


def with_leaves() -> Body:
    """Ends of chains as joints of their own, a sword in the hand and hair on the head."""
    places = standing()
    extras = [Extra("head_end", "head", (0, 1.8, 0), "end")]
    for side, sign in SIDES:
        s = side[0].upper()
        extras.append(Extra(f"toe_end.{s}", f"{side}Toes", (0.11 * sign, 0.02, 0.2), "end"))
    extras.append(Extra("sword", "rightHand", places["rightHand"] + [0, 0, 0.3], "attachment"))
    hair = [Extra(f"hair_{k}", "head", (0.03 * k - 0.06, 1.7, -0.1), "attachment") for k in range(5)]
    return build(places, _blender, extras=[*extras, *hair])


def one_armed() -> Body:
    places = standing()
    for bone in list(places):
        if bone.startswith("right") and any(
            w in bone for w in ("Arm", "Hand", "Thumb", "Index", "Middle", "Ring", "Little")
        ):
            del places[bone]
    return build(places, _blender)


def two_characters() -> Body:
    """Two bodies side by side whose joints are called alike."""
    figure = Figure("pair", crooked=0.3)
    bodies = []
    for name, x in (("Anna", -0.8), ("Berta", 0.8)):
        top = figure.space(name)
        places = {bone: at + np.array([x, 0.0, 0.0]) for bone, at in standing(fingers=False).items()}
        body = build(places, lambda bone, name=name: f"{name}_{_blender(bone)}", figure=figure, top=top)
        bodies.append(body)
    return joined(*bodies)


def several_skeletons() -> Body:
    """A body, and a cape and a hat that are skeletons of their own beside it."""
    body = build(standing(), _blender, root="root")
    for k in range(5):
        body.figure.chain(
            -1,
            (f"cape_{k}_1", (0.1 * k - 0.2, 1.4, -0.15)),
            (f"cape_{k}_2", (0.1 * k - 0.2, 1.1, -0.2)),
            (f"cape_{k}_3", (0.1 * k - 0.2, 0.8, -0.24)),
        )
    body.figure.joint("hat", -1, (0, 1.75, 0))
    roles = {"attachment": ["hat", *(f"cape_{k}_{n}" for k in range(5) for n in (1, 2, 3))]}
    return with_truth(body, roles=roles)


def crane() -> Body:
    """A crane: a turntable, a boom of two arms, a cable with a hook. No character."""
    figure = Figure("crane", crooked=0.3)
    figure.chain(
        -1,
        ("base", (0, 0, 0)),
        ("turntable", (0, 1.2, 0)),
        ("boom_arm_1", (0, 2.0, 0.4)),
        ("boom_arm_2", (0, 6.0, 3.0)),
    )
    figure.chain("boom_arm_2", ("cable", (0, 7.0, 8.0)), ("hook", (0, 3.0, 8.0)))
    figure.wrap(["boom_arm_1", "boom_arm_2", "cable"], [0.3] * 3)
    return Body(figure, {"characters": []})


def door() -> Body:
    """A double door with handles: two sides, two chains of two, no character."""
    figure = Figure("door", crooked=0.3)
    figure.joint("frame", -1, (0, 0, 0))
    for s, sign in (("L", 1.0), ("R", -1.0)):
        figure.chain("frame", (f"hinge_{s}", (1.0 * sign, 1.0, 0)), (f"handle_{s}", (0.1 * sign, 1.0, 0.1)))
        figure.wrap([f"hinge_{s}", f"handle_{s}"], [0.1] * 3, tip=(0.05 * sign, 1, 0.1))
    return Body(figure, {"characters": []})


def vehicle() -> Body:
    """A car: four wheels, each on a suspension arm, doors, a steering wheel. No character."""
    figure = Figure("car", crooked=0.3)
    figure.joint("chassis", -1, (0, 0.6, 0))
    for end, z in (("front", 1.3), ("rear", -1.3)):
        for s, sign in (("L", 1.0), ("R", -1.0)):
            figure.chain(
                "chassis",
                (f"{end}_suspension_arm_{s}", (0.4 * sign, 0.45, z)),
                (f"{end}_wheel_{s}", (0.8 * sign, 0.35, z)),
            )
            figure.wrap(
                [f"{end}_suspension_arm_{s}", f"{end}_wheel_{s}"], [0.05, 0.2, 0.2], tip=(0.9 * sign, 0.35, z)
            )
    for s, sign in (("L", 1.0), ("R", -1.0)):
        figure.chain(
            "chassis", (f"door_{s}", (0.85 * sign, 0.8, 0.5)), (f"window_{s}", (0.85 * sign, 1.1, 0.1))
        )
    figure.joint("steering_wheel", "chassis", (0.35, 1.0, 0.4))
    return Body(figure, {"characters": []})


_BLENDER = {"Shoulder": "shoulder", "UpperArm": "upper_arm", "LowerArm": "forearm", "Hand": "hand"}
_BLENDER |= {"UpperLeg": "thigh", "LowerLeg": "shin", "Foot": "foot", "Toes": "toe"}


def _blender(bone: str) -> str:
    """What riggers in Blender call a bone: ``upper_arm.L``, ``index_01.L``."""
    side = next((side for side, _ in SIDES if bone.startswith(side)), "")
    if not side:
        return bone
    own = bone.removeprefix(side)
    if own in _BLENDER:
        return f"{_BLENDER[own]}.{side[0].upper()}"
    for finger in ("Thumb", "Index", "Middle", "Ring", "Little"):
        if own.startswith(finger):
            order = (
                ("Metacarpal", "Proximal", "Distal")
                if finger == "Thumb"
                else ("Proximal", "Intermediate", "Distal")
            )
            return f"{finger.lower()}_{order.index(own.removeprefix(finger)) + 1:02}.{side[0].upper()}"
    raise LookupError(bone)


MADE: dict[str, Callable[[], Body]] = {
    make.__name__: make
    for make in (
        quadruped,
        insect,
        dragon,
        upper_body,
        sitter,
        tpose,
        mirrored,
        scaled,
        flat,
        with_controls,
        with_leaves,
        one_armed,
        two_characters,
        several_skeletons,
        crane,
        door,
        vehicle,
    )
}
