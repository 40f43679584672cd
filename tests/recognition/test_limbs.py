"""Arms and legs by VRM map and by names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES, asset_files
from posed_bodies import Pose, posed_body
from recognition_bodies.skeletons import FINGERS, HORSE, MAN, Joint, both, line, rig_with
from rigs import chain, rig_of

from rigtri.errors import NameNotFoundError, UsageError
from rigtri.formats import read
from rigtri.model.rig import Rig
from rigtri.recognition.body_hinges import bodies
from rigtri.recognition.limb_bends import LimbBends
from rigtri.recognition.limbs import along, given, recognise
from rigtri.recognition.recognise import recognise as recognise_characters
from rigtri.report import Report


def named(names: list[str], parents: list[int]) -> Rig:
    rig = chain(*((float(k), 0.0, 0.0) for k in range(len(names))))
    return replace(rig, names=tuple(names), parents=np.array(parents))


def triples(rig: Rig) -> list[list[str]]:
    return [[rig.names[node] for node in limb.triple] for limb in recognise(rig)]


def test_mixamo_names_make_an_arm_although_the_clavicle_is_called_shoulder() -> None:
    names = ["Spine", "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"]
    rig = named([f"mixamorig:{name}" for name in names], [-1, 0, 1, 2, 3])
    assert triples(rig) == [[f"mixamorig:{name}" for name in names[2:]]]


def test_the_foot_of_a_flat_rig_is_parented_elsewhere_and_still_ends_the_leg() -> None:
    rig = named(["root", "UpperLeg.L", "LowerLeg.L", "Foot.L"], [-1, 0, 1, 0])
    assert triples(rig) == [["UpperLeg.L", "LowerLeg.L", "Foot.L"]]


def test_controls_beside_the_joints_are_not_taken_for_limbs() -> None:
    rig = named(["root", "upperarm.l", "lowerarm.l", "wrist.l", "hand.l", "handIK.l"], [-1, 0, 1, 2, 3, 0])
    assert triples(rig) == [["upperarm.l", "lowerarm.l", "wrist.l"]]


def test_a_humanoid_map_goes_before_names() -> None:
    rig = named(["a", "b", "c", "d"], [-1, 0, 1, 2])
    bones = {"leftUpperArm": 1, "leftLowerArm": 2, "leftHand": 3}
    (limb,) = recognise(replace(rig, humanoid=bones))
    assert (limb.triple, limb.kind, limb.side, limb.evidence) == ((1, 2, 3), "arm", "left", "vrm")


def test_bones_of_a_humanoid_map_that_share_a_joint_are_read_by_names() -> None:
    rig = named(["hips", "UpperLeg.L", "LowerLeg.L", "Foot.L"], [-1, 0, 1, 2])
    for shared in (0, 1, 3):
        bones = dict.fromkeys(("leftUpperLeg", "leftLowerLeg", "leftFoot"), shared)
        assert triples(replace(rig, humanoid=bones)) == [["UpperLeg.L", "LowerLeg.L", "Foot.L"]]


def test_joints_that_are_only_numbered_make_a_limb_of_the_first_three() -> None:
    rig = named(
        ["torso", "leg_joint_L_1", "leg_joint_L_2", "leg_joint_L_3", "leg_joint_L_5"], [-1, 0, 1, 2, 3]
    )
    assert triples(rig) == [["leg_joint_L_1", "leg_joint_L_2", "leg_joint_L_3"]]


def test_joints_that_are_only_numbered_on_no_side_make_no_limb() -> None:
    assert not triples(named(["torso", "leg_joint_1", "leg_joint_2", "leg_joint_3"], [-1, 0, 1, 2]))


def test_a_limb_has_three_different_joints() -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0))
    with pytest.raises(UsageError, match="three different joints"):
        given(rig, "a", "b", "b")
    with pytest.raises(NameNotFoundError, match="'elbow'"):
        given(rig, "a", "elbow", "b")


@pytest.mark.parametrize("names", ["c b a", "b a c", "a c b", "c a d"])
def test_a_limb_that_is_named_upside_down_is_called_that(names: str) -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0))
    first, second, third = names.split()
    with pytest.raises(UsageError, match=f"the limb '{first}', '{second}', '{third}' is upside down"):
        given(rig, first, second, third)
    assert given(rig, "a", "b", "d").triple == (0, 1, 3)


@pytest.mark.parametrize(
    ("names", "kind", "side"),
    [
        ("arm_L elbow_L hand_L", "arm", "left"),
        ("arm_L elbow_R hand_L", "arm", ""),
        ("thigh_R knee_R foot_R", "leg", "right"),
        ("arm_L knee_L foot_L", "", "left"),
        ("x y z", "", ""),
    ],
)
def test_the_kind_and_side_of_a_named_limb_are_read_from_all_its_names(
    names: str, kind: str, side: str
) -> None:
    rig = named(names.split(), [-1, 0, 1])
    found = given(rig, *names.split())
    assert (found.kind, found.side) == (kind, side)


@pytest.mark.parametrize(
    ("names", "below", "above"),
    [
        ("hand_L head toe_L", "head", "hand_L"),
        ("thigh_L shin_L thigh_R", "thigh_R", "shin_L"),
        ("hips thigh_L hand_R", "hand_R", "thigh_L"),
    ],
)
def test_joints_of_several_branches_are_no_limb(names: str, below: str, above: str) -> None:
    rig = read(SAMPLES / "biped.glb").rig
    words = rf"'{below}' does not lie below '{above}'. Recognised: .*left leg \(thigh_L - shin_L - foot_L"
    with pytest.raises(UsageError, match=words):
        given(rig, *names.split())


@pytest.mark.parametrize("names", ["thigh shin foot", "thigh shin toe", "thigh shin knee_pole"])
def test_the_end_of_a_flat_limb_may_hang_at_the_root(names: str) -> None:
    rig = read(SAMPLES / "flat_ik.glb").rig
    assert given(rig, *names.split()).triple == tuple(map(rig.find, names.split()))


def test_no_chain_leads_from_one_branch_to_another() -> None:
    rig = rig_of(["root", "a", "b"], [-1, 0, 0], np.eye(3))
    with pytest.raises(UsageError, match="does not lie below"):
        along(rig, 1, 2)


# Counted by hand in each file: arms and legs whose three joints the file has.
LIMBS = {
    "kaykit_Barbarian.glb": 4,
    "gdquest_mannequiny-0.3.0.glb": 4,
    "raylib_robot.glb": 4,
    "gt_sparse_player.glb": 2,
    "addon_Example_vrm1.vrm": 4,
    "usdwg_RiggedFigure.usdz": 4,
    "mayausd_HIK_Export.usda": 4,
    "godot_enemy.glb": 0,
}


@pytest.mark.parametrize("name", LIMBS)
def test_limbs_of_real_characters_are_found(name: str, assets: Path) -> None:
    (path,) = (path for path in asset_files() if path.name == name)
    limbs = recognise(read(path).rig)
    assert len(limbs) == LIMBS[name]
    assert all(len(set(limb.triple)) == 3 for limb in limbs)


def test_straight_front_legs_of_an_animal_bend_at_elbows() -> None:
    heights = (1.2, 0.8, 0.42, 0.08)
    legs = line("upper_arm.L forearm.L hand.L finger.L", "chest", *((0.2, y, 0.7) for y in heights))
    moved = {name: place for name, _, place in both(legs)}
    rig = rig_with([(name, over, moved.get(name, place)) for name, over, place in HORSE])
    front = [limb for limb in recognise(rig) if limb.front]
    assert len(front) == 2
    bends = LimbBends(rig, rig.world, None, front, [], np.array([0.0, 0.0, 1.0]))
    for limb in front:
        found = bends.of(limb, Report())
        assert found is not None
        assert found.direction[2] < -0.99


def test_fingers_close_with_a_sure_hand_whichever_they_are() -> None:
    """Which finger each is may be a guess; that they are of the hand is as sure as the hand."""
    rig = posed_body(Pose()).rig
    (character,) = recognise_characters(rig).characters
    guessed = tuple(replace(k, confidence=0.7) if k.kind == "finger" else k for k in character.chains)
    (sure,) = bodies(rig, [character], rig.world, None)
    (unsure,) = bodies(rig, [replace(character, chains=guessed)], rig.world, None)
    fingers = {joint for k in character.chains if k.kind == "finger" for joint in k.joints}
    assert fingers
    assert fingers <= sure.hinges.keys()
    assert fingers <= unsure.hinges.keys()


def _called(joints: list[Joint], hands: bool) -> list[Joint]:
    """The joints whose fingers have names, or of their hands alone below one joint."""
    words = {"t": "thumb", **{f"f{k}": word for k, word in enumerate(["index", "middle", "ring", "pinky"])}}
    named = {}
    for name, _, _ in FINGERS:
        which, side = name.split(".")
        named[name] = f"{words[which[:-1]]}_{which[-1]}.{side}"
    called = [(named.get(name, name), named.get(above, above), at) for name, above, at in joints]
    if not hands:
        return called
    below = {"hand.L", "hand.R", *named.values()}
    cut = [(name, above if above in below else "root", at) for name, above, at in called if name in below]
    return [("root", "", (0.0, 1.4, 0.0)), *cut]


def test_two_hands_alone_are_hands_and_close_as_those_of_a_body() -> None:
    """Before, they were the arms of a body, with a finger for elbow and wrist."""
    found = []
    for hands in (True, False):
        joints = _called([*MAN, *FINGERS], hands)
        rig = rig_with(joints)
        (character,) = recognise_characters(rig).characters
        (body,) = bodies(rig, [character], rig.world, None)
        closing = {joints[k][0]: hinge.direction for k, hinge in body.hinges.items()}
        found.append({name: closing[name] for name in closing if name[-3] in "123"})
        if hands:
            assert character.form == "hand"
            assert [k.name for k in character.chains if k.kind == "hand" and k.is_sure] == [
                "left hand",
                "right hand",
            ]
            assert {k.kind for k in character.chains} == {"hand", "finger"}
    alone, whole = found
    assert len(alone) == 30
    assert alone.keys() == whole.keys()
    for name, direction in alone.items():
        assert float(np.dot(direction, whole[name])) > 0.9


def test_hands_below_arms_are_no_hands_alone() -> None:
    """Most joints of a chest with arms and two hands are of its hands."""
    upper = [joint for joint in MAN if joint[0].split(".")[0] in ("clavicle", "upper_arm", "forearm", "hand")]
    joints = _called([*upper, *FINGERS], hands=False)
    top: list[Joint] = [("chest", "", (0.0, 1.3, 0.0)), *joints]
    (character,) = recognise_characters(rig_with(top)).characters
    assert character.form != "hand"
    assert sorted(k.name for k in character.limbs if k.kind == "arm") == ["left arm", "right arm"]
