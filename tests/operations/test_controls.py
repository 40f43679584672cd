"""add-controls: a tree of controls over joints."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from flat_options import joints_of
from gltf_files import glb_bytes, glb_parts
from numpy.testing import assert_allclose
from places import SAMPLES, slow
from program import cli
from rigs import chain
from second_opinions import validator

import rigtri
from rigtri.errors import UsageError
from rigtri.formats import read
from rigtri.formats.usd.identifiers import identifier
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.model.animation import Clip, Track
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.option_kinds import Selection
from rigtri.pipeline.edit import edit
from rigtri.recognition.limbs import Limb
from rigtri.report import Report

WHOLE = AddControlsOptions(whole_character=True)
FINGER = chain((0, 0, 0), (0, 1, 0), (0, 2, 0.2), (0, 3, 0.6))


def controls(rig: Rig, kind: str = "fk") -> dict[str, int]:
    """The controls of a kind by their joints."""
    return {
        str(note["joint"]): node
        for node, note in rig.metadata.items()
        if note["type"] == "control" and note["kind"] == kind
    }


@pytest.mark.parametrize("count", [1, 2, 3])
def test_one_builder_serves_chains_of_any_length(count: int) -> None:
    end = "bcd"[count - 1]
    out = add_controls(FINGER, options=AddControlsOptions(chain=(("b", end),)))
    made = controls(out)
    assert sorted(made) == list("bcd"[:count])
    for joint, above in zip("cd"[: count - 1], "bc", strict=False):
        assert out.parents[out.parents[made[joint]]] == made[above]


def test_a_control_stands_in_its_joints_frame_with_zero_channels() -> None:
    turned = replace(FINGER, rotation=np.stack([from_axis_angle([1, 2, 3], k) for k in range(4)]))
    out = add_controls(turned, options=AddControlsOptions(joints=("*",), frame="joint"))
    world = out.world
    for joint, control in controls(out).items():
        assert_allclose(world[control], world[out.find(joint)], atol=1e-12)
        assert not out.translation[control].any()
        assert out.rotation[control].tolist() == [0, 0, 0, 1]


def test_a_scaled_or_mirrored_joint_gives_its_control_no_scale() -> None:
    scaled = replace(FINGER, scale=FINGER.scale * [[100], [1], [-1], [1]])
    out = add_controls(scaled, options=AddControlsOptions(joints=("*",), frame="joint"))
    world = out.world
    for joint, control in controls(out).items():
        assert_allclose(world[control, 3], world[out.find(joint), 3], atol=1e-9)
        assert_allclose(world[control, :3, :3], nearest_rotation(world[out.find(joint)]), atol=1e-9)


@pytest.mark.parametrize("frame", ["bone", "joint"])
def test_a_flat_shape_lies_across_its_bone_and_grows_with_it(frame: Literal["bone", "joint"]) -> None:
    options = AddControlsOptions(joints=("b", "c"), size=2.0, frame=frame)
    out = add_controls(FINGER, options=options)
    for joint, child in (("b", "c"), ("c", "d")):
        shape = out.pending.shapes[controls(out)[joint]]
        bone = FINGER.translation[FINGER.find(child)]
        axis = np.eye(3)[0 if frame == "bone" else np.argmax(np.abs(bone))]
        assert_allclose(shape.strips[0] @ axis, 0.0, atol=1e-9)
        assert_allclose(np.linalg.norm(shape.strips[0], axis=1), np.linalg.norm(bone), rtol=0.2)


@pytest.mark.ci
def test_sides_have_their_colours(samples: Path) -> None:
    out = add_controls(read(samples / "biped.glb").rig, options=WHOLE)
    blue, red, yellow = (
        [s.color for n, s in out.pending.shapes.items() if out.metadata[n].get("side") == side]
        for side in ("left", "right", "")
    )
    assert len(set(blue)) == len(set(red)) == len(set(yellow)) == 1
    assert np.argmax(blue[0]) == 2
    assert np.argmax(red[0]) == 0
    assert len(blue) == len(red) > 5


def test_the_root_s_arrow_points_where_the_character_looks(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    around = np.array([[-1.0, 0, 0], [0, 1, 0], [0, 0, -1]])
    faces_back = replace(
        rig,
        translation=np.where(rig.parents[:, np.newaxis] < 0, rig.translation @ around, rig.translation),
        rotation=np.array(
            [
                multiply(from_axis_angle([0, 1, 0], np.pi), turn) if parent < 0 else turn
                for parent, turn in zip(rig.parents, rig.rotation, strict=True)
            ]
        ),
    )
    for character, tip in ((rig, [0, 0, 1]), (faces_back, [0, 0, -1]), (FINGER, [0, 0, 1])):
        out = add_controls(character, options=AddControlsOptions(root_control=True))
        (root,) = controls(out, "root").values()
        points = np.concatenate(out.pending.shapes[root].strips)
        assert_allclose(points[np.argmax(np.abs(points[:, 2]) - np.abs(points[:, 0]))][[0, 1]], 0, atol=1e-9)
        assert_allclose((points @ tip).max(), np.abs(points).max())
        assert np.count_nonzero(points @ tip > 0.99 * np.abs(points).max()) == 1


def test_ik_ends_and_poles_join_the_tree_of_the_root_control(samples: Path) -> None:
    out = add_controls(read(samples / "biped.glb").rig, options=WHOLE)
    (root,) = controls(out, "root").values()
    ik = controls(out, "ik")
    assert len(ik) == 4
    poles = [node for node, note in out.metadata.items() if note["type"] == "poleVector"]
    assert {int(out.parents[node]) for node in poles} == {root}
    assert {int(out.parents[out.parents[node]]) for node in ik.values()} == {root}
    assert_allclose(out.world[root, :3, :3], np.eye(3), atol=1e-12)


def whole(rig: Rig, report: Report) -> Rig:
    return add_controls(rig, options=WHOLE, report=report)


@pytest.mark.ci
def test_what_a_user_sets_on_a_control_stays(samples: Path, tmp_path: Path) -> None:
    edit(samples / "biped.glb", tmp_path / "rig.glb", whole)
    rig = read(tmp_path / "rig.glb").rig
    control = next(iter(controls(rig).values()))
    moved = rig.translation.copy()
    moved[control] = [1, 2, 3]
    again = add_controls(replace(rig, translation=moved), options=WHOLE)
    assert again.translation[control].tolist() == [1, 2, 3]
    assert not again.pending.shapes


def test_offsets_follow_joints_that_were_reoriented_since(samples: Path) -> None:
    options = AddControlsOptions(joints=("*",), frame="joint")
    rig = add_controls(FINGER, options=options)
    turned = replace(rig, rotation=rig.rotation.copy())
    turned.rotation[1] = from_axis_angle([0, 0, 1], 0.5)
    out = add_controls(turned, options=AddControlsOptions(joints=("*",)))
    assert len(out) == len(rig)
    for joint, control in controls(out).items():
        assert_allclose(out.world[control], out.world[out.find(joint)], atol=1e-9)


def test_names_follow_their_rule_and_fit_the_format() -> None:
    rig = replace(FINGER, names=("hand.L", "mixamorig:Index 1", "左手", "d"))
    options = AddControlsOptions(joints=("*",), name="{side}_{joint}_{kind}")
    assert {"left_hand.L_ctl", "left_左手_ctl"} <= {*add_controls(rig, options=options).names}
    strict = add_controls(replace(rig, rules=replace(rig.rules, valid_name=identifier)), options=options)
    assert {"left_hand_L_ctl", "left_左手_ctl", "left_mixamorig_Index_1_ctl_offset"} <= {*strict.names}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (AddControlsOptions(), "name the joints"),
        (AddControlsOptions(whole_character=True, name="{bone}"), "tokens"),
        (AddControlsOptions(whole_character=True, shape={"fk": "banana"}), "banana"),  # type: ignore[dict-item]
    ],
)
def test_what_fits_no_control_is_reported(options: AddControlsOptions, words: str) -> None:
    with pytest.raises(UsageError, match=words):
        add_controls(FINGER, options=options)


@pytest.mark.parametrize("suffix", [".glb", slow(".usda")])
def test_the_command_reports_every_control(suffix: str, samples: Path, tmp_path: Path) -> None:
    arguments: list[Any] = ["add-controls", samples / f"biped{suffix}", "-o", tmp_path / f"out{suffix}"]
    arguments += ["--whole-character", "--color", "left=0,1,0", "--shape", "fk=sphere", "--json", "-q"]
    result = cli(*arguments, code=0)
    import json

    document = json.loads(result.stdout)
    validator("report").validate(document)
    assert {entry["kind"] for entry in document["added"]} == {"fk", "ik", "root"}
    assert len(document["limbs"]) == 4


@pytest.mark.parametrize(
    ("command", "control", "new"),
    [
        (("add-controls", "--whole-character"), "shin_R_ctl", "hips"),
        (("mirror",), "hips_root_ctl", "biped"),
        slow(("add-controls", "--whole-character"), "hips_root_ctl", "biped"),
        slow(("mirror",), "shin_R_ctl", "hips"),
    ],
)
def test_a_control_that_was_put_below_another_node_leaves_that_where_it_is(
    command: tuple[str, ...], control: str, new: str, samples: Path, tmp_path: Path
) -> None:
    source, out = tmp_path / "in.glb", tmp_path / "out.glb"
    edit(samples / "biped.glb", source, whole)
    document, data = glb_parts(source)
    nodes = document["nodes"]
    index = {node.get("name"): k for k, node in enumerate(nodes)}
    del nodes[index[f"{control}_offset"]]["children"]
    nodes[index[new]]["children"].append(index[control])
    source.write_bytes(glb_bytes(document, data))
    arguments: list[Any] = [command[0], source, "-o", out, *command[1:]]
    result = cli(*arguments, code=0)
    if "root" not in control or command[0] != "mirror":  # mirror leaves alone what is on neither side
        assert f"'{control}' has no offset group above it" in result.stderr


def test_a_control_does_not_move_from_under_what_others_have_put_below_it(tmp_path: Path) -> None:
    """Before, the joint went with it, and the result was refused as one that would look different."""
    source, out = tmp_path / "in.glb", tmp_path / "out.glb"
    rigtri.write(rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), joints=["hand_L"]), source)
    document, data = glb_parts(source)
    nodes = document["nodes"]
    index = {node.get("name"): k for k, node in enumerate(nodes)}
    nodes[index["forearm_L"]]["children"].remove(index["hand_L"])
    nodes[index["hand_L_ctl"]]["children"] = [index["hand_L"]]
    nodes[index["hand_L"]]["translation"] = [0.1, 0.0, 0.0]
    source.write_bytes(glb_bytes(document, data))
    ran = cli("add-controls", source, "-o", out, "--joints", "hand_L", code=5)
    assert (
        "'hand_L_ctl' would get another place, and 'hand_L', which is not from rigtri, is a child"
        in ran.stderr
    )
    assert not out.exists()


@pytest.mark.ci
def test_controls_made_before_those_above_them_stay_where_they_are_and_report_it(
    samples: Path, tmp_path: Path
) -> None:
    def hand(rig: Rig, report: Report) -> Rig:
        return add_controls(rig, options=AddControlsOptions(joints=("hand_L",)), report=report)

    def all_of_it(rig: Rig, report: Report) -> Rig:
        return add_controls(rig, options=WHOLE, report=report)

    for suffix in ("glb", "usda"):
        first, whole, again = (tmp_path / f"{name}.{suffix}" for name in ("first", "whole", "again"))
        edit(samples / f"biped.{suffix}", first, hand)
        report = edit(first, whole, all_of_it).report
        (kept,) = [notice.text for notice in report.warnings if notice.code == "control-kept-in-place"]
        assert kept.startswith("'hand_L_ctl' was made before the controls above it")
        rig = read(whole).rig
        fk = [
            note["joint"]
            for note in rig.metadata.values()
            if (note["type"], note.get("kind")) == ("control", "fk")
        ]
        assert len(fk) == len(set(fk)) > 10  # one for each joint
        edit(whole, again, all_of_it)
        assert again.read_bytes() == whole.read_bytes()


HAND = Selection(joints=("forearm_L", "hand_L"))


def redone(path: Path, out: Path, **told: Any) -> Report:
    options = AddControlsOptions(**joints_of(HAND), **told)
    return edit(path, out, lambda rig, report: add_controls(rig, options=options, report=report)).report


def lines(rig: Rig, joint: str) -> Any:
    return rig.content.read_lines(rig.keys[controls(rig)[joint]])


@pytest.mark.parametrize("suffix", ["glb", slow("usda"), slow("usdz")])
def test_what_is_requested_later_is_drawn_anew_where_nobody_has_edited(
    suffix: str, samples: Path, tmp_path: Path
) -> None:
    one, two, three, four, five = (tmp_path / f"{k}.{suffix}" for k in range(5))
    redone(samples / f"biped.{suffix}", one)
    report = redone(one, two, size=2.0, shape={"fk": "cube"}, color={"left": (0.25, 0.5, 1.0)})
    assert not report.warnings
    redone(one, four)
    assert four.read_bytes() == one.read_bytes()  # nothing asked for, nothing changed
    before, after = (read(path).rig for path in (one, two))
    for joint in ("forearm_L", "hand_L"):
        was, now = (rig.metadata[controls(rig)[joint]] for rig in (before, after))
        assert (was["shape"], now["shape"]) == ("circle", "cube")
        assert now["size"] == pytest.approx(2 * was["size"])
        assert np.abs(lines(after, joint).segments).max() == pytest.approx(now["size"])
        assert lines(after, joint).color == pytest.approx((0.25, 0.5, 1.0))
        validator("node").validate(now)
    redone(two, three, size=2.0, shape={"fk": "cube"}, color={"left": (0.25, 0.5, 1.0)})
    assert three.read_bytes() == two.read_bytes()
    # One thing asked for leaves the others as they are.
    redone(two, five, color={"left": (1.0, 0.0, 0.0)})
    note = read(five).rig.metadata[controls(read(five).rig)["hand_L"]]
    assert (note["shape"], note["color"]) == ("cube", [1.0, 0.0, 0.0])
    assert note["size"] == pytest.approx(2 * before.metadata[controls(before)["hand_L"]]["size"])


def test_lines_that_a_user_has_edited_stay_and_are_named(samples: Path, tmp_path: Path) -> None:
    from pxr import Sdf

    one, two = tmp_path / "one.usda", tmp_path / "two.usda"
    redone(samples / "biped.usda", one)
    layer = Sdf.Layer.FindOrOpen(str(one))
    path = read(one).rig.labels[controls(read(one).rig)["hand_L"]]
    points = layer.GetAttributeAtPath(f"{path}/hand_L_ctl_shape.points")
    points.default = [3 * point for point in points.default]
    layer.Save()
    was = lines(read(one).rig, "hand_L").segments
    (notice,) = redone(one, two, size=0.5).warnings
    assert notice.code == "shape-kept"
    assert "'hand_L_ctl'" in notice.text
    assert_allclose(lines(read(two).rig, "hand_L").segments, was)
    small = lines(read(two).rig, "forearm_L").segments
    assert_allclose(small, 0.5 * lines(read(one).rig, "forearm_L").segments, rtol=1e-5, atol=1e-9)


def test_curves_that_are_drawn_anew_keep_the_purpose_that_someone_gave_them(
    samples: Path, tmp_path: Path
) -> None:
    from pxr import Sdf

    one, two = tmp_path / "one.usda", tmp_path / "two.usda"
    redone(samples / "biped.usda", one)
    layer = Sdf.Layer.FindOrOpen(str(one))
    curves = f"{read(one).rig.labels[controls(read(one).rig)['hand_L']]}/hand_L_ctl_shape"
    layer.GetAttributeAtPath(f"{curves}.purpose").default = "render"
    layer.Save()
    redone(one, two, shape={"fk": "cube"})
    drawn = Sdf.Layer.FindOrOpen(str(two))
    assert drawn.GetAttributeAtPath(f"{curves}.purpose").default == "render"
    assert len(drawn.GetAttributeAtPath(f"{curves}.curveVertexCounts").default) > 1


@pytest.mark.ci
def test_a_pole_vector_is_drawn_anew_too(samples: Path, tmp_path: Path) -> None:
    one, two, three = (tmp_path / f"{k}.glb" for k in range(3))
    edit(samples / "biped.glb", one, whole)

    def cubes(rig: Rig, report: Report) -> Rig:
        options = replace(WHOLE, size=3.0, shape={"pole": "cube"})
        return add_controls(rig, options=options, report=report)

    assert not edit(one, two, cubes).report.warnings
    drawn = {note["shape"] for note in read(two).rig.metadata.values() if note["type"] == "poleVector"}
    assert drawn == {"cube"}
    edit(two, three, cubes)
    assert three.read_bytes() == two.read_bytes()


@pytest.mark.parametrize("suffix", ["glb", "usda"])
def test_a_rule_for_names_given_later_renames_what_nobody_has_renamed(
    suffix: str, samples: Path, tmp_path: Path
) -> None:
    from rigtri.operations.constrain.constrain import ConstrainOptions, constrain

    one, two, three, four = (tmp_path / f"{k}.{suffix}" for k in range(4))
    redone(samples / f"biped.{suffix}", one)

    def follow(rig: Rig, report: Report) -> Rig:
        rule = ConstrainOptions(type="parent", child="head", driver=(("hand_L_ctl", 1.0),))
        return constrain(rig, options=rule, report=report)

    edit(one, two, follow)
    warnings = redone(two, three, name="{joint}_anim").warnings
    assert {notice.code for notice in warnings} <= {"text-respelled"}
    rig = read(three).rig
    assert rig.names[controls(rig)["hand_L"]] == "hand_L_anim"
    assert rig.names[rig.parents[controls(rig)["hand_L"]]] == "hand_L_anim_offset"
    (constraint,) = (note for note in rig.metadata.values() if note["type"] == "constraint")
    assert constraint["drivers"] == ["hand_L_anim"]
    if suffix == "usda":
        from pxr import Usd

        stage = Usd.Stage.Open(str(three))
        (found,) = (p for p in stage.Traverse() if p.GetRelationship("rigtri:drivers:target"))
        (target,) = found.GetRelationship("rigtri:drivers:target").GetTargets()
        assert target.name == "hand_L_anim"
        assert stage.GetPrimAtPath(target)
    redone(three, four, name="{joint}_anim")
    assert four.read_bytes() == three.read_bytes()


def test_a_control_that_a_user_has_renamed_keeps_its_name_and_is_named() -> None:
    options = AddControlsOptions(joints=("b", "c"))
    rig = add_controls(FINGER, options=options)
    names = list(rig.names)
    names[rig.find("b_ctl", "node")] = "grip"
    told = Report()
    known = replace(rig, names=tuple(names), keys=tuple(range(len(rig))))
    again = add_controls(known, options=replace(options, name="{joint}_x"), report=told)
    assert {"grip", "c_x", "c_x_offset"} <= {*again.names}
    (notice,) = [notice for notice in told.warnings if notice.code == "name-kept"]
    assert "'grip'" in notice.text


@pytest.mark.parametrize(
    ("joints", "name", "words"),
    [
        (("b", "c"), "same", "2 controls would be called 'same'"),
        (("b",), "c", "another node is called 'c'"),
    ],
)
def test_a_rule_that_gives_no_name_of_its_own_is_refused(
    joints: tuple[str, ...], name: str, words: str
) -> None:
    with pytest.raises(UsageError, match=words):
        add_controls(FINGER, options=AddControlsOptions(joints=joints, name=name))


def test_as_is_refused_where_nothing_could_be_a_joint_or_is_one_of_the_other_kind(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    with pytest.raises(UsageError, match="--as is for IK ends"):
        add_controls(rig, options=AddControlsOptions(joints=("hips",), as_="joint"))
    kinds: tuple[Any, Any] = ("joint", "locator")
    for first, second in (kinds, kinds[::-1]):
        made = add_controls(rig, options=AddControlsOptions(limbs="auto", as_=first))
        with pytest.raises(UsageError, match=f"is a {first} since an earlier run"):
            add_controls(made, options=AddControlsOptions(limbs="auto", as_=second))


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_how_limbs_reach_is_stored_kept_and_mirrored(name: str, tmp_path: Path) -> None:
    once, twice, across, plain = (tmp_path / f"{k}{Path(name).suffix}" for k in range(4))
    limb = ("--ik", "upper_arm_L", "forearm_L", "hand_L")

    run = partial(cli, code=0)

    def note(path: Path, joint: str) -> Any:
        notes = read(path).rig.metadata.values()
        return next(
            n for n in notes if n.get("kind") == "ik" and n["type"] == "control" and n["joint"] == joint
        )

    run("add-controls", SAMPLES / name, "-o", once, *limb, "--soft", "0.125", "--stretch")
    assert (note(once, "hand_L")["soft"], note(once, "hand_L")["stretch"]) == (0.125, True)
    validator("node").validate(dict(note(once, "hand_L")))
    run("add-controls", once, "-o", twice, *limb)
    assert once.read_bytes() == twice.read_bytes()
    run("mirror", once, "-o", across, "--what", "controls", "--what", "polevectors")
    assert (note(across, "hand_R")["soft"], note(across, "hand_R")["stretch"]) == (0.125, True)
    run("add-controls", once, "-o", plain, *limb, "--soft", "0", "--no-stretch")
    assert not {"soft", "stretch"} & set(note(plain, "hand_L"))


@pytest.mark.ci
@pytest.mark.parametrize("whole", [False, True])
def test_limbs_with_ik_have_fk_controls_below_it_though_they_deform_no_vertex(whole: bool) -> None:
    rig = read(SAMPLES / "biped.glb").rig
    bare = {rig.find(name) for name in ("shin_L", "foot_L", "toe_L", "toe_L_end")}
    skins = tuple(
        replace(skin, weigh=lambda skin=skin: skin.weighted & ~np.isin(skin.joints, sorted(bare)))
        for skin in rig.skins
    )
    limb = Limb(*(rig.find(name) for name in ("thigh_L", "shin_L", "foot_L")))
    options = AddControlsOptions(whole_character=True) if whole else AddControlsOptions(ik=(limb,))
    made = add_controls(replace(rig, skins=skins), options=options)
    fk = {
        note["joint"]
        for note in made.metadata.values()
        if note.get("kind") == "fk" and note["type"] != "offset"
    }
    assert {"thigh_L", "shin_L", "foot_L"} <= fk
    assert "toe_L" not in fk
    assert whole or fk == {"thigh_L", "shin_L", "foot_L"}
    again = add_controls(made, options=options)
    assert len(again) == len(made)


@pytest.mark.ci
def test_what_a_hand_holds_does_not_make_its_control_larger() -> None:
    """The sample's right hand holds a staff; triangles of the two sides have other diagonals."""
    rig = add_controls(read(SAMPLES / "biped.glb").rig, options=AddControlsOptions(whole_character=True))
    sizes = [rig.records(ControlRecord)[rig.find(f"hand_{side}_ik_ctl")].size for side in "LR"]
    assert sizes[1] == pytest.approx(sizes[0], rel=1e-3)


