"""rigtri check finds axes that make no sense, and nothing where orient-joints has been."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from body_files import AXES, FINGERS, backwards, rolled, with_poles
from broken_vrm import avatar_0
from places import SAMPLES, one_in, real_files, samples_of_all_kinds
from posed_bodies import Pose, posed_body, poses
from recognition_bodies.skeletons import ARM, HORSE, LEG, MAN, TRUNK, both, line, rig_with

from rigtri import add_polevector, mirror, orient_joints
from rigtri.formats import ReadOptions, read
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import IDENTITY, from_axis_angle, rotate
from rigtri.maths.vectors import normalise
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import PRESETS
from rigtri.recognition import limb_triples
from rigtri.recognition.limbs import recognise as recognised
from rigtri.recognition.recognise import recognise
from rigtri.verification.checks import axis_check, check
from rigtri.verification.checks.axis_check import axis_findings
from rigtri.verification.checks.axis_rolls import roll_between, roll_within


def rules(rig: Rig) -> set[str]:
    return {rule for rule, _, _ in axis_findings(rig)}


EVERY = list(poses())
FEW = EVERY[3:18:7] + EVERY[37:38]


def _level(pose: Pose) -> Any:
    return [] if pose is FEW[0] else pytest.mark.ci if pose in FEW else pytest.mark.slow


@pytest.mark.ci
@pytest.mark.parametrize("pose", [pytest.param(p, marks=_level(p), id=p.title) for p in EVERY])
def test_no_preset_leaves_anything_to_report(pose: Pose) -> None:
    body = posed_body(pose)
    assert rules(body.rig) >= {"axes.aim"}  # its axes are random
    for preset in PRESETS:
        assert list(axis_findings(orient_joints(body.rig, preset=preset))) == [], preset


@pytest.mark.parametrize("path", samples_of_all_kinds(), ids=lambda path: path.name)
def test_no_preset_leaves_anything_to_report_of_the_samples(path: Path) -> None:
    rig = read(path, ReadOptions(empty=True)).rig
    if not rig.is_joint.any():
        return
    if path.stem in ("biped", "tpose"):
        assert rules(rig)
    for preset in PRESETS:
        assert list(axis_findings(orient_joints(rig, preset=preset))) == [], preset


@pytest.mark.slow
@pytest.mark.parametrize("path", real_files(), ids=lambda path: path and path.name)
def test_no_preset_leaves_anything_to_report_of_real_characters(path: Path) -> None:
    """USD ones, too, whose axes no judge outside of rigtri reads."""
    rig = read(path, ReadOptions(empty=True)).rig
    if rig.rules.orient_locked or not any(chain.is_sure for chain in recognise(rig).chains):
        return
    for preset in (name for name in PRESETS if name != "vrm"):
        assert list(axis_findings(orient_joints(rig, preset=preset))) == [], preset


def test_a_spine_that_folds_back_on_itself_is_not_rolled() -> None:
    """As Second Life's, where mSpine1 goes up, mSpine2 down again, and mTorso up once more."""
    (_, _, hips), (_, _, spine), *above = TRUNK
    names = "hips fold_1 fold_2 spine chest neck head"
    trunk = line(names, "", hips, (0, 1.15, 0.01), (0, 1.005, 0), spine, *(place for _, _, place in above))
    rig = rig_with([*trunk, *MAN[len(TRUNK) :]])
    for preset in PRESETS:
        assert rules(orient_joints(rig, preset=preset)) == set(), preset
    rig, delta = orient_joints(rig), np.tile(IDENTITY, (len(rig), 1))
    delta[rig.find("fold_2")] = from_axis_angle(np.array([1.0, 0.0, 0.0]), np.pi)
    assert rules(reframe(rig, delta)) == {"axes.trunk"}


@pytest.mark.parametrize("side", ["behavior", "blender"])
def test_mirrored_axes_bend_by_the_same_sign(side: str) -> None:
    rig = orient_joints(posed_body(Pose()).rig, preset="blender")
    assert rules(mirror(rig, mode=side)) == set()


def test_axes_of_the_world_follow_no_bone(tmp_path: Path) -> None:
    ids = {finding.id for finding in check(avatar_0().glb(tmp_path / "a.glb"))}
    assert not [name for name in ids if name.startswith("axes.")]


def test_a_rolled_joint_is_named_with_its_degrees(tmp_path: Path) -> None:
    found, after = check(AXES["axes.trunk"][0](tmp_path))
    assert after.message == "is rolled by 90° against 'mixamorig:Spine1'"
    assert found.place == "node 'mixamorig:Spine1'"
    assert found.pointer == "/nodes/3"
    assert found.message == "is rolled by 90° against 'mixamorig:Spine'"
    assert found.severity == "info"


