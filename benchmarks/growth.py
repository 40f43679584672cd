"""How much more four times as many joints, clips, points or files cost commands that look at all of them."""

from __future__ import annotations

import argparse
import sqlite3
import tempfile
from collections.abc import Callable
from pathlib import Path

from cold import PROGRAM
from large import Character, write_glb
from size import Cost, cost

MORE = 4
# A run as new process takes a tenth of a second whatever it does; less than this beside it is no figure.
LEAST = 0.02
LOOKS: dict[str, tuple[str, ...]] = {
    "inspect": (),
    "recognise": (),
    "check": (),
    "draw": ("-o", "seen.svg", "--overwrite"),
    "view": ("-o", "seen.html", "--overwrite", "--limit", "1000"),
}
KINDS: dict[str, tuple[int, Callable[[int], Character]]] = {
    "joints in a chain": (2500, lambda n: Character(joints=n, shape="chain")),
    "joints below one": (2500, lambda n: Character(joints=n, shape="wide")),
    "clips of 50 joints": (250, lambda n: Character(joints=50, clips=n)),
    "points": (1_250_000, lambda n: Character(points=n)),
}


def run(*words: str | Path, code: int = 0) -> Cost:
    found = cost(*PROGRAM, *words, code=code)
    assert found is not None
    return found


def looks(folder: Path, share: int) -> list[str]:
    """A row for each command that looks at a file, and kind of large file."""
    lines = []
    tiny = write_glb(folder / "tiny.glb", Character(joints=3))
    for kind, (most, make) in KINDS.items():
        n = max(3, most // share)
        files = [write_glb(folder / f"{times}.glb", make(n * times)) for times in (1, MORE)]
        for command, more in LOOKS.items():
            words = [folder / word if word.startswith("seen") else word for word in more]
            lines.append(
                row(f"{command}: {kind}", n, [run(command, path, *words) for path in (tiny, *files)])
            )
    return lines


def baked(folder: Path, share: int) -> list[str]:
    """Controls on every joint, their motion put there, and baked back to joints."""
    lines, up, home = [], folder / "up.glb", folder / "home.glb"
    kinds: dict[str, tuple[int, Callable[[int], Character]]] = {
        "joints in limbs of ten": (250, lambda n: Character(joints=n)),
        "clips of 50 joints": (25, lambda n: Character(joints=50, clips=n)),
    }
    for kind, (most, make) in kinds.items():
        n = max(3, most // share)
        costs: dict[str, list[Cost]] = {"controls": [], "joints": []}
        for what in (Character(joints=3), make(n), make(MORE * n)):
            plain, rig = write_glb(folder / "plain.glb", what), folder / "rig.glb"
            run("add-controls", plain, "-o", rig, "--joints", "*", "--overwrite", "-q")
            for to, source, target in (("controls", rig, up), ("joints", up, home)):
                costs[to].append(run("bake", source, "-o", target, "--to", to, "--overwrite", "-q"))
        lines += [row(f"bake --to {to}: {kind}", n, found) for to, found in costs.items()]
    return lines


def converted(folder: Path, share: int) -> list[str]:
    """convert to a crate, and build with more and more steps."""
    tiny, lines = write_glb(folder / "tiny.glb", Character(joints=3)), list[str]()
    kinds: dict[str, tuple[int, Callable[[int], Character]]] = {
        "nodes that are no joints": (7500, lambda n: Character(joints=3, others=n)),
        "clips of 50 joints": (50, lambda n: Character(joints=50, clips=n)),
    }
    for kind, (most, make) in kinds.items():
        n = max(3, most // share)
        files = [write_glb(folder / f"{times}.glb", make(n * times)) for times in (1, MORE)]
        target = folder / "seen.usdc"
        found = [run("convert", path, "-o", target, "--overwrite", "-q") for path in (tiny, *files)]
        lines.append(row(f"convert: {kind}", n, found))
    n, spec, found = max(3, 50 // share), folder / "spec.yaml", []
    for count in (1, n, MORE * n):
        steps = (f"  - {{do: add-socket, on: j1, name: s{k}}}\n" for k in range(count))
        spec.write_text(f"version: 1\nsteps:\n{''.join(steps)}")
        found.append(run("build", tiny, "--spec", spec, "-o", folder / "up.glb", "--overwrite", "-q"))
    return [*lines, row("build: steps of a spec", n, found)]


def reported(folder: Path, share: int) -> list[str]:
    """batch-report of manifests with the row of one file again and again."""
    spec, files = folder / "spec.yaml", [write_glb(folder / "one.glb", Character(joints=3))]
    spec.write_text("version: 1\nsteps:\n  - do: orient-joints\n")
    n, found = max(3, 250_000 // share), []
    for count in (1, n, MORE * n):
        out = folder / f"out{count}"
        run("batch", "--spec", spec, *files, "-O", out, "-q")
        base = sqlite3.connect(out / "rigtri-batch.sqlite")
        columns = [name for (name,) in base.execute("SELECT name FROM pragma_table_info('files')")]
        kept = ",".join(name for name in columns if name not in ("id", "output"))
        base.execute(
            f"WITH RECURSIVE n(k) AS (SELECT 2 UNION ALL SELECT k+1 FROM n WHERE k<{count}) "
            f"INSERT INTO files(output,{kept}) SELECT output||k,{kept} FROM n, files WHERE {count}>1"
        )
        base.commit()
        base.close()
        found.append(run("batch-report", out))
    return [row("batch-report: files", n, found)]


def row(what: str, n: int, found: list[Cost]) -> str:
    """Seconds less those of next to nothing, and how they grow."""
    nothing, one, four = (each.computing for each in found)
    first, last = max(one - nothing, LEAST), max(four - nothing, LEAST)
    grown = f"{last / first:.1f}" if last > 5 * LEAST else "–"
    return f"| {what} | {n:,} | {first:.2f} | {last:.2f} | {grown} | {found[2].memory:.0f} |"


def commands(folder: Path, share: int = 1) -> list[str]:
    """The table. share: makes everything smaller by so much, to try it."""
    lines = ["## Growth of other commands", "", "Seconds of computing as a new process, less those for next "]
    lines[-1] += "to nothing; growth is from n to 4n, where 4 is linear."
    lines += ["", "| what | n | n | 4n | growth | peak memory at 4n, MB |", f"|{'---|' * 6}"]
    return [
        *lines,
        *looks(folder, share),
        *baked(folder, share),
        *converted(folder, share),
        *reported(folder, share),
        "",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--share", type=int, default=1, help="make everything smaller by so much")
    with tempfile.TemporaryDirectory() as name:
        print("\n".join(commands(Path(name), parser.parse_args().share)))


if __name__ == "__main__":
    main()
