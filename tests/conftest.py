"""Fixtures that all tests share; tests/README.md says how to use them."""

from __future__ import annotations

import difflib
import gc
import os
import re
import sys
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import click
import pytest
from hypothesis import settings
from places import ASSETS, GOLDENS, NO_ASSETS, ROOT, SAMPLES, TESTS
from program import program

# `python -m pytest` puts the checkout first in the path, and there cli/ is not rigtri.cli. Test the package
# that is installed, also in programs that tests start.
sys.path[:] = [folder for folder in sys.path if Path(folder).resolve() != ROOT]
os.environ["PYTHONSAFEPATH"] = "1"

from rigtri import register_usd_schemas  # noqa: E402
from rigtri.files import worker_process  # noqa: E402
from rigtri.pipeline.batch import local_engine  # noqa: E402

# A slow machine is no failure, and a law that fails should fail the same way tomorrow.
settings.register_profile("readme", deadline=None, derandomize=True, max_examples=25)
settings.register_profile("proofs", deadline=None, derandomize=True, max_examples=200)

# All workers of a test process come from one server: what it has loaded is not loaded by each of them.
worker_process.PRELOADED.extend(local_engine.PRELOADED)

# Programs that tests start would compile every module anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# Tests open stages of their own.
register_usd_schemas()

NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")
# Printed numbers have six digits; the last may differ where libraries of the reader's side do.
CLOSE = 1e-5


# What `pytest -m quick` runs.
QUICK = (
    "maths",
    "model",
    "laws",
    "evaluation/test_two_bone.py",
    "evaluation/test_insertion.py",
    "frames/test_reframe.py",
    "frames/test_rounding.py",
    "recognition/test_limbs.py",
    "formats/gltf/test_gltf_read.py",
    "formats/gltf/test_gltf_write.py",
    "formats/usd/test_usd_reading.py",
    "formats/usd/test_usd_writing.py",
    "formats/vrm/test_vrm.py",
    "export/test_explain.py",
    "pipeline/test_pipeline.py",
    "cli/test_completion.py",
    "house/test_architecture.py",
    "house/test_examples.py",
)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="write goldens anew; then look at git diff")
    parser.addoption("--slow", action="store_true", help="run what is marked ci and the proofs, too")
    parser.addoption("--sample", metavar="K/N", default="1/1", help="of all tests, the Kth of N parts")


def pytest_configure(config: pytest.Config) -> None:
    settings.load_profile("proofs" if config.getoption("--slow") else "readme")


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Proofs are not even imported where nobody asks for them: each worker would."""
    return True if collection_path == TESTS / "proofs" and not config.getoption("--slow") else None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark the quick tests and the proofs; leave out what --slow or -m ci run, and other parts."""
    kept, left_out = [], []
    more = config.getoption("markexpr") == "ci"
    for item in items:
        folder = item.path.relative_to(TESTS)
        if folder.as_posix().startswith(QUICK):
            item.add_marker("quick")
        if folder.parts[0] == "proofs" or _takes_a_real_file(item):
            item.add_marker("slow")
        late = item.get_closest_marker("slow") or (item.get_closest_marker("ci") and not more)
        left = late and not config.getoption("--slow")
        left = left or not _is_in_part(item, config.getoption("--sample"))
        (left_out if left else kept).append(item)
    items[:] = kept
    config.hook.pytest_deselected(items=left_out)


def pytest_collection_finish(session: pytest.Session) -> None:
    """Look for rings of garbage seldom: what was imported has none, and rigs go by themselves."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)


def _takes_a_real_file(item: pytest.Item) -> bool:
    given = item.callspec.params.values() if hasattr(item, "callspec") else ()
    return "assets" in getattr(item, "fixturenames", ()) or any(
        isinstance(value, Path) and value.is_relative_to(ASSETS) for value in given
    )


def _is_in_part(item: pytest.Item, part: str) -> bool:
    """Whether the hash of a test's name falls into part K of N."""
    number, count = map(int, part.split("/"))
    return zlib.crc32(item.nodeid.encode()) % count == number - 1


@pytest.fixture(scope="session")
def every(pytestconfig: pytest.Config) -> Callable[[int], int]:
    """``every(7)``: the step through all bytes of a file, 7, or 1 where the proofs run."""
    return lambda step: 1 if pytestconfig.getoption("--slow") else step


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
