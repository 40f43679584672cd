"""glTF as bytes: containers, the spelling of JSON, and URIs."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from gltf_files import UNKNOWN_CHUNK, character, glb_bytes, glb_json, small

from rigtri.errors import FileError, UsageError
from rigtri.formats import ReadOptions
from rigtri.formats.gltf.container import Piece, open_container
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.gltf.float32_rounding import Singles, round_spline, round_tracks
from rigtri.formats.gltf.json_style import Spelling, encode, parse
from rigtri.formats.gltf.uris import escape, file_of, is_own, uris
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import normalise_for_storage, unit
from rigtri.model.animation import Track

TURN = unit([[0.1, 0.2, 0.3, 0.9]])


def turned(document: GltfDocument, folder: Path, suffix: str) -> Path:
    """The file with its first joint turned."""
    turn = np.tile([0.0, 0.0, 0.0, 1.0], (len(document.rig), 1))
    turn[document.rig.skins[0].joints[0]] = TURN
    path = folder / f"turned{suffix}"
    for companion in document.write(reframe(document.rig, turn), path, path):
        assert isinstance(companion.content, bytes)
        (folder / companion.name).write_bytes(companion.content)
    return path


@pytest.mark.parametrize(
    "text",
    [
        '{"a":1,"b":[1.5,2],"c":{"d":null}}',
        '{"a": 1, "b": [1.5, 2], "c": {"d": null}}',
        '{\n  "a": 1,\n  "b": [\n    1.5,\n    2\n  ]\n}\n',
        '{\n\t"a" : 1,\n\t"b" : [ 1.5, 2 ],\n\t"c" : {\n\t\t"d" : "[ 1, 2 ]"\n\t}\n}',
        '{\r\n    "a": [1.5,2],\r\n    "b": 1e-07\r\n}\r\n',
        '{"name":"r\u00f6t [1, 2]"}',
        '{"name":"r\\u00f6t"}',
        '{"name":"\u00f6\\ud800"}',
    ],
    ids=["tight", "spaced", "indented", "tabs, lists on a line", "windows", "utf-8", "escaped", "half"],
)
def test_a_json_text_is_written_the_way_it_was_spelled(text: str) -> None:
    spelling = Spelling.of(text)
    assert encode(spelling.fragment(parse(text)) + spelling.end).decode() == text


@pytest.mark.parametrize("text", ['{"a":NaN}', '{"a":-Infinity}', '{"a":1,"a":2}', "{", '{"a":01}'])
def test_what_json_does_not_allow_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        parse(text)


def test_unknown_chunks_keys_and_order_stay(tmp_path: Path) -> None:
    path = character().glb(tmp_path / "a.glb", (UNKNOWN_CHUNK,))
    out = turned(GltfDocument.read(path), tmp_path, ".glb")
    before, after = glb_json(path), glb_json(out)
    assert list(before) == list(after)
    assert before["unknownKey"] == after["unknownKey"]
    assert before["asset"] == after["asset"]
    chunks = open_container(out).chunks
    assert [(kind, bytes(content)) for kind, content in chunks[2:]] == [UNKNOWN_CHUNK]
    assert len(out.read_bytes()) % 4 == 0


def test_a_byte_order_mark_is_read_with_a_notice(tmp_path: Path) -> None:
    path = small().gltf_file(tmp_path / "a.gltf")
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    document = GltfDocument.read(path)
    assert [notice.code for notice in document.warnings] == ["byte-order-mark"]
    assert len(document.rig) == 4


def test_more_bytes_than_the_glb_claims_need_lenient(tmp_path: Path) -> None:
    path = small().glb(tmp_path / "a.glb")
    size = len(path.read_bytes())
    path.write_bytes(path.read_bytes() + b"more")
    with pytest.raises(FileError, match=f"offset {size}.*--lenient"):
        GltfDocument.read(path)
    lenient = GltfDocument.read(path, ReadOptions(lenient=True))
    assert [notice.code for notice in lenient.warnings] == ["glb-length"]


def test_a_glb_of_more_than_4_gib_is_refused(tmp_path: Path) -> None:
    container = open_container(small().glb(tmp_path / "a.glb"))
    # The same bytes over and over: pieces are never joined, so this takes no memory.
    pieces: list[Piece] = [bytes(1 << 20)] * 4096
    with pytest.raises(FileError, match="4 GiB"):
        container.pieces(container.gltf, pieces)


def test_the_output_is_of_the_kind_of_the_input(tmp_path: Path) -> None:
    document = GltfDocument.read(small().glb(tmp_path / "a.glb"))
    for name in ("b.gltf", "b.GLTF"):
        with pytest.raises(UsageError, match=r"\.glb"):
            document.write(document.rig, tmp_path / "part", tmp_path / name)
    with pytest.raises(UsageError, match=r"\.glb"):
        document.write(document.rig, tmp_path / "part", tmp_path / "b.usda")
    with pytest.raises(UsageError, match="no extension VRM"):
        document.write(document.rig, tmp_path / "part", tmp_path / "b.vrm")
    text = GltfDocument.read(small().gltf_file(tmp_path / "a.gltf"))
    with pytest.raises(UsageError, match=r"\.gltf"):
        text.write(text.rig, tmp_path / "part", tmp_path / "b.glb")


@pytest.mark.parametrize(
    "uri", ["../a.bin", "/etc/passwd", "sub/../../a.bin", "C:%5Ca.bin", "%2e%2e/a.bin", "..\\a.bin"]
)
def test_nothing_outside_the_folder_is_read_unless_allowed(uri: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="--allow-external-paths"):
        file_of(uri, tmp_path, "here")
    file_of(uri, tmp_path, "here", allow_external=True)


def test_a_link_out_of_the_folder_is_outside(tmp_path: Path) -> None:
    inside = tmp_path / "inside"
    inside.mkdir()
    (tmp_path / "a.bin").write_bytes(b"abcd")
    (inside / "a.bin").symlink_to(tmp_path / "a.bin")
    with pytest.raises(FileError, match="outside"):
        file_of("a.bin", inside, "here")


@pytest.mark.parametrize("uri", ["http://example.com/a.bin", "https://x/a", "file:///etc/passwd"])
def test_nothing_is_ever_fetched(uri: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="fetches nothing"):
        file_of(uri, tmp_path, "here", allow_external=True)


def test_extensions_refer_to_files_and_extras_do_not() -> None:
    sounds = {"audio": [{"uri": "c.mp3", "extras": {"uri": "note.txt"}}, {"bufferView": 0}]}
    gltf = {
        "buffers": [{"uri": "a.bin", "extras": {"uri": "note.txt"}}, {}],
        "images": [{"extensions": {"ANY_other": {"uri": "b.dds"}}}],
        "extensions": {"KHR_audio": sounds},
        "extras": {"uri": "note.txt"},
    }
    assert list(uris(gltf)) == [
        (("buffers", 0, "uri"), "a.bin"),
        (("images", 0, "extensions", "ANY_other", "uri"), "b.dds"),
        (("extensions", "KHR_audio", "audio", 0, "uri"), "c.mp3"),
    ]


def test_names_with_blanks_and_umlauts_survive_as_uris(tmp_path: Path) -> None:
    name = "größe (1) & 100%.bin"
    assert file_of(escape(name), tmp_path, "here") == tmp_path / name


def test_only_our_own_buffer_files_are_ours() -> None:
    assert is_own("hero.rigtri-0123abcd.bin")
    assert not is_own("hero.bin")
    assert not is_own("hero.rigtri-0123abcd.bin.bak")


def test_stored_rotations_are_unit_and_within_the_range_of_the_format() -> None:
    q = np.array([[0, 0, 0, 1.0000003], [0, 0, 0, 1.1], [0.5, 0.5, 0.5, 0.5]])
    assert normalise_for_storage(q).tolist() == [[0, 0, 0, 1], [0, 0, 0, 1.1], [0.5, 0.5, 0.5, 0.5]]


def test_half_turns_keep_their_way_round_when_rounded() -> None:
    random = np.random.default_rng(3)
    first = unit(random.normal(size=(500, 4)))
    aside = unit(random.normal(size=(500, 4)))
    across = unit(aside - first * (aside * first).sum(axis=1, keepdims=True))
    across += first * random.choice([-1e-9, 1e-9, 0.0], (500, 1))
    rows = np.stack([first, across, first], axis=1)
    tracks = [Track(0, "rotation", "LINEAR", np.array([0.0, 1.0, 2.0]), row) for row in rows]
    for track, stored in zip(tracks, round_tracks(tracks, tracks), strict=True):
        exact = stored.astype(np.float64)
        # As players see them, who make turns unit: of products that are 0 up to rounding, too.
        assert ((_dots(exact) < 0) == (_dots(unit(track.values)) < 0)).all()
        assert np.abs(exact - track.values).max() < 2e-6


def _dots(q: np.ndarray) -> np.ndarray:
    return np.asarray((q[:-1] * q[1:]).sum(axis=1))


def test_tangents_take_up_the_rounding_of_their_keys() -> None:
    random = np.random.default_rng(4)
    times = np.cumsum(random.uniform(0.01, 0.1, 50))
    values = random.normal(size=(50, 3, 3)) * 100
    track = Track(0, "translation", "CUBICSPLINE", times, values)
    plain = values.astype(np.float32).reshape(-1, 3)

    def middle(rows: Singles) -> np.ndarray:
        keys = rows.astype(np.float64).reshape(-1, 3, 3)
        span = np.diff(times)[:, np.newaxis]
        tangents = span / 8 * (keys[:-1, 2] - keys[1:, 0])
        return np.asarray((keys[:-1, 1] + keys[1:, 1]) / 2 + tangents)

    exact = middle(values.reshape(-1, 3))  # type: ignore[arg-type]
    naive = np.abs(middle(plain) - exact).max()
    assert np.abs(middle(round_spline(track)) - exact).max() < naive / 5


@pytest.mark.parametrize("keep", ["glTF", "JSON"])
def test_text_that_is_no_gltf_is_refused(keep: str, tmp_path: Path) -> None:
    path = tmp_path / "a.gltf"
    path.write_text({"glTF": "[]", "JSON": "hello"}[keep])
    with pytest.raises(FileError, match="no"):
        GltfDocument.read(path)


@pytest.mark.parametrize(
    ("asset", "words"),
    [({}, "version"), ({"version": "1.0"}, "1.0"), ({"version": "2.0", "minVersion": "3.0"}, "3.0")],
)
def test_other_versions_are_refused(asset: dict[str, str], words: str, tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(glb_bytes({"asset": asset}))
    with pytest.raises(FileError, match=words):
        GltfDocument.read(path)


def test_glb_version_1_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(struct.pack("<4sII", b"glTF", 1, 12))
    with pytest.raises(FileError, match="version 1"):
        GltfDocument.read(path)


def test_a_file_that_is_not_there_is_a_file_error(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="cannot be read"):
        GltfDocument.read(tmp_path / "none.glb")


def test_endless_nesting_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.gltf"
    for depth in (400, 100_000):
        nested = "[" * depth + "]" * depth
        path.write_text('{"asset":{"version":"2.0"},"extras":' + nested + ',"nodes":[{}]}')
        if depth == 400:
            document = GltfDocument.read(path)
            document.write(document.rig, tmp_path / "b.gltf", tmp_path / "b.gltf")
        else:
            with pytest.raises(FileError, match="deep"):
                GltfDocument.read(path)


def test_numbers_that_no_float_can_hold_stay_as_they_were_written(tmp_path: Path) -> None:
    builder = small()
    path = builder.gltf_file(tmp_path / "a.gltf", embedded=True)
    text = path.read_text().replace('"unknownKey": {', '"huge": 1e999, "unknownKey": {')
    path.write_text(text)
    assert json.loads(text)["huge"] == float("inf")
    out = turned(GltfDocument.read(path), tmp_path, ".gltf")
    assert '"huge": 1e999, "unknownKey": {' in out.read_text()
