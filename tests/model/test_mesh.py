"""The points of a mesh, and how far the joints that move them reach."""

from __future__ import annotations

import numpy as np

from rigtri.model.mesh import Mesh


def test_boxes_of_joints_leave_out_points_that_are_not_numbers() -> None:
    points = np.array([[0.0, 0, 0], [np.nan, 9, 9], [1, 2, 3], [4, 5, 6]])
    joints = np.array([[0], [0], [0], [1]])
    low, high = Mesh("body", 0, points, joints=joints, weights=np.ones((4, 1))).joint_boxes
    assert low.tolist() == [[0, 0, 0], [4, 5, 6]]
    assert high.tolist() == [[1, 2, 3], [4, 5, 6]]
