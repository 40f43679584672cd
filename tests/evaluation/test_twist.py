"""add-twist: twist joints along bones, by swing and twist."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_allclose
from places import one_in
from rigs import chain, random_rig
from strategies import directions, quaternions

from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.evaluation.twist_joints import driver_path, twist_joints, with_stored_rest
from rigtri.formats import read
from rigtri.maths.quaternions import (
    IDENTITY,
    conjugate,
    from_axis_angle,
    multiply,
    rotate,
    rotation_angle,
    twist_angle,
)
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.animation import Clip, Track
from rigtri.model.metadata import TwistRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import WeightRedistribution
from rigtri.model.skin_weights import shared
from rigtri.operations.add_twist.key_baking import BOUND, _before_steps
from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.recognition.limbs import Limb
from rigtri.report import Report

# Upper arm, forearm, hand and a finger, along x.
ARM = chain((0, 0, 0), (4, 0, 0), (8, 0, 0), (9, 0, 0))
LOWER = AddTwistOptions(joint=("b",), to=("c",), count=3, lower=True)
UPPER = AddTwistOptions(joint=("a",), to=("b",), count=3, upper=True)
X, Y = np.array([1.0, 0, 0]), np.array([0.0, 1, 0])


def turning(rig: Rig, joint: str, *turns: Floats, mode: str = "LINEAR") -> Rig:
    """The rig with a clip that turns one joint, a key a second."""
    times = np.arange(len(turns), dtype=np.float64)
    node = rig.find(joint)
    values = np.array([multiply(rig.rotation[node], turn) for turn in turns])
    track = Track(node, "rotation", mode, times, values)  # type: ignore[arg-type]
    return replace(rig, clips=(Clip("turn", (track,)),))


def angles(rig: Rig, time: float) -> list[float]:
    """How far each twist joint turns about x in the clip, in degrees."""
    local = locals_at(rig, rig.clips[0], [time])[0]
    return [
        float(np.degrees(np.arctan2(local[t.node, 1, 2], local[t.node, 1, 1]))) for t in twist_joints(rig)
    ]


@pytest.mark.ci
@given(quaternions, directions)
def test_swing_after_twist_is_the_rotation(q: Floats, axis: Floats) -> None:
    axis = normalise(axis)
    twist = from_axis_angle(axis, twist_angle(q, axis))
    swing = multiply(q, conjugate(twist))
    # The twist leaves the axis, the swing takes it to where the turn does, about an axis across it.
    assert_allclose(rotate(twist, axis), axis, atol=1e-9)
    assert_allclose(rotate(swing, axis), rotate(q, axis), atol=1e-9)
    assert_allclose(twist_angle(swing, axis), 0.0, atol=1e-6)


def test_a_swing_by_half_a_turn_has_no_twist() -> None:
    for q in ([0, 1, 0, 0], [0, 0, -1, 0], [0.0, 0.6, 0.8, 0]):
        assert twist_angle(q, X) == 0.0
    assert_allclose(twist_angle(multiply(from_axis_angle(Y, np.pi), from_axis_angle(X, 0.5)), X), 0.0)


def test_a_rotation_and_its_negative_have_one_twist() -> None:
    q = from_axis_angle(X, np.radians([30, -30, 179, -179]))
    assert_allclose(np.degrees(twist_angle(q, X)), [30, -30, 179, -179])
    assert_allclose(np.degrees(twist_angle(-q, X)), [30, -30, 179, -179])


def test_n_twist_joints_take_their_share_of_the_twist_and_none_of_the_swing() -> None:
    turn = multiply(from_axis_angle(Y, 0.7), from_axis_angle(X, np.radians(80)))
    rig = add_twist(turning(ARM, "c", IDENTITY, turn), options=LOWER)
    assert_allclose(angles(rig, 1.0), [20, 40, 60], atol=1e-6)
    assert_allclose(angles(rig, 0.0), 0.0, atol=1e-12)
    world = worlds(rig, locals_at(rig, rig.clips[0], [1.0]))[0]
    for twist in twist_joints(rig):  # the bone's line stays: no swing
        assert_allclose(world[twist.node, 0, :3], X, atol=1e-12)


def test_an_upper_bone_loses_its_twist_towards_its_root_and_keeps_its_swing() -> None:
    swing = from_axis_angle(Y, 0.7)
    turn = multiply(swing, from_axis_angle(X, np.radians(80)))
    rig = add_twist(turning(ARM, "a", IDENTITY, turn), options=UPPER)
    assert_allclose(angles(rig, 1.0), [-60, -40, -20], atol=1e-6)
    world = worlds(rig, locals_at(rig, rig.clips[0], [1.0]))[0]
    for share, twist in zip((0.25, 0.5, 0.75), twist_joints(rig), strict=True):
        seen = multiply(swing, from_axis_angle(X, share * np.radians(80)))
        assert_allclose(world[twist.node, :3, :3], rotate(seen, np.eye(3)), atol=1e-9)


def test_twist_joints_stand_along_the_bone_in_its_joints_axes() -> None:
    rig = add_twist(ARM, options=LOWER)
    nodes = [t.node for t in twist_joints(rig)]
    assert_allclose(rig.world[nodes, 3, :3], [[5, 0, 0], [6, 0, 0], [7, 0, 0]])
    assert_allclose(rig.rotation[nodes], np.tile(IDENTITY, (3, 1)), atol=1e-12)
    assert [int(rig.parents[node]) for node in nodes] == [1, 1, 1]
    assert rig.skins[0].joints.tolist()[-3:] == nodes
    bind = rig.skins[0].inverse_bind[-3:, 3, :3]
    assert_allclose(bind, [[-5, 0, 0], [-6, 0, 0], [-7, 0, 0]], atol=1e-12)


@pytest.mark.parametrize("seed", one_in(3, range(12)))
def test_metadata_alone_lists_what_the_keys_hold(seed: int) -> None:
    rig = random_rig(seed, joints=8)
    bones = [(k, int(p)) for k, p in enumerate(rig.parents) if p >= 0 and not rig.has_matrix[[k, p]].any()]
    child, joint = bones[seed % len(bones)]
    named = {"joint": (f"j{joint}",), "to": (f"j{child}",)}
    out = add_twist(rig, options=AddTwistOptions(**named, upper=seed % 2 > 0, lower=seed % 2 == 0))
    for twist in twist_joints(out):
        for times in ([0.0, 0.4, 1.0], [0.1, 0.3, 0.77]):
            local = locals_at(out, out.clips[0], times)
            off = rotation_angle(multiply(conjugate(twist.rotations(local)), _turns(local[:, twist.node])))
            assert off.max() < 40 * BOUND  # a random spline jumps between keys as no clip does
        at_keys = locals_at(out, out.clips[0], [0.0, 0.4, 1.0])
        off = rotation_angle(multiply(conjugate(twist.rotations(at_keys)), _turns(at_keys[:, twist.node])))
        assert off.max() < 1e-6


def _turns(local: Floats) -> Floats:
    from rigtri.maths.matrices import nearest_rotation
    from rigtri.maths.quaternions import from_axes

    return from_axes(nearest_rotation(local))


def test_a_mirrored_joint_rotates_its_twist_joints_the_other_way() -> None:
    mirrored = replace(ARM, scale=ARM.scale * [[-1], [1], [1], [1]])
    turn = multiply(from_axis_angle(Y, 0.7), from_axis_angle(X, np.radians(80)))
    rig = add_twist(turning(mirrored, "a", IDENTITY, turn), options=UPPER)
    straight = add_twist(turning(ARM, "a", IDENTITY, turn), options=UPPER)
    for one, other in zip(twist_joints(rig), twist_joints(straight), strict=True):
        world = [worlds(r, locals_at(r, r.clips[0], [1.0]))[0] for r in (rig, straight)]
        assert_allclose(world[0][one.node, :3, :3], -world[1][other.node, :3, :3], atol=1e-9)


def test_the_way_from_a_driver_goes_up_to_the_joint_whose_bone_it_twists() -> None:
    """Or, for an upper bone, over what holds the driver's axes and no further."""
    assert driver_path(ARM, 3, 0) == (3, 2, 1)
    assert driver_path(ARM, 1, 0) == (1,)
    assert driver_path(ARM, 3, -1) == (3,)
    held = replace(ARM, metadata={2: {"type": "frame", "joint": "d"}, 1: {"type": "frame", "joint": "c"}})
    assert held.holders == {1, 2}
    assert driver_path(held, 3, -1) == (3, 2, 1)
    with pytest.raises(GeometryError, match="'c' does not lie below 'd'"):
        driver_path(ARM, 2, 3)


