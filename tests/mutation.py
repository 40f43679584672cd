"""Plant faults in a copy of the package, one at a time, and list which of them the tests see.

    python -m mutation --count 30                 # in the folder tests; a fault needs one to ten minutes
    python -m mutation --count 30 --list          # only list the faults
    python -m mutation --contexts .coverage       # run only the tests that execute the changed line: seconds
    python -m mutation --only 'export/blender/*'  # only in modules that fit a pattern

A fault is another sign or operator, another bound, another axis or item, a reversed condition, or a statement
that writes and is left out. Faults are spread over the rooms of the package and follow from ``--seed``. First
the tests of the fault's room and the quick ones run, then all. A test sees a fault where it fails with it and
passes without it. Exit code 1 where more than two of thirty faults stay unseen: some have no effect that
anybody could see, which only a reader can judge.

``--contexts`` is data of coverage.py whose contexts are ids of tests, as pytest-cov writes it with
``pytest -n auto --cov=rigtri --cov-context=test --cov-report=``. Where a line has moved since, the tests of
its neighbours run; where those do not see it, the tests of its room, some of which start processes.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from time import monotonic

ROOT = Path(__file__).resolve().parents[1]
ROOMS = (
    "maths",
    "model",
    "files",
    "evaluation",
    "frames",
    "recognition",
    "operations",
    "formats/gltf",
    "formats/usd",
    "formats/vrm",
    "verification",
    "export",
    "pipeline",
)
OPERATORS = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "+"),
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}
# A bound between real numbers that moves by nothing changes nothing that anybody could see: it is reversed.
REVERSED = {ast.Lt: ("<", ">="), ast.LtE: ("<=", ">"), ast.Gt: (">", "<="), ast.GtE: (">=", "<")}
WRITES = (
    "append",
    "extend",
    "update",
    "add",
    "write",
    "write_bytes",
    "write_text",
    "insert",
    "Set",
    "warn",
    "note",
)
# How pytest ends where tests pass, ids name none, or none is found; and where the package cannot be imported.
NO_TESTS, BROKEN = (0, 4, 5), "while loading conftest"
# Of thirty faults, those that may change nothing.
UNSEEN = 2 / 30


@dataclass(frozen=True)
class Fault:
    """Other text from ``start`` to ``end`` (offsets of bytes) of a file."""

    file: str
    line: int
    start: int
    end: int
    other: str

    def planted(self, content: bytes) -> bytes:
        return content[: self.start] + self.other.encode() + content[self.end :]

    def shown(self, content: bytes) -> str:
        """The line before and after."""
        before, after = (text.split(b"\n")[self.line - 1] for text in (content, self.planted(content)))
        return f"{before.decode().strip()}  ->  {after.decode().strip()}"


def faults_of(file: str, content: bytes) -> Iterator[Fault]:
    """Every fault that can be planted in the functions of a module."""
    starts = [0]
    for line in content.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def fault(start: int, end: int, other: str) -> Fault:
        return Fault(file, content.count(b"\n", 0, start) + 1, start, end, other)

    def first(node: ast.expr | ast.stmt) -> int:
        return starts[node.lineno - 1] + node.col_offset

    def last(node: ast.expr | ast.stmt) -> int:
        return starts[(node.end_lineno or 0) - 1] + (node.end_col_offset or 0)

    def between(left: ast.expr, right: ast.expr, kind: type[ast.AST]) -> Iterator[Fault]:
        old, new = OPERATORS.get(kind, ("", ""))
        if kind in REVERSED and not (_is_whole(left) or _is_whole(right)):
            old, new = REVERSED[kind]
        at = content.find(old.encode(), last(left), first(right)) if old else -1
        if at >= 0:
            yield fault(at, at + len(old), new)

    for function in ast.walk(ast.parse(content)):
        if not isinstance(function, ast.FunctionDef):
            continue
        for node in (inner for part in function.body for inner in ast.walk(part)):
            if isinstance(node, ast.BinOp) and not _is_text(node):
                yield from between(node.left, node.right, type(node.op))
            elif isinstance(node, ast.Compare):
                yield from between(node.left, node.comparators[0], type(node.ops[0]))
            elif isinstance(node, ast.BoolOp):
                yield from between(node.values[0], node.values[1], type(node.op))
            elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
                yield fault(first(node), first(node) + len("not"), "")
            elif isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
                if node.slice.value in (0, 1) and type(node.slice.value) is int:
                    yield fault(first(node.slice), last(node.slice), str(1 - node.slice.value))
            elif _writes(node):
                assert isinstance(node, ast.stmt)
                yield fault(first(node), last(node), "pass")


def _is_text(node: ast.BinOp) -> bool:
    """Whether strings are put together; a type such as ``A | B`` has no operator here."""
    return any(
        isinstance(side, ast.JoinedStr) or (isinstance(side, ast.Constant) and isinstance(side.value, str))
        for side in (node.left, node.right)
    )


def _is_whole(node: ast.expr) -> bool:
    """Whether an expression is a whole number, as far as one sees; 0 is where signs of real numbers part."""
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id == "len"
    return isinstance(node, ast.Constant) and type(node.value) is int and node.value != 0


def _writes(node: ast.AST) -> bool:
    if isinstance(node, ast.Assign):
        return isinstance(node.targets[0], ast.Subscript)
    if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)):
        return False
    called = node.value.func
    return isinstance(called, ast.Attribute) and called.attr.startswith(WRITES)


def chosen(seed: int, count: int, only: str = "") -> list[Fault]:
    """Faults room by room, each in a file of its own; only: or any of the modules that fit a pattern."""
    chance, found = random.Random(seed), list[Fault]()
    files = {room: sorted((ROOT / "rigtri" / room).rglob("*.py")) for room in ROOMS}
    if only:
        fit = [path for paths in files.values() for path in paths if path.match(only)]
        known = [each for p in fit for each in faults_of(p.relative_to(ROOT).as_posix(), p.read_bytes())]
        return chance.sample(known, min(count, len(known)))
    while len(found) < count:
        room = ROOMS[len(found) % len(ROOMS)]
        path = chance.choice(files[room])
        name = path.relative_to(ROOT).as_posix()
        every = list(faults_of(name, path.read_bytes()))
        if every and name not in {fault.file for fault in found}:
            found.append(chance.choice(every))
    return found


def laid_out(folder: Path) -> Path:
    """The package as it is installed, where it hides any that is."""
    ignored = shutil.ignore_patterns("__pycache__")
    for source, target in (("rigtri", "rigtri"), ("cli", "rigtri/cli"), ("schemas", "rigtri/schemas")):
        shutil.copytree(ROOT / source, folder / target, ignore=ignored)
    return folder


def runs_for(fault: Fault, contexts: Path | None) -> Iterator[list[str]]:
    """Arguments of pytest, those that see it soonest first."""
    room = next(room for room in sorted(ROOMS, key=len, reverse=True) if f"/{room}/" in fault.file)
    if contexts is not None:
        yield from _covering(fault, contexts)
        yield [f"tests/{room}", "tests/house"]
    else:
        yield [f"tests/{room}"]
        yield ["-m", "quick"]
        yield ["tests"]


def _covering(fault: Fault, contexts: Path) -> Iterator[list[str]]:
    """The tests that execute the line, a few at first."""
    from coverage import CoverageData

    data = CoverageData(str(contexts))
    data.read()
    file = next((name for name in data.measured_files() if name.endswith(f"/{fault.file}")), None)
    by_line = data.contexts_by_lineno(file) if file else {}
    near = [name for line in range(fault.line - 2, fault.line + 3) for name in by_line.get(line, [])]
    found = by_line.get(fault.line) or near
    ran = [name.rpartition("|") for name in found]  # TEST|run, TEST|setup
    # A fixture of a module is set up by its first test, and others look at what it gives.
    files = {name.partition("::")[0] for name, _, phase in ran if phase == "setup"}
    alike = {name for name in _collected() if name.partition("::")[0] in files}
    tests = sorted(alike | ({name for name, _, _ in ran} & _collected()))
    few = random.Random(0).sample(tests, min(12, len(tests)))
    if tests:
        yield few
        yield [name for name in tests if name not in few]


@cache
def _collected() -> set[str]:
    """The tests that the README's command runs."""
    command = [sys.executable, "-m", "pytest", "-q", "--collect-only"]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return {line for line in run.stdout.splitlines() if "::" in line}


