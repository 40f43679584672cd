"""Which joints make arms, legs, spine and fingers: by map, by names, by shape alone."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from pathlib import Path
from weakref import ref

import numpy as np
import pytest
from places import SAMPLES, asset_files
from program import cli
from recognition_bodies.skeletons import (
    FINGERS,
    FLAT,
    HAIR,
    HORSE,
    LEG,
    MAN,
    SITTING,
    SKIRT,
    THINGS,
    TRUNK,
    TWISTED,
    Joint,
    both,
    rig_with,
)
from second_opinions import validator

import rigtri
from rigtri.errors import FileError
from rigtri.formats import read
from rigtri.maths.matrices import compose, multiply
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.recognition import layout_output
from rigtri.recognition.joint_tree import joints_of
from rigtri.recognition.layout import CONFIDENT, Layout
from rigtri.recognition.limbs import recognise as limbs
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.naming_schemes import own_scheme, schemes
from rigtri.recognition.recognise import recognise, sure_limbs
from rigtri.recognition.word_tables import our_table
from rigtri.report import Report

FOUR = {
    "left arm": "upper_arm.L forearm.L hand.L",
    "right arm": "upper_arm.R forearm.R hand.R",
    "left leg": "thigh.L shin.L foot.L",
    "right leg": "thigh.R shin.R foot.R",
}


def bends(joints: list[Joint], layout: Layout, *, least: float = CONFIDENT) -> dict[str, str]:
    """The limbs that are sure, with the names that joints had."""
    names = [name for name, _, _ in joints]
    return {
        chain.name: " ".join(names[joint] for joint in chain.bend)
        for chain in layout.chains
        if chain.bend and chain.confidence >= least
    }


BODIES = {
    "t-pose": MAN,
    "sitting": SITTING,
    "twist joints within limbs": TWISTED,
    "long hair": [*MAN, *HAIR],
    "a skirt": [*MAN, *SKIRT],
    "all joints at one": FLAT,
}


def test_a_trunk_whose_names_call_the_first_joint_a_chest_is_counted() -> None:
    """VRM's humanoid has a spine below its chest: the first of these two is none, whatever it is called."""
    rig = rig_with(MAN)
    names = {"spine": "torso_joint_2", "chest": "torso_joint_3"}  # of Cesium Man
    rig = replace(rig, names=tuple(names.get(name, name) for name in rig.names))
    (body,) = recognise(rig).characters
    assert [rig.names[body.bones[bone]] for bone in ("spine", "chest")] == list(names.values())


@pytest.mark.parametrize("named", [True, False], ids=["named", "nameless"])
@pytest.mark.parametrize("which", BODIES)
def test_arms_and_legs_are_found(which: str, named: bool) -> None:
    joints = BODIES[which]
    layout = recognise(rig_with(joints, named=named))
    assert bends(joints, layout) == FOUR
    (character,) = layout.characters
    assert character.form == "biped"
    assert np.allclose(character.facing, (0, 0, 1))
    assert np.allclose(character.up, (0, 1, 0))
    assert np.allclose(character.normal, (1, 0, 0))
    assert joints[character.hips][0] == "hips"


@pytest.mark.parametrize("named", [True, False], ids=["named", "nameless"])
def test_where_a_body_stands_and_how_it_is_rotated_changes_nothing(named: bool) -> None:
    rig = rig_with(MAN, named=named)
    turned = compose(np.array([3.0, 1, 2]), from_axis_angle(np.array([0.6, 0, 0.8]), 1.1), np.full(3, 40.0))
    root = multiply(rig.local[:1], turned)
    has_matrix = np.arange(len(rig)) == 0
    moved = replace(
        rig, matrix=np.where(has_matrix[:, np.newaxis, np.newaxis], root, rig.matrix), has_matrix=has_matrix
    )
    assert bends(MAN, recognise(moved)) == FOUR


def test_no_place_and_no_direction_is_minus_nothing() -> None:
    """Coordinates that float32 leaves next to zero, of either sign, are shown as 0.0."""
    (found,) = recognise(read(SAMPLES / "tpose.glb").rig).characters
    numbers = [*found.point, *found.normal, *found.facing, *found.up]
    assert numbers.count(0.0) >= 6
    assert not any(str(number).startswith("-") for number in numbers if number == 0.0)


def test_spine_neck_and_head_stand_between_and_beyond_the_limbs() -> None:
    (character,) = recognise(rig_with(MAN, named=False)).characters
    chains = {chain.name: [MAN[joint][0] for joint in chain.joints] for chain in character.chains}
    assert chains["spine"] == ["spine", "chest"]
    assert chains["neck"] == ["neck"]
    assert chains["head"] == ["head"]
    assert chains["left foot"] == ["foot.L", "toe.L"]
    bones = {bone: MAN[node][0] for bone, node in character.bones.items()}
    assert bones["leftShoulder"] == "clavicle.L"
    assert bones["rightToes"] == "toe.R"
    assert bones["hips"] == "hips"


