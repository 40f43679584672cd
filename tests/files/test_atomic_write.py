"""An output appears whole or not at all: whatever fails, and at whatever moment the run is killed."""

from __future__ import annotations

import errno
import multiprocessing
import os
import random
import shutil
import signal
import stat
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from places import ci, slow

from rigtri.errors import DeviationError, FileError, UsageError
from rigtri.files import atomic_write, staged_output
from rigtri.files.staged_output import Companion, StagedOutput, as_file_error, write_text
from rigtri.formats import ReadOptions, read
from rigtri.model.rig import Rig
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit
from rigtri.report import Report
from rigtri.verification.compare.compare import verify

ROOT = hasattr(os, "geteuid") and os.geteuid() == 0
POSIX = pytest.mark.skipif(os.name != "posix", reason="this system has no POSIX file permissions")


def orient(rig: Rig, report: Report) -> Rig:
    return orient_joints(rig, report=report)


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.fixture
def gltf(samples: Path, tmp_path: Path) -> Path:
    """A target .gltf and its .bin that an edit with --overwrite replaces: both are another character's."""
    folder = tmp_path / "target"
    folder.mkdir()
    (folder / "out.gltf").write_bytes((samples / "arm.gltf").read_bytes())
    (folder / "biped.bin").write_bytes(b"the old buffer")
    return folder / "out.gltf"


# --- one system call fails


def fail_at(monkeypatch: pytest.MonkeyPatch, count: int, error: int) -> list[str]:
    """Let the ``count``-th system call of a delivery fail; the list tells which that was."""
    calls: list[str] = []
    for name in ("replace", "fsync", "link", "mkdir", "unlink"):
        real = getattr(os, name)

        def call(*args: Any, _real: Any = real, _name: str = name, **more: Any) -> Any:
            calls.append(_name)
            if len(calls) == count:
                raise OSError(error, os.strerror(error))
            return _real(*args, **more)

        monkeypatch.setattr(os, name, call)
    return calls


