"""Whatever is wrong with a glTF file, the answer is a FileError in the file's own names."""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import Builder, character, glb_bytes, small
from rigs import lawful
from vrm_files import vrm_0, vrm_1
from wrong_values import WRONG, places

from rigtri.errors import FileError
from rigtri.formats import ReadOptions
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.gltf.references import check_added
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY, unit

Spoil = Callable[[dict[str, Any]], Any]


def use(path: Path) -> None:
    """Read, look at the meshes, turn all that may turn, and write."""
    document = GltfDocument.read(path)
    document.meshes()
    rig = document.rig
    for skin in rig.skins:
        assert skin.weighted.shape == skin.joints.shape
    turn = unit(np.random.default_rng(0).normal(size=(len(rig), 4)))
    turn = lawful(rig, turn)
    turn[~ScaleTable.of(rig).allows(turn)] = IDENTITY
    out = path.with_name(f"out{path.suffix}")
    document.write(reframe(rig, turn), out, out)
    GltfDocument.read(out)


def survives(path: Path) -> bool:
    """Whether a file can be used; it may only fail with a FileError that names it."""
    try:
        use(path)
    except FileError as error:
        if not str(error).startswith(str(path)):
            raise
        return False
    return True


def spoiled(builder: Builder, spoil: Spoil, folder: Path) -> Path:
    spoil(builder.gltf)
    return builder.glb(folder / "bad.glb")


