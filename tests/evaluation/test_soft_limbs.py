"""Soft and stretch of IK limbs: the end is as far from the root as docs/evaluation.md says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from places import SAMPLES, every_other, slow

from rigtri.evaluation import sampling
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.solver import Solver
from rigtri.formats import read
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.report import Report

SOFTS = (0.0, 0.01, 0.05, 0.2, 0.5, 0.9)
# How far the knee of the rest pose is to the side of its pole, as a share of the leg: bent well, straight
# but for the rounding of its positions, and, by as little as that, the other way or aside.
KNEES = {
    "bent": None,
    "straight": (0.0, 0.0),
    "other way": (-0.8e-3, 0.0),
    "aside": (1e-4, 0.5e-3),
}


def legged(knee: tuple[float, float] | None, soft: float = 0.0, stretch: bool = False) -> Rig:
    """The sample's biped with controls; its left knee off the line from hip to foot by shares of the leg."""
    rig = read(SAMPLES / "biped.glb").rig
    a, b, c = (rig.find(name) for name in ("thigh_L", "shin_L", "foot_L"))
    hip, at, foot = (rig.normalised_world[node, 3, :3] for node in (a, b, c))
    line = (foot - hip) / np.linalg.norm(foot - hip)
    bend = at - hip - (at - hip) @ line * line
    bend /= np.linalg.norm(bend)
    if knee is not None:
        leg = float(np.linalg.norm(foot - hip))
        wanted = hip + (at - hip) @ line * line + leg * (knee[0] * bend + knee[1] * np.cross(line, bend))
        translation = rig.translation.copy()
        above = np.linalg.inv(rig.normalised_world[a, :3, :3])
        translation[b] = (wanted - hip) @ above
        local = np.linalg.inv(rig.normalised_world[b, :3, :3])
        translation[c] = (foot - wanted) @ local
        rig = replace(rig, translation=translation)
    rig = add_controls(rig, options=AddControlsOptions(whole_character=True, soft=soft, stretch=stretch))
    if knee is not None:
        # The pole in front, where the well bent leg has it.
        limb = leg_of(rig).limb
        place = rig.normalised_world[b, 3, :3] + bend * leg
        world = rig.normalised_world[int(rig.parents[limb.pole])]
        translation = rig.translation.copy()
        translation[limb.pole] = (np.append(place, 1.0) @ np.linalg.inv(world))[:3]
        rig = replace(rig, translation=translation)
    single = {
        part: getattr(rig, part).astype(np.float32).astype(np.float64)
        for part in ("translation", "rotation", "scale")
    }
    return replace(rig, **single)


def leg_of(rig: Rig) -> Ik:
    return next(ik for ik in Solver(rig).limbs if rig.names[ik.limb.chain[2]] == "foot_L")


def reached(rig: Rig, distances: Floats, seed: int = 3) -> tuple[Floats, Floats, Floats]:
    """For targets at ``distances``, (f,), in directions of all sorts: how far the end is from the root, the
    knee towards the pole, and the end from its target, (f,) each. All are shares of the leg.
    """
    ik = leg_of(rig)
    a, b, c = ik.limb.chain
    hip, knee, foot = (rig.normalised_world[node, 3, :3] for node in (a, b, c))
    leg = np.linalg.norm(knee - hip) + np.linalg.norm(foot - knee)
    spread = np.random.default_rng(seed).normal(size=(len(distances), 3))
    away = (foot - hip) / np.linalg.norm(foot - hip) + 0.6 * spread / np.linalg.norm(spread, axis=1)[:, None]
    away /= np.linalg.norm(away, axis=1)[:, None]
    target = hip + away * (distances * leg)[:, None]
    control = ik.limb.control
    above = np.linalg.inv(rig.normalised_world[int(rig.parents[control])])
    local = np.c_[target, np.ones(len(target))] @ above
    still = rig.local[control]
    assert np.allclose(still, np.eye(4))
    parts = Parts(local[:, :3], np.array([[0.0, 0.0, 0.0, 1.0]]), np.ones((1, 3)))
    posed = Solver(rig, {control}).run({control: parts})
    hip, knee, foot = (np.broadcast_to(posed.world(node)[:, 3, :3], target.shape) for node in (a, b, c))
    pole = rig.normalised_world[ik.limb.pole, 3, :3] - hip
    across = pole - (pole * away).sum(axis=1)[:, None] * away
    bend = (knee - hip) - ((knee - hip) * away).sum(axis=1)[:, None] * away
    side = (across * bend).sum(axis=1) / np.linalg.norm(across, axis=1)
    return np.linalg.norm(foot - hip, axis=1) / leg, side / leg, np.linalg.norm(foot - target, axis=1) / leg


