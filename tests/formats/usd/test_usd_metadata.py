"""Prims and notes of our own: written, found again, brought up to date."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from program import cli
from pxr import Sdf, Usd, UsdGeom
from second_opinions import usd_errors
from usd_files import MESH, animation, deviation, read, save, scene, skeleton, write

from rigtri.formats.usd.reading import metadata_attributes
from rigtri.maths.quaternions import IDENTITY, unit
from rigtri.model.metadata import ConstraintRecord
from rigtri.model.rig import Rig

POLE = {
    "v": 1,
    "type": "poleVector",
    "chain": ["a", "b", "c"],
    "reach": 0.5,
    "normal": [0.0, 0.6, 0.8],
    "weights": [1.0, 2.0],
    "locked": True,
    "from": "middle",
    "clips": [{"clip": "Anim", "at": [{"time": 1.5, "what": "straight"}]}],
    "nested": {"deep": {"word": "x"}, "none": []},
}
PLACE = """double3 xformOp:translate = (1, 2, 3)
double3 xformOp:scale = (10, 10, 10)
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]"""


def located(rig: Rig, rotation: Any = IDENTITY) -> Rig:
    """The rig with a group and a pole vector at (4, 5, 6) in the world."""
    n = len(rig)
    rig = rig.with_nodes(
        ["rigtri_controls", "b_pole"],
        [-1, n],
        np.array([(0, 0, 0), (4.0, 5, 6)]),
        np.array([IDENTITY, rotation]),
    )
    return replace(rig, metadata={**rig.metadata, n: {"v": 1, "type": "group"}, n + 1: POLE})


def test_a_locator_stands_under_the_scope_of_the_skeletons_top_prim(tmp_path: Path) -> None:
    source = save(tmp_path, scene(PLACE, skeleton(), animation(), MESH))
    document = read(source)
    rotation = unit([1.0, 2, 3, 4])
    out = write(document, located(document.rig, rotation), tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(out))
    assert stage.GetPrimAtPath("/Root/rigtri").GetTypeName() == "Scope"
    pole = stage.GetPrimAtPath("/Root/rigtri/b_pole")
    world = np.array(UsdGeom.Xformable(pole).ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
    assert_allclose(world[3, :3], (4, 5, 6))
    assert_allclose(np.linalg.norm(world[:3, :3], axis=1), 1)  # not ten times too big
    assert pole.GetAttribute("rigtri:chain").GetTypeName() == "token[]"
    assert pole.GetAttribute("rigtri:normal").GetTypeName() == "double3"
    assert pole.GetAttribute("rigtri:type").GetTypeName() == "token"
    assert pole.GetAttribute("rigtri:v").GetTypeName() == "int"
    assert pole.GetAttribute("userProperties:rigtri_chain").Get() == "a, b, c"
    assert deviation(source, out) == 0
    assert not usd_errors(out) - usd_errors(source)


def test_a_locator_without_a_rotation_has_no_orient(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH)))
    out = write(document, located(document.rig), tmp_path / "out.usda")
    assert 'xformOpOrder = ["xformOp:translate"]' in out.read_text()


def test_locators_are_found_again_and_the_second_run_changes_no_byte(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(PLACE, skeleton(), animation(), MESH)))
    out = write(document, located(document.rig), tmp_path / "out.usda")
    again = read(out)
    pole = again.rig.find("b_pole")
    assert again.rig.metadata[pole] == POLE
    assert again.rig.metadata[again.rig.find("rigtri")] == {"v": 1, "type": "group"}
    assert not again.rig.has_matrix[pole]
    assert_allclose(again.rig.world[pole, 3, :3], (4, 5, 6))
    same = replace(again.rig, metadata=dict(again.rig.metadata))
    assert write(again, same, tmp_path / "second.usda").read_bytes() == out.read_bytes()


def test_a_locator_is_moved_renamed_and_annotated_in_place(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH)))
    again = read(write(document, located(document.rig), tmp_path / "out.usda"))
    pole = again.rig.find("b_pole")
    translation = again.rig.translation.copy()
    translation[pole] = (7, 8, 9)
    names = [*again.rig.names]
    names[pole] = "knee"
    note = {key: value for key, value in POLE.items() if key != "reach"} | {"from": "end"}
    rig = replace(
        again.rig, names=tuple(names), translation=translation, metadata={**again.rig.metadata, pole: note}
    )
    third = read(write(again, rig, tmp_path / "third.usda")).rig
    assert third.metadata[third.find("knee")] == note
    assert_allclose(third.translation[third.find("knee")], (7, 8, 9))
    assert "b_pole" not in third.names


@pytest.mark.parametrize(
    "order", [("!reset", "translate"), ("scale", "!reset", "translate"), ("translate", "!reset")]
)
def test_a_locator_that_follows_nothing_is_moved_alone(order: tuple[str, ...], tmp_path: Path) -> None:
    """Ops before !resetXformStack! do nothing. Before, a new place lost the reset, and was below /Root's."""
    document = read(save(tmp_path, scene(PLACE, skeleton(), animation(), MESH)))
    out = write(document, located(document.rig), tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(out))
    words = ["!resetXformStack!" if op == "!reset" else f"xformOp:{op}" for op in order]
    stage.GetPrimAtPath("/Root/rigtri/b_pole").GetAttribute("xformOpOrder").Set(words)
    stage.Save()
    again = read(out)
    pole = again.rig.find("b_pole")
    assert again.rig.parents[pole] == -1
    translation = again.rig.translation.copy()
    translation[pole] = (7, 8, 9)
    third = write(again, replace(again.rig, translation=translation), tmp_path / "third.usda")
    stage = Usd.Stage.Open(str(third))
    prim = stage.GetPrimAtPath("/Root/rigtri/b_pole")
    assert_allclose(np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(0))[3, :3], (7, 8, 9))


