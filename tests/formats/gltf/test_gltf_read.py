"""Reading glTF: accessors of every storage, the tree, clips, skins and meshes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from calls import calls
from gltf_files import Builder, character, small
from morphs import arm
from places import SAMPLES

from rigtri.errors import FileError
from rigtri.formats import ReadOptions, read
from rigtri.formats.gltf.document import GltfDocument


def opened(builder: Builder, folder: Path, **options: Any) -> GltfDocument:
    return GltfDocument.read(builder.glb(folder / "a.glb"), ReadOptions(**options))


@pytest.mark.parametrize(
    ("kind", "stored", "plain", "normalized"),
    [
        ("i1", [-128, -127, 0, 127], [-128, -127, 0, 127], [-1, -1, 0, 1]),
        ("u1", [0, 51, 102, 255], [0, 51, 102, 255], [0, 0.2, 0.4, 1]),
        ("i2", [-32768, -32767, 0, 32767], [-32768, -32767, 0, 32767], [-1, -1, 0, 1]),
        ("u2", [0, 13107, 65535, 1], [0, 13107, 65535, 1], [0, 0.2, 1, 1 / 65535]),
        ("u4", [0, 1, 2**32 - 1, 7], [0, 1, 2**32 - 1, 7], None),
        ("f4", [0, 0.5, -2, 7], [0, 0.5, -2, 7], None),
    ],
)
def test_numbers_of_every_component_type(
    kind: str, stored: list[float], plain: list[float], normalized: list[float] | None, tmp_path: Path
) -> None:
    builder = Builder()
    first = builder.accessor([stored], kind)
    second = builder.accessor([stored], kind, normalized=True) if normalized else None
    accessors = opened(builder, tmp_path).accessors
    assert accessors.read(first).tolist() == [plain]
    if second is not None:
        np.testing.assert_allclose(accessors.read(second), [normalized], atol=1e-15)


def test_sparse_strided_and_empty_storage(tmp_path: Path) -> None:
    builder = Builder()
    rows = np.arange(12.0).reshape(4, 3)
    sparse = builder.sparse(rows, {3: [9, 9, 9], 1: [8, 8, 8]})
    strided = builder.strided(rows)
    nowhere = builder.accessor(rows)
    del builder.gltf["accessors"][nowhere]["bufferView"]
    within = builder.accessor(rows[2:], bufferView=builder.gltf["accessors"][strided]["bufferView"])
    builder.gltf["accessors"][within]["byteOffset"] = 32
    accessors = opened(builder, tmp_path).accessors
    assert accessors.read(sparse).tolist() == [[0, 1, 2], [8, 8, 8], [6, 7, 8], [9, 9, 9]]
    assert accessors.read(strided).tolist() == rows.tolist()
    assert accessors.read(nowhere).tolist() == np.zeros((4, 3)).tolist()
    assert accessors.read(within).tolist() == rows[2:].tolist()


@pytest.mark.parametrize("extended", [False, True])
def test_a_stride_says_nothing_of_one_element(extended: bool, tmp_path: Path) -> None:
    builder = Builder()
    index = builder.accessor([[1.0, 2.0, 3.0]])
    view = builder.gltf["bufferViews"][builder.gltf["accessors"][index]["bufferView"]]
    view |= {"byteStride": 1 << 63} | ({"extensions": {"EXT_other": {}}} if extended else {})
    assert opened(builder, tmp_path).accessors.read(index).tolist() == [[1.0, 2.0, 3.0]]


def test_data_that_start_at_an_odd_offset_are_read(tmp_path: Path) -> None:
    builder = Builder()
    view = builder.view(b"x" + np.array([1.0, 2.0], dtype="<f4").tobytes())
    index = builder.accessor([1.0, 2.0], bufferView=view, byteOffset=1)
    assert opened(builder, tmp_path).accessors.read(index).tolist() == [[1.0], [2.0]]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"count": 100}, "needs"),
        ({"count": 7, "type": "SCALAR"}, "needs 28 bytes"),  # by no more than one of them
        ({"count": 10**15}, "needs"),
        ({"count": 0}, "at least 1"),
        ({"count": -1}, "whole number"),
        ({"count": True}, "whole number"),
        ({"byteOffset": 8}, "needs"),
        ({"byteOffset": -4}, "whole number"),
        ({"bufferView": 99}, "bufferView 99"),
        ({"componentType": 5124}, "5124"),
        ({"type": "MAT2"}, "MAT2"),
        ({"sparse": {}}, "missing"),
        ({"sparse": {"count": 9, "indices": {}, "values": {}}}, "replaces 9"),
        ({"bufferView": None, "count": 10**12}, "without bytes"),
        ({"bufferView": None, "count": 10**400}, "without bytes"),
    ],
)
def test_accessors_out_of_bounds_are_named(change: dict[str, Any], words: str, tmp_path: Path) -> None:
    builder = Builder()
    builder.gltf["accessors"] = []
    index = builder.accessor([[1.0, 2.0, 3.0]] * 2)
    builder.gltf["accessors"][index] |= change
    accessors = opened(builder, tmp_path).accessors
    with pytest.raises(FileError, match=rf"accessors\[{index}\].*{words}|{words}"):
        accessors.read(index)


def test_the_rig_is_what_the_file_contains(tmp_path: Path) -> None:
    document = opened(character(), tmp_path)
    rig = document.rig
    # Parents first, else in the file's order.
    assert rig.keys == (0, 2, 3, 4, 1, 5, 6, 7, 8, 9)
    assert rig.labels[4] == "#1"
    assert rig.parents.tolist() == [-1, -1, 1, 2, 3, -1, 3, 2, 7, 1]
    hand, hips, camera = rig.find("hand"), rig.find("hips"), rig.find("camera")
    assert rig.path(hand) == "/root/hips/#4/hand"
    assert rig.has_matrix.tolist() == [k == "" for k in rig.names]
    assert rig.attachment[camera] == camera
    assert rig.attachment[hips] == -1
    assert rig.rules.facing == (0.0, 0.0, 1.0)
    assert list(rig.rules.fixed) == [rig.find("foot")]
    # Row vectors: the last row of the stored sixteen numbers is the position.
    np.testing.assert_allclose(rig.world[rig.find("#4"), 3, :3], [1.5, 3, -2])
    assert [skin.name for skin in rig.skins] == ["all", ""]
    assert rig.skins[1].joints.tolist() == [8, 7, 2]
    assert len(rig.skins[1].inverse_bind) == 3
    walk, again = rig.clips
    assert (walk.name, again.name) == ("walk", "again")
    assert [(t.node, t.path) for t in again.tracks] == [(hips, "rotation"), (9, "rotation")]
    assert len({id(track.times) for clip in rig.clips for track in clip.tracks}) == 1
    assert len(walk.tracks) == 9
    assert walk.tracks[2].values.shape == (3, 3, 4)
    assert walk.tracks[3].values[1].tolist() == [5, 5, 5]


def test_a_joint_counts_as_weighted_where_any_mesh_gives_it_weight(tmp_path: Path) -> None:
    document = opened(character(), tmp_path)
    weighted = document.rig.skins[0].weighted
    assert weighted.tolist() == [True, True, True, False, False, False]
    builder = small()
    del builder.gltf["nodes"][3]["skin"]
    assert opened(builder, tmp_path).rig.skins[0].weighted.all()


def test_meshes_with_their_morphs_weights_and_lost_numbers(tmp_path: Path) -> None:
    document = opened(character(), tmp_path)
    body, hand, second, prop = document.meshes()
    assert (body.name, hand.name, second.name, prop.name) == ("body/0", "hand/0", "second body/0", "prop/0")
    assert (body.skin, second.skin, prop.skin) == (0, 1, None)
    assert np.isnan(body.weights[3]).all()
    assert hand.morphs.shape == (1, 5, 3)
    assert (hand.morph_weights.tolist(), prop.morph_weights.tolist()) == ([0.25], [0.5])
    assert document.warnings == ()


@pytest.mark.parametrize(
    "spoil",
    [
        lambda g: g["accessors"][1].update(componentType=5126),
        lambda g: g["accessors"][0].update(count=2),
        lambda g: g["accessors"][0].update(count=2000),
        lambda g: g["meshes"][0]["primitives"][0].update(attributes=7),
        lambda g: g["meshes"][0].update(primitives={}),
        lambda g: g["nodes"][3].update(mesh=7),
        lambda g: g["nodes"][3].update(mesh="body"),
        lambda g: g["meshes"][0]["primitives"][0].update(
            extensions={"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}}
        ),
        lambda g: g["meshes"][0]["primitives"][0].update(targets=[{"POSITION": 99}]),
    ],
)
def test_a_broken_mesh_is_a_notice_and_costs_nothing_else(spoil: Any, tmp_path: Path) -> None:
    builder = small()
    spoil(builder.gltf)
    document = opened(builder, tmp_path)
    assert document.rig.skins[0].weighted.shape == (3,)
    assert list(document.meshes()) == []
    assert {notice.code for notice in document.warnings} == {"mesh-unread"}


def test_what_morph_targets_do_to_normals_is_a_value_beside_the_normals(tmp_path: Path) -> None:
    b = arm()
    primitive = b.gltf["meshes"][0]["primitives"][0]
    up, aside = np.tile([[0.0, 0, 1]], (3, 1)), np.tile([[1.0, 0, 0]], (3, 1))
    primitive["attributes"]["NORMAL"] = b.accessor(up)
    primitive["targets"][1]["NORMAL"] = b.accessor(aside)
    (mesh,) = opened(b, tmp_path).meshes()
    surface = mesh.surface()
    assert surface is not None
    assert np.array_equal(surface.normals, up)
    assert {name: values.tolist() for name, values in surface.values.items()} == {
        "NORMAL of morph target 1": aside.tolist()
    }


def test_a_broken_channel_of_morph_weights_is_a_notice_and_costs_nothing_else(tmp_path: Path) -> None:
    b = arm()
    times = b.gltf["animations"][0]["samplers"][1]["input"]
    b.gltf["animations"][0]["samplers"][1]["output"] = times
    document = read(b.glb(tmp_path / "in.glb"))
    assert [track.path for track in document.rig.clips[0].tracks] == ["rotation"]
    (told,) = document.warnings
    assert told.code == "weights-unread"
    assert "channel 1: weights needs 2 numbers a key, its output has 1" in told.text
    assert told.text.endswith("(morph weights are kept, but not checked)")


def test_joints_that_no_skin_has_leave_the_mesh_out(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = builder.accessor(
        [[0, 77, 0, 0]] * 3, "u1"
    )
    document = opened(builder, tmp_path)
    assert list(document.meshes()) == []
    assert "joint 77 of a skin that has 3" in document.warnings[0].text


def test_lenient_takes_trs_where_a_matrix_stands_beside_it(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["nodes"][1]["matrix"] = np.eye(4).ravel().tolist()
    with pytest.raises(FileError, match=r"'joint 1' \(#1\).*--lenient"):
        opened(builder, tmp_path)
    rig = opened(builder, tmp_path, lenient=True).rig
    assert not rig.has_matrix[1]
    assert rig.translation[1].tolist() == [0, 1, 0]


def test_lenient_splits_the_matrix_of_an_animated_node(tmp_path: Path) -> None:
    builder = small()
    node = builder.gltf["nodes"][1]
    del node["translation"]
    node["matrix"] = [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1]
    with pytest.raises(FileError, match="is animated and has a matrix"):
        opened(builder, tmp_path)
    document = opened(builder, tmp_path, lenient=True)
    np.testing.assert_allclose(document.rig.scale[1], [2, 2, 2], atol=1e-15)
    # What was understood is what a changed file says.
    names = ("new name", *document.rig.names[1:])
    document.write(replace(document.rig, names=names), tmp_path / "b.glb", tmp_path / "b.glb")
    again = GltfDocument.read(tmp_path / "b.glb").rig
    np.testing.assert_allclose(again.world, document.rig.world, atol=1e-12)


def test_rotations_that_are_not_unit_are_noticed(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["nodes"][1]["rotation"] = [0, 0, 0.7071, 0.7]
    codes = [notice.code for notice in opened(builder, tmp_path).warnings]
    assert codes == ["rotation-not-unit"]


def test_a_sheared_matrix_is_noticed_and_fixed_where_it_is_a_joint(tmp_path: Path) -> None:
    builder = small()
    node = builder.gltf["nodes"][0]
    del node["translation"]
    node["matrix"] = [1, 0.5, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1]
    document = opened(builder, tmp_path)
    assert [notice.code for notice in document.warnings] == ["matrix-sheared"]
    assert "sheared" in document.rig.rules.fixed[0]


def test_unknown_required_extensions_are_noticed(tmp_path: Path) -> None:
    builder = small()
    builder.gltf |= {"extensionsRequired": ["ACME_bones", "KHR_materials_unlit"]}
    codes = {notice.code: notice.text for notice in opened(builder, tmp_path).warnings}
    assert "ACME_bones" in codes["extension-unknown"]
    assert "KHR_materials_unlit" not in codes["extension-unknown"]
    assert "extension-undeclared" in codes


def test_read_finds_the_format_by_the_suffix(tmp_path: Path) -> None:
    for suffix in (".glb", ".vrm", ".VRMA"):
        assert len(read(small().glb(tmp_path / f"a{suffix}")).rig) == 4


@pytest.mark.parametrize(
    ("mode", "kind"),
    [
        (None, "triangles"),
        (0, "points"),
        (3, "line strip"),
        (6, "triangle fan"),
        (7, "mode 7"),
        (99, "mode 99"),
    ],
)
def test_what_a_primitive_draws_is_told_by_its_mode(mode: int | None, kind: str, tmp_path: Path) -> None:
    builder = small()
    (primitive,) = builder.gltf["meshes"][0]["primitives"]
    primitive |= {} if mode is None else {"mode": mode}
    (mesh,) = GltfDocument.read(builder.glb(tmp_path / "a.glb")).meshes()
    assert mesh.surface is not None
    surface = mesh.surface()
    assert surface is not None
    assert surface.kind == kind


def test_joints_of_negative_weights_move_points(tmp_path: Path) -> None:
    """Before, prune-joints took such joints for idle ones, and its own proof refused the result."""
    builder = small(3)
    attributes = builder.gltf["meshes"][0]["primitives"][0]["attributes"]
    attributes["WEIGHTS_0"] = builder.accessor([[-1, 0, 0, 0], [0, 0, 0, 0], [0, 1, 0, 0]])
    (skin,) = opened(builder, tmp_path).rig.skins
    assert skin.weighted.tolist() == [True, True, False]


# Of the sample with its two clips; with a look-up for each property of each accessor and view it was 5,586,
# and 5,106 where the target of each channel was read for matrices, of which it has none.
_BIPED = 5_050


def test_a_file_is_read_in_so_many_calls() -> None:
    read(SAMPLES / "biped.glb")  # what is found out once for all files
    assert calls(lambda: read(SAMPLES / "biped.glb")) < _BIPED
