"""Files that a pipeline holds as objects of pygltflib: read, changed and handed back, nothing lost."""

from __future__ import annotations

import base64
import json
import os
from pathlib import Path
from typing import Any

import pytest
from numpy.testing import assert_array_equal
from places import ASSETS, NO_ASSETS, SAMPLES
from pygltflib import GLTF2

from rigtri import from_pygltflib, orient_joints, read, to_pygltflib, verify, write
from rigtri.errors import DeviationError, FileError, UsageError

# A blob, a file beside it, data in the text; compressed views, and an avatar's extensions.
FILES = [
    SAMPLES / "biped.glb",
    SAMPLES / "biped.gltf",
    ASSETS / "gltf" / "khronos_RiggedSimple_Embedded.gltf",
    ASSETS / "gltf" / "gltfpack_cc_kn_godot_enemy.glb",
    ASSETS / "vrm" / "addon_look_at_preview_enabled.vrm",
]


def held(source: Path) -> GLTF2:
    if not source.exists():
        pytest.skip(NO_ASSETS)
    return (GLTF2.load_json if source.suffix == ".gltf" else GLTF2.load_binary)(source)


def text(gltf: GLTF2) -> Any:
    return json.loads(gltf.gltf_to_json())


def saved(gltf: GLTF2, folder: Path) -> Path:
    """What pygltflib's own writer makes of an object; ``save`` would look for its files in the new folder."""
    path = folder / "saved.glb"
    path.write_bytes(b"".join(gltf.save_to_bytes()))
    return path


@pytest.mark.parametrize("source", FILES, ids=lambda path: path.name)
def test_what_pygltflib_keeps_is_kept(source: Path) -> None:
    gltf = held(source)
    before, blob = text(gltf), gltf.binary_blob()
    rig = from_pygltflib(gltf)
    same = to_pygltflib(rig)
    assert text(same) == before
    assert same.binary_blob() == blob
    turned = to_pygltflib(orient_joints(rig, aim="z", up="-x"))
    assert (text(gltf), gltf.binary_blob()) == (before, blob), "the object that was given has changed"
    after = text(turned)
    assert after["nodes"] != before["nodes"]
    numbers = {"nodes", "animations", "skins", "accessors", "bufferViews", "buffers", "extensions"}
    assert {k: v for k, v in after.items() if k not in numbers} == {
        k: v for k, v in before.items() if k not in numbers
    }
    names = [node.get("name") for node in before["nodes"]]
    assert [node.get("name") for node in after["nodes"]] == names


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.gltf"])
def test_it_looks_the_same_and_is_what_the_file_would_become(name: str, tmp_path: Path) -> None:
    rig = orient_joints(from_pygltflib(held(SAMPLES / name)), aim="z", up="-x")
    made = saved(to_pygltflib(rig), tmp_path)
    assert verify(SAMPLES / name, made).passes()
    from_file = orient_joints(read(SAMPLES / name), aim="z", up="-x")
    write(from_file, tmp_path / name)
    assert_array_equal(read(made).rotation, read(tmp_path / name).rotation)


@pytest.mark.ci
def test_it_is_written_as_a_file_too(tmp_path: Path) -> None:
    rig = orient_joints(from_pygltflib(held(SAMPLES / "biped.gltf")))
    write(rig, tmp_path / "out.glb")
    assert {path.name for path in tmp_path.iterdir()} == {"out.glb", "biped.bin"}
    assert verify(SAMPLES / "biped.gltf", tmp_path / "out.glb").passes()


@pytest.mark.ci
def test_an_object_that_was_made_and_never_loaded(tmp_path: Path) -> None:
    loaded = held(SAMPLES / "biped.gltf")
    content = (SAMPLES / "biped.bin").read_bytes()
    made = GLTF2.from_dict(loaded.to_dict())
    made.buffers[0].uri = "data:application/octet-stream;base64," + base64.b64encode(content).decode()
    turned = to_pygltflib(orient_joints(from_pygltflib(made)))
    assert verify(SAMPLES / "biped.gltf", saved(turned, tmp_path)).passes()


def test_what_is_wrong_with_an_object_is_reported_as_of_a_file(tmp_path: Path) -> None:
    broken = held(SAMPLES / "biped.glb")
    broken.nodes[0].children = [99]
    with pytest.raises(FileError, match=r"biped\.glb: nodes\[0\].*99"):
        from_pygltflib(broken)
    lost = held(SAMPLES / "biped.gltf")
    lost._path = tmp_path
    with pytest.raises(FileError, match=r"biped\.bin"):
        from_pygltflib(lost)
    rig = orient_joints(from_pygltflib(held(SAMPLES / "biped.glb")))
    with pytest.raises(DeviationError):
        to_pygltflib(rig, tolerance=0.0)
    with pytest.raises(UsageError, match="from_pygltflib"):
        to_pygltflib(read(SAMPLES / "biped.gltf"))
    assert not os.listdir(tmp_path)


def test_an_object_whose_buffer_is_not_there_is_refused() -> None:
    gltf = held(SAMPLES / "biped.glb")
    gltf.set_binary_blob(None)
    with pytest.raises(FileError):
        write(from_pygltflib(gltf), os.devnull)
