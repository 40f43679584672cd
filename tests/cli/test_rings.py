"""What a command spares itself: the search for rings of objects, while it has few."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from places import SAMPLES

PROGRAM = """
import gc
from rigtri import cli
from rigtri.__main__ import program
looks, begin = [], cli.begin
def begun():
    begin()
    gc.callbacks.append(lambda phase, info: looks.append(phase))
cli.begin = begun
try:
    program()
finally:
    print(len(looks))
"""


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", "biped.usdz"])
def test_an_edit_of_a_small_file_looks_for_no_rings_of_objects(name: str, tmp_path: Path) -> None:
    """What its modules are made of has none that go."""
    words = ["orient-joints", SAMPLES / name, "-o", tmp_path / name, "-q"]
    done = subprocess.run([sys.executable, "-c", PROGRAM, *words], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["0"]