def test_a_twist_joint_within_a_limb_is_reported_as_one() -> None:
    (character,) = recognise(rig_with(TWISTED, named=False)).characters
    roles = {TWISTED[part.joint][0]: part.role for part in character.parts}
    assert [roles[name] for name in ("a.L", "b.R", "c.L", "forearm.L")] == [
        "twist",
        "twist",
        "twist",
        "deform",
    ]


def test_fingers_are_recognised_by_their_position_from_the_thumb_on() -> None:
    joints = [*MAN, *FINGERS]
    (character,) = recognise(rig_with(joints, named=False)).characters
    fingers = {
        c.name: joints[c.joints[0]][0] for c in character.chains if c.kind == "finger" and c.side == "left"
    }
    assert fingers == {
        "left thumb": "t1.L",
        "left index finger": "f01.L",
        "left middle finger": "f11.L",
        "left ring finger": "f21.L",
        "left little finger": "f31.L",
    }
    assert joints[character.bones["leftThumbDistal"]][0] == "t3.L"


def test_what_is_no_bone_of_the_body_is_reported_by_name_and_by_place() -> None:
    more: list[Joint] = [
        ("root", "", (0, 0, 0)),
        *((name, above or "root", place) for name, above, place in MAN),
        ("elbow_pole.L", "root", (0.44, 1.45, -0.6)),
        ("x", "root", (0.1, 0.5, 0.6)),
        ("y", "upper_arm.L", (0.3, 1.45, 0)),
        ("sword_slot", "hand.R", (-0.8, 1.45, 0)),
        ("toe_end.L", "toe.L", (0.1, 0.03, 0.2)),
    ]
    rig = rig_with(more)
    moved = np.array([name not in ("x", "elbow_pole.L", "toe_end.L") for name, _, _ in more])
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moved),))
    (character,) = recognise(rig).characters
    roles = {more[part.joint][0]: part.role for part in character.parts}
    wanted = {"root": "control", "elbow_pole.L": "control", "x": "control", "y": "twist"}
    wanted |= {"sword_slot": "attachment", "toe_end.L": "end", "shin.L": "deform"}
    assert {name: roles[name] for name in wanted} == wanted


def test_controls_beside_bones_called_def_are_no_body() -> None:
    """As Rigify has them: ORG- and plain names of the same words, and DEF- bones that hang at ORG- ones."""
    joints: list[Joint] = [("root", "", (0, 0, 0))]
    joints += [(f"ORG-{name}", f"ORG-{above}" if above else "root", place) for name, above, place in MAN]
    joints += [(name, f"ORG-{name}", place) for name, _, place in MAN]
    first = {"clavicle.L", "clavicle.R", "thigh.L", "thigh.R", "hips"}
    joints += [
        (f"DEF-{name}", f"ORG-{name}" if name in first else f"DEF-{above}", place)
        for name, above, place in MAN
    ]
    layout = recognise(rig_with(joints))
    assert bends(joints, layout) == {
        name: " ".join(f"DEF-{joint}" for joint in bend.split()) for name, bend in FOUR.items()
    }
    roles = {joints[part.joint][0]: part.role for part in layout.characters[0].parts}
    assert [roles[name] for name in ("ORG-hand.L", "hand.L", "DEF-hand.L")] == [
        "control",
        "control",
        "deform",
    ]


def test_joints_that_move_points_are_no_controls_beside_the_few_that_are_called_def() -> None:
    """As Rigify's bones are once the main ones have other names: the segments of its limbs keep theirs."""
    segments = both(
        [
            (f"DEF-{bone}.L.00{k}", f"{bone}.L", tuple(np.array(start) + (end - np.array(start)) * k / 3))
            for bone, start, end in (
                ("upper_arm", (0.16, 1.45, 0), (0.44, 1.45, 0)),
                ("thigh", (0.1, 0.95, 0), (0.1, 0.5, 0)),
            )
            for k in (1, 2)
        ]
    )
    joints = [("root", "", (0, 0, 0)), *((name, above or "root", place) for name, above, place in MAN)]
    joints += segments
    rig = rig_with(joints)
    moved = np.array([name != "root" for name, _, _ in joints])
    layout = recognise(replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moved),)))
    assert bends(joints, layout) == FOUR
    roles = {joints[part.joint][0]: part.role for part in layout.characters[0].parts}
    assert [name for name, role in roles.items() if role == "control"] == ["root"]


