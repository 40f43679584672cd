"""An FK control moves its joint along the control's own axes, and its channels are found again, by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.fk import Fk
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.maths.matrices import compose
from rigtri.maths.quaternions import from_axis_angle, to_axes, unit
from rigtri.operations.add_controls import AddControlsOptions, add_controls

X, Y, Z = np.eye(3)


def fk(frame: Any, joint: str = "b", scale: float = 1.0) -> tuple[Fk, ControlsAtZero]:
    """The control of a joint whose bone points along y, and so x of the control where that is as the bone.

    scale: of the joint above it, which has no control.
    """
    bare = chain((0, 0, 0), (1, 0, 0), (1, 2, 0), (3, 2, 0))
    bare.scale[0] = scale
    rig = add_controls(bare, options=AddControlsOptions(joints=("b", "c"), frame=frame))
    zero = ControlsAtZero(rig)
    return Fk(zero, zero.fk[rig.find(joint)]), zero


def channels(translation: Any = (0, 0, 0), rotation: Any = (0, 0, 0, 1), scale: Any = (1, 1, 1)) -> Parts:
    return Parts(*(np.array([part], dtype=np.float64) for part in (translation, rotation, scale)))


def posed(step: Fk, given: Parts) -> PoseCache:
    made = PoseCache(step.rig)
    made.set(step.own.control, given)
    step.run(made)
    return made


def test_a_control_with_the_joint_s_axes_moves_it_along_them() -> None:
    step, _ = fk("joint")
    turn = from_axis_angle(np.array([1.0, 2, 3]), 0.8)
    found = posed(step, channels((0.5, 0, 0.25), turn, (2, 3, 4))).part(step.joint)
    assert_allclose(found.translation, [[1.5, 0, 0.25]], atol=1e-9)
    assert_allclose(found.rotation, [turn], atol=1e-9)
    assert_allclose(found.scale, [[2, 3, 4]])


def test_a_control_with_the_bone_s_axes_moves_it_along_those() -> None:
    step, zero = fk("bone")
    axes = to_axes(zero.world_rotation(step.own.offset))
    assert_allclose(axes[0], Y, atol=1e-9)
    found = posed(step, channels((0.5, 0, 0), from_axis_angle(X, 0.8), (2, 3, 4))).part(step.joint)
    assert_allclose(found.translation, [[1, 0.5, 0]], atol=1e-9)
    assert_allclose(found.rotation, [from_axis_angle(Y, 0.8)], atol=1e-9)
    assert_allclose(found.scale[0, 1], 2.0)
    assert sorted(found.scale[0].round(9).tolist()) == [2, 3, 4]


@pytest.mark.parametrize("frame", ["joint", "bone"])
@pytest.mark.parametrize("scale", [0.01, 1.0, 3.0, -1.0])
def test_a_control_below_ik_moves_as_far_as_without(scale: float, frame: str) -> None:
    """Also where the joint's parent has another unit, or is mirrored, as below a scaled armature."""
    step, _ = fk(frame, scale=scale)
    given = channels((0.5, 0.25, -1))
    on_its_own, on_the_joint = posed(step, given).part(step.joint), step.moved(step.rest, given)
    assert_allclose(on_the_joint.translation, on_its_own.translation, atol=1e-9 / abs(scale))
    assert_allclose(step.needed(step.rest, on_the_joint).translation, given.translation, atol=1e-9)


@pytest.mark.parametrize("frame", ["joint", "bone"])
@pytest.mark.parametrize("joint", ["b", "c"])
def test_the_channels_that_give_a_pose_are_found_again(frame: str, joint: str) -> None:
    step, _ = fk(frame, joint)
    made = np.random.default_rng(4)
    given = Parts(made.normal(size=(3, 3)), unit(made.normal(size=(3, 4))), made.uniform(0.5, 2, (3, 3)))
    pose = posed(step, given)
    found = step.channels(pose, pose.part(step.joint))
    for was, now in zip(given, found, strict=True):
        signs = np.sign(np.einsum("ij,ij->i", was, now))[:, np.newaxis] if was.shape[1] == 4 else 1.0
        assert_allclose(now * signs, was, atol=1e-9)


@pytest.mark.parametrize("frame", ["joint", "bone"])
def test_an_offset_beneath_a_posed_joint_lets_its_control_stand_on_it(frame: str) -> None:
    """As below IK, where the joint is where that has it, and the control keeps its own channels."""
    step, zero = fk(frame, "c")
    rig = step.rig
    pose = PoseCache(rig)
    turn = from_axis_angle(np.array([1.0, 1, 0]), 0.6)
    pose.set(rig.find("b"), channels((1, 0.5, 0), from_axis_angle(Z, 0.4)))
    pose.set(step.joint, channels((0, 2, 0.5), turn, (2, 2, 2)))
    given = channels((0.3, -0.2, 0.1), from_axis_angle(Y, 0.5), (1.25, 1.25, 1.25))
    pose.set(step.own.control, given)
    offset = step.beneath(pose)
    local = compose(*(part[0] for part in given)) @ compose(*(part[0] for part in offset))
    control = local @ pose.world(step.own.above)[0]
    joint = pose.world(step.joint)[0]
    assert_allclose(control[3, :3], joint[3, :3], atol=1e-9)
    seen = to_axes(zero.world_rotation(step.own.offset)) @ to_axes(zero.world_rotation(step.joint)).T
    assert_allclose(control[:3, :3], seen @ joint[:3, :3], atol=1e-9)


def test_an_offset_rides_on_the_joint_of_the_control_above() -> None:
    step, zero = fk("joint", "c")
    pose = PoseCache(step.rig)
    pose.set(step.rig.find("b"), channels((1, 0.5, 0), from_axis_angle(Z, 0.4)))
    offset = step.riding(pose)
    world = compose(*(part[0] for part in offset)) @ pose.world(step.own.above)[0]
    expected = zero.world[step.own.offset] @ np.linalg.inv(zero.world[1]) @ pose.world(1)[0]
    assert_allclose(world, expected, atol=1e-9)
    assert_allclose(world[3, :3], [1 - 2 * np.sin(0.4), 0.5 + 2 * np.cos(0.4), 0], atol=1e-9)


@pytest.mark.parametrize("frame", ["joint", "bone"])
def test_zeros_of_channels_have_one_sign_however_many_frames_are_solved(frame: str) -> None:
    step, _ = fk(frame)
    rest = step.rest
    for turn in (
        from_axis_angle(X, np.pi),
        from_axis_angle(np.array([1.0, 1, 1]), 2.0),
        from_axis_angle(Z, np.pi),
    ):
        stood = rest._replace(rotation=turn[np.newaxis])
        for count in (1, 3):
            many = Parts(*(np.repeat(part, count, axis=0) for part in stood))
            assert not np.signbit(step.needed(many, many).translation).any()
