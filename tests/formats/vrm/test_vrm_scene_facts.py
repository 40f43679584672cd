"""What VRM states besides axes, all of it, of a small file: what `verify` compares."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from gltf_files import small

from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.json_values import Value
from rigtri.formats.vrm.bindings import CONSTRAINT, Bindings, Follows, report_cycles, stored
from rigtri.formats.vrm.scene_facts import read_facts
from rigtri.formats.vrm.vrm0 import demand
from rigtri.model.scene_facts import Reference

PLACE = [10, 11, 12, 13]


def _facts(vrm: Any, turned: Any = ()) -> dict[str, Any]:
    """Facts of VRMC_vrm, of four nodes, whose places in the rig begin at 10."""
    return _plain(read_facts({"nodes": [{}] * 4, "extensions": {"VRMC_vrm": vrm}}, PLACE, turned)[0])


def _plain(value: Any) -> Any:
    """Facts with words for references: #11, or shown #11."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return f"shown #{value.node}" * value.shows or f"#{value.node}" if isinstance(value, Reference) else value


@pytest.mark.parametrize(
    ("block", "facts"),
    [
        ({"a": {"b": 1, "c": [2, "x"]}}, {"a b": 1, "a c 0": 2, "a c 1": "x"}),
        ({"a": {}, "b": []}, {"a": "empty", "b": "empty"}),
        ({"a": {"extras": 1, "b": True}}, {"a b": True}),
        ({"node": 2}, {"node": "#12"}),
        ({"node": 4, "center": -1}, {"node": 4, "center": -1}),
        ({"joints": [{"node": 1}]}, {"joints 0 node": "#11"}),
        ({"bones": [0, 3]}, {"bones": ["#10", "#13"]}),
        ({"meshAnnotations": [{"node": 1}]}, {"meshAnnotations 0 node": "shown #11"}),
        ({"morphTargetBinds": [{"node": 1}]}, {"morphTargetBinds 0 node": "shown #11"}),
        # Axes of constraints alone are left out by their names.
        ({"rollAxis": "X"}, {"rollAxis": "X"}),
    ],
    ids=str,
)
def test_numbers_and_words_are_facts_by_the_way_to_them(block: Any, facts: dict[str, Any]) -> None:
    assert _facts(block) == {f"VRMC_vrm {way}": value for way, value in facts.items()}


def test_vectors_that_are_compared_in_the_world_are_left_out_and_others_are_not() -> None:
    block = {"lookAt": {"offsetFromHeadBone": [1, 2]}, "other": {"offsetFromHeadBone": [3]}}
    turned = [("extensions", "VRMC_vrm", "lookAt", "offsetFromHeadBone")]
    assert _facts(block, turned) == {"VRMC_vrm other offsetFromHeadBone 0": 3}


def test_blocks_deeper_than_any_are_compared_whole() -> None:
    deep: Any = 1
    for _ in range(30):
        deep = [deep]
    ((way, value),) = _facts(deep).items()
    assert way == "VRMC_vrm" + " 0" * 23
    assert value == [[[[[[[1]]]]]]]


def test_constraints_are_facts_of_their_nodes_but_for_their_axes() -> None:
    rule = {"specVersion": "1.0", "constraint": {"roll": {"source": 3, "rollAxis": "Y", "weight": 0.5}}}
    nodes = [{}, {"extensions": {CONSTRAINT: rule}}, {"extensions": {"OTHER": {}}}, {"extensions": 1}]
    whole, found = read_facts({"nodes": nodes}, PLACE, ())
    assert whole == {}
    assert _plain(found) == {
        11: {
            f"{CONSTRAINT} specVersion": "1.0",
            f"{CONSTRAINT} constraint roll source": "#13",
            f"{CONSTRAINT} constraint roll weight": 0.5,
        }
    }


@pytest.mark.parametrize(
    ("kind", "axis", "words"),
    [
        ("roll", (0, -1, 0), {"rollAxis": "Y"}),
        ("aim", (0, -1, 0), {"aimAxis": "NegativeY"}),
        ("aim", (0, 0, 1), {"aimAxis": "PositiveZ"}),
        ("rotation", (0, 0, 0), {}),
    ],
)
def test_a_new_constraint_states_its_axis_where_it_has_one(kind: str, axis: Any, words: Any) -> None:
    assert stored(kind, 7, axis)["constraint"] == {kind: words | {"source": 7, "weight": 1.0}}


def _noticed(above: list[int], *follows: tuple[int, int], kind: str = "rotation") -> list[str]:
    found = Bindings()
    found.constraints += [Follows(kind, node, source) for node, source in follows]
    report_cycles(above, found)
    return [notice.text for notice in found.notices]


def test_a_constraint_on_what_is_below_waits_for_itself() -> None:
    """A node stands once its parent does and what drives it does; the end of a chain hangs along."""
    assert _noticed([-1, 0, 1], (0, 2)) == [
        "The constraints of nodes #0 form a cycle, so viewers do not evaluate them"
    ]
    assert _noticed([-1, 0, 1], (2, 0)) == []
    assert _noticed([-1, -1], (1, 0)) == []
    assert _noticed([-1, 0, 1], (0, 2), kind="tail") == []


def test_a_bone_of_the_humanoid_is_turned_although_it_shows_something() -> None:
    """And so is what stands above it; what swings and shows something keeps its axes."""
    gltf = {"nodes": [{}, {}, {"mesh": 0}, {"mesh": 0}, {}], "meshes": [{}]}
    found = Bindings(bones={3, 4}, humanoid={"head": 2})
    demand(Value(gltf, "a.vrm"), [-1, 0, 1, 0, 0], found)
    assert found.bones == {0, 1, 2, 4}


def test_a_file_gives_facts_to_the_nodes_of_its_rig(tmp_path: Path) -> None:
    builder = small()
    rule = {"specVersion": "1.0", "constraint": {"aim": {"source": 2, "aimAxis": "NegativeX"}}}
    builder.gltf["nodes"][1]["extensions"] = {CONSTRAINT: rule}
    document = GltfDocument.read(builder.glb(tmp_path / "a.vrm"))
    joint = document.rig.names.index
    facts = document.scene_facts(closely=True).own[joint("joint 1")]
    assert _plain(facts)[f"{CONSTRAINT} constraint aim source"] == f"#{joint('joint 2')}"
