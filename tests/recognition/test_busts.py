"""Busts: head, neck and shoulders, whose facing direction only the names of their sides tell."""

from __future__ import annotations

from math import cos, radians, sin

import numpy as np
import pytest
from recognition_bodies.skeletons import Joint, both, line, rig_with

from rigtri import orient_joints
from rigtri.recognition.recognise import recognise
from rigtri.report import Report

_TRUNK = [
    *line("spine chest neck head", "", (0, 1.15, 0), (0, 1.3, 0), (0, 1.5, 0), (0, 1.65, 0)),
    ("top", "head", (0.0, 1.9, 0.0)),
]
_BUSTS = {
    "shoulders": both(line("shoulder.L", "chest", (0.16, 1.45, 0))),
    "stumps": both(line("clavicle.L upper_arm.L", "chest", (0.04, 1.45, 0), (0.16, 1.45, 0))),
    "eyes": both(line("eye.L", "head", (0.03, 1.7, 0.09))),
}


def _bust(which: str, yaw: float) -> list[Joint]:
    c, s = cos(radians(yaw)), sin(radians(yaw))
    joints = [*_TRUNK, *_BUSTS[which]]
    return [(name, above, (c * x + s * z, y, c * z - s * x)) for name, above, (x, y, z) in joints]


@pytest.mark.parametrize("yaw", [0.0, 90.0, 200.0])
@pytest.mark.parametrize("which", _BUSTS)
def test_a_bust_has_the_axes_of_a_body_that_faces_as_its_sides_are_named(which: str, yaw: float) -> None:
    """Before, its trunk took the planes of its own bones, with a warning at best."""
    rig, report = rig_with(_bust(which, yaw)), Report()
    facing = (sin(radians(yaw)), 0.0, cos(radians(yaw)))
    (bust,) = recognise(rig).characters
    assert bust.facing == pytest.approx(facing, abs=1e-4)
    turned = orient_joints(rig, preset="maya", report=report).world
    for name in ("chest", "neck"):
        assert np.allclose(turned[rig.find(name), 2, :3], facing, atol=1e-4), name
    assert not [notice for notice in report.warnings if notice.code == "no-facing"]


def test_names_of_sides_that_disagree_and_trunks_that_lie_tell_no_facing() -> None:
    crossed = [
        ("eye.R" if n == "eye.L" else "eye.L" if n == "eye.R" else n, a, p) for n, a, p in _BUSTS["eyes"]
    ]
    lying = [(name, above, (x, -z, y)) for name, above, (x, y, z) in _bust("shoulders", 0.0)]
    wide = [(name, above, (5.0 * x, y, z)) for name, above, (x, y, z) in crossed]
    for joints in (lying, [*_TRUNK, *_BUSTS["shoulders"], *wide]):
        (bust,) = recognise(rig_with(joints)).characters
        assert not any(bust.facing)
