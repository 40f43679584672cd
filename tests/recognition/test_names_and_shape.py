"""Names and shape have to agree on the same three joints before a limb is sure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from recognition_bodies.cases import Case
from recognition_bodies.population import population
from recognition_bodies.skeletons import (
    ARM,
    FINGERS,
    HORSE,
    LEG,
    MAN,
    TRUNK,
    Joint,
    both,
    line,
    renamed,
    rig_with,
)
from recognition_bodies.truth import nameless

from rigtri.model.rig import Rig
from rigtri.recognition.layout import BENDS, Layout
from rigtri.recognition.limb_words import agreement, in_order, limb_words
from rigtri.recognition.recognise import recognise

_FINGERS = {"t": "thumb", "f0": "index", "f1": "middle", "f2": "ring", "f3": "little"}
# A man with fingers that are called so: a naming scheme that knows all of him.
WHOLE = [*MAN, *FINGERS]
CALLED = {name: f"{_FINGERS[name[:-3]]}_{name[-3:]}" for name, _, _ in FINGERS}


def called(rig: Rig, names: dict[str, str]) -> Rig:
    return replace(rig, names=tuple(names.get(name, name) for name in rig.names))


def exchanged(case: Case) -> Rig:
    """A rig with the names of arms on legs, of legs on arms; or of front legs on hind legs."""
    names = list(case.rig.names)
    by_side: dict[str, list[list[int]]] = {}
    for part in case.truth.parts:
        if "leg" in part.kinds or "arm" in part.kinds:
            by_side.setdefault(part.side, []).append(
                [min(choice) for choice in part.joints if min(choice) >= 0]
            )
    for limbs in by_side.values():
        for one, other in zip(*limbs[:2], strict=False) if len(limbs) > 1 else ():
            names[one], names[other] = names[other], names[one]
    return replace(case.rig, names=tuple(names))


def one_off(case: Case) -> Rig:
    """A rig in which each joint has the name of the one above it."""
    return with_names_above(case.rig)


def with_names_above(rig: Rig) -> Rig:
    names: list[str] = []
    for above in rig.parents.tolist():
        name = rig.names[above] if above >= 0 else "root"
        names.append(name if name not in names else f"{name}.{len(names):03}")
    return replace(rig, names=tuple(names))


def sure(layout: Layout) -> list[tuple[str, tuple[int, ...]]]:
    return [(chain.name, chain.bend) for chain in layout.chains if chain.bend and chain.is_sure]


def test_arms_called_legs_are_neither_and_the_evidence_has_both_readings() -> None:
    """Before, such a body was sure: arms by the names, ``though its shape could be that of a leg``."""
    rig = called(rig_with(WHOLE), CALLED)
    assert len(sure(recognise(rig))) == 4
    other = {"upper_arm": "thigh", "forearm": "shin", "hand": "foot"}
    pairs = {f"{one}.{side}": f"{two}.{side}" for one, two in other.items() for side in "LR"}
    layout = recognise(called(rig, pairs | {two: one for one, two in pairs.items()}))
    assert sure(layout) == []
    arm = next(chain for chain in layout.chains if chain.name == "left arm")
    assert arm.evidence[0].startswith("its names")
    assert arm.evidence[-1] == "but its shape is that of a leg"


@pytest.mark.parametrize("joints", [WHOLE, HORSE], ids=["man", "horse"])
def test_names_that_are_one_joint_off_make_nothing_sure_that_the_shape_denies(joints: list[Joint]) -> None:
    """Before, a shin, foot and toe that were called thigh, shin and foot were a sure leg."""
    rig = called(rig_with(joints), CALLED)
    right = {bend for _, bend in sure(recognise(rig))}
    assert len(right) == 4
    assert {bend for _, bend in sure(recognise(with_names_above(rig)))} <= right


@pytest.mark.parametrize("last", ["palm", "clavicle"])
def test_arms_whose_joints_have_the_names_of_the_next_are_not_sure_beside_no_legs(last: str) -> None:
    """Before, they were sure at 0.98, "its shape agrees", or at 0.97 by their names alone."""
    below = {"clavicle": "upper_arm", "upper_arm": "forearm", "forearm": "hand", "hand": last}
    moved = {f"{one}.{side}": f"{two}.{side}" for one, two in below.items() for side in "LR"}
    legless = rig_with([each for each in MAN if each[0][:-2] not in ("thigh", "shin", "foot", "toe")])
    assert [name for name, _ in sure(recognise(legless))] == ["left arm", "right arm"]
    layout = recognise(called(legless, moved))
    assert sure(layout) == []
    why = f"forearm.L - hand.L - {last}.L bend much more as a limb does, and names may be one joint off"
    assert f"the left arm is not sure: {why}" in layout.remarks


@pytest.mark.parametrize("wrong", [exchanged, one_off])
@pytest.mark.slow
def test_whatever_names_call_a_limb_its_shape_alone_is_not_sure_of_another(
    wrong: Callable[[Case], Rig],
) -> None:
    for case in (case for which in (0, 1, 2) for case in population(which)):
        rig = wrong(case)
        shaped = [chain for chain in recognise(nameless(rig)).chains if chain.bend and chain.is_sure]
        for chain in (chain for chain in recognise(rig).chains if chain.kind in BENDS and chain.is_sure):
            others = [k for k in shaped if set(k.bend[:2]).intersection(chain.bend[:2])]
            assert [(k.kind, k.bend) for k in others] in ([], [(chain.kind, chain.bend)]), case.name


def test_a_spine_is_no_leg_although_its_bones_are_as_long_as_those_of_one() -> None:
    """Before, it was: one of two alike, and words of its twin's names made that sure."""
    twin = {"thigh.L": "spine", "shin.L": "spine2", "foot.L": "chest", "toe.L": "neck", "hips": "body"}
    body: list[Joint] = [("body", "", (0.0, 1.0, 0.0)), ("head", "body", (0.0, 1.3, 0.0))]
    body += [(name, twin[above] if above == "hips" else above, place) for name, above, place in LEG]
    body += [(twin[name], twin[above], (-x, y, z)) for name, above, (x, y, z) in LEG]
    assert [name for name, _ in sure(recognise(rig_with(body)))] == ["left leg"]


