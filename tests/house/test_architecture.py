"""What the layout promises: imports point one way, the core needs numpy alone, and so on."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from places import ROOT, slow

import rigtri

# Tests of the source run where the source is; an installed wheel has no folders to compare.
pytestmark = pytest.mark.skipif(
    Path(rigtri.__file__).parent != ROOT / "rigtri", reason="this is no checkout of the source"
)

LONGEST = 60
PACKAGES = {"cli": ROOT / "cli", "schemas": ROOT / "schemas"}


def modules() -> list[Path]:
    return sorted([*(ROOT / "rigtri").rglob("*.py"), *(ROOT / "cli").glob("*.py")])


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


@cache
def imports(path: Path, *, annotations: bool = False) -> tuple[str, ...]:
    """The dotted names of rigtri's modules that a module imports when it runs."""
    tree = parsed(path)
    unseen = set() if annotations else set(map(id, _only_for_types(tree)))
    found: list[str] = []
    for node in statements(path):
        if isinstance(node, ast.Import) and id(node) not in unseen:
            found += (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and id(node) not in unseen:
            assert node.level == 0 or path.parent.name == "cli", f"{path.name} imports relatively"
            base = node.module or "" if node.level == 0 else f"rigtri.cli.{node.module or ''}".rstrip(".")
            found += (f"{base}.{alias.name}" for alias in node.names)
    return tuple(found)


@cache
def statements(path: Path) -> tuple[ast.AST, ...]:
    """All statements of a module, those within others too, and what handles exceptions."""
    found: list[ast.AST] = [parsed(path)]
    for node in found:  # it grows as it is walked
        inner = ast.iter_child_nodes(node)
        found += (one for one in inner if isinstance(one, ast.stmt | ast.excepthandler | ast.match_case))
    return tuple(found)


def _only_for_types(tree: ast.Module) -> Iterator[ast.AST]:
    for node in tree.body:
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            yield from ast.walk(node)


SOURCES = modules() if (ROOT / "rigtri").is_dir() else []
INNER = [path for path in SOURCES if path != ROOT / "rigtri" / "__init__.py"]


def shown(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """The package as a wheel lays it out, and beside it pyproject.toml, which has the layers."""
    copy = tmp_path / "rigtri"
    ignore = shutil.ignore_patterns("__pycache__", "page*")
    shutil.copytree(ROOT / "rigtri", copy, ignore=ignore)
    for name, folder in PACKAGES.items():
        shutil.copytree(folder, copy / name, ignore=ignore)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def lint_imports(folder: Path) -> subprocess.CompletedProcess[str]:
    pytest.importorskip("importlinter", reason="import-linter is not installed")
    code = "from importlinter.cli import lint_imports_command as main; main(['--no-cache'])"
    environment = os.environ | {"PYTHONPATH": str(folder), "PYTHONSAFEPATH": "1"}
    return subprocess.run(
        [sys.executable, "-c", code],
        check=False,
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )


def test_imports_point_one_way(installed: Path) -> None:
    run = lint_imports(installed)
    assert run.returncode == 0, run.stdout + run.stderr


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("model/rig.py", "from rigtri.formats import read"),
        slow("formats/document.py", "def late():\n    from rigtri.operations.strip import strip"),
        (
            "formats/gltf/buffers.py",
            "if TYPE_CHECKING:\n    from rigtri.formats.usd.composition import stage",
        ),
        slow("formats/usd/reading/reader.py", "from rigtri.formats.usd.opinions import edits"),
        slow("pipeline/edit.py", "from rigtri.cli import main"),
        slow("maths/euler.py", "import rigtri.report"),
    ],
)
def test_a_planted_import_upwards_is_found(installed: Path, module: str, line: str) -> None:
    path = installed / "rigtri" / module
    path.write_text(f"{path.read_text('utf-8')}\n{line}\n", "utf-8")
    run = lint_imports(installed)
    assert run.returncode == 1
    assert "BROKEN" in run.stdout


