"""Characters by seed, and things that are none: their truth is said by their maker, before recognition.

Sets of one parity share neither numbers nor words with those of the other: `DEVELOPMENT` is to be looked at,
of `JUDGING` only the figures count. Any other even number makes more to look at.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from figure import about
from rigs import rig_of

from recognition_bodies.anatomy import (
    Random,
    Skeleton,
    bird,
    dinosaur,
    many_legs,
    mech,
    pawed,
    quadruped,
)
from recognition_bodies.cases import Case
from recognition_bodies.people import arms_alone, centaur, hand, legs_alone, person
from recognition_bodies.things import fish, furniture, snake, thing
from recognition_bodies.truth import TrueCharacter, TruePart, Truth
from recognition_bodies.words import PLACES, PREFIXES, SIDED, Words
from rigtri.maths.quaternions import multiply, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# So many bodies of each kind are in each set.
KINDS: dict[str, tuple[Callable[[Random], Skeleton], int]] = {
    "person": (person, 40),
    "quadruped": (quadruped, 36),
    "insect": (lambda random: many_legs(random, 3), 8),
    "spider": (lambda random: many_legs(random, 4), 8),
    "dinosaur": (dinosaur, 14),
    "bird": (bird, 10),
    "mech": (mech, 10),
    "centaur": (centaur, 6),
    "arms alone": (arms_alone, 6),
    "legs alone": (legs_alone, 4),
    "hand": (hand, 4),
    "snake": (snake, 4),
    "fish": (fish, 6),
    "thing": (thing, 24),
}
DEVELOPMENT, JUDGING = 0, 1
SETS = ("development", "judging")
_OTHER = {"left": "right", "right": "left"}


def population(which: int, wanted: Callable[[str], bool] = lambda name: True) -> Iterator[Case]:
    """The cases of one of the two sets: of each kind, crowds, companies, animals with paws.

    wanted: by their names; the others are not made.
    """
    for name, make in _makers(which):
        if wanted(name):
            yield make()


def _makers(which: int) -> Iterator[tuple[str, Callable[[], Case]]]:
    number = 0
    for kind, (make, count) in KINDS.items():
        for k in range(count):
            yield f"{kind} {k}", partial(_alone, f"{kind} {k}", make, [which, number], 2 * k + which)
            number += 1
    for k in range(10):
        yield f"crowd {k}", partial(crowd, which, k, number)
    for k in range(10):
        yield f"company {k}", partial(company, which, k, number + 10)
    for k in range(20):
        yield f"furniture {k}", partial(furnished, which, k, number + 20)
    # Numbers of their own, so that what was made before them stays what it was.
    for k in range(24):
        yield f"paws {k}", partial(_alone, f"paws {k}", pawed, [which, k, len(KINDS)], 2 * k + which)


def _alone(name: str, make: Callable[[Random], Skeleton], seed: list[int], style: int) -> Case:
    random = np.random.default_rng(seed)
    return case_of(name, random, [make(random)], style)


def crowd(which: int, k: int, first: int) -> Case:
    """Partial people side by side. first: how many cases come before the crowds of a set."""
    random = np.random.default_rng([which, first + k])
    bodies = [_partial(random, person(random)) for _ in range(int(random.integers(2, 5)))]
    return case_of(f"crowd {k}", random, bodies, 2 * k + which)


def company(which: int, k: int, first: int) -> Case:
    """People, animals and parts of people that one skin moves, their names as Blender makes them differ.

    first: as of `crowd`.
    """
    random = np.random.default_rng([which, first + k])
    makes = (person, person, quadruped, legs_alone)
    bodies = [makes[int(random.integers(4))](random) for _ in range(int(random.integers(2, 4)))]
    return case_of(f"company {k}", random, bodies, 2 * k + which, one_skin=True)


def furnished(which: int, k: int, first: int) -> Case:
    """A piece of furniture or a machine whose parts are called as those of bodies. first: as of `crowd`."""
    random = np.random.default_rng([which, first + k])
    return case_of(f"furniture {k}", random, [furniture(random)], 2 * k + which)


def case_of(name: str, random: Random, bodies: list[Skeleton], style: int, *, one_skin: bool = False) -> Case:
    """A file of bodies side by side. style: which of their words they take. one_skin: that moves them all."""
    turn, size, up = _stance(random)
    names: list[str] = []
    parents: list[int] = []
    places: list[Floats] = []
    still: list[bool] = []
    skins: list[list[int]] = []
    characters = []
    called = _naming(random)
    root = random.random() < 0.5
    moved = []
    for number, body in enumerate(bodies):
        first, row = len(names), dict[str, int]()
        names += ["Armature" if number == 0 else f"Armature.{number:03}"] * root
        parents += [-1] * root
        places += [rotate(turn, np.array([2.5 * number, 0.0, 0.0])) * size] * root
        still += [True] * root
        words = body.words[style % len(body.words)] if body.words else {}
        for part, (above, at) in body.joints.items():
            row[part] = len(names)
            names.append(_name(part, words, called))
            parents.append(row.get(above, first if root else -1))
            crooked = random.normal(0, 0.002, 3) * np.abs(at).max()
            places.append(rotate(turn, at + crooked + [2.5 * number, 0, 0]) * size)
            still.append(part in body.still)
        skins.append(list(range(first + root, len(names))))
        characters.append(_true(body, row, turn, words))
        moved.append((body, row))
    if one_skin:
        skins = [[node for skin in skins for node in skin]]
        before = [names[:k].count(name) for k, name in enumerate(names)]
        names = [f"{name}.{count:03}" if count else name for name, count in zip(names, before, strict=True)]
    rig = _rig(names, parents, np.array(places), np.array(still), skins, up)
    if bodies[0].limbs and random.random() < 0.5:
        rig = replace(rig, clips=(_walk(rig, moved, turn, size, random.random() < 0.5),))
    return Case(SETS[style % 2], name, rig, Truth(name, tuple(c for c in characters if c is not None)))


def _stance(random: Random) -> tuple[Floats, float, tuple[float, float, float]]:
    """How a file turns a body that faces +z with y up, its units for a metre, and what it says is up."""
    size = float(random.choice([1.0, 100.0, 0.01, 39.37]))
    heading = about((0, 1, 0), float(random.choice([0, 0, 0, 180, 90, -90, 37])))
    if random.random() < 0.25:
        return multiply(about((1, 0, 0), 90), heading), size, (0.0, 0.0, 1.0)
    return heading, size, (0.0, 1.0, 0.0)


def _naming(random: Random) -> Callable[[str], str]:
    """How a rig writes the words of a part, ``upper_arm.L``: case, separator, side and prefix."""
    case = str(random.choice(["snake", "camel", "title"]))
    prefix, sided = str(random.choice(PREFIXES)), str(random.choice(SIDED))
    sided = sided if case != "snake" or "Word" not in sided else "{word}_{s}"

    def called(part: str) -> str:
        word, dot, side = part.partition(".")
        pieces = word.split("_")
        if case != "snake":
            word = "".join(piece.title() for piece in pieces)
        if case == "camel":
            word = word[0].lower() + word[1:]
        if not dot:
            return prefix + word
        full = {"L": "left", "R": "right"}[side]
        title = word[0].upper() + word[1:]
        return prefix + sided.format(
            word=word, Word=title, S=side, s=side.lower(), side=full, Side=full.title()
        )

    return called


def _name(part: str, words: Words, called: Callable[[str], str]) -> str:
    """What a rig calls a part: of segments within a bone the bone's name, and what they are."""
    own, dot, side = part.partition(".")
    first, *more = own.split()
    if first == "leg" and more[0].isdigit() and more[-1] in words:  # of many legs
        place = PLACES[int(words["pairs"])][int(more[0]) - 1]
        return called(words[more[-1]].format(k=more[0], place=place) + dot + side)
    if more == ["001"]:
        return called(words.get(first, first) + dot + side) + ".001"
    word = words.get(own) or "_".join([words.get(first, first), *more])
    return called(word + dot + side)