def first_track(gltf: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = gltf["animations"][0]["channels"][0]
    return found


def accessor(builder: Builder, rows: Any, key: str) -> Spoil:
    """Let the only sampler use other numbers."""
    index = builder.accessor(rows)
    return lambda g: g["animations"][0]["samplers"][0].update({key: index})


BAD: dict[str, tuple[Spoil, str]] = {
    "cycle": (lambda g: g["nodes"][2].update(children=[0]), "'joint .'.*below itself"),
    "own child": (lambda g: g["nodes"][0].update(children=[0]), "'joint 0' .#0. is below itself"),
    "two parents": (lambda g: g["nodes"][0].update(children=[1, 2]), "'joint 2'.*two parents"),
    "same child twice": (lambda g: g["nodes"][0].update(children=[1, 1]), "two parents"),
    "no such child": (lambda g: g["nodes"][0].update(children=[9]), "there is no node 9"),
    "no such joint": (lambda g: g["skins"][0].update(joints=[0, 9]), "there is no node 9"),
    "no joints": (lambda g: g["skins"][0].update(joints=[]), "no joints"),
    "joint twice": (lambda g: g["skins"][0].update(joints=[0, 1, 1]), "lists node 'joint 1' .#1. 2 times"),
    "no such skin": (lambda g: g["nodes"][3].update(skin=4), "there is no skin 4"),
    "no such skeleton": (lambda g: g["skins"][0].update(skeleton=44), "there is no node 44"),
    "few matrices": (
        lambda g: g["skins"][0].update(joints=[0, 1, 2, 3]),
        "3 inverse bind matrices for 4 joints",
    ),
    "no such matrices": (lambda g: g["skins"][0].update(inverseBindMatrices=99), "no accessor 99"),
    "matrices of 3": (lambda g: g["skins"][0].update(inverseBindMatrices=0), "matrices have 3 numbers each"),
    "rotation 0": (lambda g: g["nodes"][1].update(rotation=[0, 0, 0, 0]), "'joint 1'.*the rotation 0 0 0 0"),
    "3 of 4": (lambda g: g["nodes"][1].update(rotation=[0, 0, 1]), "4 numbers"),
    "text": (lambda g: g["nodes"][1].update(translation=["a", 0, 0]), "3 numbers"),
    "huge": (lambda g: g["nodes"][1].update(translation=[10**400, 0, 0]), "too large"),
    "projection": (lambda g: g["nodes"][3].update(matrix=[1] * 16), "last row"),
    "no such node": (lambda g: first_track(g)["target"].update(node=9), "channel 0.*no node 9"),
    "no such sampler": (lambda g: first_track(g).update(sampler=3), "no sampler 3"),
    "wrong width": (lambda g: first_track(g)["target"].update(path="scale"), "scale needs 3 numbers a key"),
    "same target": (
        lambda g: g["animations"][0]["channels"].append(first_track(g)),
        "channel 0 drives its rotation too",
    ),
    "pointer too": (
        lambda g: g["animations"][0]["channels"].append(
            {
                "sampler": 0,
                "target": {
                    "path": "pointer",
                    "extensions": {"KHR_animation_pointer": {"pointer": "/nodes/1/rotation"}},
                },
            }
        ),
        "channel 0 drives its rotation too",
    ),
    "interpolation": (
        lambda g: g["animations"][0]["samplers"][0].update(interpolation="BEZIER"),
        "BEZIER",
    ),
    "cubic without tangents": (
        lambda g: g["animations"][0]["samplers"][0].update(interpolation="CUBICSPLINE"),
        "2 times need 6 values",
    ),
    "null nodes": (lambda g: g.update(nodes=None), "nodes.*missing"),
    "nodes as object": (lambda g: g.update(nodes={}), "a list should stand here"),
    "root of scene": (lambda g: g["scenes"][0].update(nodes=[77]), "there is no node 77"),
    "scene": (lambda g: g.update(scene=5), "there is no scene 5"),
}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"x", "begins with 'x', where a GLB begins with 'glTF' and a .gltf with '{'"),
        (b"\n#usda 1.0\nand more", "begins with '#usda 1.0',"),
        (b"\x89PNG\r\n\x1a\n", "begins with the bytes 89 50 4e 47,"),
        (b"glTF", "ends after 4 bytes"),
        (b"", "is empty"),
        (b'\xef\xbb\xbf  {"asset": }', "not valid JSON"),
    ],
)
def test_what_is_no_gltf_is_reported_by_how_it_begins(content: bytes, words: str, tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(content)
    with pytest.raises(FileError, match=re.escape(words)):
        use(path)


@pytest.mark.parametrize("name", BAD)
def test_the_fault_is_named(name: str, tmp_path: Path) -> None:
    spoil, words = BAD[name]
    with pytest.raises(FileError, match=words):
        GltfDocument.read(spoiled(small(), spoil, tmp_path))


@pytest.mark.parametrize(
    ("rows", "key", "words"),
    [
        ([0, 0], "input", "time 1, 0 s, does not come after"),
        ([1, 0.5], "input", "does not come after"),
        ([0, np.nan], "input", "not a number"),
        ([[0, 0]] * 2, "input", "2 numbers each"),
        ([[0, 0, 0, np.inf]] * 2, "output", "channel 0: rotation key 0 is not a number"),
        ([[0, 0, 0, 1], [0, 0, 0, 0]], "output", "rotation key 1 is 0 0 0 0"),
        ([[0, 0, 0, 1]] * 3, "output", "2 times need 2 values"),
    ],
)
def test_broken_keys_name_animation_and_channel(rows: Any, key: str, words: str, tmp_path: Path) -> None:
    builder = small()
    path = spoiled(builder, accessor(builder, rows, key), tmp_path)
    with pytest.raises(FileError, match=rf"animation '' \(#0\) channel 0.*{words}|{words}"):
        GltfDocument.read(path)


def test_lenient_accepts_equal_times(tmp_path: Path) -> None:
    builder = small()
    path = spoiled(builder, accessor(builder, [0, 0], "input"), tmp_path)
    GltfDocument.read(path, ReadOptions(lenient=True))


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (np.full(16, np.nan), "'joint 1'.*not a number"),
        ([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2], "'joint 1'.*last row"),
        ([1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], "'joint 1'.*flat.*--lenient"),
    ],
)
def test_broken_inverse_binds_name_the_joint(row: Any, words: str, tmp_path: Path) -> None:
    builder = small()
    rows = np.tile(np.eye(4).ravel(), (3, 1))
    rows[1] = row
    builder.gltf["skins"][0]["inverseBindMatrices"] = builder.accessor(rows)
    path = builder.glb(tmp_path / "bad.glb")
    with pytest.raises(FileError, match=words):
        GltfDocument.read(path)
    if "lenient" in words:
        document = GltfDocument.read(path, ReadOptions(lenient=True))
        assert [notice.code for notice in document.warnings] == ["bind-flat"]


