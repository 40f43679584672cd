"""A USD file, or a layer of it, is replaced while a rig that was read from it lives on."""

from __future__ import annotations

import os
import shutil
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event
from typing import Any

import pytest

import rigtri
from rigtri.errors import FileError
from rigtri.formats import ReadOptions, read
from rigtri.formats.usd import document
from rigtri.formats.usd.composition import stage

SAMPLES = Path(__file__).parents[3] / "samples"
BIPED = SAMPLES / "biped.usda"
TOP = '#usda 1.0\n(\n    subLayers = [@./base.usda@]\n    defaultPrim = "biped"\n)\n'


def _crate(path: Path) -> Path:
    from pxr import Sdf

    Sdf.Layer.FindOrOpen(str(BIPED)).Export(str(path))
    return path


@pytest.fixture(params=[".usda", *(pytest.param(each, marks=pytest.mark.ci) for each in (".usdc", ".usdz"))])
def biped(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path = tmp_path / f"biped{request.param}"
    if request.param == ".usdc":
        return _crate(path)
    return Path(shutil.copyfile(SAMPLES / path.name, path))


def test_a_rig_of_a_file_that_was_replaced_is_written_as_if_it_were_still_there(
    biped: Path, tmp_path: Path
) -> None:
    """As with glTF: the file as it was read, by whatever operations, and also in its own place."""
    old = biped.read_bytes()
    expected, out = tmp_path / f"expected{biped.suffix}", tmp_path / f"out{biped.suffix}"
    rigtri.write(rigtri.add_root(rigtri.read(biped)), expected)
    before = rigtri.read(biped)
    rigtri.write(rigtri.add_socket(before, name="grip", on="hand_L"), biped, overwrite=True)
    rigtri.write(rigtri.add_root(before), out)  # replaced, and not read again
    assert out.read_bytes() == expected.read_bytes()
    after = rigtri.read(biped)
    assert len(after) > len(before)
    rigtri.write(rigtri.add_root(before), out, overwrite=True)  # read again
    assert out.read_bytes() == expected.read_bytes()
    again = rigtri.read(out)
    rigtri.write(again, biped, overwrite=True)
    rigtri.write(after, out, overwrite=True)
    assert rigtri.read(out).names == after.names != rigtri.read(biped).names == again.names
    rigtri.write(before, biped, overwrite=True)
    assert biped.read_bytes() == old


def test_what_a_file_refers_to_is_found_when_it_was_replaced(tmp_path: Path) -> None:
    top, out = tmp_path / "top.usda", tmp_path / "to" / "out.usda"
    out.parent.mkdir()
    shutil.copyfile(BIPED, tmp_path / "base.usda")
    top.write_text(TOP, "utf-8")
    rigtri.write(rigtri.add_root(rigtri.read(top)), tmp_path / "expected.usda")
    before = rigtri.read(top)
    rigtri.write(rigtri.add_socket(rigtri.read(BIPED), name="grip", on="hand_L"), top, overwrite=True)
    assert len(rigtri.read(top)) != len(before)
    rigtri.write(rigtri.add_root(before), tmp_path / "out.usda")
    assert (tmp_path / "out.usda").read_bytes() == (tmp_path / "expected.usda").read_bytes()
    rigtri.write(before, out)
    assert "@../base.usda@" in out.read_text("utf-8")
    assert len(rigtri.read(out, ReadOptions(allow_external_paths=True))) == len(before)
    needed = [file.name for file, _ in read(top).needed()]
    assert "base.usda" not in needed
    with pytest.raises(rigtri.errors.UsageError, match=r"base\.usda"):
        rigtri.write(before, tmp_path / "base.usda", overwrite=True)


def test_a_text_that_was_written_over_is_as_it_was_read(tmp_path: Path) -> None:
    path = Path(shutil.copyfile(BIPED, tmp_path / "biped.usda"))
    before = rigtri.read(path)
    path.write_text(path.read_text("utf-8").replace('"biped"', '"other"'), "utf-8")
    rigtri.write(before, tmp_path / "out.usda")
    assert (tmp_path / "out.usda").read_bytes() == BIPED.read_bytes()


def test_a_crate_that_was_written_over_is_refused(tmp_path: Path) -> None:
    """USD reads its arrays from the file when they are needed, and finds those of another."""
    path = _crate(tmp_path / "biped.usdc")
    before, content = rigtri.read(path), path.read_bytes()
    path.write_bytes(content + b" ")
    with pytest.raises(
        FileError, match=r"was written or replaced after this rig was read from it\. Read it again"
    ):
        rigtri.write(before, tmp_path / "out.usdc")
    assert not (tmp_path / "out.usdc").exists()


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
def test_a_file_that_was_only_touched_is_the_one_that_was_read(suffix: str, tmp_path: Path) -> None:
    """Before, a new time alone was "replaced" for crates and packages."""
    path = tmp_path / f"biped{suffix}"
    _crate(path) if suffix == ".usdc" else shutil.copyfile(BIPED.with_suffix(suffix), path)
    before, content = rigtri.read(path), path.read_bytes()
    os.utime(path, (1e9, 1e9))
    rigtri.read(path)
    rigtri.write(before, tmp_path / f"out{suffix}")
    assert (tmp_path / f"out{suffix}").read_bytes() == content


@pytest.mark.parametrize("asked", ["source", "meshes"])
def test_a_crate_that_is_written_over_while_it_is_read_is_told_so(
    asked: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, USD's own "Corrupt asset" was all that was told of a file that was good again."""
    path = _crate(tmp_path / "biped.usdc")

    def written_over(*args: Any) -> Any:
        path.write_bytes(path.read_bytes() + b" ")
        raise FileError("Corrupt asset @biped.usdc@")

    monkeypatch.setattr(document, f"read_{asked}", written_over)
    with pytest.raises(FileError, match=r"biped\.usdc was written while it was read\. Read it again"):
        read(path).meshes()


@pytest.mark.parametrize("target", ["new", "bare"])
def test_opinions_about_a_file_that_was_replaced_are_refused(tmp_path: Path, target: str) -> None:
    path = Path(shutil.copyfile(BIPED, tmp_path / "biped.usda"))
    before = rigtri.read(path, ReadOptions(edit_target=target))
    rigtri.write(rigtri.add_socket(rigtri.read(path), name="grip", on="hand_L"), path, overwrite=True)
    for _ in range(2):
        with pytest.raises(FileError, match=r"biped\.usda was written or replaced after"):
            rigtri.write(rigtri.add_root(before), tmp_path / "out.usda")
        assert len(rigtri.read(path)) > len(before)


def test_bare_opinions_that_were_replaced_are_refused(tmp_path: Path) -> None:
    path = Path(shutil.copyfile(BIPED, tmp_path / "biped.usda"))
    bare, other = tmp_path / "bare.usda", tmp_path / "other.usda"
    rig = rigtri.read(path, ReadOptions(edit_target="bare"))
    rigtri.write(rigtri.add_root(rig), bare)
    rigtri.write(rigtri.add_socket(rig, name="grip", on="hand_L"), other)
    before = rigtri.read(bare)
    other.replace(bare)
    with pytest.raises(FileError, match=r"bare\.usda was written or replaced after"):
        rigtri.write(before, tmp_path / "out.usda")


def test_a_sublayer_that_was_replaced_is_read_anew(tmp_path: Path) -> None:
    base, top = tmp_path / "base.usda", tmp_path / "top.usda"
    shutil.copyfile(BIPED, base)
    top.write_text(TOP, "utf-8")
    before, own = rigtri.read(top), rigtri.read(base)
    built = tmp_path / "built.usda"
    rigtri.write(rigtri.add_socket(rigtri.read(BIPED), name="grip", on="hand_L"), built)
    built.replace(base)
    assert len(rigtri.read(top)) > len(before)
    with pytest.raises(FileError, match=r"base\.usda was written or replaced"):
        rigtri.write(before, tmp_path / "out.usda")
    rigtri.write(own, tmp_path / "own.usda")
    assert (tmp_path / "own.usda").read_bytes() == BIPED.read_bytes()


def test_a_package_of_several_layers_that_was_replaced_is_refused(tmp_path: Path) -> None:
    """Its layers know each other by the name of the package."""
    from pxr import Sdf

    package = tmp_path / "hero.usdz"
    shutil.copyfile(BIPED, tmp_path / "base.usda")
    (tmp_path / "top.usda").write_text(TOP, "utf-8")
    writer = Sdf.ZipFileWriter.CreateNew(str(package))
    for name in ("top.usda", "base.usda"):
        writer.AddFile(str(tmp_path / name), name)
    writer.Save()
    before = rigtri.read(package)
    shutil.copyfile(SAMPLES / "biped.usdz", tmp_path / "new.usdz")
    (tmp_path / "new.usdz").replace(package)
    assert rigtri.read(package)
    with pytest.raises(FileError, match=r"hero\.usdz was written or replaced after"):
        rigtri.write(before, tmp_path / "out.usdz")


@pytest.mark.parametrize("content", [b"", b"#usda 1.0\ndef \n"])
def test_a_text_that_was_cut_off_since_is_one_error(tmp_path: Path, content: bytes) -> None:
    path = Path(shutil.copyfile(BIPED, tmp_path / "biped.usda"))
    before = rigtri.read(path)
    path.write_bytes(content)
    with pytest.raises(FileError, match=r"biped\.usda was replaced, and USD cannot read it"):
        rigtri.write(before, tmp_path / "out.usda")
    assert not (tmp_path / "out.usda").exists()


def test_one_thread_at_a_time_is_in_usd() -> None:
    """pxr changes all stages of a process where a layer is read anew: a thread that reads one would crash."""
    stderr, inside, on = sys.stderr, Event(), Event()

    def first() -> None:
        with stage.quiet("one"):
            inside.set()
            on.wait()

    with ThreadPoolExecutor(1) as pool:
        done = pool.submit(first)
        inside.wait()
        free = stage.one_thread.acquire(blocking=False)
        on.set()
        done.result()
    assert not free
    with stage.quiet("another"), stage.quiet("and below it"):
        pass
    assert sys.stderr is stderr


@pytest.mark.ci
def test_threads_read_edit_and_write_one_file(tmp_path: Path) -> None:
    path = _crate(tmp_path / "biped.usdc")

    def edit(preset: str) -> None:
        for _ in range(2):
            rigtri.write(rigtri.orient_joints(rigtri.read(path), preset=preset), path, overwrite=True)

    with ThreadPoolExecutor(3) as pool:
        for done in [pool.submit(edit, preset) for preset in ("maya", "blender", "mgear")]:
            done.result()
    assert rigtri.verify(BIPED, path).largest_deviation < 1e-5
    assert [*tmp_path.iterdir()] == [path]
