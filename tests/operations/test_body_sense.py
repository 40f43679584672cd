"""One body, one sense: re-oriented axes are those that a rigger means, on bodies whose hinges are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from places import SAMPLES
from posed_bodies import Pose, PosedBody, posed_body, poses
from recognition_bodies.skeletons import ARM, FINGERS, HORSE, LEG, MAN, TRUNK, both, line, rig_with, without

from rigtri import add_controls, add_polevector, make_limb, orient_joints, read
from rigtri.errors import GeometryError, UsageError
from rigtri.formats.usd.identifiers import identifier
from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.verification.checks.axis_check import axis_findings

# The axis that is the hinge n, with its sign, as docs/presets.md has it.
HINGES = {
    "article": "+y",
    "maya": "-y",
    "blender": "+x",
    "rigify": "+x",
    "unreal-editor": "-y",
    "mgear": "-z",
    "cmt": "-z",
    "talk": "+z",
    "openxr": "+y",
    "three-ik": "+y",
}
# How far an axis may be off the hinge that a body is made with, in degrees. A limb that is bent by less than
# 10° shows its own plane within 60° of the natural one.
LIMITS = {"trunk": 35.0, "hand": 30.0, "limb": 20.0, "clavicle": 35.0}
SHAKY_LIMB = 60.0


def hinge_axes(rig: Rig, hinge: str) -> Floats:
    """The world direction about which a positive turn of each node's hinge axis goes, unit, (n, 3).

    In left-handed axes a positive turn goes the other way round.
    """
    axes = rig.world[:, "xyz".index(hinge[1]), :3] * (-1.0 if hinge[0] == "-" else 1.0)
    axes = axes * np.sign(np.linalg.det(rig.world[:, :3, :3]))[:, np.newaxis]
    return np.asarray(axes / np.linalg.norm(axes, axis=1)[:, np.newaxis])


def kind(part: str) -> str:
    """Which law is for a part of a body."""
    if part.endswith("hand") or any(finger in part for finger in ("index", "middle", "ring", "little")):
        return "hand"
    if "clavicle" in part:
        return "clavicle"
    return "limb" if part.endswith(("arm", "leg", "foot")) else "trunk"


def broken_laws(body: PosedBody, pose: Pose, out: Rig, hinge: str) -> list[str]:
    """The joints whose hinge axis is not the one that the body was made with."""
    axes, found = hinge_axes(out, hinge), []
    for part, node in body.parts.items():
        # What ends a chain takes the axes of the joint above it.
        if node not in body.hinges or part == "head" or part.endswith(" 3"):
            continue
        if part.endswith("hand") and not pose.fingers:
            continue
        of = kind(part)
        limit = SHAKY_LIMB if of == "limb" and pose.noise and pose.elbow < 10 else LIMITS[of]
        cosine = float(axes[node] @ body.hinges[node]) / float(np.linalg.norm(body.hinges[node]))
        off = float(np.degrees(np.arccos(np.clip(cosine, -1, 1))))
        if off > limit:
            found.append(f"{part} is {off:.0f}° off")
    return found


EVERY = list(poses())
# A few of each kind always, all of them with --slow.
FEW = [*EVERY[2:18:8], *EVERY[19::12], Pose(little_first=True)]


@pytest.mark.ci
@pytest.mark.parametrize(
    "pose",
    [pytest.param(pose, marks=[] if pose in FEW else pytest.mark.slow, id=pose.title) for pose in EVERY],
)
def test_every_preset_closes_hands_and_bends_trunks_and_limbs_about_one_axis(pose: Pose) -> None:
    body = posed_body(pose)
    for preset, hinge in HINGES.items():
        out = orient_joints(body.rig, preset=preset)
        assert broken_laws(body, pose, out, hinge) == [], preset
        for socket in body.sockets:
            np.testing.assert_allclose(out.world[socket], body.rig.world[socket], atol=1e-12)


@pytest.mark.parametrize("knee", [0.0, 5.0])
def test_of_hips_that_are_turned_against_the_chest_knees_bend_as_the_hips_face(knee: float) -> None:
    """Before, they bent where half of the body faces: up to 62° off."""
    body = posed_body(Pose(turned=90.0, knee=knee, arms=70.0))
    out = orient_joints(body.rig)
    for part in ("hips", "left upper leg", "right lower leg", "left foot", "right lower arm", "upper chest"):
        cosine = hinge_axes(out, "+y")[body.parts[part]] @ body.hinges[body.parts[part]]
        assert cosine > 0.98, part
    assert list(axis_findings(out)) == []


def test_a_report_names_the_rule_that_each_joint_follows() -> None:
    body, report = posed_body(Pose(arms=80.0)), Report()
    orient_joints(body.rig, report=report)
    rules = {entry["joint"].removeprefix("mixamorig:"): entry.get("up") for entry in report.joints}
    assert rules["Spine1"] == "lateral axis of the body"
    assert rules["LeftHandIndex1"] == "palm of the hand"
    assert rules["LeftShoulder"] == "facing direction of the chest"


@pytest.mark.ci
@pytest.mark.parametrize("unknown", [["index"], ["ring"], ["pinky"], ["index", "ring", "pinky"], ["thumb"]])
def test_a_finger_of_unknown_name_closes_with_the_hand_whose_others_are_known(unknown: list[str]) -> None:
    pose = Pose("unreal", arms=45.0)
    body = posed_body(pose)
    names = list(body.rig.names)
    for k, word in enumerate(unknown):
        names = [name.replace(f"{word}_", f"xq{'abc'[k]}_") for name in names]
    assert names != list(body.rig.names)
    (usual, out) = (orient_joints(rig) for rig in (body.rig, replace(body.rig, names=tuple(names))))
    assert broken_laws(body, pose, out, HINGES["article"]) == []
    np.testing.assert_allclose(out.world, usual.world, atol=1e-12)  # the thumb's, too


HANDS = [
    Pose(hands=2.0),
    Pose("unreal", hands=2.5, arms=90.0),
    Pose(knuckles=40.0, curl=15.0),
    Pose("blender", knuckles=80.0, curl=30.0),
    Pose(fingers=1),
    Pose(fingers=1, arms=90.0, names="unreal"),
    Pose(fingers=2, names="blender"),
    Pose(phalanges=1),
    Pose(phalanges=1, fingers=1, arms=80.0),
    Pose(phalanges=2, curl=15.0),
    # Nothing shows the palm: it is where arms that hang have it.
    Pose(fingers=1, thumb=False),
    Pose(fingers=1, thumb=False, arms=20.0, names="unreal"),
    Pose(fingers=1, thumb=False, names="none", arms=70.0),
    Pose("blender", fingers=4, thumb=False, curl=25.0),
    # A clear bend goes before that.
    Pose("none", thumb=False, metacarpals=True, curl=50.0, palm=90.0, arms=75.0),
    Pose(fingers=1, thumb=False, curl=12.0, palm=150.0),
    Pose(fingers=1, thumb=False, curl=15.0, palm=90.0, arms=70.0, names="unreal"),
    # So does a thumb beside one finger, which begins nearer to the wrist.
    Pose("none", fingers=1, arms=10.0, palm=150.0),
    Pose("none", fingers=1, arms=130.0, palm=90.0, phalanges=2),
    Pose("none", fingers=1, arms=90.0, palm=90.0, phalanges=2),
]


@pytest.mark.parametrize(
    "pose",
    [
        pytest.param(pose, marks=[] if k % 3 == 2 else pytest.mark.slow, id=pose.title)
        for k, pose in enumerate(HANDS)
    ],
)
def test_hands_of_every_kind_close(pose: Pose) -> None:
    """Big ones, mittens, fingers of a single joint, and knuckles that are bent back."""
    body = posed_body(pose)
    for preset, hinge in HINGES.items():
        assert broken_laws(body, pose, orient_joints(body.rig, preset=preset), hinge) == [], preset


@pytest.mark.parametrize("names", ["none", "mixamo"])
def test_a_guess_to_which_side_fingers_close_is_a_warning(names: str) -> None:
    report = Report()
    orient_joints(posed_body(Pose(names, thumb=False, arms=60.0)).rig, report=report)
    notices = [notice for notice in report.warnings if notice.code == "unsure-hand"]
    assert [notice.geometry for notice in notices] == [True] * (names == "none")


@pytest.mark.parametrize("forward", [0.0, 80.0])
def test_which_way_one_straight_finger_closes_is_a_guess_where_arms_are_raised_ahead(forward: float) -> None:
    """Before, nothing was said, though its hand may be turned about the arm by 90°."""
    report = Report()
    pose = Pose("mixamo", thumb=False, fingers=1, curl=0.0, arms=90.0, forward=forward)
    orient_joints(posed_body(pose).rig, report=report)
    notices = [notice for notice in report.warnings if notice.code == "unsure-hand"]
    assert ["raised ahead" in notice.text for notice in notices] == [forward > 45]


@pytest.mark.parametrize("preset", HINGES)
def test_the_remedy_for_a_guess_gives_the_hinge_in_every_preset(preset: str) -> None:
    """Before, the vector went to the up axis: in `maya` the hinge reversed, in `talk` another axis."""
    pose = Pose("mixamo", thumb=False, fingers=1, curl=0.0, arms=90.0, forward=80.0)
    body, report = posed_body(pose).rig, Report()
    orient_joints(body, preset=preset, report=report)
    (said,) = (notice.text for notice in report.warnings if notice.code == "unsure-hand")
    up = said.split('up="')[1].split('"')[0]
    hand = body.find("mixamorig:LeftHand")
    finger = next(k for k in range(len(body)) if body.parents[k] == hand)
    vector = "vector:0,1,0"
    out = orient_joints(body, preset=preset, up=up, up_from=vector, joints=[body.names[finger]])
    assert hinge_axes(out, HINGES[preset])[finger] @ (0, 1, 0) > 0.9


@pytest.mark.parametrize("preset", ["maya", "unreal-editor", "mgear", "blender"])
def test_the_plane_beside_a_preset_is_its_own_plane(preset: str) -> None:
    """Before, --up-from plane reversed the hinges of `maya`."""
    rig = read(SAMPLES / "biped.glb")
    leg = ["thigh_L", "shin_L"]
    alone = orient_joints(rig, preset=preset, joints=leg)
    beside = orient_joints(rig, preset=preset, up_from="plane", joints=leg)
    of_chain = orient_joints(rig, preset=preset, chain=[{"start": leg[0], "end": leg[1], "up_from": "plane"}])
    assert np.abs(beside.world - alone.world).max() < 1e-6
    assert np.abs(of_chain.world - alone.world).max() < 1e-6


@pytest.mark.parametrize(
    ("elbow", "turned", "width", "is_sure"),
    [
        (0.0, 0.0, None, False),  # no skin
        (0.0, 0.0, 0.05, True),
        (0.0, 90.0, 0.05, False),
        (0.0, 0.0, 0.02, False),  # as thick as wide
        (40.0, 0.0, None, True),
    ],
)
def test_how_a_hand_of_one_straight_finger_is_turned_is_a_guess_without_flat_skin(
    elbow: float, turned: float, width: float | None, is_sure: bool
) -> None:
    """Hands turned about themselves were 70° to 90° off without a word."""
    turn = np.radians(elbow)
    bones = [
        (0.45, 1.4, 0.0),
        *[(0.45 + k * np.cos(turn), 1.4, k * np.sin(turn)) for k in (0.25, 0.35, 0.39)],
    ]
    names = "upper_arm.L forearm.L hand.L index1.L index2.L"
    arm = line(names, "chest", (0.2, 1.4, 0.0), *bones)
    rig = rig_with([*TRUNK, *both([*arm, *LEG])])
    corners = np.stack(np.meshgrid((0.0, 0.1), (-0.5, 0.5), (-0.5, 0.5)), axis=-1).reshape(-1, 3)
    if width is not None:
        corners = corners * (1.0, 0.02, width)
        sine, cosine = np.sin(np.radians(turned)), np.cos(np.radians(turned))
        points = corners @ np.array([[1, 0, 0], [0, cosine, sine], [0, -sine, cosine]])
        meshes = [Mesh(name, rig.find(name), points) for name in ("hand.L", "hand.R")]
        rig = replace(rig, content=Content(read_outlines=lambda: meshes))
    report = Report()
    orient_joints(rig, report=report)
    said = [notice.text for notice in report.warnings if notice.code == "unsure-hand"]
    assert ["nor does its skin" in text for text in said] == [True] * (not is_sure)


@pytest.mark.parametrize(
    ("left", "right", "bone", "is_sure"),
    [
        ((-90.0, 12.0), (-90.0, 12.0), 0.04, True),  # both bend towards the palm
        ((0.0, 12.0), (0.0, 12.0), 0.04, True),  # … of hands that are turned ahead
        ((0.0, 12.0), (-170.0, 12.0), 0.04, False),  # both bend, each elsewhere
        ((-90.0, 12.0), (-90.0, 12.0), 0.01, False),  # by a millimetre
        ((-90.0, 12.0), (-90.0, 0.0), 0.04, True),  # one alone, to the palm of a hand that hangs
        ((30.0, 12.0), (30.0, 0.0), 0.04, False),  # … or far from it
        ((30.0, 35.0), (-90.0, 0.0), 0.04, True),  # more than noise bends
    ],
)
def test_how_noise_bends_the_one_finger_of_a_hand_does_not_show_how_it_closes(
    left: tuple[float, float], right: tuple[float, float], bone: float, is_sure: bool
) -> None:
    """Before, any bend of 10° turned the hand, by up to 179°. A bend: to where, and by how much, degrees."""
    sides = []
    for side, sign, (to, by) in (("L", 1.0, np.radians(left)), ("R", -1.0, np.radians(right))):
        wrist = [(0.2, 1.4, 0.0), (0.45, 1.4, 0.0), (0.7, 1.4, 0.0), (0.8, 1.4, 0.0)]
        first = (0.8 + bone, 1.4, 0.0)
        turned = np.array([np.cos(by), np.sin(by) * np.sin(to), np.sin(by) * np.cos(to)])
        places = [(sign * x, y, z) for x, y, z in (*wrist, first, (first + bone * turned).tolist())]
        names = [f"{name}.{side}" for name in ("upper_arm", "forearm", "hand", "index1", "index2", "index3")]
        sides += line(" ".join(names), "chest", *places)
    rig, report = rig_with([*TRUNK, *sides, *both(LEG)]), Report()
    out = orient_joints(rig, report=report)
    said = [notice.names for notice in report.warnings if notice.code == "unsure-hand"]
    assert any("index1.L" in names for names in said) != is_sure
    to = np.radians(left[0])
    own, hanging = np.array([0.0, -np.cos(to), np.sin(to)]), np.array([0.0, 0.0, -1.0])
    hinge = hinge_axes(out, HINGES["article"])[out.find("index1.L")]
    assert hinge @ (own if is_sure else hanging) > 0.99


@pytest.mark.parametrize("side", ["", "right"])
def test_a_hand_alone_closes_too(side: str) -> None:
    """Without a body the thumb, or a bend, says on which side the palm is."""
    rig = read(SAMPLES / "hand.glb")
    names = [f"{side}_{name}" if side else name for name in rig.names]
    out = orient_joints(replace(rig, names=tuple(names)))
    axes = hinge_axes(out, "+y")
    four = ("index", "middle", "ring", "little")
    fingers = [node for node, name in enumerate(rig.names) if name.startswith(four)]
    # It is a right hand that looks up, its palm ahead.
    np.testing.assert_allclose(axes[fingers] @ [1.0, 0.0, 0.0], 1.0, atol=0.1)


@pytest.mark.parametrize("curl", [0.0, 10.0])
@pytest.mark.parametrize("ends", [False, True])
@pytest.mark.parametrize(("call", "sure"), [("", False), ("Bip01 R {}", True), ("rig:R_{}_jnt", True)])
def test_a_hand_alone_closes_whatever_names_its_fingers_have(
    curl: float, call: str, sure: bool, ends: bool
) -> None:
    """With metacarpals, or with ends and some joints of its arm."""
    body = posed_body(Pose("none", curl=curl, noise=2.0, metacarpals=not ends, ends=ends))
    arm = ("right upper arm", "right lower arm") if ends else ()
    order = ("right hand", "right thumb", "right index", "right middle", "right ring", "right little")
    parts = {node: part for part, node in body.parts.items() if part.startswith((*order, *arm))}
    rig, place = body.rig.subset(list(parts))
    names = [""] * len(rig)
    for node, part in parts.items():
        finger, _, k = part.rpartition(" ")
        words = f"Finger{order.index(finger) - 1}{k}" if k.isdigit() else "Hand"
        names[place[node]] = "" if part in arm else call.format(words)
    weighted = np.array([not part.endswith(" 4") for part in parts.values()])
    skin = Skin("skin", np.array([*place.values()]), inverse(rig.world), weigh=lambda: weighted)
    rig, report = replace(rig, names=tuple(names), skins=(skin,)), Report()
    axes = hinge_axes(orient_joints(rig, report=report), "+y")
    hand = body.parts["right hand"]
    turned = np.linalg.solve(body.rig.world[hand, :3, :3], rig.world[place[hand], :3, :3])
    for node in (node for node, part in parts.items() if part[-1] in "012" and "thumb" not in part):
        assert axes[place[node]] @ (body.hinges[body.parts["right hand"]] @ turned) > 0.86
    assert ("unsure-character" in {notice.code for notice in report.warnings}) == (not sure)


def test_fingers_that_are_clearly_bent_share_their_own_plane() -> None:
    report = Report()
    orient_joints(posed_body(Pose(curl=25.0)).rig, report=report)
    rules = {entry["joint"].removeprefix("mixamorig:"): entry.get("up") for entry in report.joints}
    assert rules["LeftHandIndex1"] == rules["LeftHandPinky2"] == "plane of the bent fingers"


def test_each_joint_may_still_have_its_own_plane() -> None:
    body = posed_body(Pose(curl=1.0, noise=3.0, seed=5))
    shared, own = orient_joints(body.rig), orient_joints(body.rig, per_joint_plane=True)
    fingers = [node for part, node in body.parts.items() if part.endswith(("index 1", "ring 1"))]
    spread = [np.ptp(hinge_axes(rig, "+y")[fingers[:2]], axis=0).max() for rig in (shared, own)]
    assert spread[0] < 0.1 < spread[1]


def test_a_small_bend_to_an_unnatural_side_is_not_believed() -> None:
    body = posed_body(Pose(elbow=-4.0, knee=-4.0))
    report = Report()
    out = add_polevector(body.rig, limbs="auto", report=report)
    for limb, record in zip(("arm", "arm", "leg", "leg"), report.limbs, strict=True):
        middle = body.rig.world[body.rig.find(record["limb"][1]), 3, :3]
        ahead = np.array(record["position"])[2] - middle[2]
        assert ahead < 0 if limb == "arm" else ahead > 0
    assert [notice.code for notice in report.warnings].count("bends-otherwise") == 4
    assert len(out) > len(body.rig)


def knees_aside(left: float, right: float) -> Rig:
    """A body whose knees, bent by 4°, stand so far aside, in metres: each plane 45° out for 0.015."""
    body = posed_body(Pose(knee=4.0))
    rig, moved = body.rig, body.rig.translation.copy()
    for side, aside in (("left", left), ("right", right)):
        knee, foot = body.parts[f"{side} lower leg"], body.parts[f"{side} foot"]
        for node, step in ((knee, aside), (foot, -aside)):
            moved[node] += np.linalg.solve(rig.world[rig.parents[node], :3, :3].T, [step, 0.0, 0.0])
    rig = replace(rig, translation=moved)
    binds = inverse(rig.world[rig.skins[0].joints])
    return replace(rig, skins=(replace(rig.skins[0], inverse_bind=binds),))


@pytest.mark.parametrize(("left", "right", "believed"), [(0.015, -0.015, True), (0.015, 0.0, False)])
def test_a_small_bend_aside_is_believed_where_the_other_side_mirrors_it(
    left: float, right: float, believed: bool
) -> None:
    out = orient_joints(knees_aside(left, right))
    (hinge,) = hinge_axes(out, "+y")[[out.find("mixamorig:LeftLeg")]]
    assert (abs(float(hinge[0])) < 0.9) == believed


@pytest.mark.parametrize(("aside", "warned"), [(-0.06, 2), (0.06, 2), (0.01, 0), (0.3, 0)])
def test_a_knee_that_bends_clearly_but_aside_is_reported(aside: float, warned: int) -> None:
    """Knock knees and bandy legs; from 30° on it is a pose, as of a frog."""
    for edit in (lambda rig, report: add_polevector(rig, limbs="auto", report=report), orient_reported):
        report = Report()
        edit(knees_aside(aside, -aside), report)
        assert [notice.code for notice in report.warnings].count("bends-aside") == warned


def test_a_small_bend_aside_is_no_shape_of_a_leg() -> None:
    report = Report()
    orient_reported(knees_aside(0.03, 0.0), report)
    assert {notice.code for notice in report.warnings if "Leg" in notice.text} == {"bends-otherwise"}


@pytest.mark.parametrize("aside", [-0.06, 0.06])
def test_a_knee_that_bends_aside_above_a_foot_that_points_ahead_bends_forward(aside: float) -> None:
    """Knock knees and bandy legs; legs that are turned out have feet that point out, and are bent so."""
    rig = knees_aside(aside, -aside)
    knee, foot, toes = (rig.find(f"mixamorig:Left{part}") for part in ("Leg", "Foot", "ToeBase"))
    ahead = hinge_axes(orient_joints(rig), "+y")[knee]
    assert ahead[0] > 0.9
    out = add_polevector(rig, limbs="auto")
    pole = out.world[out.find("mixamorig:LeftLeg_pole"), 3, :3] - rig.world[knee, 3, :3]
    assert pole[2] > 0.95 * np.linalg.norm(pole)
    moved = rig.translation.copy()
    step = np.array([-np.sign(aside) * -0.13, 0.0, -0.13])
    moved[toes] += np.linalg.solve(rig.world[foot, :3, :3].T, step)
    assert abs(hinge_axes(orient_joints(replace(rig, translation=moved), pose="nodes"), "+y")[knee][2]) > 0.9


def test_fingers_that_look_bent_aside_close_towards_the_palm() -> None:
    """No finger bends along the line of the knuckles; before, noise of 4 mm turned a hand by 82°."""
    body = posed_body(Pose(arms=70.0))
    rig, moved = body.rig, body.rig.translation.copy()
    first, last = (rig.world[body.parts[f"right {finger} 1"], 3, :3] for finger in ("index", "little"))
    step = 0.015 * (last - first) / np.linalg.norm(last - first)
    for finger in ("index", "middle", "ring", "little"):
        tip, parent = (body.parts[f"right {finger} {k}"] for k in (3, 2))
        moved[tip] += np.linalg.solve(rig.world[parent, :3, :3].T, step)
    axes = hinge_axes(orient_joints(replace(rig, translation=moved), pose="nodes"), "+y")
    for part in ("right hand", "right index 1", "right little 1"):
        assert axes[body.parts[part]] @ body.hinges[body.parts[part]] > 0.9


@pytest.mark.parametrize("count", [3, 4])
def test_open_fingers_with_metacarpals_have_no_vote_beside_bent_ones(count: int) -> None:
    """Before, how the two open fingers of a peace sign are spread turned the hand by 45°."""
    fingers = []
    for finger, aside in (("index", 0.035), ("middle", 0.02), ("ring", -0.01), ("little", -0.03)):
        open_, bent = [(0.83, 1.45), (0.86, 1.45)], [(0.79, 1.41), (0.76, 1.41)]
        outer = [(*place, aside) for place in (open_ if aside > 0 else bent)]
        names = " ".join(f"{finger}{k}.L" for k in range(count))
        places = [(0.71, 1.45, 0.3 * aside), (0.79, 1.45, aside), *outer]
        fingers += line(names, "hand.L", *places[:count])
    rig = rig_with([*TRUNK, *both([*ARM, *fingers, *LEG])])
    axes = hinge_axes(orient_joints(rig), "+y")
    for name in ("hand.L", "index1.L", "ring1.L", f"ring{count - 2}.L"):
        assert axes[rig.find(name)] @ (0, 0, -1) > 0.95, name


def test_open_fingers_without_metacarpals_vote_beside_bent_ones() -> None:
    """They have no joint that shows how they are spread; without them the bent ones alone would decide."""
    fingers: list[tuple[str, str, tuple[float, float, float]]] = []
    for finger, aside in (("index", 0.03), ("middle", 0.01), ("ring", -0.01), ("little", -0.03)):
        down, to = (0.03, -0.018) if finger in ("ring", "little") else (0.004, 0.0)
        places = ((0.79, 1.45, aside), (0.83, 1.45, aside), (0.86, 1.45 - down, aside + to))
        fingers += line(" ".join(f"{finger}{k}.L" for k in range(3)), "hand.L", *places)
    rig = rig_with([*TRUNK, *both([*ARM, *fingers, *LEG])])
    axes = hinge_axes(orient_joints(rig), "+y")
    assert axes[rig.find("index1.L")] @ (0, 0, -1) > 0.93


def orient_reported(rig: Rig, report: Report) -> Rig:
    return orient_joints(rig, report=report)


def test_axes_of_the_world_are_for_faces_too() -> None:
    body = posed_body(Pose(face=True))
    out = orient_joints(body.rig, preset="vrm")
    for part in ("jaw", "left eye", "right eye"):
        np.testing.assert_allclose(out.world[body.parts[part], :3, :3], np.eye(3), atol=1e-6)


def test_a_clear_bend_is_believed_whatever_is_natural() -> None:
    body, report = posed_body(Pose(knee=-15.0)), Report()
    add_polevector(body.rig, limbs="auto", report=report)
    knees = [record for record in report.limbs if "Leg" in record["limb"][1]]
    for record in knees:
        middle = body.rig.world[body.rig.find(record["limb"][1]), 3, :3]
        assert np.array(record["position"])[2] < middle[2]


def test_facing_that_changes_nothing_is_reported() -> None:
    body, report = posed_body(Pose(elbow=40.0)), Report()
    add_polevector(body.rig, limbs="auto", facing="-z", report=report)
    unused = [notice.text for notice in report.warnings if notice.code == "facing-unused"]
    assert len(unused) == 2
    assert all("clearly bent" in text for text in unused)


def test_limbs_that_bend_against_facing_are_reported() -> None:
    """Before, orient-joints turned hips and head alone, without a word."""
    body = posed_body(Pose(elbow=40.0)).rig
    for facing, count in (("-z", 2), ("+z", 0)):
        report = Report()
        orient_joints(body, facing=facing, report=report)
        unused = [notice.text for notice in report.warnings if notice.code == "facing-unused"]
        assert ["clearly bent" in text and "Arm" in text for text in unused] == [True] * count


def test_facing_turns_the_poles_of_straight_limbs() -> None:
    body = posed_body(Pose())
    ahead, back = (add_polevector(body.rig, limbs="auto", facing=facing) for facing in ("+z", "-z"))
    knee = next(name for name in ahead.names if "LeftLeg_pole" in name)
    assert ahead.world[ahead.find(knee), 3, 2] > 0 > back.world[back.find(knee), 3, 2]


def test_knees_of_legs_stretched_ahead_are_above_and_elbows_of_such_arms_below() -> None:
    """There "ahead" says nothing: it swings with the limb."""
    for pose in (Pose(seated=88.0, arms=88.0, forward=85.0), Pose(seated=97.0, arms=90.0, forward=80.0)):
        body, report = posed_body(pose), Report()
        add_polevector(body.rig, limbs="auto", report=report)
        for record in report.limbs:
            up = record["position"][1] - body.rig.world[body.rig.find(record["limb"][1]), 3, 1]
            assert up > 0.1 if "Leg" in record["limb"][1] else up < -0.1


def test_a_pole_keeps_the_dots_of_the_file_where_the_format_has_them() -> None:
    body = posed_body(Pose("blender"))
    strict = replace(body.rig, rules=replace(body.rig.rules, valid_name=identifier))
    assert "forearm.L_pole" in add_polevector(body.rig, limbs="auto").names
    assert "forearm_L_pole" in add_polevector(strict, limbs="auto").names


def test_a_pole_of_nameless_joints_is_called_after_its_limb() -> None:
    names = add_polevector(posed_body(Pose("none", elbow=15.0)).rig, limbs="auto").names
    assert {"left_arm_pole", "right_leg_pole"} <= set(names)


@pytest.mark.ci
def test_controls_of_nameless_joints_have_the_sides_of_their_limbs() -> None:
    rig = add_controls(posed_body(Pose("none", elbow=15.0)).rig, whole_character=True)
    controls = rig.records(ControlRecord).values()
    sides = {record.chain: record.side for record in controls if record.kind == "ik"}
    assert sorted(sides.values()) == ["left", "left", "right", "right"]
    for chain, side in sides.items():
        assert {record.side for record in controls if record.joint in chain} == {side}


@pytest.mark.ci
def test_hands_close_where_the_nodes_are_turned_away_from_the_bind_pose() -> None:
    body = posed_body(Pose(arms=80.0))
    bind = orient_joints(body.rig).world
    for degrees in (90.0, 180.0):
        half = np.radians(degrees) / 2
        rotation = body.rig.rotation.copy()
        rotation[0] = (0, np.sin(half), 0, np.cos(half))
        turned = orient_joints(replace(body.rig, rotation=rotation))
        back = np.array(
            [[np.cos(2 * half), 0, np.sin(2 * half)], [0, 1, 0], [-np.sin(2 * half), 0, np.cos(2 * half)]]
        )
        np.testing.assert_allclose(turned.world[:, :3, :3] @ back, bind[:, :3, :3], atol=1e-5)


def test_a_character_that_is_not_sure_is_reported_and_no_body_is_presumed() -> None:
    lean, report = posed_body(Pose("none", arms=10.0, hunch=60.0, noise=4.0, seed=3)), Report()
    from rigtri.recognition.recognise import recognise

    unsure = [k for k in recognise(lean.rig).characters if k.confidence < 0.75]
    orient_joints(lean.rig, report=report)
    assert ("unsure-character" in [notice.code for notice in report.warnings]) == bool(unsure)


@pytest.mark.parametrize("toes", [True, False])
@pytest.mark.parametrize("preset", HINGES)
def test_front_feet_of_a_horse_fold_back_as_hind_ones_do(preset: str, toes: bool) -> None:
    """Before, their positive rotation was that of the elbows, which bend the other way."""
    rig = rig_with(HORSE if toes else without(HORSE, "toe", "finger"))
    hinges = hinge_axes(orient_joints(rig, preset=preset), HINGES[preset])
    of = {name: float(hinges[rig.find(f"{name}.L"), 0]) for name in ("forearm", "hand", "shin", "foot")}
    assert {name: round(sense) for name, sense in of.items()} == {
        "forearm": -1,
        "hand": 1,
        "shin": 1,
        "foot": 1,
    }


def test_hips_that_keep_their_axes_for_a_trunk_that_is_not_sure_are_named() -> None:
    """Before, only the report's list told of them."""
    arm = line("a b c d", "chest", (0.1, 1.4, 0.0), (0.2, 1.4, 0.0), (0.45, 1.4, 0.0), (0.7, 1.4, 0.0))
    joints = [*TRUNK, *arm, *both(LEG)]  # one arm
    rig, report = rig_with(joints), Report()
    rig = replace(rig, names=tuple("" for _ in rig.names))
    orient_joints(rig, report=report)
    kept = [row for row in report.joints if row.get("status") == "kept"]
    texts = [note.text for note in report.warnings if note.code in ("unsure-limb", "unsure-character")]
    assert [f"'{row['joint']}', on top of them, keeps its axes" in texts[0] for row in kept] == [True]


