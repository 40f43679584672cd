"""What a body is does not depend on the unit of its file."""

from __future__ import annotations

from typing import Any

import pytest
from places import one_in
from recognition_bodies.skeletons import (
    FINGERS,
    FLAT,
    HAIR,
    HORSE,
    INSECT,
    MAN,
    SITTING,
    SKIRT,
    THINGS,
    TWISTED,
    Joint,
    rig_with,
)

from rigtri.recognition.layout_output import as_json
from rigtri.recognition.recognise import recognise

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
@pytest.mark.parametrize("body", one_in(2, BODIES))
def test_a_body_is_the_same_in_millimetres_and_in_kilometres(body: str, named: bool) -> None:
    """By powers of two, so that nothing is rounded otherwise."""
    known, points = layout(body, named, 1.0)
    for size in (1 / 1024, 1024):
        found, places = layout(body, named, size)
        assert found == known
        assert places == pytest.approx(points, abs=1e-3)
