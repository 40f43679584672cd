"""Bodies whose legs hang from nothing beside a trunk: each is a root of its own."""

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