def test_limbs_that_are_not_sure_are_named() -> None:
    """Short arms without fingers may begin with their clavicles: nothing edits them unnamed."""
    body = posed_body(Pose("none", short=0.6, fingers=0))
    for edit, code in ((orient_joints, "unsure-limb"), (add_polevector, "limb-left-out")):
        report = Report()
        edit(body.rig, report=report, **({"limbs": "auto"} if edit is add_polevector else {}))
        (text,) = [notice.text for notice in report.warnings if notice.code == code]
        assert "left arm (#" in text
        assert "right arm (#" in text
        assert "limb=" in text
    parts = ("upper arm", "lower arm", "hand")
    arms = [[body.parts[f"{side} {part}"] for part in parts] for side in ("left", "right")]
    report = Report()
    orient_joints(body.rig, limb=[tuple(f"#{k}" for k in arm) for arm in arms], report=report)
    assert [notice for notice in report.warnings if notice.code == "unsure-limb"] == []


@pytest.mark.parametrize("flare", [0.0, 0.01])
@pytest.mark.parametrize("word", ["coat", "スカート"])
def test_tails_of_a_coat_bend_about_the_lateral_axis_whatever_they_are_called(
    word: str, flare: float
) -> None:
    """Before, those that hang straight had hinges of their own, far apart, as they might be legs."""
    tails = []
    for part, z in (("front", 0.1), ("back", -0.1)):
        places = [
            (0.12 + 0.01 * k, 0.95 - 0.2 * k, z + (0.02 * k + flare * (k > 1)) * np.sign(z)) for k in range(4)
        ]
        tails += line(" ".join(f"{word}_{part}_{k}.L" for k in range(4)), "hips", *places)
    rig = rig_with([*MAN, *both(tails)])
    hinges = hinge_axes(orient_joints(rig), "+y")
    of_tails = [float(hinges[k, 0]) for k, name in enumerate(rig.names) if name.startswith(word)]
    assert len(of_tails) == 16
    assert min(of_tails) > np.cos(np.radians(LIMITS["trunk"]))


