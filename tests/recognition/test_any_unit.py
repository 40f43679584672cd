"""What a body is does not depend on the unit of its file, nor on where it stands."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from numpy.testing import assert_allclose
from places import one_in
from posed_bodies import Pose, posed_body
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

from rigtri import orient_joints
from rigtri.maths.matrices import inverse
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


def layout(
    body: str, named: bool, size: float, away: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> tuple[Any, list[float]]:
    """What is recognised of a body, and where its planes of symmetry are, in the body's own unit."""
    places = [
        (name, above, tuple(size * (part + more) for part, more in zip(at, away, strict=True)))
        for name, above, at in BODIES[body]
    ]
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


@pytest.mark.parametrize("named", [True, False], ids=["named", "nameless"])
@pytest.mark.parametrize("body", BODIES)
def test_a_body_is_the_same_wherever_it_stands(body: str, named: bool) -> None:
    known, _ = layout(body, named, 1.0)
    found, _ = layout(body, named, 1.0, (8.0, -16.0, 4.0))
    assert found == known


@pytest.mark.parametrize(
    "pose",
    [
        Pose(arms=10.0, curl=20.0),
        Pose("none", arms=80.0, palm=30.0, thumb=False),
        Pose(arms=40.0, elbow=25.0, knee=20.0, hunch=15.0, metacarpals=True),
        Pose("none", seated=70.0, forward=40.0, elbow=15.0, fingers=2),
        Pose(arms=60.0, fingers=0, yaw=35.0, stride=20.0),
        Pose("none", arms=90.0, forward=90.0, fingers=2, phalanges=1, thumb=False),
        Pose("none", arms=0.0, palm=90.0, fingers=2, phalanges=1, thumb=False),
    ],
)
def test_joints_get_the_same_axes_wherever_a_body_stands(pose: Pose) -> None:
    rig = posed_body(pose).rig
    translation = rig.translation.copy()
    translation[rig.parents < 0] += [8.0, -16.0, 4.0]
    moved = replace(rig, translation=translation)
    skins = tuple(replace(skin, inverse_bind=inverse(moved.world[skin.joints])) for skin in rig.skins)
    here, there = orient_joints(rig, preset="maya"), orient_joints(replace(moved, skins=skins), preset="maya")
    assert_allclose(there.rotation, here.rotation, atol=1e-6)
