"""Files made to do harm: they end in an error that names them, and reach nothing outside their folder."""

from __future__ import annotations

import json
import os
import re
import signal
import struct
import threading
import zipfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import glb_bytes, small
from places import SAMPLES, ci, first
from polling import wait_for
from program import cli
from pxr import Sdf, Tf
from usd_files import MESH, animation, error_of, read, save, scene, skeleton

from rigtri.cli.terminal_text import plain
from rigtri.errors import FileError, GeometryError, RigtriError
from rigtri.files.worker_process import CrashError, WorkerProcess, send_event
from rigtri.formats import ReadOptions
from rigtri.formats import read as read_any
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.usd import usdz
from rigtri.model.animation import Path as TrackKind
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.edit import edit
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

POSIX = pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")
LAYER = scene(skeleton(), animation(), MESH)


def fault(path: Path, options: ReadOptions | None = None) -> str:
    """The words with which a glTF file is refused; it is used as far as an edit uses it."""
    with pytest.raises(FileError) as refused:
        _use(path, options or ReadOptions())
    return str(refused.value)


def _use(path: Path, options: ReadOptions) -> None:
    document = GltfDocument.read(path, options)
    document.meshes()
    document.write(document.rig, path.with_name("out"), path.parent / "other" / path.name)


def changed(path: Path, **more: Any) -> Path:
    """A small .gltf at ``path`` with other members in its first buffer."""
    small().gltf_file(path)
    gltf = json.loads(path.read_text())
    gltf["buffers"][0] |= more
    path.write_text(json.dumps(gltf))
    return path


# --- paths

OUTSIDE = [
    "../secret.bin",
    "%2e%2e/secret.bin",
    "..%2fsecret.bin",
    "a/../../secret.bin",
    "a/%2E%2E/%2E%2E/secret.bin",
    "/secret.bin",
    "%2Fsecret.bin",
    "//host/share/secret.bin",
    "\\\\host\\share\\secret.bin",
    "..\\secret.bin",
    "%5C%5Chost%5Cx",
    "C:\\secret.bin",
    "C:/secret.bin",
    "%43%3A%5Csecret.bin",
    *(["c:secret.bin"] if os.name == "nt" else []),
    "a\\..\\..\\secret.bin",
]


@pytest.mark.parametrize("uri", OUTSIDE)
def test_a_buffer_outside_the_folder_is_never_read(uri: str, tmp_path: Path) -> None:
    (tmp_path / "asset").mkdir()
    (tmp_path / "secret.bin").write_bytes(bytes(4096))
    assert "lies outside the folder" in fault(changed(tmp_path / "asset" / "a.gltf", uri=uri))


@POSIX
def test_a_colon_in_the_name_of_a_file_is_no_drive_where_there_are_none(tmp_path: Path) -> None:
    """Before, the buffer counted as outside of the folder."""
    path = changed(tmp_path / "a.gltf", uri="a%3Ab.bin")
    (tmp_path / "the data.bin").rename(tmp_path / "a:b.bin")
    assert GltfDocument.read(path).meshes()


@pytest.mark.parametrize(
    "uri",
    ["http://h/x", "https://h/x", "HTTPS://h/x", "file:///etc/passwd", "ftp://h/x", "s3://b/x", "file:x"],
)
def test_nothing_is_fetched_from_anywhere(uri: str, tmp_path: Path) -> None:
    assert "fetches nothing" in fault(changed(tmp_path / "a.gltf", uri=uri))


@POSIX
def test_a_link_that_leads_outside_counts_as_outside(tmp_path: Path) -> None:
    (tmp_path / "asset").mkdir()
    (tmp_path / "secret.bin").write_bytes(bytes(4096))
    path = changed(tmp_path / "asset" / "a.gltf", uri="link.bin")
    (tmp_path / "asset" / "link.bin").symlink_to(tmp_path / "secret.bin")
    assert "lies outside the folder" in fault(path)
    (tmp_path / "asset" / "folder").symlink_to(tmp_path)
    assert "lies outside the folder" in fault(changed(path, uri="folder/secret.bin"))
    (tmp_path / "asset" / "near.bin").symlink_to("the data.bin")
    assert GltfDocument.read(changed(path, uri="near.bin")).meshes()


@POSIX
def test_an_image_outside_the_folder_is_not_copied_along(tmp_path: Path) -> None:
    for name in ("asset", "other"):
        (tmp_path / name).mkdir()
    (tmp_path / "secret.png").write_bytes(b"secret")
    path = changed(tmp_path / "asset" / "a.gltf")
    (tmp_path / "asset" / "link.png").symlink_to(tmp_path / "secret.png")
    for uri in ("../secret.png", "link.png", "%2e%2e/secret.png"):
        gltf = json.loads(path.read_text())
        gltf["images"] = [{"uri": uri}]
        path.write_text(json.dumps(gltf))
        with pytest.raises(FileError, match="outside the folder"):
            edit(path, tmp_path / "other" / "a.gltf", lambda rig, report: rig)
        assert list((tmp_path / "other").iterdir()) == []


