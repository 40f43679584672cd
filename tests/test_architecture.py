"""What the layout promises: imports point one way, the core needs numpy alone, and so on."""

from __future__ import annotations

import ast
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from places import ROOT

import rigtri

# Tests of the source run where the source is; an installed wheel has no folders to compare.
pytestmark = pytest.mark.skipif(
    Path(rigtri.__file__).parent != ROOT / "rigtri", reason="this is no checkout of the source"
)

# Each module may import from lines above its own, and from its own line what the comment says.
ORDER = """
errors
bounds columns plain scratch
trigonometry
vectors
quaternions
matrices
euler triangle shapes records
boxes
rig
pose constraints rules spread twist
following size timelines insertion fitting triangles
carried readers driven dependence
solve
turned_rules
reframe report reach
origin
lengths
naming
recognition
limbs
stature
views
skeleton bend
matching
playing
moving scenery attached
watched
compare descriptions description changes
advice stilled intended
delivery plain_files
ahead ops formats
inputs outputs
bridge
drawing
explanation
viewer
checks pipeline difference
on_disk
in_memory
steps
spec
confined
batch
cli
""".strip().splitlines()
LONGEST = 60
PACKAGES = {"cli": ROOT / "cli", "schemas": ROOT / "schemas"}


def modules() -> list[Path]:
    return sorted([*(ROOT / "rigtri").rglob("*.py"), *(ROOT / "cli").glob("*.py")])


def place(path: Path) -> str:
    """The line of ORDER that a module belongs to: ``ops`` for rigtri/operations/orient_joints/orient.py."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return parts[0] if parts[0] != "rigtri" else parts[1]


def rank(name: str) -> int:
    return next(k for k, line in enumerate(ORDER) if name in line.split())


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


@cache
def imports(path: Path, *, annotations: bool = False) -> tuple[str, ...]:
    """The dotted names of rigtri's modules that a module imports when it runs."""
    tree = parsed(path)
    unseen = set() if annotations else set(map(id, _only_for_types(tree)))
    found: list[str] = []
    for node in nodes(path):
        if isinstance(node, ast.Import) and id(node) not in unseen:
            found += (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and id(node) not in unseen:
            assert node.level == 0 or place(path) == "cli", f"{path.name} imports relatively"
            found.append(node.module or "")
    return tuple(found)


@cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    return tuple(ast.walk(parsed(path)))


def _only_for_types(tree: ast.Module) -> Iterator[ast.AST]:
    for node in tree.body:
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            yield from ast.walk(node)


SOURCES = modules() if (ROOT / "rigtri").is_dir() else []
INNER = [path for path in SOURCES if path != ROOT / "rigtri" / "__init__.py"]


def shown(path: Path) -> str:
    return str(path.relative_to(ROOT))


def test_imports_point_one_way() -> None:
    wrong = []
    for path in INNER:
        own = place(path)
        for name in imports(path):
            parts = name.split(".")
            if parts[0] == "rigtri" and len(parts) > 1 and parts[1] != own and rank(parts[1]) >= rank(own):
                wrong.append(f"{shown(path)} imports {name}")
    assert wrong == []


def test_formats_do_not_know_each_other() -> None:
    wrong = []
    for path in INNER:
        folders = path.parent.parts
        known = ("pxr", "formats.usd") if "gltf" in folders else ("pxr",)
        known = ("formats.gltf",) if "usd" in folders else known
        wrong += [f"{shown(path)} imports {name}" for name in imports(path) if any(k in name for k in known)]
    assert wrong == []


def test_nobody_imports_the_program_or_the_schemas() -> None:
    """They are found by entry point and importlib.resources; commands know their siblings."""
    wrong = []
    for path in SOURCES:
        known = ("rigtri.schemas",) if place(path) == "cli" else ("rigtri.schemas", "rigtri.cli")
        every = imports(path, annotations=True)
        wrong += [f"{shown(path)} imports {name}" for name in every if name.startswith(known)]
    assert wrong == []


def test_no_except_catches_everything() -> None:
    wrong = []
    for path in SOURCES:
        for node in nodes(path):
            if isinstance(node, ast.ExceptHandler) and not isinstance(node.body[-1], ast.Raise):
                caught = ast.unparse(node.type) if node.type else "everything"
                if caught in ("everything", "Exception", "BaseException"):
                    wrong.append(f"{shown(path)}:{node.lineno} catches {caught}")
    assert wrong == []


def test_a_function_fits_on_a_screen() -> None:
    long = []
    for path in SOURCES:
        for node in nodes(path):
            if isinstance(node, ast.FunctionDef):
                lines = (node.end_lineno or 0) - node.body[0].lineno + 1
                if lines > LONGEST:
                    long.append(f"{shown(path)}: {node.name} has {lines} lines")
    assert long == []


def test_the_packages_of_the_wheel_are_the_folders_of_the_source() -> None:
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["setuptools"]
    folders = {p.parent for p in SOURCES if p.name == "__init__.py"} | {ROOT / "schemas"}
    found = {".".join(folder.relative_to(ROOT).parts) for folder in folders}
    wanted = {name if name.startswith("rigtri") else f"rigtri.{name}" for name in found}
    assert set(listed["packages"]) == wanted
    python = {path.parent for path in [*SOURCES, ROOT / "schemas" / "__init__.py"]}
    assert python == folders, "a folder with modules has no __init__.py"


def loaded(statement: str) -> set[str]:
    """The top-level modules that a fresh Python has loaded after a statement."""
    code = f"{statement}\nimport sys\nprint(*{{name.split('.')[0] for name in sys.modules}})"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(run.stdout.split())


CORE = "rigtri.frames.reframe, rigtri.maths.triangle, rigtri.report, rigtri.verification.compare.compare"


@pytest.mark.parametrize("statement", ["import rigtri", f"import {CORE}"])
def test_the_core_needs_numpy_alone(statement: str) -> None:
    assert not loaded(statement) & {"click", "pxr", "pygltflib", "jsonschema"}


def test_help_waits_for_no_numpy() -> None:
    assert "numpy" not in loaded("import rigtri.cli.main")
