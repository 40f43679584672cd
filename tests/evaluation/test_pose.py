"""Clips at given times, skins and points: laws, then numbers one can check by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from characters import ARM, HIPS, SPINE, character
from numpy.testing import assert_allclose, assert_array_equal
from rigs import chain, random_rig, rig_of

from rigtri.evaluation import bind_pose, sampling, skinning
from rigtri.maths.quaternions import IDENTITY, from_axis_angle, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig

QUARTER = from_axis_angle([0, 0, 1], np.pi / 2)


def one_track(path: str, interpolation: str, values: object, times: tuple[float, ...] = (1.0, 3.0)) -> Track:
    return Track(0, path, interpolation, np.array(times), np.array(values, dtype=float))  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(5))
def test_one_time_and_many_are_the_same_call(seed: int) -> None:
    rig = random_rig(seed)
    times = np.linspace(-0.5, 1.5, 9)
    together = sampling.locals_at(rig, rig.clips[0], times)
    for k, time in enumerate(times):
        assert_array_equal(sampling.locals_at(rig, rig.clips[0], time)[0], together[k])


@pytest.mark.parametrize("seed", range(5))
def test_a_motion_gives_what_the_clip_gives(seed: int) -> None:
    rig = random_rig(seed)
    times = np.linspace(0, 1, 7)
    motion = sampling.Motion(rig, rig.clips[0])
    assert_array_equal(motion.locals_at(times), sampling.locals_at(rig, rig.clips[0], times))
    assert_array_equal(motion.locals_at(times[3:]), motion.locals_at(times)[3:])


@pytest.mark.parametrize("normalised", [True, False])
def test_clips_evaluated_as_one_are_what_each_is_alone(normalised: bool) -> None:
    """Each has tracks, key times and interpolations of its own; what one leaves alone may keep a matrix."""
    rig, others = random_rig(1), [random_rig(seed).clips[0] for seed in (2, 3)]
    count = len(rig)
    lone = [Clip("lone", [t for t in others[0].tracks if t.node == count - 1]), Clip("none", ())]
    known = [replace(c, tracks=[t for t in c.tracks if t.node < count - 1]) for c in (rig.clips[0], *others)]
    clips = [*known, *lone]
    has_matrix, matrix = rig.has_matrix.copy(), rig.matrix.copy()
    has_matrix[-1], matrix[-1] = True, np.arange(16.0).reshape(4, 4)
    rig = replace(rig, has_matrix=has_matrix, matrix=matrix)
    times = [np.linspace(-0.5, 1.5, 3 + 4 * k) for k in range(len(clips))]
    together = sampling.Motion(rig, *clips).locals_at(*times, normalised=normalised)
    alone = [
        sampling.locals_at(rig, clip, some, normalised=normalised)
        for clip, some in zip(clips, times, strict=True)
    ]
    assert together.tobytes() == np.concatenate(alone).tobytes()


def test_tracks_that_share_their_times_move_as_if_they_did_not() -> None:
    held = character()
    (clip,) = held.rig.clips
    apart = replace(clip, tracks=tuple(replace(t, times=t.times.copy()) for t in clip.tracks))
    times = np.linspace(-1, 3, 11)
    assert_array_equal(sampling.locals_at(held.rig, clip, times), sampling.locals_at(held.rig, apart, times))


def test_the_order_of_tracks_does_not_matter() -> None:
    held = character()
    (clip,) = held.rig.clips
    back = replace(clip, tracks=clip.tracks[::-1])
    times = np.linspace(0, 2, 5)
    assert_array_equal(sampling.locals_at(held.rig, clip, times), sampling.locals_at(held.rig, back, times))


def test_what_no_track_drives_stays_at_rest() -> None:
    held = character()
    local = sampling.locals_at(held.rig, held.rig.clips[0], [0.3, 1.0])
    driven = {track.node for track in held.rig.clips[0].tracks if track.path != "weights"}
    still = [node for node in range(len(held.rig)) if node not in driven]
    assert_array_equal(local[0, still], held.rig.normalised_local[still])


def test_values_are_held_before_the_first_and_after_the_last_key() -> None:
    track = one_track("translation", "LINEAR", [[1, 0, 0], [3, 0, 0]])
    assert_allclose(sampling.sample(track, [0.0, 1.0, 2.0, 3.0, 9.0])[:, 0], [1, 1, 2, 3, 3])


def test_step_waits_for_the_next_key() -> None:
    track = one_track("translation", "STEP", [[1, 0, 0], [3, 0, 0]])
    assert_allclose(sampling.sample(track, [0.0, 2.999, 3.0, 4.0])[:, 0], [1, 1, 3, 3])


def test_rotations_interpolate_along_the_shorter_arc() -> None:
    track = one_track("rotation", "LINEAR", [IDENTITY, -QUARTER])
    (halfway,) = sampling.sample(track, 2.0)
    expected = from_axis_angle([0, 0, 1], np.pi / 4)
    assert_allclose(np.abs(halfway @ expected), 1.0, atol=1e-12)


def test_a_cubic_spline_passes_through_its_keys_along_its_tangents() -> None:
    # p(t) = t² on [1, 3]: values 1 and 9, slopes 2 and 6; a cubic holds a parabola exactly.
    keys = [[[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[6, 0, 0], [9, 0, 0], [0, 0, 0]]]
    track = one_track("translation", "CUBICSPLINE", keys)
    assert_allclose(sampling.sample(track, [1.0, 1.5, 2.0, 3.0])[:, 0], [1, 2.25, 4, 9])


def test_one_key_is_the_same_at_all_times() -> None:
    track = one_track("translation", "LINEAR", [[5, 6, 7]], times=(2.0,))
    assert_allclose(sampling.sample(track, [-1.0, 2.0, 8.0]), [[5, 6, 7]] * 3)


@pytest.mark.parametrize("times", [(1.0,), (1.0, 3.0)], ids=["one key", "two keys"])
def test_each_number_of_a_track_at_all_times_is_one_row_of_memory(times: tuple[float, ...]) -> None:
    track = one_track("translation", "LINEAR", [[5, 6, 7]] * len(times), times)
    assert sampling.sample(track, np.arange(4.0)).transpose().flags.c_contiguous


def test_a_rotation_that_is_not_unit_scales_only_when_taken_raw() -> None:
    rig = rig_of(["a"], [-1], np.zeros((1, 3)), 2.0 * QUARTER[np.newaxis])
    assert_allclose(rig.normalised_local[0, 0, :3], [0, 1, 0], atol=1e-12)
    assert np.abs(rig.local[0, :3, :3]).max() > 2


def test_key_times_come_sorted_and_each_once() -> None:
    held = character()
    assert_allclose(sampling.key_times(held.rig.clips[0]), [0, 0.25, 0.5, 1, 1.25, 2])
    assert len(sampling.key_times(Clip("empty", ()))) == 0


def test_a_child_moves_with_its_parent() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    turning = Clip("turn", (one_track("rotation", "LINEAR", [IDENTITY, QUARTER]),))
    world = sampling.worlds(rig, sampling.locals_at(rig, turning, 3.0))
    assert_allclose(world[0, :, 3, :3], [[0, 0, 0], [0, 1, 0], [0, 2, 0]], atol=1e-12)


def test_skin_matrices_are_the_identity_in_the_bind_pose() -> None:
    rig = chain((0, 0, 0), (1, 2, 0), (2, 0, 3))
    assert_allclose(
        skinning.skin_matrices(rig.skins[0], rig.world), np.tile(np.eye(4), (3, 1, 1)), atol=1e-12
    )


def bent() -> tuple[Rig, Floats]:
    """Two joints at 0 and 1 on x; the second turned by a quarter about z."""
    rig = chain((0, 0, 0), (1, 0, 0))
    turning = Clip("turn", (replace(one_track("rotation", "LINEAR", [IDENTITY, QUARTER]), node=1),))
    return rig, sampling.worlds(rig, sampling.locals_at(rig, turning, 3.0))


def skinned(weights: list[float], **more: bool) -> Mesh:
    return Mesh("m", 0, np.array([[2.0, 0, 0]]), 0, np.array([[0, 1]]), np.array([weights]), **more)


@pytest.mark.parametrize(
    ("weights", "place"),
    [
        ([1.0, 0.0], [2, 0, 0]),
        ([0.0, 1.0], [1, 1, 0]),
        ([0.5, 0.5], [1.5, 0.5, 0]),
        ([2.0, 2.0], [1.5, 0.5, 0]),  # scaled to sum to 1
        ([0.0, 0.0], [2, 0, 0]),  # follows the first joint
    ],
)
def test_points_follow_their_joints_by_weight(weights: list[float], place: list[float]) -> None:
    rig, world = bent()
    assert_allclose(
        skinning.deformed(skinned(weights), rig, world, np.zeros((1, 0)))[0, 0], place, atol=1e-12
    )


def test_dual_quaternions_keep_the_distance_that_linear_blending_loses() -> None:
    rig, world = bent()
    (point,) = skinning.deformed(skinned([0.5, 0.5], dual_quaternion=True), rig, world, np.zeros((1, 0)))[0]
    assert_allclose(point, [1 + np.sqrt(0.5), np.sqrt(0.5), 0], atol=1e-12)


def test_dual_quaternions_include_scale_and_mirroring() -> None:
    rig = replace(random_rig(0), clips=())
    body = replace(character().drawn[0], node=0, joints=np.full((40, 1), 2), weights=np.ones((40, 1)))
    world = rig.world[np.newaxis]
    both = (
        skinning.deformed(replace(body, dual_quaternion=dual), rig, world, np.zeros((1, 0)))
        for dual in (False, True)
    )
    assert_allclose(*both, atol=1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_both_ways_of_skinning_agree_for_one_joint(seed: int) -> None:
    held = character(seed)
    body = replace(held.drawn[0], joints=held.drawn[0].joints[:, :1], weights=np.ones((40, 1)))
    world = sampling.worlds(held.rig, sampling.locals_at(held.rig, held.rig.clips[0], [0.1, 0.7]))
    both = (
        skinning.deformed(replace(body, dual_quaternion=dual), held.rig, world, np.zeros((2, 0)))
        for dual in (False, True)
    )
    assert_allclose(*both, atol=1e-9)


def test_morphs_follow_their_track() -> None:
    held = character()
    face = held.drawn[2]
    times = np.array([0.0, 0.625, 5.0])
    morph = sampling.morph_weights(face, held.rig.clips[0], times)
    assert_allclose(morph[:, 0], [0, 0.5, 1])
    world = np.broadcast_to(np.eye(4), (3, 8, 4, 4))
    points = skinning.deformed(face, held.rig, world, morph)
    assert_allclose(points[1], face.points + 0.5 * face.morphs[0])


def test_not_a_number_in_a_weight_stays_with_its_point() -> None:
    held = character()
    weights = held.drawn[0].weights.copy()
    weights[7, 0] = np.nan
    body = replace(held.drawn[0], weights=weights)
    points = skinning.deformed(body, held.rig, held.rig.world[np.newaxis], np.zeros((1, 0)))
    assert_array_equal(np.flatnonzero(np.isnan(points[0]).any(axis=1)), [7])


def test_in_the_bind_pose_points_are_where_the_mesh_has_them() -> None:
    held = character()
    rig = held.rig
    tracks = (replace(rig.clips[0].tracks[1], values=unit(np.ones((4, 4)))),)
    moved = sampling.worlds(rig, sampling.locals_at(rig, Clip("x", tracks), 0.0))[0]
    assert not np.allclose(moved[[HIPS, SPINE, ARM]], rig.world[[HIPS, SPINE, ARM]])
    at_bind = bind_pose.bind_worlds(rig, rig.skins[0])
    assert_allclose(
        skinning.deformed(held.drawn[0], rig, at_bind[np.newaxis], np.zeros((1, 0)))[0], held.drawn[0].points
    )


def test_points_take_nothing_from_joints_without_weight_and_the_sum_of_the_others() -> None:
    """Σ w·(p·M) over the named joints, a joint named twice included; NaN stays with whom it moves."""
    from rigtri.evaluation.skinning import blended

    random = np.random.default_rng(2)
    points, matrices = random.normal(size=(5, 3)), random.normal(size=(3, 4, 4, 4))
    matrices[..., 3] = [0, 0, 0, 1]
    joints = np.array([[0, 1], [2, 2], [1, 3], [0, 3], [2, 0]])
    weights = np.array([[0.25, 0.75], [0.5, 0.5], [1.0, 0.0], [0.0, 1.0], [0.3, 0.7]])
    matrices[:, 3] = np.nan
    moved = blended(points, matrices, joints, weights)
    assert np.isnan(moved[:, 3]).all()
    full = np.concatenate([points, np.ones((5, 1))], axis=1)
    for v in (0, 1, 2, 4):
        used = [(j, w) for j, w in zip(joints[v], weights[v], strict=True) if w]
        wanted = sum(w * (full[v] @ matrices[:, j])[:, :3] for j, w in used)
        assert np.allclose(moved[:, v], wanted, rtol=0, atol=1e-14)


def test_what_joints_move_is_reported_joint_by_joint() -> None:
    joints = np.array([[2, 0], [70_000, 2], [0, 0], [1, -1]])
    weights = np.array([[0.5, 0.5], [1.0, 0.0], [np.nan, 0.25], [0.0, -0.5]])
    for usual in (False, True):
        rows = np.where((joints < 0) | (joints > 2), 1, joints) if usual else joints
        found = list(
            zip(*(x.tolist() for x in Mesh("m", 0, np.zeros((4, 3)), 0, rows, weights).moved), strict=True)
        )
        live = [(int(rows[v, k]), v) for v in range(4) for k in range(2) if weights[v, k] != 0]
        assert found == sorted(live)