def documented(distances: Floats, soft: float, bones: tuple[float, float]) -> Floats:
    """docs/evaluation.md in numbers, as shares of the limb."""
    start = 1.0 - soft
    eased = start + soft * (1.0 - np.exp(-(distances - start) / soft)) if soft else np.ones_like(distances)
    reach = np.where(distances <= start, distances, eased)
    return np.clip(reach, abs(bones[0] - bones[1]) / sum(bones), 1.0)


def turns_by(knee: tuple[float, float] | None) -> float:
    """How far a knee that rests bent the other way leaves the line until it turns to its pole."""
    return 5e-3 if knee == KNEES["other way"] else 0.0


def bones(rig: Rig) -> tuple[float, float]:
    a, b, c = (rig.normalised_world[node, 3, :3] for node in leg_of(rig).limb.chain)
    return float(np.linalg.norm(b - a)), float(np.linalg.norm(c - b))


@pytest.mark.ci
@pytest.mark.parametrize(("knee", "soft"), every_other(list(KNEES.values()), SOFTS, of=4))
def test_the_end_goes_as_far_as_documented_and_the_knee_is_on_the_side_of_the_pole(
    soft: float, knee: tuple[float, float] | None
) -> None:
    rig = legged(knee, soft)
    distances = np.linspace(0.0, 3.0, 601)[1:]
    far, side, _ = reached(rig, distances)
    assert np.abs(far - documented(distances, soft, bones(rig))).max() < 1e-6
    assert (np.diff(far) > -1e-6).all()
    # The rounding of where the control stands turns the direction to a target near the root.
    assert (side * np.minimum(distances, 1.0)).min() > -1e-7 - turns_by(knee)


@pytest.mark.ci
@pytest.mark.parametrize(("knee", "soft"), every_other(list(KNEES.values()), SOFTS, of=4))
def test_with_stretch_the_end_reaches_its_target(soft: float, knee: tuple[float, float] | None) -> None:
    rig = legged(knee, soft, stretch=True)
    near = abs(np.subtract(*bones(rig))) / sum(bones(rig))
    distances = np.linspace(near + 1e-3, 3.0, 601)
    far, side, missed = reached(rig, distances)
    assert missed.max() < 1e-6
    assert np.abs(far - distances).max() < 1e-6
    assert (side / np.maximum(distances, 1.0)).min() > -1e-6 - turns_by(knee)  # a stretched limb is larger


@pytest.mark.ci
def test_soft_by_hand() -> None:
    # From 0.8 of the leg on: 0.8 + 0.2 (1 - e^-1) at 1, and 0.8 + 0.2 (1 - e^-2) at 1.2.
    far, _, _ = reached(legged(None, 0.2), np.array([0.653, 0.768, 1.0, 1.2]))
    np.testing.assert_allclose(far, [0.653, 0.768, 0.92642411, 0.97293294], atol=1e-6)


@pytest.mark.ci
@pytest.mark.parametrize("knee", ["bent", "straight"])
def test_a_limb_whose_controls_have_keys_where_they_are_at_rest_stays_as_it_is(knee: str) -> None:
    rig = legged(KNEES[knee])
    ik = leg_of(rig)
    posed = Solver(rig, {ik.limb.control}).run({})
    for node in ik.limb.chain:
        np.testing.assert_allclose(posed.world(node)[0], rig.normalised_world[node], atol=1e-7)


@pytest.mark.ci
@pytest.mark.parametrize("stretch", [slow(False), True])
@pytest.mark.parametrize("soft", [slow(0.05), 0.3, slow(0.9)])
def test_joints_to_controls_to_joints_gives_the_motion_back_whatever_the_softness(
    soft: float, stretch: bool
) -> None:
    rig = legged(None, soft, stretch)
    report = Report()
    up = bake(rig, options=BakeOptions(to="controls"), report=report)
    home = bake(up, options=BakeOptions())
    joints = np.flatnonzero(rig.is_joint)
    for name in ("walk", "wave"):
        clip = rig.clip(name)
        times = sampling.key_times(clip)
        before, after = (
            sampling.worlds(one, sampling.locals_at(one, one.clip(name), times))[:, joints, 3, :3]
            for one in (rig, home)
        )
        size = np.linalg.norm(np.ptp(rig.normalised_world[joints, 3, :3], axis=0))
        assert np.linalg.norm(before - after, axis=-1).max() / size < 1e-5


@pytest.mark.slow
def test_the_ik_end_is_placed_where_the_softened_limb_gives_the_joints_so_that_little_is_left_below_it() -> (
    None
):
    left = {}
    for soft in (0.0, 0.05, 0.3):
        report = Report()
        bake(legged(None, soft), options=BakeOptions(to="controls"), report=report)
        left[soft] = max(entry["residual_degrees"] for entry in report.added)
    assert left[0.05] < left[0.0] + 0.01
    assert left[0.3] < left[0.0] + 0.01
