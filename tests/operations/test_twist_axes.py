"""Twist joints beside the ends of bones take the axes of their bones."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import one_in
from posed_bodies import NAMES, Pose, PosedBody, posed_body

from rigtri import add_twist, conform, orient_joints, read
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.rig import Rig

POSES = [
    Pose(names, twists=count, chained=chained, arms=arms, elbow=bend, knee=bend)
    for names in NAMES
    for count, chained, arms, bend in ((1, False, 45.0, 0.0), (2, False, 20.0, 15.0), (2, True, 90.0, 5.0))
    if names != "none" or not chained
]


def axes(rig: Rig, node: int) -> Floats:
    """The unit axes of a joint in the world, rows, (3, 3)."""
    return np.asarray(normalise(rig.world[node, :3, :3]))


def check(body: PosedBody, out: Rig) -> None:
    """Each twist joint of a body has the axes of the bone that it is a part of, and stands where it did."""
    twists = [part for part in body.parts if " twist " in part]
    assert twists
    for part in twists:
        node, bone = (body.parts[k] for k in (part, part.rsplit(" twist ", 1)[0]))
        assert_allclose(axes(out, node), axes(out, bone), atol=1e-6, err_msg=part)


@pytest.mark.ci
@pytest.mark.parametrize("pose", one_in(3, POSES), ids=lambda pose: pose.title)
@pytest.mark.parametrize("preset", ["article", "unreal-editor", "vrm"])
def test_a_twist_joint_beside_a_bone_takes_its_axes(pose: Pose, preset: str) -> None:
    body = posed_body(pose)
    out = orient_joints(body.rig, preset=preset)
    check(body, out)
    assert_allclose(out.world[:, 3], body.rig.world[:, 3], atol=1e-9)
    np.testing.assert_array_equal(orient_joints(out, preset=preset).rotation, out.rotation)


def test_twist_joints_that_are_named_as_parts_of_bones_have_them_too() -> None:
    """Advanced Skeleton calls them ``ElbowPart1_L`` beside ``Elbow_L``; they carry weight."""
    body = posed_body(Pose("unreal", twists=1, arms=45.0))
    names = tuple(re.sub(r"_twist_0(\d)_(.)$", r"Part\1_\2", name) for name in body.rig.names)
    assert names != body.rig.names
    check(body, orient_joints(replace(body.rig, names=names)))


def test_a_skeleton_that_is_made_to_conform_has_them_too() -> None:
    body = posed_body(Pose("unreal", twists=1, arms=60.0))
    out = conform(body.rig, to="unreal")
    for name in ("upperarm", "lowerarm", "thigh", "calf"):
        bone, twist = out.find(f"{name}_l"), out.find(f"{name}_twist_01_l")
        assert_allclose(axes(out, twist), axes(out, bone), atol=1e-6, err_msg=name)


def test_twist_joints_of_rigtri_with_weight_go_with_their_bones(samples: Path) -> None:
    built = add_twist(read(samples / "biped.glb"), limbs="auto", split_weights=True)
    twists = built.nodes_of("twist")
    assert twists
    out = orient_joints(built)
    for node in twists:
        assert_allclose(axes(out, node), axes(out, int(out.parents[node])), atol=1e-6)


def test_a_twist_joint_that_is_left_out_keeps_its_axes() -> None:
    body = posed_body(Pose("unreal", twists=1))
    node = body.parts["left upper arm twist 1"]
    out = orient_joints(body.rig, exclude=("upperarm_twist*",))
    assert_allclose(out.world[node], body.rig.world[node], atol=1e-9)
