"""What a body is does not depend on the unit of its file."""

from __future__ import annotations

from typing import Any

import pytest
from recognition_bodies.skeletons import (
    FINGERS,
    FLAT,
    HAIR,
    HORSE,
    MAN,
    SITTING,
    SKIRT,
    THINGS,
    TWISTED,
    Joint,
    both,
    line,
    rig_with,
)

from rigtri.recognition.layout_output import as_json
from rigtri.recognition.recognise import recognise

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
BODIES: dict[str, list[Joint]] = {
    "man": [*MAN, *FINGERS],
    "sitting": SITTING,
    "twisted": TWISTED,
    "dressed": [*MAN, *HAIR, *SKIRT],
    "flat": FLAT,
    "horse": HORSE,
    "insect": INSECT,
    **THINGS,
}


def layout(body: str, named: bool, size: float) -> tuple[Any, list[float]]:
    """What is recognised of a body, and where its planes of symmetry are, in the body's own unit."""
    places = [(name, above, (x * size, y * size, z * size)) for name, above, (x, y, z) in BODIES[body]]
    rig = rig_with(places, named=named)
    found = as_json(rig, recognise(rig))
    planes = [character["plane"] for character in found["characters"] if character["plane"]]
    return found, [value / size for plane in planes for value in plane.pop("point")]


@pytest.mark.parametrize("named", [True, False], ids=["named", "nameless"])
@pytest.mark.parametrize("body", BODIES)
def test_a_body_is_the_same_in_millimetres_and_in_kilometres(body: str, named: bool) -> None:
    """By powers of two, so that nothing is rounded otherwise."""
    known, points = layout(body, named, 1.0)
    for size in (1 / 1024, 1024):
        found, places = layout(body, named, size)
        assert found == known
        assert places == pytest.approx(points, abs=1e-3)
