"""Limits of angles: rounding decides on none of them, and both sides of a body follow one rule."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from places import one_in
from posed_bodies import Pose, bent, posed_body
from rigs import chain

from rigtri import orient_joints
from rigtri.maths.matrices import inverse
from rigtri.model.rig import Rig

LEFT, RIGHT = "mixamorig:Left", "mixamorig:Right"
MIRROR = np.array([1.0, -1.0, -1.0])  # of a hinge


def with_thumbs(rig: Rig, left: float, right: float) -> Rig:
    """Thumbs that are bent about a hinge 45° off that about which straight ones close."""
    axes = orient_joints(rig).world
    for side, degrees in ((LEFT, left), (RIGHT, right)):
        node = rig.find(f"{side}HandThumb2")
        aside = axes[node, 2, :3] * (1.0 if side == LEFT else -1.0)
        rig = bent(rig, rig.names[node], axes[node, 1, :3] + aside, degrees)
    return rig


def with_knees(rig: Rig, left: float, right: float) -> Rig:
    """Knees that are bent 80° aside of where knees bend."""
    for side, degrees, mirror in ((LEFT, left, np.ones(3)), (RIGHT, right, MIRROR)):
        rig = bent(rig, f"{side}Leg", np.array([0.17, 0.0, 0.98]) * mirror, degrees)
    return rig


@pytest.mark.parametrize("left", [9.7, 10.3])
@pytest.mark.parametrize(("bend", "joint"), [(with_thumbs, "HandThumb1"), (with_knees, "Leg")])
def test_sides_that_are_nearly_alike_have_axes_that_are(
    bend: Callable[[Rig, float, float], Rig], joint: str, left: float
) -> None:
    out = orient_joints(bend(posed_body(Pose(curl=12.0)).rig, left, 20.0 - left))
    one, other = (out.world[out.find(side + joint), 1, :3] for side in (LEFT, RIGHT))
    assert one @ (other * MIRROR) > 0.999


def shaken(rig: Rig, seed: int) -> Rig:
    """The rig with places that are stored anew, as float32."""
    noise = np.random.default_rng(seed).normal(size=rig.translation.shape) * 3e-8
    rig = replace(rig, translation=rig.translation * (1 + noise))
    (skin,) = rig.skins
    return replace(rig, skins=(replace(skin, inverse_bind=inverse(rig.world[skin.joints])),))


def s_bend() -> Rig:
    """A rope that bends in one plane, and then as far in one square to that."""
    x, y = np.cos(np.radians(5.0)), np.sin(np.radians(5.0))
    way = [(1.0, 0.0, 0.0), (x, y, 0.0), (x * x, x * y, y), (x * x, x * y, y)]
    return chain((0.0, 0.0, 0.0), *(tuple(each) for each in np.cumsum(way, axis=0)))


def aside(degrees: float, *, moving: bool) -> Rig:
    """A chain whose last joint goes on so far aside; it moves points, or nothing."""
    x, y = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    rig = chain((0, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0), (2 + x, 1 + y, 0))
    (skin,) = rig.skins
    return replace(rig, skins=(replace(skin, weigh=lambda: np.arange(5) < (5 if moving else 4)),))


def pointing() -> Rig:
    """Fists that point with a finger."""
    body = posed_body(Pose(curl=60.0))
    rig = body.rig
    for side, name in (("left", LEFT), ("right", RIGHT)):
        hinge = body.hinges[body.parts[f"{side} hand"]]
        for k in (1, 2):
            rig = bent(rig, f"{name}HandIndex{k}", hinge, -60.0)
    return rig


ROUND = {
    "fingers of 20°": lambda: posed_body(Pose(curl=20.0)).rig,
    "thumbs of 10°": lambda: with_thumbs(posed_body(Pose(curl=12.0)).rig, 10.0, 10.0),
    "a straight finger beside bent ones": pointing,
    "planes square to each other": s_bend,
    "an end 30° aside": lambda: aside(30.0, moving=False),
}


@pytest.mark.parametrize("name", one_in(2, ROUND))
def test_rounding_decides_on_no_round_angle(name: str) -> None:
    rig = ROUND[name]()
    first = orient_joints(rig).world[:, :3, :3]
    for seed in range(6):
        np.testing.assert_allclose(orient_joints(shaken(rig, seed)).world[:, :3, :3], first, atol=1e-3)
