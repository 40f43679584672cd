"""Where the last joint of a chain aims: heads whatever hangs at them, and fingers and toes at their ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from places import one_in
from posed_bodies import NAMES, Pose, bent, posed_body
from recognition_bodies.skeletons import HORSE, MAN, Joint, both, line, rig_with

from rigtri import orient_joints
from rigtri.frames.reframe import reframe
from rigtri.maths.quaternions import unit
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise, unit_of
from rigtri.model.rig import Rig
from rigtri.recognition.recognise import recognise
from rigtri.report import Report


def aim(rig: Rig, node: int) -> Floats:
    """Where x of a joint points."""
    return np.asarray(normalise(rig.world[node, 0, :3]))


@pytest.mark.ci
@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize("ends", [False, True])
def test_a_head_aims_alike_with_and_without_a_face(names: str, ends: bool) -> None:
    """Eyes and jaw are in front of the skull: their average would tilt the head by 45°."""
    plain, face = (posed_body(Pose(names, face=face, ends=ends)) for face in (False, True))
    heads = [aim(orient_joints(body.rig), body.parts["head"]) for body in (plain, face)]
    np.testing.assert_allclose(heads[1], heads[0], atol=1e-6)
    np.testing.assert_allclose(heads[1], (0, 1, 0), atol=1e-6)


@pytest.mark.parametrize("names", NAMES)
def test_the_face_keeps_its_axes(names: str) -> None:
    body = posed_body(Pose(names, face=True))
    out = orient_joints(body.rig)
    for part in ("jaw", "left eye", "right eye"):
        np.testing.assert_allclose(out.world[body.parts[part]], body.rig.world[body.parts[part]], atol=1e-9)


@pytest.mark.ci
@pytest.mark.parametrize(
    "pose",
    [
        Pose(toes=False),
        Pose("unreal", toes=False, knee=25.0, yaw=90.0, unit=0.01),
        Pose("blender", toes=False, stride=20.0, flip=True),
    ],
)
def test_a_foot_without_toes_points_ahead_and_bends_as_one_with_toes(pose: Pose) -> None:
    """The lower leg points down, and its hinge is the knee's: a foot with its axes would be another joint."""
    body, report = posed_body(pose), Report()
    facing = recognise(body.rig).characters[0].facing
    out = orient_joints(body.rig, report=report)
    rules = {entry["joint"]: entry["aim"] for entry in report.joints}
    for side in ("left", "right"):
        foot = body.parts[f"{side} foot"]
        np.testing.assert_allclose(aim(out, foot), facing, atol=1e-6)
        hinge = out.world[foot, 1, :3] / np.linalg.norm(out.world[foot, 1, :3])
        assert abs(hinge @ body.hinges[foot]) > 0.999
        assert hinge @ body.hinges[foot] * np.linalg.det(out.world[foot, :3, :3]) > 0
        assert rules[out.names[foot]] == "facing"
    again = orient_joints(out)
    np.testing.assert_array_equal(again.rotation, out.rotation)
    copied = orient_joints(body.rig, end="parent")
    np.testing.assert_allclose(
        aim(copied, body.parts["left foot"]), aim(copied, body.parts["left lower leg"]), atol=1e-6
    )


def test_a_head_whose_neck_stands_elsewhere_goes_on_as_the_trunk() -> None:
    body = posed_body(Pose())
    world = body.rig.world
    # The neck above and ahead of the head: the way from it to the head goes down and back.
    place = np.append(world[body.parts["head"], 3, :3] + (0.0, 0.05, 0.2), 1.0)
    moved = place @ np.linalg.inv(world[body.rig.parents[body.parts["neck"]]])
    translation = body.rig.translation.copy()
    translation[body.parts["neck"]] = moved[:3]
    rig = replace(body.rig, translation=translation, skins=())
    back = np.append(world[body.parts["head"], 3, :3], 1.0) @ np.linalg.inv(rig.world[body.parts["neck"]])
    translation = translation.copy()
    translation[body.parts["head"]] = back[:3]
    rig = replace(rig, translation=translation, skins=body.rig.skins)
    out = orient_joints(rig, pose="nodes")
    assert aim(out, body.parts["head"])[1] > 0.9


