# ruff: noqa: RUF005 - places are arrays, and + adds them
"""People by the numbers of a seed, with twist joints, hair and what they carry; and parts of people."""

from __future__ import annotations

import numpy as np

from recognition_bodies.anatomy import Random, Skeleton, line, quadruped
from recognition_bodies.bodies import ordered, parents, sitting, standing
from recognition_bodies.varied import _posed, _proportioned
from recognition_bodies.words import PEOPLE

_SIDES = {"left": "L", "right": "R"}
_BONES = (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"))


def _part(bone: str) -> str:
    for side, letter in _SIDES.items():
        if bone.startswith(side):
            return f"{bone.removeprefix(side)}.{letter}"
    return bone


def person(random: Random) -> Skeleton:
    """A person of some proportions in some pose, with what games, films and VRM hang at them."""
    arms = float(random.choice([0.0, 40.0, 75.0]))
    places = sitting() if random.random() < 0.1 else standing(arms=arms, fingers=bool(random.random() < 0.5))
    places = _posed(random, _proportioned(random, places))
    lost = {"upperChest"} if random.random() < 0.4 else set()
    lost |= {f"{side}Shoulder" for side in _SIDES} if random.random() < 0.2 else set()
    lost |= {f"{side}Toes" for side in _SIDES} if random.random() < 0.3 else set()
    places = {bone: at for bone, at in places.items() if bone not in lost}
    body = Skeleton("biped", words=PEOPLE)
    above = parents(places)
    for bone in ordered(above):
        body.add(_part(bone), _part(above[bone]), places[bone])
    body.limb("arm", "UpperArm", "LowerArm", "Hand")
    body.limb("leg", "UpperLeg", "LowerLeg", "Foot")
    _twists(random, body)
    _worn(random, body)
    return body


def _twists(random: Random, body: Skeleton) -> None:
    """Segments within bones or beside them, called as rigs call them."""
    way = int(random.integers(0, 7))
    for upper, lower in _BONES if way < 4 else ():
        for side in "LR":
            start, end = f"{upper}.{side}", f"{lower}.{side}"
            if way == 0:  # Rigify's DEF- chains: the name of the bone again, with a number
                body.within(f"{upper} 001.{side}", start, end, 0.5)
            elif way == 1:
                body.within(f"{upper} twist.{side}", start, end, 0.55)
            elif way == 2:
                body.within(f"{upper} roll 1.{side}", start, end, 0.33)
                body.within(f"{upper} roll 2.{side}", f"{upper} roll 1.{side}", end, 0.5)
            else:
                at = body.at(start) + (body.at(end) - body.at(start)) * 0.5
                body.add(f"{upper} twist 01.{side}", start, at)


def _worn(random: Random, body: Skeleton) -> None:
    """Hair, skirts, tails, wings, weapons, controls: some of them."""
    head, hips = body.at("head"), body.at("hips")
    if random.random() < 0.3:
        for k, x in enumerate((-0.06, 0.0, 0.06)):
            body.chain(
                "head",
                *((f"hair {k + 1} {n}", head + [x, 0.1 - 0.12 * n, -0.1 - 0.02 * n]) for n in range(1, 5)),
            )
    if random.random() < 0.2:
        body.both(
            "head", *((f"hair side {n}", head + [0.1 + 0.02 * n, 0.1 - 0.2 * n, -0.02]) for n in range(1, 5))
        )
    if random.random() < 0.25:
        for k, z in enumerate((0.12, -0.12)):
            body.both(
                "hips",
                *(
                    (f"skirt {k + 1} {n}", hips + [0.1 + 0.05 * n, 0.05 - 0.2 * n, z * (1 + 0.3 * n)])
                    for n in range(1, 4)
                ),
            )
    if random.random() < 0.2:
        body.chain("hips", *line("tail", hips + [0, 0, -0.1], (0, -0.03, -0.14), 6))
        body.others["tail"] = tuple(f"tail {k + 1}" for k in range(6))
    if random.random() < 0.15:
        chest = body.joints["neck"][0]
        at = body.at(chest) + [0.05, 0.1, -0.1]
        body.both(
            chest,
            ("wing 1", at),
            ("wing 2", at + [0.5, 0.4, -0.1]),
            ("wing 3", at + [1.1, 0.3, -0.15]),
            ("wing 4", at + [1.6, -0.1, -0.2]),
        )
        for side, word in (("L", "left"), ("R", "right")):
            body.others[f"{word} wing|limb"] = tuple(f"wing {k}.{side}" for k in range(1, 5))
    if random.random() < 0.4:
        for side in "LR" if random.random() < 0.5 else "R":
            hand = body.at(f"Hand.{side}")
            body.chain(
                f"Hand.{side}",
                (f"weapon.{side}", hand + [0, -0.02, 0.08]),
                (f"weapon tip.{side}", hand + [0, 0.0, 0.9]),
            )
    if random.random() < 0.3:
        for side in "LR":
            body.add(f"ik hand.{side}", "", body.at(f"Hand.{side}"))
            body.add(f"ik foot.{side}", "", body.at(f"Foot.{side}"))
            body.add(f"knee pole.{side}", "", body.at(f"LowerLeg.{side}") + [0, 0, 0.6])
            body.still |= {f"ik hand.{side}", f"ik foot.{side}", f"knee pole.{side}"}


def centaur(random: Random) -> Skeleton:
    """A person's trunk and arms on a horse's body."""
    horse = quadruped(random)
    tops = [part for part in horse.joints if part.startswith(("neck", "head", "jaw", "ear", "eye"))]
    horse.joints = {part: each for part, each in horse.joints.items() if part not in tops}
    horse.words = [
        {**table, "UpperArm": "upper_arm", "LowerArm": "forearm", "Hand": "hand"}
        for table in horse.words
        if "upper_arm" not in table.values()
    ]
    chest = next(part for part in reversed(horse.joints) if part == "chest" or part.startswith("spine"))
    chest = "chest" if "chest" in horse.joints else chest
    at, tall = horse.at(chest), float(horse.at("hips")[1])
    top = at + [0, 0.1 * tall, 0.25 * tall]
    horse.chain(
        chest,
        ("waist", top),
        ("torso", top + [0, 0.25 * tall, 0]),
        ("neck", top + [0, 0.45 * tall, 0]),
        ("head", top + [0, 0.55 * tall, 0.02 * tall]),
    )
    down = random.uniform(0.0, 1.2)
    way = np.array([np.cos(down), -np.sin(down), 0.0]) * 0.25 * tall
    places = [("clavicle", top + [0.03 * tall, 0.4 * tall, 0])] if random.random() < 0.5 else []
    start = top + [0.13 * tall, 0.4 * tall, 0]
    horse.both(
        "torso",
        *places,
        ("UpperArm", start),
        ("LowerArm", start + way + [0, 0, -0.01 * tall]),
        ("Hand", start + 2 * way),
    )
    horse.limb("arm", "UpperArm", "LowerArm", "Hand")
    horse.form = "creature|quadruped"
    return horse


def arms_alone(random: Random) -> Skeleton:
    """What a player sees of themselves: two arms, sometimes on a chest."""
    body = person(random)
    keep = {"Shoulder", "UpperArm", "LowerArm", "Hand", "Thumb", "Index", "Middle", "Ring", "Little"}
    kept = {part for part in body.joints if part.startswith(tuple(keep))}
    first = next(iter(body.joints))
    joints = {first: body.joints[first]}
    for part, (above, at) in body.joints.items():
        if part in kept:
            joints[part] = (above if above in joints else first, at)
    body.joints, body.others, body.still = joints, {}, set()
    body.limbs = {name: parts for name, parts in body.limbs.items() if name.endswith("arm")}
    body.form, body.looks = "partial", False
    return body


def legs_alone(random: Random) -> Skeleton:
    """A lower body."""
    body = person(random)
    kept = {
        part
        for part in body.joints
        if part.startswith(("UpperLeg", "LowerLeg", "Foot", "Toes", "hips", "spine"))
    }
    body.joints = {part: each for part, each in body.joints.items() if part in kept}
    body.limbs = {name: parts for name, parts in body.limbs.items() if name.endswith("leg")}
    body.others, body.still = {}, set()
    body.form, body.looks = "partial|biped", False
    return body


def hand(random: Random) -> Skeleton:
    """One hand, its fingers and perhaps the forearm."""
    body = person(random)
    while "IndexProximal.L" not in body.joints:
        body = person(random)
    fingers = ("Thumb", "Index", "Middle", "Ring", "Little")
    first = "Hand.L"
    joints = {}
    if random.random() < 0.5:
        joints["LowerArm.L"] = ("", body.at("LowerArm.L"))
    joints[first] = ("LowerArm.L" if joints else "", body.at(first))
    joints |= {
        part: each for part, each in body.joints.items() if part.startswith(fingers) and part.endswith(".L")
    }
    body.joints, body.limbs, body.others, body.still = joints, {}, {}, set()
    body.form, body.looks = "hand|partial", False
    return body
