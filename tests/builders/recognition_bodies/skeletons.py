"""Skeletons of characters, and of things that are none: joints as (name, name of the one above, place)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from rigs import rig_of

from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

Place = tuple[float, float, float]
Joint = tuple[str, str, Place]


def rig_with(joints: Sequence[Joint], *, named: bool = True) -> Rig:
    """A rig of one skin whose bind pose is its rest pose."""
    row = {name: k for k, (name, _, _) in enumerate(joints)}
    parents = [row.get(above, -1) for _, above, _ in joints]
    places = np.array([place for _, _, place in joints], dtype=np.float64)
    offsets = places - np.where(np.array(parents)[:, np.newaxis] >= 0, places[parents], 0.0)
    names = [name for name, _, _ in joints] if named else [""] * len(joints)
    inverse_bind = np.tile(np.eye(4), (len(joints), 1, 1))
    inverse_bind[:, 3, :3] = -places
    skin = Skin("skin", np.arange(len(joints)), inverse_bind)
    return replace(rig_of(names, parents, offsets), skins=(skin,))


def line(names: str, above: str, *places: Place) -> list[Joint]:
    """Joints one below the other."""
    words = names.split()
    return list(zip(words, [above, *words], places, strict=False))


def without(joints: Iterable[Joint], *words: str) -> list[Joint]:
    """The joints but for those whose names are one of these words before a dot."""
    return [joint for joint in joints if joint[0].partition(".")[0] not in words]


def renamed(
    joints: Iterable[Joint], names: Mapping[str, str], sides: tuple[str, str] = (".L", ".R")
) -> list[Joint]:
    """The joints with other names before the dot, and with ``sides`` behind it for ``.L`` and ``.R``."""

    def new(name: str) -> str:
        part, _, side = name.partition(".")
        return names.get(part, part) + (sides["LR".index(side)] if side else "")

    return [(new(name), new(above), place) for name, above, place in joints]


def both(joints: Iterable[Joint]) -> list[Joint]:
    """Joints of the left, ``.L``, at +x, and their twins."""
    left = list(joints)

    def turned(name: str) -> str:
        return name.replace(".L", ".R")

    return left + [(turned(name), turned(above), (-x, y, z)) for name, above, (x, y, z) in left]


TRUNK = [
    *line(
        "hips spine chest neck head", "", (0, 1, 0), (0, 1.15, 0), (0, 1.3, 0), (0, 1.5, 0), (0, 1.6, 0.02)
    ),
]
ARM = line(
    "clavicle.L upper_arm.L forearm.L hand.L",
    "chest",
    (0.04, 1.45, 0),
    (0.16, 1.45, 0),
    (0.44, 1.45, -0.005),
    (0.7, 1.45, 0),
)
LEG = line(
    "thigh.L shin.L foot.L toe.L",
    "hips",
    (0.1, 0.95, 0),
    (0.1, 0.5, 0.01),
    (0.1, 0.1, -0.02),
    (0.1, 0.03, 0.12),
)
MAN = [*TRUNK, *both([*ARM, *LEG])]
SITTING = [
    *TRUNK,
    *both(
        [
            *ARM,
            *line(
                "thigh.L shin.L foot.L toe.L",
                "hips",
                (0.1, 0.95, 0),
                (0.1, 0.95, 0.45),
                (0.1, 0.53, 0.45),
                (0.1, 0.46, 0.6),
            ),
        ]
    ),
]
# Twist joints stand within the limbs, as in Daz and MMD.
TWISTED = [
    *TRUNK,
    *both(
        [
            *line(
                "clavicle.L upper_arm.L a.L forearm.L b.L hand.L",
                "chest",
                (0.04, 1.45, 0),
                (0.16, 1.45, 0),
                (0.3, 1.45, 0),
                (0.44, 1.45, 0),
                (0.57, 1.45, 0),
                (0.7, 1.45, 0),
            ),
            *line(
                "thigh.L c.L shin.L foot.L toe.L",
                "hips",
                (0.1, 0.95, 0),
                (0.1, 0.72, 0),
                (0.1, 0.5, 0),
                (0.1, 0.1, 0),
                (0.1, 0.03, 0.12),
            ),
        ]
    ),
]
# Five fingers of three joints; the thumb begins beside the wrist and points ahead.
FINGERS = both(
    [
        *line("t1.L t2.L t3.L", "hand.L", (0.71, 1.44, 0.03), (0.73, 1.44, 0.055), (0.745, 1.44, 0.075)),
        *(
            joint
            for k, length in enumerate((0.03, 0.034, 0.031, 0.024))
            for joint in line(
                f"f{k}1.L f{k}2.L f{k}3.L",
                "hand.L",
                *((0.79 + length * step, 1.45, 0.03 - 0.02 * k) for step in range(3)),
            )
        ),
    ]
)
HAIR = both(
    line("h1.L h2.L h3.L h4.L", "head", (0.1, 1.75, 0), (0.25, 1.6, -0.1), (0.3, 1.2, -0.1), (0.3, 0.7, -0.1))
)
SKIRT = both(
    [
        joint
        for k in range(3)
        for joint in line(
            f"s{k}1.L s{k}2.L s{k}3.L",
            "hips",
            (0.12, 0.95, 0.1 - 0.1 * k),
            (0.2, 0.7, 0.15 - 0.15 * k),
            (0.28, 0.4, 0.2 - 0.2 * k),
        )
    ]
)
# All joints hang at the first.
FLAT = [(name, "hips" if above else "", place) for name, above, place in MAN]
HORSE = [
    *line(
        "pelvis spine1 spine2 chest neck head muzzle",
        "",
        (0, 1.4, -0.6),
        (0, 1.45, -0.2),
        (0, 1.45, 0.2),
        (0, 1.4, 0.6),
        (0, 1.8, 0.9),
        (0, 2.2, 1.2),
        (0, 2.0, 1.6),
    ),
    *line("tail1 tail2 tail3", "pelvis", (0, 1.4, -0.9), (0, 1.2, -1.1), (0, 0.9, -1.2)),
    *both(
        [
            *line(
                "thigh.L shin.L foot.L toe.L",
                "pelvis",
                (0.2, 1.25, -0.7),
                (0.2, 0.85, -0.5),
                (0.2, 0.45, -0.75),
                (0.2, 0.08, -0.7),
            ),
            *line(
                "upper_arm.L forearm.L hand.L finger.L",
                "chest",
                (0.2, 1.2, 0.7),
                (0.2, 0.85, 0.55),
                (0.2, 0.42, 0.65),
                (0.2, 0.08, 0.65),
            ),
        ]
    ),
]
INSECT: list[Joint] = [
    *line("thorax head", "", (0, 0.2, 0), (0, 0.22, 0.15)),
    *line("abdomen1 abdomen2", "thorax", (0, 0.21, -0.12), (0, 0.2, -0.26)),
    *both(
        [
            joint
            for place, z in (("front", 0.08), ("middle", 0.0), ("back", -0.08))
            for joint in line(
                " ".join(f"{place}_leg_{k}.L" for k in range(1, 5)),
                "thorax",
                (0.04, 0.19, z),
                (0.16, 0.28, z * 1.8),
                (0.26, 0.1, z * 2.6),
                (0.32, 0.0, z * 3),
            )
        ]
    ),
]
THINGS = {
    "car": [
        ("chassis", "", (0, 0.5, 0)),
        *both([("wheel_front.L", "chassis", (0.8, 0.3, 1.2)), ("wheel_back.L", "chassis", (0.8, 0.3, -1.2))]),
        *both(line("door.L handle.L", "chassis", (0.8, 0.6, 0.3), (0.85, 0.7, -0.2))),
    ],
    "robot arm": [
        *line(
            "base waist a b c d tool",
            "",
            (0, 0, 0),
            (0, 0.3, 0),
            (0.1, 0.6, 0),
            (0.1, 1.4, 0),
            (0.8, 1.5, 0),
            (0.9, 1.5, 0),
            (1, 1.5, 0),
        ),
        ("grip1", "tool", (1.05, 1.5, 0.05)),
        ("grip2", "tool", (1.05, 1.5, -0.05)),
    ],
    "crane": [
        *line("base mast jib line hook", "", (0, 0, 0), (0, 5, 0), (0, 10, 0), (0, 10, 6), (0, 4, 6)),
        *both(line("out1.L out2.L pad.L", "base", (0.5, 0.3, 0), (1.5, 0.3, 0), (1.5, 0, 0))),
    ],
    "table": [
        ("top", "", (0, 1, 0)),
        *both(
            [
                *line("a1.L a2.L", "top", (0.5, 1, 0.5), (0.5, 0, 0.5)),
                *line("b1.L b2.L", "top", (0.5, 1, -0.5), (0.5, 0, -0.5)),
            ]
        ),
    ],
    "tree": [
        *line("t0 t1 t2 t3", "", (0, 0, 0), (0, 1, 0), (0, 2, 0), (0, 3, 0.1)),
        *both(line("b1.L b2.L b3.L", "t1", (0.2, 1.1, 0), (0.6, 1.4, 0.1), (1, 1.8, 0.1))),
        *both(line("c1.L c2.L c3.L", "t2", (0.2, 2.1, 0), (0.5, 2.4, 0.1), (0.8, 2.8, 0.1))),
    ],
    "chain": line("k1 k2 k3 k4 k5 k6 k7", "", *((0.0, float(k), 0.0) for k in range(7))),
}