def test_relationships_follow_when_what_is_above_their_target_is_renamed(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH)))
    rig = located(document.rig)
    rig = replace(rig, metadata={**rig.metadata, 0: {"v": 1, "type": "frame", "frame": "b_pole"}})
    again = read(write(document, rig, tmp_path / "out.usda"))
    names = [*again.rig.names]
    names[again.rig.find("rigtri")] = "moved"
    stage = Usd.Stage.Open(str(write(again, replace(again.rig, names=tuple(names)), tmp_path / "third.usda")))
    found = [
        target
        for prim in stage.Traverse()
        for relation in prim.GetRelationships()
        if relation.GetName().startswith("rigtri:")
        for target in relation.GetTargets()
    ]
    assert Sdf.Path("/Root/moved/b_pole") in found
    assert all(stage.GetPrimAtPath(target) for target in found)


def test_a_second_locator_joins_the_first(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH)))
    again = read(write(document, located(document.rig), tmp_path / "out.usda"))
    group = again.rig.find("rigtri")
    rig = again.rig.with_nodes(["b_pole"], [group], np.ones((1, 3)), IDENTITY[np.newaxis])
    third = read(write(again, rig, tmp_path / "third.usda")).rig
    assert [label for label in third.labels if "rigtri/" in label] == [
        "/Root/rigtri/b_pole",
        "/Root/rigtri/b_pole_2",
    ]


def test_a_prim_called_rigtri_that_is_not_ours_is_left_alone(tmp_path: Path) -> None:
    document = read(save(tmp_path, scene(skeleton(), animation(), MESH, 'def Xform "rigtri" {}')))
    third = read(write(document, located(document.rig), tmp_path / "out.usda")).rig
    assert "/Root/rigtri_2/b_pole" in third.labels