def test_a_bone_that_only_holds_joints_side_by_side_is_read_without_children() -> None:
    """Flat rigs (IK baked to one level) have the names of their containers read, too: before, a KeyError."""
    joints = [("forearm.L", "", (0, 0, 0))]
    joints += [(name, "forearm.L", place) for name, _, place in MAN if name not in ("forearm.L", "hand.L")]
    rig = rig_with(joints)
    skin = rig.skins[0]
    held = replace(skin, joints=skin.joints[1:], inverse_bind=skin.inverse_bind[1:])
    assert recognise(replace(rig, skins=(held,))) is not None


def test_a_foot_parented_to_the_root_ends_its_leg_if_it_moves_points() -> None:
    joints: list[Joint] = [("root", "", (0, 0, 0))]
    loose = {"foot.L": "root", "foot.R": "root"}
    joints += [(name, loose.get(name, above or "root"), place) for name, above, place in MAN]
    # Without feet elbows that are clearly bent alone tell where it faces.
    joints = [(name, above, (x, y, z - 0.09 * name.startswith("fore"))) for name, above, (x, y, z) in joints]
    rig = rig_with(joints, named=False)
    assert bends(joints, recognise(rig)) == FOUR
    moved = np.array([name[:3] not in ("foo", "toe") for name, _, _ in joints])
    controls = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moved),))
    found = bends(joints, recognise(controls))
    assert "left leg" not in found
    assert found["left arm"] == FOUR["left arm"]


def test_a_horse_has_four_legs_and_a_tail() -> None:
    (character,) = recognise(rig_with(HORSE)).characters
    assert character.form == "quadruped"
    assert bends(HORSE, recognise(rig_with(HORSE))) == {
        "left hind leg": "thigh.L shin.L foot.L",
        "right hind leg": "thigh.R shin.R foot.R",
        "left front leg": "upper_arm.L forearm.L hand.L",
        "right front leg": "upper_arm.R forearm.R hand.R",
    }
    assert [chain.name for chain in character.chains if chain.kind == "tail"] == ["tail"]
    assert np.allclose(character.facing, (0, 0, 1))


@pytest.mark.parametrize("link", ["HorseLink", "hock", "paw"])
def test_names_of_animals_make_legs_of_arms_that_do_not_quite_reach_the_ground(link: str) -> None:
    joints = [
        (name.replace("foot", link), over.replace("foot", link), (*place[:1], place[1] + 0.2, *place[2:]))
        if name.startswith("finger")
        else (name.replace("foot", link), over.replace("foot", link), place)
        for name, over, place in HORSE
    ]
    (character,) = recognise(rig_with(joints)).characters
    assert character.form == "quadruped"


def test_legs_and_a_tail_that_begin_at_one_joint_are_no_fingers() -> None:
    """Before, it was a hand with four fingers."""
    sides = [(side, x) for side, x in (("L", 0.2), ("R", -0.2))]
    joints: list[Joint] = [("body", "", (0, 1.4, -0.65))]
    for k in range(4):
        joints.append((f"back{k + 1}", joints[-1][0], (0, 1.4, -0.65 + 0.325 * (k + 1))))
    joints += [("neck1", "back4", (0, 1.8, 1.0)), ("head", "neck1", (0, 2.1, 1.25))]
    joints += [
        (f"tail{k}", f"tail{k - 1}" if k > 1 else "body", (0, 1.4, -0.65 - 0.15 * k)) for k in range(1, 5)
    ]
    hind = [(1.3, -0.6), (0.95, -0.45), (0.62, -0.82), (0.25, -0.77), (0.06, -0.67)]
    front = [(1.15, 0.77), (0.95, 0.57), (0.55, 0.63), (0.2, 0.65), (0.05, 0.72)]
    for side, x in sides:
        for which, over, places in (("back", "body", hind), ("front", "back4", front)):
            for k, (y, z) in enumerate(places, start=1):
                name = f"leg_{which}_{k}_{side}"
                joints.append((name, over, (x, y, z)))
                over = name
    (character,) = recognise(rig_with(joints)).characters
    assert character.form == "quadruped"


def test_a_hoof_that_is_called_as_an_index_finger_makes_no_human() -> None:
    """Before, it was a biped, and surely."""
    words = {"thigh": "UpLeg", "shin": "Leg", "foot": "Foot", "clavicle": "Shoulder", "upper_arm": "Arm"}
    words |= {"forearm": "ForeArm", "hand": "Hand", "finger": "HandIndex1", "toe": "ToeBase"}
    sides = {"L": "Left", "R": "Right"}

    def called(name: str) -> str:
        bone, _, side = name.partition(".")
        return f"mixamorig:{sides[side]}{words[bone]}" if bone in words else name

    joints = [(called(name), called(above), place) for name, above, place in HORSE]
    (character,) = recognise(rig_with(joints)).characters
    assert character.form == "quadruped"
    assert all(chain.kind != "arm" for chain in character.chains)


