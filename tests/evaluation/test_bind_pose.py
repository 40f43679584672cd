"""Where a skin stands in its bind pose, by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.testing import assert_allclose
from rigs import chain, rig_of

from rigtri.evaluation.bind_pose import bind_frames, bind_worlds, placed_bind
from rigtri.maths.matrices import compose, inverse
from rigtri.maths.quaternions import IDENTITY, from_axis_angle
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

Z = np.array([0.0, 0.0, 1.0])


def bound(*, moved: bool = False, hidden: float = 1.0) -> Rig:
    """Joints a and b of a skin that was bound at x = 0 and 1, with a prop below b that is no joint.

    moved: they rest elsewhere, the elbow bent. hidden: a scale of points in all inverse binds.
    """
    rig = rig_of(
        ["top", "a", "b", "prop"], [-1, 0, 1, 2], np.array([[0.0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 2, 0]])
    )
    binds = np.stack([np.eye(4), np.eye(4)])
    binds[1, 3, 0] = -1.0
    scaled = np.diag([hidden, hidden, hidden, 1.0])
    skin = Skin("s", np.array([1, 2]), scaled @ binds)
    if moved:
        rig.translation[0] = (5, 0, 0)
        rig.rotation[2] = from_axis_angle(Z, 1.0)
    return replace(rig, skins=(skin,))


def test_a_bind_pose_stands_where_the_topmost_joint_rests() -> None:
    rig = bound(moved=True)
    frames = bind_frames(rig, rig.skins[0])
    assert_allclose(frames[:, 3, :3], [[5, 0, 0], [6, 0, 0]])
    assert_allclose(frames[1, :3, :3], np.eye(3), atol=1e-12)  # not bent
    world = bind_worlds(rig, rig.skins[0])
    assert_allclose(world[[1, 2]], frames)
    assert_allclose(world[3, 3, :3], [6, 2, 0], atol=1e-12)  # follows b as that was bound
    assert_allclose(world[0], rig.world[0])
    assert bind_worlds(rig, rig.skins[0]) is world
    assert not world.flags.writeable


def test_a_scale_of_points_in_all_inverse_binds_cancels() -> None:
    rig = bound(moved=True, hidden=0.01)
    assert_allclose(bind_frames(rig, rig.skins[0])[:, 3, :3], [[5, 0, 0], [6, 0, 0]], atol=1e-12)


def test_a_skin_without_joints_has_the_rest_pose() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    empty = replace(rig.skins[0], joints=np.zeros(0, np.int64), inverse_bind=np.zeros((0, 4, 4)))
    assert bind_frames(rig, empty).shape == (0, 4, 4)
    assert bind_worlds(rig, empty) is rig.world


def test_a_body_that_leans_at_rest_stands_as_the_scene_bound_it() -> None:
    """The topmost joint is turned by 30° at rest; nothing above it says so."""
    rig = bound()
    rig.rotation[1] = from_axis_angle(Z, np.radians(30))
    found = placed_bind(rig, 0).world
    assert_allclose(found[[1, 2], 3, :3], [[0, 0, 0], [1, 0, 0]], atol=1e-9)
    assert_allclose(found[1, :3, :3], np.eye(3), atol=1e-9)
    upright = bound()
    assert placed_bind(upright, 0).world is bind_worlds(upright, upright.skins[0])


def test_a_character_that_is_placed_in_its_scene_keeps_its_place() -> None:
    rig = bound()
    rig.translation[0] = (7, 0, 0)
    rig.rotation[1] = from_axis_angle(Z, np.radians(30))
    found = placed_bind(rig, 0).world
    assert_allclose(found[[1, 2], 3, :3], [[7, 0, 0], [8, 0, 0]], atol=1e-9)
    assert_allclose(found[1], compose(np.array([7.0, 0, 0]), IDENTITY, np.ones(3)), atol=1e-9)


def test_a_skin_without_matrices_or_joints_is_not_placed() -> None:
    """Its bind pose is not known; one that is known and stands elsewhere is placed where its mesh is."""
    rig = chain((5, 0, 0), (6, 0, 0))
    away = replace(rig.skins[0], inverse_bind=inverse(chain((0, 0, 0), (1, 0, 0)).world))
    for skin in (
        replace(away, stored=False),
        replace(away, joints=away.joints[:0], inverse_bind=away.inverse_bind[:0]),
    ):
        unknown = replace(rig, skins=(skin,))
        assert np.array_equal(placed_bind(unknown, 0).world, bind_worlds(unknown, skin), equal_nan=True)
    placed = placed_bind(replace(rig, skins=(away,)), 0).world
    assert placed[:, 3, 0].tolist() == [0.0, 1.0]
