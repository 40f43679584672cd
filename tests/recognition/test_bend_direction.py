"""Which way limbs bend, in a pose, in clips and in the mirror, by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Column, Track
from rigtri.model.limb import Limb
from rigtri.model.rig import Rig
from rigtri.recognition.bend_direction import crossings, facing_along, in_motion, in_pose, mirrored, towards

X, Y, Z = np.eye(3)
LIMB = Limb(1, 2, 3)


def arm(height: float = 0.0, degrees: Any = ()) -> Rig:
    """A root and a limb along x, whose middle is so high; a clip turns its middle joint about z."""
    rig = chain((5, 5, 5), (0, 0, 0), (1, height, 0), (2, 0, 0))
    if len(degrees):
        turns = from_axis_angle(Z, np.radians(np.array(degrees, dtype=np.float64)))
        track = Track(2, "rotation", "LINEAR", np.arange(float(len(degrees))), turns)
        rig = replace(rig, clips=(Clip("bend", (track,)),))
    return rig


def test_the_image_of_a_direction_is_across_the_line_between_both_sides() -> None:
    assert_allclose(mirrored(np.array([1.0, 2, 3]), 2.0 * X, -3.0 * X), [-1, 2, 3])
    assert_allclose(mirrored(np.array([1.0, 2, 3]), X + Y, np.zeros(3)), [-2, -1, 3], atol=1e-12)
    # Where both stand off the origin, the line between them counts alone.
    assert_allclose(mirrored(np.array([1.0, 2, 3]), Y + X, Y - X), [-1, 2, 3])
    many = mirrored(np.array([[1.0, 2, 3], [4, 5, 6]]), Y, -Y)
    assert_allclose(many, [[1, -2, 3], [4, -5, 6]])


@pytest.mark.parametrize(("height", "direction"), [(0.5, Y), (-0.5, -Y)])
def test_a_pose_shows_the_side_the_hinge_and_how_much(height: float, direction: Any) -> None:
    rig = arm(height)
    (bend,) = in_pose([LIMB], rig.world)
    assert_allclose(bend.direction, direction, atol=1e-12)
    # A positive turn about the hinge flexes: the end comes nearer to the root.
    assert_allclose(bend.hinge, np.cross(direction, X), atol=1e-12)
    assert bend.source == "pose"
    assert bend.sine == pytest.approx(0.8)  # of twice the angle whose tangent is a half


def test_a_bend_towards_a_direction_is_square_to_the_limb_and_none_along_it() -> None:
    rig = arm(0.5)
    bend = towards(LIMB, rig.world, np.array([5.0, 0, 5]), "facing", 0.3)
    assert bend is not None
    assert_allclose(bend.direction, Z, atol=1e-12)
    assert_allclose(bend.hinge, np.cross(Z, X), atol=1e-12)
    assert (bend.source, bend.sine) == ("facing", 0.3)
    assert towards(LIMB, rig.world, np.array([1.0, 0.09, 0]), "facing", 0.3) is None
    assert towards(LIMB, rig.world, np.array([1.0, 0.11, 0]), "facing", 0.3) is not None


@pytest.mark.parametrize(
    ("limb", "looks"),
    [
        (-Y, Z),  # it hangs: ahead
        (X, Z),
        (Z, Y),  # stretched out ahead: up
        (-Z, -Y),  # back: down
        (Z + 0.9 * Y, None),
        (Z + 1.1 * Y, Z),  # not nearer than 45°
    ],
)
def test_where_a_body_looks_goes_with_a_limb_that_is_stretched_out(limb: Any, looks: Any) -> None:
    found = facing_along(limb, Z, Y)
    if looks is None:
        assert np.linalg.norm(found - Z) > 0.5
    else:
        assert_allclose(found, looks, atol=1e-9)
    assert np.linalg.norm(found) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("degrees", "direction", "sine"),
    [
        ([0, 30, 90], -Y, 0.5),  # an elbow that turns by so much is below the line
        ([0, -30, -90], Y, 0.5),
        ([0, 30, 3], -Y, 0.5),  # what is clearly bent is heard alone
        ([0, 0, 0], None, None),
        ([30, -30, 0], None, None),  # no one hinge
    ],
)
def test_keys_of_clips_agree_on_a_hinge_or_say_nothing(degrees: Any, direction: Any, sine: Any) -> None:
    rig = arm(0.0, degrees)
    (bend,) = in_motion(rig, [LIMB], rig.world, None)
    if direction is None:
        assert bend is None
    else:
        assert bend is not None
        assert_allclose(bend.direction, direction, atol=1e-9)
        assert (bend.source, bend.sine) == ("clips", pytest.approx(sine))


def test_the_other_pose_of_a_file_is_heard_too() -> None:
    rig, other = arm(0.0), arm(0.5)
    (bend,) = in_motion(rig, [LIMB], rig.world, other.world)
    assert bend is not None
    assert_allclose(bend.direction, Y, atol=1e-9)
    assert bend.source == "other pose"


def test_a_limb_is_looked_at_in_one_clip_without_the_tracks_of_the_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rig = arm(0.5, [0, 90, 180])
    rig = replace(rig, clips=(*rig.clips, *(Clip(f"{k}", rig.clips[0].tracks) for k in range(9))))
    copied: list[Column] = []
    moved = Column.moved
    monkeypatch.setattr(Column, "moved", lambda self, place: copied.append(self) or moved(self, place))
    for clip in rig.clips:
        crossings(rig, LIMB, clip, 0.1)
    assert len(copied) == len(rig.clips)


def test_times_at_which_a_limb_is_straight_or_bends_the_other_way() -> None:
    rig = arm(0.0, [40, 2, 30, -30, -40, 1, 50])
    found = crossings(rig, LIMB, rig.clips[0], 0.1)
    assert found == [(1.0, "straight"), (3.0, "flipped"), (5.0, "straight"), (6.0, "flipped")]
    assert crossings(rig, LIMB, rig.clips[0], 0.01) == [(3.0, "flipped"), (5.0, "flipped")]
    assert crossings(rig, LIMB, Clip("none", ()), 0.1) == []
