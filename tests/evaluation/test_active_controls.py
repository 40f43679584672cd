"""Which controls are at work: those with keys, and those posed at rest of joints without any."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from rigs import chain, rig_of

from rigtri.evaluation.active_controls import (
    controls_and_poles,
    controls_at_work,
    moved_at_rest,
    pose_at,
    skeleton_size,
)
from rigtri.evaluation.timelines import timelines
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls


def controlled() -> Rig:
    bare = chain((0, 0, 0), (1, 0, 0), (2, 0.3, 0), (3, 0, 4))
    return add_controls(bare, options=AddControlsOptions(joints=("b", "c")))


def test_the_size_is_of_joints_and_of_all_nodes_where_there_are_none() -> None:
    rig = controlled()
    assert skeleton_size(rig) == pytest.approx(np.sqrt(9 + 0.09 + 16))
    bare = rig_of(["a", "b", "c"], [-1, -1, -1], np.array([[0.0, 0, 0], [3, 4, 0], [np.nan, 0, 0]]))
    assert skeleton_size(bare) == 5.0
    assert skeleton_size(rig_of(["a"], [-1], np.zeros((1, 3)))) == 1.0


def test_controls_are_those_that_add_controls_makes() -> None:
    rig = controlled()
    assert controls_and_poles(rig) == {rig.find("b_ctl"), rig.find("c_ctl")}


@pytest.mark.parametrize(
    ("what", "value", "moved"),
    [
        ("translation", (0, 0, 1e-4), True),
        ("translation", (0, 0, 1e-6), False),  # of a size of five
        ("rotation", from_axis_angle(np.array([1.0, 0, 0]), 1e-5), True),
        ("rotation", from_axis_angle(np.array([1.0, 0, 0]), 1e-7), False),
        ("scale", (1, 1 - 1e-5, 1), True),
        ("scale", (1, 1 + 1e-7, 1), False),
    ],
)
def test_a_control_is_moved_at_rest_by_more_than_rounding(what: str, value: Any, moved: bool) -> None:
    rig = controlled()
    node = rig.find("c_ctl")
    getattr(rig, what)[node] = value
    assert moved_at_rest(rig, skeleton_size(rig)) == ({node} if moved else set())
    assert moved_at_rest(chain((0, 0, 0), (1, 0, 0)), 1.0) == frozenset()


def test_a_control_posed_at_rest_works_where_its_joint_has_no_keys() -> None:
    rig = controlled()
    b, c, joint = rig.find("b_ctl"), rig.find("c_ctl"), rig.find("c")
    rig.translation[c] = (0, 1, 0)

    def at_work(*nodes: int) -> frozenset[int]:
        keys = np.array([[0.0, 0, 0], [0, 1, 0]])
        tracks = tuple(Track(node, "translation", "LINEAR", np.array([0.0, 1.0]), keys) for node in nodes)
        made = replace(rig, clips=(Clip("walk", tracks),))
        return controls_at_work(made, timelines(made)[0])

    assert at_work(b) == {b, c}
    assert at_work(b, joint) == {b}
    assert at_work(joint, c) == {c}
    assert at_work(rig.find("a")) == {c}


@pytest.mark.parametrize("evaluate", [True, False])
def test_a_pose_is_that_of_the_keys_or_what_controls_make_of_them(evaluate: bool) -> None:
    rig = controlled()
    keys = np.array([[0.0, 0, 0], [0, 1, 0]])
    track = Track(rig.find("b_ctl"), "translation", "LINEAR", np.array([0.0, 1.0]), keys)
    rig = replace(rig, clips=(Clip("walk", (track,)),))
    pose = pose_at(rig, timelines(rig)[0], 1.0, size=skeleton_size(rig), evaluate=evaluate)
    still = rig.world[rig.find("b"), 3, :3]
    far = np.linalg.norm(pose.world(rig.find("b"))[0, 3, :3] - still)
    assert far == pytest.approx(1.0 if evaluate else 0.0, abs=1e-12)
