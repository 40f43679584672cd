"""Fixtures that all tests share; tests/README.md says how to use them."""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from pathlib import Path

import click
import pytest
from hypothesis import settings
from places import ASSETS, GOLDENS, LARGE, NO_ASSETS, SAMPLES
from program import program

from rigtri import register_usd_schemas

# A slow machine is no failure, and a law that fails should fail the same way tomorrow.
settings.register_profile("rigtri", deadline=None, derandomize=True)
settings.load_profile("rigtri")

# Tests open stages of their own.
register_usd_schemas()

# Blender's own Python runs it.
collect_ignore_glob = ["builders/engines/blender_*.py"]

NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
# Printed numbers have six digits; the last may differ where libraries of the reader's side do.
CLOSE = 1e-5


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="write goldens anew; then look at git diff")
    parser.addoption("--slow", action="store_true", help="run the long proofs too")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave the long proofs out unless they are asked for."""
    if config.getoption("--slow"):
        return
    for item in items:
        if item.get_closest_marker("slow") or (
            _is_of_large_file(item) and not item.get_closest_marker("large")
        ):
            item.add_marker(pytest.mark.skip(reason="slow: run with --slow"))


def _is_of_large_file(item: pytest.Item) -> bool:
    given = item.callspec.params.values() if hasattr(item, "callspec") else ()
    return any(isinstance(value, Path) and value.name in LARGE for value in given)


@pytest.fixture(scope="session")
def samples() -> Path:
    """The folder with the files that ship with rigtri."""
    return SAMPLES


@pytest.fixture(scope="session")
def assets() -> Path:
    """The folder with real files; the test is skipped where it is not there."""
    if not ASSETS.is_dir():
        pytest.skip(NO_ASSETS)
    return ASSETS


@pytest.fixture(scope="session")
def app() -> click.Group:
    """The installed program as click has it; `program.cli` runs it."""
    return program()


@dataclass(frozen=True)
class Golden:
    """Text that a reviewer has read: words compare exactly, numbers within 1e-5."""

    folder: Path
    update: bool

    def check(self, name: str, text: str) -> None:
        """Fail with a unified diff where ``text`` is not what tests/goldens/NAME says."""
        path = self.folder / name
        if self.update:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, "utf-8", newline="\n")
            return
        if not path.exists():
            pytest.fail(f"no golden {name}; write it with --update-golden and read it")
        expected = path.read_text("utf-8")
        if not alike(expected, text):
            lines = (side.splitlines(keepends=True) for side in (expected, text))
            diff = "".join(difflib.unified_diff(*lines, fromfile=f"goldens/{name}", tofile="now"))
            pytest.fail(f"golden {name} differs:\n{diff}", pytrace=False)


@pytest.fixture(scope="session")
def golden(pytestconfig: pytest.Config) -> Golden:
    """Compare text with a committed one: ``golden.check("name.txt", text)``."""
    return Golden(GOLDENS, bool(pytestconfig.getoption("--update-golden")))


def alike(expected: str, text: str) -> bool:
    """Whether two texts have the same words, and numbers within 1e-5 of each other."""
    if NUMBER.split(expected) != NUMBER.split(text):
        return False
    pairs = zip(NUMBER.findall(expected), NUMBER.findall(text), strict=True)
    return all(abs(float(a) - float(b)) <= CLOSE * max(1.0, abs(float(a))) for a, b in pairs if a != b)
