"""Controls with axes of their own: aimed along their bones, on skeletons whose joints keep theirs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from avatars import avatar_0
from carried import EDITS, SAME_MOTION, carried
from places import SAMPLES, every_other, real_files, slow
from recognition_bodies.skeletons import MAN, rig_with

import rigtri
from rigtri.errors import RigtriError, UsageError
from rigtri.evaluation.zero_pose import world_at_zero
from rigtri.frames import Mirror
from rigtri.frames.mirroring import Across, mirrored_axes
from rigtri.maths.matrices import nearest_rotation
from rigtri.model.metadata import ControlRecord, OffsetRecord
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import PRESETS
from rigtri.operations.control_frames import KEPT, stored_style
from rigtri.operations.mirror.symmetry_check import asymmetry
from rigtri.report import Report

# Degrees between a control's aim axis and its bone that float32 rotations leave.
ALONG = 0.01
LIMBS = ("upper_arm_L", "forearm_L", "thigh_R", "shin_R", "spine")


def off_bone(rig: Rig, joint: str, axis: int = 0, sign: float = 1.0) -> float:
    """Degrees between an axis of a joint's FK control and the line to its one child that is a joint."""
    node = rig.find(joint)
    control = next(k for k, r in rig.records(ControlRecord).items() if r.kind == "fk" and r.joint == joint)
    (child,) = (k for k in rig.children[node] if rig.is_joint[k])
    bone = rig.world[child, 3, :3] - rig.world[node, 3, :3]
    aim = rig.world[control, axis, :3] * sign
    cosine = float(aim @ bone) / float(np.linalg.norm(aim) * np.linalg.norm(bone))
    return float(np.degrees(np.arccos(min(1.0, cosine))))


@pytest.mark.ci
@pytest.mark.parametrize(
    ("name", "options", "axis", "sign"),
    [
        ("biped.glb", {}, 0, 1.0),
        ("biped.glb", {"preset": "blender"}, 1, 1.0),
        slow("biped.usda", {"preset": "blender"}, 1, 1.0),
        ("biped.usda", {"aim": "-z", "up": "x"}, 2, -1.0),
        slow("biped.glb", {"aim": "-z", "up": "x"}, 2, -1.0),
    ],
    ids=str,
)
def test_controls_are_aimed_along_their_bones_and_joints_keep_their_axes(
    name: str, options: dict[str, str], axis: int, sign: float
) -> None:
    rig = rigtri.read(SAMPLES / name)
    built = rigtri.add_controls(rig, whole_character=True, **options)
    assert max(off_bone(built, joint, axis, sign) for joint in LIMBS) < ALONG
    assert np.array_equal(built.world[: len(rig)], rig.world)


