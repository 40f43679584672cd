"""Point instancers: what they draw stays where it is when sizes above it or its prototypes change."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from program import cli
from pxr import Usd, UsdGeom, UsdSkel
from usd_files import MESH, animation, save, scene, skeleton, skinned

from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.evaluation.skinning import deformed
from rigtri.export.conversion import usd_instances
from rigtri.formats import read

ROCK = """def Mesh "Rock"
{
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
}"""
ARMY = """int[] protoIndices = [0, 1, 0]
    point3f[] positions.timeSamples = {
        1: [(0, 0, 0), (3, 0, 0), (6, 0, 1)],
        5: [(1, 0, 0), (3, 2, 0), (6, 0, 4)],
    }
    quath[] orientations = [(1, 0, 0, 0), (0.7071, 0, 0.7071, 0), (0.5, 0.5, 0.5, 0.5)]
    float3[] extent = [(-1, -1, -1), (7, 2, 5)]"""


def stage_of(*, below: bool, scales: bool, above: str = "") -> str:
    """An instancer of a character and a rock, which are below it or beside it below other ops."""
    place = "/World/Army/P" if below else "/World/P"
    hero = (
        scene(skeleton(), animation(), MESH).partition("def SkelRoot")[2].replace("/Root/", f"{place}/Root/")
    )
    protos = f'def Xform "P"\n{{\n{"" if below else above}\ndef SkelRoot{hero}\n{ROCK}\n}}'
    scaled = "float3[] scales = [(1, 1, 1), (2, 1, 1), (1, 1.5, 1)]" if scales else ""
    army = f"rel prototypes = [<{place}/Root>, <{place}/Rock>]\n{ARMY}\n{scaled}"
    inner = f"{above}\n{protos}" if below else ""
    beside = "" if below else protos
    head = '#usda 1.0\n(\n    defaultPrim = "World"\n    upAxis = "Y"\n    metersPerUnit = 1\n)\n'
    return f'{head}def Xform "World"\n{{\n{beside}\ndef PointInstancer "Army"\n{{\n{army}\n{inner}\n}}\n}}\n'


def drawn(path: Path, time: float) -> np.ndarray:
    """The world points of all instances, (v, 3)."""
    stage = Usd.Stage.Open(str(path))
    stage.SetEditTarget(stage.GetSessionLayer())
    UsdSkel.BakeSkinning(stage.Traverse(Usd.PrimAllPrimsPredicate))
    army = UsdGeom.PointInstancer(stage.GetPrimAtPath("/World/Army"))
    places = UsdGeom.XformCache(time)
    found: list[Any] = []
    roots = [stage.GetPrimAtPath(target) for target in army.GetPrototypesRel().GetTargets()]
    stands = np.array(army.ComputeInstanceTransformsAtTime(time, time))
    within = np.array(places.GetLocalToWorldTransform(army.GetPrim()))
    for number, matrix in zip(army.GetProtoIndicesAttr().Get(), stands, strict=True):
        root = roots[number]
        outside = np.linalg.inv(np.array(places.GetLocalToWorldTransform(root)))
        for prim in Usd.PrimRange(root, Usd.PrimAllPrimsPredicate):
            if prim.IsA(UsdGeom.Mesh):
                whole = np.array(places.GetLocalToWorldTransform(prim)) @ outside @ matrix @ within
                points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(time))
                found.append(points @ whole[:3, :3] + whole[3, :3])
    return np.concatenate(found)


SCALED = 'float3 xformOp:scale = (3, 3, 3)\nuniform token[] xformOpOrder = ["xformOp:scale"]'


@pytest.mark.parametrize(
    ("options", "size"), [(["--unit", "0.01"], 100.0), (["--scale"], 1.0)], ids=["unit", "scale"]
)
@pytest.mark.parametrize("below", [True, False], ids=["below", "beside"])
def test_instances_stay_where_they_are(options: list[str], size: float, below: bool, tmp_path: Path) -> None:
    source = save(tmp_path, stage_of(below=below, scales=size == 1.0, above=SCALED))
    out = tmp_path / "out.usda"
    cli("freeze", source, "-o", out, *options, code=0)
    for time in (1.0, 5.0):
        before, after = drawn(source, time) * size, drawn(out, time)
        assert np.abs(before - after).max() < 1e-6 * np.abs(before).max()
    stages = [Usd.Stage.Open(str(path)) for path in (source, out)]
    one, other = (np.array(stage.GetAttributeAtPath("/World/Army.extent").Get()) for stage in stages)
    assert np.allclose(one * (3.0 * size if below else 1.0), other)


@pytest.mark.parametrize("scales", [True, False])
def test_prototypes_below_and_beside_an_instancer_keep_their_sizes(scales: bool, tmp_path: Path) -> None:
    """The rock below it keeps its points and the hero beside it gets others, so their scales differ."""
    text = stage_of(below=False, scales=scales)
    text = text.replace(ROCK, "").replace("</World/P/Rock>", "</World/Army/Rock>")
    source = save(
        tmp_path, text.replace('def PointInstancer "Army"\n{', f'def PointInstancer "Army"\n{{\n{ROCK}')
    )
    out = tmp_path / "out.usda"
    cli("freeze", source, "-o", out, "--unit", "0.01", code=0)
    for time in (1.0, 5.0):
        before, after = drawn(source, time) * 100.0, drawn(out, time)
        assert np.abs(before - after).max() < 1e-6 * np.abs(before).max()


def test_instances_that_change_in_time_cannot_get_sizes_of_their_own(tmp_path: Path) -> None:
    text = stage_of(below=False, scales=True).replace(ROCK, "").replace("/World/P/Rock", "/World/Army/Rock")
    text = text.replace(
        "protoIndices = [0, 1, 0]", "protoIndices.timeSamples = { 1: [0, 1, 0], 5: [1, 0, 0] }"
    )
    source = save(
        tmp_path, text.replace('def PointInstancer "Army"\n{', f'def PointInstancer "Army"\n{{\n{ROCK}')
    )
    printed = cli("freeze", source, "-o", tmp_path / "out.usda", "--unit", "0.01", code=3).output
    assert "Prototypes of </World/Army> would get different sizes, and its instances change" in printed


def test_instances_stay_where_they_are_with_another_up_axis(tmp_path: Path) -> None:
    text = stage_of(below=True, scales=True)
    more = "vector3f[] accelerations = [(1, 2, 3), (0, 0, 1), (0, 1, 0)]"
    text = text.replace("int[] protoIndices", f"{more}\n    int[] protoIndices")
    source, out = save(tmp_path, text), tmp_path / "out.usda"
    cli("freeze", source, "-o", out, "--up-axis", "z", code=0)
    for time in (1.0, 5.0):
        before, after = drawn(source, time), drawn(out, time)
        assert np.abs(before[:, [0, 2, 1]] * (1, -1, 1) - after).max() < 1e-6 * np.abs(before).max()
    stage = Usd.Stage.Open(str(out))
    army = UsdGeom.PointInstancer(stage.GetPrimAtPath("/World/Army"))
    assert np.allclose(army.GetAccelerationsAttr().Get()[0], (1, -3, 2))
    assert np.allclose(army.GetScalesAttr().Get(), [(1, 1, 1), (2, 1, 1), (1, 1, 1.5)])
    assert np.allclose(army.GetExtentAttr().Get(), [(-1, -5, -1), (7, 1, 2)])


def test_what_an_instancer_draws_is_not_turned(tmp_path: Path) -> None:
    turned = 'double xformOp:rotateY = 30\nuniform token[] xformOpOrder = ["xformOp:rotateY"]'
    source = save(tmp_path, stage_of(below=False, scales=True, above=turned))
    printed = cli("freeze", source, "-o", tmp_path / "out.usda", code=3).output
    assert "What </World/Army> draws would be turned" in printed
    assert not (tmp_path / "out.usda").exists()


@pytest.mark.parametrize("specifier", ["over", "class"])
@pytest.mark.parametrize(
    ("options", "size"), [(["--unit", "0.01"], 100.0), (["--scale"], 1.0)], ids=["unit", "scale"]
)
def test_prototypes_that_are_no_prims_of_the_scene_keep_their_points_and_look(
    options: list[str], size: float, specifier: str, tmp_path: Path
) -> None:
    """Below an over or a class instancers alone draw them, and no edit reaches them."""
    text = stage_of(below=False, scales=True, above=SCALED)
    text = text.replace('def Xform "P"', f'{specifier} Xform "P"')
    hero = scene(skeleton(), animation(), MESH).partition("def SkelRoot")[2]
    above = f'def Xform "World"\n{{\n{SCALED}\ndef SkelRoot{hero.replace("/Root/", "/World/Root/")}'
    source = save(tmp_path, text.replace('def Xform "World"\n{', above))
    out = tmp_path / "out.usda"
    cli("freeze", source, "-o", out, *options, code=0)
    for time in (1.0, 5.0):
        before, after = drawn(source, time) * size, drawn(out, time)
        assert np.abs(before - after).max() < 1e-6 * np.abs(before).max()


def test_a_skeleton_below_a_class_alone_is_told_where_it_is(tmp_path: Path) -> None:
    text = scene(skeleton(), animation(), MESH).replace("def SkelRoot", "class SkelRoot")
    source = save(tmp_path, f'{text}\ndef Xform "World"\n{{\n}}\n')
    printed = cli("orient-joints", source, "-o", tmp_path / "out.usda", code=3).stderr
    assert "</Root/Skel> is no prim of the scene, because </Root> is a class" in printed


@pytest.mark.parametrize("specifier", ["class", "over"])
def test_what_a_skeleton_outside_of_the_scene_plays_is_left_as_it_is(specifier: str, tmp_path: Path) -> None:
    """UsdSkel skins a mesh by it, wherever it is."""
    bound = skeleton().replace("def Skeleton", f"{specifier} Skeleton")
    source, out = save(tmp_path, scene(bound, animation(), MESH)), tmp_path / "out.usda"
    printed = cli("orient-joints", source, "-o", out, code=3).stderr
    assert "</Root/Skel> is no prim of the scene" in printed
    other = scene(skeleton(), animation(), MESH).partition("def SkelRoot")[2].replace("/Root", "/Other")
    text = source.read_text() + "def SkelRoot" + other.replace('"Root"', '"Other"')
    beside = save(tmp_path, text, "beside.usda")
    cli("orient-joints", beside, "-o", out, code=0)
    before, after = (skinned(Usd.Stage.Open(str(path)), Usd.TimeCode(3)) for path in (beside, out))
    assert all(np.abs(before[path] - after[path]).max() < 1e-5 for path in ("/Root/Skin", "/Other/Skin"))


HALVES = "quath[] orientations = [(1, 0, 0, 0), (0.7071, 0, 0.7071, 0), (0.5, 0.5, 0.5, 0.5)]"
TILTED = "[(0.99985, 0, 0.01745, 0), (0.99985, 0.01745, 0, 0), (0.9239, 0, 0.3827, 0)]"
TURNS = {
    "unit": (HALVES.replace("(0.7071, 0, 0.7071, 0)", "(0, 0, 1, 0)"), 1e-6, False),
    "quarter": (HALVES, 2.5e-4, True),
    "tilted": (f"quath[] orientations = {TILTED}", 2.5e-4, True),
    "moved": (f"quath[] orientations.timeSamples = {{\n1: {TILTED},\n5: {TILTED},\n}}", 2.5e-4, True),
    "float": ("quatf[] orientationsf = [(1, 0, 0, 0), (1, 0.0001, 0, 0), (1, 0, 0, -0.0001)]", 1e-6, False),
}


@pytest.mark.parametrize("below", [True, False], ids=["below", "beside"])
@pytest.mark.parametrize("turns", TURNS)
def test_instances_are_nodes_of_gltf_where_they_are_drawn(below: bool, turns: str, tmp_path: Path) -> None:
    """Each instance has a place on a line, and a skin with the motion of its prototype.

    OpenUSD makes matrices of half floats as they are, so that they scale a little; glTF has unit rotations.
    """
    orientations, most, told = TURNS[turns]
    source = save(tmp_path, stage_of(below=below, scales=True, above=SCALED).replace(HALVES, orientations))
    out = tmp_path / "out.glb"
    ran = cli("convert", source, "-o", out, code=0)
    assert ("not converted" in ran.stderr) is told
    assert (
        "how OpenUSD draws instances of </World/Army> by rotations" in " ".join(ran.stderr.split())
    ) is told
    document = read(out)
    rig = document.rig
    (clip,) = rig.clips
    army = set(rig.below(rig.find("Army")))
    for time in (1.0, 5.0):
        world = worlds(rig, locals_at(rig, clip, np.array([time / 24.0])))
        found = [deformed(m, rig, world, np.zeros((1, 0)))[0] for m in document.meshes() if m.node in army]
        expected = drawn(source, time)
        assert np.abs(np.concatenate(found) - expected).max() < most * np.abs(expected).max()


def test_instancers_that_would_be_too_many_nodes_are_reported_and_not_converted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two characters of four prims and three joints each, and a rock: 18 nodes, as each gets one above it."""
    source = save(tmp_path, stage_of(below=True, scales=False))
    for most in (18, 17):
        monkeypatch.setattr(usd_instances, "MOST_NODES", most)
        ran = cli("convert", source, "-o", tmp_path / f"{most}.glb", code=0)
        assert ("PointInstancer </World/Army> with its prototypes" in " ".join(ran.stderr.split())) == (
            most < 18
        )


def test_instancers_whose_instances_come_and_go_are_reported_and_not_converted(tmp_path: Path) -> None:
    text = stage_of(below=True, scales=False).replace(
        "int[] protoIndices = [0, 1, 0]",
        "int[] protoIndices.timeSamples = {\n1: [0, 1, 0],\n3: [1, 1, 0],\n}",
    )
    source = save(tmp_path, text)
    ran = cli("convert", source, "-o", tmp_path / "out.glb", code=0)
    assert "not converted: PointInstancer </World/Army> with its prototypes" in " ".join(ran.stderr.split())
