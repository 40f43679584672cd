"""Files beside a .gltf are copied while it is read; whoever needs them gets them whole or not at all."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
import threading
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import small
from program import cli

from rigtri.evaluation.sampling import sorted_unique
from rigtri.files import background_copy
from rigtri.files.atomic_write import temp_path


@pytest.fixture(autouse=True)
def all_large(monkeypatch: pytest.MonkeyPatch) -> None:
    """Treat files of any size as large."""
    monkeypatch.setattr(background_copy, "FROM", 1)


@pytest.fixture
def source(tmp_path: Path) -> Path:
    (tmp_path / "there").mkdir()
    return small().gltf_file(tmp_path / "a.gltf")


run = partial(cli, "orient-joints", "-q")


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_an_edit_to_another_folder_takes_the_copy_that_was_begun(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    taken: list[bool] = []
    take = background_copy.BackgroundCopies.take

    def noted(self: background_copy.BackgroundCopies, file: Path, part: Path) -> bool:
        taken.append(take(self, file, part))
        return taken[-1]

    monkeypatch.setattr(background_copy.BackgroundCopies, "take", noted)
    target = tmp_path / "there" / "b.gltf"
    assert run(source, "-o", target).exit_code == 0
    assert taken == [True]
    assert (target.parent / "the data.bin").read_bytes() == (tmp_path / "the data.bin").read_bytes()
    assert not [name for name in names(target.parent) if name.startswith(".")]


def test_without_a_head_start_the_output_is_the_same(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "there" / "b.gltf"
    assert run(source, "-o", target).exit_code == 0
    first = {path.name: path.read_bytes() for path in target.parent.iterdir()}
    for path in target.parent.iterdir():
        path.unlink()
    monkeypatch.setattr(background_copy, "FROM", 1 << 40)
    assert run(source, "-o", target).exit_code == 0
    assert {path.name: path.read_bytes() for path in target.parent.iterdir()} == first


@pytest.mark.parametrize("wrong", [["--joints", "nobody"], ["--root", "nobody"]])
def test_an_edit_that_fails_leaves_no_copy(wrong: list[str], source: Path, tmp_path: Path) -> None:
    assert run(source, "-o", tmp_path / "there" / "b.gltf", *wrong).exit_code != 0
    assert names(tmp_path / "there") == []


@pytest.mark.parametrize("more", [["--dry-run"], ["--resources", "relink"]])
def test_nothing_is_copied_that_the_output_does_not_need(
    more: list[str], source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(background_copy.BackgroundCopies, "begin", lambda *_: pytest.fail("a copy was begun"))
    assert run(source, "-o", tmp_path / "there" / "b.gltf", *more).exit_code == 0


def test_a_file_of_the_same_name_is_not_touched_without_overwrite(source: Path, tmp_path: Path) -> None:
    (tmp_path / "there" / "the data.bin").write_bytes(b"another")
    assert run(source, "-o", tmp_path / "there" / "b.gltf").exit_code == 2
    assert names(tmp_path / "there") == ["the data.bin"]
    assert (tmp_path / "there" / "the data.bin").read_bytes() == b"another"


def test_names_that_lead_out_of_the_folder_are_not_copied_ahead(tmp_path: Path) -> None:
    folder, there = tmp_path / "in", tmp_path / "there"
    folder.mkdir()
    there.mkdir()
    (tmp_path / "secret.bin").write_bytes(b"secret")
    (folder / "link.bin").symlink_to(tmp_path / "secret.bin")
    for uri in ("../secret.bin", "link.bin", str(tmp_path / "secret.bin"), "..%2Fsecret.bin", "b.gltf"):
        (folder / "a.gltf").write_text(f'{{"buffers": [{{"uri": "{uri}"}}]}}', "utf-8")
        with background_copy.copy_in_background(folder / "a.gltf", there / "b.gltf"):
            assert names(there) == []


def test_each_large_file_is_copied_ahead_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not what is there, is missing, is small, is inside the .gltf, or becomes the output."""
    folder, there = tmp_path / "in", tmp_path / "there"
    folder.mkdir()
    there.mkdir()
    for name in ("a b.bin", "c.png", "old.bin", "b.gltf", "small.bin"):
        (folder / name).write_bytes(b"12" if name == "small.bin" else b"1234")
    (there / "old.bin").write_bytes(b"5")
    uris = ["a%20b.bin", "c.png", "c.png", "old.bin", "gone.bin", "b.gltf", "small.bin", "data:,1", 3]
    entries = [{"uri": uri} for uri in uris]
    (folder / "a.gltf").write_text(json.dumps({"buffers": [{}, *entries], "images": [*entries, None]}))
    begun: list[tuple[Path, Path]] = []
    monkeypatch.setattr(background_copy, "FROM", 4)
    monkeypatch.setattr(
        background_copy.BackgroundCopies, "begin", lambda _, file, place: begun.append((file, place))
    )
    with background_copy.copy_in_background(folder / "a.gltf", there / "b.gltf"):
        assert begun == [(folder / name, there / name) for name in ("a b.bin", "c.png")]
    begun.clear()
    for source, target in (("a.gltf", "in/b.gltf"), ("a.gltf", "there/b.glb"), ("c.png", "there/b.gltf")):
        with background_copy.copy_in_background(folder / source, tmp_path / target):
            assert begun == []