@pytest.mark.ci
def test_a_joint_stands_to_its_control_by_the_rest_offset() -> None:
    """joint_world = rest_offset · control_world, by matrices alone."""
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True)
    for node, record in rig.records(OffsetRecord).items():
        if record.kind != "fk":
            continue
        x, y, z, w = record.axes or (0.0, 0.0, 0.0, 1.0)
        turn = np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
                [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
                [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
        joint = rig.world[rig.find(record.joint)]
        assert np.abs(turn @ rig.world[node, :3, :3] - joint[:3, :3]).max() < 1e-6
        assert np.abs(rig.world[node, 3, :3] - joint[3, :3]).max() < 1e-6


@pytest.mark.ci
@pytest.mark.parametrize("name", ["tpose.glb", slow("biped.glb"), slow("biped.usda")])
@pytest.mark.parametrize("edit", ["orient-joints", slow("add-controls"), slow("mirror"), slow("pose")])
def test_aimed_controls_hold_the_motion_through_bakes_and_edits(name: str, edit: str, tmp_path: Path) -> None:
    source, baked = tmp_path / name, tmp_path / f"baked_{name}"
    rig = rigtri.add_controls(rigtri.read(SAMPLES / name), whole_character=True, preset="blender")
    rigtri.write(rigtri.bake(rig, to="controls"), source, verify=False)
    rigtri.write(rigtri.bake(rigtri.read(source), to="joints"), baked, verify=False)
    found = rigtri.verify(SAMPLES / name, baked)
    assert found.deviation <= 2e-3  # between samples a bake may be off by --between
    assert edit in EDITS
    assert carried(source, edit, tmp_path) <= SAME_MOTION


def test_a_second_run_keeps_what_controls_are_aimed_by(tmp_path: Path) -> None:
    one, two, joint = (tmp_path / f"{word}.glb" for word in ("one", "two", "joint"))
    rigtri.write(
        rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True, preset="maya"), one
    )
    rigtri.write(rigtri.add_controls(rigtri.read(one), whole_character=True), two)
    assert one.read_bytes() == two.read_bytes()
    rigtri.write(rigtri.add_controls(rigtri.read(one), whole_character=True, frame="joint"), joint)
    records = rigtri.read(joint).records(OffsetRecord).values()
    assert not any(record.axes or record.aim for record in records if record.kind == "fk")


def test_the_lines_of_a_control_go_with_it_where_usd_has_them_as_prims(tmp_path: Path) -> None:
    """Before, they stayed where the root control had been, which no writer could say: it was refused."""
    built, again = tmp_path / "built.usda", tmp_path / "again.usda"
    rigtri.write(rigtri.add_controls(rigtri.read(SAMPLES / "biped.usda"), whole_character=True), built)
    rig = rigtri.read(built)
    root = next(node for node, record in rig.records(OffsetRecord).items() if record.kind == "root")
    translation = rig.translation.copy()
    translation[root] += (0.0, 0.04, 0.0)  # as high as the lowest joint, where it stood before
    rigtri.write(replace(rig, translation=translation), again)
    rig = rigtri.read(again)
    rigtri.write(rigtri.add_controls(rig, whole_character=True), tmp_path / "out.usda")
    first, last = rigtri.read(built), rigtri.read(tmp_path / "out.usda")
    np.testing.assert_allclose(last.world, first.world, atol=1e-6)
    assert first.drawings


def test_a_skeleton_that_may_not_change_gets_aimed_controls(tmp_path: Path) -> None:
    """VRM 0.x: no joint may have axes of its own."""
    path = avatar_0(1).glb(tmp_path / "avatar.vrm")
    rig = rigtri.add_controls(rigtri.read(path), joints=("hair",))
    assert off_bone(rig, "hair") < ALONG


def test_the_axes_of_joints_do_not_go_with_others() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    with pytest.raises(UsageError, match='aim= does not go with frame="joint"'):
        rigtri.add_controls(rig, whole_character=True, frame="joint", aim="y")
    with pytest.raises(UsageError, match="same letter"):
        rigtri.add_controls(rig, whole_character=True, aim="y", up="y")


@pytest.mark.slow
@pytest.mark.parametrize("path", real_files(), ids=lambda path: path.name)
def test_controls_of_real_limbs_are_aimed(path: Path) -> None:
    try:
        rig = rigtri.add_controls(rigtri.read(path), whole_character=True)
    except RigtriError:
        pytest.skip("nothing in this file is there to build it for")
    chains = {r.chain for r in rig.records(ControlRecord).values() if r.kind == "ik"}
    for start, middle, _ in chains:
        for joint in (start, middle):
            if sum(bool(rig.is_joint[k]) for k in rig.children[rig.find(joint)]) == 1:
                assert off_bone(rig, joint) < ALONG


def reasons(path: Path) -> dict[str, str]:
    report = Report()
    rigtri.add_controls(rigtri.read(path), whole_character=True, report=report)
    return {entry["joint"]: entry["reason"] for entry in report.added if "reason" in entry}


@pytest.mark.ci
def test_a_root_that_moves_no_vertex_and_eyes_keep_their_axes_and_the_report_says_why(tmp_path: Path) -> None:
    assert reasons(SAMPLES / "flat_ik.glb") == {"root": "root joint: its motion is root motion"}
    assert reasons(SAMPLES / "biped.glb") == {}  # its hips are a root with skin of their own
    rig = rigtri.read(SAMPLES / "biped.glb")
    eyes = replace(rig, humanoid={"leftEye": rig.find("fingers_L"), "hips": rig.find("hips")})
    built = rigtri.add_controls(eyes, joints=("fingers_L", "hand_L"))
    here, joint = built.world[built.find("fingers_L_ctl")], built.world[built.find("fingers_L")]
    assert np.abs(here[:3, :3] - joint[:3, :3]).max() < 1e-6


@pytest.mark.ci
@pytest.mark.parametrize(
    ("mode", "style"),
    every_other(
        ["behavior", "orientation", "blender"], [{}, {"aim": "-z", "up": "x", "up_from": "vector:1,2,3"}]
    ),
)
def test_mirror_gives_the_twin_of_a_control_the_mirrored_axes(
    mode: Mirror, style: dict[str, str], tmp_path: Path
) -> None:
    one, two, three = (tmp_path / f"{word}.glb" for word in ("one", "two", "three"))
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True, **style)
    rigtri.write(rigtri.mirror(rig, mode=mode), one)
    mirrored = rigtri.read(one)
    for joint in ("clavicle", "upper_arm", "forearm", "hand", "thigh", "shin", "toe"):
        here, there = (mirrored.world[mirrored.find(f"{joint}_{side}_ctl"), :3, :3] for side in "LR")
        assert np.abs(mirrored_axes(here, mode, Across()) - there).max() < 1e-5
    rigtri.write(rigtri.mirror(mirrored, mode=mode), two)
    assert one.read_bytes() == two.read_bytes()
    rigtri.write(rigtri.add_controls(mirrored, joints=("*",)), three)
    assert one.read_bytes() == three.read_bytes()
    found = asymmetry(mirrored)
    assert not [pair for pair in found.worse() if pair.node.endswith("_ctl")]


