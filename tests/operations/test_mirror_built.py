"""mirror of what rigtri has built: limbs, twist joints, constraints, rivets and pose readers."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Golden
from numpy.testing import assert_allclose
from places import first, slow
from program import cli
from second_opinions import validator

from rigtri.evaluation.constraint_solver import evaluate_constraint
from rigtri.evaluation.pose_readers import PoseReader, weights
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.export.text_description import describe
from rigtri.formats import read
from rigtri.frames import Mirror
from rigtri.frames.mirroring import MIRRORS, Across, mirrored_axes
from rigtri.maths.matrices import multiply as after
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import PoseReaderRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import moving_points
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader
from rigtri.operations.add_rivet.rivet import AddRivetOptions, add_rivet
from rigtri.operations.add_socket import AddSocketOptions, add_socket
from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.operations.bake.bake import bake
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.operations.make_limb import MakeLimbOptions, make_limb
from rigtri.operations.mirror.mirror import MirrorOptions, mirror
from rigtri.operations.mirror.symmetry_check import asymmetry
from rigtri.pipeline.edit import edit
from rigtri.report import Report

FILES = ["biped.glb", slow("biped.usda")]
REFLECT = np.array([-1.0, 1.0, 1.0])
WING = ((0.3, 1.2, -0.2), (0.5, 1.0, -0.3), (0.6, 0.7, -0.25))


def left(rig: Rig, report: Report | None = None) -> Rig:
    """One of everything, on the left."""
    report = report if report is not None else Report()
    wing = MakeLimbOptions(points=WING, name="wing", side="left", parent="chest")
    rig = make_limb(rig, options=wing, report=report)
    hand = AddControlsOptions(joints=("hand_L",))
    rig = add_controls(rig, options=hand, report=report)
    rig = add_twist(
        rig, options=AddTwistOptions(joint=("forearm_L",), to=("hand_L",), count=2), report=report
    )
    aim = ConstrainOptions(type="aim", child="foot_L", driver=(("hand_L", 1.0), ("chest", 2.0)))
    parent = ConstrainOptions(type="parent", child="thigh_L", driver=(("hips", 1.0), ("hand_L", 2.0)))
    for rule in (aim, parent):
        rig = constrain(rig, options=rule, report=report)
    rig = add_rivet(rig, options=AddRivetOptions("body", triangle=(310,), name=("badge_L",)), report=report)
    x, y, z = rig.world[rig.find("forearm_L"), 0, :3].tolist()
    reader = AddPosereaderOptions(
        driver="forearm_L",
        frame="upper_arm_L",
        axis=(1, 0, 0),
        target=(Goal("up", direction=(x, y, z)),),
        attribute=(("up", "hand_L_ctl", "fist"),),
        name="bent_L",
    )
    return add_posereader(rig, options=reader, report=report)


def both(rig: Rig, report: Report) -> Rig:
    return mirror(rig, report=report)


def turned(rig: Rig, **turns: Floats) -> Rig:
    """The rig with joints of both sides turned alike in their own frames."""
    rotation = rig.rotation.copy()
    for name, turn in turns.items():
        for side in "LR":
            node = rig.find(f"{name}_{side}")
            rotation[node] = multiply(rotation[node], turn)
    return replace(rig, rotation=rotation)


def about(x: float, y: float, z: float, angle: float = 0.7) -> Floats:
    return from_axis_angle(np.array([x, y, z]), angle)


def said(rig: Rig, name: str) -> dict[str, Any]:
    return dict(rig.metadata[rig.find(name, "node")])


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    from places import SAMPLES

    return mirror(left(read(SAMPLES / "biped.glb").rig))


@pytest.mark.parametrize("named", ["", "nobody"])
def test_a_chain_that_names_no_joint_is_reported_and_left_out(samples: Path, named: str) -> None:
    """Before, a joint without its name ended in a traceback."""
    options = AddControlsOptions(whole_character=True)
    rig = add_controls(read(samples / "biped.glb").rig, options=options, report=Report())
    metadata = {
        node: {**kept, "chain": [named if name == "hand_L" else name for name in kept["chain"]]}
        if "chain" in kept
        else kept
        for node, kept in rig.metadata.items()
    }
    report = Report()
    mirror(replace(rig, metadata=metadata), report=report)
    left_out = [w.text for w in report.warnings if w.code == "not-mirrored"]
    assert "control 'hand_L_ik_ctl' is not mirrored: the other side has no such joint" in left_out


@pytest.mark.parametrize(
    ("name", "value", "why"),
    [
        ("aim", "nobody", "'nobody' is not a valid axis"),
        ("up", "x" * 300, "is not a valid axis"),
        ("upFrom", "world:nobody", "'nobody' is not a valid axis"),
        ("upFrom", "nobody", "'' is not a valid direction"),
    ],
)
def test_a_limb_whose_stored_axes_are_damaged_is_left_out(
    name: str, value: str, why: str, samples: Path
) -> None:
    """Before, a traceback."""
    rig = left(read(samples / "biped.glb").rig)
    (first,) = (node for node, kept in rig.metadata.items() if kept.get("type") == "limb" and "aim" in kept)
    report = Report()
    damaged = replace(rig, metadata={**rig.metadata, first: {**rig.metadata[first], name: value}})
    mirror(damaged, report=report)
    (told,) = (w.text for w in report.warnings if "what is stored of its axes is damaged: " in w.text)
    assert why in told


@pytest.mark.parametrize("chain", [(), ("hand_L",)])
def test_a_control_whose_limb_is_not_named_is_left_out(samples: Path, chain: tuple[str, ...]) -> None:
    """Before, the IK control and the pole vector of such a limb ended in a traceback."""
    options = AddControlsOptions(limbs="auto")
    rig = add_controls(read(samples / "biped.glb").rig, options=options, report=Report())
    stored = {
        node: {**kept, "chain": chain} if kept.get("chain") and "_L_" in rig.names[node] else kept
        for node, kept in rig.metadata.items()
    }
    mirrored = mirror(replace(rig, metadata=stored))
    assert {mirrored.names[node] for node in mirrored.metadata} == {rig.names[node] for node in rig.metadata}


@pytest.mark.ci
@pytest.mark.parametrize("name", FILES)
def test_all_of_one_side_is_built_on_the_other_once_and_nothing_else_moves(
    name: str, samples: Path, tmp_path: Path, golden: Golden
) -> None:
    one, once, twice = (tmp_path / f"{word}_{name}" for word in ("one", "once", "twice"))
    edit(samples / name, one, left)
    outcome = edit(one, once, both)
    assert outcome.verification is not None
    assert outcome.verification.deviation < 2e-6
    # The reader of the source is met at rest, and so is its twin; what follows now has keys in a clip.
    assert {notice.code for notice in outcome.report.warnings} <= {"target-at-rest", "mirror-moves"}
    kinds = {entry["type"] for entry in outcome.report.added if entry["new"]}
    assert kinds == {"limb", "control", "poleVector", "twist", "constraint", "rivet", "poseReader"}
    edit(once, twice, both)
    assert twice.read_bytes() == once.read_bytes()
    rig = read(once).rig
    for note in rig.metadata.values():
        validator("node").validate(note)
    found = asymmetry(rig)
    assert not found.worse()
    assert not found.alone
    golden.check(f"mirror_{name}.txt", describe(rig) + "\n")


@pytest.mark.parametrize("mode", first(MIRRORS))
def test_the_joints_of_a_limb_are_mirrored_as_the_mode_requires(mode: Mirror, samples: Path) -> None:
    out = mirror(left(read(samples / "biped.glb").rig), options=MirrorOptions(mode=mode))
    world = out.world
    for part in (1, 2, 3):
        here, there = (world[out.find(f"wing_{part}_{side}")] for side in "LR")
        assert_allclose(there[3, :3], np.array(WING[part - 1]) * [-1, 1, 1], atol=1e-7)
        wanted = mirrored_axes(nearest_rotation(here), mode, Across())
        assert_allclose(nearest_rotation(there), wanted, atol=1e-6)
    assert said(out, "wing_1_R")["chain"] == ["wing_1_R", "wing_2_R", "wing_3_R"]
    assert ("aim" in said(out, "wing_1_R")) == (mode != "orientation")


def test_equal_rotations_of_a_made_limb_and_its_mirror_image_give_a_mirrored_skin(built: Rig) -> None:
    posed = turned(built, wing_1=about(1, 2, -1), wing_2=about(-2, 1, 0.5)).world
    points = np.array([[0.1, 0.02, 0.03, 1.0], [0.0, -0.2, 0.1, 1.0]])
    for part in (1, 2, 3):
        nodes = [built.find(f"wing_{part}_{side}") for side in "LR"]
        # A point that stands mirrored at rest and hangs on the joint stays mirrored.
        bind = [np.linalg.inv(built.world[node]) for node in nodes]
        here = points @ bind[0] @ posed[nodes[0]]
        there = (points * [-1, 1, 1, 1]) @ bind[1] @ posed[nodes[1]]
        assert_allclose(here[:, :3] * REFLECT, there[:, :3], atol=1e-6)


def test_twist_joints_lie_mirrored_and_take_the_same_share(built: Rig) -> None:
    for number in (1, 2):
        here, there = (said(built, f"forearm_{side}_twist_{number}") for side in "LR")
        assert there["weight"] == here["weight"] == pytest.approx(number / 3)
        assert (there["joint"], there["to"], there["driver"]) == ("forearm_R", "hand_R", "hand_R")
        left_at, right_at = (
            built.world[built.find(f"forearm_{side}_twist_{number}"), 3, :3] for side in "LR"
        )
        assert_allclose(left_at * REFLECT, right_at, atol=1e-6)


@pytest.mark.parametrize("child", ["foot", "thigh"])
def test_mirrored_drivers_give_mirrored_children_by_the_mirrored_constraint(built: Rig, child: str) -> None:
    posed = turned(built, hand=about(1, 1, 0), forearm=about(0, 1, 1), upper_arm=about(1, 0, 2))
    world, local = posed.world, posed.normalised_local
    found = []
    for side in "LR":
        node = built.find(f"{child}_{side}")
        (rule,) = (rule for rule in constraints_of(built).values() if rule.child == node)
        above = world[int(built.parents[node])]
        at = evaluate_constraint(
            rule, world[list(rule.drivers)][np.newaxis], above[np.newaxis], local[node][np.newaxis]
        )
        found.append(after(at[0], above))
    here, there = found
    assert_allclose(here[3, :3] * REFLECT, there[3, :3], atol=1e-6)
    wanted = mirrored_axes(nearest_rotation(here), "behavior", Across())
    assert_allclose(nearest_rotation(there), wanted, atol=1e-5)  # the biped's sides differ by 1e-7
    moved = here - built.world[built.find(f"{child}_L")]
    assert np.abs(moved).max() > 1e-2


def test_a_mirrored_reader_reads_the_same_of_the_mirrored_pose(built: Rig) -> None:
    assert said(built, "bent_R")["outputs"] == [
        {"target": "up", "control": "hand_R_ctl", "attribute": "fist"}
    ]
    read_out = []
    for turn in (about(0, 0, 1, 0.0), about(0, 1, 0), about(1, 0, -1, 1.2)):
        world = turned(built, forearm=turn).world
        both_sides = []
        for side in "LR":
            note = said(built, f"bent_{side}")
            driver, frame = (world[built.find(note[key])][np.newaxis] for key in ("driver", "frame"))
            both_sides.append(
                float(
                    weights(PoseReader.of_record(PoseReaderRecord.from_dict(note)), driver, frame, {})[0, 0]
                )
            )
        assert both_sides[0] == pytest.approx(both_sides[1], abs=1e-6)
        read_out.append(both_sides[0])
    assert read_out[0] == pytest.approx(1.0)
    assert read_out[1] == pytest.approx(np.cos(0.7))


def readers(rig: Rig) -> dict[str, str]:
    """The pose readers and their drivers."""
    return {n["name"]: n["driver"] for n in rig.metadata.values() if n["type"] == "poseReader"}


@pytest.mark.ci
def test_every_reader_of_a_joint_gets_a_twin_of_its_own(samples: Path, tmp_path: Path) -> None:
    def read_twice(rig: Rig, report: Report) -> Rig:
        for name, target in (("bend", (0, 1, 0)), ("tw", (1, 0, 0)), ("bend_L", (0, 0, 1)), ("", (1, 1, 0))):
            goal = Goal("up", direction=target)
            rig = add_posereader(
                rig, options=AddPosereaderOptions(driver="forearm_L", target=(goal,), name=name)
            )
        return rig

    one, two, three, back = (tmp_path / f"{k}.glb" for k in range(4))
    edit(samples / "biped.glb", one, read_twice)
    edit(one, two, both)
    made = readers(read(two).rig)
    # "bend" makes room for the twin of "bend_L".
    twins = {"bend_R", "bend_R_2", "tw_R", "forearm_R_reader"}
    assert {name for name, driver in made.items() if driver == "forearm_R"} == twins
    assert len(made) == 8
    edit(two, three, both)
    assert three.read_bytes() == two.read_bytes()
    assert not asymmetry(read(two).rig).alone
    assert not asymmetry(read(two).rig, options=MirrorOptions(from_side="right")).alone
    edit(two, back, lambda rig, report: mirror(rig, options=MirrorOptions(from_side="right"), report=report))
    assert readers(read(back).rig) == made
    targets = {n["name"]: n["targets"] for n in read(two).rig.metadata.values() if n["type"] == "poseReader"}
    for a, b in (("bend", "bend_R_2"), ("bend_L", "bend_R"), ("tw", "tw_R")):
        lead, follow = (np.array(targets[name][0]["direction"]) for name in (a, b))
        world = read(two).rig.world
        here, there = (nearest_rotation(world[read(two).rig.find(f"upper_arm_{s}")]) for s in "LR")
        assert_allclose((lead @ here) * REFLECT, follow @ there, atol=1e-5)


def test_a_reader_alone_on_one_side_is_named_by_check(samples: Path) -> None:
    goal = Goal("up", direction=(0, 1, 0))
    rig = read(samples / "biped.glb").rig
    rig = add_posereader(rig, options=AddPosereaderOptions(driver="forearm_L", target=(goal,), name="bend"))
    assert any("bend" in text for text in asymmetry(rig).alone)


def test_a_rivet_sits_at_the_mirrored_place(built: Rig) -> None:
    here, there = (built.world[built.find(f"badge_{side}", "node"), 3, :3] for side in "LR")
    assert here[0] > 0.05
    assert_allclose(here * REFLECT, there, atol=1e-5)


def test_a_stored_number_of_twist_joints_that_are_not_there_costs_nothing(built: Rig) -> None:
    most = 10**18
    metadata = {
        node: {**kept, "count": most} if kept["type"] == "twist" else kept
        for node, kept in built.metadata.items()
    }
    assert len(mirror(replace(built, metadata=metadata))) == len(built)


def test_what_is_changed_on_one_side_is_brought_up_to_date_on_the_other(built: Rig) -> None:
    changed = add_twist(
        built, options=AddTwistOptions(joint=("forearm_L",), to=("hand_L",), count=2, weights=(0.25, 0.5))
    )
    changed = constrain(
        changed, options=ConstrainOptions(type="parent", child="thigh_L", driver=(("chest", 1.0),))
    )
    report = Report()
    out = mirror(changed, report=report)
    assert len(out) == len(built)
    assert [said(out, f"forearm_R_twist_{k}")["weight"] for k in (1, 2)] == [0.25, 0.5]
    assert said(out, "con_thigh_R_parent")["drivers"] == ["chest"]
    assert out.names == built.names
    assert {"twist", "constraint"} <= {entry["type"] for entry in report.added}


@pytest.mark.parametrize(
    ("what", "kind"),
    [("limbs", "limb"), slow("twists", "twist"), ("constraints", "constraint"), slow("rivets", "rivet")],
)
def test_only_what_is_requested_is_mirrored(what: Any, kind: str, samples: Path) -> None:
    report = Report()
    mirror(left(read(samples / "biped.glb").rig), options=MirrorOptions(what=(what,)), report=report)
    assert {entry["type"] for entry in report.added} == {kind}
    assert not report.joints


def test_what_has_no_place_on_the_other_side_is_named(samples: Path) -> None:
    rig = left(read(samples / "biped.glb").rig)
    names = tuple("arm_alone" if name == "forearm_R" else name for name in rig.names)
    report = Report()
    mirror(replace(rig, names=names), report=report)
    told = [notice.text for notice in report.warnings if notice.code == "not-mirrored"]
    assert any("twist joint 'forearm_L_twist_1'" in text for text in told)
    assert any("pose reader 'bent_L'" in text for text in told)


def test_check_names_what_only_one_side_has_and_its_json_is_as_the_schema_requires(
    samples: Path, tmp_path: Path
) -> None:
    one, two = tmp_path / "one.glb", tmp_path / "two.glb"
    edit(samples / "biped.glb", one, left)
    edit(one, two, both)
    documents = []
    for path, code in ((one, 1), (two, 0)):
        result = cli("mirror", path, "--check", "--json")
        assert result.exit_code == code
        documents.append(json.loads(result.stdout))
        validator("mirror").validate(documents[-1])
    alone = " ".join(documents[0]["without_twin"])
    for name in (
        "wing_1_L", "hand_L_ctl", "forearm_L_twist_1", "con_foot_L_aim", "badge_L", "bent_L",
    ):  # fmt: skip
        assert name in alone
    assert documents[1]["symmetric"]
    assert not validator("mirror").is_valid(documents[1] | {"symmetric": "yes"})


def test_a_mode_that_keeps_vrm_constraints_is_named_where_another_loses_them(
    assets: Path, tmp_path: Path
) -> None:
    one = tmp_path / "one.vrm"
    roll = ConstrainOptions(
        type="orient", child="hand.L", driver=(("lower_arm.L", 1.0),), roll_axis="y", vrm_constraints=True
    )
    avatar = assets / "vrm" / "addon_look_at_preview_enabled.vrm"
    edit(avatar, one, lambda rig, report: constrain(rig, options=roll, report=report))
    lost = []
    for mode in MIRRORS:
        report = Report()
        out = mirror(read(one).rig, options=MirrorOptions(mode=mode), report=report)
        told = {notice.code: notice.text for notice in report.warnings}
        kinds = [note.get("vrm") for note in out.metadata.values() if note.get("child") == "hand.R"]
        assert ("constraint-not-vrm" in told) == (kinds == [None])
        if kinds == [None]:
            lost.append(mode)
            (other,) = [text for code, text in told.items() if code == "mode-keeps-vrm"]
            kept = mirror(read(one).rig, options=MirrorOptions(mode=other.split()[1]))  # type: ignore[arg-type]
            assert [n.get("vrm") for n in kept.metadata.values() if n.get("child") == "hand.R"] == ["roll"]
        # A twin that keeps its axes for a reason of its own is a twin all the same.
        assert "'hand.R' keeps its axes, as its twin 'hand.L' is not re-oriented" in told["no-twin"]
    assert 0 < len(lost) < len(MIRRORS)


def test_a_mirrored_constraint_warns_of_keys_of_the_control_that_follows(samples: Path) -> None:
    rig = add_controls(read(samples / "biped.glb").rig, options=AddControlsOptions(whole_character=True))
    rule = ConstrainOptions(child="hand_L_ik_ctl", driver=(("head", 1.0),))
    rig = constrain(rig, options=rule)
    still, keyed, limb = Report(), Report(), Report()
    arm = {rig.find("upper_arm_R"), *rig.below(rig.find("upper_arm_R"))}
    # Or the head takes the hand along, or the clavicle the arm without its hand.
    led = {*arm, *rig.path_to_root(rig.find("head")), *rig.path_to_root(rig.find("upper_arm_R"))}
    at_rest = [replace(c, tracks=tuple(t for t in c.tracks if t.node not in led)) for c in rig.clips]
    mirror(replace(rig, clips=tuple(at_rest)), options=MirrorOptions(from_side="left"), report=still)
    assert "mirror-moves" not in {notice.code for notice in still.warnings}
    # From now on IK moves the limb in all clips; before, it moved otherwise than by its keys without a word.
    mirror(rig, options=MirrorOptions(from_side="left"), report=limb)
    (text,) = [notice.text for notice in limb.warnings if notice.code == "mirror-moves"]
    assert "upper_arm_R" in text
    assert "in walk, wave and follow" in text
    keys = Track(rig.find("hand_R_ik_ctl"), "translation", "STEP", np.zeros(1), np.full((1, 3), 0.1))
    only = replace(rig, clips=(Clip("reach", (keys,)), *at_rest))
    mirror(only, options=MirrorOptions(from_side="left"), report=keyed)
    (text,) = [notice.text for notice in keyed.warnings if notice.code == "mirror-moves"]
    assert text.startswith("hand_R_ik_ctl has keys in reach")
    rule = ConstrainOptions(type="polevector", child="hand_L", driver=(("head", 1.0),))
    pole = replace(keys, node=rig.find("forearm_R_pole"))
    rig = replace(rig, clips=(Clip("reach", (keys, pole)), *rig.clips))
    mirror(constrain(rig, options=rule), options=MirrorOptions(from_side="left"), report=keyed)
    assert "_pole have keys in reach, walk, wave and follow a" in keyed.warnings[-1].text
    # A pole vector without keys bends the limb that its IK control moves.
    rule = ConstrainOptions(child="forearm_L_pole", driver=(("head", 1.0),))
    rig, alone = replace(rig, clips=(Clip("reach", (keys,)),)), Report()
    mirror(constrain(rig, options=rule), options=MirrorOptions(from_side="left"), report=alone)
    (text,) = [notice.text for notice in alone.warnings if notice.code == "mirror-moves"]
    assert text.startswith("hand_R_ik_ctl has keys in reach")


@pytest.mark.parametrize(
    ("first", "told"),
    [
        ("chest", ["hand_R_ik_ctl has keys in reach and follows a constraint from now on"]),
        ("root", []),  # where it was before
    ],
)
def test_mirrored_spaces_warn_of_keys_that_count_from_elsewhere(
    first: str, told: list[str], samples: Path
) -> None:
    rig = add_controls(read(samples / "biped.glb").rig, whole_character=True)
    rig = constrain(rig, options=ConstrainOptions(child="hand_L_ik_ctl", space=(first, "world")))
    nodes = [rig.find(name) for name in ("hand_R_ik_ctl", "hand_L_ik_ctl", "chest_ctl")]
    keys = [Track(node, "translation", "STEP", np.zeros(1), np.full((1, 3), 0.1)) for node in nodes]
    report = Report()
    rig = replace(rig, clips=(Clip("reach", tuple(keys)),))
    mirror(rig, options=MirrorOptions(from_side="left"), report=report)
    said = [each.text.split(":")[0] for each in report.warnings if each.code == "mirror-moves"]
    assert said == told


@pytest.mark.parametrize(
    ("keyed", "told"),
    [
        ("forearm_R_pole", "forearm_R_pole has keys in reach and follows"),
        ("upper_arm_R", "upper_arm_R has keys in reach and follows"),  # by FK until now
        ("thigh_R", ""),
    ],
)
def test_a_mirrored_space_of_a_pole_vector_overrules_keys_also_where_its_parent_is(
    keyed: str, told: str, samples: Path
) -> None:
    """Before, the next bake gave other motion without a word: the limb followed IK, and its pole no keys."""
    rig = add_controls(read(samples / "biped.glb").rig, whole_character=True)
    rig = constrain(rig, options=ConstrainOptions(child="forearm_L_pole", space=("root", "world")))
    keys = Track(rig.find(keyed), "translation", "STEP", np.zeros(1), np.full((1, 3), 0.1))
    report = Report()
    mirror(replace(rig, clips=(Clip("reach", (keys,)),)), options=MirrorOptions(), report=report)
    said = [each.text for each in report.warnings if each.code == "mirror-moves"]
    assert [text.split(" a constraint")[0] for text in said] == ([told] if told else [])


@pytest.mark.parametrize(
    ("keyed", "clip"),
    [
        ("chest_ctl", "reach"),
        ("chest", "reach"),
        ("spine_ctl", "reach"),  # above the driver
        ("hips_root_ctl", ""),  # what carries both
        ("thigh_R", ""),
        ("forearm_L_ctl", ""),
    ],
)
def test_a_mirrored_constraint_warns_of_drivers_that_move_what_has_no_keys(
    keyed: str, clip: str, samples: Path
) -> None:
    """Before, IK moved a limb with a driver that has keys, and nothing said so."""
    rig = _controlled(samples)
    rig = constrain(rig, options=ConstrainOptions(child="hand_L_ik_ctl", driver=(("chest", 1.0),)))
    key = Track(rig.find(keyed), "rotation", "STEP", np.zeros(1), np.array([[0.0, 0.0, 0.6, 0.8]]))
    rig, first, second = replace(rig, clips=(Clip("reach", (key,)),)), Report(), Report()
    out = mirror(rig, options=MirrorOptions(from_side="left"), report=first)
    said = [each.text for each in first.warnings if each.code == "mirror-moves"]
    assert len(said) == bool(clip)
    assert all(text.startswith("'hand_R_ik_ctl' follows 'chest' from now on") for text in said)
    assert all(text.endswith("in reach@0") for text in said)
    mirror(out, options=MirrorOptions(from_side="left"), report=second)
    assert not [each for each in second.warnings if each.code == "mirror-moves"]


@pytest.mark.parametrize("keyed", ["clavicle_R", "hand_R_ctl", "hand_R", "hand_R_ik_ctl", "shin_R"])
@pytest.mark.parametrize("child", ["clavicle_L", "clavicle_L_ctl"])
@pytest.mark.parametrize("leads", [False, True])
def test_a_mirrored_constraint_warns_of_keys_where_its_child_moves_otherwise(
    leads: bool, child: str, keyed: str, samples: Path
) -> None:
    """Measured: before, keys below the child were named also where the driver stands still in the clip."""
    rig = add_controls(read(samples / "biped.glb").rig, whole_character=True)
    rig = constrain(rig, options=ConstrainOptions(type="orient", child=child, driver=(("head", 1.0),)))
    turned = [keyed, "head_ctl"] if leads else [keyed]
    keys = [
        Track(rig.find(name), "rotation", "STEP", np.zeros(1), np.array([[0.0, 0.0, 0.6, 0.8]]))
        for name in turned
    ]
    report = Report()
    rig = replace(rig, clips=(Clip("reach", tuple(keys)),))
    out = mirror(rig, options=MirrorOptions(from_side="left"), report=report)
    said = [each.text for each in report.warnings if each.code == "mirror-moves"]
    was, now = (bake(each) for each in (rig, out))
    joints = np.flatnonzero(rig.is_joint)
    far = np.abs(_places(was)[joints] - _places(now)[joints]).max()
    assert (far > 1e-3) == (leads or keyed == "clavicle_R")
    assert len(said) == (far > 1e-3)
    if keyed != "shin_R":
        assert all(text.startswith(f"{keyed} has keys in reach and follows a constraint") for text in said)


def _places(rig: Rig) -> Floats:
    """Where nodes are as the first clip starts, (n, 3)."""
    return worlds(rig, locals_at(rig, rig.clips[0], [0.0]))[0, :, 3, :3]


def test_a_mirrored_constraint_that_overrules_keys_of_a_pole_vector_is_named(samples: Path) -> None:
    """Before, nothing said so where the driver is what the pole vector is a child of."""
    rig = add_controls(read(samples / "biped.glb").rig, whole_character=True)
    rig = constrain(rig, child="forearm_L_pole", driver=("hips_root_ctl",))
    keys = [
        Track(rig.find(name), "translation", "STEP", np.zeros(1), np.full((1, 3), 0.1))
        for name in ("hand_R_ik_ctl", "forearm_R_pole")
    ]
    report = Report()
    mirror(replace(rig, clips=(Clip("reach", tuple(keys)),)), report=report)
    (said,) = (each.text for each in report.warnings if each.code == "mirror-moves")
    assert "forearm_R_pole have keys in reach and follow a constraint from now on" in said


@pytest.mark.parametrize("style", [{"soft": 0.3}, {"stretch": True}])
def test_mirror_warns_of_limbs_that_ik_solves_otherwise_from_now_on(style: Any, samples: Path) -> None:
    """Before, its keyed IK control gave other motion without a word."""
    rig = add_controls(read(samples / "biped.glb").rig, whole_character=True)
    rig = add_controls(rig, ik=(("upper_arm_L", "forearm_L", "hand_L"),), **style)
    told = []
    for keyed in ("hand_R_ik_ctl", "hand_L_ik_ctl"):
        key = Track(rig.find(keyed), "translation", "STEP", np.zeros(1), np.array([[0.1, 0.0, 0.0]]))
        moving, report = replace(rig, clips=(Clip("reach", (key,)),)), Report()
        mirrored = mirror(moving, options=MirrorOptions(), report=report)
        told += [each.text for each in report.warnings if each.code == "mirror-moves"]
        again = Report()
        mirror(mirrored, options=MirrorOptions(), report=again)
        assert not again.warnings
    assert told == [
        "hand_R_ik_ctl gets the softness and stretch of 'hand_L_ik_ctl': "
        "the next bake gives other motion in reach"
    ]


@pytest.mark.ci
def test_a_mirrored_constraint_warns_of_weights_that_switch_in_clips(samples: Path) -> None:
    """Keys are motion, and stay on their side; before, nothing said so."""
    rig = add_controls(read(samples / "biped.glb").rig, options=AddControlsOptions(whole_character=True))
    spaces = {"child": "hand_L_ik_ctl", "space": ("hips", "chest")}
    for switch, told in (((), []), (("walk@0.5=chest",), ["mirror-weights"])):
        built = constrain(rig, options=ConstrainOptions(**spaces, switch=switch))
        first, second = Report(), Report()
        mirrored = mirror(built, options=MirrorOptions(from_side="left"), report=first)
        assert [notice.code for notice in first.warnings if "weights" in notice.code] == told
        mirror(mirrored, options=MirrorOptions(from_side="left"), report=second)
        assert not [notice.code for notice in second.warnings if "weights" in notice.code]


@cache
def _controlled(samples: Path) -> Rig:
    return add_controls(read(samples / "tpose.glb").rig, whole_character=True)


@pytest.mark.parametrize("following", ["foot_R_ik_ctl", "shin_R_pole"])
def test_a_pole_vector_of_a_limb_that_a_constraint_moves_stays_where_it_rests(
    following: str, samples: Path
) -> None:
    """IK moves the limb in every clip, without keys of its own: before, mirror moved its pole in silence."""
    rig = _controlled(samples)
    key = Track(rig.find("hand_L_ctl"), "rotation", "STEP", np.zeros(1), np.array([[0.0, 0, 0, 1]]))
    there = rig.translation.copy()
    there[rig.find("shin_L_pole")] += (0.1, 0.0, 0.05)
    rig = replace(rig, translation=there, clips=(Clip("step", (key,)),))
    rig = constrain(rig, options=ConstrainOptions(child=following, driver=(("head", 1.0),)))
    report = Report()
    out = mirror(rig, options=MirrorOptions(from_side="left"), report=report)
    pole = rig.find("shin_R_pole")
    assert (out.translation[pole] == there[pole]).all()
    (said,) = [each.text for each in report.warnings if "'shin_R_pole' at rest would change" in each.text]
    assert "limb moves in step" in said


@pytest.mark.parametrize("keyed", ["foot_R_ik_ctl", "shin_R_pole", "foot_R_heel_ctl", ""])
def test_a_pole_vector_whose_limb_moves_in_clips_stays_where_it_rests(keyed: str, samples: Path) -> None:
    rig = add_controls(_controlled(samples), foot_roll=True, whole_character=True)
    pole, there = rig.find("shin_R_pole"), rig.translation.copy()
    there[rig.find("shin_L_pole")] += (0.1, 0.0, 0.05)
    key = Track(rig.find(keyed or "hand_R_ctl"), "rotation", "STEP", np.zeros(1), np.array([[0.0, 0, 0, 1]]))
    rig, report = replace(rig, translation=there, clips=(Clip("step", (key,)),)), Report()
    out = mirror(rig, options=MirrorOptions(from_side="left"), report=report)
    assert (out.translation[pole] == there[pole]).all() == bool(keyed)
    said = [each.text for each in report.warnings if "'shin_R_pole' at rest would change" in each.text]
    assert len(said) == bool(keyed)
    assert all("limb moves in step" in text for text in said)


@pytest.mark.ci
def test_mirror_tells_of_controls_that_were_there_and_take_a_pose(samples: Path) -> None:
    rig = _controlled(samples)
    rotation, report = rig.rotation.copy(), Report()
    rotation[rig.find("hand_R_ctl")] = (0.0, 0.0, 0.6, 0.8)
    for name in ("forearm_L_ctl", "thigh_L_ctl"):
        rotation[rig.find(name)] = (0.6, 0.0, 0.0, 0.8)
    out = mirror(replace(rig, rotation=rotation), options=MirrorOptions(from_side="left"), report=report)
    (moved,) = (each.text for each in report.warnings if each.code == "mirror-moves")
    assert moved.startswith("forearm_R_ctl, hand_R_ctl, thigh_R_ctl: takes the mirrored values at rest")
    again = Report()
    mirror(out, options=MirrorOptions(from_side="left"), report=again)
    assert not [each for each in again.warnings if each.code == "mirror-moves"]


def test_a_straight_limb_bends_as_its_twin_without_a_warning(samples: Path) -> None:
    """Before, one said that its bend direction is from the command line."""
    arm = ("upper_arm_L", "forearm_L", "hand_L")
    rig = add_controls(read(samples / "tpose.glb").rig, options=AddControlsOptions(ik=(arm,)))
    report = Report()
    rig = mirror(rig, options=MirrorOptions(), report=report)
    left, right = (rig.world[rig.find(f"forearm_{side}_pole"), 3, :3] for side in "LR")
    assert_allclose(right, left * [-1.0, 1.0, 1.0], atol=1e-6)
    assert "straight" not in {notice.code for notice in report.warnings}


@pytest.mark.ci
def test_shared_weights_are_mirrored_beside_a_constraint_of_another_kind(
    samples: Path, tmp_path: Path
) -> None:
    """Before, the constraint that gets another name on the way was told lost, and nothing was written."""

    def build(rig: Rig, report: Report) -> Rig:
        rules: tuple[dict[str, Any], ...] = ({"type": "parent"}, {"type": "aim", "aim_axis": (1.0, 0.0, 0.0)})
        for side, rule in zip("LR", rules, strict=True):
            prop = AddSocketOptions(name=f"prop_{side}", on=f"hand_{side}")
            rig = add_socket(rig, options=prop, report=report)
            follow = ConstrainOptions(child=f"prop_{side}", driver=(("head", 1.0),), **rule)
            rig = constrain(rig, options=follow, report=report)
        shared = AddTwistOptions(joint=("forearm_L",), to=("hand_L",), split_weights=True)
        return bake(add_twist(rig, options=shared, report=report), to="joints", report=report)

    source, out = tmp_path / "built.glb", tmp_path / "out.glb"
    edit(samples / "biped.glb", source, build)
    edit(source, out, lambda rig, report: mirror(rig, options=MirrorOptions(), report=report))
    rig = read(out).rig
    kinds = {rig.names[rule.child]: rule.kind for rule in constraints_of(rig).values()}
    assert kinds == {"prop_L": "parent", "prop_R": "parent"}
    assert moving_points(rig.skins, len(rig))[rig.find("forearm_R_twist_1")]
