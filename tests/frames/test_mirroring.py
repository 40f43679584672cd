"""Mirror images of directions, places and turns at a plane, and axes of twins, by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.frames.mirroring import Across, mirrored_axes, normal_of, world_rotation
from rigtri.maths.quaternions import IDENTITY, from_axis_angle, to_axes

X, Y, Z = np.eye(3)
HALF = np.sqrt(0.5)


def test_the_axis_across_each_plane() -> None:
    planes: tuple[Any, ...] = ("yz", "xz", "xy")
    assert [normal_of(plane).tolist() for plane in planes] == np.eye(3).tolist()


@pytest.mark.parametrize(
    ("across", "direction", "point"),
    [
        (Across(), [-1, 2, 3], [-1, 2, 3]),
        (Across((0.0, 1.0, 0.0), 5.0), [1, -2, 3], [1, 8, 3]),
        (Across((HALF, 0.0, -HALF), 0.0), [3, 2, 1], [3, 2, 1]),  # x and z change places
        (Across((HALF, 0.0, -HALF), HALF), [3, 2, 1], [4, 2, 0]),
    ],
)
def test_directions_and_points_have_their_images(across: Across, direction: Any, point: Any) -> None:
    given = np.array([[1.0, 2, 3], [1.0, 2, 3]])
    assert_allclose(across.directions(given), [direction] * 2, atol=1e-12)
    assert_allclose(across.points(given[0]), point, atol=1e-12)
    assert_allclose((np.append(given[0], 1.0) @ across.matrix)[:3], point, atol=1e-12)
    assert_allclose(across.points(across.points(given)), given, atol=1e-12)


def test_a_rotation_goes_the_other_way_about_the_mirrored_axis() -> None:
    across = Across((0.0, 1.0, 0.0), 3.0)
    turn = from_axis_angle(np.array([1.0, 2.0, 3.0]), 0.7)
    found = across.rotation(turn)
    assert_allclose(found, from_axis_angle(np.array([1.0, -2.0, 3.0]), -0.7), atol=1e-12)
    # What is turned and mirrored is mirrored and turned.
    flip = np.diag([1.0, -1.0, 1.0])
    assert_allclose(to_axes(turn) @ flip, flip @ to_axes(found), atol=1e-12)


@pytest.mark.parametrize(
    ("mirror", "rows"),
    [
        ("orientation", [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
        ("behavior", [[0, -1, 0], [-1, 0, 0], [0, 0, -1]]),
        ("blender", [[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
        ("y-reversed", [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]),
        ("z-reversed", [[0, 1, 0], [1, 0, 0], [0, 0, -1]]),
    ],
)
def test_the_axes_of_a_twin_are_mirrored_but_for_what_is_reversed(mirror: Any, rows: Any) -> None:
    """Of a frame that is turned by 90° about z, whose images at x = 0 have y, x and z."""
    axes = np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    found = mirrored_axes(axes, mirror, Across())
    assert_allclose(found, rows)
    assert np.linalg.det(found) == pytest.approx(1.0)


def test_a_node_in_the_world_has_its_turn_without_scale_and_none_has_none() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    turn = from_axis_angle(Z, 0.6)
    rig.rotation[0], rig.scale[0] = turn, 3.0
    assert_allclose(world_rotation(rig, 1), turn, atol=1e-12)
    assert world_rotation(rig, -1).tolist() == IDENTITY.tolist()
    assert world_rotation(rig, -1) is not IDENTITY