@pytest.mark.ci
def test_both_sides_by_one_rule_are_symmetric_whatever_axes_the_joints_have() -> None:
    built = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True)
    assert not [pair for pair in asymmetry(built).worse() if pair.node.endswith("_ctl")]


@pytest.mark.ci
def test_other_axes_of_a_control_leave_the_controls_below_where_they_are() -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True)
    again = rigtri.add_controls(rig, joints=("upper_arm_L",), aim="z", up="x")
    changed = rig.find("upper_arm_L_ctl")
    far = np.abs(again.world[: len(rig)] - rig.world).max(axis=(1, 2))
    assert far[changed] > 0.1
    assert far[[k for k in range(len(rig)) if k not in (changed, int(rig.parents[changed]))]].max() < 1e-6


def mirrored_and_plain() -> tuple[Rig, Rig]:
    """A character below a root that mirrors x, and the same one below a plain root."""
    joints = [("root", "", (0.0, 0.0, 0.0)), *((name, above or "root", at) for name, above, at in MAN)]
    plain = rig_with(joints)
    flip, scale = np.array([-1.0, 1.0, 1.0]), np.ones((len(plain), 3))
    scale[plain.find("root")] = flip
    (skin,), inverse_bind = plain.skins, plain.skins[0].inverse_bind * [-1.0, 1.0, 1.0, 1.0]
    mirrored = replace(
        plain,
        translation=plain.translation * flip,
        scale=scale,
        skins=(replace(skin, inverse_bind=inverse_bind),),
    )
    return mirrored, plain


@pytest.mark.parametrize("preset", ["article", "maya", "blender", "talk"])
def test_controls_below_a_mirrored_root_close_as_all_others_do(preset: str) -> None:
    """Before, a positive turn of a control opened elbow and knee there: its joint's axes are left-handed."""
    here, there = (rigtri.add_controls(k, whole_character=True, preset=preset) for k in mirrored_and_plain())
    names = [name for name in there.names if name.endswith("_ctl") and "root" not in name]
    assert len(names) > 10
    for name in names:
        np.testing.assert_allclose(here.world[here.find(name)], there.world[there.find(name)], atol=1e-6)


@pytest.mark.parametrize(
    ("preset", "hinge"),
    [("article", 1), ("maya", 1), ("blender", 0), ("talk", 2)],
)
def test_controls_held_by_a_mirrored_node_aim_along_bones(preset: str, hinge: int) -> None:
    """USD holds controls below the SkelRoot. Before, all their axes were reversed there, not hinges alone."""
    mirrored, plain = mirrored_and_plain()
    mirrored = replace(mirrored, rules=replace(mirrored.rules, group_parent=mirrored.find("root")))
    here, there = (rigtri.add_controls(k, whole_character=True, preset=preset) for k in (mirrored, plain))
    signs = np.where(np.arange(3) == hinge, -1.0, 1.0)[:, np.newaxis]  # so that a positive turn closes
    names = [
        name for name in there.names if name.endswith("_ctl") and "root" not in name and "_ik_" not in name
    ]
    assert len(names) > 10
    for name in names:
        a, b = (rig.world[rig.find(name), :3, :3] for rig in (here, there))
        np.testing.assert_allclose(a, b * signs, atol=1e-6, err_msg=name)
    again = rigtri.add_controls(here, whole_character=True, preset=preset)
    assert np.array_equal(again.world, here.world)


