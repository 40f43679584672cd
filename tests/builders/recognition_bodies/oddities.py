# ruff: noqa: RUF005 - places are arrays, and + adds them
"""Bodies and things in which recognition has gone wrong before, by the numbers of a seed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from figure import about

from recognition_bodies.anatomy import Random, Skeleton, dinosaur, mech
from recognition_bodies.cases import Case
from recognition_bodies.people import person
from recognition_bodies.population import case_of
from recognition_bodies.words import PEOPLE

_BONES = (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"))
# As Advanced Skeleton calls them.
_PARTED = {
    "hips": "root",
    "Shoulder": "scapula",
    "UpperArm": "shoulder",
    "LowerArm": "elbow",
    "Hand": "wrist",
    "UpperLeg": "hip",
    "LowerLeg": "knee",
    "Foot": "ankle",
    "Toes": "toes",
}


def numbered(seed: int) -> Case:
    """A person whose limbs are bones that Blender has duplicated: ``arm.L``, ``arm.L.001``, ``arm.L.002``."""
    random = np.random.default_rng([20, seed])
    body = person(random)
    words = dict(PEOPLE[1])
    for limb, (upper, lower, end) in (
        ("arm", ("UpperArm", "LowerArm", "Hand")),
        ("leg", ("UpperLeg", "LowerLeg", "Foot")),
    ):
        words |= {upper: limb, lower: f"{limb}#1", end: f"{limb}#2"}
    body.words = [words]
    case = case_of(f"numbered {seed}", random, [body], 0)
    names = tuple(
        next((name.replace(f"#{k}", "") + f".00{k}" for k in (1, 2) if f"#{k}" in name), name)
        for name in case.rig.names
    )
    return replace(case, rig=replace(case.rig, names=names))


def parted(seed: int) -> Case:
    """A person whose bones are parted in line, ``Shoulder_R``, ``ShoulderPart1_R``, ``Elbow_R``."""
    random = np.random.default_rng([21, seed])
    body, count, words = person(random), 1 + seed % 3, dict(_PARTED)
    for upper, lower in _BONES:
        for side in "LR":
            last = f"{upper}.{side}"
            for k in range(count):
                part = f"{upper} part{k + 1}.{side}"
                body.within(part, last, f"{lower}.{side}", 1 / (count + 1 - k))
                last = part
        words |= {f"{upper} part{k + 1}": f"{words[upper]}Part{k + 1}" for k in range(count)}
    body.words = [words]
    return case_of(f"parted {seed}", random, [body], 0)


def bladed(seed: int) -> Case:
    """A dinosaur whose small arms begin with shoulder blades, short or longer than an upper arm."""
    random = np.random.default_rng([22, seed])
    body = dinosaur(random)
    while "left arm" not in body.limbs:
        body = dinosaur(random)
    tall = float(body.at("hips")[1])
    upper = body.at("arm lower.L") - body.at("arm upper.L")
    size = (0.3 + (seed % 5) * 0.2) * float(np.sqrt(upper @ upper))
    for side, sign in (("L", 1.0), ("R", -1.0)):
        if f"clavicle.{side}" not in body.joints:
            body.within(f"clavicle.{side}", body.joints[f"arm upper.{side}"][0], f"arm upper.{side}", 0.5)
        way = np.array([-0.25 * sign, 0.55, -0.8] if seed % 3 else [-0.6 * sign, 0.6, 0.0])
        place = body.at(f"arm upper.{side}") + way * size
        place[0] = sign * max(sign * place[0], 0.02 * tall)
        body.joints[f"clavicle.{side}"] = (body.joints[f"clavicle.{side}"][0], place)
    return case_of(f"bladed {seed}", random, [body], seed)


def armed(seed: int) -> Case:
    """A machine on two legs with guns of three or four joints beside its turret, and no arms."""
    random = np.random.default_rng([23, seed])
    body = _bare_mech(random)
    tall = float(body.at("hips")[1])
    long = random.uniform(0.3, 0.8) * tall
    start = np.array([random.uniform(0.3, 0.5) * tall, 1.25 * tall, 0.0])
    way = np.array([0.0, -random.uniform(0.0, 0.1), 1.0]) * long
    places = [("gun", start), ("barrel", start + 0.5 * way), ("muzzle", start + way)]
    body.both("torso", *([("mount", start - [0.15 * tall, 0, 0])] if seed % 2 else []), *places)
    return case_of(f"armed {seed}", random, [body], seed)


def clawed(seed: int) -> Case:
    """A machine on two legs with one claw arm in the middle, and no head."""
    random = np.random.default_rng([24, seed])
    body = _bare_mech(random)
    del body.joints["head"]
    tall, at, places = float(body.at("hips")[1]), body.at("torso") + [0, 0.1, 0.1], []
    for k, (up, ahead) in enumerate(((0.35, 0.3), (-0.1, 0.5), (-0.35, 0.2))):
        places.append((f"claw arm {k + 1}", at))
        at = at + np.array([0, up, ahead]) * tall * random.uniform(0.7, 1.3)
    body.chain("torso", *places)
    for k, x in enumerate((-0.05, 0.05)):
        tip = at + [x * tall, 0, 0]
        body.chain("claw arm 3", (f"claw {k} 1", tip), (f"claw {k} 2", tip + [0, -0.08 * tall, 0]))
    return case_of(f"clawed {seed}", random, [body], seed)


def _bare_mech(random: Random) -> Skeleton:
    body = mech(random)
    while {"gun.L", "arm upper.L"} & body.joints.keys():
        body = mech(random)
    return body


def toon(seed: int) -> Case:
    """A figure of few joints with short straight legs, whose feet slope and are as long as these."""
    random = np.random.default_rng([27, seed])
    body = Skeleton("biped", words=PEOPLE)
    leg, trunk, slope = random.uniform(0.15, 0.4), random.uniform(0.25, 0.5), random.uniform(0.2, 0.95)
    foot = leg * random.uniform(0.8, 1.3) * np.array([0.0, -np.sin(slope), np.cos(slope)])
    low = 0.01 - foot[1]
    hip, top = low + leg, low + leg + trunk
    body.chain("", ("hips", (0, hip, 0)), ("spine", (0, top, random.normal(0, 0.01))))
    body.chain("spine", ("neck", (0, top + 0.08, -0.01)), ("head", (0, top + 0.14, 0)))
    drop, start = float(random.choice([0.0, 0.5, 1.0, 1.4])), np.array([0.14, top + 0.02, 0.0])
    arm = random.uniform(0.17, 0.35) * np.array([np.cos(drop), -np.sin(drop), 0.0])
    elbow = start + 0.5 * arm - [0, 0, random.uniform(-0.005, 0.015)]
    body.both("spine", ("UpperArm", start), ("LowerArm", elbow), ("Hand", start + arm))
    ankle, knee = np.array([0.09, low, 0.0]), low + leg * random.uniform(0.4, 0.6)
    legs = [("UpperLeg", (0.09, hip, 0)), ("LowerLeg", (0.09, knee, 0.03 * leg * random.normal()))]
    share = random.uniform(0.5, 1.0)
    tip = [("Toe tip", ankle + foot)] if seed % 2 else []
    body.both("hips", *legs, ("Foot", ankle), ("Toes", ankle + share * foot), *tip)
    body.limb("arm", "UpperArm", "LowerArm", "Hand")
    body.limb("leg", "UpperLeg", "LowerLeg", "Foot")
    return case_of(f"toon {seed}", random, [body], seed)


def stretched(seed: int) -> Case:
    """A person who sits with straight legs ahead, in a file that has y for up; half of them have z."""
    random = np.random.default_rng([25, seed])
    body = person(random)
    while not _may_stretch(body):
        body = person(random)
    for side in "LR":
        body.swing(f"UpperLeg.{side}", about((1, 0, 0), -90 + seed % 3 * 3))
    case = case_of(f"stretched {seed}", random, [body], seed)
    return replace(case, rig=replace(case.rig, clips=(), rules=replace(case.rig.rules, up=(0.0, 1.0, 0.0))))


def _may_stretch(body: Skeleton) -> bool:
    """Whether a body stands on feet with toes and has arms that hang.

    With arms ahead it would be an animal, with arms aside one who bows, in a file whose up is its own.
    """
    hands = [body.at(f"Hand.{side}") - body.at(f"UpperArm.{side}") for side in "LR"]
    stands = body.at("UpperLeg.L")[1] - body.at("LowerLeg.L")[1] > 0.2
    hang = all(way[2] < 0.3 * -way[1] and -way[1] > 0.6 * np.linalg.norm(way) for way in hands)
    return "Toes.L" in body.joints and bool(stands) and hang


def symmetric(seed: int) -> Case:
    """A lamp, a door, chains or a crane with two pairs of three joints, mirrored or turned by half a turn."""
    random = np.random.default_rng([26, seed])
    body = Skeleton("", looks=False)
    (_lamp, _door, _chains, _crane)[seed % 4](body, random)
    if random.random() < 0.5:
        body.joints = {
            part: (above, at * [1, 1, -1] if part.endswith(".R") else at)
            for part, (above, at) in body.joints.items()
        }
    return case_of(f"symmetric {seed}", random, [body], 0)


def _lamp(body: Skeleton, random: Random) -> None:
    high, wide, z = random.uniform(0.8, 2.5), random.uniform(0.2, 0.7), random.uniform(-0.1, 0.1)
    body.chain("", ("post", (0, 0, 0)), ("post top", (0, high, 0)), ("finial", (0, 1.15 * high, 0)))
    body.both(
        "post top",
        ("bracket", (0.05, high, 0)),
        ("bracket bend", (0.05 + wide, high + 0.3 * wide, z)),
        ("shade", (0.05 + 1.8 * wide, high + random.uniform(-0.4, 0.5) * wide, 0)),
    )
    foot = random.uniform(0.15, 0.5)
    body.both(
        "post", ("foot a", (0.03, -0.02, 0)), ("foot b", (0.6 * foot, -0.1, z)), ("foot c", (foot, -0.4, 0))
    )


def _door(body: Skeleton, random: Random) -> None:
    high, wide, z = random.uniform(1.5, 3), random.uniform(0.6, 1.5), random.uniform(-0.3, 0.3)
    body.chain("", ("frame", (0, 0, 0)), ("lintel", (0, high, 0)))
    handle = [("handle", (0.08, 0.45 * high, 0.1))] if random.random() < 0.6 else []
    panel = [("hinge", (wide, 0.1 * high, 0)), ("panel", (0.5 * wide, 0.12 * high, z))]
    body.both("frame", *panel, ("edge", (0.05, 0.1 * high, 0)), *handle)
    rail = [("rail", (wide, high, 0)), ("slider", (0.55 * wide, 1.02 * high, -z)), ("stop", (0.1, high, 0))]
    body.both("lintel", *rail)


def _chains(body: Skeleton, random: Random) -> None:
    high, count, x = random.uniform(2, 4), int(random.integers(3, 7)), random.uniform(0.2, 1)
    body.chain("", ("ground", (0, 0, 0)), ("mast", (0, 0.5 * high, 0)), ("beam", (0, high, 0)))
    links = [(x + 0.02 * np.sin(2 * k), high * (0.98 - 0.8 * k / count), 0.03) for k in range(count)]
    body.both("beam", *((f"link {k}", at) for k, at in enumerate(links)))
    anchors = [(0.5 * x + 0.1 * k, -0.2 * k - 0.05, 0.02 * k) for k in range(3)]
    body.both("ground", *((f"anchor {k}", at) for k, at in enumerate(anchors)))


def _crane(body: Skeleton, random: Random) -> None:
    high, wide, z = random.uniform(3, 9), random.uniform(0.6, 1.6), random.uniform(-0.2, 0.2)
    body.chain("", ("base", (0, 1, 0)), ("tower", (0, 0.6 * high, 0)), ("cab", (0, high, 0)))
    knee = [("outrigger", (0.4, 0.9, 0)), ("outrigger bend", (0.4 + 0.5 * wide, 0.6, z))]
    body.both("base", *knee, ("pad", (0.4 + wide, 0, 0)))
    long, drop = random.uniform(1, 4), random.uniform(-0.6, 0.3)
    jib = [("jib", (0.3, high, 0)), ("jib bend", (0.3 + long, high + 0.1 * long, -z))]
    body.both("cab", *jib, ("jib end", (0.3 + 2 * long, high + drop * long, 0)))
