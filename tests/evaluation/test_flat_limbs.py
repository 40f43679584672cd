"""Limbs of flat rigs, whose end joint is no descendant of the mid joint: solved, or refused by name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES
from program import cli

from rigtri.errors import GeometryError
from rigtri.evaluation.constraint_solver import Parts
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.solver import Solver
from rigtri.formats import read
from rigtri.maths.matrices import decompose, inverse, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.report import Report

ENDS = ("hand_L", "hand_R", "foot_L", "foot_R")


def moved_below(rig: Rig, parents: dict[str, str]) -> Rig:
    """The rig at rest with joints that are children of others, and stand where they stood."""
    above = rig.parents.copy()
    for name, parent in parents.items():
        above[rig.find(name)] = rig.find(parent)
    world = rig.world
    local = multiply(world, inverse(np.where((above >= 0)[:, None, None], world[above], np.eye(4))))
    translation, rotation, scale = decompose(local)
    return replace(rig, parents=above, translation=translation, rotation=rotation, scale=scale, clips=())


def flat_biped(**options: object) -> Rig:
    rig = moved_below(read(SAMPLES / "biped.glb").rig, dict.fromkeys(ENDS, "hips"))
    limbs = [
        ("upper_arm_L", "forearm_L", "hand_L"),
        ("upper_arm_R", "forearm_R", "hand_R"),
        ("thigh_L", "shin_L", "foot_L"),
        ("thigh_R", "shin_R", "foot_R"),
    ]
    given = AddControlsOptions(whole_character=True, ik=limbs, **options)  # type: ignore[arg-type]
    return add_controls(rig, options=given)


def posed(rig: Rig, moves: Floats) -> tuple[Solver, PoseCache]:
    """All IK ends moved by shares, (f, 3), of their limbs' lengths."""
    solver, still = Solver(rig), PoseCache(rig)
    parts = {}
    for ik in solver.limbs:
        size = float(sum(each[0] for each in ik.lengths(still)))
        own = still.part(ik.limb.control)
        parts[ik.limb.control] = Parts(own.translation + size * moves, own.rotation, own.scale)
    return solver, solver.run(parts)


@pytest.mark.ci
@pytest.mark.parametrize("options", [{}, {"stretch": True}, {"soft": 0.1}])
def test_the_end_stands_where_its_control_is_and_the_lower_bone_aims_at_it(
    options: dict[str, object],
) -> None:
    near = np.random.default_rng(3).uniform(-0.2, 0.2, (20, 3))
    far = np.array([[2.0, 0.5, 1.0], [-3.0, 1.0, 0.0]])
    rig = flat_biped(**options)
    solver, cache = posed(rig, np.concatenate([near, far]))
    assert len(solver.limbs) == 4
    rest = rig.world
    for ik in solver.limbs:
        a, b, c = ik.limb.chain
        start, mid, end = (cache.world(node)[:, 3, :3] for node in (a, b, c))
        size = sum(float(np.linalg.norm(rest[q, 3, :3] - rest[p, 3, :3])) for p, q in ((a, b), (b, c)))
        assert np.abs(end - ik.target(cache)).max() <= 1e-9 * size
        seat = rest[c, 3, :3] - rest[b, 3, :3]
        line = np.einsum("j,jk,fkl->fl", seat, np.linalg.inv(rest[b, :3, :3]), cache.world(b)[:, :3, :3])
        aim, bone = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (end - mid, line))
        # A soft limb ends short of its target, on the line to it.
        assert np.abs(aim - bone).max() <= (0.1 if options.get("soft") else 1e-6)
        reached = np.linalg.norm(end - start, axis=1) < (0.85 if options.get("soft") else 0.99) * size
        assert reached[:20].any() or options.get("soft")
        assert np.abs((mid + line - end)[reached]).max(initial=0.0) <= 1e-6 * size


@pytest.mark.ci
def test_a_flat_limb_at_zero_is_as_it_was() -> None:
    rig = flat_biped()
    _, cache = posed(rig, np.zeros((1, 3)))
    joints = np.flatnonzero(rig.is_joint).tolist()
    assert max(np.abs(cache.world(node) - rig.world[node]).max() for node in joints) <= 1e-6


@pytest.mark.ci
def test_motion_goes_to_the_controls_of_a_flat_leg_and_back(tmp_path: Path) -> None:
    rigged, onto, back = (tmp_path / f"{word}.glb" for word in ("rigged", "onto", "back"))
    line = ("--ik", "thigh", "shin", "foot", "--whole-character")
    cli("add-controls", SAMPLES / "flat_ik.glb", "-o", rigged, *line, code=0)
    cli("bake", rigged, "-o", onto, "--to", "controls", code=0)
    cli("bake", onto, "-o", back, code=0)
    cli("verify", SAMPLES / "flat_ik.glb", back, code=0)
    foot = read(onto).rig.find("foot_ik_ctl")
    assert any(track.node == foot for clip in read(onto).rig.clips for track in clip.tracks)


def test_a_limb_that_ik_cannot_move_is_refused_by_name() -> None:
    rig = moved_below(read(SAMPLES / "biped.glb").rig, {"hand_L": "upper_arm_L"})
    words = "'hand_L' is a descendant of 'upper_arm_L', but not of 'forearm_L'"
    with pytest.raises(GeometryError, match=f"IK cannot move this limb: {words}"):
        add_controls(rig, options=AddControlsOptions(ik=[("upper_arm_L", "forearm_L", "hand_L")]))


@pytest.mark.ci
def test_a_recognised_limb_that_ik_cannot_move_is_left_out_with_a_warning() -> None:
    rig = moved_below(read(SAMPLES / "biped.glb").rig, {"hand_L": "upper_arm_L"})
    report = Report()
    rig = add_controls(rig, options=AddControlsOptions(whole_character=True), report=report)
    made = [record["joint"] for record in report.added if record.get("kind") == "ik"]
    assert "hand_L" not in made
    assert len(Solver(rig).limbs) == len(made)
