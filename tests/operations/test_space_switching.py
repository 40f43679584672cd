"""Space switching: drivers whose weights have keys in clips, evaluated and baked, with and without a jump."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import SAMPLES, slow
from program import cli
from rigs import rig_of

import rigtri
from rigtri.errors import NameNotFoundError, UsageError
from rigtri.evaluation import sampling
from rigtri.evaluation.timelines import just_before, timelines
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.constraints import constraints_of
from rigtri.model.rig import Rig
from rigtri.operations.bake.bake import BakeOptions
from rigtri.report import Report

SPACES = ("world", "left", "right")
_TURN = (0.0, 0.0, np.sqrt(0.5), np.sqrt(0.5))


def hands() -> Rig:
    """Two hands and a sword; left moves along x by 2 in two seconds, right stands at y = 5 and turns."""
    names, parents = ["root", "left", "right", "sword"], [-1, 0, 0, 0]
    places = np.array([[0.0, 0, 0], [1, 0, 0], [0, 5, 0], [1, 1, 0]])
    rig = rig_of(names, parents, places, np.tile([0.0, 0, 0, 1], (4, 1)))
    times = np.array([0.0, 2.0])
    tracks = (
        Track(1, "translation", "LINEAR", times, np.array([[1.0, 0, 0], [3, 0, 0]])),
        Track(2, "rotation", "LINEAR", times, np.array([(0.0, 0, 0, 1), _TURN])),
    )
    return replace(rig, clips=(Clip("swing", tracks),))


def world(rig: Rig, node: str, *times: float) -> Floats:
    """World matrices, (f, 4, 4), of a node in the first clip."""
    clip = timelines(rig)[0].clip
    found: Floats = sampling.worlds(rig, sampling.locals_at(rig, clip, np.array(times)))[:, rig.find(node)]
    return found


def switched(rig: Rig, *switch: str, **more: Any) -> Rig:
    return rigtri.constrain(rig, child="sword", space=SPACES, switch=switch, **more)


def test_a_prop_changes_hands_at_its_offsets_of_the_rest_pose() -> None:
    baked = rigtri.bake(switched(hands(), "swing@0.5=left", "swing@1=right"), to="joints")
    assert_allclose(world(baked, "sword", 0.25)[0, 3, :3], [1, 1, 0])  # the world
    assert_allclose(world(baked, "sword", 0.75)[0, 3, :3], [1.75, 1, 0], atol=1e-6)  # left is at 1.75
    # Right has turned by 45° at 1; the sword is at (1, −4) from it at rest.
    half = np.sqrt(0.5)
    assert_allclose(
        world(baked, "sword", 1.0)[0, 3, :3], [half + 4 * half, 5 + half - 4 * half, 0], atol=1e-6
    )


@pytest.mark.parametrize(("node", "name"), [("left", "lost"), ("other", "left")])
def test_a_constraint_on_a_node_that_was_renamed_is_named_as_it_is_left_out(node: str, name: str) -> None:
    report, rig = Report(), hands()
    rig = rig.with_nodes(["other"], [0], np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    for child, driver in (("sword", "left"), ("right", "root")):
        rig = rigtri.constrain(rig, child=child, driver=[driver])
    called = tuple(name if each == node else each for each in rig.names)
    rigtri.bake(replace(rig, names=called), options=BakeOptions(to="joints"), report=report)
    (found,) = [notice for notice in report.warnings if notice.code == "constraint-lost"]
    assert found.names == ("left",)


@pytest.mark.ci
def test_matched_switches_do_not_jump_and_follow_from_there() -> None:
    rig = switched(hands(), "swing@0.5=left", "swing@1=right", match=True)
    baked = rigtri.bake(rig, to="joints")
    for time in (0.5, 1.0):
        before, after = world(baked, "sword", float(just_before(np.array([time]))[0]), time)
        assert_allclose(before, after, atol=1e-5)
    # Taken by the left hand at (1, 1) while that is at 1.5, at (1.5, 1) by the right one.
    assert_allclose(world(baked, "sword", 0.75)[0, 3, :3], [1.25, 1, 0], atol=1e-6)
    # At 2 the right hand has turned by 45° more.
    half = np.sqrt(0.5)
    x, y = 1.5 * half + 4 * half, 1.5 * half - 4 * half
    assert_allclose(world(baked, "sword", 2.0)[0, 3, :3], [x, 5 + y, 0], atol=1e-5)


def test_a_constraint_that_moves_what_another_was_matched_with_says_so() -> None:
    rig = switched(hands(), "swing@0.5=left", match=True)
    for options, told in (
        ({"type": "point", "driver": "right"}, True),
        ({"type": "scale", "driver": "root"}, False),
    ):
        report = Report()
        rigtri.constrain(rig, child="left", report=report, **options)
        assert ("match-outdated" in {notice.code for notice in report.warnings}) is told


def test_a_matched_switch_to_where_the_child_is_anyway_needs_no_driver_of_its_own() -> None:
    """A hand that stands still has the sword where it holds it at rest; one that has moved has not."""
    first, still = hands(), np.eye(3)[[0, 0]]
    track = replace(first.clips[0].tracks[0], values=still)
    for clip, more in ((Clip("swing", (track,)), ()), (first.clips[0], ("left", "world", "left"))):
        rig = replace(first, clips=(clip,))
        out = switched(rig, "swing@0.5=left", "swing@1=world", "swing@2=left", match=True)
        world, *drivers = (out.names[node] for node in constraints_of(out).popitem()[1].drivers)
        assert drivers == ["left", "right", *(world if name == "world" else name for name in more)]


def test_a_driver_that_counts_from_the_start_of_a_clip_takes_over_there_too() -> None:
    """The left hand is at 2 from the start of a clip: before, the sword was put beside it as at rest."""
    first = hands()
    moved = replace(first.clips[0].tracks[0], values=np.array([[2.0, 0, 0], [3, 0, 0]]))
    rig = replace(first, clips=(Clip("swing", (moved, first.clips[0].tracks[1])),))
    baked = rigtri.bake(switched(rig, "swing@0=left", match=True), to="joints")
    assert_allclose(world(baked, "sword", 0.0, 1.0)[:, 3, :3], [[1, 1, 0], [1.5, 1, 0]], atol=1e-6)
    fading = {"swing": {"times": [0, 2], "world": [1, 0], "left": [0, 1], "interpolation": "LINEAR"}}
    faded = rigtri.bake(switched(rig, weight_keys=fading, match=True), to="joints")
    assert_allclose(world(faded, "sword", 0.0, 2.0)[:, 3, :3], [[1, 1, 0], [2, 1, 0]], atol=1e-6)


def test_a_world_that_clips_move_is_named() -> None:
    """In USD what rigtri adds is below the character: before, a hand went with that without a word."""
    rig = hands()
    rig = replace(rig, rules=replace(rig.rules, group_parent=0))
    track = replace(rig.clips[0].tracks[0], node=0)
    for clip, codes in ((rig.clips[0], []), (Clip("swing", (track,)), ["world-moves"])):
        report = Report()
        moved = replace(rig, clips=(clip,))
        rigtri.constrain(moved, child="sword", space=("left", "world"), report=report)
        assert [notice.code for notice in report.warnings] == codes


def test_weights_may_move_between_keys() -> None:
    keys = {"swing": {"times": [0, 2], "left": [1, 0], "right": [0, 1], "interpolation": "LINEAR"}}
    rig = rigtri.constrain(hands(), type="point", child="sword", driver=("left", "right=0"), weight_keys=keys)
    baked = rigtri.bake(rig, to="joints")
    # Half of left at (2, 0) with its offset (0, 1), half of right at (0, 5) with its offset (1, −4).
    assert_allclose(world(baked, "sword", 1.0)[0, 3, :3], [1.5, 1, 0], atol=1e-5)


def test_weights_come_from_a_table_too(tmp_path: Path) -> None:
    table, out = tmp_path / "keys.csv", []
    table.write_text("clip,time,left,right,interpolation\nswing,0,1,0,LINEAR\nswing,2,0,1,\n")
    rows = list(csv.DictReader(table.read_text().splitlines()))
    keys = {"swing": {"times": [0, 2], "left": [1, 0], "right": [0, 1], "interpolation": "LINEAR"}}
    for given in (rows, keys):
        rig = rigtri.constrain(hands(), child="sword", driver=("left", "right=0"), weight_keys=given)
        out.append([(rig.names[t.node], t.path, t.values.tolist()) for t in rig.clips[0].tracks])
    assert out[0] == out[1]
    biped = (SAMPLES / "biped.glb", "-o", tmp_path / "out.glb", "--child", "staff", "--driver", "hand_L")
    table.write_text("clip,time,hand_L\nwalk,0,1\nwalk,0.5,much\n")
    told = cli("constrain", *biped, "--weight-keys", table, code=2).stderr
    assert "--weight-keys, row 2: hand_L 'much' is not a number" in told


def test_weights_are_copied_from_a_channel() -> None:
    rig = hands()
    switch = Track(0, "scale", "STEP", np.array([0.0, 1.0]), np.array([[1.0, 1, 1], [0.25, 1, 1]]))
    rig = replace(rig, clips=(replace(rig.clips[0], tracks=(*rig.clips[0].tracks, switch)),))
    given = {"driver": ("left", "right=0"), "weight_from": ("right=root.SX",)}
    rule = next(iter(constraints_of(out := rigtri.constrain(rig, child="sword", **given)).values()))
    tracks = {
        out.names[t.node]: t.values[:, 0].tolist() for t in out.clips[0].tracks if t.node in rule.weight_nodes
    }
    assert tracks == {"sword_weight_left": [0.0, 0.75], "sword_weight_right": [1.0, 0.25]}


def test_a_second_run_changes_nothing_and_keeps_the_keys_of_other_clips() -> None:
    rig = hands()
    rig = replace(rig, clips=(*rig.clips, replace(rig.clips[0], name="throw")))
    once = switched(rig, "swing@0.5=left", match=True)
    again = switched(once, "swing@0.5=left", match=True)
    assert (again.names, again.metadata) == (once.names, once.metadata)
    assert all(a is b for a, b in zip(again.clips, once.clips, strict=True))
    both = switched(once, "throw@1=right", match=True)
    assert len(constraints_of(both).popitem()[1].drivers) == 5
    before, after = (world(rigtri.bake(each, to="joints"), "sword", 0.75, 1.5) for each in (once, both))
    assert_allclose(before, after, atol=1e-6)
    plain = rigtri.constrain(both, child="sword", driver=("left",))
    assert not plain.nodes_of("constraintWeight")


@pytest.mark.parametrize("suffix", ["glb", slow("usda")])
def test_a_second_run_may_name_another_space(suffix: str, tmp_path: Path) -> None:
    """The node of a driver that is gone becomes that of the new one. Before, no file could be written."""
    rig = rigtri.add_controls(rigtri.read(SAMPLES / f"biped.{suffix}"), limbs="auto", root_control=True)
    clip = rig.clips[0]
    moment = f"{clip.name}@{clip.tracks[0].times[-1] / 2:g}"
    once, twice = tmp_path / f"once.{suffix}", tmp_path / f"twice.{suffix}"
    child: dict[str, Any] = {"child": "hand_L_ik_ctl"}
    rig = rigtri.constrain(rig, **child, space=("root", "head"), switch=(f"{moment}=head",))
    rigtri.write(rig, once)
    rig = rigtri.constrain(rigtri.read(once), **child, space=("root", "spine"))
    rigtri.write(rig, twice)
    found = rigtri.read(twice)
    (rule,) = constraints_of(found).values()
    assert [found.names[node] for node in rule.drivers] == ["hips_root_ctl", "spine"]
    weight = found.find("hand_L_ik_ctl_offset_weight_spine")
    assert weight in rule.weight_nodes
    assert len(found.nodes_of("constraintWeight")) == 2
    held = [track.values for each in found.clips for track in each.tracks if track.node == weight]
    assert not any(values.any() for values in held)
    rigtri.bake(found, to="joints")


@pytest.mark.parametrize("suffix", ["glb", slow("usda")])
def test_a_control_is_switched_by_its_offset_and_keeps_its_keys(suffix: str, tmp_path: Path) -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / f"biped.{suffix}"), limbs="auto", root_control=True)
    rig = rigtri.bake(rig, to="controls", clip=("walk",))
    end = float(sampling.key_times(timelines(rig)[0].clip)[-1])
    switch, spaces = (f"walk@{end / 2}=chest",), ("root", "chest", "world")
    rig = rigtri.constrain(rig, child="hand_L_ik_ctl", space=spaces, switch=switch, match=True)
    (rule,) = constraints_of(rig).values()
    assert rig.names[rule.child] == "hand_L_ik_ctl_offset"
    out = tmp_path / f"out.{suffix}"
    rigtri.write(rig, out, verify=False)
    assert not [one for one in rigtri.check(out) if one.severity != "info"]
    baked = rigtri.bake(read := rigtri.read(out), to="joints")
    before, after = world(baked, "hand_L", float(just_before(np.array([end / 2]))[0]), end / 2)
    assert_allclose(before, after, atol=1e-5)
    (rule,) = constraints_of(read).values()
    weight = timelines(read)[0].track(rule.weight_nodes[-1], "translation")
    assert weight is not None
    assert_allclose(sampling.sample(weight, np.array([0.4, 0.6]) * end)[:, 0], [0, 1])


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"switch": ("swing@1=up",)}, UsageError, "one of world, left, right"),
        ({"switch": ("swung@1=left",)}, NameNotFoundError, "swung"),
        ({"switch": ("rest=left",)}, UsageError, "at rest"),
        ({"space": ("root", "left")}, UsageError, "no root control"),
        ({"space": ("left", "left")}, UsageError, "twice"),
        ({"weight_keys": {"swing": {"left": [1]}}}, UsageError, "times"),
        ({"weight_keys": {"swing": {"times": [1, 0], "left": [1, 1]}}}, UsageError, "rise"),
        ({"weight_keys": {"swing": {"times": [0, 1], "left": [1]}}}, UsageError, "2 numbers"),
        ({"weight_keys": {"swing": {"times": [0], "left": [-1]}}}, UsageError, "from 0 on"),
        ({"weight_keys": {"swing": {"times": [0, 1], "left": [0, 0]}}}, UsageError, "every weight is 0"),
        ({"weight_keys": {"swing": {"times": [0], "top": [1]}}}, UsageError, "not one of the drivers"),
        ({"weight_from": ("left=root.rx",)}, UsageError, "CHANNEL"),
        ({"type": "aim", "match": True}, UsageError, "space= means nothing"),
        ({"type": "orient", "space": ("local",)}, UsageError, 'driver_space="local"'),
    ],
)
def test_what_is_no_switch_is_refused(given: dict[str, Any], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        rigtri.constrain(hands(), **({"child": "sword", "space": SPACES} | given))


@pytest.mark.ci
def test_a_pole_vector_is_switched_too() -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), limbs="auto")
    rig = rigtri.bake(rig, to="controls", clip=("walk",))
    given = {
        "type": "polevector",
        "limb": ("thigh_L", "shin_L", "foot_L"),
        "driver": ("foot_L_ik_ctl", "head=0"),
    }
    held, moved = (
        rigtri.bake(rigtri.constrain(rig, switch=switch, **given), to="joints")
        for switch in ((), ("walk@0.5=head",))
    )
    apart = np.abs(world(held, "shin_L", 0.25, 0.75) - world(moved, "shin_L", 0.25, 0.75)).max(axis=(1, 2))
    assert apart[0] < 1e-6
    assert apart[1] > 1e-3


def test_the_other_side_gets_a_switch_of_its_own() -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), limbs="auto")
    rig = rigtri.constrain(
        rig, child="hand_L_ik_ctl", space=("world", "chest"), switch=("walk@0.5=chest",), match=True
    )
    out = rigtri.mirror(rig, from_side="left")
    right = next(rule for rule in constraints_of(out).values() if out.names[rule.child].startswith("hand_R"))
    assert [out.names[node] for node in right.weight_nodes] == [
        "hand_R_ik_ctl_offset_weight_world",
        "hand_R_ik_ctl_offset_weight_chest",
    ]


def test_strip_takes_switches_out(tmp_path: Path) -> None:
    keys = {"walk": {"times": [0, 0.5], "chest": [0, 1], "head": [1, 0]}}
    source = rigtri.read(SAMPLES / "biped.glb")
    rig = rigtri.constrain(source, child="toe_L", driver=("head", "chest=0"), weight_keys=keys)
    out, back = tmp_path / "out.glb", tmp_path / "back.glb"
    rigtri.write(rig, out)
    rigtri.write(rigtri.strip(rigtri.read(out)), back)
    assert rigtri.read(back).names == source.names
    assert [len(c.tracks) for c in rigtri.read(back).clips] == [len(c.tracks) for c in source.clips]


def test_a_switch_outside_of_its_clip_is_refused() -> None:
    words = ["--child", "hand_L", "--space", "hips", "--space", "chest", "--switch", "walk@99=chest"]
    told = cli("constrain", SAMPLES / "biped.glb", "-n", *words, code=2).stderr
    assert "clip 'walk' runs from 0 to 1" in told