def test_between_keys_a_twist_joint_is_off_by_less_than_the_bound() -> None:
    first = multiply(from_axis_angle([0, 1, 1], 1.2), from_axis_angle(X, 1.5))
    rig = add_twist(turning(ARM, "c", IDENTITY, first, from_axis_angle(Y, -1.4)), options=LOWER)
    times = np.linspace(-0.5, 2.5, 997)
    local = locals_at(rig, rig.clips[0], times)
    for twist in twist_joints(rig):
        shown = _turns(local[:, twist.node])
        off = rotation_angle(multiply(conjugate(twist.rotations(local)), shown))
        assert off.max() < 1.2 * BOUND
        (track,) = [t for t in rig.clips[0].tracks if t.node == twist.node]
        assert 3 < len(track.times) < 200


def test_a_clip_whose_times_are_shared_gets_no_more_and_reports_how_far_off_it_is() -> None:
    rig = turning(ARM, "c", IDENTITY, multiply(from_axis_angle([0, 1, 1], 2.0), from_axis_angle(X, 1.5)))
    rig = replace(rig, clips=(replace(rig.clips[0], fixed_times=True),))
    report = Report()
    out = add_twist(rig, options=LOWER, report=report)
    assert {len(track.times) for track in out.clips[0].tracks} == {2}
    assert {notice.code for notice in report.warnings} == {"twist-between-keys"}
    assert report.added[0]["clips"][0]["off"] > BOUND


