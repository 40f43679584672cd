"""Same input, same bytes on every machine: by construction, and by hashes that were committed."""

from __future__ import annotations

import ast
import hashlib
import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from places import GOLDENS, SAMPLES
from program import cli

import rigtri

# Rooms and modules that only measure or print; nothing of theirs reaches a file but a report.
MEASURING = {"verification", "scene_facts", "edit", "report"}
# This one runs in Blender, which computes with float32.
MEASURING |= {"setup_in_blender"}
# Functions of the writing modules that only measure: module.function → why it may.
_POINTS = "points are measured, never written"
ALLOWED = {
    "skinning.deformed": _POINTS,
    "node_reader._check_rotations": "counts rotations for a message",
    "reoriented_constraints.changed_meaning": "axes are compared, never written",
    "add_controls._linear": "powers of decimal numbers are Python's own",
}
# They come from BLAS, LAPACK, libm or SIMD kernels, whose last bit differs between machines.
_FORBIDDEN = """
einsum matmul tensordot vdot linalg sum nansum mean average std var trace
sin cos tan arcsin arccos arctan arctan2 sinh cosh tanh asin acos atan atan2
exp exp2 expm1 log log2 log10 log1p power pow float_power cbrt hypot dist fsum
"""
FORBIDDEN = frozenset(_FORBIDDEN.split())
# Names that are ours too: only numpy's own functions of them are meant.
OURS_UNLESS_NUMPY = {"dot", "cross", "outer", "inner"}


def writing_modules() -> list[Path]:
    """The source of everything that can put a number into a file."""
    package = Path(rigtri.__file__).parent
    return sorted(p for p in package.rglob("*.py") if not {p.stem, *p.relative_to(package).parts} & MEASURING)


def functions(path: Path) -> Iterator[tuple[str, ast.AST]]:
    """What a module consists of, by its name: ``module.function``, of methods, too."""
    for node in ast.parse(path.read_text("utf-8")).body:
        for part in node.body if isinstance(node, ast.ClassDef) else [node]:
            yield f"{path.stem}.{getattr(part, 'name', '')}", part


def shaky(path: Path) -> Iterator[str]:
    """Operations of a module whose bits depend on the machine: ``module.function: operation``."""
    for name, part in functions(path):
        yield from (f"{name}: {what}" for what in map(_shaky, ast.walk(part)) if what)


def _shaky(node: ast.AST) -> str | None:
    if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.MatMult):
        return "@"
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
        # Squares are products and powers of constants are Python's; others ask libm.
        square = isinstance(node.right, ast.Constant) and node.right.value == 2
        return None if square or _constant(node.left) else ast.unparse(node)
    if isinstance(node, ast.Attribute):
        of_numpy = isinstance(node.value, ast.Name) and node.value.id in ("np", "numpy")
        if node.attr in FORBIDDEN or (of_numpy and node.attr in OURS_UNLESS_NUMPY):
            return ast.unparse(node)
    return None


def _constant(node: ast.AST) -> bool:
    return isinstance(node.operand if isinstance(node, ast.UnaryOp) else node, ast.Constant)


def test_what_is_written_comes_from_plus_minus_times_divide_and_root() -> None:
    """But in functions of `ALLOWED`, each of which exists and needs its place there."""
    found = [what for path in writing_modules() for what in shaky(path)]
    assert [what for what in found if what.partition(":")[0] not in ALLOWED] == []
    assert {what.partition(":")[0] for what in found} == set(ALLOWED)


def test_the_check_sees_what_it_forbids(tmp_path: Path) -> None:
    for statement in (
        "a @ b",
        "np.sin(a)",
        "np.einsum('i,i', a, a)",
        "a.sum(axis=0)",
        "np.cross(a, b)",
        "np.linalg.inv(a)",
        "math.atan2(a, b)",
        "a ** 0.5",
    ):
        path = tmp_path / "module.py"
        path.write_text(f"def f(a, b):\n    return {statement}\n", "utf-8")
        assert len(list(shaky(path))) >= 1, statement
    path.write_text("def f(a, b):\n    return cross(a, b) + a ** 2 + (-1) ** 3\n", "utf-8")
    assert list(shaky(path)) == []


# What the committed hashes are of: name → arguments, with IN for the sample and OUT for the result.
RUNS = {
    "biped.glb": ["orient-joints", "--aim", "x", "--up", "y"],
    "biped.gltf": ["orient-joints", "--preset", "blender"],
    "biped.usda": ["orient-joints", "--aim", "x", "--up", "y"],
    "biped.usdz": ["orient-joints", "--preset", "maya"],
    "flat_ik.glb": ["orient-joints", "--aim", "-x", "--up", "z"],
    "hand.glb": ["orient-joints", "--aim", "y", "--up", "x"],
    "tpose.glb": ["orient-joints", "--aim", "z", "--up", "-x"],
    "tail.glb": ["orient-joints", "--preset", "openxr"],
    "mirrored_pair.glb": ["orient-joints"],
    "arm.gltf": ["add-polevector", "--limb", "shoulder", "elbow", "wrist"],
}
HASHES = GOLDENS / "hashes.json"


@pytest.mark.parametrize("name", RUNS)
def test_outputs_have_the_bytes_they_had(name: str, tmp_path: Path, pytestconfig: pytest.Config) -> None:
    """Where they change on purpose: pytest --update-golden, and say so in the changelog."""
    command, *options = RUNS[name]
    target = tmp_path / name
    arguments = [command, str(SAMPLES / name), "-o", str(target), *options]
    cli(*arguments, code=0)
    beside = sorted(path for path in tmp_path.iterdir())
    digest = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in beside}
    known = json.loads(HASHES.read_text("utf-8")) if HASHES.exists() else {}
    if pytestconfig.getoption("--update-golden"):
        text = json.dumps(known | {name: digest}, indent=1, sort_keys=True)
        GOLDENS.mkdir(exist_ok=True)
        HASHES.write_text(text + "\n", "utf-8", newline="\n")
    else:
        assert known.get(name) == digest


def test_pictures_have_the_bytes_they_had(tmp_path: Path, pytestconfig: pytest.Config) -> None:
    """The golden is a picture: where it changes on purpose, look at it."""
    target, path = tmp_path / "biped.svg", GOLDENS / "draw_biped.svg"
    arguments = ["draw", str(SAMPLES / "biped.glb"), "-o", str(target), "--at", "walk@0.4"]
    cli(*arguments, code=0)
    if pytestconfig.getoption("--update-golden"):
        path.write_bytes(target.read_bytes())
    assert target.read_bytes() == path.read_bytes()