def test_a_rule_for_branches_that_the_user_names_is_for_heads_too() -> None:
    body = posed_body(Pose(face=True))
    assert aim(orient_joints(body.rig, branch="average"), body.parts["head"])[1] < 0.9


@pytest.mark.parametrize("curl", [5.0, 50.0, 70.0])
@pytest.mark.parametrize("names", one_in(2, ["mixamo", "unreal", "blender", "none"]))
def test_the_last_joint_aims_at_the_one_that_says_where_it_ends(names: str, curl: float) -> None:
    """Such joints have no weight; they are neither sockets nor parts of the chain."""
    body = posed_body(Pose(names, curl=curl, ends=True))
    out = orient_joints(body.rig)
    at = body.rig.world[:, 3, :3]
    fingers = [f"{side} {finger}" for side in ("left", "right") for finger in ("index", "little")]
    ends = {f"{finger} 3": f"{finger} 4" for finger in fingers}
    for last, end in (ends | {"left toes": "left toes end", "head": "head end"}).items():
        bone = at[body.parts[end]] - at[body.parts[last]]
        np.testing.assert_allclose(aim(out, body.parts[last]), bone / np.linalg.norm(bone), atol=1e-5)
        np.testing.assert_allclose(out.world[body.parts[end]], body.rig.world[body.parts[end]], atol=1e-9)


def test_a_toe_aims_at_its_end_however_a_nameless_foot_slopes() -> None:
    body = posed_body(Pose("none", ends=True))
    toes, end = body.parts["left toes"], body.parts["left toes end"]
    rig = bent(body.rig, f"#{toes}", np.array([1.0, 0.0, 0.0]), -25.0)
    bone = rig.world[end, 3, :3] - rig.world[toes, 3, :3]
    np.testing.assert_allclose(aim(orient_joints(rig), toes), bone / np.linalg.norm(bone), atol=1e-5)


def test_the_head_of_a_numbered_spine_is_its_last_joint() -> None:
    """Rigify numbers spine, neck and head throughout; a longer neck shifts the number of the head."""
    body = posed_body(Pose("blender"))
    called = {"hips": "DEF-spine", "head": "DEF-spine.007"}
    called |= {part: f"DEF-spine.{k:03}" for k, part in enumerate(("spine", "chest", "upper chest"), 1)}
    names = [f"DEF-{name}" if name and name != "Armature" else name for name in body.rig.names]
    for part, name in called.items():
        names[body.parts[part]] = name
    names[body.parts["neck"]] = "DEF-spine.006"
    (character,) = recognise(replace(body.rig, names=tuple(names))).characters
    assert character.bones["head"] == body.parts["head"]


def beside(parent: str, twist: str, share: float, joints: Sequence[Joint]) -> list[Joint]:
    """A joint below another, so far along the bone to its first child."""
    at = {name: np.array(place) for name, _, place in joints}
    child = next(name for name, above, _ in joints if above == parent)
    x, y, z = at[parent] + share * (at[child] - at[parent])
    return [*joints, (twist, parent, (float(x), float(y), float(z)))]


HANDLESS = [joint for joint in MAN if not joint[0].startswith("toe")]
# Without names knees alone tell where a body faces: from 30° on.
CROUCHING = [(n, over, (x, y, z + 0.2 * n.startswith("shin"))) for n, over, (x, y, z) in HANDLESS]


