"""Tasks for tests of batches: one that turns joints, and some that go wrong for files of a certain name."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rigtri import orient_joints
from rigtri.errors import DeviationError, GeometryError
from rigtri.files.staged_output import StagedOutput
from rigtri.formats import ReadOptions
from rigtri.model.rig import Rig
from rigtri.pipeline.edit import EditRequest, Outcome, edit_file
from rigtri.report import Report

# The file beside those whose names begin with "wait", for which these wait.
WAITED_FOR = "go-on"


@dataclass(frozen=True)
class Turn:
    """Turn the joints of a file. Its name says what goes wrong.

    die, slay, hang, wait, eat, refuse, fault, warn, slow: `go_wrong`; late, spoil: ``run``.
    """

    label: str = ""
    reads: tuple[Path, ...] = ()
    verify: bool = True
    relink: bool = False
    joint: str | None = None
    layers: bool = False
    beside: str = ""
    sources: tuple[Path, ...] = ()
    standard_rest: bool = False

    def key(self) -> str:
        return f"turn {self.label} {self.verify} {self.relink} {self.joint}"

    def files(self) -> Sequence[Path]:
        return self.reads

    def run(self, request: EditRequest, report: Report) -> Outcome:
        source = Path(request.source)

        def step(rig: Rig, report: Report) -> Rig:
            go_wrong(source, report)
            if self.joint is not None:
                rig.find(self.joint)
            return orient_joints(rig, report=report)

        def at_last(outcome: Outcome, written: StagedOutput) -> None:
            if request.ready is not None:
                request.ready(outcome, written)
            if source.stem.startswith("spoil"):
                raise DeviationError("too late")
            if source.stem.startswith("late"):
                # As if it was killed between the rename and the answer.
                os.replace(written.part, request.target)
                os.kill(os.getpid(), signal.SIGKILL)

        options = ReadOptions(resources="relink" if self.relink else "copy")
        return edit_file(replace(request, options=options, verify=self.verify, ready=at_last), step, report)


def run_program(words: list[str]) -> None:
    """The program, whose batches do `Turn` whatever their spec is."""
    from rigtri.cli import batch
    from rigtri.cli.main import program

    batch._tasks = lambda values: (
        lambda variables: Turn(  # type: ignore[assignment]
            label=str(variables), verify=values["verify"], relink=values["resources"] == "relink"
        )
    )
    program(words)


def go_wrong(source: Path, report: Report) -> None:
    """What the name of a file asks for. What hangs leaves a file with the suffix .begun beside it."""
    name = source.stem
    if name.startswith("die"):
        os.kill(os.getpid(), signal.SIGSEGV)
    if name.startswith("slay"):
        parent = multiprocessing.parent_process()
        assert parent is not None
        os.kill(parent.pid or 0, signal.SIGKILL)
        threading.Event().wait()
    if name.startswith("hang"):
        source.with_suffix(".begun").touch()
        threading.Event().wait()
    if name.startswith("wait"):
        while not source.with_name(WAITED_FOR).exists():
            threading.Event().wait(0.05)
    if name.startswith("eat"):
        np.empty(1 << 32, np.uint8)  # is never touched: only a limit can refuse it
    if name.startswith("refuse"):
        raise GeometryError("no way up")
    if name.startswith("fault"):
        raise KeyError("a mistake of ours")
    if name.startswith("warn"):
        report.warn("test", "look out", joint="hips")
    if name.startswith("slow"):
        sum(range(3_000_000))  # the work of a large file: an interrupt is more likely to hit it


if __name__ == "__main__":
    if "START_METHOD" in os.environ:
        multiprocessing.get_all_start_methods = lambda: [os.environ["START_METHOD"]]
    # Also where tests run in the background, which lets what is started there ignore interrupts.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    run_program(sys.argv[1:])
