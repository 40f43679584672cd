"""Records on nodes: read without ever failing, written as they were, and described by the schema."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigtri.formats import read
from rigtri.model.constraints import constraint_of
from rigtri.model.metadata import (
    ADDED,
    RECORDS,
    ConstraintRecord,
    ControlRecord,
    OffsetRecord,
    PoleVectorRecord,
    PoseReaderRecord,
    RivetRecord,
    Stored,
    TargetRecord,
    _keys,
)
from rigtri.model.rig import Rig
from rigtri.operations.rigtri_nodes import add, group
from rigtri.pipeline.edit import edit
from rigtri.report import Report

SCHEMA = json.loads(Path("schemas/node.schema.json").read_text("utf-8"))
FORMS = SCHEMA["$defs"]
LIMB = ["arm", "elbow", "hand"]
CONTROL = {"joint": "hand", "mine": [1], "chain": LIMB, "kind": "ik", "v": 1, "type": "control", "soft": 0.25}
IDENTITY = tuple(float(row == column) for row in range(4) for column in range(4))
VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
)


def described(form: dict[str, Any], kind: type[Stored]) -> None:
    keys = {key.name: key for key in _keys(kind)}
    assert set(keys) == set(form["properties"]) - {"v", "type"}
    assert {name for name, key in keys.items() if key.required} == set(form["required"]) - {"v", "type"}
    for name, inner in form["properties"].items():
        for choice in inner.get("enum", ()) if name in keys else ():
            assert keys[name].read(choice) == choice
        if name in keys and "enum" in inner:
            assert keys[name].read("banana") is None
        if name in keys:
            assert keys[name].required or keys[name].default in ("", (), None, False)  # what is not stored


@pytest.mark.parametrize("name", sorted(RECORDS))
def test_records_are_what_the_schema_describes(name: str) -> None:
    described(FORMS[name], RECORDS[name])


def test_the_schema_describes_every_record() -> None:
    assert set(SCHEMA["properties"]["type"]["enum"]) == set(RECORDS) == {*ADDED, "frame"}
    described(FORMS["poseReader"]["properties"]["targets"]["items"], TargetRecord)


def test_a_constraint_has_the_defaults_of_the_schema(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    record = ConstraintRecord(
        kind="orient", child="head", drivers=("spine",), weights=(1.0,), offsets=IDENTITY
    )
    made, form = constraint_of(rig, record), FORMS["constraint"]["properties"]
    assert made.order == form["rotateOrder"]["default"]
    assert made.space == form["space"]["default"]


def test_a_record_is_written_as_it_was_with_what_it_does_not_know() -> None:
    record = ControlRecord.from_dict(CONTROL)
    assert (record.kind, record.joint, record.soft, record.problems) == ("ik", "hand", 0.25, ())
    assert list(record.to_dict().items()) == list(CONTROL.items())
    changed = replace(record, joint="foot", stretch=True).to_dict()
    assert list(changed.items()) == [*(CONTROL | {"joint": "foot"}).items(), ("stretch", True)]
    made = ControlRecord(kind="fk", joint="hip")
    assert list(made.to_dict().items()) == [("v", 1), ("type", "control"), ("kind", "fk"), ("joint", "hip")]


def test_whole_numbers_may_be_floats_as_in_usd() -> None:
    stored = {"name": "button", "mesh": "body", "primitive": 0, "within": 1e-5}
    stored |= {"vertices": [0.0, 1.0, 9.0], "barycentric": [0.5, 0.5, 0]}
    record = RivetRecord.from_dict(stored)
    assert (record.vertices, record.barycentric, record.problems) == ((0, 1, 9), (0.5, 0.5, 0.0), ())
    assert record.to_dict() == stored


def test_what_cannot_be_used_is_named() -> None:
    record = ControlRecord.from_dict({"kind": "banana", "soft": "0.5"})
    assert record.problems == ("its kind is 'banana'", "its joint is missing", "its soft is '0.5'")
    assert (record.kind, record.joint, record.soft) == ("fk", "", None)


@pytest.mark.parametrize("kind", ["ik", "heel"])
@pytest.mark.parametrize("chain", [(), ("hand",), ("a", "b", "c", "d")])
def test_a_limb_has_three_joints(kind: str, chain: tuple[str, ...]) -> None:
    wrong = (f"its chain does not name the three joints of its limb: {list(chain)}",)
    assert ControlRecord.from_dict({"kind": kind, "joint": "hand", "chain": chain}).problems == wrong
    assert PoleVectorRecord.from_dict({"chain": chain}).problems == wrong


@pytest.mark.parametrize("kind", ["dot", "cone", "rbf"])
def test_a_target_of_a_pose_reader_is_somewhere(kind: str) -> None:
    here, turned = {"name": "a", "direction": [0, 1, 0]}, {"name": "b", "rotation": [0, 0, 0, 1]}
    stored = {"name": "r", "driver": "x", "frame": "", "axis": [1, 0, 0], "reader": kind, "within": 0.1}
    stored |= {"outputs": [], "targets": [here, turned]}
    wrong = "its target 'a' has no rotation" if kind == "rbf" else "its target 'b' has no direction"
    assert PoseReaderRecord.from_dict(stored).problems == (wrong,)
    assert PoseReaderRecord.from_dict({**stored, "targets": []}).problems == ("it has no targets",)


@pytest.mark.parametrize("number", [2**70, 2.9e201, -(2**70)])
def test_whole_numbers_are_those_that_an_array_takes(number: float) -> None:
    """Before, edits and bakes of a rivet at such a vertex ended with the traceback of an OverflowError."""
    stored = {"name": "r", "mesh": "m", "primitive": 0, "vertices": [0, 1, number]}
    stored |= {"barycentric": [1, 0, 0], "within": 0.1}
    (problem,) = RivetRecord.from_dict(stored).problems
    assert problem.startswith("its vertices is [0, 1, ")


def test_an_output_of_a_pose_reader_follows_one_of_its_targets() -> None:
    """Before, edits and bakes of such a reader ended with the traceback of a ValueError."""
    stored = {"name": "r", "driver": "x", "frame": "", "axis": [1, 0, 0], "reader": "dot", "within": 0.1}
    stored |= {"targets": [{"name": "a", "direction": [0, 1, 0]}]}
    stored |= {"outputs": [{"target": name, "joint": "y"} for name in "abb"]}
    wrong = "it drives something by its target 'b', which it does not have"
    assert PoseReaderRecord.from_dict(stored).problems == (wrong,)


@given(st.sampled_from(sorted(RECORDS)).map(RECORDS.__getitem__).flatmap(
    lambda kind: st.tuples(st.just(kind), st.dictionaries(
        st.sampled_from([key.name for key in _keys(kind)] or ["type"]), VALUES
    ))
))  # fmt: skip
def test_damaged_records_never_raise(damaged: tuple[type[Stored], dict[str, Any]]) -> None:
    kind, stored = damaged
    record = kind.from_dict(stored)
    assert not stored or record.problems or repr(record.to_dict()) == repr(stored)


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_damaged_record_is_reported_once_and_not_used(suffix: str, samples: Path, tmp_path: Path) -> None:
    """Before, it was passed over without a word."""
    file = tmp_path / f"in{suffix}"
    edit(samples / f"biped{suffix}", file, damaged)
    document = read(file)
    (notice,) = [one for one in document.warnings if one.code == "note-damaged"]
    assert "its kind is 'banana'" in notice.text
    assert not document.rig.records(ControlRecord)
    assert len(document.rig.nodes_of("control")) == 1  # strip finds it


def damaged(rig: Rig, report: Report) -> Rig:
    rig, parent = group(rig)
    rig, node = add(rig, "bad_ctl", parent, ControlRecord(kind="fk", joint="head"))
    stored = {**rig.metadata[node], "kind": "banana"}
    return replace(rig, metadata={**rig.metadata, node: stored})


@pytest.mark.parametrize(
    ("axes", "problems"),
    [
        ([0.0, 0.0, 0.6, 0.8], ()),
        ([0.0, 0.6, 0.8], ("its axes is [0.0, 0.6, 0.8]",)),
        ("0068", ("its axes is '0068'",)),
        ([0.0, 0.0, 0.6, "w"], ("its axes is [0.0, 0.0, 0.6, 'w']",)),
    ],
)
def test_a_row_of_numbers_has_as_many_as_it_should(axes: Any, problems: tuple[str, ...]) -> None:
    record = OffsetRecord.from_dict({"v": 1, "type": "offset", "kind": "fk", "joint": "a", "axes": axes})
    assert record.problems == problems
