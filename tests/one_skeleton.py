"""What the commands of docs/one-skeleton.md do to real files: deviation, a second run, validators.

    python -m one_skeleton FOLDER            # in the folder tests; FOLDER has glTF, VRM and USD files
    python -m one_skeleton FOLDER --write    # replaces the table of docs/one-skeleton.md

A cell is the largest movement of a vertex, as a share of the size, in all clips; of set-rest and conform,
which change the rest pose, the largest in clips alone. ``=`` a second run gives the same bytes, ``~``
others; ``-`` nothing was to do; a number in brackets is the exit code of a refusal. With RIGTRI_VALIDATOR the
Khronos validator looks for new errors, of which the number follows behind ``!``; OpenUSD's own always does.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "builders"))

import os

from program import Ran, cli
from second_opinions import khronos_errors, usd_errors

PAGE = Path(__file__).resolve().parents[1] / "docs" / "one-skeleton.md"
MARK = "<!-- table -->"
COMMANDS = {
    "freeze": (),
    "rename-joints": ("--to", "unreal"),
    "prune-joints": ("--ends",),
    "merge-joints": ("--still",),
    "limit-weights": ("--normalise",),
    "set-rest": ("--pose", "tpose"),
    "add-root": (),
    "root-motion": ("--yaw",),
    "conform unreal": ("--to", "unreal"),
    "conform godot": ("--to", "godot"),
}
# What a file has to have first.
FIRST = {"root-motion": ("add-root",)}
SUFFIXES = (".glb", ".gltf", ".vrm", ".usd", ".usda", ".usdc", ".usdz")


def cell(command: str, path: Path, folder: Path) -> str:
    """What one command does to one file."""
    out, again, report = (folder / side / path.name for side in ("one", "two", "report"))
    for each in (out, again, report):
        each.parent.mkdir(exist_ok=True, parents=True)
    words = (*COMMANDS[command], "--allow-external-paths", "--overwrite")
    command = command.partition(" ")[0]
    for first in FIRST.get(command, ()):
        ready = folder / "ready" / path.name
        ready.parent.mkdir(exist_ok=True)
        if run(first, path, "-o", ready, "--allow-external-paths", "--overwrite").exit_code == 0:
            path = ready
    ran = run(command, path, "-o", out, *words, "--report", report.with_suffix(".json"))
    if ran.exit_code:
        return f"({ran.exit_code})"
    document = json.loads(report.with_suffix(".json").read_text("utf-8"))
    found = document["verification"]
    deviation = float(found["deviation"] or 0.0)
    if (motion := found.get("motion")) is not None:
        moved = [far or 0.0 for name, far in motion["clips"].items() if not name.endswith("@default")]
        deviation = max([deviation, *moved]) if command in ("set-rest", "conform") else deviation
    if not document["joints"] and not document["added"]:
        return "-"
    second = run(command, out, "-o", again, *words)
    same = second.exit_code == 0 and again.read_bytes() == out.read_bytes()
    return f"{deviation:.0e} {'=' if same else '~'}{errors(path, out)}"


def run(*words: object) -> Ran:
    return cli(*words)


def errors(before: Path, after: Path) -> str:
    """How many new errors a validator finds, "" for none."""
    if before.suffix in SUFFIXES[3:]:
        new = usd_errors(after) - usd_errors(before)
    elif os.environ.get("RIGTRI_VALIDATOR"):
        old, now = khronos_errors(before, after)
        new = now - old
    else:
        return ""
    return f" !{len(new)}" if new else ""


def table(folder: Path) -> Iterator[str]:
    yield f"| file | {' | '.join(COMMANDS)} |"
    yield "|---" * (len(COMMANDS) + 1) + "|"
    files = sorted(path for path in folder.rglob("*") if path.suffix in SUFFIXES and path.is_file())
    for path in files:
        with tempfile.TemporaryDirectory() as place:
            cells = [cell(command, path, Path(place)) for command in COMMANDS]
        if any(each[0].isdigit() for each in cells):
            yield f"| {path.name} | {' | '.join(cells)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--write", action="store_true", help="replace the table of docs/one-skeleton.md")
    arguments = parser.parse_args()
    lines = []
    for line in table(arguments.folder):
        print(line, flush=True)
        lines.append(line)
    if arguments.write:
        text = PAGE.read_text("utf-8")
        head = text[: text.index(MARK) + len(MARK)]
        PAGE.write_text(head + "\n\n" + "\n".join(lines) + "\n", "utf-8", newline="\n")


if __name__ == "__main__":
    main()
