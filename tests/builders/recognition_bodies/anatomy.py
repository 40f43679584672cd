# ruff: noqa: RUF005 - places are arrays, and + adds them
"""Skeletons of every kind by the numbers of a seed, with what their maker says is true of them.

A part is called by words and a side, ``front knee.L``, whatever names the rig will have. y is up, +z ahead,
+x the left, in metres. `words` has the names of parts, `population` gives a file's units, axes and clips.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from figure import about

from recognition_bodies.words import FOUR_LEGS, LEGS, MECHS, TWO_LEGS
from rigtri.maths.quaternions import rotate
from rigtri.maths.trigonometry import Floats

Random = np.random.Generator


@dataclass
class Skeleton:
    """joints: by part the part that it hangs under and its place, parents first. limbs: by ``left front leg``
    start, middle and end, ``a|b`` where either reading is right. others: parts of tails and wings. form: as
    `recognise` has it, "" for no character. words: the words of rigs for parts, one table for each style.
    still: parts that move no points. looks: whether anything but names shows where it faces.
    """

    form: str
    joints: dict[str, tuple[str, Floats]] = field(default_factory=dict)
    limbs: dict[str, tuple[str, ...]] = field(default_factory=dict)
    others: dict[str, tuple[str, ...]] = field(default_factory=dict)
    words: Sequence[dict[str, str]] = ()
    still: set[str] = field(default_factory=set)
    looks: bool = True

    def add(self, part: str, above: str, at: Sequence[float] | Floats) -> None:
        self.joints[part] = (above, np.asarray(at, float))

    def chain(self, above: str, *places: tuple[str, Sequence[float] | Floats]) -> None:
        for part, at in places:
            self.add(part, above, at)
            above = part

    def both(self, above: str, *places: tuple[str, Sequence[float] | Floats]) -> None:
        """A chain on either side, given for the left; ``above`` with a side hangs each at its own."""
        for side, sign in (("L", 1.0), ("R", -1.0)):
            own = f"{above}.{side}" if f"{above}.{side}" in self.joints else above
            self.chain(own, *((f"{part}.{side}", np.asarray(at) * [sign, 1, 1]) for part, at in places))

    def limb(self, name: str, *parts: str) -> None:
        """A limb of either side: ``front leg`` of parts without their sides."""
        for side, word in (("L", "left"), ("R", "right")):
            self.limbs[f"{word} {name}"] = tuple("|".join(f"{k}.{side}" for k in p.split("|")) for p in parts)

    def at(self, part: str) -> Floats:
        return self.joints[part][1]

    def swing(self, part: str, turn: Floats) -> None:
        """Rotate all that hangs below a part about it."""
        centre = self.at(part)
        below = {part}
        for each, (above, at) in self.joints.items():
            if above in below:
                below.add(each)
                self.joints[each] = (above, centre + rotate(turn, at - centre))

    def within(self, name: str, start: str, end: str, share: float) -> None:
        """One more joint within a bone: what ended it hangs at it now."""
        above, at = self.joints[start][1], self.joints[end][1]
        order: dict[str, tuple[str, Floats]] = {}
        for part, (over, place) in self.joints.items():
            if part == end:
                order[name] = (start, above + (at - above) * share)
                over = name
            order[part] = (over, place)
        self.joints = order


def line(
    part: str, start: Sequence[float], step: Sequence[float], count: int, droop: float = 0.0
) -> list[tuple[str, Floats]]:
    """So many joints in a row, ``tail 1`` …, that bend down by ``droop`` each, in radians."""
    at, way, found = np.asarray(start, float), np.asarray(step, float), []
    for k in range(count):
        found.append((f"{part} {k + 1}", at))
        at = at + way
        way = rotate(about((1, 0, 0), -np.degrees(droop)), way)
    return found


def quadruped(random: Random) -> Skeleton:
    """Dog, horse, cat, giraffe or elephant: blade or none, hock or none, short and long necks and tails."""
    body = Skeleton("quadruped", words=FOUR_LEGS)
    tall, long, wide = random.uniform(0.3, 1.6), random.uniform(0.8, 1.6), random.uniform(0.08, 0.16)
    front, back = 0.5 * long * tall, -0.5 * long * tall
    w = wide * tall
    count = int(random.integers(1, 5))
    body.add("hips", "", (0, tall, back))
    spine = [
        (f"spine {k + 1}", (0, tall * (1 + 0.05 * np.sin(k)), back + (front - back) * (k + 1) / (count + 1)))
        for k in range(count)
    ]
    body.chain("hips", *spine)
    chest = f"spine {count}"
    if random.random() < 0.75:
        body.add("chest", chest, (0, tall * 1.02, front - 0.1 * tall))
        chest = "chest"
    neck = random.choice([0.25, 0.45, 0.6, 1.2])
    up = random.uniform(0.2, 1.2)
    pieces = int(random.integers(1, 4 if neck < 1 else 7))
    way = np.array([0, np.sin(up), np.cos(up)]) * neck * tall / pieces
    body.chain(chest, *line("neck", (0, tall * 1.08, front), way, pieces))
    head = body.at(f"neck {pieces}") + way
    body.add("head", f"neck {pieces}", head)
    if random.random() < 0.5:
        body.add("jaw", "head", head + [0, -0.06 * tall, 0.12 * tall])
    if random.random() < 0.4:
        body.both(
            "head",
            ("ear", head + [0.06 * tall, 0.1 * tall, -0.02 * tall]),
            ("ear tip", head + [0.07 * tall, 0.2 * tall, -0.04 * tall]),
        )
    if random.random() < 0.3:
        body.both("head", ("eye", head + [0.05 * tall, 0.03 * tall, 0.1 * tall]))
    tail = random.choice([0.0, 0.2, 0.7, 1.4])
    if tail:
        number = int(random.integers(2, 8))
        step = np.array([0, 0.2 * np.sin(3 * tail), -1]) * tail * tall / number
        body.chain(
            "hips",
            *line("tail", (0, tall, back - 0.1 * tall), step, number, droop=random.uniform(-0.1, 0.25)),
        )
        body.others["tail"] = tuple(f"tail {k + 1}" for k in range(number))
    straight = random.random() < 0.2
    _front_legs(random, body, chest, tall, w, front, straight)
    _hind_legs(random, body, tall, w, back, straight)
    return body


def _front_legs(
    random: Random, body: Skeleton, chest: str, tall: float, w: float, z: float, straight: bool
) -> None:
    blade, carpus, toe = random.random() < 0.6, random.random() < 0.7, random.random() < 0.6
    bend = 0.15 if straight else 1.0
    places = []
    if blade:
        places.append(("blade", (w * 0.6, tall * 1.0, z - 0.06 * tall)))
    places += [
        ("front upper", (w, tall * 0.78, z + 0.1 * bend * tall)),
        ("front lower", (w, tall * 0.55, z - 0.06 * bend * tall)),
    ]
    if carpus:
        places.append(("front foot", (w, tall * 0.27, z + 0.0 * tall)))
        if toe:
            places.append(("front hoof", (w, tall * 0.07, z - 0.01 * bend * tall)))
            if random.random() < 0.3:
                places.append(("front tip", (w, tall * 0.01, z + 0.05 * tall)))
    else:
        places.append(("front foot", (w, tall * 0.07, z + 0.0 * tall)))
        if toe:
            places.append(("front hoof", (w, tall * 0.02, z + 0.08 * tall)))
    body.both(chest, *places)
    body.limb("front leg", "front upper", "front lower", "front foot")


def _hind_legs(random: Random, body: Skeleton, tall: float, w: float, z: float, straight: bool) -> None:
    bend = 0.15 if straight else 1.0
    above = "hips"
    if random.random() < 0.25:
        body.both("hips", ("hip blade", (w * 0.5, tall * 0.97, z - 0.02 * tall)))
        above = "hip blade"
    hip, knee = (w, tall * 0.88, z), (w, tall * 0.56, z + 0.15 * bend * tall)
    if straight or random.random() < 0.25:
        body.both(
            above,
            ("hind upper", hip),
            ("hind lower", (w, tall * 0.48, z + 0.1 * bend * tall)),
            ("hind foot", (w, tall * 0.07, z)),
        )
        end = "hind foot"
    else:
        hock, foot = (w, tall * 0.3, z - 0.17 * tall), (w, tall * 0.06, z - 0.1 * tall)
        body.both(above, ("hind upper", hip), ("hind lower", knee), ("hind hock", hock), ("hind foot", foot))
        end = "hind hock|hind foot"
    if random.random() < 0.6:
        body.both("hind foot", ("hind hoof", body.at("hind foot.L") + [0, -0.04 * tall, 0.09 * tall]))
    body.limb("hind leg", "hind upper", "hind lower", end)


def pawed(random: Random) -> Skeleton:
    """A quadruped with three to five toes, where the last joint of each leg stands."""
    body = quadruped(random)
    count, bones = int(random.integers(3, 6)), int(random.integers(1, 4))
    for which in ("front", "hind"):
        last = next(k for k in ("tip", "hoof", "foot") if f"{which} {k}.L" in body.joints)
        x, y, z = body.at(f"{which} {last}.L")
        wide = 0.3 * x
        for k in range(count):
            aside = wide * (k / (count - 1) - 0.5)
            toe = [
                (
                    f"{which} toe {k} {bone}",
                    (x + aside * (1 + 0.2 * bone), y / (2 + bone), z + wide * (0.5 + 0.4 * bone)),
                )
                for bone in range(bones)
            ]
            body.both(f"{which} {last}", *toe)
    return body


def dinosaur(random: Random) -> Skeleton:
    """Two strong legs with hocks, a trunk that lies, a long tail, small arms or none; or a bird's wings."""
    body = Skeleton("biped", words=TWO_LEGS)
    tall = random.uniform(0.4, 3.0)
    body.add("hips", "", (0, tall, 0))
    pieces = int(random.integers(1, 4))
    tilt = random.uniform(0.0, 0.8)
    way = np.array([0, np.sin(tilt), np.cos(tilt)]) * 0.7 * tall / pieces
    body.chain("hips", *line("spine", way, way, pieces))
    for k in range(pieces):
        body.joints[f"spine {k + 1}"] = (body.joints[f"spine {k + 1}"][0], body.at("hips") + way * (k + 1))
    chest = f"spine {pieces}"
    reach = random.uniform(0.2, 0.8) * tall
    necks = int(random.integers(1, 5))
    step = np.array([0, np.sin(0.8), np.cos(0.8)]) * reach / necks
    body.chain(chest, *line("neck", body.at(chest) + [0, 0.05 * tall, 0.15 * tall], step, necks))
    head = body.at(f"neck {necks}") + step
    body.add("head", f"neck {necks}", head)
    body.add("jaw", "head", head + [0, -0.05 * tall, 0.15 * tall])
    number = int(random.integers(3, 9))
    body.chain(
        "hips",
        *line(
            "tail",
            (0, tall * 0.97, -0.2 * tall),
            np.array([0, 0, -1]) * random.uniform(0.6, 1.8) * tall / number,
            number,
            droop=0.05,
        ),
    )
    body.others["tail"] = tuple(f"tail {k + 1}" for k in range(number))
    w = 0.16 * tall
    body.both(
        "hips",
        ("hind upper", (w, tall * 0.95, 0)),
        ("hind lower", (w, tall * 0.58, 0.28 * tall)),
        ("hind hock", (w, tall * 0.26, -0.1 * tall)),
        ("hind foot", (w, tall * 0.05, 0.05 * tall)),
    )
    if random.random() < 0.7:
        for k, x in enumerate((-0.06, 0.0, 0.06)):
            body.both(
                "hind foot",
                (f"toe {k + 1}", (w + x * tall, 0.02 * tall, 0.18 * tall)),
                (f"toe tip {k + 1}", (w + 1.4 * x * tall, 0.01 * tall, 0.28 * tall)),
            )
    body.limb("leg", "hind upper", "hind lower", "hind hock|hind foot")
    if random.random() < 0.8:
        at, size = body.at(chest), random.uniform(0.1, 0.4) * tall
        places = (
            [("clavicle", at + [0.05 * tall, -0.05 * tall, 0.05 * tall])] if random.random() < 0.4 else []
        )
        places += [
            ("arm upper", at + [0.13 * tall, -0.1 * tall, 0.05 * tall]),
            ("arm lower", at + [0.15 * tall, -0.1 * tall - size, -0.3 * size + 0.05 * tall]),
            ("arm hand", at + [0.14 * tall, -0.1 * tall - 1.3 * size, 0.55 * size + 0.05 * tall]),
        ]
        body.both(chest, *places)
        for k in range(int(random.integers(0, 4))):
            tip = body.at("arm hand.L") + [0.02 * (k - 1) * tall, -0.15 * size, 0.1 * size]
            body.both("arm hand", (f"claw {k + 1}", tip))
        body.limb("arm", "arm upper", "arm lower", "arm hand")
    return body