@pytest.mark.ci
def test_a_joint_that_a_pose_reader_drives_gets_a_control_only_where_it_is_named() -> None:
    """It follows by itself, and what an animator set there would be replaced by each bake."""
    start = rigtri.read(SAMPLES / "tpose.glb")
    rig = rigtri.add_posereader(
        start, driver="forearm_L", target=("up=0,1,0",), joint=(("up", "head", "rz=10"),), name="reader"
    )
    whole, named = rigtri.add_controls(rig, whole_character=True), rigtri.add_controls(rig, joints=("head",))
    assert "head_ctl" in rigtri.add_controls(start, whole_character=True).names
    assert "head_ctl" not in whole.names
    assert "neck_ctl" in whole.names
    assert "head_ctl" in named.names


def test_a_second_run_leaves_pole_vectors_where_somebody_put_them_unless_another_place_is_asked_for() -> None:
    """Without keys, or counted from by those of the IK control."""
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "tpose.glb"), whole_character=True)
    poles = [rig.find("forearm_L_pole"), rig.find("shin_L_pole")]
    there = rig.translation.copy()
    there[poles] += (0.1, 0.0, 0.05)
    key = Track(rig.find("foot_L_ik_ctl"), "translation", "STEP", np.zeros(1), np.zeros((1, 3)))
    for clips in ((), (Clip("step", (key,)),)):
        moved = replace(rig, translation=there, clips=clips)
        again = rigtri.add_controls(moved, whole_character=True)
        assert again.translation[poles].tolist() == there[poles].tolist()
        assert again.metadata == moved.metadata
        farther = rigtri.add_controls(moved, whole_character=True, reach=2.0)
        assert (abs(farther.translation[poles] - there[poles]).max(axis=1) > 0.1).all()


