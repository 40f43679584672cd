"""Files larger than memory should be asked to hold: copied by the kernel, looked at in parts."""

from __future__ import annotations

import errno
import gc
import json
import os
import struct
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from characters import Held
from gltf_files import Builder, character, glb_json, small

from rigtri.errors import FileError
from rigtri.files import mapped_file
from rigtri.files.atomic_write import fsync_while_writing
from rigtri.formats import read
from rigtri.formats.gltf import document, mesh_reader
from rigtri.formats.gltf.document import GltfDocument
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.edit import Outcome, edit
from rigtri.verification.compare.compare import self_check

GIB = 1 << 30
LIMIT = (1 << 32) - 1


def turn_all(path: Path, target: Path, **more: Any) -> Outcome:
    options = OrientJointsOptions(joints=("*",))
    return edit(path, target, lambda rig, report: orient_joints(rig, options=options, report=report), **more)


def behind_a_hole(b: Builder, size: int) -> dict[str, Any]:
    """The JSON of a file whose data lie behind ``size`` bytes that are a hole on the disk."""
    gltf: dict[str, Any] = json.loads(json.dumps(b.gltf))
    for view in gltf["bufferViews"]:
        view["byteOffset"] += size
    gltf["buffers"] = [{"byteLength": size + len(b.binary)}]
    return gltf


