"""Systems that lack what POSIX has: each call has its other way, and edits, builds and batches work by it."""

from __future__ import annotations

import errno
import gc
import multiprocessing
import ntpath
import os
import shutil
import signal
import tempfile
import weakref
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from places import SAMPLES
from program import cli

import rigtri
from rigtri.errors import UsageError
from rigtri.files import mapped_file, temp_dirs, worker_process
from rigtri.files import relative_path as relative
from rigtri.files.atomic_write import stale_files
from rigtri.files.staged_output import _link
from rigtri.files.worker_process import WorkerProcess
from rigtri.formats.gltf import uris
from rigtri.pipeline.batch import inputs, urls
from rigtri.pipeline.batch.local_engine import processors

# What Windows lacks; macOS has all but the first two, and sched_getaffinity.
LACKING = ("copy_file_range", "fdatasync", "sched_getaffinity", "chown", "posix_fadvise")


@pytest.fixture
def bare(monkeypatch: pytest.MonkeyPatch) -> set[Path]:
    """A system with none of them, where folders cannot be opened and mapped files not be replaced.

    The files that are mapped at a moment.
    """
    temp_dirs.root()  # locked while it can be: the processes that are started have all that POSIX has
    for name in LACKING:
        monkeypatch.delattr(os, name, raising=False)
    # multiprocessing itself has it here.
    signals = {name: value for name, value in vars(signal).items() if name != "pthread_sigmask"}
    monkeypatch.setattr(worker_process, "signal", SimpleNamespace(**signals))
    monkeypatch.setattr(multiprocessing, "get_all_start_methods", lambda: ["spawn"])
    monkeypatch.setattr(mapped_file, "MAPS", False)
    monkeypatch.setattr(mapped_file, "MAP_FROM", 1)
    opened, replaced = os.open, os.replace
    maps: set[Path] = set()

    def no_folders(path: Any, flags: int, *more: Any, **named: Any) -> int:
        if os.path.isdir(path):
            raise PermissionError(errno.EACCES, "is a folder", str(path))
        return opened(path, flags, *more, **named)

    def not_mapped(source: Any, target: Any) -> None:
        if {Path(source), Path(target)} & maps:
            raise PermissionError(errno.EACCES, "is mapped", str(target))
        replaced(source, target)

    def no_links(*_: Any, **__: Any) -> None:
        raise OSError(errno.EPERM, "no links here")

    monkeypatch.setattr(shutil, "_use_fd_functions", False)  # it opens folders where it can
    monkeypatch.setattr(os, "open", no_folders)
    monkeypatch.setattr(os, "replace", not_mapped)
    monkeypatch.setattr(os, "link", no_links)
    loaded = mapped_file.Mapped.__new__

    def noted(cls: Any, file: int) -> Any:
        mapped, path = loaded(cls, file), Path(os.readlink(f"/proc/self/fd/{file}"))
        maps.add(path)
        weakref.finalize(mapped, maps.discard, path)
        return mapped

    monkeypatch.setattr(mapped_file.Mapped, "__new__", staticmethod(noted))
    return maps


@pytest.mark.parametrize("name", ["biped.glb", "biped.gltf", "biped.usda", "biped.usdz"])
def test_a_file_is_edited_in_place_on_a_bare_system(name: str, bare: set[Path], tmp_path: Path) -> None:
    for source in (SAMPLES / name, SAMPLES / "biped.bin"):
        (tmp_path / source.name).write_bytes(source.read_bytes())
    hero = tmp_path / name
    cli("orient-joints", hero, "-o", hero, "--overwrite", "--report", tmp_path / "report.json", code=0)
    cli("verify", SAMPLES / name, hero, code=0)
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


