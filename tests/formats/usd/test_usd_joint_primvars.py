"""Primvars of skeletons with a value for each joint, as Blender's exporter writes bone lengths."""

from __future__ import annotations

from pathlib import Path

import pytest
from places import SAMPLES
from program import cli
from pxr import Sdf, Usd, UsdGeom

NAME = "blender:bone_lengths"


def with_lengths(folder: Path, interpolation: str) -> tuple[Path, dict[str, float]]:
    """The biped with a primvar on its skeleton; and its values by the name of the joint."""
    path = folder / "in.usda"
    stage = Usd.Stage.Open(Sdf.Layer.FindOrOpen(str(SAMPLES / "biped.usda")))
    prim = next(prim for prim in stage.Traverse() if prim.GetTypeName() == "Skeleton")
    names = [str(token).rpartition("/")[2] for token in prim.GetAttribute("joints").Get()]
    lengths = [1.0 + 0.5 * k for k in range(len(names))]
    primvar = UsdGeom.PrimvarsAPI(prim).CreatePrimvar(NAME, Sdf.ValueTypeNames.FloatArray, interpolation)
    primvar.Set(lengths)
    stage.GetRootLayer().Export(str(path))
    return path, dict(zip(names, lengths, strict=True))


def lengths_of(path: Path) -> tuple[list[str], list[float]]:
    stage = Usd.Stage.Open(str(path))
    prim = next(prim for prim in stage.Traverse() if prim.GetTypeName() == "Skeleton")
    names = [str(token).rpartition("/")[2] for token in prim.GetAttribute("joints").Get()]
    return names, list(UsdGeom.PrimvarsAPI(prim).GetPrimvar(NAME).Get())


@pytest.mark.parametrize(
    ("command", "new"),
    [
        ("add-root", {"root": "hips"}),
        ("add-socket --name gun --on hand_L", {"gun": "hand_L"}),
        ("prune-joints --ends", {}),
        ("merge-joints --joints hand_L --tolerance 1", {}),
    ],
)
def test_values_stay_with_their_joints(command: str, new: dict[str, str], tmp_path: Path) -> None:
    """New joints take the value of the joint beside them. Blender drops bones that have none."""
    path, lengths = with_lengths(tmp_path, UsdGeom.Tokens.uniform)
    out = tmp_path / "out.usda"
    operation, *options = command.split()
    cli(operation, path, "-o", out, *options, code=0)
    names, found = lengths_of(out)
    assert names != list(lengths)
    assert found == [lengths[new.get(name, name)] for name in names]


def test_a_value_for_the_whole_skeleton_stays(tmp_path: Path) -> None:
    path, lengths = with_lengths(tmp_path, UsdGeom.Tokens.constant)
    cli("add-root", path, "-o", tmp_path / "out.usda", code=0)
    assert lengths_of(tmp_path / "out.usda")[1] == list(lengths.values())
