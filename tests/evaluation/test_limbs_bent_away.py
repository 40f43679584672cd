"""Limbs that are bent a little beside their pole vectors, as knees and elbows of many bind poses are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from places import ci
from posed_bodies import Pose, posed_body

from rigtri import add_controls, add_polevector
from rigtri.evaluation.ik import Ik
from rigtri.evaluation.pose_cache import PoseCache
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import conjugate, multiply, rotation_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.solver_warnings import solver_warnings


def _with_knees_aside(degrees: float) -> Rig:
    """A body whose knees are bent to its left, both of them."""
    rig = posed_body(Pose(knee=0.0)).rig
    places = rig.translation.copy()
    for side in ("Left", "Right"):
        knee, foot = (rig.names.index(f"mixamorig:{side}{name}") for name in ("Leg", "Foot"))
        half = 0.5 * float(np.linalg.norm(rig.world[foot, 3, :3] - rig.world[knee, 3, :3]))
        aside = np.array([np.tan(np.radians(degrees / 2.0)) * 2.0 * half, 0.0, 0.0])
        places[knee] += aside @ inverse(rig.world[rig.parents[knee]])[:3, :3]
        places[foot] -= aside @ inverse(rig.world[knee])[:3, :3]
    rig = replace(rig, translation=places)
    skins = [replace(skin, inverse_bind=inverse(rig.world[list(skin.joints)])) for skin in rig.skins]
    return replace(rig, skins=tuple(skins))


def _solved(rig: Rig) -> tuple[Solver, list[Ik]]:
    rig = add_controls(rig, whole_character=True)
    solver = Solver(rig, None, ControlsAtZero(rig))
    limbs = [limb for limb in solver.limbs if limb.lean]
    assert limbs
    return solver, limbs


def _turned(solver: Solver, posed: PoseCache, node: int) -> float:
    """Degrees by which a node is turned against the rest pose."""
    turns = posed.world_rotation(node), solver.reference.world_rotation(node)
    return float(np.degrees(rotation_angle(multiply(turns[0], conjugate(turns[1])))).max())


def _bend(posed: PoseCache, limb: Ik) -> Floats:
    """Unit, (3,), from the line of root and end to the mid joint."""
    a, b, c = (posed.world(node)[0, 3, :3] for node in limb.limb.chain)
    line = (c - a) / np.linalg.norm(c - a)
    aside = b - a - (b - a) @ line * line
    return np.asarray(aside / np.linalg.norm(aside))


BODIES = {
    "0.05° back": posed_body(Pose(elbow=-0.05, knee=-0.05)).rig,
    "4° back": posed_body(Pose(elbow=-4.0, knee=-4.0)).rig,
    "9° back": posed_body(Pose(elbow=-9.0, knee=-9.0)).rig,
    "2° aside": _with_knees_aside(2.0),
    "8° aside": _with_knees_aside(8.0),
}
MOST = ["4° back", "8° aside", *map(ci, ("0.05° back", "9° back", "2° aside"))]


@pytest.mark.parametrize("name", MOST)
def test_they_rest_as_they_are_where_ik_moves_them(name: str) -> None:
    """They turned by up to 89°, or went through straight to the other side."""
    solver, limbs = _solved(BODIES[name])
    posed = solver.run({})
    for limb in limbs:
        for node in limb.limb.chain:
            assert _turned(solver, posed, node) < 1e-3
            places = posed.world(node)[..., 3, :3], solver.reference.world[node, 3, :3]
            np.testing.assert_allclose(*np.broadcast_arrays(*places), atol=1e-6)


@pytest.mark.ci
@pytest.mark.parametrize("name", MOST)
def test_they_bend_to_their_pole_and_do_not_roll(name: str) -> None:
    """Their ends go nearer in small steps: they stand where the control is in each, and no bone jumps."""
    solver, limbs = _solved(BODIES[name])
    for limb in limbs:
        root, _, end = (solver.reference.world[node, 3, :3] for node in limb.limb.chain)
        before = None
        for nearer in np.linspace(0.0, 0.6, 61) ** 2:
            control = limb.limb.control
            part = PoseCache(solver.rig, {}).part(control)
            back = inverse(solver.rig.world[solver.rig.parents[control]])[:3, :3]
            place = part.translation + nearer * (root - end) @ back
            posed = solver.run({control: part._replace(translation=place)})
            target = limb.target(posed)[0]
            np.testing.assert_allclose(posed.world(limb.limb.chain[2])[0, 3, :3], target, atol=1e-6)
            turned = [_turned(solver, posed, node) for node in limb.limb.chain[:2]]
            assert before is None or np.abs(np.subtract(turned, before)).max() < 6.0
            before = turned
        pole = limb.pole_position(posed)[0] - root
        line = (target - root) / np.linalg.norm(target - root)
        assert _bend(posed, limb) @ (pole - pole @ line * line) > 0.999 * np.linalg.norm(
            pole - pole @ line * line
        )
        assert max(turned) < 120.0


@pytest.mark.ci
def test_limbs_that_bend_to_their_pole_are_solved_as_before() -> None:
    rig = add_controls(posed_body(Pose(elbow=4.0, knee=4.0)).rig, whole_character=True)
    assert [limb.lean for limb in Solver(rig, None, ControlsAtZero(rig)).limbs] == [0.0] * 4


def test_a_pole_that_stands_beside_a_clear_bend_is_warned_of() -> None:
    """A user's --bend against an elbow that is bent by 30°: IK turns the arm to it, at rest too."""
    rig = posed_body(Pose(elbow=30.0)).rig
    ahead = {"mixamorig:LeftForeArm": (0.0, 0.0, 1.0)}
    rig = add_polevector(add_controls(rig, whole_character=True), limbs="auto", bend=ahead)
    solver = Solver(rig, None, ControlsAtZero(rig))
    (found,) = solver_warnings(solver, solver.run({}), str)
    assert (found.code, found.joint) == ("pole-elsewhere", "mixamorig:LeftHand")


