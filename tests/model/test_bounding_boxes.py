"""Boxes of what each joint moves, wherever morphs carry it, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.model import mesh as module
from rigtri.model.bounding_boxes import boxes, corners, extent
from rigtri.model.mesh import Mesh

POINTS = np.array([[0.0, 0, 0], [1, 2, 3], [4, -1, 0], [9, 9, 9]])
JOINTS, WEIGHTS = np.array([[0, 2], [2, 0], [2, 2], [1, 0]]), np.array([[1.0, 0], [0.5, 0.5], [1, 0], [0, 0]])
MESH = Mesh("m", 0, POINTS, 0, JOINTS, WEIGHTS)


@pytest.mark.parametrize("block", [1 << 13, 1, 3])
def test_a_box_is_of_the_points_that_a_joint_has_weight_on(
    monkeypatch: pytest.MonkeyPatch, block: int
) -> None:
    monkeypatch.setattr(module, "_BLOCK", block)
    low, high = boxes(replace(MESH), 4)
    assert low.tolist() == [[0, 0, 0], [np.inf] * 3, [1, -1, 0], [np.inf] * 3]
    assert high.tolist() == [[1, 2, 3], [-np.inf] * 3, [4, 2, 3], [-np.inf] * 3]


def test_morphs_go_from_0_to_1_and_to_the_weights_that_they_have() -> None:
    morphs = np.zeros((2, 4, 3))
    morphs[0, 1], morphs[1, 1] = (1, -1, 0), (0, 0, 2)
    mesh = replace(MESH, morphs=morphs, morph_weights=np.array([-0.5, 3.0]))
    near, far = mesh.morphed()
    assert_allclose(near[1], [0.5, 1, 3])
    assert_allclose(far[1], [2, 2.5, 9])
    assert_allclose(near[[0, 2, 3]], POINTS[[0, 2, 3]])
    plain = replace(mesh, morph_weights=np.zeros(0))
    assert_allclose(plain.morphed()[1][1], [2, 2, 5])
    assert_allclose(boxes(mesh, 3)[1][2], [4, 2.5, 9])
    assert extent(mesh)[1][1].tolist() == [2, 2.5, 9]


def test_points_that_are_no_numbers_have_no_box() -> None:
    points = POINTS.copy()
    points[2, 0] = np.nan
    low, high = boxes(replace(MESH, points=points), 3)
    assert (low[2].tolist(), high[2].tolist()) == ([1, 2, 3], [1, 2, 3])


def test_a_box_that_a_mesh_has_is_that_of_all_its_joints() -> None:
    box = np.array([[-1.0, -2, -3], [4, 5, 6]])
    mesh = replace(MESH, box=box)
    low, high = boxes(mesh, 2)
    assert low.tolist() == [[-1, -2, -3]] * 2
    assert high.tolist() == [[4, 5, 6]] * 2
    assert [each.tolist() for each in extent(mesh)] == [[[-1, -2, -3]], [[4, 5, 6]]]
    found = corners(low[:1], high[:1])
    assert found.shape == (1, 8, 3)
    assert {tuple(corner) for corner in found[0].tolist()} == {
        (x, y, z) for x in (-1, 4) for y in (-2, 5) for z in (-3, 6)
    }


def test_weights_are_listed_joint_by_joint() -> None:
    joints, points = MESH.moved
    assert joints.tolist() == [0, 0, 2, 2]
    assert points.tolist() == [0, 1, 1, 2]
    many = replace(MESH, joints=np.array([[300, 1], [1, 300], [70_000, 2], [5, 5]]), weights=np.ones((4, 2)))
    joints, points = many.moved
    assert joints.tolist() == [1, 1, 2, 5, 5, 300, 300, 70_000]
    assert points.tolist() == [0, 1, 2, 3, 3, 0, 1, 2]


def test_joints_that_a_skin_does_not_have_are_allowed_without_weight() -> None:
    skins = chain((0, 0, 0), (1, 0, 0), (2, 0, 0)).skins
    assert MESH.fits(skins)
    for joint, weight, fits in ((3, 0.0, True), (3, 0.5, False), (-1, 0.5, False), (-1, 0.0, True)):
        joints, weights = JOINTS.copy(), WEIGHTS.copy()
        joints[0, 1], weights[0, 1] = joint, weight
        assert replace(MESH, joints=joints, weights=weights).fits(skins) is fits
    assert replace(MESH, skin=None, joints=JOINTS + 9).fits(skins)
