"""Node constraints do after a change of axes what they did before, in every pose, or nothing has turned.

The evaluator (`avatars.Driven`) is written from the specification and compares world frames: each
may differ from the one before by the turn of its own axes alone, the same at every key.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from avatars import CONSTRAINTS, NODES, Driven, avatar, mul, quaternion
from flat_options import joints_of
from gltf_files import Builder, glb_json, small
from numpy.testing import assert_allclose
from places import slow

from rigtri.errors import FileError, GeometryError
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.vrm.bindings import line
from rigtri.frames.reframe import reframe
from rigtri.frames.reoriented_constraints import broken
from rigtri.maths.quaternions import IDENTITY, from_axis_angle, multiply, rotates
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import PRESETS
from rigtri.operations.option_kinds import Selection
from rigtri.operations.orient_joints.constraint_policy import bonds
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.operations.orient_joints.scale_policy import cardinal_rotations
from rigtri.report import Report

WEIGHTS = {name: weight for name, (_, _, _, weight) in CONSTRAINTS.items()}
ALL = Selection(joints=("*",))


def opened(builder: Builder, folder: Path) -> Rig:
    return GltfDocument.read(builder.glb(folder / "a.vrm")).rig


def turns_between(before: Rig, after: Rig) -> np.ndarray:
    """How the axes of each node have turned in themselves: the same at rest as at every key."""
    was, now = Driven(before, None), Driven(after, None)
    back = [-1, -1, -1, 1]
    return np.array([mul(was.world(k)[0] * back, now.world(k)[0]) for k in range(len(before))])


def deviation(before: Rig, after: Rig, weights: Mapping[str, float] = WEIGHTS) -> float:
    """The largest difference of any world frame at any key, its own turn of axes taken out."""
    turns, worst = turns_between(before, after), 0.0
    for key in range(4):
        was, now = Driven(before, key, weights), Driven(after, key, weights)
        for node in range(len(before)):
            (q, position), (p, place) = was.world(node), now.world(node)
            expected = mul(q, turns[node])
            apart = min(np.abs(p - expected).max(), np.abs(p + expected).max())
            worst = max(worst, apart, np.abs(position - place).max())
    return worst


def stored(seed: int, *, cardinal: tuple[str, ...] = ()) -> dict[str, object]:
    """Turns for every joint as --frames holds them: random, or onto axes."""
    random = np.random.default_rng(seed)
    onto = cardinal_rotations()
    joints = {
        name: (onto[random.integers(24)] if name in cardinal else quaternion(random)).tolist()
        for name in NODES
        if name not in ("plate", "badge", "body")
    }
    return {"rigtri": "frames", "v": 1, "joints": joints}


def test_the_line_above_a_node_ends_with_the_root() -> None:
    assert list(line(3, [-1, 0, 1, 1])) == [3, 1, 0]


@pytest.mark.ci
@pytest.mark.parametrize("seed", [0, 1, *map(slow, range(2, 6))])
def test_constraints_move_everything_as_before_whatever_reorientation_is_requested(
    seed: int, tmp_path: Path
) -> None:
    rig = opened(avatar(seed), tmp_path)
    after = orient_joints(rig, options=OrientJointsOptions(frames=stored(seed, cardinal=tuple(CONSTRAINTS))))
    assert deviation(rig, after) < 1e-9
    # Nothing of this is empty: what is driven moves, and the free joints have turned.
    at = [Driven(rig, key, WEIGHTS).world(NODES["sleeve_end"])[1] for key in (0, 1)]
    assert np.abs(at[0] - at[1]).max() > 0.01
    assert rotates(turns_of(rig, after))[[NODES[n] for n in ("hips", "hand", "finger", "sleeve")]].all()


@pytest.mark.ci
@pytest.mark.parametrize(
    "preset", ["blender", "maya", *map(slow, sorted(PRESETS.keys() - {"blender", "maya"}))]
)
def test_constraints_mean_the_same_under_every_preset(preset: str, tmp_path: Path) -> None:
    rig = opened(avatar(1), tmp_path)
    for selection in (Selection(), ALL):
        after = orient_joints(rig, options=OrientJointsOptions(preset=preset, **joints_of(selection)))
        assert deviation(rig, after) < 1e-9


@pytest.mark.ci
def test_a_reorientation_that_a_constraint_forbids_is_seen_by_the_evaluator(tmp_path: Path) -> None:
    rig = opened(avatar(2), tmp_path)
    for name in CONSTRAINTS:
        turns = np.tile(IDENTITY, (len(rig), 1))
        turns[NODES[name]] = quaternion(np.random.default_rng(3))
        with pytest.raises(ValueError, match=name):
            reframe(rig, turns)
        careless = reframe(replace(rig, node_constraints=()), turns)
        assert deviation(rig, replace(careless, node_constraints=rig.node_constraints)) > 1e-3


def test_joints_that_a_rotation_constraint_ties_are_reoriented_as_their_source(tmp_path: Path) -> None:
    rig, report = opened(avatar(3), tmp_path), Report()
    after = orient_joints(rig, options=OrientJointsOptions(**joints_of(ALL)), report=report)
    turns = turns_between(rig, after)
    source = turns[NODES["upper_arm"]]
    assert rotates(turns_of(rig, after)[NODES["upper_arm"]])
    for name in ("sleeve", "cuff"):
        assert_allclose(turns[NODES[name]] * np.sign(turns[NODES[name]] @ source), source, atol=1e-12)
    told = [notice.text for notice in report.warnings if notice.code == "constraint"]
    assert any("'sleeve', 'cuff' can only be re-oriented as 'upper_arm' is" in text for text in told)
    follows = {entry["joint"]: entry.get("follows") for entry in report.joints}
    assert follows["sleeve"] == follows["cuff"] == "upper_arm"
    assert follows["upper_arm"] is None


def test_a_source_is_reoriented_although_what_copies_it_was_not_named(tmp_path: Path) -> None:
    rig, report = opened(avatar(3), tmp_path), Report()
    after = orient_joints(rig, options=OrientJointsOptions(joints=("upper_arm",)), report=report)
    turns = rotates(turns_of(rig, after))
    # The lower arm too: what rolls below it goes by the upper arm's axes.
    assert {name for name in NODES if turns[NODES[name]]} == {"upper_arm", "sleeve", "cuff", "lower_arm"}
    assert not [notice for notice in report.warnings if notice.code == "constraint"]


@pytest.mark.ci
def test_what_is_driven_does_not_reorient_its_source(tmp_path: Path) -> None:
    rig, report = opened(avatar(3), tmp_path), Report()
    options = OrientJointsOptions(joints=("sleeve", "hand"))
    after = orient_joints(rig, options=options, report=report)
    assert {name for name in NODES if rotates(turns_of(rig, after))[NODES[name]]} == {"hand"}
    reasons = {entry["joint"]: entry.get("reason", "") for entry in report.joints}
    assert reasons["sleeve"].startswith("'upper_arm' stays (not selected)")


@pytest.mark.ci
def test_a_driven_node_that_is_no_joint_follows_and_one_that_leads_stays(tmp_path: Path) -> None:
    builder = avatar(3, without=tuple(CONSTRAINTS))
    for node, source in (("badge", "upper_arm"), ("hair", "plate")):
        rule = {"rotation": {"source": NODES[source], "weight": 0.5}}
        extension = {"specVersion": "1.0", "constraint": rule}
        builder.gltf["nodes"][NODES[node]]["extensions"] = {"VRMC_node_constraint": extension}
    rig, report = opened(builder, tmp_path), Report()
    after = orient_joints(rig, report=report)
    turns = turns_of(rig, after)
    assert_allclose(turns[NODES["badge"]], turns[NODES["upper_arm"]], atol=1e-9)
    assert rotates(turns)[NODES["upper_arm"]]
    assert not rotates(turns)[[NODES["hair"], NODES["plate"]]].any()
    assert after.names[-1] == "badge_payload"
    assert deviation(rig, after, {"badge": 0.5, "hair": 0.5}) < 1e-9


@pytest.mark.parametrize("preset", ["article", "blender", "maya", "openxr", "vrm"])
def test_a_second_run_changes_no_byte_and_like_brings_the_rules_home(preset: str, tmp_path: Path) -> None:
    source = avatar(5).glb(tmp_path / "a.vrm")
    once, twice, home = (tmp_path / f"{name}.vrm" for name in ("once", "twice", "home"))
    options = OrientJointsOptions(preset=preset, **joints_of(ALL))
    for before, after, how in (
        (source, once, options),
        (once, twice, options),
        (once, home, OrientJointsOptions(like=GltfDocument.read(source).rig)),
    ):
        document = GltfDocument.read(before)
        document.write(orient_joints(document.rig, options=how), after, after)
    assert twice.read_bytes() == once.read_bytes() != source.read_bytes()
    rules = [[n.get("extensions") for n in glb_json(path)["nodes"][: len(NODES)]] for path in (source, home)]
    assert rules[0] == rules[1]


def test_an_excluded_joint_holds_the_source_it_copies(tmp_path: Path) -> None:
    rig, report = opened(avatar(3), tmp_path), Report()
    after = orient_joints(rig, options=OrientJointsOptions(exclude=("cuff",)), report=report)
    turns = rotates(turns_of(rig, after))
    assert not turns[[NODES[n] for n in ("upper_arm", "sleeve", "cuff", "lower_arm")]].any()
    assert turns[[NODES["hand"], NODES["spine"]]].all()
    reasons = {entry["joint"]: entry.get("reason", "") for entry in report.joints}
    assert "'cuff' stays (excluded)" in reasons["upper_arm"]


def test_a_roll_axis_is_reported_in_the_new_frame(tmp_path: Path) -> None:
    source, out = avatar(4).glb(tmp_path / "a.vrm"), tmp_path / "b.vrm"
    document = GltfDocument.read(source)
    options = OrientJointsOptions(aim="x", up="y", joints=("arm_twist", "lower_arm"))
    document.write(orient_joints(document.rig, options=options), out, out)
    constraint = glb_json(out)["nodes"][NODES["arm_twist"]]["extensions"]["VRMC_node_constraint"]
    # Its bone ran along Y, and now runs along X; weight and source are what they were.
    assert constraint["constraint"] == {"roll": {"source": NODES["hand"], "weight": 0.5, "rollAxis": "X"}}


def test_an_aim_axis_keeps_its_sign_in_the_new_frame(tmp_path: Path) -> None:
    source, out = avatar(4).glb(tmp_path / "a.vrm"), tmp_path / "b.vrm"
    document = GltfDocument.read(source)
    # A quarter about X: the old −Z is the new −Y's opposite … by hand: new Y = old Z, new Z = old −Y.
    quarter = from_axis_angle([1.0, 0, 0], np.pi / 2)
    frames = {"rigtri": "frames", "v": 1, "joints": {"gaze": quarter.tolist()}}
    document.write(orient_joints(document.rig, options=OrientJointsOptions(frames=frames)), out, out)
    constraint = glb_json(out)["nodes"][NODES["gaze"]]["extensions"]["VRMC_node_constraint"]
    assert constraint["constraint"]["aim"]["aimAxis"] == "NegativeY"


def test_only_the_destination_of_an_aim_is_held(tmp_path: Path) -> None:
    rig, report = opened(avatar(5), tmp_path), Report()
    after = orient_joints(
        rig, options=OrientJointsOptions(frames=stored(5, cardinal=("arm_twist",))), report=report
    )
    turns = rotates(turns_of(rig, after))
    assert not turns[NODES["gaze"]]
    assert turns[[NODES["head"], NODES["hand"]]].all()
    (reason,) = [entry["reason"] for entry in report.joints if entry["joint"] == "gaze"]
    assert reason == "the aim axis would not be an axis of its new frame (aim constraint of 'gaze')"


def test_noise_of_storage_does_not_hold_a_joint(tmp_path: Path) -> None:
    rig = opened(avatar(5), tmp_path)
    noisy = multiply(cardinal_rotations()[5], from_axis_angle([0.6, 0.0, 0.8], 1e-6))
    frames = {"rigtri": "frames", "v": 1, "joints": {"gaze": noisy.tolist()}}
    after = orient_joints(rig, options=OrientJointsOptions(frames=frames))
    assert rotates(turns_of(rig, after))[NODES["gaze"]]
    assert deviation(rig, after) < 1e-9


def test_on_constraint_error_names_the_joint_and_what_to_do(tmp_path: Path) -> None:
    rig = opened(avatar(3), tmp_path)
    with pytest.raises(GeometryError, match=r"'sleeve'.*rotation.*--exclude.*--on-constraint freeze"):
        orient_joints(rig, options=OrientJointsOptions(on_constraint="error"))
    free = opened(avatar(3, without=tuple(CONSTRAINTS)), tmp_path)
    orient_joints(free, options=OrientJointsOptions(on_constraint="error"))


def test_the_least_is_frozen(tmp_path: Path) -> None:
    """By default the driven twist bones stay; each bond holds what its constraints compare, no more."""
    rig = opened(avatar(6), tmp_path)
    tied = [{rig.names[node] for node in bond.nodes} for bond in bonds(rig)]
    # The lower arm is there for odd_twist, whose source is its parent.
    alone = [{"arm_twist"}, {"upper_twist"}, {"odd_twist"}, {"gaze"}]
    alone.append({"upper_arm", "sleeve", "cuff", "lower_arm"})
    assert sorted(map(sorted, tied)) == sorted(map(sorted, alone))
    report = Report()
    after = orient_joints(rig, report=report)
    turns = rotates(turns_of(rig, after))
    kept = {name for name in NODES if not turns[NODES[name]]}
    assert kept >= {"arm_twist", "upper_twist", "odd_twist", "gaze"}
    assert not kept & {
        "spine",
        "head",
        "upper_arm",
        "lower_arm",
        "hand",
        "sleeve",
        "cuff",
        "hair",
        "hair_mid",
    }


def test_a_joint_whose_constraint_reads_its_rotation_is_not_split(tmp_path: Path) -> None:
    builder = avatar(1)
    builder.gltf["nodes"][NODES["hand"]]["scale"] = [1, 1.5, 1]
    document = GltfDocument.read(builder.glb(tmp_path / "a.vrm"))
    after = orient_joints(document.rig, options=OrientJointsOptions(on_nonuniform_scale="split"))
    assert len([name for name in after.names if name.endswith("_orient")]) == 0


def test_a_node_that_a_split_inserts_leaves_constraints_where_they_were(tmp_path: Path) -> None:
    builder = avatar(1)
    builder.gltf["nodes"][NODES["hair"]]["scale"] = [1, 1.5, 1]
    del builder.gltf["extensions"]["VRMC_vrm"]  # which wants no such scales, and no splits
    source, out = builder.glb(tmp_path / "a.glb"), tmp_path / "b.glb"
    document = GltfDocument.read(source)
    after = orient_joints(document.rig, options=OrientJointsOptions(on_nonuniform_scale="split"))
    assert "hair_orient" in after.names
    document.write(after, out, out)
    again = GltfDocument.read(out).rig

    def tied(rig: Rig) -> list[tuple[str, str]]:
        return sorted((rig.names[c.node], rig.names[c.source]) for c in rig.node_constraints)

    assert tied(again) == tied(after) == tied(document.rig)
    assert len(tied(again)) == len(CONSTRAINTS)


@pytest.mark.parametrize(
    ("kind", "rule", "words"),
    [
        ("roll", {"source": 0, "rollAxis": "W"}, "one of X, Y, Z"),
        ("roll", {"source": 0, "rollAxis": 3}, "one of X, Y, Z"),
        ("aim", {"source": 0, "aimAxis": "X"}, "one of PositiveX"),
        ("aim", {"source": 99}, "no node 99"),
        ("rotation", {"source": 0.5}, "whole number"),
        ("rotation", {}, "'source' is missing"),
        ("rotation", [], "an object should stand here"),
    ],
)
def test_broken_constraints_are_named(kind: str, rule: object, words: str, tmp_path: Path) -> None:
    builder = small()
    extension = {"specVersion": "1.0", "constraint": {kind: rule}}
    builder.gltf["nodes"][1]["extensions"] = {"VRMC_node_constraint": extension}
    with pytest.raises(FileError, match=words):
        opened(builder, tmp_path)


def test_an_axis_that_is_not_written_is_the_first(tmp_path: Path) -> None:
    builder = small()
    extension = {"specVersion": "1.0", "constraint": {"aim": {"source": 2}}}
    builder.gltf["nodes"][1]["extensions"] = {"VRMC_node_constraint": extension}
    (constraint,) = opened(builder, tmp_path).node_constraints
    assert constraint.axis.tolist() == [1, 0, 0]


def test_constraints_that_wait_for_each_other_are_noticed_and_tied(tmp_path: Path) -> None:
    builder = small()
    for node, source in ((1, 2), (2, 1)):
        extension = {"specVersion": "1.0", "constraint": {"rotation": {"source": source}}}
        builder.gltf["nodes"][node]["extensions"] = {"VRMC_node_constraint": extension}
    document = GltfDocument.read(builder.glb(tmp_path / "a.vrm"))
    assert [notice.code for notice in document.warnings] == ["constraint-circle"]
    after = orient_joints(document.rig)
    assert not broken(document.rig, turns_of(document.rig, after))


def turns_of(before: Rig, after: Rig) -> np.ndarray:
    turns = turns_between(before, after)
    return np.where(np.abs(turns - IDENTITY).max(axis=1, keepdims=True) < 1e-12, IDENTITY, turns)