def bird(random: Random) -> Skeleton:
    """Two legs with hocks, wings of three or four joints, a short tail."""
    body = Skeleton("biped|partial|creature", words=TWO_LEGS)
    tall = random.uniform(0.1, 1.2)
    body.add("hips", "", (0, tall, 0))
    body.chain("hips", ("spine 1", (0, tall * 1.15, 0.15 * tall)), ("spine 2", (0, tall * 1.3, 0.3 * tall)))
    necks = int(random.integers(1, 5))
    step = np.array([0, 0.9, 0.4]) * random.uniform(0.15, 0.9) * tall / necks
    body.chain("spine 2", *line("neck", (0, tall * 1.38, 0.4 * tall), step, necks))
    head = body.at(f"neck {necks}") + step
    body.chain(f"neck {necks}", ("head", head), ("beak", head + [0, -0.03 * tall, 0.15 * tall]))
    body.chain("hips", *line("tail", (0, tall, -0.2 * tall), (0, -0.05 * tall, -0.25 * tall), 2))
    body.others["tail"] = ("tail 1", "tail 2")
    w = 0.12 * tall
    body.both(
        "hips",
        ("hind upper", (w, tall * 0.9, 0.0)),
        ("hind lower", (w, tall * 0.65, 0.18 * tall)),
        ("hind hock", (w, tall * 0.38, -0.12 * tall)),
        ("hind foot", (w, tall * 0.04, 0.0)),
    )
    for k, x in enumerate((-0.08, 0.0, 0.08)):
        body.both("hind foot", (f"toe {k + 1}", (w + x * tall, 0.01 * tall, 0.12 * tall)))
    body.limb("leg", "hind upper", "hind lower", "hind hock|hind foot")
    span, folded = random.uniform(0.6, 2.0) * tall, random.random() < 0.3
    out = np.array([0.3, -0.6, -0.7]) if folded else np.array([1.0, 0.1, -0.1])
    at = np.array([0.1, 1.32, 0.3]) * [tall, tall, tall]
    fore = np.array([0.2, 0.5, 0.6]) if folded else np.array([0.95, -0.05, 0.2])
    places = [
        ("wing 1", at),
        ("wing 2", at + out * 0.35 * span),
        ("wing 3", at + out * 0.35 * span + fore * 0.35 * span),
    ]
    if random.random() < 0.6:
        places.append(("wing 4", places[-1][1] + out * 0.3 * span))
    body.both("spine 2", *places)
    for side, word in (("L", "left"), ("R", "right")):
        body.others[f"{word} wing|arm"] = tuple(f"{part}.{side}" for part, _ in places)
    return body