def holed_glb(path: Path, b: Builder, total: int) -> Path:
    """A GLB of ``total`` bytes that takes as much of the disk as its data."""
    length = 0
    for _ in range(2):  # the JSON says how large the hole is, and makes it smaller
        gltf = behind_a_hole(b, total - 28 - length - len(b.binary))
        text = json.dumps(gltf).encode()
        text += b" " * (-len(text) % 4)
        length = len(text)
    with path.open("wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, total) + struct.pack("<II", length, 0x4E4F534A) + text)
        file.write(struct.pack("<II", total - 28 - length, 0x004E4942))
        file.seek(total - len(b.binary))
        file.write(b.binary)
    return path


# --- copied by the kernel


@pytest.fixture
def all_mapped(monkeypatch: pytest.MonkeyPatch) -> None:
    """Treat files of any size as large."""
    monkeypatch.setattr(mapped_file, "MAP_FROM", 1)
    monkeypatch.setattr(mapped_file, "WORTHWHILE", 1)
    monkeypatch.setattr(document, "BUFFERING", 16)  # what is smaller is written in one go


def refuse(number: int) -> Any:
    def copy_file_range(*_: Any, **__: Any) -> int:
        raise OSError(number, os.strerror(number))

    return copy_file_range


def one_byte_at_a_time(source: int, target: int, count: int, offset_src: int) -> int:
    return os.write(target, os.pread(source, min(count, 1), offset_src))


def half_and_no_more(source: int, target: int, count: int, offset_src: int) -> int:
    return os.write(target, os.pread(source, count // 2, offset_src))


@pytest.mark.skipif(not hasattr(os, "copy_file_range"), reason="this system has no copy_file_range")
@pytest.mark.parametrize("way", ["kernel", "bytes", "half", "none", errno.EXDEV, errno.ENOSYS])
def test_a_mapped_file_is_copied_to_the_same_bytes_as_a_read_one(
    way: str | int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    source = character().glb(tmp_path / "a.glb", ((0x58595A57, b"keep me!"),))
    turn_all(source, tmp_path / "read.glb")
    request.getfixturevalue("all_mapped")
    if way == "none":
        monkeypatch.delattr(os, "copy_file_range")
    elif way != "kernel":
        fake = {"bytes": one_byte_at_a_time, "half": half_and_no_more}.get(str(way))
        monkeypatch.setattr(os, "copy_file_range", fake or refuse(int(way)))
    turn_all(source, tmp_path / "mapped.glb")
    assert (tmp_path / "mapped.glb").read_bytes() == (tmp_path / "read.glb").read_bytes()
    # And what does not change at all.
    edit(source, tmp_path / "same.glb", lambda rig, _: rig)
    assert (tmp_path / "same.glb").read_bytes() == source.read_bytes()


@pytest.mark.skipif(not hasattr(os, "copy_file_range"), reason="this system has no copy_file_range")
@pytest.mark.usefixtures("all_mapped")
def test_a_full_disk_is_an_error_and_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = character().glb(tmp_path / "a.glb")
    monkeypatch.setattr(os, "copy_file_range", refuse(errno.ENOSPC))
    with pytest.raises(FileError, match=os.strerror(errno.ENOSPC)):
        turn_all(source, tmp_path / "b.glb")
    assert [path.name for path in tmp_path.iterdir()] == ["a.glb"]


@pytest.mark.skipif(not hasattr(os, "fdatasync"), reason="this system has no fdatasync")
def test_a_large_file_goes_to_the_disk_while_it_is_written(
    tmp_path: Path, all_mapped: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced = threading.Event()

    def fdatasync(_: int) -> None:
        synced.set()
        raise OSError(errno.EIO, "told by the sync that counts")

    def copy_when_synced(source: int, target: int, count: int, offset_src: int) -> int:
        assert synced.wait(60)
        return os.write(target, os.pread(source, count, offset_src))

    monkeypatch.setattr(os, "fdatasync", fdatasync)
    monkeypatch.setattr(os, "copy_file_range", copy_when_synced, raising=False)
    source = character().glb(tmp_path / "a.glb")
    edit(source, tmp_path / "b.glb", lambda rig, _: rig)
    assert (tmp_path / "b.glb").read_bytes() == source.read_bytes()


@pytest.mark.slow
def test_mapped_files_are_closed_with_the_document(tmp_path: Path, all_mapped: None) -> None:
    folder = Path("/proc/self/fd")
    if not folder.is_dir():
        pytest.skip("this system does not show open files")
    source = character().glb(tmp_path / "a.glb")
    gc.collect()
    before = len(list(folder.iterdir()))
    document = read(source)
    assert len(list(folder.iterdir())) > before
    del document
    gc.collect()
    assert len(list(folder.iterdir())) == before


# --- as large as a file can be


def test_a_glb_that_would_grow_over_4_gib_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    source = holed_glb(tmp_path / "a.glb", small(), LIMIT - 3)
    with pytest.raises(FileError, match=r"4 GiB a GLB can hold; convert it to \.gltf"):
        edit(source, tmp_path / "b.glb", lambda rig, _: replace(rig, metadata={0: {"v": 1, "type": "group"}}))
    assert [path.name for path in tmp_path.iterdir()] == ["a.glb"]


def test_data_behind_4_gib_of_a_bin_are_found_and_kept(tmp_path: Path) -> None:
    b, size = small(), 5 * GIB
    gltf = behind_a_hole(b, size)
    with (tmp_path / "a.bin").open("wb") as file:
        file.seek(size)
        file.write(b.binary)
    gltf["buffers"][0]["uri"] = "a.bin"
    (tmp_path / "a.gltf").write_text(json.dumps(gltf), "utf-8")
    before = (tmp_path / "a.bin").stat()
    result = turn_all(tmp_path / "a.gltf", tmp_path / "b.gltf").verification
    assert result is not None
    assert result.passes()
    after = (tmp_path / "a.bin").stat()
    assert (after.st_mtime_ns, after.st_size) == (before.st_mtime_ns, size + len(b.binary))
    # Its keys and inverse binds stand in a small file of their own beside it.
    (ours,) = tmp_path.glob("b.rigtri-*.bin")
    assert ours.stat().st_size < 1000


def peak_of(command: str, source: Path, target: Path) -> float:
    """The peak memory of a command, in MB, mapped files included."""
    # The rusage of a process begins with the size of the one that started it; VmHWM does not.
    script = (
        "import re, sys; from rigtri.cli.main import program\n"
        "try: program(sys.argv[1:])\n"
        "except SystemExit as end: assert not end.code, end.code\n"
        "print(re.search(r'VmHWM:\\s+(\\d+) kB', open('/proc/self/status').read())[1])"
    )
    run = [sys.executable, "-c", script, command, str(source), "-o", str(target), "-q"]
    answer = subprocess.run(run, capture_output=True, text=True, check=True)
    return int(answer.stdout.split()[-1]) / 1024


needs_peak = pytest.mark.skipif(
    not Path("/proc/self/status").exists(), reason="this system does not tell the peak of memory"
)


@needs_peak
@pytest.mark.slow
def test_a_glb_of_almost_4_gib_is_edited_in_little_memory(tmp_path: Path) -> None:
    source = holed_glb(tmp_path / "a.glb", small(), LIMIT - 4095)
    assert peak_of("orient-joints", source, tmp_path / "b.glb") < 150
    assert (tmp_path / "b.glb").stat().st_size > LIMIT - 8192
    assert glb_json(tmp_path / "b.glb")["skins"] == glb_json(source)["skins"]


@pytest.mark.slow
@needs_peak
def test_memory_does_not_grow_with_what_is_not_edited(tmp_path: Path) -> None:
    source = holed_glb(tmp_path / "a.glb", small(), 250 << 20)
    assert peak_of("orient-joints", source, tmp_path / "b.glb") < 150


# --- looked at in parts


def crowded(path: Path, monkeypatch: pytest.MonkeyPatch, **constants: int) -> GltfDocument:
    """A document that takes even a small file for one with too many points to read."""
    for name, value in ({"MOST_POINTS": 0, "BLOCK": 5, "SAMPLE": 64} | constants).items():
        monkeypatch.setattr(mesh_reader, name, value)
    return GltfDocument.read(path)


def bounded() -> Builder:
    """The character with the bounds of its points stated, as the format demands."""
    b = character()
    primitives = [p for mesh in b.gltf["meshes"] for p in mesh["primitives"]]
    for part in (part for p in primitives for part in (p["attributes"], *p.get("targets", []))):
        accessor = b.gltf["accessors"][part["POSITION"]]
        view = b.gltf["bufferViews"][accessor["bufferView"]]
        numbers = np.frombuffer(b.binary, "<f4", accessor["count"] * 3, view["byteOffset"]).reshape(-1, 3)
        accessor |= {"min": numbers.min(axis=0).tolist(), "max": numbers.max(axis=0).tolist()}
    return b


def test_boxes_block_by_block_bound_the_same_as_all_points(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, target = bounded().glb(tmp_path / "a.glb"), tmp_path / "b.glb"
    turn_all(source, target)
    whole = self_check(read(source), read(target))
    parts = self_check(crowded(source, monkeypatch), read(target), detail="boxes")
    assert parts.as_json() == whole.as_json()
    assert whole.deviation > 0


def test_boxes_that_the_file_states_never_bound_less(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source, target = bounded().glb(tmp_path / "a.glb"), tmp_path / "b.glb"
    turn_all(source, target)
    whole = self_check(read(source), read(target))
    document = crowded(source, monkeypatch)
    stated = self_check(document, read(target))
    assert stated.deviation >= whole.deviation
    assert stated.diagonal == whole.diagonal
    assert set(stated.boxed) == {mesh.name for mesh in document.meshes()}
    assert not whole.boxed


def test_a_fault_is_seen_by_stated_boxes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    document = crowded(bounded().glb(tmp_path / "a.glb"), monkeypatch)

    nudge = [1, 1, 1.001, 1]
    skins = tuple(replace(s, inverse_bind=s.inverse_bind * nudge) for s in document.rig.skins)
    moved = Held(replace(document.rig, skins=skins))
    assert not self_check(document, moved).passes()


@pytest.mark.parametrize("wrong", ["missing", "too small"])
def test_boxes_that_are_missing_or_wrong_are_made_from_all_points(
    wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    b = bounded()
    for mesh in b.gltf["meshes"]:
        accessor = b.gltf["accessors"][mesh["primitives"][0]["attributes"]["POSITION"]]
        if wrong == "missing":
            del accessor["min"]
        else:
            accessor["max"] = accessor["min"]
    document = crowded(b.glb(tmp_path / "a.glb"), monkeypatch)
    stated, closely = document.outlines(), document.outlines(closely=True)
    for one, other in zip(stated, closely, strict=True):
        assert one.box is not None
        assert np.array_equal(one.box, other.box)


def test_where_stated_boxes_are_too_coarse_the_points_decide(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    b = bounded()
    for accessor in b.gltf["accessors"]:
        if "min" in accessor and len(accessor["min"]) == 3:
            accessor |= {"min": [-1000] * 3, "max": [1000] * 3}
    source, target = b.glb(tmp_path / "a.glb"), tmp_path / "b.glb"
    turn_all(source, target)
    document = crowded(source, monkeypatch)
    coarse = self_check(document, read(target)).deviation
    fine = self_check(document, read(target), detail="boxes").deviation
    assert fine < coarse
    limit = (fine + coarse) / 2
    result = turn_all(source, tmp_path / "c.glb", tolerance=limit).verification
    assert result is not None
    assert (result.deviation, result.boxed) == (fine, ())


def test_joints_with_weight_are_the_same_in_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = character().glb(tmp_path / "a.glb")
    whole = [skin.weighted.tolist() for skin in read(source).rig.skins]
    assert not all(map(all, whole))
    parts = crowded(source, monkeypatch, BLOCK=3).rig.skins
    assert [skin.weighted.tolist() for skin in parts] == whole


@pytest.mark.parametrize("large", [True, False])
def test_a_small_file_is_written_without_a_thread(
    large: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "fdatasync", lambda _: None, raising=False)
    with (tmp_path / "a").open("wb") as file:
        before = threading.active_count()
        with fsync_while_writing(file, large=large):
            assert threading.active_count() - before == large
        assert threading.active_count() == before


def test_only_the_largest_meshes_are_looked_at_in_parts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    b = small()
    large = {"attributes": {"POSITION": b.points(np.arange(30.0).reshape(10, 3))}}
    b.gltf["meshes"].append({"name": "large", "primitives": [large]})
    b.gltf["nodes"].append({"name": "wall", "mesh": 1})
    b.gltf["scenes"][0]["nodes"].append(len(b.gltf["nodes"]) - 1)
    document = crowded(b.glb(tmp_path / "a.glb"), monkeypatch, MOST_POINTS=3, SAMPLE=2)
    boxed = {mesh.name: mesh.box is not None for mesh in document.outlines()}
    assert boxed == {"#3/0": False, "wall/0": True}
    assert [mesh.box for mesh in document.meshes()] == [None, None]
    assert [len(mesh.points) for mesh in document.meshes()] == [3, 10]


def test_boxes_of_large_meshes_are_of_each_joint_or_one_of_what_is_rigid(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    document = crowded(character().glb(tmp_path / "a.glb"), monkeypatch)
    whole = {mesh.name: mesh for mesh in GltfDocument.read(tmp_path / "a.glb").meshes()}
    found = document.outlines(closely=True)
    assert {mesh.skin is None for mesh in found} == {True, False}
    for mesh in found:
        assert mesh.box is not None
        box, points = mesh.box, whole[mesh.name].points
        if mesh.skin is None:
            assert box.shape == (2, 3)  # with its morphs
            assert (box[0] <= points.min(axis=0)).all()
            assert (box[1] >= points.max(axis=0)).all()
        else:
            assert box.shape == (2, len(document.rig.skins[mesh.skin].joints), 3)
