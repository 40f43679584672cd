"""Rigs of several characters in one USD file, as Blender writes them after an import with guides."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from blender_usd import through_blender
from program import cli
from pxr import Gf, Usd, UsdGeom
from usd_files import MESH, animation, save, scene, skeleton, skinned

import rigtri
from rigtri.model.metadata import PoleVectorRecord
from rigtri.operations.take_clips.node_matching import pairs

TWO = """#usda 1.0
(
    upAxis = "Y"
    startTimeCode = 1
    endTimeCode = 5
)
def Xform "World"
{
    def Xform "Left"
    {
        def "figure" (references = @./hero.usda@)
        {
        }
    }
    def Xform "Right"
    {
        double3 xformOp:translate = (8, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        def "figure" (references = @./hero.usda@)
        {
        }
    }
}
"""
POLES = {"b_pole": 3.0, "b_pole_2": -2.0}


@pytest.fixture
def rigged(tmp_path: Path) -> Path:
    """Two characters of equal joints, with IK each; Blender drops the prims whose names tell them apart."""
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    shot = save(tmp_path, TWO, "two.usda")
    for name in ("Left", "Right"):
        out = tmp_path / f"with_{name}.usda"
        cli("add-controls", shot, "-o", out, "--ik", "a", "b", "c", "--character", name, code=0)
        shot = out
    return shot


def keyed(path: Path, out: Path, poles: dict[str, float]) -> Path:
    """A file in which poles move sideways, whether they have the names of their curves or not."""
    stage = Usd.Stage.Open(str(path))
    for prim in stage.Traverse():
        if prim.GetTypeName() == "Xform" and (far := poles.get(prim.GetName().removesuffix("_shape"))):
            (op, *_) = UsdGeom.Xformable(prim).GetOrderedXformOps()
            place = op.Get()
            for time in range(1, 6):
                op.Set(place + Gf.Vec3d(far * (time - 1) / 4, 0, 0), time)
    stage.Export(str(out))
    return out


def shown(path: Path) -> list[np.ndarray]:
    """Where the mesh of each character is at every frame."""
    stage = Usd.Stage.Open(str(path))
    frames = [skinned(stage, time) for time in range(1, 6)]
    return [np.array([frame[name] for frame in frames]) for name in sorted(frames[0])]


def test_nodes_of_characters_whose_names_blender_drops_are_paired_by_its_numbers(
    rigged: Path, tmp_path: Path
) -> None:
    rig, edited = rigtri.read(rigged), rigtri.read(through_blender(rigged, tmp_path / "edited.usda"))
    found = pairs(rig, edited)
    assert not found.unclear
    assert {rig.names[node] for node in range(len(rig)) if node not in found.of} <= {"Left", "Right"}
    for node in np.flatnonzero(rig.is_joint).tolist():
        second = "_001" in edited.labels[found.of[node]]
        assert second == rig.labels[node].startswith("/World/Right")


@pytest.mark.parametrize("character", [None, "figure", "figure_001"])
def test_poles_of_two_characters_that_have_the_names_of_their_curves_come_home(
    rigged: Path, tmp_path: Path, character: str | None
) -> None:
    """Before, those of both were lost with a warning, and `--character` was refused."""
    edited = keyed(through_blender(rigged, tmp_path / "edited.usda"), tmp_path / "keyed.usda", POLES)
    poles = rigtri.read(edited).records(PoleVectorRecord)
    assert Counter(rigtri.read(edited).names[node] for node in poles) == Counter(
        f"{name}_shape" for name in POLES
    )
    right = tmp_path / "right.usda"
    cli("bake", keyed(rigged, tmp_path / "own.usda", POLES), "--to", "joints", "-o", right, code=0)
    out = tmp_path / "out.usda"
    one = () if character is None else ("--character", character)
    cli("bake", edited, "--rig", rigged, "--to", "joints", "-o", out, *one, code=0)
    moves = [np.abs(a - b).max() for a, b in zip(shown(right), shown(edited), strict=True)]
    assert min(moves) > 0.1
    off = [np.abs(a - b).max() for a, b in zip(shown(right), shown(out), strict=True)]
    for far, name in zip(off, ("figure", "figure_001"), strict=True):
        assert (far < 1e-3) == (character in (None, name))


@pytest.mark.parametrize("character", ["Left", "Right"])
def test_one_of_two_characters_gets_its_motion_by_take_clips(
    rigged: Path, tmp_path: Path, character: str
) -> None:
    """Before, the second one lost it, and "EDITED has no changes" was all that was said."""
    edited = keyed(through_blender(rigged, tmp_path / "edited.usda"), tmp_path / "keyed.usda", POLES)
    out, right, home = (tmp_path / f"{name}.usda" for name in ("out", "right", "home"))
    cli("take-clips", rigged, "--from", edited, "--character", character, "-o", out, code=0)
    cli("bake", out, "--to", "joints", "-o", home, code=0)
    cli("bake", keyed(rigged, tmp_path / "own.usda", POLES), "--to", "joints", "-o", right, code=0)
    off = [np.abs(a - b).max() for a, b in zip(shown(right), shown(home), strict=True)]
    assert [far < 1e-3 for far in off] == [character == "Left", character == "Right"]


def test_curves_below_nodes_of_their_own_are_those_of_their_controls(rigged: Path, tmp_path: Path) -> None:
    """Before, `strip` refused them as children from others, and their motion was called that of the file."""
    edited = keyed(through_blender(rigged, tmp_path / "edited.usda"), tmp_path / "keyed.usda", POLES)
    rig = rigtri.read(edited)
    curves = {node for node, label in enumerate(rig.labels) if label.endswith("_shape")}
    assert curves <= rig.own
    assert not rig.showing
    bare = tmp_path / "bare.usda"
    cli("strip", edited, "--discard-motion", "-o", bare, code=0)
    assert not any("ctl" in label or "pole" in label for label in rigtri.read(bare).labels)
    out = tmp_path / "out.usda"
    told = cli("bake", edited, "--rig", rigged, "--to", "joints", "-o", out, code=0).output
    assert "motion differs from IN" in told
    assert "_shape" not in told.partition("motion differs from IN")[2]