def test_steps_stay_steps() -> None:
    rig = add_twist(turning(ARM, "c", IDENTITY, from_axis_angle(X, 1.0), mode="STEP"), options=LOWER)
    assert {track.interpolation for track in rig.clips[0].tracks} == {"STEP"}
    assert_allclose(angles(rig, 0.99), 0.0, atol=1e-9)
    assert_allclose(angles(rig, 1.0), np.degrees([0.25, 0.5, 0.75]), atol=1e-6)


def test_a_twist_that_jumps_is_reported() -> None:
    turns = [from_axis_angle(X, np.radians(angle)) for angle in (170, 190)]
    report = Report()
    add_twist(turning(ARM, "c", *turns), options=LOWER, report=report)
    assert {notice.code for notice in report.warnings} == {"twist-jumps"}


def test_a_clip_that_rotates_no_driver_gets_no_keys() -> None:
    rig = turning(ARM, "d", IDENTITY, from_axis_angle(X, 1.0))
    assert len(add_twist(rig, options=LOWER).clips[0].tracks) == 1
    rig = turning(ARM, "c", IDENTITY, from_axis_angle(X, 1.0))
    assert len(add_twist(rig, options=replace(LOWER, keys=False)).clips[0].tracks) == 1


def test_weights_and_axis_are_the_users() -> None:
    rig = turning(ARM, "c", IDENTITY, from_axis_angle(X, np.radians(80)))
    out = add_twist(rig, options=replace(LOWER, weights=(-1.0, 0.0, 0.5)))
    assert_allclose(angles(out, 1.0), [-80, 0, 40], atol=1e-6)
    out = add_twist(rig, options=replace(LOWER, axis=(0.0, 1.0, 0.0)))
    assert_allclose(angles(out, 1.0), 0.0, atol=1e-6)


def test_a_limb_gets_both_bones_unless_one_is_named() -> None:
    limb = Limb(0, 1, 2)
    for options, bones in (
        (AddTwistOptions(limb=(limb,)), ["a", "a", "b", "b"]),
        (AddTwistOptions(limb=(limb,), upper=True), ["a", "a"]),
        (AddTwistOptions(limb=(limb,), lower=True), ["b", "b"]),
    ):
        assert [note["joint"] for note in add_twist(ARM, options=options).metadata.values()] == bones