@pytest.mark.ci
def test_no_module_imports_itself_by_a_circle() -> None:
    """Lazy imports count; those for types alone do not."""
    known = {dotted(path) for path in SOURCES}
    graph = {
        name: {found for found in (module_of(line, known) for line in imports(path)) if found} - {name}
        for name, path in zip(map(dotted, SOURCES), SOURCES, strict=True)
    }
    TopologicalSorter(graph).prepare()  # CycleError names the circle


def dotted(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(("rigtri", *parts) if parts[0] == "cli" else parts).removesuffix(".__init__")


def module_of(name: str, known: set[str]) -> str | None:
    """The module that an imported name is, or is in."""
    while name and name not in known:
        name = name.rpartition(".")[0]
    return name or None


def test_only_what_is_of_usd_imports_openusd() -> None:
    wrong = [
        shown(path)
        for path in INNER
        if "usd" not in str(path.relative_to(ROOT)) and any(name.startswith("pxr") for name in imports(path))
    ]
    assert wrong == []


def test_nobody_imports_the_program_or_the_schemas() -> None:
    """They are found by entry point and importlib.resources; commands know their siblings."""
    wrong = []
    for path in SOURCES:
        known = ("rigtri.schemas",) if path.parent.name == "cli" else ("rigtri.schemas", "rigtri.cli")
        every = imports(path, annotations=True)
        wrong += [f"{shown(path)} imports {name}" for name in every if name.startswith(known)]
    assert wrong == []


def test_no_package_imports_the_root() -> None:
    """Its face is for users; a package names the module that it needs."""
    wrong = []
    for path in INNER:
        for node in statements(path):
            whole = isinstance(node, ast.Import) and any(alias.name == "rigtri" for alias in node.names)
            parts = isinstance(node, ast.ImportFrom) and node.level == 0 and node.module == "rigtri"
            wrong += [f"{shown(path)}:{node.lineno}"] if whole or parts else []
    assert wrong == []


def test_no_except_catches_everything() -> None:
    wrong = []
    for path in SOURCES:
        for node in statements(path):
            if isinstance(node, ast.ExceptHandler) and not isinstance(node.body[-1], ast.Raise):
                caught = ast.unparse(node.type) if node.type else "everything"
                if caught in ("everything", "Exception", "BaseException"):
                    wrong.append(f"{shown(path)}:{node.lineno} catches {caught}")
    assert wrong == []


def test_a_function_fits_on_a_screen() -> None:
    long = []
    for path in SOURCES:
        for node in statements(path):
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


def test_an_edit_of_one_file_imports_nothing_for_temporary_files(samples: Path, tmp_path: Path) -> None:
    """`tempfile` brings archives and random numbers along, a twentieth of a new process."""
    words = ["orient-joints", str(samples / "biped.glb"), "-o", str(tmp_path / "out.glb"), "-q"]
    assert "tempfile" not in loaded(
        f"from rigtri.cli.main import program\nprogram({words!r}, standalone_mode=False)"
    )


@pytest.mark.ci
def test_reasons_to_leave_a_test_out_are_messages_that_there_are() -> None:
    """`.ci/run` fails for a reason that it does not know: who words a message anew does it there, too."""
    said = " ".join(
        node.value
        for path in modules()
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )
    allowed = (ROOT / ".ci/allowed-skips").read_text("utf-8")
    messages = re.findall(r"^rigtri: (.+)", allowed, re.M)
    assert messages
    for message in messages:
        words = max(re.split(r"\.\*|\d+(?!\.)", message.replace("\\.", ".")), key=len).strip(" ,")
        assert words in said, message


def test_modules_of_tests_have_names_of_their_own() -> None:
    """Two of one name cannot be collected in one run."""
    names = sorted(path.name for path in ROOT.glob("tests/**/test_*.py"))
    assert names == sorted({*names})