def mech(random: Random) -> Skeleton:
    """Machines on two legs of three segments, a turret or a cockpit above, guns or arms or nothing beside."""
    body = Skeleton("biped|partial", words=MECHS)
    tall = random.uniform(2, 8)
    body.add("hips", "", (0, tall, 0))
    body.chain("hips", ("torso", (0, tall * 1.15, 0)), ("head", (0, tall * 1.4, 0.1 * tall)))
    w = 0.25 * tall
    body.both(
        "hips",
        ("hind upper", (w, tall * 0.95, 0)),
        ("hind lower", (w, tall * 0.66, 0.25 * tall)),
        ("hind hock", (w, tall * 0.38, -0.22 * tall)),
        ("hind foot", (w, tall * 0.06, 0.0)),
    )
    if random.random() < 0.6:
        body.both("hind foot", ("toe", (w, 0.03 * tall, 0.2 * tall)))
    body.limb("leg", "hind upper", "hind lower", "hind hock|hind foot")
    if random.random() < 0.4:
        body.both(
            "torso", ("gun", (0.4 * tall, 1.25 * tall, 0)), ("muzzle", (0.4 * tall, 1.25 * tall, 0.5 * tall))
        )
    elif random.random() < 0.7:
        body.both(
            "torso",
            ("arm upper", (0.35 * tall, 1.3 * tall, 0)),
            ("arm lower", (0.42 * tall, 1.0 * tall, -0.08 * tall)),
            ("arm hand", (0.42 * tall, 0.72 * tall, 0.1 * tall)),
            ("claw 1", (0.42 * tall, 0.62 * tall, 0.2 * tall)),
        )
        body.limb("arm", "arm upper", "arm lower", "arm hand")
    return body