def test_a_second_run_finds_its_joints_and_changes_nothing() -> None:
    turn = multiply(from_axis_angle(Y, 0.7), from_axis_angle(X, 1.0))
    once = add_twist(turning(ARM, "c", IDENTITY, turn), options=LOWER)
    twice = add_twist(once, options=LOWER)
    assert twice.names == once.names
    assert twice.clips is once.clips
    moved = add_twist(once, options=replace(LOWER, count=4))
    assert_allclose(moved.world[[t.node for t in twist_joints(moved)], 3, 0], [4.8, 5.6, 6.4, 7.2])
    with pytest.raises(UsageError, match="4 twist joints already"):
        add_twist(moved, options=LOWER)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (AddTwistOptions(), "name the bones"),
        (replace(LOWER, count=0), "at least 1 and at most 64"),
        (replace(LOWER, weights=(0.5,)), "each of 3 twist joints, not 1"),
        (replace(LOWER, weights=(0.5, 1.5, 0.0)), "between -1 and 1"),
        (AddTwistOptions(limb=(Limb(0, 1, 2),), weights=(0.1, 0.2)), "--upper or --lower"),
        (replace(LOWER, axis=(0.0, 0.0, 0.0)), "not a valid direction"),
        (replace(LOWER, name="{bone}"), "tokens"),
        (AddTwistOptions(joint=("b",), to=("b",)), "both ends"),
        (AddTwistOptions(joint=("c",), to=("b",)), "below"),
    ],
)
def test_what_fits_no_twist_is_reported(options: AddTwistOptions, words: str) -> None:
    with pytest.raises(UsageError, match=words):
        add_twist(ARM, options=options)


def test_a_bone_without_length_is_an_error() -> None:
    rig = chain((0, 0, 0), (4, 0, 0), (4, 0, 0))
    with pytest.raises(GeometryError, match="at one place"):
        add_twist(rig, options=AddTwistOptions(joint=("b",), to=("c",)))


# --- weights along a bone


SPREAD = WeightRedistribution(
    0, np.array([1, 4, 5]), np.array([0.0, 0.25, 0.5]), np.zeros(3), np.array([4.0, 0, 0])
)


def test_a_bones_weight_goes_to_the_two_nearest_along_it() -> None:
    points = np.array([[x, 7.0, 0] for x in (-1, 0, 0.5, 1, 1.75, 2, 9)])
    joints, weights = np.tile([1, 2, 0, 0], (7, 1)), np.tile([0.6, 0.4, 0, 0], (7, 1))
    new_joints, new = shared(SPREAD, points, joints, weights)

    def of(joint: int) -> Floats:
        return np.where(new_joints == joint, new, 0.0).sum(axis=1)

    assert_allclose(of(1), [0.6, 0.6, 0.3, 0, 0, 0, 0], atol=1e-7)
    assert_allclose(of(4), [0, 0, 0.3, 0.6, 0.15, 0, 0], atol=1e-7)
    assert_allclose(of(5), [0, 0, 0, 0, 0.45, 0.6, 0.6], atol=1e-7)
    assert_allclose(of(2), 0.4)
    assert new.shape == (7, 4)


def test_the_sum_stays_and_a_second_time_changes_no_bit() -> None:
    random = np.random.default_rng(3)
    points = random.uniform(-1, 5, (500, 3))
    joints = np.array([random.permutation(4) for _ in range(500)])
    weights = random.dirichlet(np.ones(4), 500).astype(np.float32).astype(np.float64)
    once = shared(SPREAD, points, joints, weights)
    assert once[0].shape == (500, 5)
    assert_allclose(once[1].sum(axis=1), weights.sum(axis=1), atol=1e-7)
    single = once[1].astype(np.float32).astype(np.float64)
    twice = shared(SPREAD, points, once[0], single)
    assert np.array_equal(twice[0], once[0])
    assert np.array_equal(twice[1], single)


def test_whole_numbers_stay_whole_and_their_sum_too() -> None:
    random = np.random.default_rng(4)
    points = random.uniform(-1, 5, (300, 3))
    weights = random.multinomial(255, [0.4, 0.3, 0.2, 0.1], 300).astype(np.float64)
    joints = np.tile([1, 2, 3, 0], (300, 1))
    once = shared(SPREAD, points, joints, weights, units=True)
    assert (once[1] == np.rint(once[1])).all()
    assert (once[1].sum(axis=1) == 255).all()
    twice = shared(SPREAD, points, *once, units=True)
    assert all(np.array_equal(a, b) for a, b in zip(once, twice, strict=True))


def test_where_a_point_may_have_no_more_joints_the_nearest_takes_all() -> None:
    points = np.array([[0.3, 0, 0], [0.3, 0, 0]])
    joints = np.array([[1, 2, 3, 0], [1, 2, 0, 0]])
    weights = np.array([[0.4, 0.3, 0.2, 0.1], [0.5, 0.5, 0, 0]])
    new_joints, new = shared(replace(SPREAD, most=4), points, joints, weights)
    assert new_joints.shape == (2, 4)
    assert (new[0] > 0).sum() == 4
    assert (new[1] > 0).sum() == 3


