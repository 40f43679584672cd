"""bake: a rig that stands in an uneven scale is evaluated in its own space, or refused before it is wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from program import cli
from pxr import Gf, Usd, UsdGeom, UsdSkel
from rigs import rig_of
from usd_files import MESH, animation, read, save, scene, skeleton

from rigtri.evaluation.rig_space import in_rig_space, shearing_node, uneven_above
from rigtri.model.animation import Clip, Track
from rigtri.model.animation import Path as Channel
from rigtri.model.skin import Skin
from rigtri.operations.bake.warnings import warn_outside
from rigtri.report import Report

PLACE = """
double3 xformOp:translate = (3, 1, 0)
double3 xformOp:rotateXYZ = (20, 30, -40)
double3 xformOp:scale.timeSamples = {
    1: (1, 2, 0.5),
    5: (1.5, 2, 0.5),
}
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ", "xformOp:scale"]
"""


def shot(folder: Path, asset: str, place: str = PLACE) -> Path:
    prim = f'def "A" (references = @./{asset}@)\n{{\n{place}\n}}'
    text = f'#usda 1.0\n(\n    upAxis = "Y"\n)\ndef "W"\n{{\n{prim}\n}}\n'
    return save(folder, text, f"shot_of_{asset}")


def joints(path: Path, time: float) -> np.ndarray:
    """The joints seen from their skeleton, (n, 4, 4)."""
    stage = Usd.Stage.Open(str(path))
    prim = next(p for p in stage.Traverse() if p.IsA(UsdSkel.Skeleton))
    root = prim.GetParent()
    cache = UsdSkel.Cache()
    cache.Populate(UsdSkel.Root(root), Usd.PrimDefaultPredicate)
    return np.array(cache.GetSkelQuery(UsdSkel.Skeleton(prim)).ComputeJointSkelTransforms(time))


def pull(path: Path) -> None:
    """Move the IK control, so that joints have to follow it."""
    stage = Usd.Stage.Open(str(path))
    prim = next(p for p in stage.TraverseAll() if p.GetName() == "c_ik_ctl")
    attribute = prim.GetAttribute("xformOp:translate")
    was = np.array(attribute.Get(1.0))
    for time in (1.0, 5.0):
        attribute.Set(tuple(was - (0.2 * time, 0.1, 0.3)), time)
    stage.Save()


@pytest.fixture
def asset(tmp_path: Path) -> Path:
    """A limb whose motion lies on its controls."""
    hero, rigged, keyed = (tmp_path / f"{name}.usda" for name in ("hero", "rigged", "keyed"))
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    cli("add-controls", hero, "-o", rigged, "--ik", "a", "b", "c", code=0)
    cli("bake", rigged, "--to", "controls", "-o", keyed, code=0)
    return keyed


@pytest.mark.ci
def test_a_rig_in_an_uneven_scale_bakes_as_it_does_alone(asset: Path, tmp_path: Path) -> None:
    above = shot(tmp_path, asset.name)
    pull(asset)
    alone, out = tmp_path / "alone.usda", tmp_path / "out.usda"
    cli("bake", asset, "--to", "joints", "-o", alone, "--between", "1e-5", code=0)
    printed = cli("bake", above, "--to", "joints", "-o", out, "--between", "1e-5", code=0).output
    assert "not uniform" not in printed
    for time in np.linspace(1.0, 5.0, 9):
        assert np.abs(joints(alone, time) - joints(out, time)).max() < 5e-5
    # What it stands in is as it was.
    for time in (1.0, 3.0):
        assert place(above, time) == place(out, time)
    back = tmp_path / "back.usda"
    cli("bake", out, "--to", "controls", "-o", back, "--discard-motion", code=0)


def place(path: Path, time: float) -> Gf.Matrix4d:
    stage = Usd.Stage.Open(str(path))
    return UsdGeom.XformCache(time).GetLocalToWorldTransform(stage.GetPrimAtPath("/W/A"))


@pytest.mark.ci
def test_joints_beside_an_uneven_scale_are_refused_where_they_would_be_off(
    samples: Path, tmp_path: Path
) -> None:
    """IK ends and poles that are joints themselves; controls beside the scale give all joints back."""
    (tmp_path / "hero.usda").write_bytes((samples / "biped.usda").read_bytes())
    above, rigged, out = shot(tmp_path, "hero.usda"), tmp_path / "rigged.usda", tmp_path / "out.usda"
    cli("add-controls", above, "-o", rigged, "--whole-character", "--as", "joint", code=0)
    error = cli("bake", rigged, "--to", "controls", "-o", out, code=5).stderr
    assert "the scale of 'A' is not uniform" in error
    assert not out.exists()


@pytest.mark.ci
def test_controls_beside_an_uneven_scale_give_joints_back(samples: Path, tmp_path: Path) -> None:
    (tmp_path / "hero.usda").write_bytes((samples / "biped.usda").read_bytes())
    above = shot(tmp_path, "hero.usda")
    rigged, keyed, out = (tmp_path / f"{name}.usda" for name in ("rigged", "keyed", "out"))
    cli("add-controls", above, "-o", rigged, "--joints", "*", code=0)
    cli("bake", rigged, "--to", "controls", "-o", keyed, code=0)
    cli("bake", keyed, "--to", "joints", "-o", out, code=0)
    for time in (1.0, 3.0, 5.0):
        assert np.abs(joints(above, time) - joints(out, time)).max() < 5e-5


@pytest.mark.ci
def test_a_uniform_scale_changes_nothing(asset: Path, tmp_path: Path) -> None:
    rig = read(shot(tmp_path, asset.name, PLACE.replace("2, 0.5", "1, 1").replace("1.5", "1"))).rig
    assert in_rig_space(rig, lambda seen: seen) is rig


def test_a_bake_warns_of_each_node_above_the_joints_whose_scale_is_uneven() -> None:
    names = ["squashed", "hips", "beside"]
    rig = rig_of(names, [-1, 0, -1], np.zeros((3, 3)), scale=np.array([[1.0, 2, 1], [1, 1, 1], [1, 1, 3]]))
    report = Report()
    warn_outside(replace(rig, skins=(Skin("skin", np.array([1]), np.eye(4)[np.newaxis]),)), report)
    (warning,) = report.warnings
    assert warning.code == "uneven-above"
    assert "The scale of 'squashed' is not uniform" in str(warning)


@pytest.mark.parametrize(
    ("node", "path", "values", "uneven"),
    [
        (0, "scale", [[1, 1, 1], [1, -1, 1]], []),
        (0, "scale", [[1, 1, 1], [1, 2, 1]], [0]),
        (0, "scale", [[3, 3, 3], [1, 1, 1]], []),
        (0, "translation", [[0, 0, 0], [1, 2, 3]], []),
        (1, "scale", [[1, 1, 1], [1, 2, 1]], []),  # a joint
        (2, "scale", [[1, 1, 1], [1, 2, 1]], []),  # above none
    ],
)
def test_a_clip_makes_a_node_above_joints_uneven_by_its_scale_alone(
    node: int, path: Channel, values: list[list[float]], uneven: list[int]
) -> None:
    rig = rig_of(["above", "hips", "beside"], [-1, 0, -1], np.zeros((3, 3)))
    track = Track(node, path, "LINEAR", np.array([0.0, 1.0]), np.array(values, dtype=np.float64))
    skin = Skin("skin", np.array([1]), np.eye(4)[np.newaxis])
    assert uneven_above(replace(rig, skins=(skin,), clips=(Clip("grow", (track,)),))) == uneven


def test_what_shears_a_node_is_no_noise_above_it() -> None:
    rig = rig_of(["place", "hips", "arm", "hand"], [-1, 0, 1, 2], np.zeros((4, 3)))
    scale = np.array([(1, 1.00002, 1), (1, 1, 1), (1, 2, 1), (1, 9, 1)])
    assert shearing_node(replace(rig, scale=scale), 3) == 2  # its own is along its axes


@pytest.mark.ci
def test_what_a_constraint_moves_below_an_uneven_scale_is_reported_as_below_an_even_one(
    samples: Path, tmp_path: Path
) -> None:
    (tmp_path / "hero.usda").write_bytes((samples / "biped.usda").read_bytes())
    above = shot(tmp_path, "hero.usda")
    rigged, ruled, out = (tmp_path / f"{name}.usda" for name in ("rigged", "ruled", "out"))
    cli("add-controls", above, "-o", rigged, "--joints", "*", "-q", code=0)
    cli("constrain", rigged, "-o", ruled, "--type", "orient", "--child", "head", "--driver", "chest", code=0)
    told = cli("bake", ruled, "--to", "controls", "-o", out, code=0).stderr
    assert "The controls give 'head_end' back" in told
    assert "what also moves it is not its controls' to hold" in told