def _true(body: Skeleton, row: dict[str, int], turn: Floats, words: Words) -> TrueCharacter | None:
    """What is true of a body's nodes; None where it is no character.

    A front leg whose bones have the names of an arm's may be called one.
    """
    if not body.form:
        return None
    parts = []
    for name, joints in [*body.limbs.items(), *body.others.items()]:
        kind = name.split()
        side = kind[0] if kind[0] in _OTHER else ""
        # Of a limb without a third joint the end may be left out.
        choices = tuple(frozenset(row[way] if way else -1 for way in joint.split("|")) for joint in joints)
        kinds = tuple(kind[-1].split("|"))
        if "front leg" in name and not {"arm", "elbow"}.isdisjoint(
            words["front upper"].split("_") + words["front lower"].split("_")
        ):
            kinds = ("leg", "arm")
        parts.append(TruePart(name, side, kinds, choices))
    known = {node for part in parts for node in part.nodes}
    facing, up = (tuple(rotate(turn, np.array(v, float)).tolist()) for v in ((0, 0, 1), (0, 1, 0)))
    stands = ((facing, up),) if body.looks else ()
    return TrueCharacter(body.form, tuple(parts), frozenset(set(row.values()) - known), {}, stands)


def _rig(
    names: list[str],
    parents: list[int],
    places: Floats,
    still: Floats,
    skins: list[list[int]],
    up: tuple[float, float, float],
) -> Rig:
    above = np.array(parents)
    offsets = places - np.where(above[:, np.newaxis] >= 0, places[above], 0.0)
    rig = rig_of(names, parents, offsets)
    made = []
    for number, joints in enumerate(skins):
        bind = np.tile(np.eye(4), (len(joints), 1, 1))
        bind[:, 3, :3] = -places[joints]
        weighs = ~still[joints]
        made.append(Skin(f"skin{number}", np.array(joints), bind, weigh=lambda weighs=weighs: weighs))
    return replace(rig, skins=tuple(made), rules=replace(rig.rules, up=up))