def seen_by(fault: Fault, folder: Path, contexts: Path | None) -> str | None:
    """The test that fails with the fault and passes without it, if any."""
    place, content = folder / fault.file, (ROOT / fault.file).read_bytes()
    for words in runs_for(fault, contexts):
        if not words:
            continue
        place.write_bytes(fault.planted(content))
        code, told = _tested(folder, ["--cache-clear", *words])
        place.write_bytes(content)
        # Tests that fail for another reason fail again. pytest passes over files without a failure, and
        # would not find their tests by id.
        files = dict.fromkeys(word.partition("::")[0] for word in words)
        failing = code not in NO_TESTS or any(BROKEN in line for line in told)
        if failing and _tested(folder, ["--last-failed", *files])[0] == 0:
            failed = (line for line in told if line.startswith(("FAILED", "ERROR")))
            return next(failed, f"pytest ends: {code}")
    return None


def _tested(folder: Path, words: Sequence[str]) -> tuple[int | str, list[str]]:
    """How pytest ends with the package in ``folder``, and what it prints."""
    plugins = ["-p", "no:randomly", "-o", f"cache_dir={folder / 'cache'}"]
    try:
        run = subprocess.run(
            [sys.executable, "-m", "pytest", "-q", "-x", *plugins, *words],
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=1800,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "too slow", []
    return run.returncode, run.stdout.splitlines()


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m mutation", description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--list", action="store_true", help="only list the faults")
    parser.add_argument("--only", default="", metavar="PATTERN", help="modules, such as export/blender/*")
    parser.add_argument("--contexts", type=Path, metavar="FILE", help="data of coverage.py by test")
    given = parser.parse_args(words)
    faults, unseen = chosen(given.seed, given.count, given.only), 0
    with tempfile.TemporaryDirectory() as name:
        folder = laid_out(Path(name))
        for number, fault in enumerate(faults, 1):
            content = (ROOT / fault.file).read_bytes()
            print(f"{number:3} {fault.file}:{fault.line}  {fault.shown(content)}", flush=True)
            if given.list:
                continue
            begin = monotonic()
            test = seen_by(fault, folder, given.contexts)
            unseen += test is None
            print(f"    {test or 'NOT SEEN'}  ({monotonic() - begin:.0f} s)", flush=True)
    if not given.list:
        print(f"{len(faults) - unseen} of {len(faults)} seen")
    return unseen > UNSEEN * len(faults)


if __name__ == "__main__":
    sys.exit(main())
