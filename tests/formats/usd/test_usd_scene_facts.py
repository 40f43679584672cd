"""What a USD stage shows besides poses."""

from __future__ import annotations

from pathlib import Path

import pytest
from places import SAMPLES
from program import cli
from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdSkel

from rigtri.formats.usd.reading.scene_facts import BINDING, read_scene_facts


@pytest.mark.parametrize(
    ("path", "facts"), [("/Paint", ["inputs:size of the material"]), ("/Skel", []), ("/Nobody", [])]
)
def test_a_binding_to_what_is_no_material_shows_nothing_of_it(path: str, facts: list[str]) -> None:
    """Found by mutations: joints that were added to a Skeleton counted as another look of the mesh."""
    stage = Usd.Stage.CreateInMemory()
    mesh = UsdGeom.Mesh.Define(stage, "/Body").GetPrim()
    UsdSkel.Skeleton.Define(stage, "/Skel").CreateJointsAttr(["a"])
    UsdShade.Material.Define(stage, "/Paint").CreateInput("size", Sdf.ValueTypeNames.Float).Set(2.0)
    mesh.CreateRelationship(BINDING).SetTargets([path])
    found = read_scene_facts(stage, {0: "/Body"}, closely=True).nodes[0]
    assert found["material"] == path
    assert [name for name in found if "of the material" in name] == facts


def test_one_sample_is_what_shows_at_all_times() -> None:
    """Before, the fallback hid it: a mesh with one sample of "invisible" was taken for a visible one."""
    stage = Usd.Stage.CreateInMemory()
    mesh = UsdGeom.Mesh.Define(stage, "/Body")
    shown = read_scene_facts(stage, {0: "/Body"}).nodes[0]["visibility"]
    mesh.CreateVisibilityAttr().Set("invisible", 5.0)
    assert "invisible" in read_scene_facts(stage, {0: "/Body"}).nodes[0]["visibility"] != shown


def test_a_number_that_is_none_is_the_same_number(tmp_path: Path) -> None:
    """Found by mutations: nothing could be edited beside a camera with an aperture of NaN."""
    source = tmp_path / "camera.usda"
    source.write_bytes((SAMPLES / "biped.usda").read_bytes())
    stage = Usd.Stage.Open(str(source))
    UsdGeom.Camera.Define(stage, "/Camera").CreateVerticalApertureAttr(float("nan"))
    stage.Save()
    ran = cli("orient-joints", source, "-o", tmp_path / "out.usda")
    assert ran.exit_code == 0, ran.stderr
    stage.GetPrimAtPath("/Camera").GetAttribute("verticalAperture").Set(3.0)
    stage.Save()
    ran = cli("verify", tmp_path / "out.usda", source)
    assert "verticalAperture of Camera is 3, was nan" in str(ran.stdout)