def test_a_source_that_changed_meanwhile_is_copied_anew(source: Path, tmp_path: Path) -> None:
    file, target = tmp_path / "the data.bin", tmp_path / "there" / "b.gltf"
    with background_copy.copy_in_background(source, target) as copies:
        file.write_bytes(b"longer than it was before" * 100)
        part = temp_path(target.parent / file.name)
        assert not copies.take(file, part)
        assert not part.exists()


@pytest.mark.parametrize("ended", [True, False], ids=["removed", "stopped"])
def test_a_copy_that_is_not_there_or_did_not_end_is_made_anew(
    ended: bool, source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One that somebody removed, or one that was stopped behind its last byte."""
    file, target = tmp_path / "the data.bin", tmp_path / "there" / "b.gltf"

    def copy(_: Path, to: Path, __: Any) -> bool:
        if not ended:
            to.write_bytes(file.read_bytes())
        return ended

    monkeypatch.setattr(background_copy, "copy_file", copy)
    with background_copy.copy_in_background(source, target) as copies:
        assert not copies.take(file, temp_path(target.parent / file.name))


@pytest.mark.parametrize("number", [errno.ENOSYS, errno.EXDEV, None])
def test_what_the_kernel_cannot_copy_is_copied_all_the_same(
    number: int | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: Any) -> int:
        assert number is not None
        raise OSError(number, os.strerror(number))

    (tmp_path / "a").write_bytes(os.urandom(100_000))
    if number is None:
        monkeypatch.delattr(os, "copy_file_range", raising=False)
    else:
        monkeypatch.setattr(os, "copy_file_range", refuse, raising=False)
    monkeypatch.setattr(background_copy, "STEP", 1 << 12)
    assert background_copy.copy_file(tmp_path / "a", tmp_path / "b")
    assert (tmp_path / "b").read_bytes() == (tmp_path / "a").read_bytes()


def test_a_copy_that_is_stopped_reports_it(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(bytes(100))
    stop = threading.Event()
    stop.set()
    assert not background_copy.copy_file(tmp_path / "a", tmp_path / "b", stop)


def test_the_kernel_copies_what_it_can_until_it_is_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    content, stop, asked = bytes(range(200)), threading.Event(), list[int]()

    def by_kernel(source: int, target: int) -> int:
        block = os.read(source, 60)
        asked.append(len(block))
        if len(asked) == 2:
            stop.set()
        return os.write(target, block)

    monkeypatch.setattr(background_copy, "_by_kernel", by_kernel)
    (tmp_path / "a").write_bytes(content)
    assert background_copy.copy_file(tmp_path / "a", tmp_path / "b")
    assert asked == [60, 60, 60, 20, 0]
    assert (tmp_path / "b").read_bytes() == content
    asked.clear()
    stop.clear()
    assert not background_copy.copy_file(tmp_path / "a", tmp_path / "b", stop)
    assert asked == [60, 60]
    assert (tmp_path / "b").read_bytes() == content[:120]


def test_copies_that_nobody_has_taken_are_all_removed(tmp_path: Path) -> None:
    copies = background_copy.BackgroundCopies()
    for name in "abc":
        (tmp_path / name).write_bytes(name.encode())
        copies.begin(tmp_path / name, tmp_path / "there" / name)
    (tmp_path / "there").mkdir(exist_ok=True)
    assert not copies.take(tmp_path / "a", tmp_path / "there" / "other")
    copies.drop()
    assert names(tmp_path / "there") == []


def test_large_files_are_those_of_buffers_and_images_beside_it_once_each(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = tmp_path / "there"
    there.mkdir()
    for name in ("a.bin", "b c.png", "small.bin", "known.bin", "x.gltf", "link.bin"):
        (tmp_path / name).write_bytes(bytes(4 if name == "small.bin" else 5))
    (tmp_path / "link.bin").unlink()
    (tmp_path / "link.bin").symlink_to(tmp_path / "a.bin")
    (there / "known.bin").touch()
    monkeypatch.setattr(background_copy, "FROM", 5)
    uris = [
        "a.bin",
        "a.bin",
        "small.bin",
        "known.bin",
        "link.bin",
        "missing.bin",
        "../a.bin",
        "x.gltf",
        7,
        None,
    ]
    gltf = {
        "buffers": [{"uri": uri} for uri in uris] + [None],
        "images": [{"uri": "b%20c.png"}],
        "nodes": [{"uri": "a"}],
    }
    source = tmp_path / "in.gltf"
    source.write_text(json.dumps(gltf))
    found = background_copy._large(source, there / "x.gltf")
    assert [file.name for file in found] == ["a.bin", "b c.png"]
    assert not list(background_copy._large(source, tmp_path / "x.gltf"))
    assert not list(background_copy._large(source.rename(tmp_path / "in.glb"), there / "x.gltf"))
    source.write_text(json.dumps(gltf))
    monkeypatch.setattr(background_copy, "LONGEST_JSON", source.stat().st_size)
    assert list(background_copy._large(source, there / "x.gltf"))
    monkeypatch.setattr(background_copy, "LONGEST_JSON", source.stat().st_size - 1)
    assert not list(background_copy._large(source, there / "x.gltf"))


def test_a_head_start_does_not_wait_for_numpy() -> None:
    imported = "sys, rigtri.files.background_copy, rigtri.cli.shared_options"
    script = f"import {imported}; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0


def test_times_are_sorted_and_stand_once() -> None:
    times = np.array([3.0, 1.0, np.nan, 1.0, 2.0, np.nan, 3.0])
    assert np.array_equal(sorted_unique(times), np.unique(times), equal_nan=True)
    assert len(sorted_unique(np.zeros(0))) == 0