@pytest.mark.parametrize(
    ("named", "call"),
    [(True, "{bone}_twist.{side}"), (True, "{bone}_helper.{side}"), (False, "{bone} {side}")],
)
def test_what_stands_beside_hands_and_feet_says_nothing_of_their_axes(named: bool, call: str) -> None:
    plain = joints = HANDLESS if named else CROUCHING
    for side in "LR":
        for bone, share in (("forearm", 0.5), ("shin", 0.6)):
            joints = beside(f"{bone}.{side}", call.format(bone=bone, side=side), share, joints)
    index = {name: k for k, (name, _, _) in enumerate(joints)}
    axes = []
    for some in (plain, joints):
        rig = rig_with(some, named=named)
        rotation = unit(np.random.default_rng(3).normal(size=(len(joints), 4)))[: len(some)]
        axes.append(normalise(orient_joints(reframe(rig, rotation)).world[: len(HANDLESS), :3, :3]))
    for end in ("hand.L", "hand.R", "foot.L", "foot.R"):
        np.testing.assert_allclose(axes[1][index[end]], axes[0][index[end]], atol=1e-6)
    np.testing.assert_allclose(axes[1][[index["foot.L"], index["foot.R"]], 0], [(0, 0, 1)] * 2, atol=1e-6)


@pytest.mark.parametrize("moving", [True, False], ids=["with points of its own", "without"])
def test_a_heel_is_no_toe_and_a_weapon_no_finger(moving: bool) -> None:
    joints = [*HANDLESS]
    for side in "LR":
        for name, end, dy, dz in (("heel", "foot", -0.06, -0.05), ("weapon", "hand", -0.05, 0.1)):
            x, y, z = next(place for joint, _, place in joints if joint == f"{end}.{side}")
            joints.append((f"{name}.{side}", f"{end}.{side}", (x, y + dy, z + dz)))
    rig = rig_with(joints)
    weighted = np.array([moving or not name.startswith(("heel", "weapon")) for name in rig.names])
    out = orient_joints(replace(rig, skins=(replace(rig.skins[0], weigh=lambda: weighted),)))
    for side in "LR":
        node = {name: rig.names.index(f"{name}.{side}") for name in ("hand", "forearm", "foot")}
        np.testing.assert_allclose(aim(out, node["foot"]), (0, 0, 1), atol=1e-6)
        np.testing.assert_allclose(aim(out, node["hand"]), aim(out, node["forearm"]), atol=1e-6)


HORSE_TRUNK = [joint for joint in HORSE if not joint[0].endswith((".L", ".R"))]
BLADED = [
    *HORSE_TRUNK,
    *both([("blade.L", "chest", (0.1, 1.5, 0.5))]),
    *(
        (name, f"blade.{name[-1]}" if name.startswith("upper_arm") else above, at)
        for name, above, at in HORSE[len(HORSE_TRUNK) :]
    ),
]


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize(
    ("body", "lead", "named"), [(MAN, "clavicle", True), (MAN, "clavicle", False), (BLADED, "blade", True)]
)
def test_what_leads_to_a_limb_aims_at_it_whatever_else_hangs_there(
    body: Sequence[Joint], lead: str, named: bool, count: int
) -> None:
    """Before, a clavicle with armour or correctives of its own went on as the spine: 70° off the arm."""
    x, y, z = next(place for name, _, place in body if name == f"{lead}.L")
    worn = [(x + 0.06, y + 0.06, z), (x + 0.05, y - 0.12, z + 0.1), (x + 0.02, y + 0.03, z - 0.05)][:count]
    more = both((f"armour_{k}.L", f"{lead}.L", at) for k, at in enumerate(worn))
    plain, dressed = (orient_joints(rig_with(each, named=named)) for each in (body, [*body, *more]))
    for row in (k for k, (name, _, _) in enumerate(body) if name.startswith(lead)):
        np.testing.assert_allclose(dressed.world[row, :3, :3], plain.world[row, :3, :3], atol=1e-6)


@pytest.mark.parametrize("word", ["clavicle", "clav", "shoulder"])
@pytest.mark.parametrize("above", ["chest", "hips"])
def test_a_clavicle_beside_its_arm_aims_at_it(word: str, above: str) -> None:
    """The deform bones of Rigify, exported alone, have them so. Before, they kept their axes in silence."""
    body = [
        (name.replace("clavicle", word), above if name.startswith("upper_arm") else over, at)
        for name, over, at in MAN
    ]
    plain, beside = (orient_joints(rig_with(each)) for each in (MAN, body))
    assert {part.bone for part in recognise(beside).characters[0].parts} >= {"leftShoulder", "rightShoulder"}
    rows = [k for k, (name, _, _) in enumerate(MAN) if name.startswith("clavicle")]
    np.testing.assert_allclose(beside.world[rows, :3, :3], plain.world[rows, :3, :3], atol=1e-6)


