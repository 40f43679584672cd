"""A joint whose control scales it otherwise along each axis keeps that scale when it gets new axes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.errors import GeometryError
from rigtri.evaluation.active_controls import skeleton_size
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.evaluation.timelines import Timeline, timelines
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.maths.matrices import compose, inverse, multiply
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.operations.controls_check import _deviation
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.operations.orient_joints.scaled_controls import scales_by_controls

B, C = 1, 2


def with_controls(scale: Any = (2.0, 1.0, 0.5), *, bone: float | None = None, flat: bool = False) -> Rig:
    """A chain a, b, c, d with controls of b and, below that, of c; the one of b is scaled.

    bone: the controls have the axes of the bones, whose bend is about z, and not of the joints; the bone of
    b is turned about z by so many degrees. flat: c is no descendant of b, although its control is one of b's.
    """
    x, y = np.cos(np.radians(bone or 0.0)), np.sin(np.radians(bone or 0.0))
    bare = chain((0, 0, 0), (1, 0, 0), (1 + x, y, 0), (3, 2, 0))
    frame = "joint" if bone is None else "bone"
    rig = add_controls(bare, options=AddControlsOptions(joints=("b", "c"), frame=frame))
    rig.scale[rig.find("b_ctl")] = scale
    if flat:
        rig.parents[C] = 0
    return rig


def scales_of(rig: Rig, node: int) -> tuple[Any, dict[int, int]]:
    table, controls = scales_by_controls(rig, ScaleTable.of(rig))
    return table.of_node(node).tolist(), controls


@pytest.mark.parametrize(
    ("bone", "along_the_joint"),
    [
        (None, [2.0, 1.0, 0.5]),
        (0.0, [2.0, 0.5, 1.0]),  # up, which is y of the control, is what the bones bend about
        (90.0, [0.5, 2.0, 1.0]),
        (30.0, [1.0, 2.0, 3.0]),  # of other axes nothing but the joint's own may stay
    ],
)
def test_a_control_s_scale_is_one_of_its_joint_along_the_joint_s_axes(
    bone: float | None, along_the_joint: list[float]
) -> None:
    rig = with_controls(bone=bone)
    scales, controls = scales_of(rig, B)
    assert_allclose(scales, [[1.0, 1.0, 1.0], along_the_joint], atol=1e-12)
    assert controls == {B: rig.find("b_ctl")}


def test_a_uniform_scale_of_a_control_is_none() -> None:
    assert scales_of(with_controls((2.0, 2.0, 2.0)), B) == ([[1.0, 1.0, 1.0]], {})


def test_a_mirrored_control_scales_by_the_amounts_alone() -> None:
    assert scales_of(with_controls((-2.0, 1.0, 0.5)), B)[0][1] == [2.0, 1.0, 0.5]


def test_a_joint_with_a_scale_of_its_own_keeps_both_and_is_named_for_its_own() -> None:
    rig = with_controls()
    rig.scale[B] = (1.0, 3.0, 2.0)
    assert scales_of(rig, B) == ([[1.0, 3.0, 2.0], [2.0, 1.0, 0.5]], {})


def test_the_scale_of_a_control_above_is_a_joint_s_where_no_joint_above_has_it() -> None:
    """A joint below b takes b's scale from b itself; one that is not takes it from b's control."""
    assert scales_of(with_controls(), C) == ([[1.0, 1.0, 1.0]], {B: with_controls().find("b_ctl")})
    rig = with_controls(flat=True)
    scales, controls = scales_of(rig, C)
    assert_allclose(scales, [[1.0, 1.0, 1.0], [2.0, 1.0, 0.5]])
    assert controls == {B: rig.find("b_ctl"), C: rig.find("b_ctl")}


def test_the_scales_of_two_controls_are_both_a_joint_s() -> None:
    rig = with_controls(flat=True)
    rig.scale[rig.find("c_ctl")] = (1.0, 1.0, 4.0)
    scales, controls = scales_of(rig, C)
    assert_allclose(scales, [[1.0, 1.0, 1.0], [1.0, 1.0, 4.0], [2.0, 1.0, 0.5]])
    assert controls[C] == rig.find("c_ctl")


@pytest.mark.parametrize(("own", "told"), [(1.0, "'b' ('b_ctl' 2 1 0.5)"), (3.0, "'b' (1 3 1)")])
def test_the_error_of_axes_that_such_a_scale_refuses_says_whose_it_is(own: float, told: str) -> None:
    rig = with_controls(bone=30.0)
    rig.scale[B, 1] = own
    with pytest.raises(GeometryError) as error:
        orient_joints(rig, options=OrientJointsOptions(on_nonuniform_scale="error"))
    assert told in str(error.value)


@pytest.mark.parametrize("by", ["keys", "reader", "control"])
def test_what_follows_a_joint_that_is_scaled_along_one_axis_gets_the_nearest_axes(by: str) -> None:
    """A parent constraint gives its child the lengths of the child's axes, which are others in other axes."""
    rig = chain((0, 0, 0), (1, 0, 0), (2, 1, 0), (3, 2, 0))
    rig.parents[C] = 0
    rig.rotation[B] = from_axis_angle([0, 0, 1], 0.5)
    track = Track(B, "scale", "LINEAR", np.arange(2.0), np.array([[1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]))
    if by == "control":
        rig = add_controls(rig, options=AddControlsOptions(joints=("b",), frame="joint"))
        track = replace(track, node=rig.find("b_ctl"))
    elif by == "reader":
        track = Track(0, "rotation", "LINEAR", np.arange(2.0), from_axis_angle([0, 0, 1], np.arange(2.0)))
    rig = replace(rig, clips=(Clip("clip", (track,)),))
    if by == "reader":
        bent = {"target": (Goal("bent", pose="clip@1"),), "joint": (("bent", "b", "sx=2"),)}
        rig = add_posereader(rig, options=AddPosereaderOptions(driver="a", **bent))
    rig = constrain(rig, options=ConstrainOptions(type="parent", child="c", driver=("b",)))
    turned = orient_joints(rig, options=OrientJointsOptions(joints=("c",), aim="z", up="x"))
    new = multiply(turned.world[C], inverse(rig.world[C]))
    was, now = (at_end(bake(each, options=BakeOptions())) for each in (rig, turned))
    assert_allclose(now, multiply(new, was), atol=1e-6)
    assert np.ptp(length(was[:3, :3])) > 0.1
    assert not np.allclose(new, np.eye(4))


def at_end(rig: Rig) -> Floats:
    return worlds(rig, locals_at(rig, rig.clips[0], [1.0]))[0, C]


def test_joints_that_controls_move_elsewhere_are_told_with_the_moment() -> None:
    """As a share of the size of the skeleton: here half of a unit of four, where the last key is."""
    rig = chain((0, 0, 0), (4, 0, 0))
    times = np.array([0.0, 1.0, 2.0])

    def moving(*places: float) -> tuple[Rig, Timeline]:
        values = np.array([[x, 0.0, 0.0] for x in places])
        moved = replace(rig, clips=(Clip("c", (Track(1, "translation", "LINEAR", times, values),)),))
        (line,) = timelines(moved)
        return moved, line

    one, other = moving(4, 4, 4), moving(4, 4.25, 3.5)
    size = skeleton_size(one[0])
    assert _deviation(one, one, [0, 1])[0] == 0.0
    far, joint, time = _deviation(one, other, [0, 1])
    assert (far * size, joint, time) == (0.5, 1, 2.0)
    assert _deviation(one, other, [0])[0] == 0.0


def test_a_mirrored_joint_keeps_the_axis_along_which_it_is_mirrored() -> None:
    """A matrix, as USD stores a rest pose, does not say which one that is; scale alone has keys or values."""
    bare = chain((0, 0, 0), (1, 0, 0), (2, 1, 0), (3, 2, 0))
    scale, has_matrix = bare.scale.copy(), bare.has_matrix.copy()
    scale[B], has_matrix[B] = (-1.0, 1.0, 1.0), True
    matrix = compose(bare.translation, bare.rotation, scale)
    bare = replace(bare, scale=scale, has_matrix=has_matrix, matrix=matrix)
    bare = replace(bare, skins=(replace(bare.skins[0], inverse_bind=inverse(bare.world)),))
    rig = add_controls(bare, options=AddControlsOptions(joints=("b",)))
    turns = np.stack([from_axis_angle([1, 2, 3], angle) for angle in (0.0, 0.2)])
    swing = Track(rig.find("b_ctl"), "rotation", "LINEAR", np.arange(2.0), turns)
    baked = bake(replace(rig, clips=(Clip("swing", (swing,)),)), options=BakeOptions())
    found = {track.path: track.values for track in baked.clips[0].tracks if track.node == B}
    assert found.keys() == {"rotation"}
    assert_allclose(np.abs(found["rotation"][:, 3]), np.cos([0.0, 0.1]), atol=1e-6)
