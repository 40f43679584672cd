"""Where indices stand in a glTF, members of a wrong type, and extensions wherever objects have them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from rigtri.verification.checks.gltf.references import (
    _check_members,
    _fits,
    _found,
    _pointer_text,
    extensions,
)

GLTF: dict[str, Any] = {
    "meshes": [
        {"primitives": [{"attributes": {"POSITION": 1, "NORMAL": 2}, "indices": 3}, {"indices": 4}]},
        {"primitives": [{"attributes": {"POSITION": 5}, "targets": [{"POSITION": 6}]}, 7], "name": "body"},
        {"primitives": "none"},
    ],
    "nodes": [{"camera": 0}, {}, {"camera": "x"}],
}


@pytest.mark.parametrize(
    ("path", "found"),
    [
        ("nodes/*/camera", {"/nodes/0/camera": 0, "/nodes/2/camera": "x"}),
        (
            "meshes/*/primitives/*/indices",
            {"/meshes/0/primitives/0/indices": 3, "/meshes/0/primitives/1/indices": 4},
        ),
        (
            "meshes/*/primitives/*/attributes/*",
            {
                "/meshes/0/primitives/0/attributes/POSITION": 1,
                "/meshes/0/primitives/0/attributes/NORMAL": 2,
                "/meshes/1/primitives/0/attributes/POSITION": 5,
            },
        ),
        ("meshes/*/primitives/*/targets/*/*", {"/meshes/1/primitives/0/targets/0/POSITION": 6}),
        ("skins/*/joints", {}),
        ("nodes", {"/nodes": GLTF["nodes"]}),
    ],
)
def test_what_stands_at_a_path_is_found_with_its_pointer(path: str, found: dict[str, Any]) -> None:
    assert dict(_found(GLTF, path.split("/"), "")) == found


def test_a_place_is_called_by_its_thing_and_primitive() -> None:
    view: Any = SimpleNamespace(raw=GLTF)
    assert _pointer_text(view, "/meshes/1/primitives/0/indices") == "mesh 'body' (#1), primitive 0"
    assert _pointer_text(view, "/nodes/2/camera") == "node #2"


class Noted:
    """An item of a file with what is added to it."""

    def __init__(self, raw: dict[str, Any]) -> None:
        self.raw, self.added = raw, list[tuple[str, ...]]()

    def add(self, *words: str) -> None:
        self.added.append(words)


KINDS = {"count": "integer", "name": "text", "joints": "list", "extras": "object", "normalized": "boolean"}


@pytest.mark.parametrize(
    ("raw", "text"),
    [
        ({"count": True}, "count should be an integer, not true"),
        ({"count": 1.5}, "count should be an integer, not 1.5"),
        ({"name": 1}, "name should be a text, not 1"),
        ({"joints": {}}, "joints should be a list, not {}"),
        ({"extras": []}, "extras should be an object, not []"),
        ({"normalized": 1}, "normalized should be a boolean, not 1"),
        ({"count": 0, "name": "", "joints": [], "extras": {}, "normalized": False, "more": 1}, ""),
        ({}, ""),
    ],
)
def test_members_of_another_type_are_told(raw: dict[str, Any], text: str) -> None:
    item: Any = Noted(raw)
    _check_members(item, KINDS)
    if text:
        ((rule, said, key),) = item.added
        assert (rule, key) == ("gltf.json.value", next(iter(raw)))
        assert said.lower() == text
    assert bool(item.added) == bool(text) == (not _fits(raw, KINDS))


def test_extensions_are_found_wherever_objects_have_them_but_not_in_extras() -> None:
    gltf = {
        "extensions": {"A": {"inner": {"extensions": {"B": {}}}}},
        "nodes": [{"extensions": {"C": {}}}, {"extensions": {"C": {}, "D": 1}}, {"extensions": "none"}],
        "extras": {"extensions": {"E": {}}},
        "meshes": [{"extras": {"extensions": {"F": {}}}, "primitives": [[{"extensions": {"G": {}}}]]}],
    }
    found = extensions(gltf)
    assert set(found) == {"A", "B", "C", "D", "G"}
    assert found["A"] == "/extensions"
    assert found["B"] == "/extensions/A/inner/extensions"
    assert found["C"] in ("/nodes/0/extensions", "/nodes/1/extensions")
    assert found["D"] == "/nodes/1/extensions"
    assert found["G"] == "/meshes/0/primitives/0/0/extensions"