def test_straight_limbs_are_straight_without_a_number() -> None:
    report = Report()
    orient_joints(posed_body(Pose()).rig, report=report)
    texts = [notice.text for notice in report.warnings if notice.code == "straight"]
    assert len(texts) == 4
    assert all(" is straight; up axis: " in text for text in texts)


def test_advice_is_not_what_was_tried() -> None:
    body = posed_body(Pose(elbow=0.0))
    limb = ("mixamorig:Spine", "mixamorig:Spine1", "mixamorig:Spine2")
    with pytest.raises(GeometryError, match=r"bend='.*'\.$"):
        add_polevector(body.rig, limb=[limb])
    with pytest.raises(GeometryError, match="facing= says nothing of it"):
        add_polevector(body.rig, limb=[limb], facing="+z")


def test_a_facing_direction_along_the_body_is_refused() -> None:
    with pytest.raises(UsageError, match="along the character"):
        orient_joints(posed_body(Pose()).rig, facing="+y")


def test_axes_along_the_world_need_no_body() -> None:
    report = Report()
    orient_joints(posed_body(Pose(elbow=-4.0, knee=-4.0)).rig, preset="vrm", report=report)
    assert [notice.code for notice in report.warnings if notice.code == "bends-otherwise"] == []


@pytest.mark.ci
@pytest.mark.parametrize("droop", [-0.1, 0.0, 0.1])
def test_a_wing_has_one_hinge_along_its_whole_length_on_both_sides(droop: float) -> None:
    """Its curve lies in the plane of the body's own hinge, some bones on either side of it."""
    rig = posed_body(Pose()).rig
    x, y = np.array([0.1, 0.3, 0.52, 0.75, 0.97]), np.array([0.0, 0.1, 0.155, 0.155, 0.1])
    for side, sign in (("left", 1.0), ("right", -1.0)):
        points = np.array([0.0, 1.3, -0.1]) + np.stack([sign * x, y - droop * x, -0.25 * x], axis=1)
        rig = make_limb(
            rig,
            points=tuple(map(tuple, points.tolist())),
            name="wing",
            side=side,
            parent="mixamorig:Spine2",
            as_="joint",
            planar=True,
        )
    # As any file has such joints: nothing is stored on them, and they have weight.
    every = np.ones(len(rig.skins[0].joints), dtype=bool)
    skin = replace(rig.skins[0], weigh=lambda: every)
    out = orient_joints(replace(rig, metadata={}, skins=(skin,)))
    left, right = (
        np.array([out.world[out.find(f"wing_{k}_{side}"), 1, :3] for k in range(1, 5)]) for side in "LR"
    )
    assert (left @ left[0] > 0.99).all()
    # A hinge is seen in the mirror of the sides as a direction about which things turn.
    assert np.abs(right - left * [1.0, -1.0, -1.0]).max() < 1e-6