@pytest.mark.ci
@pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="this system does not show open files")
def test_a_system_that_lets_no_mapped_file_be_replaced_would_refuse_one(
    bare: set[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That the fixture is as strict as Windows: with maps, the same edit is refused, and nothing is lost."""
    hero = tmp_path / "hero.glb"
    hero.write_bytes((SAMPLES / "biped.glb").read_bytes())
    monkeypatch.setattr(mapped_file, "MAPS", True)
    assert "is mapped" in cli("orient-joints", hero, "-o", hero, "--overwrite", code=3).stderr
    assert hero.read_bytes() == (SAMPLES / "biped.glb").read_bytes()
    gc.collect()


def test_builds_and_batches_work_on_a_bare_system(bare: set[Path], tmp_path: Path) -> None:
    spec = tmp_path / "rig.yaml"
    spec.write_text("steps: [{do: orient-joints}, {do: add-controls, whole-character: true}]")
    (tmp_path / "in").mkdir()
    for name in ("a", "b"):
        (tmp_path / "in" / f"{name}.glb").write_bytes((SAMPLES / "biped.glb").read_bytes())
    cli("build", SAMPLES / "biped.glb", "--spec", spec, "-o", tmp_path / "built.glb", code=0)
    cli("batch", "--spec", spec, tmp_path / "in" / "*.glb", "-O", tmp_path / "out", "-j", "2", code=0)
    built = (tmp_path / "built.glb").read_bytes()
    assert [(tmp_path / "out" / f"{name}.glb").read_bytes() for name in ("a", "b")] == [built, built]


def test_a_worker_is_spawned_where_there_is_no_fork_server(bare: set[Path]) -> None:
    with WorkerProcess() as worker:
        assert worker("a name", ntpath.basename, "C:\\rigs\\hero.glb") == "hero.glb"


def test_folders_that_cannot_be_locked_stay_while_they_are_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(temp_dirs, "fcntl", None)
    monkeypatch.setattr(temp_dirs._ProcessFolders, "root", "")
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with temp_dirs.folder() as folder:
        temp_dirs.remove_stale()
        assert Path(folder).is_dir()
        assert Path(folder).is_relative_to(tmp_path)
    assert not Path(folder).exists()


def test_a_backup_is_a_copy_where_there_are_no_links(bare: set[Path], tmp_path: Path) -> None:
    (tmp_path / "a").write_text("a")
    _link(tmp_path / "a", tmp_path / "b")
    assert (tmp_path / "b").read_text() == "a"


def test_processors_are_counted_all_the_same(bare: set[Path]) -> None:
    assert processors() == (os.cpu_count() or 1)


def test_nobody_asks_windows_whether_a_process_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """There os.kill would end it."""
    (tmp_path / ".hero.part-1.glb").touch()
    monkeypatch.setattr(os, "kill", lambda *_: pytest.fail("it was asked"))
    monkeypatch.setattr("rigtri.files.atomic_write.os.name", "nt")
    try:
        assert stale_files(tmp_path, ".hero.part-", ".glb") == []
    finally:
        monkeypatch.undo()


# --- paths of Windows, by its own rules


@pytest.fixture
def windows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(relative.os, "path", ntpath)
    monkeypatch.setattr(relative.os, "sep", "\\")


@pytest.mark.parametrize(
    ("path", "folder", "found"),
    [
        (r"C:\rigs\textures\skin.png", r"C:\rigs\out", "../textures/skin.png"),
        (r"C:\rigs\skin.png", r"c:\RIGS", "skin.png"),
        (r"D:\skin.png", r"C:\rigs", "D:/skin.png"),
        (r"\\server\share\skin.png", r"C:\rigs", "//server/share/skin.png"),
        (r"\\server\share\rigs\skin.png", r"\\server\share\out", "../rigs/skin.png"),
        ("C:\\" + "long\\" * 60 + "skin.png", "C:\\" + "long\\" * 59, "long/skin.png"),
    ],
)
def test_ways_between_folders_of_windows_have_forward_slashes(
    path: str, folder: str, found: str, windows: None
) -> None:
    assert relative.relative_path(path, folder) == found


def test_an_input_on_another_drive_is_refused_before_its_output_would_take_its_place(windows: None) -> None:
    with pytest.raises(UsageError, match="another drive than --base"):
        inputs._relative(r"D:\rigs\hero.glb", r"C:\rigs")


OUTSIDE = ["C:/skin.png", r"C:\skin.png", r"\\server\share\skin.png", r"..\skin.png"]
if os.name == "nt":
    OUTSIDE.append("C:skin.png")  # the folder that is open on a drive; elsewhere a name as any other


@pytest.mark.parametrize("name", OUTSIDE)
def test_uris_with_drives_shares_and_backslashes_lie_outside(name: str, tmp_path: Path) -> None:
    assert uris.is_file(name)
    assert uris.lies_outside(name, tmp_path, "images.0")
    assert not urls.is_url(name)


def test_a_library_can_be_imported_and_used_without_what_windows_lacks(
    bare: set[Path], tmp_path: Path
) -> None:
    rig = rigtri.orient_joints(rigtri.read(SAMPLES / "biped.glb"))
    assert rigtri.write(rig, tmp_path / "out.glb").verification.passes()


@pytest.mark.parametrize("locked", ["out.gltf", "biped.bin", "out.rig.yaml", "p.svg"])
def test_a_file_that_the_system_has_locked_costs_no_other(
    locked: str, samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As macOS locks files, sticky folders those of others, and a mount of a single file itself."""
    words = "auto", samples / "biped.gltf", "-o", tmp_path / "out.gltf", "--picture", tmp_path / "p.svg"
    cli(*words)
    for name in ("p.svg", "biped.bin"):
        (tmp_path / name).write_bytes((tmp_path / name).read_bytes() + b" ")
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def refusing(name: str) -> Callable[..., object]:
        real = getattr(os, name)

        def call(*given: Any, **options: Any) -> object:
            if tmp_path / locked in (Path(path) for path in given if isinstance(path, str | Path)):
                raise PermissionError(errno.EPERM, os.strerror(errno.EPERM), str(given[0]))
            return real(*given, **options)

        return call

    for name in ("link", "unlink", "rename", "replace"):
        monkeypatch.setattr(os, name, refusing(name))
    result = cli(*words, "--preset", "blender", "--overwrite", code=3)
    assert "cannot be written: Operation not permitted" in result.stderr.splitlines()[-1]
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
