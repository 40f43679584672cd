"""Files that a .gltf refers to: outside its folder, no plain files, missing; and GLBs cut off at once."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest
from gltf_files import small

from rigtri.errors import FileError
from rigtri.formats import ReadOptions, read
from rigtri.model.rig import Rig
from rigtri.pipeline.edit import Outcome, edit
from rigtri.report import Report
from rigtri.verification.checks import check

ALLOWED = ReadOptions(allow_external_paths=True)


def nothing(rig: Rig, report: Report) -> Rig:
    return rig


def referring(folder: Path, *, buffer: str | None = None, image: str | None = None) -> Path:
    """A .gltf whose buffer or image has another URI; its data lie beside it."""
    folder.mkdir(exist_ok=True)
    path = small().gltf_file(folder / "hero.gltf")
    document: dict[str, Any] = json.loads(path.read_text("utf-8"))
    if buffer is not None:
        document["buffers"][0]["uri"] = buffer
    if image is not None:
        document["images"] = [{"uri": image}]
    path.write_text(json.dumps(document), "utf-8")
    return path


def moved(source: Path, folder: Path, options: ReadOptions) -> Outcome:
    folder.mkdir()
    return edit(source, folder / "out.gltf", nothing, options=options)


@pytest.mark.parametrize("options", [ALLOWED, ReadOptions()], ids=["allowed", "not"])
def test_what_cannot_be_copied_along_is_advised_to_be_relinked(options: ReadOptions, tmp_path: Path) -> None:
    source = referring(tmp_path / "in", image="../secret.png")
    (tmp_path / "secret.png").write_bytes(b"image")
    with pytest.raises(FileError, match=r"images\.0\.uri: '\.\./secret.* --resources relink") as e:
        moved(source, tmp_path / "out", options)
    assert "--allow-external-paths" not in str(e.value)
    assert list((tmp_path / "out").iterdir()) == []
    relinked = ReadOptions(allow_external_paths=options.allow_external_paths, resources="relink")
    moved(source, tmp_path / "other", relinked)
    uri = json.loads((tmp_path / "other" / "out.gltf").read_text("utf-8"))["images"][0]["uri"]
    assert (tmp_path / "other" / uri).resolve() == tmp_path / "secret.png"


def test_a_device_is_no_missing_file(tmp_path: Path) -> None:
    source = referring(tmp_path / "in", buffer=os.devnull)
    with pytest.raises(
        FileError, match=f"'{os.devnull}' is not a regular file but a folder, a device or a pipe"
    ):
        read(source, ALLOWED)
    (finding,) = [f for f in check(source, allow_external_paths=True) if f.id == "gltf.buffer.missing"]
    assert "is not a regular file" in finding.message


def test_a_missing_file_is_named_as_the_file_names_it(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"the file 'gone\.bin' is missing; put it beside hero\.gltf"):
        read(referring(tmp_path / "in", buffer="gone.bin"))
    with pytest.raises(FileError, match=r"the file 'sub/\.\./gone\.bin', as seen from the folder of hero"):
        read(referring(tmp_path / "in", buffer="sub/../gone.bin"), ALLOWED)


@pytest.mark.parametrize(
    "options", [ReadOptions(), ReadOptions(resources="relink")], ids=["copied", "linked"]
)
def test_a_missing_image_is_reported_where_a_file_moves_and_only_there(
    options: ReadOptions, tmp_path: Path
) -> None:
    source = referring(tmp_path / "in", image="skin%20of.png")
    (warning,) = moved(source, tmp_path / "out", options).report.warnings
    assert warning.code == "file-missing"
    assert warning.text.startswith("images.0.uri: the file 'skin of.png' is missing; put it beside hero.gltf")
    assert edit(source, tmp_path / "in" / "out.gltf", nothing, options=options).report.warnings == []
    (tmp_path / "in" / "skin of.png").write_bytes(b"image")
    assert moved(source, tmp_path / "again", options).report.warnings == []


@pytest.mark.parametrize("content", [b"", b"g", b"glT", b"glTF", b"glTF\2\0\0\0", b"junk", b"\0" * 16])
@pytest.mark.parametrize("suffix", [".glb", ".vrm", ".gltf"])
def test_a_file_cut_off_at_once_is_a_fault_of_the_file(content: bytes, suffix: str, tmp_path: Path) -> None:
    source, out = tmp_path / f"in{suffix}", tmp_path / f"out{suffix}"
    source.write_bytes(content)
    with pytest.raises(FileError, match="empty" if not content else None):
        edit(source, out, nothing)
    assert not out.exists()


IMAGES = {
    "gone.png": "the file 'gone.png' is missing",
    "pipe.png": "'pipe.png' is not a regular file but a folder, a device or a pipe",
    "link.png": "'link.png' is not a regular file but a folder, a device or a pipe",
    "https://example.com/x.png": "rigtri fetches nothing from 'https://example.com/x.png'",
}


@pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")
@pytest.mark.parametrize("image", list(IMAGES))
def test_check_and_edits_report_the_same_of_an_image_that_cannot_be_had(image: str, tmp_path: Path) -> None:
    source = referring(tmp_path / "in", image=image)
    os.mkfifo(tmp_path / "in" / "pipe.png")
    (tmp_path / "in" / "link.png").symlink_to("pipe.png")
    (warning,) = moved(source, tmp_path / "out", ReadOptions()).report.warnings
    assert warning.text.startswith(f"images.0.uri: {IMAGES[image]}")
    (finding,) = [item for item in check(source) if item.id == "gltf.file.missing"]
    assert (finding.severity, finding.pointer) == ("warning", "/images/0/uri")
    assert finding.message.startswith(IMAGES[image])


@pytest.mark.parametrize("uri", ["sub/../{}", "./{}", "a/b/../../{}"])
def test_steps_down_and_up_again_stay_inside(uri: str, tmp_path: Path) -> None:
    """Whether the folders are there or not, as where URIs are resolved (RFC 3986, 5.2.4)."""
    source = referring(tmp_path / "in")
    name = json.loads(source.read_text("utf-8"))["buffers"][0]["uri"]
    source = referring(tmp_path / "in", buffer=uri.format(name))
    moved(source, tmp_path / "out", ReadOptions())
    assert len(read(tmp_path / "out" / "out.gltf").rig) == len(read(source).rig)
    assert not [item for item in check(source) if item.severity == "error"]


@pytest.mark.parametrize("uri", ["sub/../../{}", "../{}", "sub/../link/../../{}", "..\\{}", "sub/..\\..\\{}"])
def test_steps_that_end_outside_are_refused_and_nothing_is_read(uri: str, tmp_path: Path) -> None:
    source = referring(tmp_path / "in")
    name = json.loads(source.read_text("utf-8"))["buffers"][0]["uri"]
    (tmp_path / "in" / unquote(name)).rename(tmp_path / unquote(name))
    (tmp_path / "in" / "link").symlink_to("..")
    with pytest.raises(FileError, match="lies outside"):
        read(_with(source, uri.format(name)))
    with pytest.raises(FileError, match="lies outside"):
        read(_with(source, f"link/{name}"))


def _with(source: Path, uri: str) -> Path:
    document = json.loads(source.read_text("utf-8"))
    document["buffers"][0]["uri"] = uri
    source.write_text(json.dumps(document), "utf-8")
    return source