@pytest.mark.parametrize(("aim", "up", "told"), [("x", "-y", True), ("x", "-x", False), ("x", "w", False)])
def test_stored_axes_that_are_no_two_stay_as_they_are(aim: str, up: str, told: bool) -> None:
    rig = rig_with(MAN)
    record = OffsetRecord(kind="fk", joint="a", aim=aim, up=up, up_from="plane")
    assert (stored_style(rig, record) != KEPT) == told
    assert stored_style(rig, OffsetRecord(kind="fk", joint="a")) is None


@pytest.mark.parametrize("up_from", ["", "zzz", "node:nobody", "vector:nan", "noderot:w:hips", "world:"])
def test_controls_whose_stored_up_nobody_can_read_stay_as_they_are(up_from: str) -> None:
    """They keep their axes and their record, with a warning that names them; the others go on as before."""
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True, preset="blender")
    offset = rig.find("forearm_L_ctl_offset")
    stored = {**rig.metadata[offset], "upFrom": up_from}
    if not up_from:
        del stored["upFrom"]
    rig = replace(rig, metadata={**rig.metadata, offset: stored})
    report = Report()
    again = rigtri.add_controls(rig, whole_character=True, report=report)
    (notice,) = [one for one in report.warnings if one.code == "style-illegible"]
    assert notice.joint == "forearm_L_ctl"
    assert again.metadata == rig.metadata
    np.testing.assert_allclose(again.world, rig.world, atol=1e-6)


def test_offsets_stand_on_joints_whose_quaternions_rounding_has_made_longer() -> None:
    """Else bones count as longer once the joints rest otherwise, and limbs keyed nearly straight bend."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    longer = 1.0 + 1e-7 * np.random.default_rng(3).uniform(-1.0, 1.0, (len(rig), 1))
    rig = rigtri.add_controls(replace(rig, rotation=rig.rotation * longer), whole_character=True)
    controls, stored = set(rig.nodes_of("control")), rig.records(OffsetRecord)
    for offset, record in stored.items():
        if record.kind in ("fk", "ik"):
            there, joint = world_at_zero(rig, offset, controls), rig.find(record.joint)
            assert np.abs(there[3] - rig.normalised_world[joint, 3]).max() < 1e-14
            if record.axes is None:
                axes = nearest_rotation(rig.normalised_world[joint])
                assert np.abs(nearest_rotation(there) - axes).max() < 1e-14
    assert len(stored) > 20


def test_controls_that_constraints_count_from_keep_their_axes_in_a_second_run() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    built = rigtri.add_controls(rig, chain=("forearm_L", "hand_L"), root_control=True)
    names = {r.joint: built.names[k] for k, r in built.records(ControlRecord).items() if r.kind == "fk"}
    child, driver = names["hand_L"], names["forearm_L"]
    tied = rigtri.constrain(built, type="parent", child=child, driver=((driver, 1.0),))
    again = rigtri.add_controls(tied, chain=("forearm_L", "hand_L"), root_control=True, frame="joint")
    for name in (child, driver):
        assert np.allclose(again.world[again.find(name)], tied.world[tied.find(name)], atol=1e-6)
    # Without the constraint they get the axes of their joints.
    free = rigtri.add_controls(built, chain=("forearm_L", "hand_L"), root_control=True, frame="joint")
    assert not np.allclose(free.world[free.find(driver)], built.world[built.find(driver)], atol=1e-3)


@pytest.mark.parametrize("preset", [name for name, style in PRESETS.items() if not style.world])
def test_controls_have_the_axes_that_their_joints_would_have(preset: str) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    turned = rigtri.orient_joints(rig, preset=preset)
    made = rigtri.add_controls(
        rig,
        joints=[k for k, is_joint in zip(rig.labels, rig.is_joint, strict=True) if is_joint],
        preset=preset,
    )
    pairs = [(joint, f"{name}_ctl") for joint, name in enumerate(rig.names) if f"{name}_ctl" in made.names]
    assert len(pairs) > 20
    for joint, control in pairs:
        assert np.allclose(turned.world[joint, :3, :3], made.world[made.find(control), :3, :3], atol=1e-6)