@pytest.mark.ci
def test_limbs_of_both_sides_that_are_bent_against_their_poles_turn_as_mirror_images() -> None:
    """Knees 8° back and poles ahead: both sides swing out, or both in, and not both to the left."""
    rig = add_controls(posed_body(Pose(knee=-8.0)).rig, whole_character=True)
    leans = {
        rig.names[limb.limb.chain[2]]: limb.lean for limb in Solver(rig, None, ControlsAtZero(rig)).limbs
    }
    left, right = (leans[f"mixamorig:{side}Foot"] for side in ("Left", "Right"))
    assert left == pytest.approx(-right)
    assert abs(left) > 3.1


def test_a_target_beyond_a_limb_is_reached_where_the_control_of_its_end_brings_that_there() -> None:
    solver, (limb, *_) = _solved(BODIES["4° back"])
    ik, hand = limb.limb.control, limb.fk[limb.limb.chain[2]].own.control
    parts = {node: PoseCache(solver.rig, {}).part(node) for node in (ik, hand)}

    def run(beyond: float, pulled: Floats) -> tuple[PoseCache, list[str], Floats]:
        ways = {ik: np.array([beyond, 0.0, 0.0]), hand: pulled}
        posed = solver.run({k: p._replace(translation=p.translation + ways[k]) for k, p in parts.items()})
        codes = [notice.code for notice in solver_warnings(solver, posed, str)]
        return posed, codes, limb.target(posed)[0] - posed.world(limb.limb.chain[2])[0, 3, :3]

    assert run(0.0, np.zeros(3))[1] == []
    _, codes, missing = run(0.4, np.zeros(3))
    assert codes == ["ik-unreachable"]
    pulls = np.array([missing - run(0.4, way)[2] for way in np.eye(3)])
    _, codes, missing = run(0.4, missing @ np.linalg.inv(pulls))
    assert np.abs(missing).max() < 1e-9
    assert codes == []