@pytest.mark.parametrize("drop", [0.15, 0.3])
def test_each_hand_of_four_arms_that_are_equal_closes_with_its_own_fingers(drop: float) -> None:
    """Before, the wrists of the second pair had axes of their own, and thumbs closed over other hands."""
    own = both([*ARM]) + FINGERS

    def second(name: str) -> str:
        stem, dot, side = name.rpartition(".")
        return f"{stem}_second{dot}{side}" if dot else name

    more = [(second(name), second(above), (x, y - drop, z)) for name, above, (x, y, z) in own]
    joints = [*TRUNK, *both(LEG), *own, *more]
    alone, out = (orient_joints(rig_with(k)) for k in ([*TRUNK, *both(LEG), *own], joints))
    for name, *_ in own:
        if name.startswith(("hand", "t", "f")) and not name.startswith("forearm"):
            expected = alone.world[alone.find(name), :3, :3]
            for node in (out.find(name), out.find(second(name))):
                np.testing.assert_allclose(out.world[node, :3, :3], expected, atol=1e-6, err_msg=name)


def test_clavicles_of_further_arms_are_those_of_the_chest() -> None:
    """Before, they took the plane of their limb: up to 70° off the clavicles of the first two."""

    def shifted(name: str) -> str:
        stem, dot, side = name.rpartition(".")
        return f"{stem}_second{dot}{side}" if dot else name

    places = (0.04, 1.45, 0.0), (0.16, 1.45, -0.02), (0.36, 1.25, -0.04), (0.5, 1.05, 0.06)
    arms = both(line("clavicle.L upper_arm.L forearm.L hand.L", "chest", *places))
    more = [(shifted(name), shifted(above), (x, y - 0.2, z)) for name, above, (x, y, z) in arms]
    out = orient_joints(rig_with([*TRUNK, *both(LEG), *arms, *more]))
    for name in (name for name, *_ in arms if name.startswith("clavicle")):
        first, second = (out.world[out.find(each), :3, :3] for each in (name, shifted(name)))
        np.testing.assert_allclose(second, first, atol=1e-6, err_msg=name)


