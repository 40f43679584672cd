"""A second run of orient-joints turns nothing of bodies that stand square, either."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from posed_bodies import Pose, posed_body, translations
from recognition_bodies.anatomy import dinosaur
from rigs import rig_of

from rigtri import orient_joints
from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import unit
from rigtri.maths.vectors import dot
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin


def turned_again(rig: Rig, preset: str) -> list[int]:
    """The joints that a second run turns by more than 0.05°."""
    once = orient_joints(rig, preset=preset)
    twice = orient_joints(once, preset=preset)
    return np.flatnonzero(np.abs(once.rotation - twice.rotation).max(axis=1) > 1e-3).tolist()


@pytest.mark.ci
@pytest.mark.parametrize("preset", ["article", "maya"])
@pytest.mark.parametrize(
    ("arms", "forward", "palm"), [(90.0, 90.0, 0.0), (0.0, 0.0, 90.0), (90.0, 0.0, 90.0)]
)
def test_hands_without_thumb_or_bend_close_to_one_side(
    arms: float, forward: float, palm: float, preset: str
) -> None:
    """Their row of fingers stands square to the axis about which hands close that hang at the sides."""
    for seed in range(6):
        pose = Pose(
            "none", arms=arms, forward=forward, palm=palm, fingers=2, phalanges=1, thumb=False, seed=seed
        )
        body = posed_body(pose)
        assert turned_again(body.rig, preset) == []
        # The hands are each other's mirror image: what the one does to the left, the other does to the right.
        left, right = (_closing(body.rig, body.parts[f"{side} hand"], preset) for side in ("left", "right"))
        assert float(dot(left * [1.0, -1.0, -1.0], right)) == pytest.approx(1.0, abs=1e-3)


def _closing(rig: Rig, hand: int, preset: str) -> np.ndarray:
    """About which direction of the world a hand closes, unit, (3,)."""
    once = orient_joints(rig, preset=preset)
    return once.world[hand, 1, :3]


@pytest.mark.parametrize("seed", [2, 8, 21, 27])
def test_a_foot_aims_at_one_of_toes_side_by_side(seed: int) -> None:
    """Of nameless toes that reach equally far ahead."""
    body = dinosaur(np.random.default_rng(seed))
    row = {part: k + 1 for k, part in enumerate(body.joints)}
    above = [-1, *(row.get(parent, 0) for parent, _ in body.joints.values())]
    assert turned_again(_crooked(above, [body.at(part) for part in row], seed), "article") == []


def _crooked(parents: Sequence[int], places: Sequence[np.ndarray], seed: int) -> Rig:
    """Nameless joints at their places, with axes at random, below a root."""
    rotation = unit(np.random.default_rng(seed).normal(size=(len(parents), 4)))
    rotation[0] = (0.0, 0.0, 0.0, 1.0)
    rig = rig_of(["Armature"] + [""] * len(places), parents, np.zeros((len(parents), 3)), rotation)
    rig = replace(rig, translation=translations(rig, np.array(places)))
    joints = np.arange(1, len(parents))
    weighs = np.ones(len(joints), dtype=bool)
    return replace(
        rig, skins=(Skin("skin", joints, inverse(rig.world[joints]), weigh=lambda: weighs, key=0),)
    )
