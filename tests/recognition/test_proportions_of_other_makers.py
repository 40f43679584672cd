"""Proportions, poses and names as games and robots have them: what of these is sure, and what is not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import ARM, HORSE, LEG, MAN, TRUNK, Joint, both, line, rig_with, without

from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.recognition.layout import Character
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.recognise import recognise


def sure(joints: list[Joint], *, named: bool = True) -> dict[str, str]:
    """The three joints of each limb that is sure, by the name of the limb."""
    (found,) = recognise(rig_with(joints, named=named)).characters
    return _sure(found, joints)


def _sure(found: Character, joints: list[Joint]) -> dict[str, str]:
    names = [name for name, _, _ in joints]
    return {k.name: " ".join(names[j] for j in k.bend) for k in found.limbs if k.is_sure}


def test_a_doll_of_two_joints_a_limb_whose_hips_are_one_place_is_read() -> None:
    """Before, it ended in an IndexError."""
    halves = [("Shoulder.L", "Body", (0.1, 0.45, 0)), ("Arm.L", "Shoulder.L", (0.2, 0.45, 0))]
    halves += [("Hip.L", "Body", (0, 0, 0)), ("Leg.L", "Hip.L", (0.1, 0, 0))]
    doll: list[Joint] = [("Body", "", (0, 0, 0)), ("Head", "Body", (0, 0.5, 0)), *both(halves)]
    assert sure(doll) == {}


def test_arms_that_go_straight_apart_tell_nothing_of_up() -> None:
    """What they go together is noise; before, legs of a robot were its arms, and up was behind it."""
    arm = line(
        "a1.L a2.L a3.L a4.L",
        "",
        (0.106, 0.919, 0),
        (0.153, 0.919, 0),
        (0.214, 0.919, 0),
        (0.361, 0.919, 1e-9),
    )
    places = [(0.106, 0.584), (0.106, 0.564), (0.106, 0.483), (0.106, 0.349), (0.106, 0.069)]
    leg = line(
        "l1.L l2.L l3.L l4.L l5.L", "waist", *((x, y, 0.013 * (k > 2)) for k, (x, y) in enumerate(places))
    )
    robot: list[Joint] = [("trunk", "", (0, 0.7, -0.06)), ("waist", "trunk", (0, 0.584, 0))]
    robot += line("h1 h2", "trunk", (0, 0.943, 0), (0, 1.005, 0))
    robot += [(name, above or "trunk", place) for name, above, place in both([*arm, *leg])]
    (found,) = recognise(rig_with(robot)).characters
    assert found.up == (0.0, 1.0, 0.0)
    assert {k.name for k in found.limbs if k.joints[0] in {*range(4, 8), *range(13, 17)}} == {
        "left arm",
        "right arm",
    }


def test_a_horse_whose_legs_slant_stands_on_the_ground_of_a_file_with_another_up() -> None:
    """Up was as its legs slant, so that its front feet were in the air, and it might have had arms."""
    slanted = [
        (name, over, (x, -(z + (0.22 * (1.0 - y) if "." in name else 0.0)), y))
        for name, over, (x, y, z) in HORSE
    ]
    (found,) = recognise(rig_with(slanted, named=False)).characters
    assert found.up == (0.0, 0.0, 1.0)
    assert len(_sure(found, slanted)) == 4


def test_a_long_hand_that_is_the_last_bone_makes_no_elbow_a_twist_joint() -> None:
    hands = [
        (f"tip{name[4:]}", name, (x * 1.25, y, z)) for name, _, (x, y, z) in MAN if name.startswith("hand")
    ]
    straight = [(name, over, (x, y, 0.0 if over.startswith("upper") else z)) for name, over, (x, y, z) in MAN]
    assert sure([*straight, *hands], named=False)["left arm"] == "upper_arm.L forearm.L hand.L"


def test_half_of_a_lower_arm_after_an_upper_arm_in_halves_is_no_hand() -> None:
    arm = line(
        "clavicle.L a.L b.L c.L d.L",
        "chest",
        (0.04, 1.45, 0),
        *((x, 1.45, 0) for x in (0.16, 0.3, 0.44, 0.56)),
    )
    assert not sure([*TRUNK, *both([*arm, *LEG])], named=False).keys() & {"left arm", "right arm"}


def test_either_reading_of_a_leg_with_a_hock_agrees_with_its_names() -> None:
    """Named by the hip and knee where its shape alone chooses knee and hock."""
    places = {"thigh": (0.66, -0.36), "shin": (0.51, -0.4), "foot": (0.27, -0.54), "toe": (0.06, -0.52)}
    places |= {
        "clavicle": (0.72, 0.22),
        "upper_arm": (0.66, 0.24),
        "forearm": (0.48, 0.17),
        "hand": (0.29, 0.23),
    }
    places |= {"finger": (0.07, 0.25), "pelvis": (0.7, -0.34), "spine1": (0.74, -0.1), "spine2": (0.75, 0.05)}
    places |= {"chest": (0.75, 0.2), "neck": (0.8, 0.35), "head": (0.82, 0.5)}
    cat: list[Joint] = []
    for name, over, (x, y, z) in HORSE:
        y, z = places.get(name.partition(".")[0], (y, z))
        cat.append((name, over, (0.0 if name.startswith("thigh") else x, y, z)))
    found = sure(cat)
    assert found["left hind leg"] == "thigh.L shin.L foot.L"
    assert found["right hind leg"] == "thigh.R shin.R foot.R"


def _offset(ahead: float, *, toes: bool = False) -> list[Joint]:
    """A robot whose knees are beside the line from hip to ankle by 9°, towards the back of where it faces."""
    body = [*TRUNK, *both([*ARM, *LEG])]
    offsets = {"shin": -0.025, "foot": 0.015}
    return [
        (name, above, (x, y, ahead * (offsets.get(name[:-2], 0.0) if name[:-2] in offsets else z)))
        for name, above, (x, y, z) in body
        if toes or not name.startswith("toe")
    ]


@pytest.mark.parametrize("front", [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), None])
@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_knees_that_are_set_off_by_a_few_degrees_tell_no_facing_alone(
    ahead: float, front: tuple[float, float, float] | None
) -> None:
    """Noise is not mirrored, but the joints of robots are; what a format says of front is no evidence."""
    rig = rig_with(_offset(ahead), named=False)
    (found,) = recognise(replace(rig, rules=replace(rig.rules, facing=front))).characters
    assert not any(limb.is_sure for limb in found.limbs)


def test_feet_that_point_ahead_are_sure_whatever_small_bends_say() -> None:
    found = recognise(rig_with(_offset(1.0, toes=True), named=False)).characters[0]
    assert found.facing[2] > 0.99


def test_legs_that_slant_under_a_trunk_that_falls_to_the_front_are_legs() -> None:
    """They go the way of the trunk, as nothing of a body on two does; before, they were not sure."""
    falling: list[Joint] = []
    for name, over, (x, y, z) in HORSE:
        low = name.startswith(("clavicle", "upper_arm"))
        back = name.startswith(("thigh", "shin", "foot", "toe"))
        falling.append((name, over, (x, y - 0.4 * low, z + back * 0.5 * (1.0 - y))))
    (found,) = recognise(rig_with(falling, named=False)).characters
    assert found.form == "quadruped"
    assert {"left hind leg", "right hind leg"} <= _sure(found, falling).keys()


def test_lleg_at_a_corner_is_a_lower_leg_of_the_side_that_the_corner_says() -> None:
    """Of the right side, too; before, ``fr_lleg`` said left."""
    robot: list[Joint] = [("body", "", (0, 0.5, 0))]
    for corner, x, z in (("fl", 1, 0.3), ("fr", -1, 0.3), ("hl", 1, -0.3), ("hr", -1, -0.3)):
        places = [(0.05, 0.5, 0.0), (0.16, 0.5, 0.0), (0.16, 0.27, -0.2), (0.16, 0.0, 0.0)]
        words = f"{corner}_hip {corner}_uleg {corner}_lleg {corner.upper()}_foot"
        robot += line(words, "body", *((x * a, b, z + c) for a, b, c in places))
    found = sure(robot)
    assert found["right front leg"] == "fr_uleg fr_lleg FR_foot"
    assert found["left hind leg"] == "hl_uleg hl_lleg HL_foot"
    assert sure([joint for joint in robot if "foot" not in joint[0]]) == {}


@pytest.mark.parametrize(
    ("word", "level"),
    [("l_sho_pitch", "upper"), ("arml_elb1", "lower"), ("armr_wri2", "end"), ("l_ank_roll", "end")],
)
def test_robots_short_words_are_those_of_joints(word: str, level: str) -> None:
    assert limb_words(word).levels[level] == 1.0


def test_an_animal_without_head_and_tail_has_no_sure_front() -> None:
    """As of the furthest details of a game; before, what the skeleton hung from was its hind end."""
    headless = [
        joint for joint in HORSE if joint[0] not in ("neck", "head", "muzzle", "tail1", "tail2", "tail3")
    ]
    assert sure(headless, named=False) == {}


def test_what_is_ahead_of_legs_is_measured_along_the_ground() -> None:
    """Where front legs begin lower than hind ones, the line between them falls, and a high head is behind."""
    fallen = {"neck": (1.65, 0.95), "head": (1.75, 1.05), "muzzle": (1.75, 1.1), "tail1": (1.4, -1.2)}
    sheep: list[Joint] = []
    for name, over, (x, y, z) in HORSE:
        y, z = fallen.get(name, (y, z))
        y -= 0.55 * name.startswith(("clavicle", "upper_arm")) + 0.25 * name.startswith("forearm")
        if name not in ("tail2", "tail3"):
            sheep.append((name, over, (x, y, z)))
    (found,) = recognise(rig_with(sheep, named=False)).characters
    assert found.facing[2] > 0.9


def test_a_shin_whose_end_moves_a_whole_further_bone_ends_no_leg() -> None:
    """Joints that a game leaves out far away: their skin moves with the joint before."""
    short = without(MAN, "foot", "toe")
    middles = both([("half.L", "thigh.L", (0.1, 0.73, 0.0))])
    short = [(name, f"half{name[4:]}" if name.startswith("shin") else over, at) for name, over, at in short]
    joints = [*(k for k in short if "shin" not in k[0]), *middles, *(k for k in short if "shin" in k[0])]
    rig, names = rig_with(joints, named=False), [name for name, _, _ in joints]
    ends = np.array([[names.index(name)] for name in ("shin.L", "shin.R")])
    feet = rig.world[ends.repeat(2), 3, :3] * [1.0, 0.0, 1.0] + [[0.0, 0.0, -0.06], [0.0, 0.0, 0.2]] * 2
    mesh = Mesh("feet", -1, feet, 0, ends.repeat(2, axis=0), np.ones((4, 1)))
    layout = recognise(replace(rig, content=Content(read_outlines=lambda: [mesh])))
    assert not any(limb.is_sure and limb.kind == "leg" for each in layout.characters for limb in each.limbs)


def test_legs_that_begin_all_but_in_the_middle_may_begin_a_joint_later() -> None:
    """Noise sets apart what begins in one place."""
    hips = both([("hip.L", "pelvis", (0.03, 1.4, -0.62))])
    legs = [(name, f"hip{name[5:]}" if "thigh" in name else over, place) for name, over, place in HORSE]
    first = [joint for joint in legs if joint[0] == "pelvis"]
    rest = [joint for joint in legs if not joint[0].startswith(("pelvis", "foot", "toe"))]
    found = sure([*first, *hips, *rest], named=False)
    assert not {"left hind leg", "right hind leg"} & found.keys()


def _axles(name: str, place: tuple[float, float, float], *offsets: tuple[float, float, float]) -> list[Joint]:
    """Joints of a robot that make one: an axle for each of its axes, set off from the one before."""
    axes = ["pitch", "roll", "yaw"]
    places = [place]
    for far in offsets:
        x, y, z = (a + b for a, b in zip(places[-1], far, strict=True))
        places.append((x, y, z))
    return [(f"{name}_{axis}.L", "", at) for axis, at in zip(axes, places, strict=False)]


def _chain(over: str, *joints: list[Joint]) -> list[Joint]:
    """Joints one below the other, the first below ``over``."""
    flat = [joint for each in joints for joint in each]
    above = [over, *(name for name, _, _ in flat)]
    return [(name, at, place) for (name, _, place), at in zip(flat, above, strict=False)]


HIP = _axles("hip", (0.09, 1.0, 0.0), (0.0, -0.03, -0.05), (0.0, -0.02, 0.06))
SHOULDER = _axles("shoulder", (0.12, 1.45, 0.0), (0.06, -0.02, 0.04))


def test_roll_is_an_axis_where_joints_have_the_names_of_axes() -> None:
    """Elsewhere it is a twist joint; before, knees and elbows that roll were passed over, surely."""
    arm = _chain(
        "chest", SHOULDER, [("elbow_roll.L", "", (0.45, 1.43, 0.03)), ("hand.L", "", (0.7, 1.43, 0))]
    )
    leg = _chain("hips", HIP, [("knee_roll.L", "", (0.09, 0.52, 0.0)), ("ankle_pitch.L", "", (0.09, 0.1, 0))])
    found = sure([*TRUNK, *both([*arm, *leg])])
    assert found["right leg"].split()[1:] == ["knee_roll.R", "ankle_pitch.R"]
    assert found["left arm"] == "shoulder_roll.L elbow_roll.L hand.L"


def test_axes_of_one_joint_are_no_two_joints_of_a_limb() -> None:
    """However long the bones between them are; before, hips, knees and ankles lost to these."""
    hip = _axles("hip", (0.064, 0.69, 0.0), (0.052, -0.03, 0.0), (0.0, -0.118, 0.046))
    ankle = _axles("ankle", (0.119, 0.054, 0.0), (0.0, -0.018, 0.0))
    leg = _chain("hips", hip, [("knee.L", "", (0.119, 0.354, 0.0))], ankle)
    trunk: list[Joint] = [
        ("hips", "", (0, 0.75, 0)),
        ("chest", "hips", (0, 0.9, 0)),
        ("head", "chest", (0, 1.2, 0)),
    ]
    arm = line("shoulder.L elbow.L wrist.L", "chest", (0.1, 1.08, 0), (0.15, 0.9, 0.016), (0.15, 0.75, 0.1))
    assert sure([*trunk, *both([*leg, *arm])])["left leg"] == "hip_roll.L knee.L ankle_pitch.L"


def test_an_arm_starts_and_ends_at_no_axis_within_its_bones() -> None:
    """Robots' shoulders yaw in the upper arm, and wrists in the forearm: before, a limb went from there."""
    yaw = _axles("shoulder", (0.13, 1.45, 0.0), (0.02, 0.0, 0.0), (0.0, -0.07, 0.0))
    wrist: list[Joint] = [("wrist_yaw.L", "", (0.155, 1.2, 0.05)), ("wrist_pitch.L", "", (0.155, 1.13, 0.1))]
    arm = _chain("chest", yaw, [("elbow.L", "", (0.155, 1.27, 0.0))], wrist)
    grip = line("gripper_1.L", "wrist_pitch.L", (0.155, 1.05, 0.12))
    found = sure([*TRUNK, *both([*LEG, *arm, *grip])])
    assert found["left arm"] == "shoulder_roll.L elbow.L wrist_pitch.L"


