"""What materials a prim and its subsets are bound to, and what of shaders says anything."""

from __future__ import annotations

from typing import Any

import pytest
from pxr import Sdf, Usd, UsdGeom, UsdShade

from rigtri.export.conversion.usd_unread import _has_meaning
from rigtri.formats.usd.reading.scene_facts import _below, _bound_materials


def stage() -> Any:
    made = Usd.Stage.CreateInMemory()
    for name in ("red", "blue"):
        UsdShade.Material.Define(made, f"/{name}")
    mesh = UsdGeom.Mesh.Define(made, "/mesh")
    for kind, name in (("GeomSubset", "part"), ("GeomSubset", "bare"), ("Scope", "other")):
        prim = made.DefinePrim(f"/mesh/{name}", kind)
        if name != "bare":
            prim.CreateRelationship("material:binding").SetTargets(["/blue"])
    mesh.GetPrim().CreateRelationship("material:binding").SetTargets(["/red"])
    return made


def test_subsets_are_bound_by_themselves_and_other_children_are_no_part() -> None:
    made = stage()
    prim = made.GetPrimAtPath("/mesh")
    assert _bound_materials(prim, "/red") == {"material": "/red", "material of subset part": "/blue"}
    assert _bound_materials(prim, None) == {"material of subset part": "/blue"}


def test_what_is_below_inherits_what_is_not_said() -> None:
    made = stage()
    prim = made.GetPrimAtPath("/mesh")
    assert _below(prim, "inherited", "default", None) == ("inherited", "default", "/red")
    assert _below(made.GetPrimAtPath("/red"), "inherited", "proxy", "/blue") == (
        "inherited",
        "proxy",
        "/blue",
    )
    UsdGeom.Imageable(prim).CreateVisibilityAttr("invisible")
    UsdGeom.Imageable(prim).CreatePurposeAttr("render")
    assert _below(prim, "inherited", "default", None) == ("invisible", "render", "/red")
    assert _below(prim, "inherited", "guide", None)[1] == "guide"
    assert _below(made.GetPrimAtPath("/blue"), "invisible", "default", None)[0] == "invisible"


@pytest.mark.parametrize(
    ("name", "kind", "value", "says"),
    [
        ("colorSpace:name", Sdf.ValueTypeNames.Token, "lin_rec709_scene", False),
        ("colorSpace:name", Sdf.ValueTypeNames.Token, "srgb_texture", True),
        ("inputs:other", Sdf.ValueTypeNames.Token, "lin_rec709_scene", True),
        ("visibility", Sdf.ValueTypeNames.Token, "inherited", False),
        ("visibility", Sdf.ValueTypeNames.Token, "invisible", True),
    ],
)
def test_a_value_has_meaning_where_it_is_not_what_nothing_says(
    name: str, kind: Any, value: Any, says: bool
) -> None:
    made = Usd.Stage.CreateInMemory()
    prim = UsdGeom.Xform.Define(made, "/x").GetPrim()
    attribute = prim.CreateAttribute(name, kind)
    assert not _has_meaning(prim, attribute)
    attribute.Set(value)
    assert _has_meaning(prim, attribute) is says
    attribute.Set(value, 1.0)
    assert _has_meaning(prim, attribute)


def test_a_connection_has_meaning() -> None:
    made = Usd.Stage.CreateInMemory()
    shader = UsdShade.Shader.Define(made, "/s")
    other = UsdShade.Shader.Define(made, "/t").CreateOutput("out", Sdf.ValueTypeNames.Float)
    given = shader.CreateInput("in", Sdf.ValueTypeNames.Float)
    given.ConnectToSource(other)
    assert _has_meaning(shader.GetPrim(), given.GetAttr())
