"""Skeletons without any pose, which UsdSkel does not skin: their meshes stay where their prims are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program import cli
from pxr import Gf, Usd, UsdGeom, UsdSkel
from usd_files import MESH, animation, at, read, save, scene, skeleton

import rigtri
from rigtri.evaluation.sampling import locals_at
from rigtri.maths.trigonometry import Floats

PLACE = """
double3 xformOp:translate = (0, 0, 5)
float xformOp:rotateX = -90
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
"""


def _below_a_turn(*meshes: str, rest: str = "") -> str:
    """A skeleton without motion below a transform."""
    return scene(PLACE, skeleton(rest=rest, source=""), *meshes)


def _shown(path: Path, time: float = 0.0) -> Floats:
    """The points of the skin in the world, as UsdSkel shows them."""
    stage = Usd.Stage.Open(Usd.Stage.Open(str(path)).Flatten())
    UsdSkel.BakeSkinning(UsdSkel.Root(stage.GetPrimAtPath("/Root")), Gf.Interval(0, 6))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Root/Skin"))
    world = np.array(mesh.ComputeLocalToWorldTransform(time))
    points = np.array(mesh.GetPointsAttr().Get(time), dtype=np.float64)
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


@pytest.mark.ci
@pytest.mark.parametrize("place", ["", PLACE])
def test_an_animated_skeleton_without_rest_pose_stands_in_a_scene_of_another_axis(
    place: str, tmp_path: Path
) -> None:
    source = save(tmp_path, scene(place, skeleton(rest=""), animation(), MESH))
    out = tmp_path / "out.usda"
    cli("freeze", source, "-o", out, "--up-axis", "z", code=0)
    assert "restTransforms" not in out.read_text()
    for time in (1.0, 3.0, 5.0):
        x, y, z = _shown(source, time).T
        np.testing.assert_allclose(_shown(out, time), np.stack([x, -z, y], axis=1), atol=1e-5)


def test_an_animated_skeleton_gets_the_rest_pose_that_is_requested(tmp_path: Path) -> None:
    source = save(tmp_path, scene(skeleton(rest=""), animation(), MESH))
    out = tmp_path / "out.usda"
    cli("set-rest", source, "-o", out, "--pose", "Anim@5", code=0)
    rig = read(out).rig
    joints = rig.skins[0].joints
    played = locals_at(rig, rig.clips[0], [5.0])[0, joints]
    np.testing.assert_allclose(rig.local[joints], played, atol=1e-6)
    np.testing.assert_array_equal(_shown(out, 3.0), _shown(source, 3.0))


def test_a_rest_pose_that_would_skin_what_is_not_skinned_is_refused(tmp_path: Path) -> None:
    elsewhere = f"matrix4d primvars:skel:geomBindTransform = {at(1, 0, 0)}\npoint3f"
    hat = MESH.replace('"Skin"', '"Hat"').replace("point3f", elsewhere)
    source = save(tmp_path, _below_a_turn(MESH, hat))
    turned = "((0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (0, 2, 0, 1))"
    rest = f"uniform matrix4d[] restTransforms = [{at(0, 0, 0)}, {turned}, {at(0, 2, 1)}]"
    like = save(tmp_path, scene(skeleton(rest=rest, source="")), "like.usda")
    ran = cli("set-rest", source, "-o", tmp_path / "out.usda", "--like", like, code=3)
    assert "Add restTransforms" in " ".join(ran.stderr.split())