def test_a_skeleton_that_is_not_above_its_joints_is_kept_with_a_notice(tmp_path: Path) -> None:
    path = spoiled(small(), lambda g: g["skins"][0].update(skeleton=2), tmp_path)
    assert [notice.code for notice in GltfDocument.read(path).warnings] == ["skeleton-not-above"]


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("../x.bin", "outside the folder"),
        ("/x.bin", "outside the folder"),
        ("gone.bin", "gone.bin.*missing"),
        ("http://example.com/x.bin", "fetches nothing"),
        ("data:;base64,AAAA", "only 3"),
        ("data:;base64,!", "broken"),
        ("data:AAAA", "comma"),
    ],
)
def test_buffers_that_cannot_be_had_are_named(uri: str, words: str, tmp_path: Path) -> None:
    path = small().gltf_file(tmp_path / "a.gltf")
    gltf = json.loads(path.read_text())
    gltf["buffers"][0]["uri"] = uri
    path.write_text(json.dumps(gltf))
    with pytest.raises(FileError, match=rf"buffers\[0\].*{words}"):
        GltfDocument.read(path)


def test_a_bin_that_is_too_short_is_named(tmp_path: Path) -> None:
    path = small().gltf_file(tmp_path / "a.gltf")
    (tmp_path / "the data.bin").write_bytes(b"short")
    with pytest.raises(FileError, match=r"buffers\[0\].*only 5"):
        GltfDocument.read(path)


@pytest.mark.ci
def test_a_glb_cut_off_anywhere_is_refused(tmp_path: Path) -> None:
    content = small().glb(tmp_path / "a.glb").read_bytes()
    path = tmp_path / "cut.glb"
    for length in range(len(content)):
        path.write_bytes(content[:length])
        assert not survives(path), length


def test_a_glb_with_any_byte_changed_never_ends_in_a_traceback(
    tmp_path: Path, every: Callable[[int], int]
) -> None:
    content = bytearray(small().glb(tmp_path / "a.glb").read_bytes())
    path = tmp_path / "changed.glb"
    for place in range(0, len(content), every(9)):
        old = content[place]
        for new in {0, 255, old ^ 1, ord("9"), ord("-")} - {old} if place % 81 == 0 else {old ^ 16}:
            content[place] = new
            path.write_bytes(content)
            survives(path)
        content[place] = old
    assert path.write_bytes(content)
    assert survives(path)


def fuzz(builder: Builder, folder: Path, every: int) -> None:
    text = json.dumps(builder.gltf | {"buffers": [{"byteLength": len(builder.binary)}]})
    path, binary = folder / "fuzz.glb", bytes(builder.binary)
    trials = [(at, wrong) for at in places(json.loads(text)) for wrong in WRONG]
    for at, wrong in trials[::every]:
        gltf = json.loads(text)
        holder = gltf
        for key in at[:-1]:
            holder = holder[key]
        holder[at[-1]] = wrong
        path.write_bytes(glb_bytes(gltf, binary))
        with warnings.catch_warnings():
            # A weird but legal number may overflow; it must not end in a traceback.
            warnings.simplefilter("ignore", RuntimeWarning)
            try:
                survives(path)
            except Exception as error:
                raise AssertionError(f"{at} = {wrong!r}: {error!r}") from error


def test_any_value_of_a_small_file_may_be_wrong(tmp_path: Path) -> None:
    fuzz(small(), tmp_path, 7)


@pytest.mark.ci
def test_any_value_of_a_rich_file_may_be_wrong(tmp_path: Path) -> None:
    fuzz(vrm_1(), tmp_path, 37)
    fuzz(character(), tmp_path, 37)


@pytest.mark.slow
def test_every_value_of_a_rich_file_may_be_wrong(tmp_path: Path) -> None:
    fuzz(vrm_1(), tmp_path, 1)
    fuzz(vrm_0(), tmp_path, 1)
    fuzz(character(), tmp_path, 1)


def test_an_index_that_is_no_number_leads_to_nothing_that_is_added(tmp_path: Path) -> None:
    before = {"accessors": [{"bufferView": [1]}, {"bufferView": 0}], "bufferViews": [{}]}
    after, path = {"bufferViews": [{}, {}]}, tmp_path / "a.glb"
    check_added(before, after, path)
    with pytest.raises(FileError, match="bufferViews"):
        check_added(before | {"accessors": [{"bufferView": 1}]}, after, path)