def test_a_ball_with_five_toes_aims_at_the_midmost() -> None:
    """Where names do not say which joint the ball is. Before, at the big toe: 45° inwards."""
    ball = next(at for name, _, at in MAN if name == "toe.L")
    row = [(ball[0] + 0.02 * (k - 2), ball[1], ball[2] + 0.07 - 0.008 * k) for k in range(5)]
    body = [*MAN, *both((f"digit_{k}.L", "toe.L", at) for k, at in enumerate(row))]
    rig, names = orient_joints(rig_with(body, named=False)), [name for name, _, _ in body]
    at, toe = (rig.world[names.index(name)] for name in ("toe.L", "digit_2.L"))
    np.testing.assert_allclose(at[0, :3], unit_of(toe[3, :3] - at[3, :3]), atol=1e-6)


EAR, JAW = ("ear.L", "head", (0.1, 2.35, 1.15)), ("jaw", "head", (0.0, 2.1, 1.3))
END, CREST = ("head_end", "head", (0.0, 2.1, 1.65)), ("crest_end", "head", (0.0, 2.6, 1.4))
JAW_END, EAR_END = ("jaw_end", "head", (0.0, 1.95, 1.5)), ("ear_end.L", "head", (0.15, 2.5, 1.1))


@pytest.mark.parametrize(
    ("more", "muzzle", "aims_at"),
    [
        ([END], False, "head_end"),
        ([EAR, JAW], True, "muzzle"),
        ([EAR, JAW, END, CREST, JAW_END, EAR_END], True, "head_end"),
        ([EAR, JAW, JAW_END, EAR_END], False, ""),
        ([], False, ""),
    ],
)
def test_a_head_on_four_legs_aims_at_its_own_end_or_its_nose_and_else_goes_on_as_the_neck(
    more: Sequence[Joint], muzzle: bool, aims_at: str
) -> None:
    joints = [joint for joint in HORSE if muzzle or joint[0] != "muzzle"] + list(more)
    rig = rig_with(joints)
    weighted = np.array([not name.startswith(("head_end", "crest", "jaw_", "ear_")) for name in rig.names])
    out = orient_joints(replace(rig, skins=(replace(rig.skins[0], weigh=lambda: weighted),)))
    at, head = rig.world[:, 3, :3], rig.names.index("head")
    start, end = (head, rig.names.index(aims_at)) if aims_at else (rig.names.index("neck"), head)
    np.testing.assert_allclose(aim(out, head), normalise(at[end] - at[start]), atol=1e-6)
    for name in {"ear.L", "jaw"} & set(rig.names):
        node = rig.names.index(name)
        np.testing.assert_allclose(out.world[node], rig.world[node], atol=1e-9)


@pytest.mark.parametrize("arms", [False, True])
def test_a_head_above_six_legs_aims_at_its_nose_and_that_of_a_centaur_goes_on_as_the_neck(arms: bool) -> None:
    called = {} if arms else {"upper_arm": "front_thigh", "forearm": "front_shin", "hand": "front_foot"}

    def name(joint: str) -> str:
        bone, dot, side = joint.partition(".")
        return called.get(bone, bone) + dot + side

    middle = line(
        "mid_thigh.L mid_shin.L mid_foot.L mid_toe.L",
        "spine2",
        *[(0.2, y, z) for y, z in ((1.2, 0.1), (0.85, 0.2), (0.42, 0.0), (0.05, 0.1))],
    )
    rig = rig_with([(name(joint), name(above), at) for joint, above, at in [*HORSE, *both(middle)]])
    assert recognise(rig).characters[0].form == "creature"
    at, out = dict(zip(rig.names, rig.world[:, 3, :3], strict=True)), orient_joints(rig)
    start, end = ("neck", "head") if arms else ("head", "muzzle")
    np.testing.assert_allclose(aim(out, rig.names.index("head")), normalise(at[end] - at[start]), atol=1e-6)