def many_legs(random: Random, pairs: int) -> Skeleton:
    """An insect (three pairs) or a spider (four): with or without a coxa before the long bones."""
    body = Skeleton("creature", words=[{**way, "pairs": str(pairs)} for way in LEGS])
    size = random.uniform(0.1, 2.0)
    coxa, foot = random.random() < 0.5, random.random() < 0.7
    body.add("thorax", "", (0, 0.5 * size, 0))
    body.add("head", "thorax", (0, 0.52 * size, 0.35 * size))
    if random.random() < 0.6:
        body.both(
            "head",
            ("antenna 1", (0.05 * size, 0.6 * size, 0.45 * size)),
            ("antenna 2", (0.12 * size, 0.8 * size, 0.7 * size)),
            ("antenna 3", (0.16 * size, 0.85 * size, 0.95 * size)),
        )
    body.chain(
        "thorax", ("abdomen 1", (0, 0.5 * size, -0.3 * size)), ("abdomen 2", (0, 0.48 * size, -0.7 * size))
    )
    for k in range(pairs):
        turn = (k / (pairs - 1) - 0.5) * random.uniform(1.4, 2.0)
        out, z = np.array([np.cos(turn), 0.0, -np.sin(turn)]), (0.22 - 0.44 * k / (pairs - 1)) * size
        root = np.array([0.12 * size, 0.45 * size, z])
        start = root + out * (0.12 * size if coxa else 0.0)
        high = start + out * 0.5 * size + [0, 0.35 * size, 0]
        low = high + out * 0.3 * size + [0, -0.65 * size, 0]
        tip = low + out * 0.12 * size + [0, -0.13 * size, 0]
        places = [(f"leg {k + 1} coxa", root)] if coxa else []
        places += [(f"leg {k + 1} upper", start), (f"leg {k + 1} lower", high), (f"leg {k + 1} foot", low)]
        if foot:
            places.append((f"leg {k + 1} tip", tip))
        body.both("thorax", *places)
        end = f"leg {k + 1} foot" + (f"|leg {k + 1} tip" if foot else "")
        body.limb(f"leg{k + 1} leg", f"leg {k + 1} upper", f"leg {k + 1} lower", end)
    return body
