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


def test_without_a_hierarchy_no_finger_aims_at_another() -> None:
    """Before, the end of one finger aimed at the next one, and a second run turned them again."""
    places = {name: np.array(at) for name, _, at in MAN}
    flat = [("root", "", (0.0, 0.0, 0.0)), *((name, "root", at) for name, _, at in MAN)]
    for side in ("L", "R"):
        out = places[f"hand.{side}"] - places[f"forearm.{side}"]
        out = out / np.linalg.norm(out)
        for n, finger in enumerate(("index", "middle", "ring", "pinky")):
            row = places[f"hand.{side}"] + np.array([0.0, 0.0, 0.03 - 0.02 * n])
            flat += [(f"{finger}{k}.{side}", "root", tuple(row + out * (0.05 + 0.03 * k))) for k in (1, 2, 3)]
    made = orient_joints(rig_with(flat))
    assert np.array_equal(orient_joints(made).world, made.world)
    at = {name: k for k, name in enumerate(made.names)}
    across = made.world[at["middle1.L"], 3, :3] - made.world[at["index1.L"], 3, :3]
    aim = made.world[at["index1.L"], 0, :3]
    assert abs(aim @ across) < 0.9 * np.linalg.norm(across) * np.linalg.norm(aim)