def test_a_nose_does_not_tilt_a_head_that_stands_upright() -> None:
    above, head = (next(joint for joint in MAN if joint[0] == name) for name in ("neck", "head"))
    (x, y, z), out = head[2], orient_joints(rig_with([*MAN, ("nose", "head", (0.0, head[2][1], 0.2))]))
    way = np.array((x, y, z)) - above[2]
    np.testing.assert_allclose(aim(out, out.names.index("head")), normalise(way), atol=1e-6)


@pytest.mark.parametrize("arms", [False, True])
def test_the_head_of_a_bird_aims_at_its_beak_and_that_of_an_angel_goes_on_as_the_neck(arms: bool) -> None:
    """Before, a bird's head had the axes of a person's, which stands upright."""
    above, head = (next(joint for joint in MAN if joint[0] == name) for name in ("neck", "head"))
    limbs = ("upper_arm", "forearm", "hand")
    joints = [joint for joint in MAN if arms or not joint[0].startswith((*limbs, "finger", "thumb"))]
    joints.append(("beak", "head", (0.0, head[2][1], 0.2)))
    span = [(x, above[2][1] - 0.1, z) for x, z in ((0.15, -0.1), (0.5, -0.2), (0.9, -0.1))]
    over = next(joint for joint in MAN if joint[0].startswith("upper_arm."))[1]
    over = next(joint for joint in MAN if joint[0] == over)[1] if over.startswith("clavicle") else over
    joints += both(line("wing1.L wing2.L wing3.L", over, *span))
    out = orient_joints(rig := rig_with(joints))
    assert any(chain.kind == "wing" for chain in recognise(rig).characters[0].chains)
    at = dict(zip(rig.names, rig.world[:, 3, :3], strict=True))
    start, end = ("neck", "head") if arms else ("head", "beak")
    np.testing.assert_allclose(aim(out, rig.names.index("head")), normalise(at[end] - at[start]), atol=1e-6)


@pytest.mark.parametrize("toes", [True, False])
@pytest.mark.parametrize("degrees", [20.0, 50.0, 80.0])
def test_feet_of_legs_that_are_stretched_aside_turn_with_them(degrees: float, toes: bool) -> None:
    """Before, their hinge was the lateral axis of the body, as far off theirs as the leg was from hanging."""
    joints = []
    for name, above, (x, y, z) in MAN:
        if name.startswith("toe") and not toes:
            continue
        if name.startswith(("shin", "foot", "toe")):
            side = np.copysign(1.0, x)
            angle = np.radians(degrees) * side
            far, high = x - side * 0.1, y - 0.95
            x = side * 0.1 + far * np.cos(angle) - high * np.sin(angle)
            y = 0.95 + far * np.sin(angle) + high * np.cos(angle)
        joints.append((name, above, (float(x), float(y), z)))
    rig = rig_with(joints)
    out = orient_joints(rig)
    for side, way in (("L", 1.0), ("R", -1.0)):
        turned = np.radians(degrees) * way
        hinge = np.array([np.cos(turned), np.sin(turned), 0.0])
        foot = out.world[out.find(f"foot.{side}"), 1, :3]
        assert np.degrees(np.arccos(foot @ hinge)) < (30 if degrees > 30 else 21)


@pytest.mark.parametrize("whole", [False, True])
def test_the_topmost_bone_of_a_trunk_turns_and_what_moves_the_whole_stays(whole: bool) -> None:
    """The spine of Rigify's animals begins behind the hips: before, its first bone kept its axes."""
    place = (0.0, 0.0, -0.6) if whole else (0.0, 1.4, -0.8)
    behind = [("croup", "", place), *((n, above or "croup", at) for n, above, at in HORSE)]
    out = orient_joints(rig_with(behind), preset="maya")
    croup, hips = out.find("croup"), out.find("pelvis")
    assert (aim(out, croup) @ aim(out, hips) > 0.9) is not whole
    if not whole:
        np.testing.assert_allclose(out.world[croup, 1, :3], out.world[hips, 1, :3], atol=1e-9)
