"""Temporary folders: of whom is dead nothing stays, of whom lives nothing goes."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from places import SAMPLES
from program import cli

from rigtri.files import temp_dirs

HOLD = (
    "import sys; from rigtri.files.temp_dirs import folder; "
    "print(folder().name, flush=True); sys.stdin.read()"
)
POSIX = pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")


def hold(place: Path) -> tuple[subprocess.Popen[str], Path]:
    """A process that has a temporary folder, and its own, until its input ends."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD],
        env=os.environ | {"TMPDIR": str(place)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    return process, Path(process.stdout.readline()).parent


@POSIX
def test_the_next_process_removes_what_a_killed_one_has_left_and_nothing_of_others(tmp_path: Path) -> None:
    (tmp_path / "rigtri-mine").mkdir()
    dead, its = hold(tmp_path)
    alive, own = hold(tmp_path)
    dead.send_signal(signal.SIGKILL)
    dead.communicate()
    assert its.is_dir()
    other, _ = hold(tmp_path)
    assert not its.exists()
    assert own.is_dir()
    other.communicate()
    alive.communicate()
    assert [path.name for path in tmp_path.iterdir()] == ["rigtri-mine"]


@POSIX
def test_an_edit_that_needs_no_temporary_folder_removes_those_of_killed_processes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before, what a process had left that was killed at the end stayed until another made such a folder."""
    place = tmp_path / "tmp"
    (place / "rigtri-tmp-left").mkdir(parents=True)
    (place / "rigtri-mine").mkdir()
    alive, own = hold(place)
    (place / "rigtri-tmp-left").mkdir(exist_ok=True)  # which that one has removed
    monkeypatch.setenv("TMPDIR", str(place))
    monkeypatch.setattr("tempfile.tempdir", None)
    out = tmp_path / "out.usda"
    shutil.copy(SAMPLES / "biped.usda", out)
    cli("orient-joints", out, "-o", out, "--preset", "maya", "--joints", "no such*", "--overwrite", code=4)
    found = sorted(path.name for path in place.iterdir())
    alive.communicate()
    assert found == sorted(["rigtri-mine", own.name])


def test_a_file_system_without_locks_is_used_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(temp_dirs, "fcntl", None)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / "rigtri-tmp-of-another").mkdir()
    monkeypatch.setattr(temp_dirs._ProcessFolders, "root", "")
    with temp_dirs.folder() as name:
        assert Path(name).parent.parent == tmp_path
    assert len(list(tmp_path.iterdir())) == 2