def test_a_joint_that_aims_backwards_along_its_bone_is_named() -> None:
    body = posed_body(Pose())
    ((rule, node, _),) = axis_findings(rolled(body, (0, 1, 0), left_index_1=180.0))
    assert (rule, node) == ("axes.aim", body.parts["left index 1"])


def test_both_hands_and_each_knee_are_reported() -> None:
    body = posed_body(Pose())
    out = rolled(body, right_little_1=40.0, left_index_1=40.0, left_lower_leg=25.0, right_lower_leg=40.0)
    found = [rule for rule, _, _ in axis_findings(out)]
    assert found.count("axes.fingers") == 2
    assert found.count("axes.hinge") == 2


def test_what_is_below_the_limits_is_not_reported() -> None:
    out = rolled(posed_body(Pose()), left_ring_1=25.0, left_lower_leg=15.0, chest=25.0)
    assert rules(out) == set()


@pytest.mark.ci
def test_poles_are_judged_where_a_limb_is_nearly_straight() -> None:
    assert rules(with_poles(posed_body(Pose()))) == set()
    assert rules(backwards(posed_body(Pose()))) == {"axes.pole"}
    assert rules(backwards(posed_body(Pose(knee=-15.0)))) == set()


def test_our_own_pole_is_known_by_its_metadata() -> None:
    body = posed_body(Pose())
    rig = with_poles(body)
    poles = [node for node in rig.metadata if "Leg" in rig.names[node]]
    names = tuple(f"k{k}" if k in poles else name for k, name in enumerate(rig.names))
    translation = rig.translation.copy()
    translation[poles, 2] *= -1.0
    moved = replace(rig, names=names, translation=translation)
    assert [rule for rule, _, _ in axis_findings(moved)] == ["axes.pole"] * 2
    given = {node: {**rig.metadata[node], "source": "given"} for node in poles}
    assert rules(replace(moved, metadata={**rig.metadata, **given})) == set()


def test_left_and_right_by_other_signs_are_named() -> None:
    out = rolled(posed_body(Pose(arms=80.0)), left_upper_arm=180.0, left_lower_arm=180.0)
    ((rule, _, text),) = axis_findings(out)
    assert rule == "axes.flex"
    assert "left elbow by -y, right elbow by +y" in text


@pytest.mark.parametrize("part", ["left_thumb_2", "right_hand", "left_foot", "right_clavicle"])
@pytest.mark.parametrize("degrees", one_in(2, [90.0, 180.0]))
def test_rolled_hands_thumbs_feet_and_clavicles_are_named(part: str, degrees: float) -> None:
    body = posed_body(Pose(arms=70.0))
    ((rule, node, text),) = axis_findings(rolled(body, **{part: degrees}))
    assert (rule, node) == ("axes.roll", body.parts[part.replace("_", " ")])
    assert "+y" in text


@pytest.mark.parametrize("part", ["left_thumb_1", "right_thumb_2"])
def test_a_thumb_that_is_no_mirror_image_of_the_other_is_named(part: str) -> None:
    """It may close over the palm all the same."""
    body = posed_body(Pose(arms=70.0))
    assert rules(rolled(body, **{part: 20.0})) == set()
    ((rule, node, text),) = axis_findings(rolled(body, **{part: 45.0}))
    assert (rule, node) == ("axes.roll", body.parts[f"left thumb {part[-1]}"])
    assert "no mirror image of it" in text


def test_thumbs_of_a_fist_and_of_an_open_hand_need_not_be_mirror_images() -> None:
    """Before, a thumb beside a fist was rolled otherwise against its fingers than the other one."""
    joints = [*TRUNK, *both([*ARM, *LEG])]
    thumb = [(0.725, 1.438, 0.028), (0.754, 1.424, 0.061), (0.775, 1.414, 0.086), (0.79, 1.4, 0.1)]
    for side, sign, bends in (("L", 1.0, (70.0, 155.0)), ("R", -1.0, (20.0, 35.0))):
        for finger, z in (("index", 0.03), ("middle", 0.01), ("ring", -0.01), ("little", -0.03)):
            a, b = np.radians(bends)
            steps = [(0.79, 1.45, z), (0.04 * np.cos(a), -0.04 * np.sin(a), 0.0)]
            steps.append((0.03 * np.cos(b), -0.03 * np.sin(b), 0.0))
            places = np.cumsum(steps, axis=0) * (sign, 1.0, 1.0)
            names = " ".join(f"{finger}{k}.{side}" for k in range(1, 4))
            joints += line(names, f"hand.{side}", *map(tuple, places.tolist()))
        names = " ".join(f"thumb{k}.{side}" for k in range(1, 5))
        joints += line(names, f"hand.{side}", *((sign * x, y, z) for x, y, z in thumb))
    assert rules(orient_joints(rig_with(joints))) == set()


