"""Bodies whose legs are roots of their own beside a trunk, or whose joints are all below one."""

from __future__ import annotations

import numpy as np
import pytest
from recognition_bodies.skeletons import MAN, rig_with

from rigtri.operations.orient_joints.orient import orient_joints


@pytest.mark.parametrize("preset", ["article", "maya", "blender"])
def test_a_thigh_without_a_joint_above_turns_with_its_shin(preset: str) -> None:
    """Before, it was kept as a root, and knees had a hinge that turned by up to 90° between both bones."""
    joints = [(name, "" if name.startswith("thigh") else above, at) for name, above, at in MAN]
    made = orient_joints(rig_with(joints), preset=preset)
    world = {name: made.world[k, :3, :3] for k, name in enumerate(made.names)}
    for side in ("L", "R"):
        thigh, shin = world[f"thigh.{side}"], world[f"shin.{side}"]
        assert np.einsum("ij,ij->i", thigh, shin) == pytest.approx([1, 1, 1], abs=0.02)


@pytest.mark.parametrize("preset", ["article", "maya", "blender", "openxr"])
@pytest.mark.parametrize("named", [True, False])
def test_a_body_whose_joints_are_all_below_one_has_the_axes_of_one_with_a_hierarchy(
    preset: str, named: bool
) -> None:
    """Before, all of them got the axes of the root, without a word; hips and clavicles kept theirs."""
    flat = [("root", "", (0.0, 0.0, 0.0)), *((name, "root", at) for name, _, at in MAN)]
    tree = [flat[0], *((name, above or "root", at) for name, above, at in MAN)]
    here, there = (orient_joints(rig_with(joints, named=named), preset=preset) for joints in (flat, tree))
    np.testing.assert_allclose(here.world, there.world, atol=1e-9)
    assert np.array_equal(orient_joints(here, preset=preset).world, here.world)