def test_arms_without_hands_have_no_bend_and_are_no_error() -> None:
    """Before, poles of a body with arms of two joints ended with an IndexError."""
    arms = both(line("arm.L forearm.L", "chest", (0.16, 1.45, 0.0), (0.4, 1.2, 0.0)))
    rig = rig_with([*TRUNK, *both(LEG), *arms])
    chains = [
        chain for each in recognise(rig).characters for chain in each.sure_chains if chain.kind == "arm"
    ]
    assert [chain.bend for chain in chains] == [(), ()]
    assert len(add_polevector(rig, limbs="auto").nodes_of("poleVector")) == 2


def test_feet_of_who_sits_with_legs_crossed_bend_as_the_knees_do() -> None:
    """Before, about the lateral axis of the body, to which the soles are turned there: 80° off."""
    leg = [(0.1, 0.95, 0), (0.42, 0.9, 0.28), (0.02, 0.85, 0.38), (-0.02, 0.83, 0.5)]
    joints = [*TRUNK, *both([*ARM, *line("thigh.L shin.L foot.L toe.L", "hips", *leg)])]
    out = orient_joints(rig_with(joints))
    for side in "LR":
        hip, knee, ankle = (out.world[out.find(f"{k}.{side}"), 3, :3] for k in ("thigh", "shin", "foot"))
        hinge = np.cross(knee - hip, ankle - knee)
        axis = out.world[out.find(f"foot.{side}"), 1, :3]
        assert axis @ hinge / np.linalg.norm(hinge) > 0.9