def test_a_pole_vector_that_was_there_before_its_ik_control_stays_where_it_was_asked_for() -> None:
    """Before, it went to the reach of add-controls, without a word."""
    rig = rigtri.add_polevector(rigtri.read(SAMPLES / "biped.glb"), limbs="auto", reach=0.9)
    poles = [rig.find(f"{name}_pole") for name in ("forearm_L", "forearm_R", "shin_L", "shin_R")]
    kept = rigtri.add_controls(rig, whole_character=True)
    assert_allclose(kept.world[[kept.find(rig.names[k]) for k in poles], 3], rig.world[poles, 3], atol=1e-6)
    asked = rigtri.add_controls(rig, whole_character=True, reach=0.3)
    nearer = asked.world[[asked.find(rig.names[k]) for k in poles], 3]
    assert (np.abs(nearer - rig.world[poles, 3]).max(axis=1) > 0.1).all()


def test_a_pole_vector_with_keys_that_a_new_ik_control_brings_to_work_is_named() -> None:
    """Before, it did nothing; limbs with an IK control, and poles without keys, are no matter."""
    limb = [("thigh_L", "shin_L", "foot_L"), ("thigh_R", "shin_R", "foot_R")]
    rig = rigtri.add_polevector(rigtri.read(SAMPLES / "tpose.glb"), limb=limb)
    pole = rig.find("shin_L_pole")
    key = Track(pole, "translation", "STEP", np.zeros(1), rig.translation[[pole]])
    rig = replace(rig, clips=(Clip("step", (key,)),))
    first, again = Report(), Report()
    built = rigtri.add_controls(rig, whole_character=True, report=first)
    rigtri.add_controls(built, whole_character=True, report=again)
    (said,) = [notice.text for notice in first.warnings if notice.code == "pole-keyed"]
    assert "'shin_L_pole' has keys in step" in said
    assert not [notice for notice in again.warnings if notice.code == "pole-keyed"]


