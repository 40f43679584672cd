"""The law of glTF writing: an unchanged rig gives the same bytes, a changed one only its changes."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import Builder, character, glb_bytes, glb_json, glb_parts, small
from places import ASSETS, GLTF, asset_files, sample_files, samples_of_all_kinds
from rigs import lawful
from second_opinions import khronos_errors

import rigtri
from rigtri.errors import FileError, GeometryError
from rigtri.formats import Companion, ReadOptions
from rigtri.formats.gltf.document import GltfDocument
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY, conjugate, unit
from rigtri.model.animation import Clip, Track
from rigtri.model.control_shapes import Shape
from rigtri.model.rig import Rig
from rigtri.verification.compare.compare import verify

FILES = [*sample_files(*GLTF), *asset_files(*GLTF)]
KINDS: dict[str, Callable[[Builder, Path], Path]] = {
    "glb": lambda b, folder: b.glb(folder / "hero.glb"),
    "embedded": lambda b, folder: b.gltf_file(folder / "hero.gltf", embedded=True),
    "external": lambda b, folder: b.gltf_file(folder / "hero.gltf"),
}


def written(document: GltfDocument, rig: Rig, target: Path) -> Path:
    """The file as the pipeline would leave it: companions beside it."""
    target.parent.mkdir(parents=True, exist_ok=True)
    place(document.write(rig, target, target), target.parent)
    return target


def place(companions: Any, folder: Path) -> None:
    for companion in companions:
        assert isinstance(companion, Companion)
        path = folder / companion.name
        path.parent.mkdir(parents=True, exist_ok=True)
        content = companion.content
        path.write_bytes(content if isinstance(content, bytes) else content.read_bytes())


def random_turns(rig: Rig, seed: int = 7) -> np.ndarray:
    """A turn for every joint, or for every node where there is no skin, that may turn."""
    turn = unit(np.random.default_rng(seed).normal(size=(len(rig), 4)))
    if rig.skins:
        turn[~rig.is_joint] = IDENTITY
    turn = lawful(rig, turn)
    turn[~ScaleTable.of(rig).allows(turn)] = IDENTITY
    return turn


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_a_rig_nobody_changed_gives_back_the_same_bytes(path: Path, tmp_path: Path) -> None:
    document = GltfDocument.read(path)
    assert written(document, document.rig, tmp_path / path.name).read_bytes() == path.read_bytes()
    # A rig that is equal, but not the same object, is unchanged, too.
    copy = replace(document.rig, translation=document.rig.translation.copy())
    assert written(document, copy, tmp_path / path.name).read_bytes() == path.read_bytes()


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_random_reorientations_move_nothing(path: Path, tmp_path: Path) -> None:
    document = GltfDocument.read(path)
    turn = random_turns(document.rig)
    after = GltfDocument.read(written(document, reframe(document.rig, turn), tmp_path / path.name))
    comparison = verify(document, after)
    assert comparison.passes(1e-5), comparison.summary()
    # The file has the axes that were asked for.
    expected = reframe(document.rig, turn).world
    place_of = {key: k for k, key in enumerate(after.rig.keys)}
    order = [place_of[key] for key in document.rig.keys]
    assert np.abs(after.rig.world[order] - expected[: len(order)]).max() < 1e-5 * np.abs(expected).max()


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.name)
def test_a_second_reader_opens_the_result_and_agrees(path: Path, tmp_path: Path) -> None:
    from pygltflib import GLTF2

    document = GltfDocument.read(path)
    out = written(document, reframe(document.rig, random_turns(document.rig)), tmp_path / path.name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its own, about files it did not expect
        other = GLTF2.load_json(out) if out.suffix == ".gltf" else GLTF2.load_binary(out)
    rig = GltfDocument.read(out).rig
    assert len(other.nodes) == len(rig)
    for node, index in enumerate(rig.keys):
        assert isinstance(index, int)
        theirs = other.nodes[index]
        assert (theirs.name or "") == rig.names[node]
        if theirs.rotation is not None:
            assert list(theirs.rotation) == rig.rotation[node].tolist()


@pytest.mark.parametrize("path", samples_of_all_kinds(*GLTF), ids=lambda p: p.name)
def test_the_khronos_validator_finds_no_new_errors(path: Path, tmp_path: Path) -> None:
    document = GltfDocument.read(path)
    out = written(document, reframe(document.rig, random_turns(document.rig)), tmp_path / path.name)
    before, after = khronos_errors(path, out)
    assert not after - before


@pytest.mark.parametrize("kind", KINDS)
def test_every_trap_at_once_moves_nothing(kind: str, tmp_path: Path) -> None:
    document = GltfDocument.read(KINDS[kind](character(), tmp_path))
    assert len(document.meshes()) == 4
    rig = reframe(document.rig, random_turns(document.rig))
    out = written(document, rig, tmp_path / f"out{document.container.path.suffix}")
    after = GltfDocument.read(out)
    comparison = verify(document, after)
    assert comparison.passes(2e-7), comparison.summary()
    assert comparison.deviation > 0
    old, new = glb_json(document.container.path), glb_json(out)
    assert len(new["nodes"]) == len(old["nodes"]) + 2
    assert new["meshes"] == old["meshes"]
    assert [a["count"] for a in new["accessors"][: len(old["accessors"])]] == [
        a["count"] for a in old["accessors"]
    ]
    assert new["nodes"][0] == old["nodes"][0]
    assert new["nodes"][8]["extensions"] == old["nodes"][8]["extensions"]


def test_shared_data_part_ways_only_where_they_must(tmp_path: Path) -> None:
    document = GltfDocument.read(character().glb(tmp_path / "a.glb"))
    out = written(document, reframe(document.rig, random_turns(document.rig)), tmp_path / "b.glb")
    old, new = glb_json(tmp_path / "a.glb"), glb_json(out)
    walk, again = new["animations"]
    # Nobody turned what drives the prop and what drives nothing: they keep the old numbers.
    assert again["samplers"][0] == old["animations"][1]["samplers"][0]
    assert walk["channels"][7] == old["animations"][0]["channels"][7]
    # Both clips drive the hips with the same keys, and go on sharing the new ones.
    hips = [c for a in (walk, again) for c in a["channels"] if c["target"].get("node") == 3]
    rotations = [c for c in hips if c["target"]["path"] == "rotation"]
    outputs = [a["samplers"][c["sampler"]]["output"] for a, c in zip((walk, again), rotations, strict=True)]
    assert outputs[0] == outputs[1]
    assert new["animations"][1]["samplers"][1]["extras"] == {"a": 1}
    # The weights of the hand's mesh follow the mesh.
    assert walk["channels"][5]["target"] == {"node": 10, "path": "weights"}


def test_the_mesh_bytes_of_a_glb_stay_where_they_are(tmp_path: Path) -> None:
    builder = character()
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    out = written(document, reframe(document.rig, random_turns(document.rig)), tmp_path / "b.glb")
    binary = bytes(GltfDocument.read(out).container.binary or b"")
    for view in builder.gltf["bufferViews"][:5]:
        span = slice(view["byteOffset"], view["byteOffset"] + view["byteLength"])
        assert binary[span] == builder.binary[span]


@pytest.mark.parametrize("kind", KINDS)
def test_a_second_and_a_third_edit_do_not_grow_the_file(kind: str, tmp_path: Path) -> None:
    document = GltfDocument.read(KINDS[kind](character(), tmp_path))
    suffix = document.container.path.suffix
    sizes, names = [], []
    for edit in range(3):
        turn = random_turns(document.rig, seed=edit)
        turn[np.flatnonzero(document.rig.attachment >= 0)] = IDENTITY
        target = tmp_path / f"out{edit}{suffix}"
        companions = document.write(reframe(document.rig, turn), target, target)
        place(companions, tmp_path)
        names += [companion.name for companion in companions]
        document = GltfDocument.read(target)
        gltf = glb_json(target)
        sizes.append(
            (
                len(gltf["accessors"]),
                len(gltf["bufferViews"]),
                [buffer["byteLength"] for buffer in gltf["buffers"]],
                [len(animation["samplers"]) for animation in gltf["animations"]],
            )
        )
    assert sizes[0] == sizes[1] == sizes[2]
    assert len(names) == len(set(names)) == (3 if kind == "external" else 0)


def test_the_users_bin_is_never_touched(tmp_path: Path) -> None:
    document = GltfDocument.read(character().gltf_file(tmp_path / "a.gltf"))
    before = (tmp_path / "the data.bin").read_bytes()
    rig = reframe(document.rig, random_turns(document.rig))
    companions = document.write(rig, tmp_path / "part", tmp_path / "größe 1.gltf")
    (companion,) = companions
    assert companion.name.startswith("größe 1.rigtri-")
    assert companion.name.endswith(".bin")
    assert (tmp_path / "the data.bin").read_bytes() == before
    buffers = glb_json(tmp_path / "part")["buffers"]
    assert buffers[0] == glb_json(tmp_path / "a.gltf")["buffers"][0]
    assert buffers[1]["uri"].startswith("gr%C3%B6%C3%9Fe%201.rigtri-")


def test_in_another_folder_the_resources_come_along(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["images"] = [{"uri": "sub%20dir/skin.png"}, {"uri": "missing.png"}]
    (tmp_path / "sub dir").mkdir()
    (tmp_path / "sub dir" / "skin.png").write_bytes(b"png")
    document = GltfDocument.read(builder.gltf_file(tmp_path / "a.gltf"))
    out = written(document, document.rig, tmp_path / "deep" / "er" / "a.gltf")
    assert out.read_bytes() == (tmp_path / "a.gltf").read_bytes()
    assert (out.parent / "sub dir" / "skin.png").read_bytes() == b"png"
    assert (out.parent / "the data.bin").exists()
    assert not document.write(document.rig, tmp_path / "p", tmp_path / "b.gltf")


def test_relinked_uris_lead_back_to_the_old_resources(tmp_path: Path) -> None:
    small().gltf_file(tmp_path / "a.gltf")
    document = GltfDocument.read(tmp_path / "a.gltf", ReadOptions(resources="relink"))
    target = tmp_path / "deep" / "a.gltf"
    target.parent.mkdir()
    assert not document.write(document.rig, target, target)
    assert glb_json(target)["buffers"][0]["uri"] == "../the%20data.bin"
    again = GltfDocument.read(target, ReadOptions(allow_external_paths=True))
    assert len(again.meshes()) == 1


def test_missing_inverse_binds_are_created(tmp_path: Path) -> None:
    builder = small()
    del builder.gltf["skins"][0]["inverseBindMatrices"]
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    assert not document.rig.skins[0].stored
    after = GltfDocument.read(
        written(document, reframe(document.rig, random_turns(document.rig)), tmp_path / "b.glb")
    )
    assert after.rig.skins[0].stored
    assert verify(document, after).passes(2e-7)


def test_matrices_behind_the_last_joint_are_kept(tmp_path: Path) -> None:
    builder = small()
    rows = np.arange(5 * 16, dtype="f4").reshape(5, 16)
    rows[:3] = np.eye(4).ravel()
    builder.gltf["skins"][0]["inverseBindMatrices"] = builder.accessor(rows)
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    after = GltfDocument.read(
        written(document, reframe(document.rig, random_turns(document.rig)), tmp_path / "b.glb")
    )
    stored = after.accessors.read(glb_json(tmp_path / "b.glb")["skins"][0]["inverseBindMatrices"])
    assert stored[3:].tolist() == rows[3:].tolist()


def test_a_value_that_was_not_written_and_has_not_changed_stays_unwritten(tmp_path: Path) -> None:
    document = GltfDocument.read(small().glb(tmp_path / "a.glb"))
    turn = np.tile(IDENTITY, (len(document.rig), 1))
    turn[1] = unit([0.0, 1.0, 0.0, 1.0])
    written(document, reframe(document.rig, turn), tmp_path / "b.glb")
    nodes = glb_json(tmp_path / "b.glb")["nodes"]
    # A turn about Y leaves the joint below it, on the Y axis, its translation up to the last bit.
    assert nodes[0] == glb_json(tmp_path / "a.glb")["nodes"][0]
    assert set(nodes[1]) == {"name", "translation", "children", "rotation"}
    assert "scale" not in nodes[2]


def test_bounds_are_those_of_the_numbers_that_are_written(tmp_path: Path) -> None:
    """Of accessors that are written over, each alone or several of one shape, and of new ones."""
    builder = small(4)
    turns = unit(np.random.default_rng(2).normal(size=(2, 2, 4))).astype("<f4")
    animation = builder.gltf["animations"][0]
    time = animation["samplers"][0]["input"]
    for k, rows in enumerate(turns):
        animation["samplers"].append({"input": time, "output": builder.accessor(rows)})
        animation["channels"].append({"sampler": k + 1, "target": {"node": k + 2, "path": "rotation"}})
    widths = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}

    def rows_of(gltf: Any, binary: bytes, accessor: Any) -> Any:
        start = gltf["bufferViews"][accessor["bufferView"]]["byteOffset"] + accessor.get("byteOffset", 0)
        count = accessor["count"] * widths[accessor["type"]]
        return np.frombuffer(binary, "<f4", count, start).reshape(accessor["count"], -1)

    for accessor in builder.gltf["accessors"]:
        if accessor["componentType"] == 5126:
            rows = rows_of(builder.gltf, bytes(builder.binary), accessor)
            accessor |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
    # Of keys a file may state one of them alone.
    keyed = [each for each in builder.gltf["accessors"] if each["type"] == "VEC4" and "min" in each]
    del keyed[-2]["min"], keyed[-1]["max"]
    document = GltfDocument.read(builder.glb(tmp_path / "in.glb"))
    turned = reframe(document.rig, random_turns(document.rig))
    gltf, binary = glb_parts(written(document, turned, tmp_path / "out" / "out.glb"))
    bounded = [each for each in gltf["accessors"] if "min" in each or "max" in each]
    assert len(bounded) >= 6
    changed = 0
    for number, each in enumerate(bounded):
        rows = rows_of(gltf, binary, each)
        stated = {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        assert {key: each[key] for key in stated if key in each}.items() <= stated.items(), number
        changed += each not in builder.gltf["accessors"]
    assert changed >= 4


def test_bytes_that_something_else_overlaps_are_not_written_over(tmp_path: Path) -> None:
    builder = small()
    gltf = builder.gltf
    output = gltf["animations"][0]["samplers"][0]["output"]
    # An image that, oddly, shares the bytes of the keys.
    gltf["images"] = [{"bufferView": gltf["accessors"][output]["bufferView"], "mimeType": "image/png"}]
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    written(document, reframe(document.rig, random_turns(document.rig)), tmp_path / "b.glb")
    new = glb_json(tmp_path / "b.glb")
    assert new["animations"][0]["samplers"][0]["output"] == len(gltf["accessors"])
    binary = GltfDocument.read(tmp_path / "b.glb").container.binary or b""
    assert bytes(binary[: len(builder.binary)])[-32:] == bytes(builder.binary)[-32:]


def test_new_nodes_and_metadata_come_behind_the_last_node(tmp_path: Path) -> None:
    document = GltfDocument.read(small().glb(tmp_path / "a.glb"))
    moved = np.array([[0.5, 1.0, 2.0], [0.0, 0.0, 1.0]])
    rig = document.rig.with_nodes(["pole", "child"], [-1, 4], moved, np.tile(IDENTITY, (2, 1)))
    rig = replace(rig, metadata={4: {"v": 1, "type": "poleVector"}, 1: {"v": 1, "type": "frame"}})
    written(document, rig, tmp_path / "b.glb")
    gltf = glb_json(tmp_path / "b.glb")
    note = {"rigtri": {"v": 1, "type": "poleVector"}}
    pole = {"name": "pole", "translation": [0.5, 1.0, 2.0], "children": [5], "extras": note}
    assert gltf["nodes"][4] == pole
    assert gltf["scenes"][0]["nodes"] == [0, 3, 4]
    again = GltfDocument.read(tmp_path / "b.glb")
    assert again.rig.metadata == rig.metadata
    # Taken away, they leave nothing behind.
    written(again, replace(again.rig, metadata={4: again.rig.metadata[4]}), tmp_path / "c.glb")
    assert "extras" not in glb_json(tmp_path / "c.glb")["nodes"][1]


def test_metadata_beside_extras_that_are_no_object_is_refused(tmp_path: Path) -> None:
    document = GltfDocument.read(character().glb(tmp_path / "a.glb"))
    root = document.rig.find("root")
    with pytest.raises(FileError, match="root has extras"):
        written(document, replace(document.rig, metadata={root: {"v": 1}}), tmp_path / "b.glb")


def test_a_single_root_stays_the_only_root(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["extensionsUsed"] = ["GODOT_single_root"]
    builder.gltf["nodes"][0] |= {"rotation": [0, 0, 0.6, 0.8], "children": [1, 3]}
    builder.gltf["scenes"] = [{"nodes": [0]}]
    document = GltfDocument.read(builder.glb(tmp_path / "a.glb"))
    rig = document.rig.with_nodes(["pole"], [-1], np.array([[1.0, 2.0, 3.0]]), IDENTITY[np.newaxis])
    written(document, rig, tmp_path / "b.glb")
    again = GltfDocument.read(tmp_path / "b.glb").rig
    assert glb_json(tmp_path / "b.glb")["scenes"] == [{"nodes": [0]}]
    np.testing.assert_allclose(again.world[again.find("pole")], rig.world[-1], atol=1e-12)


def test_a_node_put_above_another_takes_its_place_among_the_children(tmp_path: Path) -> None:
    document = GltfDocument.read(small().glb(tmp_path / "a.glb"))
    rig = document.rig
    parents, order = [-1, 0, 1, 2, -1], [0, 4, 1, 2, 3]
    rig = rig.with_nodes(["control"], [0], np.zeros((1, 3)), IDENTITY[np.newaxis])
    fields = ("names", "keys", "labels")
    rig = replace(
        rig,
        **{f: tuple(getattr(rig, f)[k] for k in order) for f in fields},
        parents=np.array(parents),
        **{
            f: getattr(rig, f)[order]
            for f in ("translation", "rotation", "scale", "matrix", "has_matrix", "attachment")
        },
        skins=tuple(replace(s, joints=np.array([0, 2, 3])) for s in rig.skins),
        clips=tuple(
            replace(c, tracks=tuple(replace(t, node=order.index(t.node)) for t in c.tracks))
            for c in rig.clips
        ),
    )
    rig = replace(rig, attachment=np.array([-1, -1, -1, -1, 4]))
    written(document, rig, tmp_path / "b.glb")
    nodes = glb_json(tmp_path / "b.glb")["nodes"]
    assert nodes[0]["children"] == [4]
    assert nodes[4] == {"name": "control", "children": [1]}
    assert nodes[3] == {"mesh": 0, "skin": 0}


def test_clips_gain_lose_and_retime_tracks(tmp_path: Path) -> None:
    document = GltfDocument.read(small().glb(tmp_path / "a.glb"))
    (clip,) = document.rig.clips
    (track,) = clip.tracks
    extra = Track(2, "translation", "LINEAR", track.times, np.ones((2, 3)))
    slow = replace(track, times=track.times * 2, interpolation="STEP")
    fresh = Clip("new", (replace(extra, node=0, times=np.array([0.0, 4.0])),))
    rig = replace(document.rig, clips=(replace(clip, tracks=(slow, extra)), fresh))
    first, second = GltfDocument.read(written(document, rig, tmp_path / "b.glb")).rig.clips
    assert [(t.node, t.path, t.interpolation) for t in first.tracks] == [
        (1, "rotation", "STEP"),
        (2, "translation", "LINEAR"),
    ]
    assert first.tracks[0].times.tolist() == [0.0, 2.0]
    assert first.tracks[1].times.tolist() == [0.0, 1.0]
    assert (second.name, second.tracks[0].times.tolist()) == ("new", [0.0, 4.0])
    none = replace(document.rig, clips=(replace(clip, tracks=()),))
    assert len(GltfDocument.read(written(document, none, tmp_path / "c.glb")).rig.clips[0].tracks) == 0


def test_a_new_name_is_the_only_change(tmp_path: Path) -> None:
    document = GltfDocument.read(small().gltf_file(tmp_path / "a.gltf"))
    names = ("renamed", *document.rig.names[1:])
    written(document, replace(document.rig, names=names), tmp_path / "b.gltf")
    old, new = (tmp_path / f"{k}.gltf" for k in "ab")
    assert new.read_text() == old.read_text().replace('"joint 0"', '"renamed"')


def test_a_file_without_nodes_and_buffers_takes_new_ones(tmp_path: Path) -> None:
    for name in ("a.glb", "a.gltf"):
        path = tmp_path / name
        text = json.dumps({"asset": {"version": "2.0"}}).encode()
        path.write_bytes(glb_bytes(text) if name == "a.glb" else text)
        document = GltfDocument.read(path)
        rig = document.rig.with_nodes(["a"], [-1], np.ones((1, 3)), IDENTITY[np.newaxis])
        track = Track(0, "rotation", "LINEAR", np.array([0.0, 1.0]), np.tile(IDENTITY, (2, 1)))
        rig = replace(rig, clips=(Clip("turn", (track,)),))
        after = GltfDocument.read(written(document, rig, tmp_path / f"out{path.suffix}")).rig
        assert after.clips[0].tracks[0].values.tolist() == track.values.tolist()
        assert glb_json(tmp_path / f"out{path.suffix}")["accessors"][0]["min"] == [0.0]


def test_values_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    document = GltfDocument.read(small().glb(tmp_path / "a.glb"))
    (clip,) = document.rig.clips
    track = replace(clip.tracks[0], values=clip.tracks[0].values * 1e39)
    with pytest.raises(FileError, match="too large"):
        written(document, replace(document.rig, clips=(replace(clip, tracks=(track,)),)), tmp_path / "b.glb")
    shape = Shape("circle", (np.full((3, 3), 1e39),), True, (1.0, 1.0, 1.0))
    pending = replace(document.rig.pending, shapes={0: shape})
    with pytest.raises(FileError, match="too large"):
        written(document, replace(document.rig, pending=pending), tmp_path / "c.glb")


def test_turning_there_and_back_gives_back_the_same_rest_pose(tmp_path: Path) -> None:
    document = GltfDocument.read(small().glb(tmp_path / "a.glb"))
    turn = random_turns(document.rig)
    there = GltfDocument.read(written(document, reframe(document.rig, turn), tmp_path / "b.glb"))
    back = GltfDocument.read(written(there, reframe(there.rig, conjugate(turn)), tmp_path / "c.glb"))
    np.testing.assert_allclose(back.rig.world, document.rig.world, atol=1e-12)


@pytest.mark.skipif(not ASSETS.is_dir(), reason="real files are not here: set RIGTRI_ASSETS")
def test_the_cubic_file_is_more_exact_than_plain_rounding(tmp_path: Path) -> None:
    document = GltfDocument.read(ASSETS / "gltf" / "blender_cubic_godot_enemy.glb")
    out = written(document, reframe(document.rig, random_turns(document.rig)), tmp_path / "a.glb")
    # Plain rounding moves its points by 1.6e-5.
    assert verify(document, GltfDocument.read(out)).deviation < 1e-6


def test_a_clip_that_is_called_otherwise_is_called_so_in_the_file(tmp_path: Path) -> None:
    document = GltfDocument.read(character().glb(tmp_path / "in.glb"))
    first, *others = document.rig.clips
    renamed = replace(document.rig, clips=(replace(first, name="stroll"), *others))
    before, after = (
        glb_json(path) for path in (tmp_path / "in.glb", written(document, renamed, tmp_path / "o.glb"))
    )
    assert after["animations"][0].pop("name") == "stroll"
    before["animations"][0].pop("name", None)
    assert after == before


def test_a_track_with_other_times_gets_a_sampler_of_its_own_where_others_use_it(tmp_path: Path) -> None:
    b = small()
    times = b.accessor([0.0, 1.0], min=[0], max=[1])
    values = b.accessor([[0.0, 0, 0], [1, 0, 0]])
    sampler = {"input": times, "output": values, "interpolation": "LINEAR"}
    targets = [{"node": node, "path": "translation"} for node in (1, 2)]
    b.gltf["animations"] = [
        {
            "name": "both",
            "samplers": [sampler],
            "channels": [{"sampler": 0, "target": each} for each in targets],
        },
        {"name": "one", "samplers": [sampler], "channels": [{"sampler": 0, "target": targets[0]}]},
    ]
    document = GltfDocument.read(b.glb(tmp_path / "in.glb"))
    moved = np.array([0.0, 0.5, 2.0])
    clips = []
    for clip in document.rig.clips:
        track = replace(clip.tracks[0], times=moved, values=np.eye(3), interpolation="STEP")
        clips.append(replace(clip, tracks=(track, *clip.tracks[1:])))
    out = written(document, replace(document.rig, clips=tuple(clips)), tmp_path / "out.glb")
    both, one = glb_json(out)["animations"]
    assert both["samplers"][0] == sampler
    assert [channel["sampler"] for channel in both["channels"]] == [1, 0]
    assert both["samplers"][1]["interpolation"] == "STEP"
    assert len(one["samplers"]) == 1
    assert one["samplers"][0]["interpolation"] == "STEP"
    again = GltfDocument.read(out).rig
    for clip in again.clips:
        assert clip.tracks[0].times.tolist() == moved.tolist()
        assert clip.tracks[0].values.tolist() == np.eye(3).tolist()
    assert again.clips[0].tracks[1].times.tolist() == [0.0, 1.0]


@pytest.mark.parametrize(("late", "why"), [(1.0 + 1e-9, "the same 32-bit number"), (0.5, "not in order")])
def test_keys_that_gltf_cannot_tell_apart_are_refused(late: float, why: str, tmp_path: Path) -> None:
    """Before, with verify=False they were written, and nobody could read the file."""
    rig = rigtri.read(small(3).glb(tmp_path / "in.glb"))
    track = Track(1, "translation", "LINEAR", np.array([0.0, 1.0, late]), np.zeros((3, 3)))
    tied = replace(rig, clips=(Clip("wave", (track,)),))
    with pytest.raises(GeometryError, match=f"at 1 s and {late:.12g} s, which are {why}"):
        rigtri.write(tied, tmp_path / "out.glb", verify=False)
    assert not (tmp_path / "out.glb").exists()
