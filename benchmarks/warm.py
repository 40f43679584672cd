"""Warm loops beside each other, in turns: a worker of a batch, glTF-Transform and Blender.

See benchmarks/README.md.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path

from rigtri.files.worker_process import WorkerProcess
from rigtri.pipeline.batch.file_task import Assignment, work
from rigtri.pipeline.batch.inputs import Entry
from rigtri.pipeline.batch.spec_task import SpecTask
from rigtri.pipeline.rigspec.load import load

ROOT = Path(__file__).resolve().parent.parent
SPEC = "steps: [{do: orient-joints, aim: x, up: y}]\n"
WARM_UP = 4

BLENDER = """
import bpy, sys, time
source, target, runs = sys.argv[-3], sys.argv[-2], int(sys.argv[-1])
wall, used = [], []
for _ in range(runs + 1):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    start, begin = time.perf_counter(), time.process_time()
    bpy.ops.import_scene.gltf(filepath=source)
    rig = next(o for o in bpy.data.objects if o.type == "ARMATURE")
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for bone in rig.data.edit_bones:
        if len(bone.children) == 1:
            bone.tail = bone.children[0].head
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.export_scene.gltf(filepath=target)
    wall.append(time.perf_counter() - start)
    used.append(time.process_time() - begin)
print("SECONDS", sum(wall[1:]) / runs, sum(used[1:]) / runs)
"""

LIBRARY = """
import rigtri, sys, time
source, target, runs = sys.argv[-3], sys.argv[-2], int(sys.argv[-1])
wall, used = [], []
for _ in range(runs + 4):
    start, begin = time.perf_counter(), time.process_time()
    turn = lambda rig, report: rigtri.orient_joints(rig, aim="x", up="y", report=report)
    rigtri.edit(source, target, turn, overwrite=True)
    wall.append(time.perf_counter() - start)
    used.append(time.process_time() - begin)
