"""A rig as data: finding by name, paths, levels; no file and no terminal."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from rigs import chain, random_rig, rig_of

from rigtri.errors import AmbiguousNameError, GeometryError, NameNotFoundError
from rigtri.maths.matrices import compose
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.model.format_rules import FormatRules
from rigtri.model.limb import Limb
from rigtri.model.pending_edits import PendingEdits
from rigtri.model.rig import Rig
from rigtri.model.skin import JointMerge, Skin, WeightLimit


def hero() -> Rig:
    """root > (arm > elbow, arm, mesh), with the first arm a joint and the names ``arm`` twice."""
    rig = rig_of(["root", "arm", "elbow", "arm", "", "b[1]*"], [-1, 0, 1, 0, 0, 0], np.eye(6, 3) + 1.0)
    skin = Skin("skin", np.array([0, 1, 2]), np.broadcast_to(np.eye(4), (3, 4, 4)))
    return replace(rig, skins=(skin,), humanoid={"hips": 0})


def test_a_copy_of_a_rig_is_that_rig_and_no_other_process_gets_one() -> None:
    """Before, both failed with "cannot pickle memoryview objects"."""
    rig = hero()
    assert copy.copy(rig) is copy.deepcopy(rig) is rig
    with pytest.raises(TypeError, match="write it to a file"):
        pickle.dumps(rig)


def test_what_is_below_a_control_is_ours_by_its_name_and_what_it_shows_alone() -> None:
    """Lines (by name, what they show, no children), what holds ours alone, the switch of export-blender."""
    ours, others = (
        ["ctl", "ctl_shape", "between", "knob", "rigtri_ik_001"],
        ["prop", "prop_shape", "shape", "held", "hat"],
    )
    parents = {"ctl": -1, "held": 7, "knob": 2}
    names = ours + others
    rig = rig_of(names, [parents.get(name, 0) for name in names], np.zeros((10, 3)))
    shows = np.array([k if name in ("ctl_shape", "prop", "shape") else -1 for k, name in enumerate(names)])
    made = {names.index(name): {"type": "control"} for name in ("ctl", "knob")}
    assert {names[node] for node in replace(rig, attachment=shows, metadata=made).own} == set(ours)


def test_a_group_shares_what_its_frame_is_given_with_what_it_is_in() -> None:
    rig = rig_of(["controls", "hand", "group", "ctl"], [-1, -1, 1, 2], np.zeros((4, 3)))
    rig = replace(rig, metadata={0: {"type": "group"}, 2: {"type": "group"}})
    given = np.arange(8.0).reshape(4, 2)
    assert rig.shared(given)[:, 0].tolist() == [0.0, 2.0, 2.0, 6.0]
    assert given[2, 0] == 4.0


def test_a_joint_with_the_metadata_of_a_group_shares_nothing() -> None:
    """Found by mutations: a twist joint got the axes of the arm, against its constraint."""
    rig = rig_of(["arm", "twist"], [-1, 0], np.array([[0.0, 1.0, 0.0], [0.2, 0.0, 0.0]]))
    rig = replace(rig, metadata={1: {"type": "group"}})
    assert rig.shared(np.array([[1.0], [2.0]])).tolist() == [[1.0], [2.0]]


@given(st.integers(0, 2**32 - 1))
def test_worlds_are_locals_times_the_parents_world(seed: int) -> None:
    rig = random_rig(seed)
    world = rig.world
    for node, parent in enumerate(rig.parents.tolist()):
        above = world[parent] if parent >= 0 else np.eye(4)
        assert_allclose(world[node], rig.local[node] @ above, atol=1e-9)


@given(st.integers(0, 2**32 - 1))
def test_every_level_holds_the_children_of_the_one_before(seed: int) -> None:
    rig = random_rig(seed, joints=12)
    assert sorted(np.concatenate(rig.levels).tolist()) == list(range(12))
    above: set[int] = {-1}
    for level in rig.levels:
        assert set(rig.parents[level].tolist()) <= above
        above = set(level.tolist())


@given(st.integers(0, 2**32 - 1))
def test_a_node_and_all_below_it_are_found_from_both_ends(seed: int) -> None:
    rig = random_rig(seed, joints=12)
    for node in range(len(rig)):
        expected = {node}
        for child in rig.children[node]:
            expected.update(rig.below(child))
        assert rig.below(node) == sorted(expected)


def test_a_rig_without_nodes_is_a_rig() -> None:
    rig = rig_of([], [], np.zeros((0, 3)))
    assert (len(rig), rig.levels, rig.world.shape) == (0, (), (0, 4, 4))


def test_a_node_is_found_by_name_label_path_and_vrm_bone() -> None:
    rig = hero()
    assert [rig.find(name) for name in ("elbow", "#2", "/root/arm/elbow")] == [2, 2, 2]
    assert rig.find("vrm:hips") == 0


def test_a_joint_wins_over_another_node_of_its_name() -> None:
    assert hero().find("arm") == 1


def test_a_name_that_several_joints_share_is_refused_with_their_labels() -> None:
    skin = Skin("skin", np.array([1, 3]), np.broadcast_to(np.eye(4), (2, 4, 4)))
    rig = replace(hero(), skins=(skin,))
    with pytest.raises(AmbiguousNameError, match="2 joints are named 'arm': '#1', '#3'"):
        rig.find("arm")


def test_a_name_that_is_not_there_gets_the_nearest_one() -> None:
    with pytest.raises(NameNotFoundError, match="No joint is named 'elbo'\\. Did you mean 'elbow'"):
        hero().find("elbo")


def test_a_look_up_that_may_find_nothing_searches_no_names_like_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def compare(*_: object, **__: object) -> str:
        raise AssertionError("compared with every name of the rig")

    monkeypatch.setattr("rigtri.errors.did_you_mean", compare)
    assert [hero().known(name) for name in ("elbo", "arm", "elbow", None, "")] == [None, 1, 2, None, None]


def test_an_exact_name_wins_over_a_pattern() -> None:
    rig = hero()
    assert rig.match("b[1]*") == [5]
    assert rig.match("*o*") == [0, 1, 2, 3, 4, 5]  # every path goes through /root
    assert rig.match("el*") == [2]
    assert rig.match("arm") == [1, 3]
    with pytest.raises(NameNotFoundError):
        rig.match("leg*")


def test_titles_suffice_to_find_the_node() -> None:
    rig = hero()
    assert [rig.title(node) for node in (1, 2, 4)] == ["arm (#1)", "elbow", "#4"]
    assert rig.path(4) == "/root/#4"
    assert [rig.find(rig.title(node)) for node in range(len(rig))] == [*range(len(rig))]
    assert rig.match("arm (#3)") == [3]


def test_new_nodes_come_last_and_have_no_key() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    more = rig.with_nodes(["pole"], [-1], np.array([[1.0, 2, 3]]), np.array([[0.0, 0, 0, 1]]))
    assert (more.names, more.keys) == (("a", "b", "pole"), (0, 1, None))
    assert more.labels[2] == "+pole"
    assert_array_equal(more.world[2, 3, :3], [1, 2, 3])
    assert len(rig) == 2


def test_rules_and_edits_follow_nodes_to_their_new_numbers_the_first_one_too() -> None:
    rules = FormatRules(group_parent=0, named=frozenset({0, 1}), fixed={1: "a viewer turns it"})
    new = rules.reordered([1, 0])
    assert (new.group_parent, new.named, new.fixed) == (1, {0, 1}, {0: "a viewer turns it"})
    assert FormatRules().reordered([1, 0]).group_parent == -1
    edits = PendingEdits(removed=frozenset({0, 1, 2})).reordered([2, 0, -1])
    assert edits.removed == {0, 2}


def with_matrices(*matrices: Any) -> Rig:
    rig = chain(*((float(k), 0.0, 0.0) for k in range(len(matrices))))
    for node, matrix in enumerate(matrices):
        rig.has_matrix[node] = matrix is not None
        rig.matrix[node] = np.eye(4) if matrix is None else matrix
    return rig


PLACED = compose(np.array([4.0, 5, 6]), from_axis_angle(np.array([0.0, 0, 1]), 0.7), np.array([2.0, -3, 4]))
SHEARED = np.array([[1.0, 0, 0, 0], [0.5, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def test_the_end_of_a_path_names_a_clip_where_one_alone_moves_joints_at_hand() -> None:
    rig = chain((0, 0, 0), (0, 1, 0))
    clips = [
        Clip(f"/{who}/walk", (Track(node, "scale", "STEP", np.zeros(1), np.ones((1, 3))),))
        for node, who in enumerate(("Ann", "Bob"))
    ]
    rig = replace(rig, clips=tuple(clips))
    one = Skin("", np.array([1]), np.eye(4)[np.newaxis])
    assert replace(rig, skins=(one,)).clip("walk").name == "/Bob/walk"
    with pytest.raises(NameNotFoundError, match="No clip is named 'walk'"):
        replace(rig, skins=(one, replace(one, joints=np.array([0])))).clip("walk")
    assert "2 meshes are named" in str(AmbiguousNameError("mesh", "Hat", ["#1", "#2"]))


def test_a_matrix_is_taken_apart_where_a_clip_is_to_move_its_node() -> None:
    rig = with_matrices(None, PLACED, PLACED)
    found = rig.with_parts([0, 1])
    assert found.has_matrix.tolist() == [False, False, True]
    assert_allclose(found.local, rig.local, atol=1e-12)
    assert_allclose(found.translation[1], [4, 5, 6])
    assert rig.has_matrix.tolist() == [False, True, True]
    assert rig.with_parts([0]) is rig
    raw = replace(rig, rules=replace(rig.rules, raw_quaternions=True))
    assert raw.with_parts([1]) is raw


@pytest.mark.parametrize("broken", [SHEARED, np.diag([1.0, 0, 0, 1]) + np.eye(4, k=1) * 0.3])
def test_a_matrix_that_has_no_parts_is_refused(broken: Any) -> None:
    rig = with_matrices(None, broken)
    with pytest.raises(GeometryError, match="'b' has a matrix that is sheared or flat"):
        rig.with_parts([1])
    assert rig.with_parts([0]) is rig


def test_a_rig_says_how_much_is_in_it() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    assert repr(rig) == "<Rig: 2 nodes, 2 joints, 1 skin, 0 clips>"
    assert repr(replace(chain((0, 0, 0)), clips=(Clip("a", ()),))) == "<Rig: 1 node, 1 joint, 1 skin, 1 clip>"


def test_new_nodes_come_in_between_right_before_the_nodes_below_them() -> None:
    rig = chain((0, 0, 0), (1, 2, 0), (3, 0, 0))
    found = rig.insert_above({0: "top", 2: "mid"})
    assert found.names == ("top", "a", "b", "mid", "c")
    assert found.parents.tolist() == [-1, 0, 1, 2, 3]
    assert found.skins[0].joints.tolist() == [1, 2, 4]
    assert_allclose(found.world[[1, 2], 3, :3], rig.world[[0, 1], 3, :3])


def test_rules_and_edits_follow_nodes_to_their_new_numbers() -> None:
    new = [2, 0, 1]
    rules = FormatRules(
        fixed={0: "held"},
        world_aligned=frozenset([1]),
        data_nodes=frozenset([2]),
        instances={2: 1},
        group_parent=1,
    )
    moved = rules.reordered(new)
    assert (moved.fixed, moved.world_aligned, moved.data_nodes) == ({2: "held"}, {0}, {1})
    assert (moved.instances, moved.group_parent) == ({1: 0}, 0)
    assert FormatRules().reordered(new).group_parent == -1
    values = np.array([[1.0], [2.0], [3.0]])
    assert rules.shared(values).tolist() == [[1.0], [2.0], [2.0]]
    assert values.tolist() == [[1.0], [2.0], [3.0]]
    assert FormatRules().shared(values) is values
    edits = PendingEdits(morph_weights={0: values, 1: values}, removed=frozenset([0, 2]))
    assert edits.reordered([-1, 0, 1]).removed == {1}
    assert edits.reordered(new).morph_weights.keys() == {2, 0}


@pytest.mark.parametrize(
    ("edits", "changes"),
    [
        (PendingEdits(), False),
        (PendingEdits(removed=frozenset([1])), False),
        (PendingEdits(weight_limits=(WeightLimit(4),)), True),
        (PendingEdits(joint_merges=(JointMerge(0, np.arange(2), np.zeros(2), {}, False),)), True),
    ],
)
def test_only_some_edits_change_weights(edits: PendingEdits, changes: bool) -> None:
    assert edits.changes_weights == changes


def test_arms_and_front_legs_bend_back() -> None:
    limbs = [Limb(0, 1, 2, "arm"), Limb(0, 1, 2, "leg", front=True), Limb(0, 1, 2, "leg")]
    assert [limb.bends_back for limb in limbs] == [True, True, False]