@pytest.mark.parametrize(
    ("name", "words"), [("hand_L", "another node is called so"), ("tw", "several twist joints")]
)
def test_a_name_that_is_taken_or_given_twice_is_refused(name: str, words: str, samples: Path) -> None:
    options = AddTwistOptions(joint=("forearm_L",), to=("hand_L",), count=2, name=name)
    with pytest.raises(UsageError, match=words):
        add_twist(read(samples / "biped.glb").rig, options=options)


def test_twist_counts_from_the_rest_pose_of_before() -> None:
    """Where joints rest otherwise now; twist joints whose joints rest as they did keep no rest."""
    rig = add_twist(add_twist(ARM, options=LOWER), options=UPPER)
    turned = rig.rotation.copy()
    turned[rig.find("c")] = from_axis_angle(X, 0.75)
    now = with_stored_rest(replace(rig, rotation=turned), rig)
    of = {record.number: record for record in now.records(TwistRecord).values() if record.driver == "c"}
    assert {record.rest for record in of.values()} == {(0.0, 0.0, 0.0, 1.0)}
    assert {record.rest for record in now.records(TwistRecord).values() if record.driver == "a"} == {None}
    lower = [joint for joint in twist_joints(now) if joint.path[0] == rig.find("c")]
    assert [joint.angles(now.local) for joint in lower] == pytest.approx([0.75] * 3)
    assert with_stored_rest(rig, rig) is rig


@pytest.mark.parametrize("mirrored", [(-1, 1, 1), (1, -1, 1), (-1, -1, -1)])
def test_twist_of_a_mirrored_joint_counts_from_the_rest_pose_of_before(
    mirrored: tuple[int, int, int],
) -> None:
    """Before, once it rested otherwise, its twist joints turned to the other side in all clips."""
    rig = add_twist(
        replace(ARM, scale=ARM.scale * [mirrored, (1, 1, 1), (1, 1, 1), (1, 1, 1)]), options=UPPER
    )
    turned = rig.rotation.copy()
    turned[rig.find("a")] = multiply(from_axis_angle(Y, 0.7), from_axis_angle(X, 0.6))
    rested = replace(rig, rotation=turned)
    now = with_stored_rest(rested, rig)
    assert now is not rested
    for before, after in zip(twist_joints(rig), twist_joints(now), strict=True):
        assert_allclose(after.rotations(rested.local), before.rotations(rested.local), atol=1e-12)


@pytest.mark.parametrize("options", [LOWER, UPPER])
def test_twist_is_about_the_bone_as_it_lay_before_it_ended_elsewhere(options: AddTwistOptions) -> None:
    """Before, a rest pose with the end to the side of the bone changed what twist joints do in all clips."""
    rig = add_twist(ARM, options=options)
    place = rig.translation.copy()
    place[rig.find(options.to[0])] += (0.0, 0.4, 0.3)
    now = with_stored_rest(replace(rig, translation=place), rig)
    for before, after in zip(twist_joints(rig), twist_joints(now), strict=True):
        assert_allclose(after.own_axis, before.own_axis, atol=1e-12)
        assert_allclose(after.axis, before.axis, atol=1e-12)
    assert add_twist(now, options=options).metadata == now.metadata  # a second run, too
    longer = replace(rig, translation=rig.translation * 1.5)  # along the line
    assert {record.axis for record in with_stored_rest(longer, rig).records(TwistRecord).values()} == {None}


def test_a_step_has_a_key_just_before_it_but_for_the_first() -> None:
    times, values = np.array([0.0, 1.0, 2.0]), np.tile([0.0, 0, 0, 1], (3, 1))
    steps = Track(0, "rotation", "STEP", times[:2], values[:2])
    line = Track(1, "rotation", "LINEAR", times, values)
    before = float(np.nextafter(np.float32(1.0), np.float32(0.0)))
    assert _before_steps(times, [line, steps]).tolist() == [0.0, before, 1.0, 2.0]


@pytest.mark.parametrize("lost", ["b", "c"])
def test_a_twist_joint_whose_joint_was_renamed_is_named(lost: str) -> None:
    rig = add_twist(ARM, options=LOWER, report=Report())
    renamed = replace(rig, names=tuple("other" if name == lost else name for name in rig.names))
    with pytest.raises(GeometryError, match=f"The twist joint 'b_twist_1' takes its twist from '{lost}'"):
        twist_joints(renamed)
