"""Measure batches: files a second, two processes beside one, Dask, the manifest, memory, a million rows.

See benchmarks/README.md.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import random
import shutil
import sqlite3
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cold import PROGRAM, started
from warm import Times

from rigtri.pipeline.batch.axis_summary import Axes
from rigtri.pipeline.batch.file_task import Record
from rigtri.pipeline.batch.inputs import Entry
from rigtri.pipeline.batch.manifest_writer import Manifest
from rigtri.pipeline.batch.report import summarise

ROOT = Path(__file__).resolve().parent.parent
SPEC = "steps: [{do: orient-joints, aim: x, up: y}]\n"


def copies(source: Path, count: int, folder: Path) -> None:
    """Many files with the content of one; links, as reading is not what is measured."""
    (folder / "in").mkdir(parents=True)
    for number in range(count):
        os.link(source, folder / "in" / f"{number:06}{source.suffix}")
    (folder / "rig.yaml").write_text(SPEC)


def run(folder: Path, suffix: str, *words: str, fresh: bool = True) -> Times:
    """Seconds that a batch takes, and seconds of processors of the process that hands files out."""
    if fresh:
        shutil.rmtree(folder / "out", ignore_errors=True)
    given = ["batch", f"in/*{suffix}", "--spec", "rig.yaml", "-O", "out", "-q", *words]
    return started([*PROGRAM, *given], cwd=folder)


def stages(folder: Path) -> dict[str, float]:
    """What a worker needs for a file, in milliseconds, from the log of the last run."""
    lines = [json.loads(line)["seconds"] for line in (folder / "log.jsonl").read_text().splitlines()]
    warm = lines[len(lines) // 10 :]
    return {name: 1000 * sum(line[name] for line in warm) / len(warm) for name in warm[0]}


@contextmanager
def scheduler(workers: int) -> Iterator[str | None]:
    """The address of a Dask scheduler with so many worker processes; None where Dask is not installed."""
    if not importlib.util.find_spec("distributed"):
        yield None
        return
    from distributed import LocalCluster

    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster:
        yield cluster.scheduler_address


def throughput(source: Path, count: int, folder: Path, jobs: int) -> list[str]:
    """Files a second; what the start takes is measured with two files and taken off."""
    copies(source, count, folder)
    few = folder / "few"
    copies(source, 2, few)
    lines = [f"{count} files of {source.stat().st_size / 1e6:.2f} MB ({source.name}).", ""]
    lines += [
        "| run | files/s | seconds | start | handing out, ms of processors a file |",
        "|---|---|---|---|---|",
    ]
    rates: dict[str, float] = {}
    one, two, bare, cluster = (
        "one process, verified",
        f"{jobs} processes, verified",
        "one process, not verified",
        f"{jobs} workers of Dask, verified",
    )
    with scheduler(jobs) as address:
        runs = {one: ["-j", "1"], two: ["-j", str(jobs)], bare: ["-j", "1", "--no-verify"]}
        if address:
            runs[cluster] = ["--dask", address]
        for name, words in runs.items():
            start, least = min(run(few, source.suffix, *words) for _ in range(2))
            (folder / "log.jsonl").unlink(missing_ok=True)
            seconds, used = run(folder, source.suffix, *words, "--log", "log.jsonl")
            rates[name] = (count - 2) / max(seconds - start, 1e-9)
            own = 1000 * (used - least) / (count - 2)
            lines.append(f"| {name} | {rates[name]:.1f} | {seconds:.2f} | {start:.2f} | {own:.1f} |")
            text = ", ".join(f"{stage} {value:.1f}" for stage, value in stages(folder).items())
            lines.append(f"| in the worker, ms a file | {text} | | | |")
    words = ["-j", "1"]
    for place in (few, folder):
        run(place, source.suffix, *words)
    (start, least), (again, used) = (
        run(place, source.suffix, *words, fresh=False) for place in (few, folder)
    )
    rate, own = (count - 2) / max(again - start, 1e-9), 1000 * (used - least) / (count - 2)
    lines.append(f"| nothing left to do | {rate:.0f} | {again:.2f} | {start:.2f} | {own:.1f} |")
    lines += ["", f"{jobs} processes do {rates[two] / rates[one]:.2f} times what one does."]
    if cluster in rates:
        lines[-1] += f" Dask's workers do {rates[cluster] / rates[two]:.2f} of what {jobs} processes do."
    return [*lines, ""]


def overhead(count: int, folder: Path) -> list[str]:
    """What the manifest takes for a file: to be put down before and after it appears, and to be looked up."""
    folder.mkdir()
    turns = bytes(range(240))
    with Manifest(folder / "rigtri-batch.sqlite") as manifest:
        begin, cpu = time.perf_counter(), time.process_time()
        for number in range(count):
            entry = Entry(f"{folder}/in/{number}.glb", f"{folder}/out/{number}.glb")
            record = Record(
                "ok",
                deviation=1e-7,
                seconds={"read": 0.01, "all": 0.02},
                read={f"in/{number}.glb": "0" * 64},
                made={f"out/{number}.glb": "0" * 64},
                axes=Axes('[[-1,"a"]]', turns),
            )
            manifest.known(entry)
            manifest.ready(entry, "0" * 64, record)
            manifest.done(entry, "0" * 64, record)
        wall, cpu = time.perf_counter() - begin, time.process_time() - cpu
    each, of_core = 1000 * wall / count, 1000 * cpu / count
    return [f"The manifest takes {each:.3f} ms a file ({of_core:.3f} ms of a core).", ""]


def memory(count: int, source: Path, folder: Path) -> list[str]:
    """How much the processes of a batch take after a tenth of its files, and at its end."""
    copies(source, count, folder)
    given = ["batch", f"in/*{source.suffix}", "--spec", "rig.yaml", "-O", "out", "-j", "2", "--json"]
    with subprocess.Popen([*PROGRAM, *given], cwd=folder, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        early = late = 0
        for number, _ in enumerate(process.stdout):
            if number == count // 10:
                early = _resident(process.pid)
            if number == count - 10:
                late = _resident(process.pid)
    text = f"{early / 1e6:.0f} MB in all processes after a tenth, {late / 1e6:.0f} MB at the end"
    return [f"{count} files: {text}.", ""]


def _resident(process: int) -> int:
    """Bytes that a process and all below it have in memory (Linux)."""
    total, todo = 0, [process]
    while todo:
        one = todo.pop()
        try:
            total += int(Path(f"/proc/{one}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
            todo += map(int, Path(f"/proc/{one}/task/{one}/children").read_text().split())
        except FileNotFoundError:
            continue
    return total


def million(count: int, folder: Path) -> list[str]:
    """How long the summary of a large manifest takes."""
    folder.mkdir()
    path = folder / "rigtri-batch.sqlite"
    with Manifest(path):
        pass
    chance = random.Random(1)
    base = sqlite3.connect(path)
    with base:
        for skeleton in range(50):
            base.execute("INSERT INTO skeletons VALUES (?, ?, ?)", (skeleton, f"{skeleton}", '[[-1,"hips"]]'))
            for kind in range(4):
                turns = chance.randbytes(8)
                base.execute("INSERT INTO axes VALUES (?, ?, ?)", (4 * skeleton + kind, skeleton, turns))
        statuses = ["ok"] * 980 + ["warned"] * 17 + ["error"] * 2 + ["crashed"]
        base.executemany(
            "INSERT INTO files VALUES (?, ?, ?, ?, ?, ?, 0, ?, ?, ?, ?, 0)",
            (_row(number, chance, chance.choice(statuses)) for number in range(count)),
        )
        hashes = json.dumps({"characters/somebody/hero.glb": "0" * 64})
        base.executemany(
            "INSERT INTO contents VALUES (?, ?, ?, NULL)", ((k, hashes, hashes) for k in range(count))
        )
        base.executemany(
            "INSERT INTO warnings VALUES (?, ?, NULL, 'look out')",
            ((k, f"code{k % 7}") for k in range(0, count, 10)),
        )
    base.close()
    begin = time.perf_counter()
    found = summarise([path])
    seconds = time.perf_counter() - begin
    assert found["files"] == count
    return [f"{count} rows, {path.stat().st_size / 1e6:.0f} MB, are summarised in {seconds:.2f} s.", ""]


def _row(number: int, chance: random.Random, status: str) -> tuple[object, ...]:
    failed = status in ("error", "crashed")
    name = f"characters/{number % 1000:03}/{number:06}.glb"
    kind, reason = ("geometry", f"reason {number % 5}") if failed else (None, None)
    deviation, axes = (None, None) if failed else (chance.random() * 1e-6, number % 200)
    return number, f"out/{name}", name, status, kind, reason, deviation, chance.random(), axes, "0" * 64


def batches(
    file: Path, folder: Path, *, count: int = 300, long: int = 2000, rows: int = 1_000_000, jobs: int = 2
) -> list[str]:
    """All tables and sentences."""
    # Links need the file on the same disk.
    source = Path(shutil.copy(file, folder))
    return [
        *("## Batches", ""),
        *throughput(source, count, folder / "many", jobs),
        *overhead(10_000, folder / "manifest"),
        *memory(long, source, folder / "long"),
        *million(rows, folder / "million"),
    ]


def main() -> None:
    """Measure, and print a table."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--file", type=Path, default=ROOT / "samples" / "biped.glb")
    arguments.add_argument("--count", type=int, default=300)
    arguments.add_argument("--long", type=int, default=2000, help="files of the run whose memory is measured")
    arguments.add_argument("--rows", type=int, default=1_000_000)
    arguments.add_argument("--jobs", type=int, default=2)
    arguments.add_argument("--scratch", type=Path, help="a folder on the disk that is to be measured")
    given = arguments.parse_args()
    with tempfile.TemporaryDirectory(dir=given.scratch) as name:
        many = {key: vars(given)[key] for key in ("count", "long", "rows", "jobs")}
        print("\n".join(batches(given.file, Path(name), **many)))


if __name__ == "__main__":
    main()