def test_a_joint_at_the_side_with_a_name_of_the_trunk_makes_its_limb_unsure() -> None:
    layout = recognise(called(rig_with(MAN), {"clavicle.L": "chest.001", "clavicle.R": "chest.002"}))
    assert sorted(name for name, _ in sure(layout)) == ["left leg", "right leg"]
    assert any("'chest.001' before it has a name of the trunk" in remark for remark in layout.remarks)


def test_a_limb_that_forks_at_its_end_is_sure_by_its_names_whichever_branch_its_shape_takes() -> None:
    """Two palms below a forearm: of the nameless arm the shape takes the other one, and is not sure."""
    joints = [*MAN, *both([("palm.L", "forearm.L", (0.7, 1.44, 0.01))])]
    arms = {named: recognise(rig_with(joints, named=named)).chains for named in (True, False)}
    ends = {
        named: [
            joints[chain.bend[2]][0] for chain in chains if chain.kind == "arm" and chain.is_sure == named
        ]
        for named, chains in arms.items()
    }
    assert ends == {True: ["hand.L", "hand.R"], False: ["palm.L", "palm.R"]}


def test_arms_of_parted_straight_bones_are_what_their_names_say() -> None:
    """As MakeHuman's are in T-pose: by shape any joint along them may be the elbow."""
    places = [(x, 1.45, 0.0) for x in (0.02, 0.115, 0.247, 0.411, 0.576, 0.73, 0.884)]
    bones = "clavicle.L shoulder01.L upperarm01.L upperarm02.L lowerarm01.L lowerarm02.L wrist.L"
    arm = line(bones, "chest", *places)
    for k, z in enumerate((0.03, 0.02, 0.0, -0.02, -0.03)):
        far = [0.884 + step + 0.03 * (k > 0) for step in (0.05, 0.085, 0.11)]
        names = " ".join(f"finger{k + 1}-{joint}.L" for joint in (1, 2, 3))
        arm += line(names, "wrist.L", *((x, 1.45, z) for x in far))
    rig = rig_with([*TRUNK, *both([*arm, *LEG])])
    arms = [limb for limb in recognise(rig).chains if limb.kind == "arm"]
    assert [limb.is_sure for limb in arms] == [True, True]
    for limb in arms:
        side = rig.names[limb.bend[0]][-2:]
        assert [rig.names[k] for k in limb.bend] == [
            f"{k}{side}" for k in ("upperarm01", "lowerarm01", "wrist")
        ]


@pytest.mark.parametrize(
    ("names", "agreed"),
    [
        (
            "leg_upper leg_middle leg_lower",
            1.0,
        ),  # between both the middle is clear, and the lower ends the limb
        ("leg_upper leg_lower leg_foot", 1.0),
    ],
)
def test_names_of_a_chain_agree_with_the_places_at_which_it_bends(names: str, agreed: float) -> None:
    levels_of = in_order([limb_words(name) for name in names.split()])
    assert agreement(levels_of, (0, 1, 2)) == pytest.approx(agreed)


def test_arms_beside_front_and_hind_legs_are_read_by_the_words_that_many_use() -> None:
    """No scheme has front legs; what names say of them costs the arms of a centaur nothing."""
    legs = ("thigh", "shin", "foot", "toe")
    joints = [joint for joint in MAN if not joint[0].startswith(legs)]
    joints.insert(1, ("rump", "hips", (0, 1, -0.9)))
    for name, over, (x, y, z) in (joint for joint in MAN if joint[0].startswith(legs)):
        front = f"front_{over}" if over.startswith(legs) else over
        hind = f"hind_{over}" if over.startswith(legs) else "rump"
        joints += [(f"front_{name}", front, (x, y, z)), (f"hind_{name}", hind, (x, y, z - 1.0))]
    layout = recognise(rig_with(joints))
    arms = [chain for chain in layout.chains if chain.kind == "arm"]
    assert [chain.evidence for chain in arms] == [
        ("its names: common words for bones", "its shape agrees")
    ] * 2
    assert sorted(chain.name for chain in layout.chains if chain.is_sure and chain.kind == "leg") == [
        "left front leg",
        "left hind leg",
        "right front leg",
        "right hind leg",
    ]


