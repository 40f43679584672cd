"""take-clips: each clip plays as in EDITED, whatever rests or moves above the body, or is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from taken_clips import apart, notices, rig_of, turned_key

from rigtri.errors import GeometryError
from rigtri.evaluation.constraint_solver import to_parts
from rigtri.maths.matrices import compose, inverse, multiply
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips import take_clips as module
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.report import Report

CLOSE = 1e-5
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def turn(axis: tuple[float, float, float], degrees: float) -> Floats:
    return from_axis_angle(axis, np.radians(degrees))


def below(rig: Rig, above: Floats) -> Rig:
    """The rig without clips, its joints where they are, below a topmost node that rests as ``above``."""
    parts = {path: getattr(rig, path).copy() for path in ("translation", "rotation", "scale")}
    matrix, hips = rig.matrix.copy(), rig.find("hips")
    for node, local in ((0, above), (hips, multiply(rig.world[hips], inverse(above)))):
        matrix[node] = local
        parts["translation"][node], parts["rotation"][node], parts["scale"][node] = to_parts(local)
    return replace(rig, clips=(), matrix=matrix, **parts)


def one_of_two_clips_moves_what_carries_the_body() -> Rig:
    """As a DCC writes it: the frame that was shown is the rest."""
    rig = rig_of()
    walk, hips = rig.clip("walk"), rig.find("hips")
    assert rig.parents[hips] == 0
    times = walk.tracks[0].times[[0, -1]]
    gone = Track(0, "translation", "LINEAR", times, np.array([[1.0, 0.0, 0.5], [2.0, 0.0, 2.5]]))
    turned = Track(0, "rotation", "LINEAR", times, np.array([turn(Y, 30.0), turn(Y, 120.0)]))
    rotation, translation = rig.rotation.copy(), rig.translation.copy()
    rotation[0], translation[0] = turned.values[0], gone.values[0]
    clips = (replace(walk, tracks=(*walk.tracks, gone, turned)), replace(walk, name="idle", key=1))
    return replace(rig, rotation=rotation, translation=translation, clips=clips)


def lying_in_centimetres() -> Rig:
    """As FBX files are: the node above the body lies on its back, in centimetres."""
    return below(rig_of(), compose([0.0, 0.0, 0.0], turn(X, -90.0), [0.01] * 3))


def test_the_body_is_where_edited_has_it_in_a_clip_that_does_not_move_what_carries_it() -> None:
    """Before, it lay on its back 2 m beside, with exit code 0."""
    edited = one_of_two_clips_moves_what_carries_the_body()
    home = take_clips(lying_in_centimetres(), from_=edited)
    for clip in ("walk", "idle"):
        assert apart(home, edited, clip) < CLOSE


def test_a_clip_that_would_play_otherwise_is_refused_whatever_rule_is_wrong(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module._Taking, "_rest_of_joints", lambda self: None)
    with pytest.raises(GeometryError, match=r"'idle' would not play as in EDITED: 'hips' is turned by \d+"):
        take_clips(lying_in_centimetres(), from_=one_of_two_clips_moves_what_carries_the_body())


def test_joints_that_edited_poses_without_keys_are_told() -> None:
    """Before, RIG's pose was kept in silence."""
    rig, report = rig_of(), Report()
    rotation, shin = rig.rotation.copy(), rig.find("shin_L")
    rotation[shin] = turn(X, 60.0)
    edited = turned_key(rig, "forearm_L", "wave", key=0)
    take_clips(rig, from_=replace(edited, rotation=rotation), report=report)
    assert notices(report) == ["held-without-keys"]
    assert "no keys of 'shin_L' in 'wave'" in report.warnings[0].text