@pytest.mark.parametrize("count", range(1, 9))
def test_a_failure_at_any_step_leaves_the_old_files_or_the_new(
    count: int, gltf: Path, samples: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    old = contents(gltf.parent)
    edit(samples / "biped.gltf", gltf, orient, overwrite=True)
    new = contents(gltf.parent)
    for name, content in old.items():
        (gltf.parent / name).write_bytes(content)
    for name in new.keys() - old.keys():
        (gltf.parent / name).unlink()
    done = False
    with monkeypatch.context() as patched:
        calls = fail_at(patched, count, errno.ENOSPC)
        with suppress(FileError):
            edit(samples / "biped.gltf", gltf, orient, overwrite=True)
            done = True
    found = contents(gltf.parent)
    assert found == old or (done and {name: found[name] for name in new} == new), calls


class Interrupt(BaseException):
    """What a user's Ctrl-C is."""


def test_an_interrupt_while_measuring_leaves_the_old_files(
    gltf: Path, samples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*args: Any, **more: Any) -> Any:
        raise Interrupt

    old = contents(gltf.parent)
    monkeypatch.setattr("rigtri.pipeline.edit.check_result", stop)
    with pytest.raises(Interrupt):
        edit(samples / "biped.gltf", gltf, orient, overwrite=True)
    assert contents(gltf.parent) == old


def test_what_cannot_be_tidied_up_afterwards_does_not_undo_the_output(
    gltf: Path, samples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(self: Path, **_: Any) -> None:
        if ".kept-" in self.name and not list(gltf.parent.glob(".out.part-*")):
            raise PermissionError(errno.EACCES, "Permission denied")
        if self.exists():
            os.unlink(self)

    monkeypatch.setattr(Path, "unlink", refuse)
    assert edit(samples / "biped.gltf", gltf, orient, overwrite=True).written
    assert (gltf.parent / "biped.bin").read_bytes() == (samples / "biped.bin").read_bytes()


# --- the process is killed

STEPS = ("replace", "fsync", "link", "unlink")


def deadly_edit(moment: int, source: str, target: str) -> None:
    """Edit in a process that kills itself at its ``moment``-th step."""
    calls = 0

    def wrapped(real: Any) -> Any:
        def call(*args: Any, **more: Any) -> Any:
            nonlocal calls
            calls += 1
            if calls == moment:
                os.kill(os.getpid(), signal.SIGKILL)
            return real(*args, **more)

        return call

    for name in STEPS:
        setattr(os, name, wrapped(getattr(os, name)))
    edit(source, target, orient, overwrite=True)


def started(moment: int, source: Path, target: Path) -> Any:
    """A process that runs `deadly_edit`; it starts at once, because its server has loaded all."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["rigtri.pipeline.edit", "rigtri.formats.gltf.document", "pxr.Usd"])
    process = context.Process(target=deadly_edit, args=(moment, str(source), str(target)))
    process.start()
    return process


def restored(folder: Path, old: dict[str, bytes]) -> None:
    for name in contents(folder).keys() - old.keys():
        (folder / name).unlink()
    for name, content in old.items():
        (folder / name).write_bytes(content)


@POSIX
@pytest.mark.slow
def test_a_kill_at_any_step_leaves_old_or_new_and_the_next_run_tidies_up(gltf: Path, samples: Path) -> None:
    old, between, exitcode, moment = contents(gltf.parent), 0, None, 0
    buffer = (samples / "biped.bin").read_bytes()
    while exitcode != 0:
        moment += 1
        restored(gltf.parent, old)
        process = started(moment, samples / "biped.gltf", gltf)
        process.join()
        exitcode = process.exitcode
        found = contents(gltf.parent)
        # Each file by itself is whole, and the new one is there only with its buffer.
        assert found["biped.bin"] in (old["biped.bin"], buffer)
        if found["out.gltf"] != old["out.gltf"]:
            assert found["biped.bin"] == buffer
            continue
        between += found["biped.bin"] == buffer
        # A buffer replaced too early comes back, even where the next run fails.
        with pytest.raises(DeviationError):
            edit(samples / "biped.gltf", gltf, orient, overwrite=True, tolerance=0.0)
        found = contents(gltf.parent)
        assert found == old, moment
    assert between > 0
    assert moment > 6


@pytest.mark.ci
@POSIX
@pytest.mark.parametrize("name", ["biped.glb", "biped.usda", slow("biped.usdz")])
def test_a_kill_at_a_random_time_leaves_the_old_file_or_the_new(
    name: str, samples: Path, tmp_path: Path
) -> None:
    target = tmp_path / f"out{Path(name).suffix}"
    edit(samples / name, target, orient)
    new, old = target.read_bytes(), (samples / name).read_bytes()
    seeded = random.Random(name)
    for _ in range(8):
        target.write_bytes(old)
        process = started(0, samples / name, target)
        process.join(timeout=seeded.uniform(0.0, 0.1))
        process.kill()
        process.join()
        assert target.read_bytes() in (old, new)
    edit(samples / name, target, orient, overwrite=True)
    assert contents(tmp_path) == {target.name: new}


# --- kinds of targets


def test_a_replaced_file_keeps_its_permissions(samples: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.glb"
    target.write_bytes(b"old")
    target.chmod(0o640)
    edit(samples / "biped.glb", target, orient, overwrite=True)
    assert stat.S_IMODE(target.stat().st_mode) == 0o640


@pytest.mark.parametrize("mode", [0o444, 0o600])
def test_permissions_of_the_old_file_are_no_hindrance(mode: int, samples: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.glb"
    target.write_bytes(b"old")
    target.chmod(mode)
    edit(samples / "biped.glb", target, orient, overwrite=True)
    edit(samples / "biped.glb", target, orient, overwrite=True)
    assert stat.S_IMODE(target.stat().st_mode) == mode


@pytest.mark.skipif(not ROOT, reason="only root may give files away")
def test_a_replaced_file_keeps_its_owner(samples: Path, tmp_path: Path) -> None:
    target = tmp_path / "out.glb"
    target.write_bytes(b"old")
    os.chown(target, 1234, 2345)
    edit(samples / "biped.glb", target, orient, overwrite=True)
    assert (target.stat().st_uid, target.stat().st_gid) == (1234, 2345)


def test_other_names_of_the_old_file_keep_the_old_content(samples: Path, tmp_path: Path) -> None:
    target, twin = tmp_path / "out.glb", tmp_path / "twin.glb"
    shutil.copyfile(samples / "biped.glb", target)
    os.link(target, twin)
    edit(twin, target, orient, overwrite=True)
    assert twin.read_bytes() == (samples / "biped.glb").read_bytes()
    assert target.read_bytes() != twin.read_bytes()


@POSIX
@pytest.mark.parametrize("there", [True, False])
def test_a_link_stays_a_link_and_what_it_leads_to_is_written(
    there: bool, samples: Path, tmp_path: Path
) -> None:
    (tmp_path / "far").mkdir()
    real, link = tmp_path / "far" / "real.glb", tmp_path / "link.glb"
    if there:
        real.write_bytes(b"old")
    link.symlink_to(Path("far", "real.glb"))
    edit(samples / "biped.glb", link, orient, overwrite=True)
    assert link.is_symlink()
    assert real.read_bytes()[:4] == b"glTF"
    assert set(contents(tmp_path)) == {"link.glb", "far/real.glb"}


@POSIX
def test_links_in_a_circle_and_links_into_nothing_are_errors(samples: Path, tmp_path: Path) -> None:
    one, other = tmp_path / "one.glb", tmp_path / "other.glb"
    one.symlink_to(other)
    other.symlink_to(one)
    with pytest.raises(FileError, match=r"one.glb cannot be written"):
        edit(samples / "biped.glb", one, orient)
    with pytest.raises(FileError, match="no file"):
        edit(one, tmp_path / "out.glb", orient)
    (tmp_path / "lost.glb").symlink_to(tmp_path / "no" / "folder.glb")
    with pytest.raises(FileError, match="no folder"):
        edit(samples / "biped.glb", tmp_path / "lost.glb", orient)


@POSIX
def test_pipes_and_devices_are_neither_read_nor_replaced(samples: Path, tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.glb"
    os.mkfifo(pipe)
    with pytest.raises(FileError, match="pipe"):
        edit(pipe, tmp_path / "out.glb", orient)
    with pytest.raises(UsageError, match="pipe"):
        edit(samples / "biped.glb", pipe, orient, overwrite=True)
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_a_name_that_is_too_long_is_reported(samples: Path, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="cannot be written"):
        edit(samples / "biped.glb", tmp_path / f"{'x' * 250}.glb", orient)
    assert contents(tmp_path) == {}


# --- disks


def _succeeds(command: list[str]) -> bool:
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


@pytest.fixture
def tiny(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 kB."""
    folder = tmp_path / "tiny"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(folder)]
    if not ROOT or shutil.which("mount") is None or not _succeeds(mount):
        pytest.skip("no file system can be mounted here")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


@pytest.mark.parametrize("error", [OSError(5, "broken", "part"), OSError("broken")])
def test_an_error_of_the_system_is_reported_with_its_reason_alone(error: OSError) -> None:
    with pytest.raises(FileError) as found, as_file_error(Path("out.glb")):
        raise error
    assert str(found.value) == "out.glb cannot be written: broken"


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda", "biped.usdz", "biped.gltf"])
def test_a_full_disk_is_reported_and_loses_nothing(name: str, samples: Path, tiny: Path) -> None:
    target = tiny / f"out{Path(name).suffix}"
    target.write_bytes(b"precious")
    (tiny / "filler").write_bytes(bytes(40_000))
    with pytest.raises(FileError, match="No space left"):
        edit(samples / name, target, orient, overwrite=True)
    assert {p.name for p in tiny.iterdir()} == {target.name, "filler"}
    assert target.read_bytes() == b"precious"


def test_a_disk_that_may_not_be_written_is_reported(samples: Path, tiny: Path) -> None:
    target = tiny / "out.glb"
    target.write_bytes(b"precious")
    subprocess.run(["mount", "-o", "remount,ro", str(tiny)], check=True)
    with pytest.raises(FileError, match="Read-only file system"):
        edit(samples / "flat_ik.glb", target, orient, overwrite=True)
    assert target.read_bytes() == b"precious"


def test_source_and_target_may_lie_on_different_disks(samples: Path, tiny: Path) -> None:
    edit(samples / "flat_ik.glb", tiny / "out.glb", orient)
    assert [p.name for p in tiny.iterdir()] == ["out.glb"]


def test_reports_appear_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    report = tmp_path / "report.json"
    write_text(report, "old")

    def full(*_: Any) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        with pytest.raises(FileError, match="No space left"):
            write_text(report, "new")
    assert contents(tmp_path) == {"report.json": b"old"}
    write_text(report, '"\ud800"')
    assert report.read_bytes() == rb'"\ud800"'


@pytest.mark.parametrize("verify", [True, False])
def test_the_new_name_is_forced_to_the_disk_after_the_content(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, verify: bool
) -> None:
    steps: list[str] = []
    sync, rename = os.fsync, os.replace

    def synced(handle: int) -> None:
        steps.append("folder" if stat.S_ISDIR(os.fstat(handle).st_mode) else "file")
        sync(handle)

    def renamed(one: Any, other: Any) -> None:
        steps.append("rename")
        rename(one, other)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(os, "replace", renamed)
    edit(samples / "biped.glb", tmp_path / "out.glb", orient, verify=verify)
    assert steps == ["file", "rename", "folder"]


def test_a_sync_that_fails_while_the_result_is_looked_at_comes_again_and_is_reported(
    samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    sync, asked = os.fsync, []

    def fails_first(handle: int) -> None:
        asked.append(handle)
        if len(asked) in failing:
            raise OSError(errno.EIO, "Input/output error")
        sync(handle)

    monkeypatch.setattr(os, "fsync", fails_first)
    failing = {1, 2}
    with pytest.raises(FileError, match="Input/output error"):
        edit(samples / "biped.glb", tmp_path / "out.glb", orient)
    assert (len(asked), contents(tmp_path)) == (2, {})
    failing = {3}
    edit(samples / "biped.glb", tmp_path / "out.glb", orient)
    assert len(asked) == 5  # again, and then the name
    assert list(contents(tmp_path)) == ["out.glb"]


def test_a_dead_process_with_our_own_number_left_what_bears_it(tmp_path: Path) -> None:
    part = atomic_write.temp_path(tmp_path / "out.glb")
    part.write_bytes(b"half")
    assert atomic_write.stale_parts(tmp_path / "out.glb") == [(part, os.getpid())]


@pytest.mark.parametrize("elsewhere", [False, True])
@pytest.mark.parametrize("renamed", [False, True])
def test_what_follows_an_output_is_of_the_same_run_whatever_becomes_of_the_next(
    renamed: bool, elsewhere: bool, samples: Path, tmp_path: Path
) -> None:
    """A run that was killed before, or after, its output had its name; the next one is refused."""
    out = tmp_path / "out.glb"
    side = tmp_path / "specs" / "mine.yaml" if elsewhere else tmp_path / "out.rig.yaml"
    side.parent.mkdir(exist_ok=True)
    kept, part = (side.with_name(f".{side.name}.{word}-{os.getpid()}") for word in ("kept", "part"))
    kept.write_bytes(b"old")
    part.write_bytes(b"new")
    out.write_bytes(b"new" if renamed else b"old")
    (tmp_path / f".out.glb.kept-{os.getpid()}").write_bytes(b"old")
    if not renamed:
        atomic_write.temp_path(out).write_bytes(b"new")
    with pytest.raises(UsageError, match="exists; it is replaced only"):
        edit(samples / "flat_ik.glb", out, orient, side_files=(side,))
    now = b"new" if renamed else b"old"
    assert contents(tmp_path) == {"out.glb": now, str(side.relative_to(tmp_path)): now}


def test_what_follows_an_output_comes_back_where_that_gets_no_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(part: Path, final: Path, **_: bool) -> None:
        raise OSError(errno.EACCES, "no", str(final))

    side = tmp_path / "out.rig.yaml"
    side.write_bytes(b"old")
    staged = StagedOutput(tmp_path / "out.glb", overwrite=True)
    staged.part.write_bytes(b"new")
    staged.follow(side, b"new")
    monkeypatch.setattr(staged_output, "commit", fail)
    with pytest.raises(FileError):
        staged.finish()
    staged.undo()
    assert contents(tmp_path) == {"out.rig.yaml": b"old"}


def test_an_override_beside_its_source_is_delivered_the_same_way(samples: Path, tmp_path: Path) -> None:
    options = ReadOptions(edit_target="bare")
    edit(samples / "biped.usda", tmp_path / "over.usda", orient, options=options)
    assert list(contents(tmp_path)) == ["over.usda"]


@POSIX
def test_a_reader_that_goes_away_ends_the_program_quietly(samples: Path) -> None:
    code = "from rigtri.cli.main import program; program()"
    command = [sys.executable, "-c", code, "orient-joints", str(samples / "biped.glb"), "-o", "-", "-q"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.wait() == 3
        assert b"Traceback" not in process.stderr.read()


def run(*words: str | Path, **streams: Any) -> subprocess.CompletedProcess[bytes]:
    """The program in a process of its own."""
    code = "from rigtri.cli.main import program; program()"
    return subprocess.run([sys.executable, "-c", code, *map(str, words)], check=False, **streams)


SIDE_FILES = ["--report", slow("--save-frames"), slow("--sidecar")]


def oriented(flag: str, side: Path, source: Path) -> list[str | Path]:
    """A command that writes ``side`` besides its output."""
    named = [flag] if flag == "--sidecar" else [flag, side]
    return ["orient-joints", source, "-o", side.with_name("out.glb"), "--overwrite", *named]


@POSIX
@pytest.mark.parametrize("flag", SIDE_FILES)
@pytest.mark.parametrize("there", [True, False])
def test_a_side_file_that_is_a_link_stays_one(flag: str, there: bool, samples: Path, tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    real, link = tmp_path / "far" / "real.json", tmp_path / "out.rig.json"
    if there:
        real.write_text("old")
    link.symlink_to(Path("far", "real.json"))
    assert run(*oriented(flag, link, samples / "biped.glb"), capture_output=True).returncode == 0
    assert link.is_symlink()
    assert real.read_bytes()[:1] == b"{"
    assert set(contents(tmp_path)) == {"out.glb", "out.rig.json", "far/real.json"}


@POSIX
@pytest.mark.parametrize("flag", SIDE_FILES)
def test_a_side_file_that_is_a_pipe_is_refused_before_anything_is_done(
    flag: str, samples: Path, tmp_path: Path
) -> None:
    pipe = tmp_path / "out.rig.json"
    os.mkfifo(pipe)
    done = run(*oriented(flag, pipe, samples / "biped.glb"), capture_output=True)
    assert done.returncode == 2
    assert b"is a device or a pipe; give the name of a plain file" in done.stderr
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert [path.name for path in tmp_path.iterdir()] == [pipe.name]


@POSIX
def test_text_is_never_written_over_a_pipe_or_a_link(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("pipe")
    for name in ("pipe", "link"):
        with pytest.raises(UsageError, match="pipe"):
            write_text(tmp_path / name, "{}")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)
    assert (tmp_path / "link").is_symlink()


# --- standard output that takes nothing


@pytest.fixture
def full(tmp_path: Path) -> Iterator[int]:
    """A device that is full, made for the test; where only root may make one, the system's own."""
    place = tmp_path / "full"
    try:
        os.mknod(place, stat.S_IFCHR | 0o600, os.makedev(1, 7))
        device = os.open(place, os.O_WRONLY)
    except OSError:
        device = os.open("/dev/full", os.O_WRONLY)
    place.unlink(missing_ok=True)
    yield device
    os.close(device)


def talking(name: str, samples: Path, out: Path) -> list[str | Path]:
    """A command that prints something, by its first word or words."""
    biped = samples / "biped.glb"
    return {
        "inspect": ["inspect", biped],
        "check": ["check", biped],
        "verify": ["verify", biped, biped],
        "diff": ["diff", biped, samples / "tpose.glb"],
        "orient-joints": ["orient-joints", biped, "-o", out, "--save-frames", out.with_suffix(".frames")],
        "-o -": ["orient-joints", biped, "-o", "-"],
        "--help": ["--help"],
        "inspect --help": ["inspect", "--help"],
    }[name]


CASES = [
    *(
        (name, machine) if (name, machine) == ("diff", False) else slow(name, machine)
        for name in ("inspect", "check", "verify", "diff", "orient-joints")
        for machine in (True, False)
        if machine or name != "orient-joints"
    ),
    ("-o -", False),
    ("--help", False),
    ("inspect --help", False),
]


@POSIX
@pytest.mark.parametrize(("name", "machine"), CASES)
def test_a_full_standard_output_is_reported_in_one_line(
    name: str, machine: bool, samples: Path, full: int, tmp_path: Path
) -> None:
    words = [*talking(name, samples, tmp_path / "out.glb"), *(["--json"] if machine else [])]
    done = run(*words, stdout=full, stderr=subprocess.PIPE)
    assert done.stderr.decode().splitlines()[-1] == "rigtri: output: No space left on device"
    assert b"Traceback" not in done.stderr
    assert b"Exception" not in done.stderr
    assert done.returncode == (2 if name == "diff" else 3)
    # What was written was so before the words were: it is whole.
    names = {"out.glb", "out.frames"} if name == "orient-joints" else set()
    assert set(contents(tmp_path)) == names
    if names:
        assert not read(tmp_path / "out.glb").warnings


@POSIX
@pytest.mark.parametrize(("name", "machine"), [*CASES[:-2], slow("--help", False)])
def test_a_closed_standard_output_is_no_success(
    name: str, machine: bool, samples: Path, tmp_path: Path
) -> None:
    words = [*talking(name, samples, tmp_path / "out.glb"), *(["--json"] if machine else [])]
    done = run(*words, stderr=subprocess.PIPE, preexec_fn=lambda: os.close(1))
    assert done.stderr.decode().splitlines()[-1] == "rigtri: output: Bad file descriptor"
    assert done.returncode == (2 if name == "diff" else 3)


@POSIX
@pytest.mark.parametrize(
    ("words", "code", "lost"),
    [
        ("orient-joints nofile.glb -o out.glb", 3, 3),
        ("verify biped.glb tpose.glb", 6, 6),
        ci("explain biped.glb --limb nojoint", 4, 4),
        ci("no-command", 2, 2),
        ci("diff biped.glb tpose.glb", 1, 1),
        ci("diff biped.glb biped.glb", 0, 0),
        ci("orient-joints biped.glb -o out.glb", 0, 0),
        ci("orient-joints biped.glb -o -", 0, 3),
        ci("inspect biped.glb", 0, 3),
        ci("--help", 0, 3),
    ],
)
def test_a_command_ends_with_its_own_code_whoever_reads_what_it_prints(
    words: str, code: int, lost: int, samples: Path, tmp_path: Path
) -> None:
    """code: where only messages are lost; lost: where what standard output was to get is lost, too."""
    line = [str(samples / word) if (samples / word).exists() else word for word in words.split()]
    reader, closed = os.pipe()
    os.close(reader)
    for printed, expected in ((subprocess.DEVNULL, code), (closed, lost)):
        done = run(*line, cwd=tmp_path, stdout=printed, stderr=closed)
        (tmp_path / "out.glb").unlink(missing_ok=True)
        assert done.returncode == expected
    os.close(closed)


@pytest.mark.slow
@POSIX
def test_who_prints_nothing_needs_no_standard_output(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    done = run(
        "orient-joints", samples / "biped.glb", "-o", out, "-q", preexec_fn=lambda: os.closerange(0, 3)
    )
    assert done.returncode == 0
    assert verify(read(samples / "biped.glb"), read(out)).passes()


@pytest.mark.parametrize(
    ("there", "companion"), [(b"same", True), (b"other", False), (None, True)], ids=["same", "other", "none"]
)
def test_a_companion_that_is_there_is_left_and_another_file_is_not_replaced(
    there: bytes | None, companion: bool, tmp_path: Path
) -> None:
    place, source = tmp_path / "a.bin", tmp_path / "source.bin"
    source.write_bytes(b"same")
    for content in (b"same", source):
        staged = StagedOutput(tmp_path / "out.glb", overwrite=False)
        if there is not None:
            place.write_bytes(there)
        if companion:
            staged.add(Companion("a.bin", content))
            assert place.read_bytes() == b"same"
            assert bool(staged.placed) == (there is None)
            place.unlink()
        else:
            with pytest.raises(UsageError, match="exists and is another file"):
                staged.add(Companion("a.bin", content))


@pytest.mark.parametrize(
    ("replaced", "orphan", "follower", "kept"),
    [
        (False, False, False, []),
        (True, False, False, ["a.bin", "out.gltf"]),
        (False, True, False, ["out.gltf"]),
        (False, False, True, ["out.gltf", "out.log"]),
        (True, True, True, ["a.bin", "out.gltf", "out.log"]),
    ],
)
def test_what_is_to_be_done_after_the_rename_is_known_to_the_next_run(
    replaced: bool,
    orphan: bool,
    follower: bool,
    kept: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A run that is killed at the rename leaves the old output under another name, and nobody else does."""
    final, buffer = tmp_path / "out.gltf", "out.rigtri-0123abcd.bin"
    final.write_text(f'{{"uri": "{buffer}"}}' if orphan else "{}")
    for name in ("a.bin", "out.log", buffer):
        (tmp_path / name).write_bytes(b"old")
    seen: list[str] = []

    def commit(part: Path, place: Path, **how: bool) -> None:
        atomic_write.commit(part, place, **how)
        if place == final:
            seen.extend(sorted(path.name for path in tmp_path.glob(".*.kept-*")))

    monkeypatch.setattr(staged_output, "commit", commit)
    output = StagedOutput(final, overwrite=True)
    output.part.write_text('{"new": 1}')
    if replaced:
        output.add(Companion("a.bin", b"new"))
    if follower:
        output.follow(tmp_path / "out.log", b"new")
    output.finish()
    assert seen == [f".{name}.kept-{os.getpid()}" for name in kept]
    assert (tmp_path / buffer).exists() != orphan
    left = [path.name for path in tmp_path.iterdir() if path.name != buffer]
    assert sorted(left) == ["a.bin", "out.gltf", "out.log"]


def test_what_a_companion_is_a_copy_of_is_known_after_others_have_replaced_it(tmp_path: Path) -> None:
    """By this a batch sees that two outputs need different files. Before, both had the same hash."""
    source, place = tmp_path / "in.bin", tmp_path / "out" / "in.bin"
    source.write_bytes(b"one")
    place.parent.mkdir()
    staged = StagedOutput(tmp_path / "out" / "a.gltf", overwrite=True, shared=True)
    staged.add(Companion("in.bin", source))
    place.write_bytes(b"two")
    assert staged.beside == [place]
    assert staged.copied[place].read_bytes() == b"one"


def test_a_copy_that_another_process_places_meanwhile_is_the_one_that_is_needed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two workers place one buffer. Before, one could say that it "exists and is another file"."""
    source, place = tmp_path / "in.bin", tmp_path / "out" / "in.bin"
    source.write_bytes(b"one")
    place.parent.mkdir()
    exists = Path.exists

    def late(path: Path) -> bool:
        known = exists(path)
        if path == place and not known:
            shutil.copy(source, place)  # right after the first question
        return known

    monkeypatch.setattr(Path, "exists", late)
    staged = StagedOutput(tmp_path / "out" / "a.gltf", overwrite=False, shared=True)
    staged.add(Companion("in.bin", source))
    assert place.read_bytes() == b"one"
