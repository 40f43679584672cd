"""The pose of controls at zero: which limbs IK can move and why not, and what rests otherwise, by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from calls import calls
from numpy.testing import assert_allclose
from rigs import chain, rig_of

from rigtri.errors import GeometryError
from rigtri.evaluation.rig_space import in_rig_space, seen_alone, shearing_node, uneven_above
from rigtri.evaluation.twist_joints import bone, driver_path
from rigtri.evaluation.zero_pose import (
    ControlsAtZero,
    idle_ik,
    ik_obstacle,
    moved_controls,
    world_at_zero,
)
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls

Z = np.array([0.0, 0.0, 1.0])
NAMES = ["root", "start", "mid", "end", "flat"]
PARENTS = [-1, 0, 1, 2, 0]


def tree() -> Rig:
    return rig_of(NAMES, PARENTS, np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [1, 0, 0], [3, 0, 0]]))


@pytest.mark.parametrize(
    ("limb", "why"),
    [
        ("start mid end", ""),
        ("start mid flat", ""),
        ("start mid mid", "'start', 'mid' and 'mid' are not three joints"),
        ("mid start end", "'start' is not a descendant of 'mid', so it does not follow it"),
        ("start mid root", "'start' is a descendant of 'root', so the limb would move its own root"),
        (
            "start end mid",
            "'mid' is a descendant of 'start', but not of 'end', so it does not follow the bend",
        ),
        ("start flat end", "'flat' is not a descendant of 'start', so it does not follow it"),
    ],
)
def test_why_ik_cannot_move_a_limb(limb: str, why: str) -> None:
    rig = tree()
    a, b, c = map(rig.find, limb.split())
    assert ik_obstacle(rig, (a, b, c)) == why
    everything = np.ones(len(rig), dtype=bool)
    assert idle_ik(rig, (a, b, c), everything) == why
    nothing = everything.copy()
    nothing[a] = False
    assert idle_ik(rig, (a, b, c), nothing) == f"no mesh follows '{rig.names[a]}'"


def test_a_limb_that_holds_the_controls_cannot_follow_one() -> None:
    rig = tree()
    held = replace(rig, rules=replace(rig.rules, group_parent=3))
    assert ik_obstacle(held, (1, 2, 3)) == "'start' holds the controls, so it cannot follow one"
    assert ik_obstacle(replace(rig, rules=replace(rig.rules, group_parent=4)), (1, 2, 3)) == ""


@pytest.fixture
def controlled() -> Rig:
    bare = chain((0, 0, 0), (1, 0, 0), (2, 0.3, 0), (3, 0, 0))
    return add_controls(bare, options=AddControlsOptions(joints=("b", "c"), frame="joint"))


def test_controls_that_somebody_has_moved_or_that_have_keys(controlled: Rig) -> None:
    rig, b, c = controlled, controlled.find("b_ctl"), controlled.find("c_ctl")
    assert moved_controls(rig) == frozenset()
    places = rig.translation.copy()
    places[b, 1] = 0.5
    assert moved_controls(replace(rig, translation=places)) == {b}
    keys = [Track(node, "rotation", "LINEAR", np.zeros(1), np.array([[0.0, 0, 0, 1]])) for node in (c, 1)]
    assert moved_controls(replace(rig, clips=(Clip("w", tuple(keys)),))) == {c}


def test_controls_do_not_count_on_the_way_to_the_world_at_zero(controlled: Rig) -> None:
    rig, b = controlled, controlled.find("b_ctl")
    rig.translation[b] = (0, 7, 0)
    below = rig.find("c_ctl_offset")
    assert_allclose(world_at_zero(rig, below, {b})[3, :3], [2, 0.3, 0], atol=1e-12)
    assert_allclose(world_at_zero(rig, below, set())[3, :3], [2, 7.3, 0], atol=1e-12)
    assert_allclose(world_at_zero(rig, -1, set()), np.eye(4))


@pytest.mark.parametrize("matrix", [False, True])
def test_joints_have_the_scales_that_are_stored_with_their_offsets(controlled: Rig, matrix: bool) -> None:
    rig, offset = controlled, controlled.find("b_ctl_offset")
    metadata = {**rig.metadata, offset: {**rig.metadata[offset], "scale": [2.0, 3.0, 4.0]}}
    rig = replace(rig, metadata=metadata)
    if matrix:
        has, matrices = rig.has_matrix.copy(), rig.matrix.copy()
        has[1], matrices[1] = True, rig.local[1]
        rig = replace(rig, has_matrix=has, matrix=matrices)
    zero = ControlsAtZero(rig).rig
    assert_allclose(np.linalg.norm(zero.local[1][:3, :3], axis=1), [2, 3, 4])
    assert_allclose(zero.local[1][3, :3], rig.local[1][3, :3])
    assert_allclose(zero.local[2], rig.local[2])


def test_a_joint_that_rests_in_its_place_stands_there_though_what_is_above_it_does_not(
    controlled: Rig,
) -> None:
    rig, b, c = controlled, controlled.find("b"), controlled.find("c")
    places = rig.world[[b, c]].copy()
    rig.translation[b] += (0, 5, 0)
    rig.translation[c] -= (0, 5, 0)
    assert_allclose(ControlsAtZero(replace(rig)).world[[b, c]], places, atol=1e-12)


# --- what shears


def squashed(top: Any = (1.0, 1.5, 0.7), low: Any = 1.0, a: Any = 1.0) -> Rig:
    """A node that is scaled unevenly and one that is not, above a skeleton of two joints."""
    rig = rig_of(
        ["top", "low", "a", "b"], [-1, 0, 1, 2], np.array([[1.0, 2, 3], [4, 5, 6], [0, 0, 0], [1, 0, 0]])
    )
    rig.scale[0], rig.scale[1], rig.scale[2] = top, low, a
    skin = replace(chain((0, 0, 0), (1, 0, 0)).skins[0], joints=np.array([2, 3]))
    return replace(rig, skins=(skin,))


def test_nodes_above_skeletons_that_are_uneven_at_rest_or_in_a_clip() -> None:
    assert uneven_above(squashed()) == [0]
    assert uneven_above(squashed(2.0, low=(1, 1, 1.1))) == [1]
    assert uneven_above(squashed(2.0)) == []
    assert uneven_above(rig := squashed(2.0, a=(1, 2, 3))) == []  # of a joint
    sizes = np.array([[1.0, 1, 1], [2.0, 2, 2.1]])
    for node, found in ((1, [1]), (3, [])):
        keys = Track(node, "scale", "LINEAR", np.array([0.0, 1.0]), sizes)
        assert uneven_above(replace(rig, clips=(Clip("c", (keys,)),))) == found
    even = Track(1, "scale", "LINEAR", np.array([0.0, 1.0]), np.array([[1.0, 1, 1], [3, -3, 3]]))
    assert uneven_above(replace(rig, clips=(Clip("c", (even,)),))) == []


def test_the_least_uniform_node_above_is_what_shears() -> None:
    assert shearing_node(squashed(), 3) == 0
    assert shearing_node(squashed(low=(1.0, 5.0, 1.0)), 3) == 1
    assert shearing_node(squashed(), 0) == 0


def test_what_is_evaluated_without_uneven_nodes_gets_them_back() -> None:
    rig = squashed()
    rig.rotation[0] = from_axis_angle(Z, 0.5)
    walk = Track(0, "translation", "LINEAR", np.array([0.0, 1.0]), np.ones((2, 3)))
    wave = Track(3, "rotation", "LINEAR", np.array([0.0]), np.array([[0.0, 0, 0, 1]]))
    rig = replace(rig, clips=(Clip("walk", (walk, wave)), Clip("wave", (wave,))))
    seen, nodes = seen_alone(rig)
    assert nodes == [0]
    assert_allclose(seen.local[0], np.eye(4))
    assert_allclose(seen.local[1:], rig.local[1:])
    assert [clip.tracks for clip in seen.clips] == [(wave,), (wave,)]
    assert seen.clips[1] is rig.clips[1]
    kept, _ = seen_alone(replace(rig, rules=replace(rig.rules, group_parent=1)), building=True)
    assert_allclose(kept.rotation[0], rig.rotation[0], atol=1e-12)
    assert_allclose(kept.translation[0], 0.0)
    assert seen_alone(rig, building=True) == (rig, [])  # controls will not be below it

    def evaluate(given: Rig) -> Rig:
        moved = given.translation.copy()
        moved[3] = (9, 9, 9)
        more = replace(given.clips[0], tracks=(wave, wave))
        return replace(given, translation=moved, clips=(more, given.clips[1]))

    made = in_rig_space(rig, evaluate)
    assert_allclose(made.local[0], rig.local[0])
    assert made.translation[3].tolist() == [9, 9, 9]
    assert made.clips[0].tracks == (walk, wave, wave)
    assert made.clips[1] is rig.clips[1]
    assert in_rig_space(rig, lambda given: given) is rig
    plain = chain((0, 0, 0), (1, 0, 0))
    assert in_rig_space(plain, lambda given: replace(given, names=("x", "y"))).names == ("x", "y")


# --- twist


@pytest.mark.parametrize(
    ("driver", "below", "path"),
    [("end", "start", ["end", "mid"]), ("end", "root", ["end", "mid", "start"]), ("mid", "start", ["mid"])],
)
def test_the_nodes_from_a_driver_up_to_where_twist_is_seen_from(
    driver: str, below: str, path: list[str]
) -> None:
    rig = tree()
    found: Any = driver_path(rig, rig.find(driver), rig.find(below))
    assert [rig.names[node] for node in found] == path


def test_a_driver_alone_has_itself_and_one_beside_is_refused() -> None:
    rig = tree()
    assert driver_path(rig, 3, -1) == (3,)
    with pytest.raises(GeometryError, match="'flat' does not lie below 'start'"):
        driver_path(rig, 4, 1)


def test_a_bone_is_seen_by_its_joint() -> None:
    rig = tree()
    rig.rotation[1] = from_axis_angle(Z, np.pi / 2)
    rig.scale[1] = 2.0
    assert_allclose(bone(rig, 1, 3), [2, 0, 0], atol=1e-12)
    assert_allclose(bone(rig, 1, 0), [0, 0.5, 0], atol=1e-12)


@pytest.mark.parametrize(
    ("carrier", "scale"),
    [
        ([1.0, 1, 1], [1.0, 2, 4]),  # what it is made of follows the carrier
        ([3.0, 3, 3], [1.0, 2, 4]),
        ([1.0, 3, 1], [2.0, 2, 2]),  # the third root of its volume, 8, along the axes that it keeps
    ],
)
def test_a_joint_grows_by_its_volume_where_its_carriers_scale_is_not_uniform(
    carrier: list[float], scale: list[float]
) -> None:
    scales = np.array([carrier, [1.0, 1, 1], [1.0, 1, 1]])
    rig = rig_of(["carrier", "parent", "joint"], [-1, -1, 1], np.zeros((3, 3)), scale=scales)
    parts = ControlsAtZero(rig).carried_parts(2, 0, np.diag([1.0, 2, 4, 1])[np.newaxis])
    assert_allclose(parts.scale, [scale])


def test_four_times_as_many_controls_in_a_chain_are_four_times_the_work() -> None:
    def work(count: int) -> int:
        names = [f"j{k}" for k in range(count)]
        rig = chain(*((float(k), 0.0, 0.0) for k in range(count)), names=names)
        built = add_controls(rig, options=AddControlsOptions(joints=("*",)))
        return calls(lambda: ControlsAtZero(built).world)

    assert work(120) < 4.5 * work(30)