@pytest.mark.parametrize("named", [True, False], ids=["named", "nameless"])
@pytest.mark.parametrize("thing", THINGS)
def test_what_is_no_character_has_no_limb_and_is_reported_as_none(thing: str, named: bool) -> None:
    layout = recognise(rig_with(THINGS[thing], named=named))
    assert bends(THINGS[thing], layout) == {}
    assert not layout.characters
    assert layout.remarks[0].startswith("not a character: ")


def test_a_part_of_a_body_is_one_and_the_rest_is_missed() -> None:
    half = [*TRUNK, *LEG]
    layout = recognise(rig_with(half))
    assert bends(half, layout) == {"left leg": FOUR["left leg"]}
    assert layout.characters[0].form == "partial"
    assert "no right leg was found, though there is a left one" in layout.remarks
    # Of a pair alone nobody can tell by its shape what it is: it is shown, and left alone.
    legs = [*TRUNK[:1], *both(LEG)]
    nameless = recognise(rig_with(legs, named=False))
    assert bends(legs, nameless) == {}
    assert set(bends(legs, nameless, least=0.0)) == {"left leg", "right leg"}


def two_bodies(skins: int) -> Rig:
    """A man, and another beside him."""

    def second(name: str) -> str:
        return f"second_{name}" if name else ""

    other = [(second(name), second(above), (x + 2, y, z)) for name, above, (x, y, z) in MAN]
    rig = rig_with([*MAN, *other])
    if skins == 1:
        return rig
    halves = np.split(np.arange(len(rig)), 2)
    bind = rig.skins[0].inverse_bind
    return replace(rig, skins=tuple(Skin(f"s{rows[0]}", rows, bind[rows]) for rows in halves))


@pytest.mark.parametrize("skins", [1, 2])
def test_two_characters_of_a_file_are_distinguished(skins: int) -> None:
    rig = two_bodies(skins)
    layout = recognise(rig)
    assert len(layout.characters) == 2
    assert layout.remarks[0].startswith("2 characters")
    assert len(limbs(rig)) == 8


def test_names_that_contradict_the_shape_are_not_trusted() -> None:
    swapped = {
        "upper_arm": "thigh",
        "forearm": "shin",
        "hand": "foot",
        "thigh": "upper_arm",
        "shin": "forearm",
        "foot": "hand",
    }

    def called(name: str) -> str:
        word, dot, which = name.partition(".")
        return swapped.get(word, word) + dot + which

    joints = [(called(name), called(above), place) for name, above, place in MAN]
    layout = recognise(rig_with(joints))
    assert bends(joints, layout) == {}
    assert any("but its shape is that of a" in words for chain in layout.chains for words in chain.evidence)


def test_names_of_one_side_are_enough() -> None:
    """The twin of a limb whose shape agrees with its names is one, too, whatever it is called."""
    other = {name: f"bone{k}" for k, (name, _, _) in enumerate(MAN) if name.endswith(".R")}
    joints = [(other.get(name, name), other.get(above, above), place) for name, above, place in MAN]
    found = bends(joints, recognise(rig_with(joints)))
    assert found["right leg"] == " ".join(other[name] for name in FOUR["right leg"].split())
    assert found["left arm"] == FOUR["left arm"]
    assert len(found) == 4


def test_what_names_call_left_stays_left_and_the_contradiction_is_reported() -> None:
    joints = [(name, above, (-x, y, z)) for name, above, (x, y, z) in MAN]
    layout = recognise(rig_with(joints))
    assert bends(joints, layout) == FOUR
    assert any("call left is on the right" in remark for remark in layout.remarks)
    orient_joints(rig_with(joints), report=(report := Report()))
    assert "sides-disagree" in [notice.code for notice in report.warnings]


@pytest.mark.parametrize("mirrored", [True, False])
def test_what_little_denies_names_of_sides_is_told_and_believed_below_a_mirrored_root(mirrored: bool) -> None:
    """Feet say one way, elbows the other, names that of the elbows. Before, nothing was said."""
    joints = [(name, above, (-x, y, z + 0.1 * name.startswith("forearm"))) for name, above, (x, y, z) in MAN]
    rig = rig_with(joints)
    if mirrored:
        sign = np.where(np.arange(len(rig)) == 0, -1.0, 1.0)[:, np.newaxis] * [1, 0, 0] + [0, 1, 1]
        rig = replace(rig_with([(name, above, (-x, y, z)) for name, above, (x, y, z) in joints]), scale=sign)
    layout = recognise(rig)
    assert layout.characters[0].facing[2] == pytest.approx(1 if mirrored else -1, abs=0.01)
    assert any(f"call left {'is' if mirrored else 'may be'} on the right" in k for k in layout.remarks)
    assert layout.characters[0].is_mirrored == mirrored


