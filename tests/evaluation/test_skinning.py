"""Points that skins, nodes and morphs move: as a plain loop over points and joints has them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from rigs import chain

from rigtri.evaluation import skinned_points, skinning
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.evaluation.skinned_points import SkinnedPoints
from rigtri.evaluation.skinning import deformed, deformed_parts, normalised_weights
from rigtri.evaluation.timelines import timelines
from rigtri.maths.quaternions import from_axis_angle, to_axes, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig

COUNT = 11


def arm() -> Rig:
    """Three joints whose clip turns and moves them, and a node beside them."""
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0.5, 0), (9, 9, 9))
    rig.parents[3] = -1
    skin = replace(
        rig.skins[0], joints=np.array([2, 0, 1]), inverse_bind=rig.skins[0].inverse_bind[[2, 0, 1]]
    )
    made = np.random.default_rng(2)
    times = np.array([0.0, 1.0])
    tracks = [Track(k, "rotation", "LINEAR", times, unit(made.normal(size=(2, 4)))) for k in range(4)]
    tracks.append(Track(0, "translation", "LINEAR", times, made.normal(size=(2, 3))))
    tracks.append(Track(3, "weights", "LINEAR", times, np.array([[0.0, 1.0], [2.0, 0.5]])))
    return replace(rig, skins=(skin,), clips=(Clip("wave", tuple(tracks)),))


def body(**more: Any) -> Mesh:
    made = np.random.default_rng(1)
    joints, weights = made.integers(0, 3, (COUNT, 3)), made.uniform(0.1, 1.0, (COUNT, 3))
    weights[::3, 1] = 0.0
    weights[4] = (0.0, 0.0, 2.0)
    given = {"skin": 0, "joints": joints, "weights": weights, "bind": made.normal(size=(4, 4)) * [1, 1, 1, 0]}
    given["bind"][3, 3] = 1.0
    return Mesh("body", 3, made.normal(size=(COUNT, 3)), **(given | more))


def by_hand(mesh: Mesh, rig: Rig, world: Floats, morph: Floats) -> Floats:
    """(f, v, 3), one point and joint at a time."""
    found = np.zeros((len(world), COUNT, 3))
    for frame in range(len(world)):
        points = mesh.points + sum(
            (w * offsets for w, offsets in zip(morph[frame], mesh.morphs, strict=True)), 0.0
        )
        for v in range(COUNT):
            point = np.append(points[v], 1.0)
            if mesh.skin is None or not mesh.joints.shape[1]:
                found[frame, v] = (point @ world[frame, mesh.node])[:3]
                continue
            skin, total = rig.skins[mesh.skin], np.abs(mesh.weights[v]).sum()
            for joint, weight in zip(mesh.joints[v], mesh.weights[v], strict=True):
                matrix = mesh.bind @ skin.inverse_bind[joint] @ world[frame, skin.joints[joint]]
                found[frame, v] += weight / total * (point @ matrix)[:3]
    return found


def at(rig: Rig, *times: float) -> Floats:
    return worlds(rig, locals_at(rig, rig.clips[0], np.array(times)))


@pytest.mark.parametrize("block", [1 << 13, 4])
@pytest.mark.parametrize("times", [(0.3,), (0.0, 0.3, 1.0)])
@pytest.mark.parametrize("kind", ["skin", "node", "no influences"])
@pytest.mark.parametrize("morphed", [False, True])
def test_points_are_where_a_loop_over_points_and_joints_has_them(
    monkeypatch: pytest.MonkeyPatch, block: int, times: tuple[float, ...], kind: str, morphed: bool
) -> None:
    monkeypatch.setattr(skinning, "_POINTS", block)
    more: dict[str, Any] = {"skin": None} if kind == "node" else {}
    if kind == "no influences":
        more = {"joints": np.zeros((COUNT, 0), np.int64), "weights": np.zeros((COUNT, 0))}
    rig = arm()
    made = np.random.default_rng(4)
    mesh = body(morphs=made.normal(size=(2, COUNT, 3)) if morphed else np.zeros((0, COUNT, 3)), **more)
    morph = made.normal(size=(len(times), 2 if morphed else 0))
    world = at(rig, *times)
    assert_allclose(deformed(mesh, rig, world, morph), by_hand(mesh, rig, world, morph), atol=1e-9)


@pytest.mark.parametrize("off", [0.0, 1e-14, 0.1])
def test_at_rest_all_joints_of_many_points_move_them_alike(
    monkeypatch: pytest.MonkeyPatch, off: float
) -> None:
    """Which is one product for a block of points; matrices that differ are told apart."""
    monkeypatch.setattr(skinning, "_POINTS", 4)
    rig = arm()
    moved = np.eye(4)
    moved[:3, :3], moved[3, :3] = [[1, 2, 0], [0, 3, 1], [1, 0, 2]], (5, 6, 7)
    world = (rig.world @ moved)[np.newaxis]
    world[0, 1] = world[0, 1] * (1.0 + off)
    world[0, 1, 3, 3] = 1.0
    mesh = body(bind=np.eye(4))
    none = np.zeros((1, 0))
    found = deformed(mesh, rig, world, none)
    assert_allclose(found, by_hand(mesh, rig, world, none), atol=1e-9)
    assert (np.abs(found - (mesh.points @ moved[:3, :3] + moved[3, :3])).max() < 1e-9) == (off < 0.1)


def test_a_joint_without_weight_moves_nothing_even_where_it_is_no_number() -> None:
    rig, mesh = arm(), body(bind=np.eye(4))
    mesh.weights[mesh.joints == 1] = 0.0
    bare = mesh.weights.sum(axis=1) == 0
    mesh.weights[bare], mesh.joints[bare] = (0.0, 0.0, 1.0), 2
    mesh.joints[mesh.weights == 0] = 1
    none = np.zeros((1, 0))
    for times in ((0.5,), (0.5, 0.7)):
        world = at(rig, *times)
        expected = by_hand(mesh, rig, world, np.zeros((len(times), 0)))
        world[:, rig.skins[0].joints[1]] = np.nan
        assert_allclose(deformed(mesh, rig, world, none), expected, atol=1e-12)


def test_weights_sum_to_1_and_a_point_without_any_follows_its_first_joint() -> None:
    weights = np.array([[1.0, 3.0], [0.0, 0.0], [0.5, -0.5], [np.nan, 1.0]])
    found = normalised_weights(weights)
    assert_array_equal(found[:3], [[0.25, 0.75], [1.0, 0.0], [0.5, -0.5]])
    assert np.isnan(found[3]).all()
    assert_array_equal(normalised_weights(weights[:1]), [[0.25, 0.75]])


def test_dual_quaternions_keep_the_distance_from_a_bone_that_twists() -> None:
    """Half way between a joint and one that is turned by 90° about the bone, a point is turned by 45°."""
    rig = chain((0, 0, 0), (1, 0, 0))
    rig = replace(rig, skins=(replace(rig.skins[0], inverse_bind=np.tile(np.eye(4), (2, 1, 1))),))
    world = np.tile(np.eye(4), (1, 2, 1, 1))
    half = np.sqrt(0.5)
    world[0, 1, :3, :3] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]  # y goes to z
    world[0, :, 3, :3] = (0, 0, 5)
    mesh = Mesh(
        "m",
        0,
        np.array([[0.5, 2.0, 0.0]] * 3),
        0,
        np.array([[0, 1]] * 3),
        np.array([[1.0, 1.0], [1.0, 0.0], [0.0, 3.0]]),
        dual_quaternion=True,
    )
    found = deformed(mesh, rig, world, np.zeros((1, 0)))[0]
    assert_allclose(found, [[0.5, 2 * half, 5 + 2 * half], [0.5, 2, 5], [0.5, 0, 7]], atol=1e-12)
    # A joint's scale is blended along; linear weights alone would lose a third of the distance.
    world[0, 1, :3, :3] *= 3.0
    grown = deformed(mesh, rig, world, np.zeros((1, 0)))[0]
    assert_allclose(grown[0], [1.0, 4 * half, 5 + 4 * half], atol=1e-12)


@pytest.mark.parametrize("parent", [-1, 0, 3])
@pytest.mark.parametrize("kind", ["skin", "node"])
def test_a_few_points_are_found_without_the_others(
    kind: str, parent: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(skinned_points, "_BLOCK", 8)
    rig, made = arm(), np.random.default_rng(4)
    mesh = body(morphs=made.normal(size=(2, COUNT, 3)), morph_weights=np.array([0.3, -0.2]))
    mesh = replace(mesh, skin=None) if kind == "node" else mesh
    rows = np.array([4, 9])
    some = SkinnedPoints(rig, mesh, rows, parent)
    (timeline,) = timelines(rig)
    times = np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    weights = np.array([[2.0 * t, 1.0 - 0.5 * t] for t in times])
    for used in (timeline, some.affecting(timeline)):
        world = at(rig, *times)
        expected = by_hand(mesh, rig, world, weights)[:, rows]
        if parent >= 0:
            back = np.linalg.inv(world[:, parent])
            expected = expected @ back[:, :3, :3] + back[:, 3:, :3]
        assert_allclose(some.sample(used, times), expected, atol=1e-9)
    rest = by_hand(mesh, rig, rig.world[np.newaxis], mesh.morph_weights[np.newaxis])[0, rows]
    if parent >= 0:
        back = np.linalg.inv(rig.world[parent])
        rest = rest @ back[:3, :3] + back[3, :3]
    assert_allclose(some.at_rest(), rest, atol=1e-9)


def test_only_what_can_move_the_points_counts() -> None:
    rig = arm()
    (timeline,) = timelines(rig)
    joints, weights = np.full((COUNT, 1), 2), np.ones((COUNT, 1))  # joint 1 of the chain
    still = np.zeros((1, COUNT, 3))
    still[0, 5] = 1.0
    mesh = body(joints=joints, weights=weights, morphs=still, morph_weights=np.ones(1))
    some = SkinnedPoints(rig, mesh, np.array([0, 1]))
    assert some.nodes == [0, 1]
    tracks = {(t.node, t.path) for t in some.affecting(timeline).clip.tracks}
    assert tracks == {(0, "rotation"), (0, "translation"), (1, "rotation")}
    morphed = SkinnedPoints(rig, mesh, np.array([0, 5]), parent=2)
    assert morphed.nodes == [0, 1, 2]
    tracks = {(t.node, t.path) for t in morphed.affecting(timeline).clip.tracks}
    assert tracks == {(0, "rotation"), (0, "translation"), (1, "rotation"), (2, "rotation"), (3, "weights")}


def test_a_turn_of_one_joint_by_hand() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    rig.rotation[1] = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.pi / 2)
    mesh = Mesh("m", 0, np.array([[2.0, 0, 0]]), 0, np.array([[1, 0]]), np.array([[3.0, 1.0]]))
    world = worlds(rig, rig.normalised_local)[np.newaxis]
    assert_allclose(
        deformed(mesh, rig, world, np.zeros((1, 0)))[0], [[0.75 * 1 + 0.25 * 2, 0.75, 0]], atol=1e-12
    )


def test_dual_quaternions_blend_along_the_short_way() -> None:
    """Half way between 170° and −170° about the bone is half a turn."""
    rig = chain((0, 0, 0), (1, 0, 0))
    rig = replace(rig, skins=(replace(rig.skins[0], inverse_bind=np.tile(np.eye(4), (2, 1, 1))),))
    world = np.tile(np.eye(4), (1, 2, 1, 1))
    for joint, degrees in enumerate((170.0, -170.0)):
        world[0, joint, :3, :3] = to_axes(from_axis_angle(np.array([1.0, 0.0, 0.0]), np.radians(degrees)))
    mesh = Mesh(
        "m", 0, np.array([[0.5, 2.0, 0.0]]), 0, np.array([[0, 1]]), np.ones((1, 2)), dual_quaternion=True
    )
    assert_allclose(deformed(mesh, rig, world, np.zeros((1, 0)))[0], [[0.5, -2, 0]], atol=1e-12)


def test_few_points_of_a_mesh_without_influences_follow_its_node() -> None:
    rig = arm()
    mesh = body(joints=np.zeros((COUNT, 0), np.int64), weights=np.zeros((COUNT, 0)))
    some = SkinnedPoints(rig, mesh, np.array([1]))
    assert some.nodes == [3]
    (timeline,) = timelines(rig)
    expected = by_hand(mesh, rig, at(rig, 0.5), np.zeros((1, 0)))[:, [1]]
    assert_allclose(some.sample(timeline, np.array([0.5])), expected, atol=1e-12)


def test_matrices_are_alike_up_to_rounding() -> None:
    first = np.diag([1.0, 2.0, 40.0, 1.0])
    for off, alike in ((1e-13, True), (1e-12, False), (np.nan, False)):
        other = first.copy()
        other[3, 0] += off
        assert skinning._alike(np.stack([first, other])) is alike
        assert skinning._alike(np.stack([other, first])) is alike
    assert skinning._alike(first[np.newaxis])


EVEN = normalised_weights(np.random.default_rng(3).uniform(size=(COUNT, 3)))


@pytest.mark.parametrize(
    ("more", "in_parts"),
    [
        ({}, True),
        ({"raw_weights": True, "weights": EVEN}, True),
        ({"raw_weights": True}, False),
        ({"dual_quaternion": True}, False),
        ({"skin": None}, False),
    ],
)
@pytest.mark.parametrize("block", [2, COUNT, 100])
def test_points_some_after_the_other_are_those_of_all_at_once_to_the_bit(
    more: dict[str, Any], in_parts: bool, block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(skinning, "_POINTS", block)
    rig, mesh = arm(), body(**more)
    world = worlds(rig, locals_at(rig, rig.clips[0], np.array([0.4])))
    (whole,) = deformed(mesh, rig, world, np.zeros((1, 0)))
    parts = list(deformed_parts(mesh, rig, world[0], np.zeros(0)))
    assert_array_equal(np.concatenate(parts), whole)
    assert len(parts) == (-(-COUNT // block) if in_parts else 1)