def test_bones_that_share_the_axis_that_they_flex_about_are_not_rolled() -> None:
    """Noise tilts short bones, which then have no one plane: the shortest turn between them is aslant."""
    hinge, bones = np.array([0.0, 0.0, 1.0]), normalise(np.array([[1.0, 0.1, 0.3], [-0.2, 1.0, 0.3]]))
    up = normalise(hinge - (bones @ hinge)[:, None] * bones)
    axes = np.stack([bones, up, np.cross(bones, up)], axis=1)
    assert roll_between(axes, (0, 1.0), 0, 1) > 30 > 25 > roll_within(axes, (0, 1.0), 0, 1)
    turn = from_axis_angle(bones[1], np.radians(50.0))
    axes[1] = [bones[1], rotate(turn, up[1]), rotate(turn, np.cross(bones[1], up[1]))]
    assert roll_within(axes, (0, 1.0), 0, 1) > 30


@pytest.mark.ci
def test_a_joint_within_a_finger_that_is_rolled_is_named() -> None:
    body = posed_body(Pose())
    found = list(axis_findings(rolled(body, left_ring_2=90.0)))
    assert ("axes.roll", body.parts["left ring 2"]) in [(rule, node) for rule, node, _ in found]
    assert rules(rolled(body, left_ring_2=25.0)) == set()


def test_a_finger_of_a_hand_alone_that_curls_about_another_axis_is_named() -> None:
    rig = orient_joints(read(SAMPLES / "hand.glb").rig)
    assert rules(rig) == set()
    delta = np.tile(IDENTITY, (len(rig), 1))
    delta[[rig.find(f"index_{k}") for k in (1, 2, 3)]] = from_axis_angle(np.array([1.0, 0.0, 0.0]), np.pi / 2)
    ((_, _, text),) = [each for each in axis_findings(reframe(rig, delta)) if each[0] == "axes.fingers"]
    assert text.startswith("the fingers of the hand curl about axes up to 9")


def test_a_hand_whose_fingers_all_close_the_other_way_is_named() -> None:
    found = list(axis_findings(rolled(posed_body(Pose()), **dict.fromkeys(FINGERS, 180.0))))
    ((_, _, text),) = [each for each in found if each[0] == "axes.hands"]
    assert "by -y" in text
    assert "by +y" in text


def test_joints_without_weight_are_left_out() -> None:
    out = rolled(posed_body(Pose()), left_lower_leg=90.0)
    (skin,) = out.skins
    legs = [k for k, node in enumerate(skin.joints) if "LeftUpLeg" in out.path(int(node))]
    weighted = skin.weighted.copy()
    weighted[legs] = False
    bare = replace(out, skins=(replace(skin, weigh=lambda: weighted),))
    assert "axes.hinge" in rules(out)
    assert "axes.hinge" not in rules(bare)
    assert np.count_nonzero(weighted) < len(weighted)


def test_rounding_does_not_choose_which_of_equally_distant_fingers_are_named() -> None:
    rig, found = rolled(posed_body(Pose()), left_ring_1=50.0), set()
    for seed in range(6):
        noise = np.random.default_rng(seed).uniform(-1e-9, 1e-9, (len(rig), 4))
        ((_, _, text),) = [
            each for each in axis_findings(reframe(rig, IDENTITY + noise)) if each[0] == "axes.fingers"
        ]
        found.add(text)
    assert len(found) == 1


@pytest.mark.parametrize("preset", ["article", "blender", "maya"])
def test_a_trunk_that_is_rolled_as_a_whole_is_named_once(preset: str) -> None:
    """Nothing of it differs from its neighbour, and another axis points where the character faces."""
    body = posed_body(Pose())
    rig = orient_joints(body.rig, preset=preset)
    delta = np.tile(IDENTITY, (len(rig), 1))
    trunk = [body.parts[part] for part in ("hips", "spine", "chest", "upper chest", "neck", "head")]
    bone = np.array(PRESETS[preset].aim == np.array(list("xyz")), dtype=float)
    delta[trunk] = from_axis_angle(bone, np.pi / 2)
    ((rule, node, text),) = axis_findings(reframe(rig, delta))
    assert (rule, node) == ("axes.trunk", body.parts["spine"])
    assert text.startswith("is rolled with all of the trunk: it bends about ")


