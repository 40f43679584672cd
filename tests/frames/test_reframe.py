"""New axes: nothing that can be seen moves, in any pose; and there and back is nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from rigs import chain, poses, random_rig, random_turns

from rigtri.evaluation.skinning import skin_matrices
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reframe import reframe, split
from rigtri.frames.reoriented_constraints import reoriented_metadata
from rigtri.maths.matrices import from_frame, multiply
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axis_angle, to_axes
from rigtri.maths.quaternions import multiply as then
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.bindings import Bound
from rigtri.model.metadata import OffsetRecord

seeds = st.integers(0, 2**32 - 1)
QUARTER = from_axis_angle([0, 0, 1], np.pi / 2)


def turned_by(turn: Floats, world: Floats) -> Floats:
    return multiply(from_frame(to_axes(turn), np.zeros(3)), world)


@given(seeds)
def test_new_axes_move_no_vertex_in_any_pose(seed: int) -> None:
    rig = random_rig(seed)
    turned = reframe(rig, random_turns(seed, len(rig)))
    (before,), (after,) = rig.skins, turned.skins
    expected = skin_matrices(before, poses(rig))
    assert_allclose(skin_matrices(after, poses(turned)), expected, atol=1e-9)


@given(seeds)
def test_joints_have_the_axes_that_were_requested(seed: int) -> None:
    rig, turn = random_rig(seed), random_turns(seed, 6)
    after = poses(reframe(rig, turn))[:, : len(rig)]
    expected = turned_by(turn, poses(rig))
    # A uniform scale of mixed signs is a half turn: the axes are the same up to their sign.
    assert_allclose(np.abs(after[..., :3, :3]), np.abs(expected[..., :3, :3]), atol=1e-9)
    assert_allclose(after[..., 3, :3], expected[..., 3, :3], atol=1e-9)


@given(seeds)
def test_what_a_joint_shows_stays_where_it_was(seed: int) -> None:
    rig = random_rig(seed)
    turned = reframe(rig, random_turns(seed, len(rig)))
    before, after = poses(rig), poses(turned)
    shown = {int(origin): node for node, origin in enumerate(turned.attachment) if origin >= 0}
    assert set(shown) == set(rig.attachment[rig.attachment >= 0].tolist())
    for origin, node in shown.items():
        assert_allclose(after[:, node], before[:, origin], atol=1e-9)


@given(seeds)
def test_there_and_back_is_where_one_was(seed: int) -> None:
    rig, turn = random_rig(seed), random_turns(seed, 6)
    rig = replace(rig, attachment=np.full(len(rig), -1))
    back = reframe(reframe(rig, turn), conjugate(turn))
    assert_allclose(poses(back), poses(rig), atol=1e-9)
    assert_allclose(back.skins[0].inverse_bind, rig.skins[0].inverse_bind, atol=1e-9)
    for a, b in zip(rig.clips[0].tracks, back.clips[0].tracks, strict=True):
        assert b.times is a.times
        if a.path == "translation":
            assert_allclose(b.values, a.values, atol=1e-12)


@given(seeds)
def test_two_rotations_are_their_product(seed: int) -> None:
    rig, first, second = random_rig(seed), random_turns(seed, 6), random_turns(seed + 1, 6)
    rig = replace(rig, attachment=np.full(len(rig), -1), scale=np.abs(rig.scale))
    one_by_one = reframe(reframe(rig, first), second)

    at_once = reframe(rig, then(first, second))
    assert_allclose(poses(one_by_one), poses(at_once), atol=1e-9)


@given(seeds)
def test_a_rig_that_nothing_reorients_is_the_same_object(seed: int) -> None:
    rig = random_rig(seed)
    assert reframe(rig, np.tile(IDENTITY, (len(rig), 1))) is rig


@given(seeds)
def test_what_is_below_no_reoriented_joint_keeps_its_bits(seed: int) -> None:
    rig = random_rig(seed)
    turn = np.tile(IDENTITY, (len(rig), 1))
    turn[-1] = random_turns(seed, 2)[1]
    turned = reframe(rig, turn)
    touched = {len(rig) - 1, *rig.children[-1]}
    for node in set(range(len(rig))) - touched:
        for field in ("translation", "rotation", "scale", "matrix"):
            assert_array_equal(getattr(turned, field)[node], getattr(rig, field)[node])
    for before, after in zip(rig.clips[0].tracks, turned.clips[0].tracks, strict=True):
        assert after is before or before.node in touched


def test_tangents_rotate_with_their_keys_and_keep_their_length() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    values = np.array([[[0, 0, 0, 5.0], [0, 0, 0, 1.0], [3.0, 0, 0, 0]]] * 2)
    track = Track(0, "rotation", "CUBICSPLINE", np.array([0.0, 1.0]), values)
    rig = replace(rig, clips=(Clip("clip", (track,)),))
    (after,) = reframe(rig, np.stack([QUARTER, IDENTITY])).clips[0].tracks
    half = np.sqrt(0.5)
    expected = [[0, 0, 5 * half, 5 * half], [0, 0, half, half], [3 * half, -3 * half, 0, 0]]
    assert_allclose(after.values, [expected] * 2, atol=1e-15)
    assert after.times is track.times


@pytest.mark.parametrize("seed", range(3))
def test_long_tracks_become_to_the_bit_what_short_ones_do(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rig, deltas = random_rig(seed), random_turns(seed, 6)
    short = reframe(rig, deltas)
    monkeypatch.setattr("rigtri.frames.reframe._LONG", 1)
    for was, now in zip(short.clips, reframe(rig, deltas).clips, strict=True):
        for one, other in zip(was.tracks, now.tracks, strict=True):
            assert_array_equal(one.values, other.values)


def test_a_quarter_turn_about_z_in_numbers() -> None:
    """The child stood at +x of its parent; seen from the turned parent it stands at −y."""
    rig = reframe(chain((0, 0, 0), (1, 0, 0)), np.stack([QUARTER, IDENTITY]))
    assert_allclose(rig.translation[1], [0, -1, 0], atol=1e-15)
    assert_allclose(rig.world[0, :3, :3], [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert_allclose(rig.world[1, :3, :3], np.eye(3), atol=1e-15)


def test_a_vector_that_a_format_keeps_in_a_frame_follows() -> None:
    rig = replace(chain((0, 0, 0), (1, 0, 0)), bound=(Bound(0, np.array([1.0, 0, 0])),))
    (bound,) = reframe(rig, np.stack([QUARTER, IDENTITY])).bound
    assert_allclose(bound.vector, [0, -1, 0], atol=1e-15)


def test_an_attachment_gets_a_node_of_its_own_and_its_morphs_follow() -> None:
    rig = replace(chain((0, 0, 0), (1, 0, 0)), attachment=np.array([0, -1]))
    weights = Track(0, "weights", "STEP", np.array([0.0]), np.array([[1.0]]))
    rig = replace(rig, clips=(Clip("clip", (weights,)),))
    turned = reframe(rig, np.stack([QUARTER, IDENTITY]))
    assert turned.names[2] == "a_payload"
    assert turned.attachment.tolist() == [-1, -1, 0]
    assert turned.clips[0].tracks[0].node == 2
    assert_allclose(turned.world[2], np.eye(4), atol=1e-15)


def test_an_uneven_scale_allows_what_keeps_it_diagonal_and_refuses_the_rest() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    slant = from_axis_angle([1, 2, 3], 1.0)
    about_x = from_axis_angle([1, 0, 0], 1.0)

    def allowed(scale: list[float], turn: Floats) -> bool:
        scaled = replace(rig, scale=np.array([scale, [1.0, 1.0, 1.0]]))
        return bool(ScaleTable.of(scaled).allows(np.stack([turn, IDENTITY]))[0])

    assert allowed([2, 2, 2], slant)
    assert allowed([-2, 2, 2], slant)
    assert allowed([1, 2, 3], QUARTER)
    assert allowed([1, 2, 2], about_x)
    assert not allowed([2, 1, 2], about_x)
    assert not allowed([1, 2, 3], slant)
    with pytest.raises(ValueError, match="would shear"):
        reframe(replace(rig, scale=np.array([[1.0, 2, 3], [1, 1, 1]])), np.stack([slant, IDENTITY]))


def test_a_permuted_scale_goes_to_its_new_axis() -> None:
    rig = replace(chain((0, 0, 0), (1, 0, 0)), scale=np.array([[1.0, 2, 3], [1, 1, 1]]))
    keys = Track(0, "scale", "LINEAR", np.array([0.0, 1.0]), np.array([[1.0, 2, 3], [4, 5, 6]]))
    rig = replace(rig, clips=(Clip("clip", (keys,)),))
    turned = reframe(rig, np.stack([QUARTER, IDENTITY]))
    assert_allclose(turned.scale[0], [2, 1, 3], atol=1e-15)
    assert_allclose(turned.clips[0].tracks[0].values, [[2, 1, 3], [5, 4, 6]], atol=1e-15)
    (before,), (after,) = rig.skins, turned.skins
    assert_allclose(skin_matrices(after, poses(turned)), skin_matrices(before, poses(rig)), atol=1e-12)


@given(seeds)
def test_splits_at_once_are_those_one_after_another(seed: int) -> None:
    rig, turns = random_rig(seed), random_turns(seed, 6)
    chosen = {node: turns[node] for node in np.flatnonzero(turns[:, 3] != 1.0).tolist()}
    one_by_one = rig
    for node in sorted(chosen, reverse=True):  # from the back: the indices before stay
        one_by_one = split(one_by_one, {node: chosen[node]})
    at_once = split(rig, chosen)
    assert at_once.names == one_by_one.names
    assert at_once.labels == one_by_one.labels
    assert at_once.keys == one_by_one.keys
    for array in ("parents", "translation", "rotation", "scale", "matrix", "has_matrix", "attachment"):
        assert_array_equal(getattr(at_once, array), getattr(one_by_one, array))
    assert_array_equal(at_once.skins[0].joints, one_by_one.skins[0].joints)
    for one, other in zip(at_once.clips, one_by_one.clips, strict=True):
        for a, b in zip(one.tracks, other.tracks, strict=True):
            assert (a.node, a.path) == (b.node, b.path)
            assert_array_equal(a.values, b.values)
    assert at_once.metadata.keys() == one_by_one.metadata.keys()


def test_a_chain_split_at_each_joint_alternates_holders_and_joints() -> None:
    rig = chain((0, 0, 0), (0, 1, 0), (0, 2, 0))
    out = split(rig, dict.fromkeys(range(3), QUARTER))
    assert out.names == tuple(n for name in rig.names for n in (f"{name}_orient", name))
    assert out.parents.tolist() == [-1, 0, 1, 2, 3, 4]


@pytest.mark.parametrize(
    ("angle", "scale", "turned"),
    [
        (np.pi / 2, (1.0, 2.0, 3.0), (2.0, 1.0, 3.0)),
        (np.pi / 6, (1.0, 2.0, 3.0), (1.25, 1.75, 3.0)),
        (np.pi / 6, (0.1, 0.1, 0.1), (0.1, 0.1, 0.1)),  # to the bit
    ],
)
def test_an_offset_keeps_its_joints_axes_and_its_scale_along_them(
    angle: float, scale: tuple[float, ...], turned: tuple[float, ...]
) -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    turn = from_axis_angle([0, 0, 1], angle)
    stored = OffsetRecord(kind="fk", joint="b", axes=(0.0, 0.6, 0.0, 0.8), scale=scale)
    delta = np.stack([IDENTITY, turn])
    found = reoriented_metadata(replace(rig, metadata={0: stored.to_dict()}), delta)[0]
    assert_allclose(found["axes"], then(np.array(stored.axes), turn), atol=1e-15)
    assert_allclose(found["scale"], turned, rtol=0 if scale == turned else 1e-12)
    root = replace(rig, metadata={0: replace(stored, kind="root").to_dict()})
    assert reoriented_metadata(root, delta) == root.metadata
