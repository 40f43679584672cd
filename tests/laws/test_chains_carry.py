"""Chains of edits carry together what earlier ones built: build, animate, bake, edit, bake: the same motion.

`chains` makes a chain of a number; an operation takes part once it is among `carried.EDITS`.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from carried import EDITS, SAME_MOTION
from chains import ALONE, STEPS, chain, deviation
from places import SAMPLES, slow

FILES = ("tpose.glb", "biped.glb", "biped.usda")


@pytest.mark.parametrize("seed", [*map(slow, range(6)), 6, *map(slow, (7, 8)), 9, *map(slow, range(10, 60))])
def test_a_chain_ends_with_the_motion_that_it_began_with(seed: int, tmp_path: Path) -> None:
    assert deviation(SAMPLES / FILES[seed % len(FILES)], chain(seed), tmp_path) <= SAME_MOTION


def test_chains_have_every_edit_but_those_that_move_something_on_purpose() -> None:
    assert STEPS.keys() == EDITS.keys() - {*ALONE}
    assert {step.name for seed in range(300) for step in chain(seed)} >= STEPS.keys()