def test_limbs_are_recognised_once_and_looked_at_in_their_own_character(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    one = read(SAMPLES / "biped.glb").rig
    rig = copies(one, 3)
    seen: list[Any] = []
    monkeypatch.setattr(axis_check, "recognised", lambda rig: seen.append(rig) or recognised(rig))
    wide: list[int] = []

    def counted(array: Any) -> Any:
        wide.append(array.shape[1])
        return normalise(array)

    monkeypatch.setattr(limb_triples, "normalise", counted)
    rules(rig)
    assert len(seen) == 1
    assert wide
    assert max(wide) <= len(one)


def copies(rig: Rig, count: int) -> Rig:
    """So many characters as this one in one rig; the first has the clips."""
    many = (f"{name}.{k}" for k in range(count) for name in rig.names)
    parents = [np.where(rig.parents < 0, -1, rig.parents + k * len(rig)) for k in range(count)]
    parts = ("translation", "rotation", "scale", "matrix", "has_matrix")
    return replace(
        rig,
        names=tuple(many),
        parents=np.concatenate(parents),
        **{part: np.concatenate([getattr(rig, part)] * count) for part in parts},
        attachment=np.full(count * len(rig), -1),
        keys=tuple(range(count * len(rig))),
        labels=tuple(f"#{k}" for k in range(count * len(rig))),
        metadata={},
        skins=tuple(
            replace(skin, joints=skin.joints + k * len(rig)) for k in range(count) for skin in rig.skins
        ),
    )


@pytest.mark.parametrize(
    ("joint", "degrees", "expected", "text"),
    [
        ("spine2", 90.0, "axes.trunk", "is rolled by 90° against 'spine1'"),
        ("shin.L", 90.0, "axes.hinge", "rolled by 90° against that of 'thigh.L'"),
        ("forearm.R", 90.0, "axes.hinge", "rolled by 90° against that of 'upper_arm.R'"),
        ("thigh.R shin.R", 180.0, "axes.flex", "'shin.L' by +y, 'shin.R' by -y"),
    ],
)
def test_the_axes_of_an_animal_are_judged_as_those_of_a_person(
    joint: str, degrees: float, expected: str, text: str
) -> None:
    """Before, nothing was found on four legs but hands."""
    rig = orient_joints(rig_with(HORSE))
    assert rules(rig) == set()
    turn = np.tile(IDENTITY, (len(rig), 1))
    for name in joint.split():
        turn[rig.find(name)] = from_axis_angle([1.0, 0.0, 0.0], np.radians(degrees))
    found = {rule: words for rule, _, words in reversed(list(axis_findings(reframe(rig, turn))))}
    assert text in found[expected]


def test_a_pole_ahead_of_the_elbow_of_a_nearly_straight_front_leg_is_named() -> None:
    """Its elbow bends back, as that of an arm. Before, poles of animals were not looked at."""
    joints = {name: (name, above, at) for name, above, at in HORSE}
    for side, sign in (("L", 1.0), ("R", -1.0)):
        (_, _, (x, high, z)), (_, _, (_, low, ahead)) = joints[f"upper_arm.{side}"], joints[f"hand.{side}"]
        half = (sign * abs(x), 0.5 * (high + low), 0.5 * (z + ahead) - 0.01)
        joints[f"forearm.{side}"] = (f"forearm.{side}", f"upper_arm.{side}", half)
    rig = add_polevector(orient_joints(rig_with([*joints.values()])), limbs="auto")
    assert rules(rig) == set()
    (pole,) = (k for k in rig.metadata if rig.names[k].startswith("forearm.L"))
    translation = rig.translation.copy()
    translation[pole, 2] += 2.0 * (rig.world[rig.find("forearm.L"), 3, 2] - rig.world[pole, 3, 2])
    (found,) = axis_findings(replace(rig, translation=translation))
    assert found[:2] == ("axes.pole", pole)
    assert "behind the elbow" in found[2] or "to which it bends at 'forearm.L'" in found[2]


def test_the_limbs_of_half_a_body_are_judged_as_those_of_a_whole_one() -> None:
    """Before, nothing was said of knees, elbows and poles of a part of a body, as of legs alone."""
    legs = [joint for joint in MAN if joint[0].split(".")[0] in ("hips", "thigh", "shin", "foot", "toe")]
    rig = orient_joints(rig_with(legs))
    assert [k.form for k in recognise(rig).characters] == ["partial"]
    assert rules(rig) == set()
    delta = np.tile(IDENTITY, (len(rig), 1))
    delta[rig.find("shin.L")] = from_axis_angle(np.array([1.0, 0.0, 0.0]), np.radians(45.0))
    assert "axes.hinge" in rules(reframe(rig, delta))
