"""strip of files with values of other types, where nothing else looks: an error of the file, and where."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from gltf_files import character, glb_bytes, glb_parts
from program import cli


@pytest.mark.parametrize(
    ("place", "wrong"),
    [
        (("nodes", -1, "mesh"), []),
        (("nodes", -1, "mesh"), "x"),
        (("nodes", -1, "mesh"), 2**63),
        (("meshes", -1, "primitives"), 1e30),
        (("meshes", -1, "primitives", 0), None),
        (("meshes", -1, "primitives", 0, "material"), {"a": None}),
        (("materials", 0), True),
        (("materials",), 99),
        (("accessors", -1, "bufferView"), "x"),
        (("accessors", -1, "bufferView"), 2**63),
        (("accessors", -1, "byteOffset"), {}),
        (("accessors", 5, "count"), None),
        (("bufferViews", -1, "byteLength"), {}),
        (("animations", 0, "channels", 0, "target"), None),
        (("animations", 0, "channels", 0, "target"), [[]]),
        (("animations", 0, "channels", 0, "target", "node"), []),
    ],
    ids=str,
)
def test_what_is_no_index_count_or_object_is_refused(
    place: tuple[Any, ...], wrong: Any, tmp_path: Path
) -> None:
    character().glb(path := tmp_path / "in.glb")
    rigged = tmp_path / "rigged.glb"
    assert cli("add-controls", path, "-o", rigged, "--joints", "*").exit_code == 0
    gltf, binary = glb_parts(rigged)
    holder: Any = gltf
    for key in place[:-1]:
        holder = holder[key]
    holder[place[-1]] = wrong
    rigged.write_bytes(glb_bytes(json.dumps(gltf).encode(), binary))
    done = cli("strip", rigged, "-o", tmp_path / "out.glb")
    assert done.exit_code in (0, 3), done.stderr
    assert done.exit_code == 0 or f"rigged.glb: {place[0]}" in done.stderr