def test_metadata_of_joints_lies_in_attributes_of_the_skeleton(tmp_path: Path) -> None:
    source = save(tmp_path, scene(skeleton(), animation(), MESH))
    document = read(source)
    found = {
        document.rig.find("b"): {"v": 1, "type": "frame", "invented": True},
        document.rig.find("c"): POLE,
    }
    out = write(document, replace(document.rig, metadata=found), tmp_path / "out.usda")
    again = read(out)
    assert {again.rig.names[node]: note for node, note in again.rig.metadata.items()} == {
        "b": {"v": 1, "type": "frame", "invented": True},
        "c": POLE,
    }
    bare = write(again, replace(again.rig, metadata={}), tmp_path / "bare.usda")
    assert "rigtri" not in bare.read_text()


@pytest.mark.parametrize(
    "value",
    [0, -5, 2**40, 1.5, True, "", 'ü "q"', [], ["x"], [1.0], [1.0, 2.0, 3.0], None, {}, [[1]], {"a": {}}],
)
def test_any_json_value_reads_back(value: Any) -> None:
    note = {"type": "t", "value": value}
    stage = Usd.Stage.CreateInMemory()
    prim = stage.DefinePrim("/A")
    for name, (type_name, stored) in metadata_attributes.attributes_of(note).items():
        prim.CreateAttribute(name, type_name).Set(stored)
    Sdf.Layer.CreateAnonymous().ImportFromString(stage.GetRootLayer().ExportToString())
    assert metadata_attributes.read_prim(prim) == note
    for name, (type_name, stored) in metadata_attributes.joint_attributes({"a/b": note}).items():
        prim.CreateAttribute(name, type_name).Set(stored)
    assert metadata_attributes.read_joints(prim) == {"a/b": note}


PROP = 'def Xform "Prop"\n{\n}\n'


def constrained(rig: Rig) -> list[tuple[str, list[str]]]:
    """Where each constraint's child is, "" for one that is not there, and its drivers."""
    found = []
    for record in rig.records(ConstraintRecord).values():
        nodes = [rig.known(name) for name in (record.child, *record.drivers)]
        child, *drivers = ("" if node is None else rig.labels[node] for node in nodes)
        found.append((child, drivers))
    return found


def test_what_a_reference_does_not_bring_is_no_other_prim_of_its_name(tmp_path: Path) -> None:
    """A constraint on a prop beside the referenced prim, and one by such a prop."""
    save(tmp_path, scene(skeleton(), animation(), MESH) + PROP + PROP.replace("Prop", "Own"), "in.usda")
    for k, (child, *drivers) in enumerate((("/Prop", "b"), ("c", "/Own", "/Prop", "a"))):
        words = [word for driver in drivers for word in ("--driver", driver)]
        cli("constrain", tmp_path / "in.usda", "-o", tmp_path / "out.usda", "--child", child, *words, code=0)
        shot = f'#usda 1.0\n{PROP}def "A" (references = @./out.usda@</Root>)\n{{\n}}\n'
        assert constrained(read(save(tmp_path, shot, f"shot_{k}.usda")).rig) == [
            (("", ["a/b"]), ("a/b/c", ["", "", "a"]))[k]
        ]
        (tmp_path / "out.usda").unlink()


def test_a_constraint_that_a_prim_shows_again_leaves_what_lies_outside_to_its_source(tmp_path: Path) -> None:
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    one, other = (
        'def "A" (references = @./hero.usda@</Root>)\n{\n}\n',
        'def "B" (references = </A>)\n{\n}\n',
    )
    source, out = save(tmp_path, f"#usda 1.0\n{PROP}{one}{other}"), tmp_path / "out.usda"
    cli("constrain", source, "-o", out, "--child", "/Prop", "--driver", "/A/Skel:a/b", code=0)
    assert constrained(read(out).rig) == [("/Prop", ["/A/Skel:a/b"]), ("", ["/B/Skel:a/b"])]
    cli("strip", out, "-o", tmp_path / "plain.usda", code=0)
    assert (tmp_path / "plain.usda").read_text() == source.read_text()
