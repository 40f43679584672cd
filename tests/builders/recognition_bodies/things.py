# ruff: noqa: RUF005 - places are arrays, and + adds them
"""What has no arms and no legs: machines, furniture, plants, snakes and fish, by the numbers of a seed."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from recognition_bodies.anatomy import Random, Skeleton, line


def snake(random: Random) -> Skeleton:
    body = Skeleton("", looks=False)
    body.chain("", *line("spine", (0, 0.1, 1), (0, 0, -0.2), int(random.integers(8, 30))))
    body.add("head", "spine 1", (0, 0.12, 1.2))
    return body


def fish(random: Random) -> Skeleton:
    """A trunk of some joints with one to three pairs of fins and a tail fin."""
    body = Skeleton("partial", looks=False)
    count = int(random.integers(3, 8))
    body.chain("", *line("spine", (0, 0.5, 0.5), (0, 0, -0.2), count))
    body.add("head", "spine 1", (0, 0.5, 0.7))
    for k in range(int(random.integers(1, 4))):
        at = body.at(f"spine {k + 1}") + [0.06, -0.05, 0]
        number = int(random.integers(1, 4))
        body.both(
            f"spine {k + 1}",
            *((f"fin {k + 1} {n}", at + [0.12 * n, -0.08 * n, -0.05 * n]) for n in range(number)),
        )
    body.chain(f"spine {count}", ("tail fin", body.at(f"spine {count}") + [0, 0, -0.3]))
    body.others["tail"] = ("tail fin",)
    return body


def thing(random: Random) -> Skeleton:
    """One of a dozen machines and pieces of furniture, in some proportion."""
    return _made(random, _THINGS)


def _made(random: Random, things: Sequence[Callable[[Skeleton, Random], None]]) -> Skeleton:
    make = things[int(random.integers(len(things)))]
    body = Skeleton("", looks=False)
    make(body, random)
    stretch = random.uniform(0.6, 1.6, 3)
    stretch[0] = stretch[2] = max(stretch[0], 0.7)
    body.joints = {part: (above, at * stretch) for part, (above, at) in body.joints.items()}
    return body


def _car(body: Skeleton, random: Random) -> None:
    body.add("chassis", "", (0, 0.6, 0))
    for end, z in (("front", 1.3), ("rear", -1.3)):
        body.both(
            "chassis",
            (f"{end} suspension arm", (0.3, 0.5, z)),
            (f"{end} axle", (0.6, 0.35, z)),
            (f"{end} wheel", (0.85, 0.35, z)),
        )
    body.both("chassis", ("door", (0.8, 0.8, 0.5)), ("window", (0.85, 1.1, 0.1)))


def _truck(body: Skeleton, random: Random) -> None:
    body.add("chassis", "", (0, 1.0, 0))
    for k in range(int(random.integers(3, 6))):
        body.both(
            "chassis",
            (f"leg axle {k + 1}", (0.6, 0.6, 1.2 * k - 2)),
            (f"wheel {k + 1}", (1.0, 0.5, 1.2 * k - 2)),
        )


def _tank(body: Skeleton, random: Random) -> None:
    body.chain(
        "", ("hull", (0, 1, 0)), ("turret", (0, 1.8, 0)), ("barrel", (0, 1.9, 0.8)), ("muzzle", (0, 1.9, 3))
    )
    for k in range(5):
        body.both(
            "hull",
            (f"swing arm {k + 1}", (1.2, 0.7, 1.5 - 0.7 * k)),
            (f"road wheel {k + 1}", (1.25, 0.4, 1.3 - 0.7 * k)),
        )


def _excavator(body: Skeleton, random: Random) -> None:
    body.chain(
        "",
        ("tracks", (0, 0.5, 0)),
        ("cab", (0, 1.2, 0)),
        ("boom", (0, 1.6, 0.8)),
        ("arm", (0, 4, 3)),
        ("bucket", (0, 2, 5)),
        ("bucket tip", (0, 1.4, 5.2)),
    )
    body.both("tracks", ("track", (1, 0.4, 0)), ("track end", (1, 0.4, 1.5)))


def _table(body: Skeleton, random: Random) -> None:
    body.add("top", "", (0, 1, 0))
    for end, z in (("front", 0.5), ("back", -0.5)):
        body.both(
            "top",
            (f"{end} leg upper", (0.6, 0.95, z)),
            (f"{end} leg lower", (0.6, 0.5, z)),
            (f"{end} leg foot", (0.6, 0.0, z)),
        )


def _chair(body: Skeleton, random: Random) -> None:
    body.add("seat", "", (0, 0.5, 0))
    body.chain("seat", ("back 1", (0, 0.7, -0.25)), ("back 2", (0, 1.0, -0.3)))
    body.both("seat", ("arm rest", (0.3, 0.7, -0.2)), ("arm rest front", (0.32, 0.72, 0.2)))
    for end, z in (("front", 0.25), ("back", -0.25)):
        body.both("seat", (f"{end} leg", (0.25, 0.45, z)), (f"{end} foot", (0.28, 0.0, z)))


def _chandelier(body: Skeleton, random: Random) -> None:
    body.chain("", ("ceiling", (0, 3, 0)), ("rod", (0, 2.4, 0)), ("crown", (0, 2, 0)))
    for k in range(3):
        turn = np.radians(60 * k - 60)
        out = np.array([np.cos(turn), 0, np.sin(turn)])
        body.both(
            "crown",
            (f"arm {k + 1}", out * 0.1 + [0, 2, 0]),
            (f"arm bend {k + 1}", out * 0.5 + [0, 1.8, 0]),
            (f"candle {k + 1}", out * 0.9 + [0, 2.1, 0]),
        )


def _tree(body: Skeleton, random: Random) -> None:
    body.chain("", *line("trunk", (0, 0, 0), (0.02, 1, 0.03), 5))
    for k in range(2, 5):
        reach = random.uniform(0.6, 1.3)
        body.both(
            f"trunk {k}",
            *(
                (f"branch {k} {n}", np.array([0.3 * n * reach + 0.1, k - 1 + 0.25 * n, 0.1 * n]))
                for n in range(1, 4)
            ),
        )


def _crane(body: Skeleton, random: Random) -> None:
    body.chain(
        "",
        ("base", (0, 0, 0)),
        ("mast", (0, 5, 0)),
        ("upper arm", (0, 10, 0)),
        ("fore arm", (0, 10.5, 6)),
        ("hook", (0, 4, 6)),
    )
    body.both(
        "base", ("outrigger 1", (0.5, 0.3, 0.4)), ("outrigger 2", (1.6, 0.35, 0.4)), ("pad", (1.6, 0.0, 0.4))
    )


def _robot_arm(body: Skeleton, random: Random) -> None:
    body.chain(
        "",
        ("base", (0, 0, 0)),
        ("waist", (0, 0.3, 0)),
        ("shoulder", (0.1, 0.6, 0)),
        ("elbow", (0.1, 1.4, 0)),
        ("wrist", (0.8, 1.5, 0)),
        ("tool", (1, 1.5, 0)),
    )
    body.both("tool", ("grip 1", (0.05, 1.45, 0.0)), ("grip 2", (0.05, 1.3, 0.0)))


def _plane(body: Skeleton, random: Random) -> None:
    body.chain("", ("fuselage", (0, 2, 0)), ("nose", (0, 2, 4)))
    body.both("fuselage", ("wing", (0.5, 2, 0)), ("wing mid", (3, 2.2, -0.4)), ("wing tip", (6, 2.5, -0.9)))
    body.both(
        "fuselage", ("gear leg", (1, 1.6, 0)), ("gear strut", (1, 0.9, 0.1)), ("gear wheel", (1, 0.3, 0))
    )
    body.chain("fuselage", ("tail", (0, 2.2, -4)), ("rudder", (0, 3.4, -4.6)))
    body.both("tail", ("elevator", (0.3, 2.3, -4.2)), ("elevator tip", (1.8, 2.4, -4.5)))


def _octopus(body: Skeleton, random: Random) -> None:
    body.chain("", ("mantle", (0, 1, 0)), ("head", (0, 1.3, 0)))
    for k in range(4):
        turn = np.radians(45 * k - 67)
        out = np.array([np.cos(turn), 0, np.sin(turn)])
        body.both(
            "mantle",
            *((f"tentacle {k + 1} {n}", out * (0.15 + 0.25 * n) + [0, 0.9 - 0.08 * n, 0]) for n in range(7)),
        )


def _lamp(body: Skeleton, random: Random) -> None:
    body.chain(
        "",
        ("foot", (0, 0, 0)),
        ("lower arm", (0, 0.1, 0)),
        ("upper arm", (0, 0.6, -0.3)),
        ("shade", (0, 1.0, 0.2)),
        ("bulb", (0, 0.9, 0.35)),
    )


def _curtain(body: Skeleton, random: Random) -> None:
    body.add("rod", "", (0, 3, 0))
    for k in range(1, 4):
        body.both("rod", *((f"cloth {k} {n}", (0.4 * k, 3 - 0.5 * n, 0.05 * n)) for n in range(1, 5)))


def _armchair(body: Skeleton, random: Random) -> None:
    """Its legs and its arms bend, and its back goes up: the front legs may be shorter than those behind."""
    back = random.uniform(0.9, 1.4)
    body.chain("", ("seat", (0, 0.5, 0)), ("back 1", (0, 0.55, -0.2)), ("back 2", (0, 1.0, -0.25)))
    for end, z, size in (("front", 0.2, 1.0), ("back", -0.2, back)):
        places = [(0.2, 0.24 + 0.24 * size, z), (0.22, 0.25, 1.1 * z), (0.23, 0.0, 1.15 * z)]
        body.both("seat", *((f"{end} leg {k}", at) for k, at in enumerate(places, 1)))
    rest = [(0.25, 0.75, -0.2), (0.26, 0.76, 0.0), (0.26, 0.74, 0.2), (0.26, 0.7, 0.24)]
    body.both("back 1", *((f"arm {k}", at) for k, at in enumerate(rest[: int(random.integers(3, 5))], 1)))


def _scales(body: Skeleton, random: Random) -> None:
    body.chain("", ("stand", (0, 0, 0)), ("beam", (0, 1, 0)), ("head", (0, 1.2, 0)))
    body.both("beam", ("arm", (0.1, 1, 0)), ("chain", (0.5, 1, 0)), ("pan", (0.5, 0.5, 0)))


def _signal(body: Skeleton, random: Random) -> None:
    """A mast on four feet with two arms and a lamp on its top."""
    body.chain("", ("base", (0, 0.3, 0)), ("mast", (0, 2, 0)), ("head", (0, 2.4, 0)), ("lamp", (0, 2.6, 0)))
    for k, z in enumerate((0.4, -0.4), 1):
        body.both("base", (f"strut {k}", (0.1, 0.3, 0.2 * z)), (f"foot {k}", (0.5, 0.0, z)))
    body.both(
        "mast",
        ("arm", (0.1, 2, 0)),
        ("lower arm", (0.5, 1.9, 0.02)),
        ("disc", (0.9, 2.0, 0)),
        *((("disc rim", (1.0, 2.0, 0)),) if random.random() < 0.5 else ()),
    )


def _drone(body: Skeleton, random: Random) -> None:
    body.add("hull", "", (0, 1, 0))
    for end, z in (("front", 0.3), ("rear", -0.3)):
        body.both(
            "hull",
            (f"{end} arm", (0.1, 1, 0.3 * z)),
            (f"{end} arm fold", (0.3, 1, 0.8 * z)),
            (f"{end} rotor", (0.5, 1.05, 1.3 * z)),
        )
    body.both("hull", ("skid leg", (0.1, 0.95, 0)), ("skid knee", (0.2, 0.8, 0.05)), ("skid", (0.2, 0.6, 0)))


def _easel(body: Skeleton, random: Random) -> None:
    """Two legs that fold and two arms that hold a picture, below a head."""
    body.chain("", ("hinge", (0, 1.5, 0)), ("board", (0, 1.6, 0.05)), ("head", (0, 2.0, 0.05)))
    body.both("hinge", ("leg", (0.1, 1.4, 0)), ("leg fold", (0.25, 0.7, 0.05)), ("leg tip", (0.4, 0, 0)))
    body.both("board", ("arm", (0.1, 1.6, 0.05)), ("arm fold", (0.3, 1.6, 0.06)), ("clip", (0.5, 1.6, 0.05)))


def furniture(random: Random) -> Skeleton:
    """More of such things, whose parts are called as those of bodies are."""
    return _made(random, _FURNITURE)


_FURNITURE = (_armchair, _armchair, _scales, _signal, _drone, _chair, _table)
_THINGS = (
    _car,
    _truck,
    _tank,
    _excavator,
    _table,
    _chair,
    _chandelier,
    _tree,
    _crane,
    _robot_arm,
    _plane,
    _octopus,
    _lamp,
    _curtain,
)
