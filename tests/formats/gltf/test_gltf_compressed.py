"""Compressed and quantised characters: read to the bit, and compressed bytes left alone."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import Builder, character, glb_bytes, glb_json, small
from packed_files import EXT, KHR, Fallback, pack
from places import ASSETS, NO_ASSETS
from program import cli
from second_opinions import khronos_errors

from rigtri.errors import FileError
from rigtri.formats.gltf.document import GltfDocument
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY, unit
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.verification.compare.compare import self_check, verify

Spoil = Callable[[dict[str, Any]], object]


def turned(document: GltfDocument, target: Path, seed: int = 7) -> GltfDocument:
    """The file with a random turn of every joint that may turn, read again."""
    rig = document.rig
    turn = unit(np.random.default_rng(seed).normal(size=(len(rig), 4)))
    turn[~rig.is_joint] = IDENTITY
    turn[list(rig.rules.fixed)] = IDENTITY
    turn[~ScaleTable.of(rig).allows(turn)] = IDENTITY
    for companion in document.write(reframe(rig, turn), target, target):
        content = companion.content
        (target.parent / companion.name).write_bytes(
            content if isinstance(content, bytes) else content.read_bytes()
        )
    return GltfDocument.read(target)


def binary_of(path: Path) -> bytes:
    """The BIN chunk of a GLB, read without rigtri."""
    content = path.read_bytes()
    (length,) = struct.unpack_from("<I", content, 12)
    (size,) = struct.unpack_from("<I", content, 20 + length)
    return content[28 + length : 28 + length + size]


def assert_same(one: GltfDocument, other: GltfDocument) -> None:
    """The same rig and the same meshes, to the bit."""
    assert len(one.rig.clips) == len(other.rig.clips)
    for a, b in zip(one.rig.clips, other.rig.clips, strict=True):
        for mine, theirs in zip(a.tracks, b.tracks, strict=True):
            assert mine.values.tobytes() == theirs.values.tobytes()
            assert mine.times.tobytes() == theirs.times.tobytes()
    for s, t in zip(one.rig.skins, other.rig.skins, strict=True):
        assert s.inverse_bind.tobytes() == t.inverse_bind.tobytes()
        assert s.weighted.tolist() == t.weighted.tolist()
    assert len(one.meshes()) == len(other.meshes())
    for x, y in zip(one.meshes(), other.meshes(), strict=True):
        for name in ("points", "joints", "weights", "morphs"):
            assert getattr(x, name).tobytes() == getattr(y, name).tobytes()


# --- meshopt: the laws


@pytest.mark.parametrize("name", [EXT, KHR])
@pytest.mark.parametrize("version", [0, 1])
def test_a_compressed_character_is_the_same_before_and_after_an_edit(
    version: int, name: str, tmp_path: Path
) -> None:
    """Strided, sparse, quantised and shared views, all of them in one buffer."""
    plain = GltfDocument.read(character().glb(tmp_path / "plain.glb"))
    packed = GltfDocument.read(pack(character(), tmp_path / "packed.glb", version=version, name=name))
    assert_same(packed, plain)
    assert packed.warnings == plain.warnings
    assert_same(turned(packed, tmp_path / "b.glb"), turned(plain, tmp_path / "c.glb"))


def test_an_edit_adds_plain_views_and_leaves_all_compressed_bytes_and_references(tmp_path: Path) -> None:
    path = pack(character(), tmp_path / "a.glb", version=1)
    document = GltfDocument.read(path)
    after = turned(document, tmp_path / "b.glb")
    assert verify(document, after).passes(1e-6)
    assert self_check(document, after).passes(1e-6)
    old, new = glb_json(path), glb_json(tmp_path / "b.glb")
    size = old["buffers"][0]["byteLength"]
    assert binary_of(tmp_path / "b.glb")[:size] == binary_of(path)[:size]
    assert new["buffers"][1:] == old["buffers"][1:]
    assert new["bufferViews"][: len(old["bufferViews"])] == old["bufferViews"]
    assert new["accessors"][: len(old["accessors"])] == old["accessors"]
    assert (new["extensionsUsed"], new["extensionsRequired"]) == (
        old["extensionsUsed"],
        old["extensionsRequired"],
    )
    fresh = new["bufferViews"][len(old["bufferViews"]) :]
    assert len(fresh) == 2
    assert all("extensions" not in view and view["buffer"] == 0 for view in fresh)
    # Only what no longer has its old numbers uses them.
    for accessor in new["accessors"][len(old["accessors"]) :]:
        assert accessor["componentType"] == 5126
        assert accessor["bufferView"] >= len(old["bufferViews"])


def test_a_second_edit_of_a_packed_file_does_not_make_it_grow(tmp_path: Path) -> None:
    document = turned(GltfDocument.read(pack(character(), tmp_path / "a.glb")), tmp_path / "b.glb")
    turned(document, tmp_path / "c.glb", seed=8)
    one, two = glb_json(tmp_path / "b.glb"), glb_json(tmp_path / "c.glb")
    assert len(one["accessors"]) == len(two["accessors"])
    assert one["buffers"] == two["buffers"]


@pytest.mark.parametrize("fallback", ["there", "beside", "missing"])
def test_the_uncompressed_bytes_are_read_where_they_are_there(fallback: Fallback, tmp_path: Path) -> None:
    plain = GltfDocument.read(character().glb(tmp_path / "plain.glb"))
    packed = GltfDocument.read(pack(character(), tmp_path / "a.glb", fallback=fallback))
    assert_same(packed, plain)
    assert_same(turned(packed, tmp_path / "b.glb"), turned(plain, tmp_path / "c.glb"))
    old, new = glb_json(tmp_path / "a.glb"), glb_json(tmp_path / "b.glb")
    assert new["bufferViews"][: len(old["bufferViews"])] == old["bufferViews"]
    assert new["buffers"][1:] == old["buffers"][1:]


def test_a_broken_stream_beside_its_uncompressed_bytes_costs_nothing(tmp_path: Path) -> None:
    path = pack(character(), tmp_path / "a.glb", fallback="beside")
    gltf, binary = glb_json(path), binary_of(path)
    path.write_bytes(glb_bytes(gltf, b"\xff" * len(binary)))
    plain = GltfDocument.read(character().glb(tmp_path / "plain.glb"))
    assert_same(GltfDocument.read(path), plain)


def test_a_missing_file_that_is_no_fallback_is_still_an_error(tmp_path: Path) -> None:
    path = pack(character(), tmp_path / "a.glb", fallback="missing")
    gltf, binary = glb_json(path), binary_of(path)
    del gltf["buffers"][1]["extensions"]
    path.write_bytes(glb_bytes(gltf, binary))
    with pytest.raises(FileError, match=r"'fallback\.bin' is missing"):
        GltfDocument.read(path)


# --- meshopt: what is broken


def how(gltf: dict[str, Any], accessor: int) -> dict[str, Any]:
    """The extension of the view of an accessor."""
    view = gltf["bufferViews"][gltf["accessors"][accessor]["bufferView"]]
    found: dict[str, Any] = view["extensions"][EXT]
    return found


def keys(gltf: dict[str, Any]) -> dict[str, Any]:
    return how(gltf, gltf["animations"][0]["samplers"][0]["output"])


BROKEN: dict[str, tuple[Spoil, str]] = {
    "no mode": (lambda g: keys(g).pop("mode"), "'mode' is missing"),
    "mode": (lambda g: keys(g).update(mode="BEST"), "mode 'BEST' is unknown"),
    "mode is a number": (lambda g: keys(g).update(mode=0), "a text should stand here"),
    "triangles": (lambda g: keys(g).update(mode="TRIANGLES"), "byteStride 16 is not valid for TRIANGLES"),
    "indices": (lambda g: keys(g).update(mode="INDICES"), "byteStride 16 is not valid for INDICES"),
    "filter": (lambda g: keys(g).update(filter="SEPIA"), "filter 'SEPIA' is unknown"),
    "filter is a list": (lambda g: keys(g).update(filter=[]), r"filter \[\] is unknown"),
    "filter of 8 bytes": (lambda g: keys(g).update(filter="QUATERNION"), "QUATERNION does not go with"),
    "stride": (lambda g: keys(g).update(byteStride=6), "byteStride 6 is not valid"),
    "long stride": (lambda g: keys(g).update(byteStride=260), "byteStride 260 is not valid"),
    "no stride": (lambda g: keys(g).update(byteStride=0), "byteStride 0 is not valid"),
    "count": (lambda g: keys(g).update(count=3), "3 elements of 16 bytes are not the 32"),
    "no count": (lambda g: keys(g).update(count=0), "at least 1"),
    "negative count": (lambda g: keys(g).update(count=-2), "at least 1"),
    "count is a text": (lambda g: keys(g).update(count="2"), "whole number"),
    "no such buffer": (lambda g: keys(g).update(buffer=7), "there is no buffer 7"),
    "itself": (lambda g: keys(g).update(buffer=1), "the buffer has no data"),
    "outside": (lambda g: keys(g).update(byteOffset=1 << 40), "outside buffer 0"),
    "short": (lambda g: keys(g).update(byteLength=20), "cannot hold 2 compressed elements"),
    "another stream": (lambda g: keys(g).update(byteOffset=0), "left over|too early|cannot|begin with"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_what_is_wrong_with_a_compressed_view_is_named(name: str, tmp_path: Path) -> None:
    path = pack(small(), tmp_path / "a.glb")
    gltf, binary = glb_json(path), binary_of(path)
    spoil, words = BROKEN[name]
    spoil(gltf)
    path.write_bytes(glb_bytes(gltf, binary))
    view = gltf["accessors"][gltf["animations"][0]["samplers"][0]["output"]]["bufferView"]
    with pytest.raises(FileError, match=words) as caught:
        GltfDocument.read(path)
    assert f"bufferViews[{view}]" in str(caught.value) or "buffers[1]" in str(caught.value)


def test_a_view_that_claims_more_than_any_character_has_is_refused(tmp_path: Path) -> None:
    path = pack(small(), tmp_path / "a.glb")
    gltf, binary = glb_json(path), binary_of(path)
    count = 1 << 40
    keys(gltf)["count"] = count
    accessor = gltf["accessors"][gltf["animations"][0]["samplers"][0]["output"]]
    accessor["count"] = count
    gltf["bufferViews"][accessor["bufferView"]]["byteLength"] = 16 * count
    path.write_bytes(glb_bytes(gltf, binary))
    with pytest.raises(FileError, match="rigtri decodes 268435456 at most"):
        GltfDocument.read(path)


def test_a_small_stream_of_very_many_zeros_is_refused(tmp_path: Path) -> None:
    path = pack(small(), tmp_path / "a.glb")
    gltf, binary = glb_json(path), binary_of(path)
    count = 1 << 21
    stream = b"\xa1" + b"\xaa" * (4 * (count // 256)) + bytes(24)
    keys(gltf).update(count=count, byteOffset=len(binary), byteLength=len(stream))
    accessor = gltf["accessors"][gltf["animations"][0]["samplers"][0]["output"]]
    gltf["bufferViews"][accessor["bufferView"]]["byteLength"] = 16 * count
    gltf["buffers"][0]["byteLength"] = len(binary) + len(stream)
    path.write_bytes(glb_bytes(gltf, binary + stream))
    with pytest.raises(FileError, match="32793 bytes claim to be 33554432"):
        GltfDocument.read(path)


def test_a_broken_stream_of_a_mesh_is_a_notice_and_joints_are_checked_instead(tmp_path: Path) -> None:
    path = pack(small(), tmp_path / "a.glb")
    gltf, binary = glb_json(path), binary_of(path)
    how(gltf, gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"])["byteLength"] -= 1
    path.write_bytes(glb_bytes(gltf, binary))
    document = GltfDocument.read(path)
    assert list(document.meshes()) == []
    assert [notice.code for notice in document.warnings] == ["mesh-unread"]
    assert self_check(document, turned(document, tmp_path / "b.glb")).passes(1e-6)


# --- meshopt: a real file


@pytest.mark.skipif(not ASSETS.is_dir(), reason=NO_ASSETS)
def test_what_gltfpack_wrote_is_reoriented_and_no_better_or_worse_for_the_validator(tmp_path: Path) -> None:
    source = ASSETS / "gltf" / "gltfpack_cc_kn_godot_enemy.glb"
    document = GltfDocument.read(source)
    assert document.warnings == ()
    assert len(document.meshes()) == 3
    after = turned(document, tmp_path / "a.glb")
    assert verify(document, after).passes(2e-7)
    before, now = khronos_errors(source, tmp_path / "a.glb")
    assert now == before


# --- quantised rotations, inverse binds and points


@pytest.mark.parametrize(
    ("kind", "full", "error"),
    [("i1", 127, 6e-3), ("u1", 255, 3e-3), ("i2", 32767, 3e-5), ("u2", 65535, 2e-5)],
)
def test_quantised_rotations_are_read_as_fractions_and_written_as_floats(
    kind: str, full: int, error: float, tmp_path: Path
) -> None:
    turns = unit([[0.1, 0.2, 0.3, 0.9], [0.5, 0.5, 0.5, 0.5]])
    builder = small()
    stored = np.rint(turns * full)
    builder.gltf["animations"][0]["samplers"][0]["output"] = builder.accessor(stored, kind, normalized=True)
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    (track,) = document.rig.clips[0].tracks
    assert track.values.tolist() == (stored / full).tolist()
    np.testing.assert_allclose(track.values, turns, atol=error)
    after = turned(document, tmp_path / "b.glb")
    assert verify(document, after).passes(1e-6)
    new = glb_json(tmp_path / "b.glb")
    output = new["accessors"][new["animations"][0]["samplers"][0]["output"]]
    assert (output["componentType"], "normalized" in output) == (5126, False)


def test_the_smallest_integer_is_minus_one_like_the_one_above_it(tmp_path: Path) -> None:
    builder = small()
    rows = [[-128, 0, 0, 0], [-127, 0, 0, 0]]
    builder.gltf["animations"][0]["samplers"][0]["output"] = builder.accessor(rows, "i1", normalized=True)
    (track,) = GltfDocument.read(builder.glb(tmp_path / "a.glb")).rig.clips[0].tracks
    assert track.values.tolist() == [[-1, 0, 0, 0], [-1, 0, 0, 0]]


def test_quantised_scales_stay_the_very_bytes_and_quantised_places_become_floats(tmp_path: Path) -> None:
    builder = small()
    walk = builder.gltf["animations"][0]
    times = walk["samplers"][0]["input"]
    scales = builder.accessor([[65535] * 3, [32768] * 3], "u2", normalized=True)
    places = builder.accessor([[0, 127, 0], [-64, 64, 32]], "i1", normalized=True)
    walk["samplers"] += [{"input": times, "output": scales}, {"input": times, "output": places}]
    for sampler, path in ((1, "scale"), (2, "translation")):
        walk["channels"].append({"sampler": sampler, "target": {"node": 1, "path": path}})
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    by_path = {track.path: track.values.tolist() for track in document.rig.clips[0].tracks}
    assert by_path["scale"] == [[1.0] * 3, [32768 / 65535] * 3]
    assert by_path["translation"] == [[0, 1, 0], [-64 / 127, 64 / 127, 32 / 127]]
    after = turned(document, tmp_path / "b.glb")
    assert verify(document, after).passes(2e-7)
    new = glb_json(tmp_path / "b.glb")
    assert new["accessors"][scales] == builder.gltf["accessors"][scales]
    outputs = [sampler["output"] for sampler in new["animations"][0]["samplers"]]
    assert outputs[1] == scales
    assert new["accessors"][outputs[2]]["componentType"] == 5126


def bent(quantised: bool) -> Builder:
    """A bent limb; quantised: points as int16, and what makes metres of them in the inverse binds."""
    builder = small()
    nodes = builder.gltf["nodes"]
    nodes[1]["translation"], nodes[2]["translation"] = [0.2, 1, 0], [-0.1, 1, 0.3]
    places = np.cumsum([node["translation"] for node in nodes[:3]], axis=0)
    bind = np.tile(np.eye(4), (3, 1, 1))
    bind[:, 3, :3] = -places
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 3, 0.0]])
    attributes = builder.gltf["meshes"][0]["primitives"][0]["attributes"]
    if quantised:
        scale, corner = 4 / 32767, np.array([-1.0, 0.5, 0.25])
        metres = np.diag([scale, scale, scale, 1.0])
        metres[3, :3] = corner
        bind = metres @ bind
        attributes["POSITION"] = builder.accessor(np.rint((points - corner) / scale), "i2")
        builder.gltf["extensionsUsed"] = ["KHR_mesh_quantization"]
    else:
        attributes["POSITION"] = builder.accessor(points)
    builder.gltf["skins"][0]["inverseBindMatrices"] = builder.accessor(bind.reshape(-1, 16))
    return builder


def test_axes_do_not_come_from_what_a_file_hides_in_its_inverse_binds(tmp_path: Path) -> None:
    plain, packed = (
        GltfDocument.read(bent(quantised).glb(tmp_path / f"{quantised}.glb")) for quantised in (False, True)
    )
    wanted, found = orient_joints(plain.rig), orient_joints(packed.rig)
    assert not np.array_equal(wanted.rotation, plain.rig.rotation)
    np.testing.assert_allclose(found.world, wanted.world, atol=1e-6)
    packed.write(found, tmp_path / "b.glb", tmp_path / "b.glb")
    after = GltfDocument.read(tmp_path / "b.glb")
    assert verify(packed, after).passes(2e-7)
    # The scale stays where it was: in the matrices, not in the nodes.
    sizes = np.linalg.norm(after.rig.skins[0].inverse_bind[:, :3, :3], axis=2)
    np.testing.assert_allclose(sizes, 4 / 32767, rtol=1e-6)


# --- points of the list of what real files are like


def several_skins() -> Builder:
    """Skins over the same joints: one accessor in one order twice, in another order, and other matrices."""
    builder = bent(quantised=False)
    gltf = builder.gltf
    first = gltf["skins"][0]
    matrices = np.tile(np.eye(4), (3, 1, 1)) * [0.01, 0.01, 0.01, 1]
    gltf["skins"] += [
        {"joints": [0, 1, 2], "inverseBindMatrices": first["inverseBindMatrices"]},
        {"joints": [2, 0, 1], "inverseBindMatrices": first["inverseBindMatrices"]},
        {"joints": [0, 1, 2], "inverseBindMatrices": builder.accessor(matrices.reshape(-1, 16))},
    ]
    gltf["nodes"] += [{"mesh": 0, "skin": k} for k in (1, 2, 3)]
    gltf["scenes"][0]["nodes"] += [4, 5, 6]
    # Two joints that turn differently share their keys.
    gltf["animations"][0]["channels"].append({"sampler": 0, "target": {"node": 2, "path": "rotation"}})
    return builder


@pytest.mark.parametrize("packed", [False, True])
def test_point_3_joints_shared_by_several_skins_and_a_shared_accessor_is_not_reoriented_twice(
    packed: bool, tmp_path: Path
) -> None:
    path = tmp_path / "a.glb"
    document = GltfDocument.read(pack(several_skins(), path) if packed else several_skins().glb(path))
    after = turned(document, tmp_path / "b.glb")
    assert verify(document, after).passes(2e-7)
    used = [skin["inverseBindMatrices"] for skin in glb_json(tmp_path / "b.glb")["skins"]]
    assert used[0] == used[1]
    assert len(set(used)) == 3
    walk = glb_json(tmp_path / "b.glb")["animations"][0]
    outputs = [walk["samplers"][channel["sampler"]]["output"] for channel in walk["channels"]]
    assert outputs[0] != outputs[1]


def scattered(folder: Path) -> Path:
    """A .gltf with byte strides, sparse and absent views, NaN weights, two .bin and a buffer without data."""
    builder = character()
    gltf = builder.gltf
    empty = {"componentType": 5126, "count": 3, "type": "VEC3"}
    gltf["accessors"].append(empty)
    gltf["animations"][0]["samplers"].append({"input": 10, "output": len(gltf["accessors"]) - 1})
    walk = gltf["animations"][0]
    walk["samplers"][-1]["input"] = walk["samplers"][0]["input"]
    walk["channels"].append(
        {"sampler": len(walk["samplers"]) - 1, "target": {"node": 7, "path": "translation"}}
    )
    keys = builder.strided(unit(np.random.default_rng(8).normal(size=(3, 4))))
    walk["samplers"][0]["output"] = keys
    middle = gltf["bufferViews"][5]["byteOffset"]
    content = bytes(builder.binary)
    for name, part in (("one.bin", content[:middle]), ("two.bin", content[middle:])):
        (folder / name).write_bytes(part)
    for view in gltf["bufferViews"][5:]:
        view |= {"buffer": 1, "byteOffset": view["byteOffset"] - middle}
    gltf["buffers"] = [
        {"uri": "one.bin", "byteLength": middle},
        {"uri": "two.bin", "byteLength": len(content) - middle},
        {"byteLength": 1000, "extensions": {EXT: {"fallback": True}}},
    ]
    path = folder / "a.gltf"
    path.write_text(json.dumps(gltf), "utf-8")
    return path


def test_point_13_byte_traps_strides_sparse_no_view_no_data_several_bins_and_nan_weights(
    tmp_path: Path,
) -> None:
    document = GltfDocument.read(scattered(tmp_path))
    before = {path.name: path.read_bytes() for path in tmp_path.glob("*.bin")}
    old = glb_json(tmp_path / "a.gltf")
    after = turned(document, tmp_path / "b.gltf")
    assert verify(document, after).passes(1e-6)
    assert {name: (tmp_path / name).read_bytes() for name in before} == before
    new = glb_json(tmp_path / "b.gltf")
    assert new["buffers"][:3] == old["buffers"]
    assert new["bufferViews"][: len(old["bufferViews"])] == old["bufferViews"]
    assert new["meshes"] == old["meshes"]
    body = next(mesh for mesh in after.meshes() if mesh.skin == 0)
    assert np.isnan(body.weights[3]).all()


def test_weights_that_do_not_sum_to_one_stay_and_move_nothing(tmp_path: Path) -> None:
    builder = small()
    attributes = builder.gltf["meshes"][0]["primitives"][0]["attributes"]
    attributes["WEIGHTS_0"] = builder.accessor([[0.5, 0.2, 0, 0], [3, 1, 0, 0], [0, 0, 0, 0]])
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    after = turned(document, tmp_path / "b.glb")
    assert verify(document, after).passes(2e-7)
    assert after.meshes()[0].weights.tolist() == document.meshes()[0].weights.tolist()


@pytest.mark.parametrize("number", [-1.0, np.nan, 1e30, np.inf])
def test_joints_that_no_index_can_be_leave_the_mesh_out(number: float, tmp_path: Path) -> None:
    builder = small()
    attributes = builder.gltf["meshes"][0]["primitives"][0]["attributes"]
    attributes["JOINTS_0"] = builder.accessor([[number, 1, 0, 0]] * 3)
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    # A joint that nobody can tell may move it: prune-joints took such out, and was refused (6).
    assert document.rig.skins[0].weighted.all()
    assert list(document.meshes()) == []
    assert "uses joint -1" in document.warnings[0].text


def test_signalling_nan_in_weights_is_read_without_a_word(tmp_path: Path) -> None:
    builder = small()
    attributes = builder.gltf["meshes"][0]["primitives"][0]["attributes"]
    weights = np.full((3, 4), 0x7F800001, dtype="<u4").view("<f4")
    attributes["WEIGHTS_0"] = builder.accessor(weights)
    (mesh,) = GltfDocument.read(builder.glb(tmp_path / "a.glb")).meshes()
    assert np.isnan(mesh.weights).all()


# --- Draco


def with_draco() -> Builder:
    """A second skin over the same joints whose only mesh is compressed with Draco."""
    builder = bent(quantised=False)
    gltf = builder.gltf
    stream = builder.view(b"DRACO, or so it says")
    attributes = {
        "POSITION": len(gltf["accessors"]),
        "JOINTS_0": len(gltf["accessors"]) + 1,
        "WEIGHTS_0": len(gltf["accessors"]) + 2,
    }
    for kind, component in (("VEC3", 5126), ("VEC4", 5121), ("VEC4", 5126)):
        gltf["accessors"].append({"componentType": component, "count": 900, "type": kind})
    draco = {"bufferView": stream, "attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}
    primitive = {"attributes": attributes, "extensions": {"KHR_draco_mesh_compression": draco}}
    gltf["meshes"].append({"primitives": [primitive]})
    rows = np.tile(np.eye(4), (3, 1, 1))
    rows[:, 3, 1] = [-1, -2.5, -3]
    gltf["skins"].append({"joints": [0, 1, 2], "inverseBindMatrices": builder.accessor(rows.reshape(-1, 16))})
    gltf["nodes"].append({"mesh": 1, "skin": 1})
    gltf["scenes"][0]["nodes"].append(4)
    gltf["extensionsUsed"] = gltf["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    return builder


def test_draco_meshes_pass_through_and_their_joints_are_verified(tmp_path: Path) -> None:
    builder = with_draco()
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    after = turned(document, tmp_path / "b.glb")
    assert [mesh.skin for mesh in document.meshes()] == [0]
    assert [notice.code for notice in document.warnings] == ["mesh-unread"]
    assert self_check(document, after).passes(1e-6)
    assert verify(document, after).passes(1e-6)
    old, new = glb_json(tmp_path / "a.glb"), glb_json(tmp_path / "b.glb")
    assert new["meshes"] == old["meshes"]
    assert b"DRACO, or so it says" in (tmp_path / "b.glb").read_bytes()


def test_a_picture_reports_which_meshes_it_lacks(tmp_path: Path) -> None:
    path = with_draco().glb(tmp_path / "draco.glb")
    result = cli("draw", path, "-o", tmp_path / "a.svg", code=0)
    assert "is compressed with KHR_draco_mesh_compression" in result.stderr


def test_verify_sees_a_wrong_inverse_bind_that_only_a_draco_mesh_shows(tmp_path: Path) -> None:
    builder = with_draco()
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    accessor = builder.gltf["accessors"][builder.gltf["skins"][1]["inverseBindMatrices"]]
    start = builder.gltf["bufferViews"][accessor["bufferView"]]["byteOffset"]
    builder.binary[start : start + 4] = struct.pack("<f", 1.01)
    other = GltfDocument.read(builder.glb(tmp_path / "b.glb"))
    assert not verify(document, other).passes()
    assert not self_check(document, other).passes()


# --- KHR_animation_pointer, and channels that rigtri does not know


def pointing(targets: Sequence[str]) -> Builder:
    """The small character with a channel for each pointer, all with the keys of its rotation."""
    builder = small()
    walk = builder.gltf["animations"][0]
    walk["channels"] = []
    walk["samplers"].append(
        {"input": walk["samplers"][0]["input"], "output": builder.accessor([[1, 2, 3], [4, 5, 6.0]])}
    )
    for target in targets:
        extension = {"KHR_animation_pointer": {"pointer": target}}
        sampler = 1 if target.endswith("translation") else 0
        walk["channels"].append({"sampler": sampler, "target": {"path": "pointer", "extensions": extension}})
    builder.gltf["materials"] = [{}]
    builder.gltf["extensionsUsed"] = ["KHR_animation_pointer"]
    return builder


def test_pointers_to_rotation_and_translation_are_rewritten_like_channels(tmp_path: Path) -> None:
    pointers = ["/nodes/1/rotation", "/nodes/1/translation"]
    pointed = GltfDocument.read(pointing(pointers).glb(tmp_path / "a.glb"))
    builder = pointing(pointers)
    for channel, path in zip(
        builder.gltf["animations"][0]["channels"], ("rotation", "translation"), strict=True
    ):
        channel["target"] = {"node": 1, "path": path}
    plain = GltfDocument.read(builder.glb(tmp_path / "b.glb"))
    assert_same(pointed, plain)
    after = turned(pointed, tmp_path / "c.glb")
    assert_same(after, turned(plain, tmp_path / "d.glb"))
    assert verify(pointed, after).passes(2e-7)
    targets = [channel["target"] for channel in glb_json(tmp_path / "c.glb")["animations"][0]["channels"]]
    assert [t["extensions"]["KHR_animation_pointer"]["pointer"] for t in targets] == pointers


def test_pointers_to_materials_and_weights_keep_their_very_numbers(tmp_path: Path) -> None:
    """They share a sampler with a joint that turns."""
    pointers = ["/nodes/1/rotation", "/materials/0/pbrMetallicRoughness/baseColorFactor", "/nodes/3/weights"]
    document = GltfDocument.read(pointing(pointers).glb(tmp_path / "a.glb"))
    turned(document, tmp_path / "b.glb")
    old, new = (glb_json(tmp_path / name)["animations"][0] for name in ("a.glb", "b.glb"))
    outputs = [new["samplers"][channel["sampler"]]["output"] for channel in new["channels"]]
    assert outputs[1] == outputs[2] == old["samplers"][0]["output"]
    assert outputs[0] != outputs[1]
    kept = [glb_json(tmp_path / name)["accessors"][outputs[1]] for name in ("a.glb", "b.glb")]
    assert kept[0] == kept[1]
    before, after = (GltfDocument.read(tmp_path / name).accessors for name in ("a.glb", "b.glb"))
    assert after.read(outputs[1]).tobytes() == before.read(outputs[1]).tobytes()


@pytest.mark.parametrize(
    "target", [{"node": 1, "path": "visibility"}, {"node": 1}, {"path": "pointer"}, None]
)
def test_a_channel_that_rigtri_does_not_know_is_noticed_and_kept(target: Any, tmp_path: Path) -> None:
    builder = small()
    channels = builder.gltf["animations"][0]["channels"]
    channels.append({"sampler": 0, "target": target})
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    (notice,) = document.warnings
    assert notice.code == "channel-unknown"
    assert "channel 1" in notice.text
    turned(document, tmp_path / "b.glb")
    (old, new) = (glb_json(tmp_path / name)["animations"][0] for name in ("a.glb", "b.glb"))
    assert new["channels"][1] == old["channels"][1]
    assert new["samplers"][0] == old["samplers"][0]


def test_channels_of_other_things_are_none_to_notice(tmp_path: Path) -> None:
    builder = small()
    extension = {"KHR_animation_pointer": {"pointer": "/materials/0/alphaCutoff"}}
    builder.gltf["animations"][0]["channels"] += [
        {"sampler": 0, "target": {"path": "rotation"}},
        {"sampler": 0, "target": {"path": "pointer", "extensions": extension}},
    ]
    assert GltfDocument.read(builder.glb(tmp_path / "a.glb")).warnings == ()


def test_a_rig_keeps_what_it_had_when_its_packed_file_is_not_changed(tmp_path: Path) -> None:
    path = pack(character(), tmp_path / "a.glb", version=1)
    document = GltfDocument.read(path)
    rig: Rig = document.rig
    document.write(rig, tmp_path / "b.glb", tmp_path / "b.glb")
    assert (tmp_path / "b.glb").read_bytes() == path.read_bytes()