def test_a_pole_vector_that_follows_a_constraint_brings_a_new_ik_control_to_work_in_every_clip() -> None:
    limb = ("thigh_L", "shin_L", "foot_L")
    rig = rigtri.add_polevector(rigtri.read(SAMPLES / "biped.glb"), limb=(limb,))
    rig = rigtri.constrain(rig, child="shin_L_pole", type="point", driver=("hips",))
    report = Report()
    rigtri.add_controls(rig, ik=limb, report=report)
    (said,) = [notice.text for notice in report.warnings if notice.code == "pole-keyed"]
    assert said.startswith("'shin_L_pole' follows a constraint")
    assert "in every clip" in said


def test_pole_vectors_of_both_sides_are_as_large_whatever_axes_their_joints_have() -> None:
    """Their size is that of the ring of the middle joint, which stands across the bone."""
    turned = rigtri.orient_joints(rigtri.read(SAMPLES / "biped.glb"), joints="shin_L", offset=(30, 20, 50))
    rig = rigtri.add_controls(turned, whole_character=True)
    sizes = [rig.metadata[rig.find(f"shin_{side}_pole")]["size"] for side in "LR"]
    assert sizes[0] == pytest.approx(sizes[1], rel=1e-3)


@pytest.mark.ci
def test_pole_vectors_go_along_with_another_rest_pose_of_their_limb() -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "tpose.glb"), whole_character=True)
    arm, leg = rig.find("forearm_L_pole"), rig.find("shin_L_pole")
    turned = rig.rotation.copy()
    turned[rig.find("upper_arm_L")] = (0.0, 0.0, 0.6, 0.8)
    again = rigtri.add_controls(replace(rig, rotation=turned), whole_character=True)
    assert abs(again.translation[arm] - rig.translation[arm]).max() > 0.1
    assert again.translation[leg].tolist() == rig.translation[leg].tolist()