def test_only_what_is_sure_is_a_limb_to_work_on() -> None:
    rig = rig_with([*TRUNK[:1], *both(LEG)], named=False)
    assert limbs(rig) == []
    found = limbs(rig_with(MAN, named=False))
    assert [(limb.kind, limb.side, limb.evidence) for limb in found] == [
        ("arm", "left", "shape"),
        ("arm", "right", "shape"),
        ("leg", "left", "shape"),
        ("leg", "right", "shape"),
    ]
    # Of joints that all hang at one, start and end make no chain that an operation could turn.
    assert limbs(rig_with(FLAT)) == []


def test_a_hand_alone_has_its_fingers() -> None:
    layout = recognise(read(SAMPLES / "hand.glb").rig)
    assert layout.characters[0].form == "hand"
    names = [chain.name for chain in layout.chains]
    assert names == ["hand", "thumb", "index finger", "middle finger", "ring finger", "little finger"]


# Names of one arm, one leg and the middle, as each scheme has them, by the joints of MAN.
_JOINTS = "hips spine chest neck head clavicle.L upper_arm.L forearm.L hand.L thigh.L shin.L foot.L toe.L"
NAMED = {
    "Mixamo": """
        mixamorig:Hips mixamorig:Spine mixamorig:Spine1 mixamorig:Neck mixamorig:Head
        mixamorig:LeftShoulder mixamorig:LeftArm mixamorig:LeftForeArm mixamorig:LeftHand
        mixamorig:LeftUpLeg mixamorig:LeftLeg mixamorig:LeftFoot mixamorig:LeftToeBase
    """,
    "Unreal mannequin": """
        pelvis spine_01 spine_02 neck_01 head clavicle_l upperarm_l lowerarm_l hand_l thigh_l
        calf_l foot_l ball_l
    """,
    "Unity humanoid": """
        Hips Spine UpperChest Neck Head LeftShoulder LeftUpperArm LeftLowerArm LeftHand
        LeftUpperLeg LeftLowerLeg LeftFoot LeftToes
    """,
    "Rigify": """
        DEF-spine DEF-spine.001 DEF-spine.002 DEF-spine.004 DEF-spine.006 DEF-shoulder.L
        DEF-upper_arm.L DEF-forearm.L DEF-hand.L DEF-thigh.L DEF-shin.L DEF-foot.L DEF-toe.L
    """,
    "3ds Max Biped": """
        Bip01_Pelvis Bip01_Spine Bip01_Spine1 Bip01_Neck Bip01_Head Bip01_L_Clavicle
        Bip01_L_UpperArm Bip01_L_Forearm Bip01_L_Hand Bip01_L_Thigh Bip01_L_Calf Bip01_L_Foot
        Bip01_L_Toe0
    """,
    "MMD": """
        センター 上半身 上半身2 首 頭 左肩 左腕 左ひじ 左手首 左足 左ひざ 左足首 左つま先
    """,
    "MMD (English)": """
        groove upper_body upper_body2 neck head shoulder_L arm_L elbow_L wrist_L leg_L knee_L
        ankle_L toe_L
    """,
    "Daz": """
        hip abdomenLower chestLower neckLower head lCollar lShldrBend lForearmBend lHand
        lThighBend lShin lFoot lToe
    """,
    "Character Creator": """
        CC_Base_Hip CC_Base_Waist CC_Base_Spine01 CC_Base_NeckTwist01 CC_Base_Head
        CC_Base_L_Clavicle CC_Base_L_Upperarm CC_Base_L_Forearm CC_Base_L_Hand CC_Base_L_Thigh
        CC_Base_L_Calf CC_Base_L_Foot CC_Base_L_ToeBase
    """,
    "BVH joints": """
        Hips Abdomen Chest Neck Head LeftCollar LeftShoulder LeftElbow LeftWrist LeftHip LeftKnee
        LeftAnkle LeftToe
    """,
    "HumanIK": """
        Character1_Hips Character1_Spine Character1_Spine1 Character1_Neck Character1_Head
        Character1_LeftShoulder Character1_LeftArm Character1_LeftForeArm Character1_LeftHand
        Character1_LeftUpLeg Character1_LeftLeg Character1_LeftFoot Character1_LeftToeBase
    """,
    "Rokoko": """
        Hips Spine1 Spine4 Neck Head LeftShoulder LeftArm LeftForeArm LeftHand LeftThigh LeftShin
        LeftFoot LeftToe
    """,
}


