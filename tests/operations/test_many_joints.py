"""Deep, wide and crowded rigs: nothing recurses, nothing is asked of every pair of joints."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from calls import calls
from gltf_files import Builder
from program import cli
from rigs import chain, random_rig, rig_of

from rigtri.evaluation.bind_pose import bind_worlds
from rigtri.formats import read
from rigtri.maths.matrices import inverse
from rigtri.model.addresses import DEEPEST_PATH
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_twist.twist import AddTwistOptions, _bones, _check_names, add_twist
from rigtri.operations.merge_joints import MergeJointsOptions, merge_joints
from rigtri.operations.take_clips.node_matching import pairs
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.recognition.bend_direction import between
from rigtri.report import Notice, Report
from rigtri.verification.compare.correspondence import match

DEEP = sys.getrecursionlimit() + 500


def rope(path: Path, joints: int) -> Path:
    """A zigzag chain of joints, each animated, with a point on each; the last three are an arm."""
    b = Builder()
    nodes = [
        {"name": f"j{k}", "translation": [0, 1, 0.1 * (k % 3)], "children": [k + 1]} for k in range(joints)
    ]
    del nodes[-1]["children"]
    for node, name in zip(nodes[-3:], ("upperarm_l", "forearm_l", "hand_l"), strict=True):
        node["name"] = name
    places = np.cumsum([node["translation"] for node in nodes], axis=0)
    bind = np.tile(np.eye(4), (joints, 1, 1))
    bind[:, 3, :3] = -places
    numbers = np.zeros((joints, 4))
    numbers[:, 0] = np.arange(joints)
    primitive = {
        "POSITION": b.accessor(np.add(places, [0.5, 0, 0])),
        "JOINTS_0": b.accessor(numbers, "u2"),
        "WEIGHTS_0": b.accessor(np.tile([1.0, 0, 0, 0], (joints, 1))),
    }
    turn = math.sin(0.2 / joints), math.cos(0.2 / joints)
    times = b.accessor([0, 1], min=[0], max=[1])
    turns = b.accessor([[0, 0, 0, 1], [turn[0], 0, 0, turn[1]]])
    channels = [{"sampler": k, "target": {"node": k, "path": "rotation"}} for k in range(joints)]
    b.gltf |= {
        "scenes": [{"nodes": [0, joints]}],
        "nodes": [*nodes, {"mesh": 0, "skin": 0}],
        "meshes": [{"primitives": [{"attributes": primitive}]}],
        "skins": [{"joints": list(range(joints)), "inverseBindMatrices": b.accessor(bind.reshape(-1, 16))}],
        "animations": [{"samplers": [{"input": times, "output": turns}] * joints, "channels": channels}],
    }
    return b.glb(path)


def went_through_all_commands(source: Path, folder: Path) -> None:
    """orient-joints, add-polevector, inspect and verify, each with its own proof."""
    turned, pole = folder / "turned.glb", folder / "pole.glb"
    report = folder / "report.json"
    for arguments in (
        ["orient-joints", source, "-o", turned, "--report", report],
        ["add-polevector", turned, "-o", pole, "--limbs", "auto"],
        ["inspect", turned],
        ["verify", source, pole],
    ):
        result = cli(*arguments)
        assert result.exit_code == 0, (arguments[0], result.output[-500:])
    joints = json.loads(report.read_text("utf-8"))["joints"]
    count = len(read(source).rig) - 1
    assert sum(joint["status"] == "turned" for joint in joints) >= count - 2


@pytest.mark.slow
def test_a_chain_deeper_than_the_recursion_limit_goes_through_every_command(tmp_path: Path) -> None:
    went_through_all_commands(rope(tmp_path / "rope.glb", DEEP), tmp_path)


@pytest.mark.slow
def test_a_chain_of_10_000_joints_goes_through_every_command(tmp_path: Path) -> None:
    went_through_all_commands(rope(tmp_path / "rope.glb", 10_000), tmp_path)


def above(rig: Rig, node: int) -> set[int]:
    """The node and all above it, looked up one by one."""
    found = set()
    while node >= 0:
        found.add(node)
        node = int(rig.parents[node])
    return found


@pytest.mark.parametrize("seed", range(8))
def test_below_follows_from_the_parents(seed: int) -> None:
    rig = random_rig(seed, joints=12)
    for node in range(12):
        assert rig.below(node) == [k for k in range(12) if node in above(rig, k)]
        assert [rig.is_below(k, node) for k in range(12)] == [node in above(rig, k) for k in range(12)]


@pytest.mark.parametrize("seed", range(8))
def test_what_lies_between_joints_ends_at_the_first_joint_above_all_of_them(seed: int) -> None:
    rig = random_rig(seed, joints=12)
    nodes = np.random.default_rng(seed).permutation(12)[:3].tolist()
    lines = [above(rig, node) for node in nodes]
    shared = set.intersection(*lines)
    small, places = between(rig, nodes)
    wanted = set.union(*lines) - shared | ({max(shared)} if shared else set())
    assert sorted(small.names) == sorted(rig.names[node] for node in wanted)
    assert [small.names[place] for place in places] == [rig.names[node] for node in nodes]
    tracks = [(rig.names[t.node], t.path) for t in rig.clips[0].tracks if t.node in wanted]
    assert sorted((small.names[t.node], t.path) for t in small.clips[0].tracks) == sorted(tracks)


@pytest.mark.parametrize("seed", range(4))
def test_joints_of_a_skin_stand_at_their_bind_places_and_the_rest_follows(seed: int) -> None:
    rig = random_rig(seed, joints=9)
    skin = replace(rig.skins[0], joints=rig.skins[0].joints[::2], inverse_bind=rig.skins[0].inverse_bind[::2])
    posed = bind_worlds(rig, skin)
    top = int(np.argmin(skin.joints))
    placed = skin.inverse_bind[top] @ rig.world[skin.joints[top]]
    bind = dict(zip(skin.joints.tolist(), np.linalg.inv(skin.inverse_bind) @ placed, strict=True))
    for node, parent in enumerate(rig.parents.tolist()):
        follows = rig.local[node] @ posed[parent] if parent >= 0 else rig.local[node]
        assert np.allclose(posed[node], bind.get(node, follows))


def test_a_path_ends_where_it_would_be_endless() -> None:
    n = DEEPEST_PATH + 2
    rig = rig_of(["bone"] * n, list(range(-1, n - 1)), np.ones((n, 3)))
    assert rig.path(2) == "/bone/bone/bone"
    assert rig.path(DEEPEST_PATH) == "/bone" * (DEEPEST_PATH + 1)
    assert rig.path(DEEPEST_PATH + 1) == f"#{DEEPEST_PATH + 1}"
    assert rig.address(DEEPEST_PATH + 1) == f"#{DEEPEST_PATH + 1}"
    assert rig.find(f"#{DEEPEST_PATH + 1}") == DEEPEST_PATH + 1


def test_nodes_of_deep_chains_find_their_partners_by_their_whole_path() -> None:
    n = DEEPEST_PATH + 40
    names, parents = [f"j{k}" for k in range(n)], list(range(-1, n - 1))
    here = rig_of(names, parents, np.ones((n, 3)))
    # In the other file a node stands before the chain, so that no label fits any more.
    there = rig_of(["first", *names], [-1, -1, *range(1, n)], np.ones((n + 1, 3)))
    assert match(here, there, by_key=False).node.tolist() == list(range(1, n + 1))


def test_a_numbered_limb_is_the_first_three_joints_below_each_other() -> None:
    from rigtri.recognition.limbs import recognise

    names = ["torso", "leg_joint_L_1", "leg_joint_L_2", "leg_joint_L_3", "leg_joint_L_4"]
    # Where a joint of the count hangs elsewhere, nobody knows which is the third.
    for parents, limbs in (([-1, 0, 1, 2, 3], [(1, 2, 3)]), ([-1, 0, 1, 2, 1], []), ([-1, 0, 1, 1, 2], [])):
        rig = rig_of(names, parents, np.ones((5, 3)))
        assert [limb.triple for limb in recognise(rig)] == limbs


def test_words_that_were_written_are_not_written_again() -> None:
    report = Report()
    report.warn("a", "one")
    report.warnings.append(Notice("b", "two"))
    report.extend([Notice("b", "two"), Notice("a", "one"), Notice("c", "three"), Notice("c", "three")])
    report.warn("c", "three")
    assert [notice.text for notice in report.warnings] == ["one", "two", "three"]


def test_a_long_straight_chain_that_nothing_bends_is_straight(tmp_path: Path) -> None:
    from rigtri.operations.orient_joints.orient import orient_joints

    rig = chain(*[(0.0, float(k), 0.0) for k in range(8)])
    report = Report()
    orient_joints(rig, report=report)
    assert [notice.code for notice in report.warnings] == ["straight"]


def test_a_merge_of_four_times_as_many_joints_takes_four_times_as_long(tmp_path: Path) -> None:
    """Before, 500 joints in a row took three seconds, and ten times as many a quarter of an hour."""
    few, many = (read(rope(tmp_path / f"{joints}.glb", joints)).rig for joints in (50, 200))
    once = calls(lambda: merge_joints(few, options=MergeJointsOptions(max_joints=25)))
    assert calls(lambda: merge_joints(many, options=MergeJointsOptions(max_joints=100))) < 5 * once


@pytest.mark.ci
def test_controls_of_four_times_as_many_joints_take_four_times_as_long(tmp_path: Path) -> None:
    """Before, 1,000 joints in a row took half a minute, and 5,000 did not end."""
    options = AddControlsOptions(whole_character=True)
    few, many = (read(rope(tmp_path / f"{joints}.glb", joints)).rig for joints in (100, 400))
    once = calls(lambda: add_controls(few, options=options))
    assert calls(lambda: add_controls(many, options=options)) < 5 * once


def row_of_characters(count: int) -> Rig:
    """Characters of three joints and a skin each, beside each other; a clip turns all."""
    names = [f"{joint}{k}" for k in range(count) for joint in ("hip", "knee", "foot")]
    parents = [3 * k + above for k in range(count) for above in (-1 - 3 * k, 0, 1)]
    steps = np.tile([[0.0, 2.0, 0.0], [0.0, -1.0, 0.1], [0.0, -1.0, -0.1]], (count, 1))
    steps[::3, 0] = np.arange(count)
    rig = rig_of(names, parents, steps)
    skins = tuple(
        Skin(f"skin{k}", np.arange(3 * k, 3 * k + 3), inverse(rig.world[3 * k : 3 * k + 3]))
        for k in range(count)
    )
    turns = np.array([[0.0, 0.0, 0.0, 1.0], [0.6, 0.0, 0.0, 0.8]])
    tracks = tuple(Track(n, "rotation", "LINEAR", np.array([0.0, 1.0]), turns) for n in range(3 * count))
    return replace(rig, skins=skins, clips=(Clip("bow", tracks),))


def test_motion_of_four_times_as_many_characters_is_taken_in_four_times_as_long() -> None:
    """Before, where all joints are bound was worked out again for each that carries a body."""
    few, many = row_of_characters(4), row_of_characters(16)
    once = calls(lambda: take_clips(few, from_=few))
    assert calls(lambda: take_clips(many, from_=many)) < 5 * once


@pytest.mark.ci
def test_twist_joints_of_four_times_as_many_characters_take_four_times_as_long() -> None:
    """Before, the rig was replaced once for each: 100 characters took 8.4 times as many calls as 25."""
    few, many = (
        (row_of_characters(count), AddTwistOptions(joint=hips, to=knees, split_weights=True))
        for count in (25, 100)
        for hips, knees in [[tuple(f"{joint}{k}" for k in range(count)) for joint in ("hip", "knee")]]
    )
    once = calls(lambda: add_twist(few[0], options=few[1]))
    assert calls(lambda: add_twist(many[0], options=many[1])) < 5 * once


def crowd_of(rig: Rig, count: int) -> Rig:
    """Copies of a character beside each other, whose joints have the same names below a root of its own."""
    size, steps = len(rig), np.arange(count) * 3.0
    named = list(zip(rig.names, rig.parents.tolist(), strict=True))
    translation = np.tile(rig.translation, (count, 1, 1))
    translation[:, rig.parents < 0, 0] += steps[:, np.newaxis]
    above = np.where(rig.parents < 0, -1, rig.parents + size * np.arange(count)[:, np.newaxis])
    skins = list[Skin]()
    for k in range(count):
        bind = rig.skins[0].inverse_bind.copy()
        bind[:, 3, 0] -= steps[k]
        skins.append(Skin(f"skin{k}", rig.skins[0].joints + size * k, bind))
    tracks = (replace(t, node=t.node + size * k) for k in range(count) for t in rig.clips[0].tracks)
    clips = [replace(rig.clips[0], tracks=tuple(tracks))]
    return rig_of(
        [f"{name}{k}" if parent < 0 else name for k in range(count) for name, parent in named],
        above.reshape(-1).tolist(),
        translation.reshape(-1, 3),
        rotation=np.tile(rig.rotation, (count, 1)),
        skins=tuple(skins),
        clips=tuple(clips),
    )


@pytest.mark.ci
def test_controls_of_four_times_as_many_characters_take_little_more_than_four_times_as_long(
    samples: Path,
) -> None:
    """Before, what all nodes are called was found anew for each: 16 took 5.7 times as many calls as 4."""
    one, options = read(samples / "biped.gltf").rig, AddControlsOptions(whole_character=True)
    few, many = crowd_of(one, 4), crowd_of(one, 16)
    once = calls(lambda: add_controls(few, options=options))
    assert calls(lambda: add_controls(many, options=options)) < 5 * once


@pytest.mark.ci
def test_twist_joints_that_are_there_are_found_by_their_bones_where_a_rule_names_new_ones() -> None:
    """Before, each bone looked at the records of all: 100 characters took 12 times as many calls as 25."""
    work = []
    for count in (25, 100):
        hips, knees = (tuple(f"{joint}{k}" for k in range(count)) for joint in ("hip", "knee"))
        options = AddTwistOptions(joint=hips, to=knees, split_weights=False, name="{joint}_t{number}")
        made = add_twist(row_of_characters(count), options=options)
        work.append(calls(partial(_check_names, made, _bones(made, options, Report()), options)))
    assert work[1] < 5 * work[0]


@pytest.mark.ci
def test_motion_of_a_chain_four_times_as_long_is_taken_in_four_times_as_long(
    tmp_path: Path,
) -> None:
    """Before, the way to the root was walked a dozen times for each joint: of 2,400 eight seconds."""
    few, many = (read(rope(tmp_path / f"{joints}.glb", joints)).rig for joints in (100, 400))
    once = calls(lambda: take_clips(few, from_=few))
    assert calls(lambda: take_clips(many, from_=many)) < 5 * once


def test_four_times_as_many_joints_of_one_name_are_paired_in_four_times_as_long() -> None:
    """Before, 3,000 took a minute and more: the paths of all were compared with those of all others."""
    few, many = (
        rig_of(
            ["root", *["j"] * 2 * count],
            [-1, *[0] * count, *range(1, count + 1)],
            np.ones((2 * count + 1, 3)),
        )
        for count in (20, 80)
    )
    once = calls(lambda: pairs(few, few))
    assert calls(lambda: pairs(many, many)) < 5 * once