@pytest.mark.parametrize("lost", ["arm", "leg"])
def test_a_limb_without_a_twin_is_found_by_words_of_all_its_joints(lost: str) -> None:
    """Of a maker whose names are in no scheme. Before, who had one arm or one leg had none."""
    called = {"hips": "mPelvis", "spine": "mTorso", "chest": "mChest", "neck": "mNeck", "head": "mHead"}
    called |= {"clavicle": "mCollar", "upper_arm": "mShoulder", "forearm": "mElbow", "hand": "mWrist"}
    called |= {"thigh": "mHip", "shin": "mKnee", "foot": "mAnkle", "toe": "mFoot"}
    words = (
        ("clavicle", "upper_arm", "forearm", "hand") if lost == "arm" else ("thigh", "shin", "foot", "toe")
    )
    joints = [joint for joint in MAN if not joint[0].startswith(tuple(f"{word}.R" for word in words))]
    (man,) = recognise(rig_with(renamed(joints, called, ("Left", "Right")))).characters
    assert sorted(chain.name for chain in man.limbs if chain.is_sure and chain.kind == lost) == [
        f"left {lost}"
    ]


def test_an_arm_that_is_a_gun_is_one_by_its_names() -> None:
    """Names of one scheme on one side, with a word more on the other. Before, it was missed."""
    called = {"upper_arm": "arm_upper", "forearm": "arm_lower"}
    joints = [
        (
            name.replace("arm_", "gun_arm_").replace("hand", "gun_hand") if name.endswith("_r") else name,
            above,
            at,
        )
        for name, above, at in renamed(MAN, called, ("_l", "_r"))
    ]
    fixed = {name.replace("gun_", ""): name for name, _, _ in joints if "gun_" in name}
    rig = rig_with([(name, fixed.get(above, above), at) for name, above, at in joints])
    arms = {chain.name: chain for chain in recognise(rig).chains if chain.kind == "arm"}
    assert rig.names[arms["right arm"].bend[0]] == "gun_arm_upper_r"


@pytest.mark.parametrize("words", ["upper lower hand", "shoulder elbow wrist"])
def test_a_wing_whose_joints_have_words_of_an_arm_is_a_wing(words: str) -> None:
    """``wing_upper_L`` … ``wing_hand_L`` were surely an arm of a body on four legs, and of a bird."""
    places = ((0.1, 1.45, 0.2), (0.6, 1.75, 0.05), (1.1, 1.7, 0.3))
    names = " ".join(f"wing_{word}.L" for word in words.split())
    joints = [*HORSE, *both(line(names, "chest", *places))]
    (dragon,) = recognise(rig_with(joints)).characters
    wings = {chain.name: chain for chain in dragon.chains if chain.kind in ("arm", "wing")}
    assert wings.keys() == {"left wing", "right wing"}
    assert " ".join(joints[k][0] for k in wings["left wing"].bend) == names


_MIXAMO = {"hips": "Hips", "spine": "Spine", "clavicle": "Shoulder", "upper_arm": "Arm", "forearm": "ForeArm"}
_MIXAMO |= {"thigh": "UpLeg", "shin": "Leg", "foot": "Foot", "toe": "ToeBase"}


@pytest.mark.parametrize("part", [0.5, 0.7, 0.85])
def test_a_nameless_joint_within_a_forearm_is_no_hand(part: float) -> None:
    """Before, of a body with one arm, whose hand has no name either, it was the hand, at 0.97."""

    def new(name: str) -> str:
        word, _, side = name.partition(".")
        sided = {"L": "Left", "R": "Right"}.get(side, "") + _MIXAMO.get(word, "")
        return f"mixamorig:{sided}" if word in _MIXAMO else {"hand": "Bone.026"}.get(word, name)

    joints: list[Joint] = []
    for name, over, place in [*TRUNK, *both(LEG), *ARM, *FINGERS[: len(FINGERS) // 2]]:
        if name == "hand.L":
            joints.append(("Bone.061", new(over), (0.44 + 0.26 * part, 1.45, 0.0)))
        joints.append((new(name), "Bone.061" if name == "hand.L" else new(over), place))
    (found,) = recognise(rig_with(joints)).characters
    ends = [joints[chain.bend[2]][0] for chain in found.chains if chain.bend and chain.is_sure]
    assert "mixamorig:LeftFoot" in ends
    assert "Bone.061" not in ends