print("SECONDS", sum(wall[4:]) / runs, sum(used[4:]) / runs)
"""

# Seconds a file, and seconds of processors a file.
Times = tuple[float, float]
Loop = Callable[[int], Times]


@contextmanager
def kept_to(cores: set[int]) -> Iterator[None]:
    """Meanwhile this thread, and the threads and programs it starts, share these cores, where systems can."""
    if not hasattr(os, "sched_setaffinity"):
        yield
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, cores)
    try:
        yield
    finally:
        os.sched_setaffinity(0, before)


def of_this_process() -> list[int]:
    """The cores that are ours."""
    return sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [0, 1]


class Workers:
    """The processes that a batch has on so many cores, each of which orients one file after another."""

    def __init__(self, source: Path, folder: Path, *, verify: bool, cores: set[int]) -> None:
        folder.mkdir()
        (folder / "rig.yaml").write_text(SPEC)
        self._source, self._folder = shutil.copy(source, folder), folder
        self._task = SpecTask(load(folder / "rig.yaml"), verify=verify)
        self._children = [WorkerProcess(preload=["rigtri.pipeline.batch.spec_task"]) for _ in cores]
        if hasattr(os, "sched_setaffinity"):
            for child in self._children:
                child("cores", os.sched_setaffinity, 0, cores)
        self._made = 0

    def __call__(self, count: int) -> Times:
        """Of all processes together."""
        if not self._made:  # a process of Python is warm from then on
            self._run(WARM_UP)
        start, used = time.perf_counter(), self._used()
        self._run(count)
        files = count * len(self._children)
        times = (time.perf_counter() - start) / files, (self._used() - used) / files
        self._clear()  # no batch does so: it is not measured
        return times

    def _used(self) -> float:
        return sum(child("clock", time.process_time) for child in self._children)

    def _run(self, count: int) -> None:
        threads = [
            threading.Thread(target=self._serve, args=(child, self._made + k * count, count))
            for k, child in enumerate(self._children)
        ]
        self._made += count * len(threads)
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    def _serve(self, child: WorkerProcess, first: int, count: int) -> None:
        folder = str(self._folder)
        for number in range(first, first + count):
            target = self._folder / f"{number:06}{Path(self._source).suffix}"
            assignment = Assignment(Entry(str(self._source), str(target)), self._task)
            record = child(target.name, work, assignment, folder, folder, False)
            assert record.status in ("ok", "warned"), record.message

    def _clear(self) -> None:
        for made in self._folder.glob(f"[0-9]*{Path(self._source).suffix}"):
            made.unlink()

    def close(self) -> None:
        for child in self._children:
            child.close()


def printed(*command: str | Path) -> Times:
    """The times that a program prints."""
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    (line,) = (text for text in done.stdout.splitlines() if text.startswith("SECONDS"))
    wall, used = line.split()[1:3]
    return float(wall), float(used)


def transform(source: Path, folder: Path) -> Loop | None:
    """glTF-Transform: read and write, nothing else; None where it is not installed."""
    place, node = os.environ.get("RIGTRI_GLTF_TRANSFORM"), shutil.which("node")
    if not place or not node:
        return None
    script = Path(__file__).with_name("rewrite.mjs")
    if source.suffix != ".glb":  # it goes by the suffix, and knows none of avatars
        source = Path(shutil.copyfile(source, folder / f"{source.stem}.glb"))
    return lambda count: printed(node, script, place, source, folder / "transform.glb", str(count))


def library(source: Path, folder: Path) -> Loop:
    """`rigtri.edit`, verified, in a process of its own."""
    target = folder / f"library{source.suffix}"
    return lambda count: printed(sys.executable, "-c", LIBRARY, source, target, str(count))


def blender(source: Path, folder: Path) -> Loop | None:
    """Blender: import, aim each bone at its child, export, in one process; None where it is not installed."""
    python = os.environ.get("BPY_PYTHON")
    if not python:
        return None
    script = folder / "blender.py"
    script.write_text(BLENDER)
    # It takes as long for one as others for ten.
    return lambda count: printed(python, script, source, folder / "blender.glb", str(max(count // 10, 3)))


def measured(source: Path, folder: Path, count: int, rounds: int) -> list[str]:
    """A table of all loops over one file, each the median of its rounds, and the label of each."""
    one, two = (set(of_this_process()[:many]) for many in (1, 2))
    variants = {"rigtri, verified": (True, one), "rigtri, not verified": (False, one)}
    if len(two) == 2:
        variants["rigtri, verified, two cores"] = True, two
    peers = {
        "rigtri.edit, verified": library(source, folder),
        f"glTF-Transform {version()}: read, write": transform(source, folder),
        "Blender: import, aim, export": blender(source, folder),
    }
    loops: dict[str, Loop] = {}
    with ExitStack() as stack:
        for name, (verify, cores) in variants.items():
            batch = Workers(source, folder / f"{len(loops)}", verify=verify, cores=cores)
            loops[name] = stack.enter_context(closing(batch))
        loops |= {name: loop for name, loop in peers.items() if loop is not None}
        times: dict[str, list[Times]] = {name: [] for name in loops}
        for _ in range(rounds):
            for name, loop in loops.items():
                with kept_to(variants[name][1] if name in variants else one):
                    times[name].append(loop(count))
    base = min(used for _, used in times["rigtri, verified"])
    lines = [f"## Warm, one file after another: {source.name}, {source.stat().st_size / 1e6:.2f} MB", ""]
    lines += ["| loop, on one core | files/s | in the median round | ms of processors | ratio of these |"]
    lines += ["|---|---|---|---|---|"]
    for name, found in times.items():
        best, middle = min(wall for wall, _ in found), statistics.median(wall for wall, _ in found)
        used = min(used for _, used in found)
        lines.append(
            f"| {name} | {1 / best:.1f} | {1 / middle:.1f} | {1000 * used:.1f} | {used / base:.2f} |"
        )
    return [*lines, ""]


def side_by_side(sources: Sequence[Path], folder: Path, rounds: int, seconds: float = 0.4) -> list[str]:
    """A table with a row for each file: a worker of ours, verified, and glTF-Transform, in turns on one core.

    seconds: of each loop in a round, about.
    """
    lines = ["## A file in a running process, verified, beside glTF-Transform's read and write", ""]
    lines += [f"Milliseconds of processors, medians of {rounds} rounds. glTF-Transform {version()}.", ""]
    lines += ["| file | MB | rigtri, verified | glTF-Transform | ratio | ratio by the clock |"]
    lines += ["|---|---|---|---|---|---|"]
    core = set(of_this_process()[:1])
    for number, source in enumerate(sources):
        place = folder / f"side{number}"
        peer = transform(source, folder)
        with closing(Workers(source, place, verify=True, cores=core)) as mine, kept_to(core):
            loops = [mine, *([peer] if peer else [])]
            counts = [max(3, round(seconds / loop(1)[0])) for loop in loops]
            times = [[loop(n) for loop, n in zip(loops, counts, strict=True)] for _ in range(rounds)]
        walls, used = (
            [statistics.median(each[k][of] for each in times) for k in range(len(loops))] for of in (0, 1)
        )
        row = f"| {source.name} | {source.stat().st_size / 1e6:.2f} | {1000 * used[0]:.1f} |"
        if peer:
            row += f" {1000 * used[1]:.1f} | {used[0] / used[1]:.2f} | {walls[0] / walls[1]:.2f} |"
        lines.append(row)
    return [*lines, ""]


def version() -> str:
    """That of glTF-Transform, where it is installed."""
    place = os.environ.get("RIGTRI_GLTF_TRANSFORM", "")
    package = Path(place, "node_modules", "@gltf-transform", "core", "package.json")
    return str(json.loads(package.read_text())["version"]) if package.is_file() else "is not installed"


def main() -> None:
    """Measure, and print a table."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument(
        "--file", type=Path, action="append", help="a character; with several, one table of all"
    )
    arguments.add_argument("--count", type=int, default=60, help="files of each loop in a round")
    arguments.add_argument("--rounds", type=int, default=5)
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory() as name:
        files = given.file or [ROOT / "samples" / "biped.glb"]
        if len(files) > 1:
            print("\n".join(side_by_side(files, Path(name), given.rounds)))
        else:
            print("\n".join(measured(files[0], Path(name), given.count, given.rounds)))


if __name__ == "__main__":
    sys.exit(main())
