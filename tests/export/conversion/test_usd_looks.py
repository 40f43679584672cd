"""Values and materials of a stage as USD resolves them: samples, indices, connections, texture channels."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gltf_files import glb_parts
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel

import rigtri

_TYPES = Sdf.ValueTypeNames


def _lost(outcome: Any) -> set[str]:
    return {n.text.removeprefix("not converted: ") for n in outcome.report.warnings if n.code == "lost"}


def _mesh(stage: Any, path: str) -> Any:
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    return mesh


def _skinned(stage: Any) -> None:
    """A triangle that a joint moves, with indexed texture coordinates; and one of an indexed colour."""
    UsdSkel.Root.Define(stage, "/r")
    skeleton = UsdSkel.Skeleton.Define(stage, "/r/s")
    skeleton.CreateJointsAttr(["a"])
    for give in (skeleton.CreateBindTransformsAttr, skeleton.CreateRestTransformsAttr):
        give([Gf.Matrix4d(1.0)])
    skin = _mesh(stage, "/r/skin")
    binding = UsdSkel.BindingAPI.Apply(skin.GetPrim())
    binding.CreateSkeletonRel().SetTargets(["/r/s"])
    binding.CreateJointIndicesPrimvar(True, 1).Set([0])
    binding.CreateJointWeightsPrimvar(True, 1).Set([1.0])
    binding.CreateGeomBindTransformAttr(Gf.Matrix4d().SetTranslate((0, 2, 0)))
    coordinates = UsdGeom.PrimvarsAPI(skin).CreatePrimvar("st", _TYPES.TexCoord2fArray, "vertex")
    coordinates.Set([(0, 0), (1, 0)])
    coordinates.SetIndices([0, 1, 1])
    colour = UsdGeom.PrimvarsAPI(_mesh(stage, "/r/red")).CreatePrimvar("displayColor", _TYPES.Color3fArray)
    colour.Set([(0, 1, 0), (1, 0, 0)])
    colour.SetIndices([1])


def test_values_that_are_samples_alone_are_converted_as_defaults_are(tmp_path: Path) -> None:
    found = []
    for name in ("default", "samples"):
        (tmp_path / name).mkdir()
        stage = Usd.Stage.CreateNew(str(tmp_path / name / "in.usda"))
        _skinned(stage)
        for prim in stage.Traverse() if name == "samples" else ():
            for one in prim.GetAuthoredAttributes():
                value = one.Get()
                if one.GetVariability() == Sdf.VariabilityVarying and value is not None:
                    one.ClearDefault()
                    one.Set(value, 3.0)
        stage.Save()
        rigtri.convert(tmp_path / name / "in.usda", tmp_path / name / "out.glb")
        found.append(glb_parts(tmp_path / name / "out.glb"))
    assert found[0] == found[1]
    assert found[0][0]["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == [1, 0, 0, 1]


def test_a_primvar_whose_indices_lead_nowhere_is_listed(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "in.usda"))
    coordinates = UsdGeom.PrimvarsAPI(_mesh(stage, "/m")).CreatePrimvar("st", _TYPES.TexCoord2fArray)
    coordinates.Set([(0, 0)])
    coordinates.SetIndices([7])
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    assert "primvar st of mesh /m, whose indices and values do not fit" in _lost(outcome)
