"""conform: the standard skeleton of an engine, for any character."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES
from program import cli

import rigtri
from rigtri.maths.quaternions import angle_between, normalise
from rigtri.verification.checks import check

TARGETS = ("unreal", "unity", "godot", "vrm", "mixamo")


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_second_time_changes_no_byte(target: str, suffix: str, tmp_path: Path) -> None:
    out, again = tmp_path / f"out{suffix}", tmp_path / f"again{suffix}"
    cli("conform", SAMPLES / f"biped{suffix}", "-o", out, "--to", target, code=0)
    cli("conform", out, "-o", again, "--to", target, code=0)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize("target", ["unreal", "unity", "godot", "vrm"])
def test_the_engine_finds_what_it_asks_for(target: str, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    cli("conform", SAMPLES / "biped.glb", "-o", out, "--to", target, code=0)
    ids = {item.id for item in check(out, profile=target)}  # type: ignore[arg-type]
    assert not {found for found in ids if found.startswith("profile.")}


def test_two_characters_differ_in_the_lengths_of_their_bones_alone(tmp_path: Path) -> None:
    """The same body from two files, of other axes, names and rest pose."""
    other, one, two = (tmp_path / f"{name}.glb" for name in ("other", "one", "two"))
    cli("orient-joints", SAMPLES / "biped.glb", "-o", other, "--preset", "maya", code=0)
    cli("rename-joints", other, "-o", other, "--overwrite", "--to", "mixamo", code=0)
    cli("set-rest", other, "-o", other, "--overwrite", "--pose", "walk@0.5", code=0)
    for source, out in ((SAMPLES / "biped.glb", one), (other, two)):
        cli("conform", source, "-o", out, "--to", "vrm", code=0)
    mine, theirs = rigtri.read(one), rigtri.read(two)
    shared = [name for name in mine.names if name in theirs.names and name.startswith(("left", "right"))]
    assert "leftLowerArm" in shared
    for name in shared:
        a, b = (rig.rotation[rig.find(name)] for rig in (mine, theirs))
        assert angle_between(normalise(a), normalise(b)) < 1e-4, name


def test_the_steps_are_a_spec_that_builds_the_same(tmp_path: Path) -> None:
    out, spec, built = tmp_path / "out.glb", tmp_path / "conform.yaml", tmp_path / "built.glb"
    cli("conform", SAMPLES / "biped.glb", "-o", out, "--to", "unreal", "--save-spec", spec, code=0)
    cli("build", SAMPLES / "biped.glb", "-o", built, "--spec", spec, code=0)
    before, after = rigtri.read(out), rigtri.read(built)
    assert before.names == after.names
    assert np.allclose(before.world, after.world, atol=1e-6)
