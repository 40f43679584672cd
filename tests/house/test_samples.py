"""The samples are what their script makes, small, and valid."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from places import SAMPLES, sample_files
from second_opinions import khronos_errors, usd_errors

GLTF = sample_files(".glb", ".gltf")
USD = sample_files(".usda", ".usdz")


def test_the_script_makes_the_same_bytes() -> None:
    command = [sys.executable, SAMPLES / "make.py", "--check"]
    environment = {**os.environ, "PYTHONPATH": str(SAMPLES)}
    run = subprocess.run(command, capture_output=True, env=environment, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_every_sample_is_described() -> None:
    text = (SAMPLES / "README.md").read_text("utf-8")
    for path in sample_files():
        assert f"`{path.name}`" in text


@pytest.mark.parametrize("path", sample_files(), ids=lambda path: path.name)
def test_samples_are_small(path: Path) -> None:
    assert path.stat().st_size <= 150_000


def test_the_khronos_validator_finds_no_error_in_the_samples() -> None:
    found = khronos_errors(*GLTF)
    assert {p.name: dict(e) for p, e in zip(GLTF, found, strict=True) if e} == {}


@pytest.mark.parametrize("path", USD, ids=lambda path: path.name)
def test_usd_validation_finds_no_error_in_the_samples(path: Path) -> None:
    assert not usd_errors(path)