def test_a_prim_that_controls_are_below_gets_none_and_is_named(tmp_path: Path) -> None:
    """Before, bake ended with a cycle that nobody had made."""
    source, out, baked = (tmp_path / f"{name}.usda" for name in ("crane", "out", "baked"))
    place = "double3 xformOp:translate = (0, 1, 0.1)\n"
    moving = "double3 xformOp:rotateXYZ.timeSamples = { 0: (0, 0, 0), 9: (20, 5, 0) }\n"
    order = 'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ"]\n'
    text = ""
    for name in ("hook", "jib", "boom", "crane"):
        text = f'def Xform "{name}"\n{{\n{place}{moving}{order}{text}}}\n'
    source.write_text(f"#usda 1.0\n{text}")
    root = ("--root", "/crane")
    shown = cli("add-controls", source, "-o", out, *root, "--joints", "*", code=0).stderr
    assert "Controls are below 'crane', which cannot follow them, so none is made there" in shown
    cli("bake", out, "-o", baked, "--to", "controls", *root, code=0)
    cli("bake", baked, "-o", out, "--to", "joints", *root, "--overwrite", code=0)
    line = ("add-controls", source, "-o", out, *root, "--overwrite", "--joints", "crane")
    assert "Controls are below 'crane'" in cli(*line, code=5).stderr
