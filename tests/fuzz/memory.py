"""python -m fuzz.memory, in the folder tests: how many bytes stay with a process each time it does a task.

docs/fuzzing.md says what was measured. For glibc alone.
"""

from __future__ import annotations

import ctypes
import gc
import os
import sys
import tempfile
from collections.abc import Callable
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from itertools import count
from pathlib import Path

import click
from click.testing import CliRunner
from places import SAMPLES
from pxr import Sdf, Usd, Work

from rigtri.cli.main import program

# So often before it is measured, for what is loaded once and kept, and so often then.
BEFORE, TIMES = 50, 200
# Names of fields of mallinfo2(3) that do not matter here.
_OTHERS = ("arena", "ordblks", "smblks", "hblks")
ARM = str(SAMPLES / "arm.usda")


class _MallocInfo(ctypes.Structure):
    """What mallinfo2(3) returns: uordblks and hblkhd of it, by what they are."""

    _fields_ = [(name, ctypes.c_size_t) for name in (*_OTHERS, "mapped", "b", "c", "in_use", "d", "e")]


def growth(task: Callable[[], object]) -> float:
    """How many bytes more this process has in use after each run of a task."""
    for _ in range(BEFORE):
        task()
    before = _in_use()
    for _ in range(TIMES):
        task()
    return (_in_use() - before) / TIMES


def main() -> None:
    Work.SetConcurrencyLimit(1)  # threads have memory of their own
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        nowhere = stack.enter_context(open(os.devnull, "w", encoding="utf-8"))
        stack.enter_context(redirect_stdout(nowhere))
        stack.enter_context(redirect_stderr(nowhere))
        for name, task in _tasks(folder).items():
            print(f"{growth(task):8.0f}  {name}", file=sys.__stdout__, flush=True)


def _tasks(folder: Path) -> dict[str, Callable[[], object]]:
    numbers = count()

    def orient(name: str, *options: str) -> Callable[[], object]:
        command = ["orient-joints", str(SAMPLES / name), "-o", str(folder / name), "--overwrite", *options]
        return lambda: program.main(command, standalone_mode=False)

    def root_layer() -> None:
        stage = Usd.Stage.Open(ARM)
        stage.GetRootLayer()

    def new_names() -> None:
        number = next(numbers)
        text = f'#usda 1.0\ndef "prim{number}"\n{{\ncustom double attribute{number}\n}}\n'
        Sdf.Layer.CreateAnonymous(".usda").ImportFromString(text)

    printing = click.Command("one", callback=lambda: click.echo("a line"))
    return {
        "rigtri orient-joints arm.gltf": orient("arm.gltf", "--root", "shoulder"),
        "rigtri orient-joints biped.glb": orient("biped.glb"),
        "rigtri orient-joints arm.usda": orient("arm.usda", "--root", "/arm"),
        "rigtri orient-joints biped.usdz": orient("biped.usdz"),
        "pxr: Usd.Stage.Open": lambda: Usd.Stage.Open(ARM),
        "pxr: Usd.Stage.Open, GetRootLayer": root_layer,
        "pxr: Sdf.Layer.Export": lambda: Sdf.Layer.FindOrOpen(ARM).Export(str(folder / "copy.usda")),
        "pxr: a prim and an attribute of new names": new_names,
        "click: CliRunner().invoke of a command that prints a line": lambda: CliRunner().invoke(printing),
    }


def _in_use() -> int:
    gc.collect()
    ask = ctypes.CDLL(None).mallinfo2
    ask.restype = _MallocInfo
    found = ask()
    return int(found.in_use + found.mapped)


if __name__ == "__main__":
    if os.environ.get("PYTHONMALLOC") != "malloc":  # or Python's small objects are not seen
        os.execve(sys.executable, [*sys.orig_argv], {**os.environ, "PYTHONMALLOC": "malloc"})
    main()