@pytest.mark.parametrize("curl", [0.0, 8.0])
def test_a_metacarpal_that_is_set_aside_is_no_bend_of_a_lone_finger(curl: float) -> None:
    """The knuckle stands 14° aside in the palm. Before, the finger closed about the palm's own normal."""
    places = [(0.72, 1.45, 0.017), (0.78, 1.45, 0.032)]
    for k, bone in enumerate((0.04, 0.026, 0.02)):
        x, y, z = places[-1]
        places.append((x + bone * np.cos(k * np.radians(curl)), y - bone * np.sin(k * np.radians(curl)), z))
    finger = line("index0.L index1.L index2.L index3.L index4.L", "hand.L", *places)
    out = orient_joints(rig_with([*TRUNK, *both([*ARM, *finger, *LEG])]))
    axes = hinge_axes(out, "+y")
    for joint in (name for name, _, _ in finger):
        assert np.degrees(np.arccos(axes[out.find(joint)] @ (0, 0, -1))) < 30, joint


@pytest.mark.parametrize("ahead", [-1.0, 0.0, 1.0])
def test_a_hand_of_one_straight_finger_goes_with_its_bent_elbow(ahead: float) -> None:
    """Arms across the belly, ahead, and out: the palm was at the thigh. Before, it was up in the first."""
    elbow, forearm = np.array([0.2, 1.1, 0.0]), np.array([0.0, 0.0, 0.25])
    forearm = np.array([0.25 * ahead, 0.0, 0.0]) if ahead else forearm
    places = [(0.2, 1.4, 0.0), elbow, elbow + forearm, *(elbow + forearm * k for k in (1.4, 1.6, 1.75))]
    arm = line("upper_arm.L forearm.L hand.L index1.L index2.L index3.L", "chest", *map(tuple, places))
    out = orient_joints(rig_with([*TRUNK, *both([*arm, *LEG])]))
    palm = {-1.0: (0, 0, -1), 0.0: (-1, 0, 0), 1.0: (0, 0, 1)}[ahead]
    expected = np.cross(forearm / 0.25, palm)
    got = hinge_axes(out, "+y")[out.find("index2.L")]
    assert np.degrees(np.arccos(got @ expected)) < 30


