"""Measure rigtri beside its peers in one run and print a table with ratios.

See benchmarks/README.md.
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from bake import tables
from batch import batches
from cold import PROGRAM, cold_starts, version_of
from growth import commands
from size import differences, growth, large_files
from usdcat import beside_export
from warm import BLENDER, measured, side_by_side, version

ROOT = Path(__file__).resolve().parent.parent
BIPED = ROOT / "samples" / "biped.glb"
SUFFIXES = (".glb", ".gltf", ".vrm", ".vrma", ".usd", ".usda", ".usdc", ".usdz")
# Bytes of the files that are measured beside glTF-Transform.
LEAST_CHARACTER = 100_000


@dataclass
class Row:
    """One measurement: what, seconds, and what it is compared with."""

    what: str
    seconds: float
    note: str = ""


def median_of(runs: int, action: Callable[[], None]) -> float:
    """The median duration of ``runs`` calls, in seconds, after one call to warm up."""
    action()
    durations = []
    for _ in range(runs):
        start = time.perf_counter()
        action()
        durations.append(time.perf_counter() - start)
    return statistics.median(durations)


def process(*command: str | Path) -> Callable[[], None]:
    """A call that runs a program and fails loudly."""

    def run() -> None:
        done = subprocess.run([str(part) for part in command], capture_output=True, check=False)
        if done.returncode:
            raise SystemExit(f"{command}: {done.stderr.decode()[-500:]}")

    return run


def cold(source: Path, folder: Path) -> Callable[[], None]:
    """`rigtri orient-joints` as a new process, verification included."""
    target = folder / f"cold{source.suffix}"
    return process(*PROGRAM, "orient-joints", source, "-o", target, "--overwrite", "-q")


def warm(source: Path, folder: Path) -> Callable[[], None]:
    """Read, orient and write in a running process, without verification."""
    from rigtri.formats import read
    from rigtri.operations.orient_joints.orient import orient_joints

    part, target = folder / f"warm{source.suffix}", folder / f"out{source.suffix}"

    def run() -> None:
        document = read(source)
        document.write(orient_joints(document.rig), part, target)

    return run


def blender_rows(source: Path, folder: Path, runs: int) -> list[Row]:
    """Blender: import, aim each bone at its child, export; as a process, and warm inside one."""
    python = os.environ.get("BPY_PYTHON")
    if not python:
        return []
    target = folder / "blender.glb"
    script = folder / "blender.py"
    script.write_text(BLENDER)
    whole = median_of(2, process(python, script, source, target, "1"))
    answer = subprocess.run(
        [python, script, source, target, str(runs)], capture_output=True, text=True, check=True
    )
    (line,) = (text for text in answer.stdout.splitlines() if text.startswith("SECONDS"))
    # The process imports and exports twice: once to warm up, once measured.
    once = float(line.split()[1])
    return [
        Row("Blender, new process: import, aim, export", whole - once),
        Row("Blender, warm: import, aim, export", once),
    ]


def peer_rows(source: Path, folder: Path, runs: int) -> list[Row]:
    rows = []
    transform = os.environ.get("GLTF_TRANSFORM") or shutil.which("gltf-transform")
    if transform:
        copy = process(transform, "copy", source, folder / "transform.glb")
        name = f"glTF-Transform {version_of(transform)}, its command line, new process: copy"
        rows.append(Row(name, median_of(runs, copy)))
    place, node = os.environ.get("RIGTRI_GLTF_TRANSFORM"), shutil.which("node")
    if place and node:
        script = Path(__file__).with_name("rewrite.mjs")
        once = process(node, script, place, source, folder / "transform.glb", "0")
        name = f"glTF-Transform {version()}, a script, new process: read, write"
        rows.append(Row(name, median_of(runs, once)))
    if importlib.util.find_spec("pygltflib"):
        import pygltflib

        def rewrite() -> None:
            pygltflib.GLTF2().load(str(source)).save(str(folder / "pygltflib.glb"))

        rows.append(Row("pygltflib, warm: read, write", median_of(runs, rewrite)))
    return rows + blender_rows(source, folder, max(3, runs // 2))


def imports(source: Path, folder: Path) -> set[str]:
    """The top-level modules and rigtri formats that a run imports."""
    script = (
        "import sys; from rigtri.__main__ import program\n"
        f"sys.argv = ['rigtri', 'orient-joints', {str(source)!r}, "
        f"'-o', {str(folder / ('i' + source.suffix))!r}, '-q', '--overwrite']\n"
        "try: program()\n"
        "except SystemExit: pass\n"
        "print(*sys.modules)"
    )
    answer = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    return set(answer.stdout.split())


def deviations(folder: Path, scratch: Path) -> list[tuple[str, str, str, str]]:
    """For each file of a folder: what orient-joints makes of it, and the deviation it measures."""
    from rigtri.errors import RigtriError
    from rigtri.operations.orient_joints.orient import orient_joints
    from rigtri.pipeline.edit import edit

    found = []
    for path in sorted(p for p in folder.rglob("*") if p.suffix.lower() in SUFFIXES):
        name = str(path.relative_to(folder))
        place = scratch / "files" / path.stem
        place.mkdir(parents=True, exist_ok=True)
        try:
            outcome = edit(
                path,
                place / path.name,
                lambda rig, report: orient_joints(rig, report=report),
                overwrite=True,
            )
        except RigtriError as error:
            found.append((name, "-", "-", str(error).split(". ")[0].replace(str(path), path.name)))
            continue
        turned = sum(entry["status"] == "turned" for entry in outcome.report.joints)
        assert outcome.verification is not None
        measured = outcome.verification
        raw = f"{measured.raw_deviation:.2g}" if measured.raw_deviation is not None else "-"
        found.append((name, f"{measured.deviation:.2g}", raw, f"{turned} joints turned"))
    return found


def table(rows: list[Row], base: Row) -> list[str]:
    lines = ["| what | seconds | ratio |", "|---|---|---|"]
    lines += [f"| {row.what} | {row.seconds:.3f} | {row.seconds / base.seconds:.2f} |" for row in rows]
    return lines


def character(source: Path, folder: Path, runs: int) -> list[str]:
    """The table of one glTF character: rigtri cold and warm beside its peers."""
    mine = [
        Row("rigtri orient-joints, new process, verified", median_of(runs, cold(source, folder))),
        Row("rigtri, warm: read, orient, write", median_of(runs, warm(source, folder))),
    ]
    peers = peer_rows(source, folder, runs)
    started = [row for row in peers if "new process" in row.what]
    running = [row for row in peers if "warm" in row.what]
    lines = [f"## {source.name}, {source.stat().st_size / 1e6:.2f} MB", ""]
    lines += [*table([mine[0], *started], mine[0]), "", *table([mine[1], *running], mine[1]), ""]
    return lines


def small(folder: Path, assets: Path | None, runs: int) -> list[str]:
    """Ordinary characters, beside the peers, and what a run imports."""
    lines = [*cold_starts(folder, runs), *character(BIPED, folder, runs)]
    usd = [ROOT / "samples" / "biped.usdz"]
    if assets:
        man = next(assets.rglob("*CesiumMan*.glb"))
        lines += [*character(man, folder, runs), *measured(man, folder, 60, runs)]
        usd += list(assets.rglob("*CesiumMan*.usdz"))
        # VRM 0 forbids what is done here.
        avatars = [place for place in assets.rglob("*.vrm") if b"VRMC_vrm" in place.read_bytes()]
        ours = {place.stat().st_size: place for place in [*assets.rglob("*.glb"), *avatars]}
        characters = [place for size, place in sorted(ours.items()) if size > LEAST_CHARACTER]
        lines += side_by_side([BIPED, *characters], folder, 3)
    lines += ["## USD", "", "| file | seconds, new process, verified |", "|---|---|"]
    lines += [f"| {path.name} | {median_of(runs, cold(path, folder)):.3f} |" for path in usd]
    loaded = imports(BIPED, folder)
    lines += ["", f"A glTF run imports pxr: {'pxr' in loaded}. "]
    loaded = imports(ROOT / "samples" / "biped.usda", folder)
    lines[-1] += f"A USD run imports the glTF format: {'rigtri.formats.gltf.document' in loaded}."
    layers = folder / "layers"
    layers.mkdir()
    lines += ["", *beside_export(layers)]
    shutil.rmtree(layers)
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--assets", type=Path, help="a folder with real files")
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--write", type=Path, help="write the table to this file too")
    parser.add_argument("--only", choices=["small", "large", "bake", "batch"], help="leave the rest out")
    parser.add_argument("--scratch", type=Path, help="a folder with 10 GB to spare, for the large files")
    options = parser.parse_args()
    # An installed program has its modules compiled.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    if options.scratch is not None:
        options.scratch.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=options.scratch) as name:
        folder = Path(name)
        machine = f"{platform.platform()}, {os.cpu_count()} cores, Python {platform.python_version()}"
        runs = f"Medians of {options.runs} runs."
        lines = ["# Results", "", f"{date.today()}, {machine}. {runs}", ""]
        if options.only in (None, "small"):
            lines += small(folder, options.assets, options.runs)
        if options.only in (None, "bake"):
            lines += ["## Evaluation", "", *tables(10_000), ""]
        if options.only in (None, "batch"):
            man = next(options.assets.rglob("*CesiumMan*.glb")) if options.assets else BIPED
            lines += batches(man, folder)
        if options.only in (None, "large"):
            lines += [*large_files(folder, options.runs), *growth(folder)]
            lines += [*commands(folder), *differences(folder)]
        if options.assets and options.only in (None, "small"):
            lines += ["## Deviation of each real file", ""]
            lines += ["Share of the bounding-box diagonal; raw: with rotations as stored, not unit.", ""]
            lines += ["| file | deviation | raw | |", "|---|---|---|---|"]
            lines += [f"| {' | '.join(row)} |" for row in deviations(options.assets, folder)]
    text = "\n".join(lines) + "\n"
    print(text)
    if options.write:
        options.write.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