def _walk(
    rig: Rig, moved: list[tuple[Skeleton, dict[str, int]]], turn: Floats, size: float, travels: bool
) -> Clip:
    """A walk: limbs swing about the lateral axis, knees bend back and elbows ahead, the body may travel."""
    times, tracks = np.linspace(0.0, 1.0, 9), []
    for body, row in moved:
        for number, (name, joints) in enumerate(body.limbs.items()):
            phase = 2 * np.pi * (times + 0.5 * (number % 2))
            ahead = -1.0 if name.endswith("arm") else 1.0
            if "front" in name:
                ahead = -1.0  # an elbow
            for joint, angles in (
                (joints[0], 25 * np.sin(phase)),
                (joints[1], ahead * (25 + 20 * np.cos(phase))),
            ):
                swing = np.array(
                    [
                        multiply(multiply(turn, about((1, 0, 0), float(a))), turn * [-1, -1, -1, 1])
                        for a in angles
                    ]
                )
                tracks.append(Track(row[joint.split("|")[0]], "rotation", "LINEAR", times, swing))
        if travels:
            top = next(iter(row.values()))
            way = rotate(turn, np.array([0, 0, 1.5])) * size
            tracks.append(
                Track(top, "translation", "LINEAR", times, rig.translation[top] + times[:, np.newaxis] * way)
            )
    return Clip("walk", tuple(tracks))


def _partial(random: Random, body: Skeleton) -> Skeleton:
    """Of a crowd: some bodies lack the ends of their limbs, an arm, or all below the hips."""
    lost: set[str] = set()
    kind = random.random()
    if kind < 0.25:
        lost = {part for part in body.joints if part.startswith(("Hand", "Toes")) and not body.others}
    elif kind < 0.45:
        lost = {"UpperArm.R"}
    elif kind < 0.6:
        lost = {"UpperLeg.L", "UpperLeg.R"}
    for part, (above, _) in body.joints.items():
        if above in lost:
            lost.add(part)
    body.joints = {part: each for part, each in body.joints.items() if part not in lost}
    body.limbs = {
        name: tuple("" if part in lost else part for part in parts)
        for name, parts in body.limbs.items()
        if not lost.intersection(parts[:2])
    }
    body.form = "biped|partial"
    return body