# One name each for the joints of `_JOINTS`, accents and the sides of the language as they are written.
LANGUAGES = {
    "German": """
        Becken Wirbelsäule Brust Hals Kopf Schlüsselbein_links Oberarm_links Unterarm_links Hand_links
        Oberschenkel_links Unterschenkel_links Fuß_links Zehen_links
    """,
    "Swedish": """
        höft rygg bröst nacke huvud nyckelben_V överarm_V underarm_V hand_V lår_V underben_V fot_V tå_V
    """,
    "French": "Bassin Dos Torse Cou Tête Epaule_G Bras_G AvantBras_G Main_G Cuisse_G Jambe_G Pied_G Orteil_G",
    "Spanish": """
        cadera columna pecho cuello cabeza clavícula_izq brazo_izq antebrazo_izq mano_izq muslo_izq pierna_izq
        pie_izq dedos_izq
    """,
    "Chinese": "骨盆 脊椎 胸部 脖子 头 左锁骨 左上臂 左前臂 左手 左大腿 左小腿 左脚 左脚趾",
    "Korean": "골반 척추 가슴 목 머리 왼쪽쇄골 왼쪽위팔 왼쪽아래팔 왼손 왼쪽허벅지 종아리_왼쪽 왼발 왼발가락",
}
NAMED_ANYHOW = {**NAMED, **LANGUAGES}


@pytest.mark.parametrize("scheme", NAMED_ANYHOW)
def test_the_names_of_a_scheme_are_read_as_it_means_them(scheme: str) -> None:
    """By names alone: the joints stand in a line, where no shape helps."""
    names = dict(zip(_JOINTS.split(), NAMED_ANYHOW[scheme].split(), strict=True))
    above = {name: over for name, over, _ in MAN}
    joints = [(names[name], names.get(above[name], ""), (float(k), 0.0, 0.0)) for k, name in enumerate(names)]
    layout = recognise(rig_with(joints))
    (character,) = layout.characters
    found = {chain.kind: [joints[joint][0] for joint in chain.bend] for chain in layout.chains if chain.bend}
    assert found["arm"] == [names[k] for k in ("upper_arm.L", "forearm.L", "hand.L")]
    assert found["leg"] == [names[k] for k in ("thigh.L", "shin.L", "foot.L")]
    assert character.bones["leftShoulder"] == list(names).index("clavicle.L")
    title = "words of other languages" if scheme in LANGUAGES else scheme
    assert any(title in words for chain in layout.chains for words in chain.evidence)


MOVERS = ["センター", "グルーブ", "腰"]


@pytest.mark.parametrize("count", [1, 2, 3])
def test_of_joints_that_move_the_whole_in_turn_the_last_that_carries_all_is_the_hips(
    count: int,
) -> None:
    """MikuMikuDance has up to three of them; the pelvis, below the last, carries legs alone."""
    known = dict(zip(_JOINTS.split(), NAMED["MMD"].split(), strict=True))
    names = {
        name: known.get(name.replace(".R", ".L"), "").replace("左", "右" if ".R" in name else "左")
        for name, _, _ in MAN
    }
    movers = [(name, above, (0.0, 0.9, 0.0)) for name, above in zip(MOVERS, ["", *MOVERS], strict=False)][
        :count
    ]
    joints = [*movers, ("下半身", movers[-1][0], (0.0, 0.95, 0.0))]
    for name, above, place in MAN[1:]:
        over = "下半身" if name.startswith("thigh") else movers[-1][0] if above == "hips" else names[above]
        joints.append((names[name], over, place))
    (character,) = recognise(rig_with(joints)).characters
    found = {bone: joints[node][0] for bone, node in character.bones.items()}
    assert found["hips"] == MOVERS[count - 1]
    assert (found["spine"], found["chest"]) == ("上半身", "上半身2")


def test_every_scheme_is_tried_and_those_of_nobody_last() -> None:
    titles = [scheme.title for scheme in schemes()]
    assert len(titles) == len(set(titles)) >= 16
    assert titles[-2:] == ["common words for bones", "common words for joints"]


