"""Controls that come back from a DCC under other names: no key of an animator is lost."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import every_other
from program import cli
from pxr import Gf, Sdf, Usd, UsdGeom

import rigtri
from rigtri.errors import GeometryError
from rigtri.formats import read
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.report import Report


def returned(rig: Path, out: Path, *, names: dict[str, str], stored: bool) -> Path:
    """What Blender writes: other names, no relationships or lists, and of what is animated all keyed."""
    stage = Usd.Stage.Open(str(rig))
    layer = stage.Flatten()
    with Sdf.ChangeBlock():
        for prim in stage.TraverseAll():
            spec = layer.GetPrimAtPath(prim.GetPath())
            for item in list(spec.properties) if spec else ():
                is_list = isinstance(item, Sdf.AttributeSpec) and str(item.typeName) == "token[]"
                if "rigtri" in item.name and (
                    not stored or is_list or isinstance(item, Sdf.RelationshipSpec)
                ):
                    spec.RemoveProperty(item)
    edited = Usd.Stage.Open(layer)
    for prim in list(edited.TraverseAll()):
        if prim.GetName() in names:
            op = UsdGeom.Xformable(prim).GetOrderedXformOps()[0]
            for time, x in ((0, 0.0), (12, 0.05)):
                op.Set(Gf.Vec3d(x, 0, 0), time)
            for attribute in prim.GetAuthoredAttributes():
                if "rigtri" in attribute.GetName():
                    value = attribute.Get()
                    attribute.Clear()
                    attribute.Set(value, 0)
    for prim in list(edited.TraverseAll()):
        if prim.GetName() in names:
            layer.GetPrimAtPath(prim.GetPath()).name = names[prim.GetName()]
            break
    layer.Export(str(out))
    return out


@pytest.fixture(scope="module")
def rig(samples: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("rigged") / "rig.usda"
    cli("add-controls", samples / "biped.usda", "-o", out, "--whole-character", code=0)
    return out


@pytest.mark.parametrize(
    ("command", "control"),
    every_other(["bake", "take-clips"], ["hand_L_ik_ctl", "forearm_L_pole", "chest_ctl"], of=3),
)
def test_a_control_of_another_name_is_found_by_its_metadata(
    command: str, control: str, rig: Path, tmp_path: Path
) -> None:
    back = returned(rig, tmp_path / "back.usda", names={control: "shape_004"}, stored=True)
    out = tmp_path / "out.usda"
    words = {
        "bake": ["bake", back, "--rig", rig, "--to", "joints"],
        "take-clips": ["take-clips", rig, "--from", back],
    }
    printed = cli(*words[command], "-o", out, code=0).output
    assert "not in this file" not in printed
    if command == "bake":
        assert "keys for" in printed
    else:
        found = read(out).rig
        assert found.find(control) in {t.node for clip in found.clips for t in clip.tracks}


def test_keys_of_nodes_that_nobody_knows_are_an_error(rig: Path, tmp_path: Path) -> None:
    back = returned(rig, tmp_path / "back.usda", names={"hand_L_ik_ctl": "shape_004"}, stored=False)
    words = ["bake", back, "--rig", rig, "--to", "joints", "-o", tmp_path / "out.usda"]
    printed = cli(*words, code=5).output
    assert "'shape_004' of this file have keys" in printed
    assert "'hand_L_ik_ctl'" in printed


def nameless(plain: Rig) -> tuple[Rig, tuple[str, ...]]:
    """A rig with controls on joints without names, and the names that a DCC gives these."""
    hips = plain.labels[plain.find("hips")]
    names = tuple("" if joint else name for joint, name in zip(plain.is_joint, plain.names, strict=True))
    rig = rigtri.add_controls(replace(plain, names=names), below=hips)
    return rig, tuple(name or f"Bone_{k}" for k, name in enumerate(rig.names))


def test_joints_without_names_are_found_by_their_places_in_files_that_are_built_alike(samples: Path) -> None:
    rig, named = nameless(read(samples / "tpose.glb").rig)
    report = Report()
    found = rigtri.as_described(replace(rig, names=named), rig, report=report)
    assert not report.warnings
    joints = [rig.find(record.joint) for record in rig.records(ControlRecord).values()]
    assert [found.find(record.joint) for record in found.records(ControlRecord).values()] == joints


def test_joints_without_names_are_the_reason_why_no_control_finds_its_joint(samples: Path) -> None:
    plain = read(samples / "tpose.glb").rig
    rig, _ = nameless(plain)
    more = plain.with_nodes(["extra"], [-1], np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    other, named = nameless(more)
    with pytest.raises(GeometryError, match=r"no names, and --rig finds joints by these.*take-clips RIG"):
        rigtri.as_described(replace(other, names=named), rig, report=Report())


def test_the_curve_of_a_control_has_its_name(rig: Path) -> None:
    stage = Usd.Stage.Open(str(rig))
    curves = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.BasisCurves)]
    assert curves
    assert all(prim.GetName() == f"{prim.GetParent().GetName()}_shape" for prim in curves)