@pytest.mark.parametrize("curl", [0.0, 40.0, 70.0])
@pytest.mark.parametrize("thumb", [0.0, 30.0])
@pytest.mark.parametrize("way", [(0.6, -0.35, 0.72), (0.5, -0.7, 0.5)], ids=["aside", "into the palm"])
def test_a_bent_thumb_does_not_turn_the_one_finger_beside_it(
    curl: float, thumb: float, way: tuple[float, float, float]
) -> None:
    """Before, the tip of the thumb said where the palm is, and turned the finger by up to 120°."""
    finger, turn = [np.array([0.79, 1.45, 0.028])], 0.0
    for bone in (0.04, 0.026):
        turn += np.radians(curl)
        finger.append(finger[-1] + bone * np.array([np.cos(turn), -np.sin(turn), 0.0]))
    first = np.array(way) / np.linalg.norm(way)
    hinge = np.cross(first, (0.05, -0.5, -0.75))
    hinge /= np.linalg.norm(hinge)
    bones, turn = [np.array([0.725, 1.438, 0.022])], 0.0
    for bone in (0.045, 0.033):
        turn += np.radians(thumb)  # from its base on
        ahead = np.cos(turn) * first + np.sin(turn) * np.cross(hinge, first)
        bones.append(bones[-1] + bone * ahead)
    hand = [
        *line("index1.L index2.L index3.L", "hand.L", *map(tuple, finger)),
        *line("thumb1.L thumb2.L thumb3.L", "hand.L", *map(tuple, bones)),
    ]
    report = Report()
    out = orient_joints(rig_with([*TRUNK, *both([*ARM, *hand, *LEG])]), report=report)
    axes = hinge_axes(out, "+y")
    assert axes[out.find("index2.L")] @ (0, 0, -1) > np.cos(
        np.radians((45 if thumb else 37) if curl == 0 else 10)
    )
    assert axes[out.find("thumb1.L")] @ hinge > np.cos(np.radians(45))
    # Where the finger shows nothing, the bent thumb is no sure witness.
    unsure = any(notice.code == "unsure-hand" for notice in report.warnings)
    assert unsure == (curl == 0 and thumb > 0)