def test_axles_of_shoulders_and_ankles_turn_no_robot_round() -> None:
    """An axle behind the ankle is no toe, and one beside the shoulder no elbow; before, both were."""
    elbow: list[Joint] = [("elbow.L", "", (0.25, 1.15, 0.04))]
    ankle = _axles("ankle", (0.09, 0.1, 0.0), (-0.06, 0.0, -0.1))
    leg = _chain("hips", HIP[:1], [("knee.L", "", (0.09, 0.55, 0.0))], ankle)
    assert sure([*TRUNK, *both([*_chain("chest", SHOULDER, elbow), *leg])], named=False) == {}


def test_an_elbow_of_two_axles_ends_no_arm() -> None:
    """The first of three bones that are as long as each other may be a clavicle, whatever stands between."""
    places = ((0.1, 1.45, 0), (0.38, 1.45, 0), (0.42, 1.05, -0.03), (0.42, 1.05, -0.031), (0.45, 0.75, 0))
    two = line("a.L b.L c.L d.L e.L", "chest", *places)
    found = sure([*TRUNK, *both([*two, *LEG])], named=False)
    assert "left leg" in found
    assert "left arm" not in found


def test_legs_of_clear_names_are_no_arms_however_vague_the_arms_are() -> None:
    """The shank is a lower leg, as robots have it; before, such a leg was not sure."""
    heights = zip(
        (0.584, 0.564, 0.483, 0.349, 0.069, 0.057), (0.06, 0.06, 0.06, 0.05, 0.05, 0.05), strict=True
    )
    names = "Hip_Pitch.L Hip_Roll.L Hip_Yaw.L Shank.L Ankle_Cross.L foot.L"
    leg = line(names, "Waist", *((0.106, y, z) for y, z in heights))
    arm = line("AL1.L AL2.L AL3.L hand.L", "Trunk", *((x, 0.919, 0.06) for x in (0.106, 0.153, 0.214, 0.361)))
    trunk = line("Trunk Waist", "", (0, 0.7, 0), (0, 0.584, 0.06))
    head = line("H1 H2", "Trunk", (0, 0.943, 0.06), (0, 1.005, 0.06))
    found = sure([*trunk, *head, *both([*arm, *leg])])
    assert found["left leg"].split()[1:] == ["Shank.L", "Ankle_Cross.L"]
