"""The benchmarks run: nobody else calls them, and options that are renamed would stop them unseen."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from places import ROOT, SAMPLES

FOLDER = ROOT / "benchmarks"
# Those with a command line of their own.
SCRIPTS = sorted(path.name for path in FOLDER.glob("*.py") if "ArgumentParser" in path.read_text("utf-8"))


def run(name: str, *words: str | Path) -> str:
    """What a script prints; an error where it fails."""
    line = [sys.executable, FOLDER / name, *words]
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONSAFEPATH"}
    return subprocess.run(line, capture_output=True, text=True, check=True, env=environment).stdout


@pytest.mark.ci
@pytest.mark.parametrize("name", SCRIPTS)
def test_a_benchmark_finds_all_that_it_imports(name: str) -> None:
    assert run(name, "--help").startswith("usage")


@pytest.mark.ci
def test_evaluation_is_measured_on_the_rig_that_it_names(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, it used names that options no longer have, and `run.py` ended in a traceback after minutes."""
    monkeypatch.syspath_prepend(FOLDER)
    import bake  # type: ignore[import-not-found]

    took = bake.measured(50, 30)
    assert took.nodes > 40
    assert min(took.solved, took.keyed, took.thinned) > 0


@pytest.mark.ci
def test_a_warm_edit_is_measured() -> None:
    printed = run("warm.py", "--file", SAMPLES / "biped.glb", "--count", "1", "--rounds", "1")
    assert "| rigtri, verified |" in printed