@pytest.mark.parametrize(
    ("tail", "bow", "word"), [(0, 0, "at the side"), (1, 0, "paw"), (0, 60, "raised ahead")]
)
def test_one_straight_finger_may_be_a_paw_or_raised_ahead_of_a_bent_chest(
    tail: int, bow: float, word: str
) -> None:
    """Before, only arms raised ahead of the whole body were unsure, and front paws were up to 89° off."""
    up = np.array([0.0, np.cos(np.radians(bow)), np.sin(np.radians(bow))])
    hips = np.array([0.0, 1.0, 0.0])
    trunk = line("hips spine chest neck head", "", *(tuple(hips + k * up) for k in (0, 0.15, 0.3, 0.5, 0.6)))
    root, down = hips + 0.45 * up, np.array([0.0, -1.0, 0.0])
    hanging = [root + 0.17 * np.eye(3)[0] + k * down for k in (0, 0.28, 0.54, 0.62, 0.66)]
    names = "clavicle.L upper_arm.L forearm.L hand.L index1.L index2.L"
    arm = line(names, "chest", tuple(root + 0.04 * np.eye(3)[0]), *map(tuple, hanging))
    tails = line("tail1 tail2 tail3", "hips", (0, 1, -0.1), (0, 0.95, -0.2), (0, 0.9, -0.3))
    report = Report()
    orient_joints(rig_with([*trunk, *tails * tail, *both([*arm, *LEG])]), report=report)
    said = [notice.text for notice in report.warnings if notice.code == "unsure-hand"]
    assert [word in text for text in said] == [True]


def with_palms(held: str) -> Rig:
    """A body whose first palm bone holds thumb and index finger, or whose last one the last two fingers."""
    above = {"t1.L": "p0.L", "f01.L": "p0.L"} if held == "thumb" else {"f21.L": "p3.L", "f31.L": "p3.L"}
    palm = (
        ("p0.L", "hand.L", (0.72, 1.45, 0.015))
        if held == "thumb"
        else ("p3.L", "hand.L", (0.72, 1.45, -0.01))
    )
    left = [(name, above.get(name, over), at) for name, over, at in FINGERS if ".L" in name]
    return rig_with([*TRUNK, *both([*ARM, *LEG, palm, *left])])


@pytest.mark.parametrize("held", ["thumb", "last fingers"])
@pytest.mark.parametrize("preset", HINGES)
def test_a_bone_of_the_palm_that_holds_several_fingers_closes_with_the_hand(preset: str, held: str) -> None:
    """As Rigify's first palm, and cups. Before, it was rolled by up to 91°, or opened."""
    out = orient_joints(with_palms(held), preset=preset)
    hinges = hinge_axes(out, HINGES[preset])
    palm = "p0" if held == "thumb" else "p3"
    for side in "LR":
        assert hinges[out.find(f"{palm}.{side}")] @ hinges[out.find(f"f{palm[1]}1.{side}")] > 0.95
