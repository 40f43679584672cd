"""Skeletons without any pose, which UsdSkel does not skin: their meshes stay where their prims are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from program import cli
from pxr import Usd, UsdGeom, UsdSkel
from usd_files import MESH, at, read, save, scene, skeleton

import rigtri
from rigtri.maths.trigonometry import Floats

PLACE = """
double3 xformOp:translate = (0, 0, 5)
float xformOp:rotateX = -90
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
"""


def _below_a_turn(*meshes: str, rest: str = "") -> str:
    """A skeleton without motion below a transform."""
    return scene(PLACE, skeleton(rest=rest, source=""), *meshes)


def _shown(path: Path) -> Floats:
    """The points of the skin in the world, as UsdSkel shows them."""
    stage = Usd.Stage.Open(Usd.Stage.Open(str(path)).Flatten())
    UsdSkel.BakeSkinning(UsdSkel.Root(stage.GetPrimAtPath("/Root")))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Root/Skin"))
    world = np.array(mesh.ComputeLocalToWorldTransform(0))
    points = np.array(mesh.GetPointsAttr().Get(0), dtype=np.float64)
    return np.asarray(points @ world[:3, :3] + world[3, :3])


def test_a_new_joint_does_not_move_a_skin_that_had_no_pose(tmp_path: Path) -> None:
    source = save(tmp_path, _below_a_turn(MESH))
    cli("add-socket", source, "--on", "b", "--name", "grip", "-o", tmp_path / "out.usda", code=0)
    assert np.abs(_shown(source) - _shown(tmp_path / "out.usda")).max() < 1e-6


def test_comparison_knows_what_is_not_skinned(tmp_path: Path) -> None:
    source = read(save(tmp_path, _below_a_turn(MESH)))
    in_the_world = f"uniform matrix4d[] restTransforms = [{at(0, -5, 0)}, {at(0, 2, 0)}, {at(0, 2, 1)}]"
    posed = read(save(tmp_path, _below_a_turn(MESH, rest=in_the_world), "posed.usda"))
    assert rigtri.verify(source, posed).deviation > 0.5


def test_a_new_joint_is_refused_where_no_pose_shows_all_meshes_as_they_are(tmp_path: Path) -> None:
    elsewhere = f"matrix4d primvars:skel:geomBindTransform = {at(1, 0, 0)}\npoint3f"
    hat = MESH.replace('"Skin"', '"Hat"').replace("point3f", elsewhere)
    source, out = save(tmp_path, _below_a_turn(MESH, hat)), tmp_path / "out.usda"
    ran = cli("add-socket", source, "--on", "b", "--name", "grip", "-o", out, code=3)
    assert "UsdSkel leaves its meshes where they are" in " ".join(ran.stderr.split())
    assert not out.exists()