def test_a_scheme_of_ones_own_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "studio.toml"
    path.write_text(
        'title = "Studio"\n[sides]\nUpperArm = "alpha"\nLowerArm = "beta"\nHand = "gamma"\n', "utf-8"
    )
    joints: list[Joint] = [
        ("alpha_L", "", (0, 0, 0)),
        ("beta_L", "alpha_L", (1, 0, 0)),
        ("gamma_L", "beta_L", (2, 0, 0)),
    ]
    assert bends(joints, recognise(rig_with(joints))) == {}
    assert bends(joints, recognise(rig_with(joints), scheme=[path])) == {"left arm": "alpha_L beta_L gamma_L"}
    monkeypatch.setenv("RIGTRI_SCHEMES", str(tmp_path))
    assert bends(joints, recognise(rig_with(joints))) == {"left arm": "alpha_L beta_L gamma_L"}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("title = 3 3", "this is not TOML: .*line 1"),
        ("title = " + "[" * 3000, "this is not TOML: "),
        ('[sides]\nHand = "h"', "'title' is missing"),
        ("title = 3", "'title' is a number: give a text"),
        ('title = "A"\nside = 1', "there is no 'side'. Did you mean 'sides'"),
        ('title = "A"\n[middle]\nWing = "w"', r"\[middle\] Wing: there is no such bone here. There are hips"),
        ('title = "A"\n[sides]\nUperArm = "h"', r"\[sides\] UperArm: .*Did you mean 'UpperArm'"),
        ('title = "A"\n[chains]\ntail = "t"', r"\[chains\] tail: .*There are arm, leg"),
        ('title = "A"\n[sides]\nHand = ["a"]', r"\[sides\] Hand is a list: give a text in quotes"),
        ('title = "A"\nsides = "a"', "'sides' is a text: make it a table"),
        ('title = "A"\n[sides]\nHand = "ok HandTop"', "no name can say 'HandTop': write 'handtop'"),
        ('title = "A"\n[sides]\nHand = "l_hand"', "no name can say 'l_hand': write 'hand'"),
        ('title = "A"\n[sides]\nHand = "joint"', "no name can say 'joint': sides and words like joint"),
        ('title = "A"\nmarks = "XX"', "'marks': no name can say 'XX': write 'xx'"),
        ('title = "A"\nlike = "unrael"', "no scheme 'unrael' to be like. Did you mean 'unreal'"),
        (
            'title = "A"\n[sides]\nUpperArm = "arm"\nLowerArm = "fore arm"',
            r"\[sides\] LowerArm: 'arm' means UpperArm already",
        ),
        ('like = 1\nbones = "b"', "'like' is a number.*; there is no 'bones'.*; 'title' is missing"),
    ],
)
def test_what_is_no_scheme_is_refused(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(text, "utf-8")
    with pytest.raises(FileError, match=words):
        own_scheme(path)


def test_all_schemes_that_are_none_are_reported_at_once(tmp_path: Path) -> None:
    words: list[str] = []
    for name, text in (("a", "title = 1"), ("b", "marks = 2"), ("c", "\ufefftitle = 'Fine'")):
        path = tmp_path / f"{name}.toml"
        path.write_text(text, "utf-8")
        words += ["--scheme", str(path)]
    result = cli("recognise", SAMPLES / "biped.glb", *words, code=3)
    assert "a.toml is not a naming scheme: 'title' is a number" in result.stderr
    assert "b.toml is not a naming scheme: 'marks' is a number" in result.stderr
    assert "c.toml" not in result.stderr


def test_rigtris_own_schemes_have_no_faults() -> None:
    folder = Path(rigtri.__file__).parent / "recognition" / "schemes"
    assert [own_scheme(path).title for path in (folder.parent / "languages.toml", *folder.glob("*.toml"))]


def test_tables_of_words_are_read_as_toml() -> None:
    tables = list((Path(rigtri.__file__).parent / "recognition").rglob("*.toml"))
    assert len(tables) > 20
    for path in tables:
        assert repr(our_table(path)) == repr(tomllib.loads(path.read_text("utf-8")))


def test_a_folder_of_schemes_that_is_not_there_is_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RIGTRI_SCHEMES", str(tmp_path / "gone"))
    result = cli("recognise", SAMPLES / "biped.glb", code=3)
    assert "RIGTRI_SCHEMES names" in result.stderr
    assert "gone, which is not a folder" in result.stderr


def test_a_name_is_read_whatever_stands_between_its_words() -> None:
    for name in ("LeftUpperArm", "left_upper_arm", "upper arm.L", "L_UpperArm", "upperArm.l", "leftupperarm"):
        assert (parse_name(name).side, parse_name(name).key) == ("left", "upperarm"), name


def test_a_rig_is_looked_at_once_and_what_is_known_goes_with_it() -> None:
    rig = rig_with(MAN)
    assert recognise(rig) is recognise(rig)
    assert len(sure_limbs(rig)) == 4
    gone = ref(rig)
    del rig
    assert gone() is None


def test_the_command_reports_chains_roles_and_words() -> None:
    told = cli("recognise", SAMPLES / "biped.glb").output
    assert "biped, 0.99 sure" in told
    assert "faces +z, up +y, left +x" in told
    assert "upper_arm_L → forearm_L → hand_L" in told
    assert "end: head_end" in told
    told = cli("recognise", SAMPLES / "biped.glb", "--joints").output
    assert "leftUpperArm" in told


def test_chains_of_more_than_four_joints_are_shown_by_their_ends() -> None:
    assert "tail_01 → tail_02 → … → tail_08" in cli("recognise", SAMPLES / "tail.glb", code=0).stdout
    rig = read(SAMPLES / "tail.glb").rig
    layout = recognise(rig)
    (tail,) = layout.characters[0].chains
    four = replace(layout.characters[0], chains=(replace(tail, joints=tail.joints[:4]),))
    printed = layout_output.text(rig, replace(layout, characters=(four,)))
    assert "tail_01 → tail_02 → tail_03 → tail_04 " in printed


@pytest.mark.parametrize("name", ["biped.glb", "hand.glb", "flat_ik.glb", "biped.usda"])
def test_json_is_as_its_schema_requires(name: str) -> None:
    run = cli("recognise", SAMPLES / name, "--json", code=0)
    validator("recognise").validate(json.loads(run.stdout))


def test_a_scheme_that_cannot_be_read_is_reported_in_one_line(tmp_path: Path) -> None:
    run = cli("recognise", SAMPLES / "biped.glb", "--scheme", tmp_path / "no.toml", code=3)
    assert "is not a naming scheme" in run.output
    (tmp_path / "long.toml").write_text(f"title = {'9' * 4400}")
    run = cli("recognise", SAMPLES / "biped.glb", "--scheme", tmp_path / "long.toml", code=3)
    assert "is not a naming scheme: this is not TOML" in run.output


# By hand: arms and legs that the shape alone shows in real files whose names are taken away.
NAMELESS = {"gdquest_mannequiny-0.3.0.glb": 4, "raylib_robot.glb": 4, "mayausd_HIK_Export.usda": 4}


@pytest.mark.parametrize("name", NAMELESS)
def test_real_characters_without_names_are_recognised_as_with_them(name: str, assets: Path) -> None:
    (path,) = (path for path in asset_files() if path.name == name)
    rig = read(path).rig
    with_names = {(limb.kind, limb.side, limb.triple) for limb in limbs(rig)}
    without = limbs(replace(rig, names=("",) * len(rig), humanoid={}))
    assert {(limb.kind, limb.side, limb.triple) for limb in without} == with_names
    assert len(without) == NAMELESS[name]


@pytest.mark.parametrize("named", [True, False])
def test_bodies_that_one_skin_moves_are_several_where_each_has_limbs_of_its_own(named: bool) -> None:
    """Before, a man and another's legs beside him were one creature, with a plane between both of them."""
    legs = [*TRUNK[:1], *both(LEG)]
    beside = [(f"{name}.001", f"{above}.001", (x + 2.0, y, z)) for name, above, (x, y, z) in legs]
    layout = recognise(rig_with([*MAN, *beside], named=named))
    assert [len(character.parts) for character in layout.characters] == [len(MAN), len(beside)]
    assert len([chain for chain in layout.characters[0].limbs if chain.is_sure]) == 4


def test_hands_that_hang_at_nothing_are_of_the_body_whose_skin_they_have() -> None:
    """Their fingers are in pairs, too, and the planes of those lie elsewhere than the body's."""
    floating: list[Joint] = [("hand.L", "", (0.7, 1.45, 0.0)), ("hand.R", "", (-0.7, 1.45, 0.0)), *FINGERS]
    assert len(recognise(rig_with([*TRUNK, *both(LEG), *floating])).characters) == 1


@pytest.mark.parametrize("rests", ["as bound", "in a line"])
def test_a_body_that_rests_in_a_line_is_seen_in_its_bind_pose(rests: str) -> None:
    rig = rig_with(MAN, named=False)
    if rests == "in a line":
        sizes = np.linalg.norm(rig.translation, axis=1)
        rig = replace(rig, translation=sizes[:, np.newaxis] * [0.0, 1.0, 0.0])
    (character,) = recognise(rig).characters
    assert character.pose == ("rest" if rests == "as bound" else "bind")
    limbs = {(chain.kind, chain.side): chain.bend for chain in character.limbs}
    row = {name: k for k, (name, _, _) in enumerate(MAN)}
    assert limbs["leg", "left"] == tuple(row[name] for name in ("thigh.L", "shin.L", "foot.L"))
    assert limbs["arm", "right"] == tuple(row[name] for name in ("upper_arm.R", "forearm.R", "hand.R"))


@pytest.mark.parametrize(("more", "left_out"), [(0, False), (1, False), (2, True)])
def test_joints_at_the_origin_are_nobodys_where_they_are_less_than_half(more: int, left_out: bool) -> None:
    placed: list[Joint] = [(name, "", (float(k), 1.0, 0.0)) for k, name in enumerate("abc", 1)]
    lost: list[Joint] = [(f"{above}_end", above, (0.0, 0.0, 0.0)) for above in "abc"]
    others: list[Joint] = [(f"d{k}", "a", (1.0, 2.0 + k, 0.0)) for k in range(more)]
    kept = joints_of(rig_with([*placed, *lost, *others]))
    assert (not {3, 4, 5} & {*kept}) == left_out
    assert {0, 1, 2} <= {*kept}
