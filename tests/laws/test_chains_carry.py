"""Chains of edits carry together what earlier ones built: build, animate, bake, edit, bake: the same motion.

`chains` makes a chain of a number; an operation takes part once it is among `carried.EDITS`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from carried import EDITS, SAME_MOTION
from chains import STEPS, chain, deviation
from pairs import pair
from places import SAMPLES

FILES = ("tpose.glb", "biped.glb", "biped.usda")


def _seeds() -> Iterator[Any]:
    """Two see faults in what re-orients and what bakes; all others are proofs."""
    for seed in range(30):
        yield pytest.param(seed, marks=[] if seed in (6, 21) else [pytest.mark.slow])


@pytest.mark.parametrize("seed", list(_seeds()))
def test_a_chain_ends_with_the_motion_that_it_began_with(seed: int, tmp_path: Path) -> None:
    assert deviation(SAMPLES / FILES[seed % len(FILES)], chain(seed), tmp_path) <= SAME_MOTION


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30, 36))
@pytest.mark.parametrize("suffix", ["gltf", "usda"])
def test_a_chain_of_edits_of_two_characters_moves_neither(suffix: str, seed: int, tmp_path: Path) -> None:
    """Some are of one of the two alone."""
    assert deviation(pair(SAMPLES, tmp_path, suffix), chain(seed), tmp_path) <= SAME_MOTION


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(36, 40))
def test_a_chain_of_layers_ends_with_the_motion_that_it_began_with(seed: int, tmp_path: Path) -> None:
    path = SAMPLES / "biped.usda"
    assert deviation(path, chain(seed), tmp_path, target="new") <= SAME_MOTION


def test_chains_have_every_edit() -> None:
    assert {*STEPS} == {*EDITS, "snap --to ik", "convert"}
    assert {step.name for seed in range(300) for step in chain(seed)} >= STEPS.keys()