TEXTURED = """#usda 1.0
def Mesh "m" (prepend apiSchemas = ["MaterialBindingAPI"])
{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    rel material:binding = </look>
}
def Material "look"
{
    token outputs:surface.connect = </look/surface.outputs:surface>
    def Shader "surface"
    {
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor.connect = </look/map.outputs:rgb>
        token outputs:surface
    }
    def Shader "map"
    {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @IMAGE@
        float3 outputs:rgb
    }
}
"""


def _shown(folder: Path, image: str) -> Iterator[tuple[str, str, bytes]]:
    """What is said of an image, and what is written, by each command that reads images, in both formats."""
    folder.mkdir(exist_ok=True)
    gltf = changed(folder / "a.gltf")
    parts = json.loads(gltf.read_text())
    parts |= {"images": [{"uri": image}], "textures": [{"source": 0}]}
    parts["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    parts["meshes"][0]["primitives"][0]["material"] = 0
    gltf.write_text(json.dumps(parts))
    usd = folder / "b.usda"
    usd.write_text(TEXTURED.replace("IMAGE", image))
    for source, other in ((gltf, "a.usdz"), (usd, "b.glb")):
        for command, target in (("view", f"{source.name}.html"), ("convert", other)):
            result = cli(command, source, "-o", folder / target, "--overwrite")
            yield f"{command} {source.name}", result.stderr, (folder / target).read_bytes()


@POSIX
def test_pipes_are_no_images(tmp_path: Path) -> None:
    """Opening one would wait for whoever writes to it."""
    os.mkfifo(tmp_path / "pipe.png")
    for where, said, _ in _shown(tmp_path, "pipe.png"):
        assert "a device or a pipe" in said, where


@POSIX
@pytest.mark.parametrize("image", ["../secret.png", "link.png"])
def test_no_output_holds_an_image_from_outside_the_folder(image: str, tmp_path: Path) -> None:
    secret = b"\x89PNG\r\n\x1a\nsecret"
    (tmp_path / "secret.png").write_bytes(secret)
    (tmp_path / "asset").mkdir()
    (tmp_path / "asset" / "link.png").symlink_to(tmp_path / "secret.png")
    for where, said, written in _shown(tmp_path / "asset", image):
        assert "lies outside the folder" in said, where
        assert secret not in written, where
    out = tmp_path / "out.glb"
    assert not cli("convert", tmp_path / "asset" / "b.usda", "-o", out, "--allow-external-paths").exit_code
    assert secret in out.read_bytes()


@pytest.mark.parametrize("uri", ["\ud800.bin", "a\0b", "x" * 5000, "x/" * 3000 + "y", ".", "", "a/"])
def test_what_is_no_file_name_is_an_error(uri: str, tmp_path: Path) -> None:
    assert "buffers[0]" in fault(changed(tmp_path / "a.gltf", uri=uri))


@POSIX
def test_links_in_a_circle_and_pipes_are_no_buffers(tmp_path: Path) -> None:
    path = changed(tmp_path / "a.gltf", uri="one.bin")
    (tmp_path / "one.bin").symlink_to("two.bin")
    (tmp_path / "two.bin").symlink_to("one.bin")
    assert "buffers[0]" in fault(path)
    os.mkfifo(tmp_path / "pipe.bin")
    assert "is not a regular file" in fault(changed(path, uri="pipe.bin"))


# --- limits


@pytest.fixture(scope="module")
def frugal() -> Iterator[WorkerProcess]:
    """A child that may take no more than 256 MB."""
    with WorkerProcess(memory=1 << 28, seconds=60) as child:
        yield child


@pytest.mark.parametrize("number", [2**31 - 1, 2**31, 2**32, 2**53, 2**63, 2**64, 1e300])
@pytest.mark.parametrize("key", ["count", "byteOffset"])
def test_an_accessor_that_claims_too_much_allocates_nothing(
    key: str, number: float, frugal: WorkerProcess, tmp_path: Path
) -> None:
    builder = small()
    builder.gltf["accessors"][3][key] = number
    with pytest.raises(FileError, match=r"accessors\[3\]"):
        frugal("a.glb", read_any, builder.glb(tmp_path / "a.glb"))


@pytest.mark.parametrize("number", [2**31 - 1, 2**31, 2**63])
@pytest.mark.parametrize(
    ("owner", "key"),
    [("bufferViews", "byteLength"), ("bufferViews", "byteOffset"), ("buffers", "byteLength")],
)
def test_a_view_that_claims_too_much_is_named(owner: str, key: str, number: int, tmp_path: Path) -> None:
    path = small().gltf_file(tmp_path / "a.gltf")
    gltf = json.loads(path.read_text())
    gltf[owner][-1 if owner == "buffers" else 3][key] = number
    path.write_text(json.dumps(gltf))
    assert owner in fault(path) or "accessors[3]" in fault(path)


def test_zeros_and_sparse_rows_that_nobody_stores_are_limited(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["accessors"][3] = {"componentType": 5126, "type": "MAT4", "count": 2**31}
    assert "without bytes" in fault(builder.glb(tmp_path / "a.glb")) or "joints" in fault(tmp_path / "a.glb")
    builder = small()
    builder.gltf["accessors"][3]["sparse"] = {
        "count": 2**31,
        "indices": {"bufferView": 0, "componentType": 5125},
        "values": {"bufferView": 0},
    }
    assert "accessors[3].sparse" in fault(builder.glb(tmp_path / "b.glb"))


@pytest.mark.parametrize("brackets", ["[", '{"a":', '[{"":'])
@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_json_nested_a_hundred_thousand_times_is_an_error(brackets: str, suffix: str, tmp_path: Path) -> None:
    text = b'{"asset":{"version":"2.0"},"extras":' + brackets.encode() * 100_000
    path = tmp_path / f"deep{suffix}"
    path.write_bytes(glb_bytes(text, b"") if suffix == ".glb" else text)
    assert "nested too deep" in fault(path)


@pytest.mark.parametrize("depth", [50, 300, 600, 900])
@pytest.mark.parametrize("key", ["extras", "extensions"])
def test_json_nested_less_deep_is_kept_or_refused(key: str, depth: int, tmp_path: Path) -> None:
    builder, inner = small(), {}
    builder.gltf[key] = {"a": inner}
    for _ in range(depth):
        inner["a"] = inner = {}
    path, out = builder.glb(tmp_path / "a.glb"), tmp_path / "out.glb"
    reason = ""
    try:
        edit(path, out, lambda rig, report: rig)
    except FileError as error:
        reason = str(error)
    # A whole copy, or the reason and nothing.
    assert ("nested too deep" in reason) != out.exists()
    assert not out.exists() or out.read_bytes() == path.read_bytes()


@pytest.mark.ci
@pytest.mark.parametrize("kind", first([".glb", ".gltf", "embedded"]))
def test_a_gltf_cut_off_at_any_byte_is_refused(
    kind: str, tmp_path: Path, every: Callable[[int], int]
) -> None:
    builder = small()
    if kind == ".glb":
        whole = builder.glb(tmp_path / "a.glb").read_bytes()
    else:
        whole = builder.gltf_file(tmp_path / "a.gltf", embedded=kind == "embedded", indent=None).read_bytes()
    path = tmp_path / f"cut{'.glb' if kind == '.glb' else '.gltf'}"
    for length in range(0, len(whole), every(5)):
        path.write_bytes(whole[:length])
        with pytest.raises(FileError, match="cut"):
            GltfDocument.read(path)


@pytest.mark.parametrize("wrong", [3, "x", [3], {"a": 1}, True, None])
@pytest.mark.parametrize("member", ["meshes.primitives", "meshes.extras", "nodes.extensions", "nodes.mesh"])
def test_what_a_node_shows_may_be_of_any_type(member: str, wrong: Any, tmp_path: Path) -> None:
    builder = small()
    owner, _, key = member.partition(".")
    builder.gltf[owner][-1][key] = wrong
    path = builder.glb(tmp_path / "a.glb")
    with suppress(RigtriError):
        edit(path, tmp_path / "o.glb", lambda rig, report: orient_joints(rig, report=report))
    with suppress(RigtriError):
        verify(read_any(path), read_any(path))


# --- USD


def crate(folder: Path) -> bytes:
    layer = Sdf.Layer.FindOrOpen(str(save(folder, LAYER, "text.usda")))
    layer.Export(str(folder / "whole.usdc"))
    return (folder / "whole.usdc").read_bytes()


def zipped(*entries: tuple[str | zipfile.ZipInfo, bytes], path: Path) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as file:
        for name, content in entries:
            file.writestr(name, content)
    return path


def unread(folder: Path, suffix: str, whole: bytes, lengths: range) -> list[int]:
    """The lengths at which a file cut off is read all the same."""
    found = []
    for length in lengths:
        path = folder / f"cut{length}{suffix}"
        path.write_bytes(whole[:length])
        if not error_of(path):
            found.append(length)
        path.unlink()
    return found


@pytest.mark.parametrize("kind", [".usda", ".usdc", ci(".usdz")])
def test_a_usd_file_cut_off_at_any_byte_is_refused(
    kind: str, tmp_path: Path, every: Callable[[int], int]
) -> None:
    """Binary files in a child: it is no fault of ours, but may be the end of the process."""
    whole = {".usda": LAYER.rstrip().encode(), ".usdc": crate(tmp_path)}.get(kind)
    if whole is None:
        whole = zipped(("a.usdc", crate(tmp_path)), path=tmp_path / "whole.usdz").read_bytes()
    with WorkerProcess(seconds=120, memory=1 << 30) as child:
        for start in range(0, len(whole), 500):
            lengths = range(start, min(start + 500, len(whole)), every(7))
            assert child("cut", unread, tmp_path, kind, whole, lengths) == []


def test_bytes_that_are_no_text_are_refused_wherever_they_stand(tmp_path: Path) -> None:
    whole = bytearray(LAYER.encode())
    for place in range(0, len(whole), 7):
        old, whole[place] = whole[place], 0xFF
        path = tmp_path / f"odd{place}.usda"
        path.write_bytes(whole)
        whole[place] = old
        error_of(path)  # only a FileError may come out
    content = bytearray(crate(tmp_path))
    at = content.index(b"Root") if b"Root" in content else 200
    content[at] = 0xE8
    (tmp_path / "odd.usdc").write_bytes(content)
    assert error_of(tmp_path / "odd.usdc")


def test_a_crate_that_lists_a_prim_that_is_not_in_it_is_refused(tmp_path: Path) -> None:
    content = bytearray(crate(tmp_path))
    assert content[88:96] == struct.pack(
        "<Q", 1
    )  # so many root prims, and the token with the name of the first
    content[96] ^= 2
    (tmp_path / "odd.usdc").write_bytes(content)
    assert re.search(r"below </> it lists a prim '.*' and has none", error_of(tmp_path / "odd.usdc"))


def test_a_crate_that_lists_a_property_that_is_not_in_it_is_refused(tmp_path: Path) -> None:
    """Before, it had one without a name, at which `verify` ended with a traceback."""
    layer = Sdf.Layer.CreateNew(str(tmp_path / "odd.usdc"))
    prim = Sdf.PrimSpec(layer, "Root", Sdf.SpecifierDef)
    for name in ("x", "y"):
        Sdf.AttributeSpec(prim, name, Sdf.ValueTypeNames.Token)
    layer.Save()
    content = bytearray((tmp_path / "odd.usdc").read_bytes())
    at = content.rindex(struct.pack("<Q", 2), 0, 200) + 8  # the tokens of both names, behind their number
    content[at] -= 1
    (tmp_path / "odd.usdc").write_bytes(content)
    assert re.search(r"below </Root> it lists a property '.*' and has none", error_of(tmp_path / "odd.usdc"))


def test_a_crate_whose_sample_times_are_not_in_order_is_refused(tmp_path: Path) -> None:
    """OpenUSD lists all of them, and finds no value at some."""
    content = bytearray(crate(tmp_path))
    times = struct.pack("<Qdd", 2, 1.0, 5.0)
    at = content.index(times)
    content[at : at + 24] = struct.pack("<Qdd", 2, 5.0, 1.0)
    (tmp_path / "odd.usdc").write_bytes(content)
    assert "the times of its samples are not in order" in error_of(tmp_path / "odd.usdc")


@pytest.mark.parametrize("kind", [46, 49, 58])
def test_a_crate_whose_attribute_has_a_value_of_metadata_is_refused(kind: int, tmp_path: Path) -> None:
    """A list of layer offsets, for one: pxr has no Python object for it and ends in a TypeError."""
    content = bytearray(crate(tmp_path))
    (times,) = [m.start() for m in re.finditer(re.escape(struct.pack("<Qdd", 2, 1.0, 5.0)), content)]
    at = content.index(struct.pack("<Q", 2), times + 24)
    assert content[at + 14] == 17  # after the number of samples the first: a quatf[]
    content[at + 14] = kind
    (tmp_path / "odd.usdc").write_bytes(content)
    assert f"an attribute has a value of type {kind}" in error_of(tmp_path / "odd.usdc")


def test_a_crate_whose_attribute_has_metadata_as_its_default_is_refused(tmp_path: Path) -> None:
    layer = Sdf.Layer.CreateNew(str(tmp_path / "odd.usdc"))
    prim = Sdf.PrimSpec(layer, "Root", Sdf.SpecifierDef)
    Sdf.AttributeSpec(prim, "x", Sdf.ValueTypeNames.Double3).SetInfo("default", Sdf.TokenListOp())
    layer.Save()
    assert "an attribute has a value of type 32" in error_of(tmp_path / "odd.usdc")


def test_joints_that_are_no_tokens_are_refused_or_ignored_by_name(tmp_path: Path) -> None:
    for block in (skeleton(joints="int[] joints = [1, 2, 3]"), skeleton(joints="custom strong joints = 3")):
        assert error_of(save(tmp_path, scene(block, animation(), MESH), f"{len(block)}.usda"))
    odd = animation(joints="int[] joints = [1, 2, 3]")
    document = read(save(tmp_path, scene(skeleton(), odd, MESH), "b.usda"))
    assert not document.rig.clips
    (notice,) = document.warnings
    assert "moves no joints by animation </Root/Anim>: joints is int[] and should be token[]" in notice.text


def test_influences_that_do_not_fit_are_not_printed_by_pxr(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    short = MESH.replace("[1, 0, 0.5, 0.5, 1, 0] (element", "[1, 0, 0.5, 0.5, 1] (element")
    document = read(save(tmp_path, scene(skeleton(), animation(), short)))
    assert document.rig.skins[0].weighted.shape == (3,)
    document.meshes()
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("what", ["translation", "scale", "matrix", "inverse_bind"])
def test_an_edit_may_not_make_a_number_none(what: str, tmp_path: Path) -> None:
    def overflow(rig: Rig, report: Report) -> Rig:
        if what == "inverse_bind":
            (skin,) = rig.skins
            broken = skin.inverse_bind.copy()
            broken[1, 0, 0] = np.inf
            return replace(rig, skins=(replace(skin, inverse_bind=broken),))
        numbers = getattr(rig, what).copy()
        numbers[1] = np.nan
        return replace(rig, **{what: numbers})

    path = small().glb(tmp_path / "a.glb")
    with pytest.raises(GeometryError, match="'joint 1' gets no finite position"):
        edit(path, tmp_path / "out.glb", overflow)
    assert not (tmp_path / "out.glb").exists()


@pytest.mark.parametrize(
    ("file", "path", "value"),
    [
        ("biped.glb", "rotation", np.nan),
        ("biped.glb", "translation", 1e39),
        ("biped.usda", "translation", np.inf),
        ("biped.usda", "scale", 1e5),
    ],
)
@pytest.mark.parametrize("verify", [True, False])
def test_an_edit_may_not_make_a_clip_infinite(
    file: str, path: TrackKind, value: float, verify: bool, samples: Path, tmp_path: Path
) -> None:
    def overflow(rig: Rig, report: Report) -> Rig:
        clip = rig.clips[0]
        times = clip.tracks[0].times
        values = np.full((len(times), 4 if path == "rotation" else 3), value)
        hips = rig.find("hips")
        others = [track for track in clip.tracks if (track.node, track.path) != (hips, path)]
        track = Track(hips, path, "LINEAR", times, values)
        return replace(rig, clips=(replace(clip, tracks=(*others, track)), *rig.clips[1:]))

    with pytest.raises(GeometryError, match=f"The {path} of 'hips' in clip 'walk' gets values"):
        edit(samples / file, tmp_path / file, overflow, verify=verify)
    assert not (tmp_path / file).exists()


@pytest.mark.filterwarnings("error")
def test_numbers_near_the_end_of_float32_are_not_noisy(tmp_path: Path) -> None:
    builder = small(12)
    for node in builder.gltf["nodes"][:12]:
        node["scale"] = [3e38, 3e38, 3e38]
    with suppress(RigtriError):
        edit(builder.glb(tmp_path / "a.glb"), tmp_path / "o.glb", lambda r, _: orient_joints(r, report=_))


# --- packages


def test_headers_that_state_different_sizes_are_refused(tmp_path: Path) -> None:
    """USD reads the one, every unpacker the other: what is checked must be what is used."""
    path = zipped(("a.usda", LAYER.encode()), ("b.txt", b"twelve bytes"), path=tmp_path / "a.usdz")
    content = bytearray(path.read_bytes())
    second = content.index(b"PK\3\4", 4)
    struct.pack_into("<2I", content, second + 18, 4, 4)
    path.write_bytes(content)
    assert "another size in its own header" in error_of(path)
    struct.pack_into("<2I", content, second + 18, 12, 12)
    struct.pack_into("<H", content, second + 8, 8)
    path.write_bytes(content)
    assert "another size in its own header" in error_of(path)


@pytest.mark.parametrize(
    ("field", "number"),
    [(8, 0xFFFF), (10, 0xFFFF), (10, 5000), (12, 0xFFFFFFFF), (16, 0xFFFFFFFF), (16, 0x7FFFFFFF), (4, 1)],
)
def test_a_directory_that_claims_too_much_is_refused(field: int, number: int, tmp_path: Path) -> None:
    path = zipped(("a.usda", LAYER.encode()), path=tmp_path / "a.usdz")
    content = bytearray(path.read_bytes())
    struct.pack_into("<I" if field >= 12 else "<H", content, content.rindex(b"PK\5\6") + field, number)
    path.write_bytes(content)
    if field != 8:  # how many entries are on this disk: nobody asks, there is one disk
        assert error_of(path)


@pytest.mark.parametrize("offset", [20, 24, 42])
def test_an_entry_that_claims_too_much_is_refused(offset: int, tmp_path: Path) -> None:
    path = zipped(("a.usda", LAYER.encode()), path=tmp_path / "a.usdz")
    for number in (1 << 20, 0x7FFFFFFF, 0xFFFFFFFF):
        content = bytearray(path.read_bytes())
        at = content.index(b"PK\1\2")
        if offset < 42:
            struct.pack_into("<2I", content, at + 20, number, number)
        else:
            struct.pack_into("<I", content, at + offset, number)
        (tmp_path / f"b{number}.usdz").write_bytes(content)
        assert "entry 1" in error_of(tmp_path / f"b{number}.usdz")


def test_a_zip64_entry_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.usdz"
    with zipfile.ZipFile(path, "w") as file, file.open("a.usda", "w", force_zip64=True) as entry:
        entry.write(LAYER.encode())
    content = bytearray(path.read_bytes())
    content[18:26] = b"\xff" * 8  # the sizes of the entry's own header, which Python 3.11.2 does not set so
    path.write_bytes(content)
    assert error_of(path)


def test_a_link_in_a_package_leads_nowhere(tmp_path: Path) -> None:
    link = zipfile.ZipInfo("picture.png")
    link.external_attr = 0o120777 << 16
    path = zipped(("a.usda", LAYER.encode()), (link, b"/etc/passwd"), path=tmp_path / "a.usdz")
    with pytest.raises(FileError, match=r"'picture\.png' is a link"):
        usdz.read(path)


def test_a_misaligned_package_with_a_comment_is_read_and_comes_out_aligned(tmp_path: Path) -> None:
    path = zipped(("a.usda", LAYER.encode()), ("b.txt", b"b"), path=tmp_path / "a.usdz")
    with zipfile.ZipFile(path, "a") as file:
        file.comment = b"PK\5 no directory"
    edit(path, tmp_path / "out.usdz", lambda rig, report: orient_joints(rig, report=report))
    assert [entry.start % 64 for entry in usdz.read(tmp_path / "out.usdz").entries] == [0, 0]


# --- what a terminal gets


def test_names_cannot_steer_the_terminal(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["nodes"][1]["name"] = "a\x1b[2J\nrigtri: all is well\u202eb\ud800"
    path = builder.glb(tmp_path / "a.glb")
    shown = cli("inspect", path, code=0)
    assert "\x1b" not in shown.output
    assert "\u202e" not in shown.output
    limb = ["--limb", "#0", "#1", "#2", "--bend", "#1=0,1,0"]
    refused = cli("add-polevector", path, "-o", tmp_path / "o.glb", *limb)
    assert [line[:7] for line in refused.stderr.splitlines()] == ["rigtri:"]
    assert "\\nrigtri: all is well" in refused.stderr


def test_plain_text_keeps_scripts_and_escapes_what_controls() -> None:
    assert plain("名前 é שלום\ntwo") == "名前 é שלום\ntwo"
    assert plain("a\nb\tc", one_line=True) == "a\\nb\\tc"
    assert plain("\x1b[31m\u2066x\x07") == "\\x1b[31m\\u2066x\\x07"


def test_a_report_holds_names_that_are_no_text(tmp_path: Path) -> None:
    builder = small()
    builder.gltf["nodes"][1]["name"] = "half \ud800"
    path = builder.glb(tmp_path / "a.glb")
    report = tmp_path / "r.json"
    command = ["orient-joints", str(path), "-o", str(tmp_path / "o.glb"), "--report", str(report)]
    cli(*command, code=0)
    assert "half \ufffd" in {entry["joint"] for entry in json.loads(report.read_text("utf-8"))["joints"]}


# --- a process of its own


def twice(number: int) -> int:
    return 2 * number


def die(how: str) -> None:
    if how == "crash":
        os.kill(os.getpid(), 11)
    elif how == "hang":
        while True:
            pass
    elif how == "eat":
        bytearray(1 << 40)
    elif how == "refuse":
        read_any(Path("no.glb"))
    else:
        os._exit(3)


@POSIX
@pytest.mark.parametrize(
    ("how", "words", "kind"),
    [
        ("crash", r"hero\.usdc: the library that reads it crashed \(SIGSEGV\)", "crash"),
        ("leave", r"hero\.usdc: the library that reads it crashed \(3\)", "crash"),
        ("hang", r"hero\.usdc: took longer than 0\.5 s", "timeout"),
        ("eat", r"hero\.usdc: there is not enough memory", "memory"),
    ],
)
def test_what_ends_a_child_is_an_error_of_the_file_and_the_next_file_is_done(
    how: str, words: str, kind: str
) -> None:
    seconds = 0.5 if how == "hang" else 60
    with WorkerProcess(seconds=seconds, memory=1 << 28) as child:
        with pytest.raises(CrashError, match=words) as told:
            child("hero.usdc", die, how)
        assert told.value.kind == kind
    with WorkerProcess(seconds=60) as child:
        with pytest.raises(CrashError):
            child("hero.usdc", die, "crash")
        assert child("other.usdc", twice, 21) == 42
        with pytest.raises(FileError, match=r"no\.glb"):
            child("no.glb", die, "refuse")
        assert child("other.usdc", twice, 4) == 8


def counting(count: int) -> int:
    """A task that tells how far it is, and finds each time that it was heard."""
    for number in range(count):
        send_event(number)
    return count


def test_an_event_of_a_task_arrives_before_the_task_goes_on() -> None:
    heard: list[int] = []
    with WorkerProcess(seconds=60) as child:
        assert child("x", counting, 3, on_event=heard.append) == 3
    assert heard == [0, 1, 2]
    assert counting(3) == 3  # outside of a child nobody listens


def test_a_fault_in_the_task_itself_is_reported_with_its_traceback() -> None:
    with WorkerProcess(seconds=60) as child, pytest.raises(RuntimeError, match="TypeError"):
        child("x", twice, None)


def outer(task: str, *arguments: object) -> object:
    """What a child does with a child of its own; names, as functions of a test file travel."""
    with WorkerProcess() as child:
        return child("inner.usdc", {"twice": twice, "die": die, "wait": wait}[task], *arguments)


def wait(mark: str) -> None:
    """Leave this process's number in a file and then hang."""
    part = Path(mark + ".part")
    part.write_text(str(os.getpid()))
    part.rename(mark)
    threading.Event().wait()


@POSIX
def test_a_child_may_have_a_child_of_its_own_which_has_its_limits() -> None:
    with WorkerProcess(seconds=60, memory=1 << 28) as child:
        assert child("outer", outer, "twice", 21) == 42
        with pytest.raises(CrashError, match=r"inner\.usdc: the library that reads it crashed \(SIGSEGV\)"):
            child("outer", outer, "die", "crash")
        with pytest.raises(CrashError, match=r"inner\.usdc: there is not enough memory"):
            child("outer", outer, "die", "eat")
        assert child("outer", outer, "twice", 4) == 8


@POSIX
@pytest.mark.slow
def test_a_child_that_does_not_respond_ends_with_the_child_that_started_it(tmp_path: Path) -> None:
    mark = tmp_path / "number"
    with WorkerProcess(seconds=15) as child, pytest.raises(CrashError, match="took longer"):
        child("outer", outer, "wait", str(mark))
    number = int(mark.read_text())
    try:
        wait_for(lambda: not _runs(number))
    except AssertionError:
        os.kill(number, signal.SIGKILL)
        raise


def _runs(number: int) -> bool:
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    # What nobody has asked after yet is over all the same.
    state = Path(f"/proc/{number}/stat")
    return not (state.exists() and state.read_text().rpartition(")")[2].split()[0] == "Z")


@pytest.mark.parametrize("count", [2**31, 3.4e38])
def test_points_without_bytes_that_outnumber_their_weights_are_a_notice(count: float, tmp_path: Path) -> None:
    builder = small()
    points = builder.gltf["accessors"][builder.gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
    del points["bufferView"]
    points["count"] = count

    def step(rig: Rig, report: Report) -> Rig:
        return orient_joints(rig, options=OrientJointsOptions(joints=("*",)), report=report)

    outcome = edit(builder.glb(tmp_path / "in.glb"), tmp_path / "out.glb", step)
    assert "mesh-unread" in [notice.code for notice in outcome.report.warnings]


class _Spoilt:
    """A layer whose own data OpenUSD cannot unpack, and a finding of it that quotes bytes."""

    @property
    def customLayerData(self) -> Any:  # noqa: N802 (a name of pxr)
        Tf.RaiseRuntimeError("Attempted to unpack unsupported type enum value 239")

    def GetMessage(self) -> str:  # noqa: N802 (a name of pxr)
        return b"\xdd".decode("utf-8")


def test_custom_data_that_cannot_be_unpacked_are_an_error_of_the_file() -> None:
    from rigtri.formats.usd.composition.stage import overridden_file

    with pytest.raises(FileError, match=r"in\.usdc: USD cannot read it: .*enum value 239"):
        overridden_file(_Spoilt(), Path("in.usdc"))


def test_a_number_of_a_stage_that_cannot_be_unpacked_is_an_error_of_the_file(tmp_path: Path) -> None:
    """Where a crate keeps it beyond its own end. Before, a traceback."""
    path, layer = tmp_path / "in.usdc", Sdf.Layer.CreateAnonymous(".usdc")
    layer.pseudoRoot.SetInfo("metersPerUnit", 0.01)
    layer.Export(str(path))
    content = bytearray(path.read_bytes())
    place = content.index(struct.pack("<d", 0.01))
    where = content.index(place.to_bytes(1, "little"), place)
    content[where : where + 2] = b"\xff\xff"
    path.write_bytes(content)
    assert "USD cannot read it: Corrupt asset" in error_of(path)


def test_a_clock_without_length_is_looked_at_for_shear_all_the_same(tmp_path: Path) -> None:
    """Where a frame is 1e-30 time codes; before, 1e30 times between two samples, and a traceback."""
    path, crate = tmp_path / "in.usda", tmp_path / "in.usdc"
    path.write_text("""#usda 1.0
(
    framesPerSecond = 24
    timeCodesPerSecond = 1e-30
)
def Xform "top" {
    def Xform "turning" {
        matrix4d xformOp:transform.timeSamples = {
            0: ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)),
            10: ((0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)),
        }
        uniform token[] xformOpOrder = ["xformOp:transform"]
    }
}
""")
    Sdf.Layer.FindOrOpen(str(path)).Export(str(crate))
    rate = struct.pack("<fHBB", 24.0, 0, 9, 0x40)  # a double that is held as a float
    assert rate in crate.read_bytes()
    crate.write_bytes(crate.read_bytes().replace(rate, struct.pack("<fHBB", 0.0, 0, 9, 0x40)))
    for file in (path, crate):
        assert read_any(file, ReadOptions(root="top")).rig.clips


def test_a_finding_of_openusd_that_quotes_bytes_is_reported_all_the_same() -> None:
    from rigtri.verification.checks.usd.usd_validation import _message

    assert "not text" in _message(_Spoilt())


DEEP = {
    "tuples": 'def "A" { custom double3 x = ' + "(" * 60_000 + "1" + ")" * 60_000 + "}",
    "arrays": 'def "A" { custom double[] x = ' + "[" * 60_000 + "1" + "]" * 60_000 + "}",
    "prims": 'def "A" {\n' * 60_000 + "}" * 60_000,
    "open": 'def "A" { custom double3 x = ' + "(" * 60_000,
    # Closing brackets in words and comments close nothing.
    "words": 'def "A" { custom double3 x = ' + ("(" * 600 + "# " + ")" * 600 + "\n") * 100,
}


@pytest.mark.parametrize("how", ["alone", ci("reference"), ci("clip"), "package"])
@pytest.mark.parametrize("what", DEEP)
def test_usd_nested_sixty_thousand_times_is_an_error_of_the_file(what: str, how: str, tmp_path: Path) -> None:
    deep = tmp_path / "deep.usda"
    deep.write_text("#usda 1.0\n" + DEEP[what])
    path = tmp_path / "a.usda"
    if how == "alone":
        path = deep
    elif how == "reference":
        path.write_text('#usda 1.0\ndef "Root" (payload = @./deep.usda@</A>)\n{\n}\n')
    elif how == "clip":
        path.write_text(
            '#usda 1.0\ndef "Root" (clips = { dictionary default = { asset[] assetPaths = [@./deep.usda@]\n'
            '    string primPath = "/A"\n    double2[] active = [(0, 0)] } })\n{\n}\n'
        )
    else:
        path = tmp_path / "a.usdz"
        root = tmp_path / "root.usda"
        root.write_text('#usda 1.0\ndef "Root" (references = @./deep.usda@</A>)\n{\n}\n')
        with Sdf.ZipFileWriter.CreateNew(str(path)) as archive:
            archive.AddFile(str(root), "root.usda")
            archive.AddFile(str(deep), "deep.usda")
    with pytest.raises(FileError, match=r"deep\.usda.*: more than \d+ (brackets|braces) are nested"):
        read(path)


def test_brackets_in_words_and_comments_are_not_nested(tmp_path: Path) -> None:
    odd = "# " + "(" * 6000 + '\nstring s = "' + "[({" * 6000 + '" /* ' + "{" * 6000 + " */\n"
    path = tmp_path / "a.usda"
    path.write_text(scene(skeleton(), animation(), MESH, odd))
    assert read(path).rig.skins


@pytest.mark.parametrize("command", ["view", "convert", "orient-joints", "inspect"])
def test_a_sample_at_time_nan_is_refused_with_its_attribute(command: str, tmp_path: Path) -> None:
    """Before, `view` crashed in OpenUSD, and `convert` ended in a traceback."""
    path = tmp_path / "a.usda"
    path.write_text(
        '#usda 1.0\ndef Mesh "M"\n{\n    int[] faceVertexCounts = [3]\n'
        "    int[] faceVertexIndices = [0, 1, 2]\n    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n"
        '    token visibility.timeSamples = { nan: "inherited" }\n}\n'
    )
    outputs = {"view": ["-o", tmp_path / "o.html"], "convert": ["-o", tmp_path / "o.glb"]}
    words = outputs.get(command, ["-n"] if command == "orient-joints" else [])
    reason = cli(command, path, *words, code=3).stderr
    assert "/M.visibility has a sample at time nan" in reason


@pytest.mark.parametrize("field", ["metersPerUnit", "timeCodesPerSecond", "startTimeCode"])
def test_metadata_of_a_stage_that_are_nan_are_refused_with_their_layer(field: str, tmp_path: Path) -> None:
    """Before, edits ended with 6, "metersPerUnit is nan, was nan", and `convert` named OUT."""
    path = tmp_path / "a.usda"
    path.write_text(scene(skeleton(), animation(), MESH, head=f"    {field} = nan\n"))
    reason = cli("inspect", path, code=3).stderr
    assert f"a.usda: {field} is nan" in reason


@pytest.mark.parametrize("field", ["timeCodesPerSecond", "metersPerUnit"])
def test_metadata_are_checked_in_the_layers_where_they_mean_something(field: str, tmp_path: Path) -> None:
    (tmp_path / "b.usda").write_text(f"#usda 1.0\n(\n    {field} = inf\n)\n")
    path = tmp_path / "a.usda"
    head = "    endTimeCode = inf\n    subLayers = [@./b.usda@]\n"
    path.write_text(scene(skeleton(), animation(), MESH, head=head))
    if field == "metersPerUnit":  # only that of the root layer counts
        assert read(path).rig.skins
    else:
        assert "b.usda: timeCodesPerSecond is inf" in cli("inspect", path, code=3).stderr


@pytest.mark.parametrize("field", ["metersPerUnit", "timeCodesPerSecond"])
def test_a_stage_without_a_size_or_time_is_not_converted(field: str, tmp_path: Path) -> None:
    """Before, everything was at one point, or at one moment."""
    path = tmp_path / "a.usda"
    path.write_text(scene(skeleton(), animation(), MESH, head=f"    {field} = 0\n"))
    reason = cli("convert", path, "-o", tmp_path / "o.glb", code=3).stderr
    assert f"a.usda: {field} is 0" in reason


def test_an_up_axis_that_usd_does_not_define_is_a_warning(tmp_path: Path) -> None:
    path = tmp_path / "a.usda"
    path.write_text(scene(skeleton(), animation(), MESH).replace('upAxis = "Y"', 'upAxis = "X"'))
    (notice,) = (notice for notice in read(path).warnings if notice.code == "up-axis")
    assert "upAxis is 'X'" in notice.text


def test_an_accessor_by_a_whole_number_with_a_point_is_known_where_a_skin_grows(tmp_path: Path) -> None:
    """Some exporters write all numbers as floats; before, a traceback."""
    (tmp_path / "biped.bin").write_bytes((SAMPLES / "biped.bin").read_bytes())
    gltf = json.loads((SAMPLES / "biped.gltf").read_text("utf-8"))
    gltf["skins"][0]["inverseBindMatrices"] *= 1.0
    path = tmp_path / "in.gltf"
    path.write_text(json.dumps(gltf), "utf-8")
    points = ["--points", "0,0,0", "0,1,0.1", "0,2,0", "--parent", "hips"]
    cli("make-limb", path, "-o", tmp_path / "out.gltf", *points, code=0)
