"""New processes beside each other, in turns, by processor time and by the clock.

See benchmarks/README.md. On POSIX alone, which says what processors the children took.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from warm import Times, version

ROOT = Path(__file__).resolve().parent.parent
# As the installed script does.
PROGRAM = [sys.executable, "-c", "from rigtri.__main__ import program; program()"]
# What a process has imported at its end, and so much alone.
IMPORTED = "import atexit, sys; atexit.register(lambda: print(*sys.modules)); "
IMPORT = "import importlib, sys; [importlib.import_module(name) for name in sys.argv[1:]]"


def commands(folder: Path) -> dict[str, list[str]]:
    """What is started, by its name in the table; peers that are not installed are left out."""
    found = {"import numpy, click": [sys.executable, "-c", "import numpy, click"]}
    found["rigtri --help"] = [*PROGRAM, "--help"]
    edit = found["rigtri orient-joints biped.glb, verified"] = _orient("biped.glb", folder)
    found["its modules alone"] = modules_of(edit)
    place, node = os.environ.get("RIGTRI_GLTF_TRANSFORM"), shutil.which("node")
    sample, copy = str(ROOT / "samples" / "biped.glb"), str(folder / "copy.glb")
    if place and node:
        script = str(Path(__file__).with_name("rewrite.mjs"))
        name = f"glTF-Transform {version()}, a script: read, write biped.glb"
        found[name] = [node, script, place, sample, copy, "0"]
    transform = os.environ.get("GLTF_TRANSFORM") or shutil.which("gltf-transform")
    if transform:
        name = f"glTF-Transform {version_of(transform)}, its command line: copy biped.glb"
        found[name] = [transform, "copy", sample, copy]
    if importlib.util.find_spec("pxr"):
        found["from pxr import Usd, UsdSkel"] = [sys.executable, "-c", "from pxr import Usd, UsdSkel"]
        edit = found["rigtri orient-joints biped.usdz, verified"] = _orient("biped.usdz", folder)
        found["its modules alone, with pxr"] = modules_of(edit)
    return found


def _orient(name: str, folder: Path) -> list[str]:
    target = str(folder / f"cold-{name}")
    return [*PROGRAM, "orient-joints", str(ROOT / "samples" / name), "-o", target, "--overwrite", "-q"]


def modules_of(command: list[str]) -> list[str]:
    """A process that imports what one of `PROGRAM` does, and does nothing."""
    words = [sys.executable, "-c", IMPORTED + command[2], *command[3:]]
    known = subprocess.run(words, capture_output=True, text=True, check=True).stdout.split()
    names = [name for name in known if name.partition(".")[0] in ("rigtri", "pxr", "numpy", "click")]
    return [sys.executable, "-c", IMPORT, *names]


def version_of(program: str) -> str:
    """What a program says of its version."""
    done = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    return done.stdout.strip().splitlines()[-1]


def started(command: list[str], cwd: Path | None = None) -> Times:
    """Seconds, and seconds of processors, of a new process and its children."""
    start, before = time.perf_counter(), _used()
    subprocess.run(command, cwd=cwd, capture_output=True, check=True)
    return time.perf_counter() - start, _used() - before


def _used() -> float:
    children = resource.getrusage(resource.RUSAGE_CHILDREN)  # os.times counts hundredths of a second
    return children.ru_utime + children.ru_stime


def cold_starts(folder: Path, runs: int) -> list[str]:
    """A table of new processes, medians of their runs; the first of each, which finds no compiled modules or
    cached files, does not count."""
    every = commands(folder)
    times: dict[str, list[Times]] = {name: [] for name in every}
    for _ in range(runs + 1):
        for name, command in every.items():
            times[name].append(started(command))
    medians = {
        name: [statistics.median(column) for column in zip(*found[1:], strict=True)]
        for name, found in times.items()
    }
    base = medians["import numpy, click"]
    lines = ["## New processes", "", f"Medians of {runs} runs, in turns; ratios to the first row.", ""]
    lines += ["| process | s of processors | ratio | s by the clock | ratio |", "|---|---|---|---|---|"]
    for name, (wall, used) in medians.items():
        lines.append(f"| {name} | {used:.3f} | {used / base[1]:.2f} | {wall:.3f} | {wall / base[0]:.2f} |")
    return [*lines, ""]


def main() -> None:
    """Measure, and print the table."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--runs", type=int, default=7)
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory() as name:
        print("\n".join(cold_starts(Path(name), given.runs)))


if __name__ == "__main__":
    sys.exit(main())
