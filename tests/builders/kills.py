"""Commands that kill themselves at one of the moments in which they change a folder."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import tempfile
from pathlib import Path
from typing import Any

# What Python reports of itself before it asks the system: https://docs.python.org/3/library/audit_events.html
CHANGES = ("os.rename", "os.link", "os.symlink", "os.mkdir", "os.remove", "os.rmdir", "os.truncate")
WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT
# What commands import, so that each process has it from the start: most of what one takes otherwise.
PRELOADED = [
    "pxr.Usd",
    "rigtri.cli.main",
    "rigtri.export.viewer",
    "rigtri.formats.gltf.document",
    "rigtri.formats.usd.document",
    "rigtri.operations.add_twist.twist",
    "rigtri.operations.orient_joints.orient",
    "rigtri.pipeline.batch.run",
    "rigtri.pipeline.batch.file_task",
    "rigtri.pipeline.rigspec.auto",
    "rigtri.pipeline.rigspec.build",
    "rigtri.pipeline.rigspec.models.spec",
    "rigtri.verification.compare.compare",
    "kills",
]


def _kill_at(moment: int, top: str, number: signal.Signals) -> None:
    """Send this process a signal at the n-th change below a folder."""
    counted = 0

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        nonlocal counted
        if event in CHANGES or (event == "open" and arguments[2] & WRITES):
            paths = arguments[:1] if event == "open" else arguments[:2]  # its second is a mode
            names = [str(one) for one in paths if isinstance(one, str | Path)]
            if any(os.path.abspath(name).startswith(top) for name in names):
                counted += 1
                if counted == moment:
                    os.kill(os.getpid(), number)

    sys.addaudithook(hook)


def _run(moment: int, top: str, words: list[str], number: signal.Signals) -> None:
    from rigtri.cli import begin
    from rigtri.cli.main import program

    # Given, for else the standard library tries whether it can write there, and a kill leaves what it wrote.
    os.environ["TMPDIR"] = tempfile.tempdir = str(Path(top, "tmp"))
    os.chdir(top)
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 2)
    os.dup2(null, 1)
    # As a terminal starts it: what runs in the background of a shell ignores interrupts, and the server of
    # forks blocks them where one of our own worker processes was the first to need it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    begin()
    if moment:
        _kill_at(moment, top, number)
    sys.argv = ["rigtri", *words]
    program()  # as a process of its own, which heeds signals to its end


def run(top: Path, words: list[str], moment: int = 0, number: signal.Signals = signal.SIGKILL) -> int:
    """The exit code of a command in a folder, sent a signal at a moment, from 1 on; 0: left alone."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(PRELOADED)
    process = context.Process(target=_run, args=(moment, str(top), words, number))
    process.start()
    process.join()
    assert process.exitcode is not None
    return process.exitcode


def working(top: Path) -> list[int]:
    """The processes that work in a folder."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if (process / "cwd").resolve(strict=True) == top.resolve():
                found.append(int(process.name))
        except OSError:
            continue  # it has ended, or is another user's
    return found


def contents(top: Path) -> dict[str, bytes]:
    """All files below a folder, and its folders as such; of a manifest, which has times, only the name."""
    found = {}
    for path in top.rglob("*"):
        name = str(path.relative_to(top))
        found[name] = b"" if path.is_dir() or path.suffix == ".sqlite" else path.read_bytes()
    return found
