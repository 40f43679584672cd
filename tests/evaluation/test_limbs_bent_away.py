"""Limbs that are bent a little away from their pole vectors, as knees and elbows of many bind poses are."""

from __future__ import annotations

import numpy as np
import pytest
from places import ci
from posed_bodies import Pose, posed_body

from rigtri import add_controls
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.maths.quaternions import conjugate, multiply, rotation_angle


@pytest.mark.parametrize(("bent", "away"), [(-4.0, True), ci(-9.0, True), (4.0, False)])
def test_ik_swings_them_through_straight_and_does_not_turn_them_round(bent: float, away: bool) -> None:
    """Twist joints would take thirds of half a turn, to either side."""
    rig = add_controls(posed_body(Pose(elbow=bent, knee=bent)).rig, whole_character=True)
    solver = Solver(rig, None, ControlsAtZero(rig))
    posed = solver.run({})
    assert len(solver.limbs) == 4
    for limb in solver.limbs:
        assert limb.bends_away == away
        for node in limb.limb.chain[:2]:
            turns = posed.world_rotation(node), solver.reference.world_rotation(node)
            off = np.degrees(rotation_angle(multiply(turns[0], conjugate(turns[1]))))
            assert float(off.max()) < (1.5 * abs(bent) if away else 0.01)
        end = limb.limb.chain[2]
        places = posed.world(end)[..., 3, :3], solver.reference.world[end, 3, :3]
        np.testing.assert_allclose(*np.broadcast_arrays(*places), atol=1e-6)
