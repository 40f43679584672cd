"""Edits carry controls: build, animate the controls, edit, bake, and the motion is the same."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import rigtri
from rigtri.model.rig import Rig

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
# What two bakes of one motion may differ by, as a share of the size: float32 keys.
SAME_MOTION = 1e-5

EDITS: dict[str, Callable[[Rig], Rig]] = {
    "orient-joints": lambda rig: rigtri.orient_joints(rig, preset="talk"),
    "orient-joints, add-controls": lambda rig: rigtri.add_controls(
        rigtri.orient_joints(rig, preset="blender"), whole_character=True
    ),
    "mirror": lambda rig: rigtri.mirror(rig, from_side="left"),
    "add-controls": lambda rig: rigtri.add_controls(rig, whole_character=True),
    "add-polevector": lambda rig: rigtri.add_polevector(rig, limbs="auto"),
}


@pytest.fixture(scope="module")
def animated(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A character whose controls are animated, and the same baked to its joints."""
    folder, source = tmp_path_factory.mktemp("animated"), SAMPLES / request.param
    controls, joints = folder / f"controls{source.suffix}", folder / f"joints{source.suffix}"
    built = rigtri.add_controls(rigtri.read(source), whole_character=True)
    rigtri.write(rigtri.bake(built, to="controls"), controls, verify=False)
    rigtri.write(rigtri.bake(rigtri.read(controls), to="joints", fps=24), joints, verify=False)
    return controls, joints


@pytest.mark.parametrize("edit", EDITS)
@pytest.mark.parametrize(
    "animated",
    ["tpose.glb", *(pytest.param(name, marks=pytest.mark.slow) for name in ("biped.glb", "biped.usda"))],
    indirect=True,
)
def test_motion_on_controls_survives_an_edit(animated: tuple[Path, Path], edit: str, tmp_path: Path) -> None:
    controls, joints = animated
    edited, baked = (tmp_path / f"{name}{controls.suffix}" for name in ("edited", "baked"))
    rigtri.write(EDITS[edit](rigtri.read(controls)), edited, verify=False)
    rigtri.write(rigtri.bake(rigtri.read(edited), to="joints", fps=24), baked, verify=False)
    assert rigtri.verify(joints, baked).deviation <= SAME_MOTION


def test_controls_without_motion_take_the_new_axes_of_their_joints() -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "tpose.glb"), joints=("upper_arm_L",))
    turned = rigtri.orient_joints(rig, preset="blender")
    again = rigtri.add_controls(turned, joints=("upper_arm_L",))
    control, joint = again.find("upper_arm_L_ctl"), again.find("upper_arm_L")
    assert "axes" in turned.metadata[int(turned.parents[control])]
    assert "axes" not in again.metadata[int(again.parents[control])]
    assert abs(again.world[control, :3, :3] - again.world[joint, :3, :3]).max() < 1e-6
