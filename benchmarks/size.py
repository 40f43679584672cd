"""Large files and many joints: time, peak memory and growth, beside `cp` and the peers."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import astuple, dataclass
from pathlib import Path
from statistics import median

from cold import PROGRAM, version_of
from large import Character, write_glb, write_gltf, write_usd
from warm import version

PYGLTFLIB = "import pygltflib, sys; pygltflib.GLTF2().load(sys.argv[1]).save(sys.argv[2])"
# A peer that takes longer is stopped and listed as such.
LONGEST = 60.0
# Runs a program from a process that is small itself, whose size the program would inherit.
LAUNCHER = """
import os, sys, time
quiet = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
start = time.perf_counter()
_, status, usage = os.wait4(os.posix_spawnp(sys.argv[1], sys.argv[1:], os.environ, file_actions=quiet), 0)
print(time.perf_counter() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))
"""


@dataclass(frozen=True)
class Cost:
    """What a run took: seconds by the clock, seconds of computing, peak memory in MB."""

    seconds: float
    computing: float
    memory: float


def cost(*command: str | Path, longest: float | None = None, code: int = 0) -> Cost | None:
    """Run a program once, which ends with ``code``; None where it takes longer than ``longest`` seconds."""
    launcher = [sys.executable, "-S", "-c", LAUNCHER, *map(str, command)]
    try:
        done = subprocess.run(launcher, capture_output=True, text=True, check=False, timeout=longest)
    except subprocess.TimeoutExpired:
        return None
    if done.returncode != code:
        raise SystemExit(f"{command}: {done.stderr[-500:]}")
    seconds, computing, memory = map(float, done.stdout.split())
    return Cost(seconds, computing, memory / (1 << 20 if sys.platform == "darwin" else 1 << 10))


def orient(source: Path, target: Path) -> Cost:
    """`rigtri orient-joints` as a new process, verified."""
    found = cost(*PROGRAM, "orient-joints", source, "-o", target, "--overwrite", "-q")
    assert found is not None
    return found


def copied(*sources: Path, to: Path) -> Cost:
    """`cp` and the sync of what it wrote, holes filled."""
    to.mkdir(exist_ok=True)
    command = 'to=$1; shift; cp --sparse=never "$@" "$to" && sync -d "$to"/*'
    found = cost("sh", "-c", command, "sh", to, *sources)
    shutil.rmtree(to)
    assert found is not None
    return found


def medians(runs: int, *actions: Callable[[], Cost]) -> list[Cost]:
    """The medians of some runs of each action, taken in turns, so that all meet the same machine.

    A round before is not counted: a virtual machine gets the memory for its page cache from its host
    when it first uses it, which takes whoever comes first up to 2 s a GB.
    """
    rounds = [[astuple(action()) for action in actions] for _ in range(1 + runs)][1:]
    return [Cost(*map(median, zip(*some, strict=True))) for some in zip(*rounds, strict=True)]


def peers(source: Path, target: Path) -> dict[str, Cost | None]:
    """What others take to read a file and write it again."""
    found: dict[str, Cost | None] = {}
    place, node = os.environ.get("RIGTRI_GLTF_TRANSFORM"), shutil.which("node")
    if place and node:
        script = [node, Path(__file__).with_name("rewrite.mjs"), place, source, target, "0"]
        found[f"glTF-Transform {version()}, a script: read, write"] = cost(*script, longest=LONGEST)
    transform = os.environ.get("GLTF_TRANSFORM") or shutil.which("gltf-transform")
    if transform:
        name = f"glTF-Transform {version_of(transform)}, its command line: copy"
        found[name] = cost(transform, "copy", source, target, longest=LONGEST)
    if importlib.util.find_spec("pygltflib"):
        name = "pygltflib: read, write"
        found[name] = cost(sys.executable, "-c", PYGLTFLIB, source, target, longest=LONGEST)
    target.unlink(missing_ok=True)
    return found


def rows(costs: dict[str, Cost | None], base: Cost) -> list[str]:
    lines = ["| what, as a new process | seconds | ratio | s of processors | ratio | peak memory, MB |"]
    lines.append(f"|{'---|' * 6}")
    for name, found in costs.items():
        if found is None:
            lines.append(f"| {name} | over {LONGEST:.0f} | over {LONGEST / base.seconds:.0f} | - | - | - |")
        else:
            clock, used = found.seconds / base.seconds, found.computing / base.computing
            row = f"| {name} | {found.seconds:.2f} | {clock:.2f} | {found.computing:.2f} | {used:.2f} |"
            lines.append(f"{row} {found.memory:.0f} |")
    return [*lines, ""]


def large_files(folder: Path, runs: int) -> list[str]:
    """500 MB of points and images, as a .glb and as a .gltf with its data beside it; and 4 GB."""
    half = Character(joints=60, clips=4, keys=30, points=5_000_000, filler=200_000_000)
    glb = write_glb(folder / "half.glb", half)
    copies, target = folder / "copies", folder / "out.glb"

    def oriented(source: Path, to: Path) -> Cost:
        to.parent.mkdir(exist_ok=True)
        for old in to.parent.glob(f"{to.stem}.*") if to.parent != source.parent else [to]:
            old.unlink(missing_ok=True)
        return orient(source, to)

    base, mine = medians(runs, lambda: copied(glb, to=copies), lambda: oriented(glb, target))
    costs = {"cp + fsync": base, "rigtri orient-joints, verified": mine}
    lines = [f"## A .glb of {glb.stat().st_size / 1e6:.0f} MB, 5 million points", ""]
    lines += rows(costs | peers(glb, target), base)
    glb.unlink()
    gltf = write_gltf(folder / "half.gltf", half)
    both, elsewhere = [gltf, gltf.with_suffix(".bin")], folder / "elsewhere" / "half.gltf"
    base, mine = medians(runs, lambda: copied(*both, to=copies), lambda: oriented(gltf, elsewhere))
    lines += ["## The same as a .gltf with a .bin, to another folder", ""]
    lines += rows({"cp + fsync": base, "rigtri orient-joints, verified": mine}, base)
    shutil.rmtree(elsewhere.parent)
    for path in both:
        path.unlink()
    most = write_glb(folder / "most.glb", Character(joints=60, filler=(1 << 32) - (1 << 20), holes=True))
    base, mine = medians(min(runs, 3), lambda: copied(most, to=copies), lambda: oriented(most, target))
    lines += [f"## A .glb of {most.stat().st_size / 1e6:.0f} MB, which is as large as they get", ""]
    lines += rows({"cp + fsync": base, "rigtri orient-joints, verified": mine}, base)
    for path in (most, target):
        path.unlink()
    return lines


def growth(folder: Path) -> list[str]:
    """What twice and four times as much costs, and what the peers take for the most."""
    kinds: list[tuple[str, str, int, Callable[[int], Character]]] = [
        ("joints in a chain", ".glb", 2500, lambda n: Character(joints=n, shape="chain")),
        ("joints below one", ".glb", 2500, lambda n: Character(joints=n, shape="wide")),
        ("joints in limbs of ten", ".glb", 2500, lambda n: Character(joints=n)),
        ("accessors that nothing uses", ".glb", 5000, lambda n: Character(extras=n)),
        ("clips of 200 joints", ".glb", 10, lambda n: Character(joints=200, clips=n)),
        ("joints below one", ".usdc", 2500, lambda n: Character(joints=n, shape="wide")),
        ("joints in limbs of ten", ".usdc", 2500, lambda n: Character(joints=n)),
        ("joints in a chain", ".usdc", 250, lambda n: Character(joints=n, shape="chain")),
    ]
    lines = ["## Growth", "", "Seconds of computing of `rigtri orient-joints` as a new process, verified, "]
    lines[-1] += "less those for two joints; growth is from n to 4n, where 4 is linear."
    lines += ["", "| what | n | n | 2n | 4n | growth | peak memory at 4n, MB |", f"|{'---|' * 7}"]
    beside = ["", "The same files at 4n, seconds by the clock:", "", "| what | rigtri | peers |"]
    beside.append("|---|---|---|")
    nothing: dict[str, float] = {}
    for name, suffix, n, make in kinds:
        write = write_usd if suffix == ".usdc" else write_glb
        target = folder / f"grown{suffix}"
        if suffix not in nothing:
            tiny = write(folder / f"tiny{suffix}", Character(joints=2))
            nothing[suffix] = min(orient(tiny, target).computing for _ in range(3))
        found = []
        for times in (1, 2, 4):
            path = write(folder / f"grow{times}{suffix}", make(n * times))
            found.append(min((orient(path, target) for _ in range(2)), key=lambda one: one.computing))
        first, second, last = (max(one.computing - nothing[suffix], 0.01) for one in found)
        title = f"{name}, {suffix}"
        lines.append(
            f"| {title} | {n} | {first:.2f} | {second:.2f} | {last:.2f} | {last / first:.1f} "
            f"| {found[-1].memory:.0f} |"
        )
        if suffix == ".glb":
            others = peers(path, target)
            seconds = [f"{k} {f'{c.seconds:.1f}' if c else f'over {LONGEST:.0f}'}" for k, c in others.items()]
            beside.append(f"| {title} | {found[-1].seconds:.1f} | {', '.join(seconds)} |")
        for times in (1, 2, 4):
            (folder / f"grow{times}{suffix}").unlink()
    return [*lines, *beside, ""]


def differences(folder: Path) -> list[str]:
    """What `rigtri diff` takes for a file and what orient-joints makes of it, by joints."""
    about = (
        "Seconds by the clock of `rigtri diff` as a new process, of a file with joints in limbs of ten and "
        "what orient-joints made of it; `--no-verify` leaves out how far they look apart."
    )
    lines = ["## Differences", "", about]
    lines += ["", "| joints | diff | diff --no-verify | peak memory, MB |", "|---|---|---|---|"]
    for joints in (2500, 5000, 10000):
        path, target = write_glb(folder / "plain.glb", Character(joints=joints)), folder / "turned.glb"
        orient(path, target)
        seconds = []
        for more in ((), ("--no-verify",)):
            some = [cost(*PROGRAM, "diff", path, target, *more, code=1) for _ in range(2)]
            seconds.append(min((one for one in some if one), key=lambda one: one.seconds))
        whole, plain = seconds
        lines.append(f"| {joints} | {whole.seconds:.1f} | {plain.seconds:.1f} | {whole.memory:.0f} |")
        for old in (path, target):
            old.unlink()
    return [*lines, ""]
