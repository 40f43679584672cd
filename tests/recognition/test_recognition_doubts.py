"""Arms and legs that evidence contradicts are shown, and never sure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from posed_bodies import Pose, posed_body
from recognition_bodies.measure import measure
from recognition_bodies.population import company, crowd, furnished, population
from recognition_bodies.skeletons import ARM, FINGERS, LEG, MAN, TRUNK, Joint, both, line, rig_with
from recognition_bodies.truth import nameless

from rigtri.maths.scalar_vector import Vector
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.pipeline.rigspec.spec_init import left_out, starter, unsure
from rigtri.recognition.layout import Layout
from rigtri.recognition.recognise import recognise
from rigtri.recognition.shape_alone import SAME_PLACE, _parts_a_bone, _stand_in_one_place
from rigtri.report import Report


def renamed(joints: list[Joint], names: dict[str, str]) -> Layout:
    """What is recognised where joints have other names than they should."""
    rig = rig_with(joints)
    return recognise(replace(rig, names=tuple(names.get(name, name) for name in rig.names)))


def wrong(joints: list[Joint], layout: Layout) -> list[str]:
    """The limbs that are sure, and not the three joints that they should be."""
    right = {
        (f"{part[0]}.{side}", f"{part[1]}.{side}", f"{part[2]}.{side}")
        for part in (("upper_arm", "forearm", "hand"), ("thigh", "shin", "foot"))
        for side in "LR"
    }
    names = [name for name, _, _ in joints]
    found = {chain.name: tuple(names[k] for k in chain.bend) for chain in layout.chains if chain.is_sure}
    return [f"{name}: {bend}" for name, bend in found.items() if bend and bend not in right]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("hand.L", "foot.L"),
        ("hand.L", "thigh.L"),
        ("foot.R", "spine"),
        ("forearm.L", "clavicle.L"),
        ("upper_arm.L", "clavicle.L"),
        ("shin.L", "shin.R"),
        ("foot.L", "toe.L"),
        ("hand.R", "head"),
    ],
)
def test_two_names_that_are_swapped_make_no_limb_sure_that_is_wrong(one: str, other: str) -> None:
    assert wrong(MAN, renamed(MAN, {one: other, other: one})) == []


def test_hands_parented_to_feet_are_not_sure_and_a_remark_gives_the_reason() -> None:
    hands = [(name, f"shin{name[4:]}", place) for name, _, place in MAN if name.startswith("hand")]
    layout = recognise(rig_with([*(one for one in MAN if not one[0].startswith("hand")), *hands]))
    arms = [chain for chain in layout.chains if chain.kind == "arm"]
    assert arms
    assert not any(chain.is_sure for chain in arms)
    assert any("is not a descendant of 'forearm.L'" in remark for remark in layout.remarks)


@pytest.mark.parametrize("part", ["upper_arm.L", "foot.L", "shin.R", "forearm.R"])
def test_a_joint_that_has_lost_its_name_makes_no_limb_sure_that_is_wrong(part: str) -> None:
    assert wrong(MAN, renamed(MAN, {part: ""})) == []


def test_a_crane_is_no_arm_that_is_sure() -> None:
    layout = recognise(rig_with(CRANE))
    assert not any(chain.is_sure for chain in layout.chains if chain.bend)


def test_a_table_is_no_body_that_is_sure() -> None:
    table: list[Joint] = [("top", "", (0, 1, 0))]
    for side, x in (("L", 0.5), ("R", -0.5)):
        for end, z in (("F", 1), ("B", -1)):
            name = f"leg_{end}_{side}"
            table += [
                (name, "top", (x, 0.95, z)),
                (f"{name}2", name, (x, 0.5, z)),
                (f"{name}3", f"{name}2", (x, 0, z)),
            ]
    layout = recognise(rig_with(table))
    assert not any(chain.is_sure for chain in layout.chains if chain.bend)


@pytest.mark.parametrize("drop", [0.0, 0.2])
def test_a_clavicle_as_long_as_an_upper_arm_is_none(drop: float) -> None:
    places = ((0.03, 1.45, 0), (0.35, 1.45, 0), (0.62, 1.45 - drop, 0), (0.88, 1.45 - 1.9 * drop, 0))
    parts = ("clavicle", "upper_arm", "forearm", "hand")
    bare = [*TRUNK, *both([*line(" ".join(f"{part}.L" for part in parts), "chest", *places), *LEG])]
    fingers = [
        (name, over, (x + (0.18 if x > 0 else -0.18), y - 1.9 * drop, z)) for name, over, (x, y, z) in FINGERS
    ]
    joints = [*bare, *fingers]
    names = [name for name, _, _ in joints]
    arms = [chain for chain in recognise(rig_with(joints, named=False)).chains if chain.kind == "arm"]
    assert [chain.is_sure for chain in arms] == [True, True]
    assert {tuple(names[k] for k in chain.bend) for chain in arms} == {
        tuple(f"{part}.{side}" for part in parts[1:]) for side in "LR"
    }
    unseen = recognise(rig_with(bare, named=False)).chains  # nothing shows where its hands are
    assert not any(chain.is_sure for chain in unseen if chain.kind == "arm")


WINGS = both(
    [
        ("w0.L", "chest", (0.1, 1.4, -0.15)),
        ("w1.L", "w0.L", (0.5, 1.7, -0.2)),
        ("w2.L", "w1.L", (1.2, 1.6, -0.25)),
        ("w3.L", "w2.L", (1.8, 1.3, -0.3)),
    ]
)


def test_arms_beside_wings_are_not_sure_without_names() -> None:
    joints = [*MAN, *WINGS]
    layout = recognise(rig_with(joints, named=False))
    assert wrong(joints, layout) == []
    sure = {chain.kind for chain in layout.chains if chain.is_sure}
    assert sure == {"leg", "foot", "spine"}  # which are as they are, whichever pair the arms are


def test_joints_of_a_wing_deform_and_are_no_twist_joints_of_it() -> None:
    wings = [(name.replace("w", "wing"), over.replace("w", "wing"), place) for name, over, place in WINGS]
    rig = rig_with([*MAN, *wings])
    (character,) = recognise(rig).characters
    assert sum(chain.kind == "wing" for chain in character.chains) == 2
    roles = {rig.names[part.joint]: part.role for part in character.parts}
    assert {roles[name] for name, _, _ in wings} == {"deform"}


def test_further_limbs_that_are_not_sure_are_reported_without_a_question() -> None:
    more = line("x.L y.L z.L", "hips", (0.33, 0.95, 0), (0.33, 0.5, 0.01), (0.33, 0.1, -0.02))
    joints = [*MAN, *both(more)]
    layout = recognise(rig_with(joints))
    assert [chain.name for chain in layout.chains if chain.bend and not chain.is_sure] != []
    assert unsure(layout) == []
    assert len(left_out(layout)) == 2
    text = starter(rig_with(joints), "man.glb", layout, open_places=True)
    assert "null" not in text
    assert text.count(": left out") == 2
    assert "not sure, and left out" in text


def test_joints_at_one_place_but_for_one_beside_them_come_to_an_end() -> None:
    """Of joints that all hang at one, the one beside is nobody's to follow."""
    joints: list[Joint] = [("a", "", (0.0, 0.0, 0.0))]
    joints += [(f"a{k}", "a", (0.0, 0.0, 0.0)) for k in range(8)]
    joints.insert(8, ("beside", "a", (1e-6, 0.3, 1e-6)))
    assert not recognise(rig_with(joints)).characters


def test_an_arm_with_named_fingers_is_one_although_nothing_else_of_a_body_is_there() -> None:
    arm = line(
        "root upper_arm forearm hand", "", (0, 0, 0), (0.2, 1.4, 0), (0.48, 1.4, -0.03), (0.73, 1.4, 0)
    )
    for k, finger in enumerate(("thumb", "index", "middle", "ring")):
        places = [(0.8 + 0.03 * joint, 1.4 - 0.004 * joint, 0.04 - 0.02 * k) for joint in range(3)]
        arm += line(" ".join(f"{finger}_{joint}" for joint in (1, 2, 3)), "hand", *places)
    layout = recognise(rig_with(arm))
    assert [chain.name for chain in layout.chains if chain.is_sure and chain.bend] == ["arm"]


def test_joints_without_names_are_not_reported_to_share_one() -> None:
    rig = rig_with(MAN)
    report = Report()
    add_polevector(
        replace(rig, names=("",) * len(rig)), options=AddPolevectorOptions(limbs="auto"), report=report
    )
    assert report.limbs
    assert [notice.text for notice in report.warnings if notice.code == "limb-left-out"] == []


def test_of_very_many_joints_without_names_a_remark_reports_that_their_shape_is_not_read() -> None:
    hair = [
        joint
        for k in range(1001)
        for joint in line(f"h{k}_0 h{k}_1 h{k}_2", "", *((k, y, 0.0) for y in range(3)))
    ]
    (remark,) = recognise(
        rig_with(line("root", "", (0, 0, 0)) + [(n, a or "root", p) for n, a, p in hair])
    ).remarks
    assert "of more than 3000 only names are read" in remark


@pytest.mark.parametrize("number", [2, 6])
def test_arms_of_a_body_without_legs_are_no_sure_legs_beside_hair(number: int) -> None:
    """With hands, which the strands of hair have not; and below clavicles, where the strands are not sure."""
    case = crowd(618, number, 180)
    rig = nameless(case.rig)
    found = measure(rig, case.truth, recognise(rig), named=False)
    assert [each for each in found if each.outcome == "surely wrong"] == []


def test_a_limb_that_begins_at_the_further_part_of_a_split_bone_is_not_sure() -> None:
    """``lShoulder`` is the upper arm here, and ``lShoulder.001`` its second half."""
    case = next(population(402, "person 34".__eq__))
    found = measure(case.rig, case.truth, recognise(case.rig), named=True)
    assert [each for each in found if each.outcome == "surely wrong"] == []


@pytest.mark.parametrize(("which", "number", "why"), [(50, 6, "of its upper bone"), (6, 0, ""), (26, 4, "")])
def test_a_bone_that_begins_at_the_second_of_two_joints_of_one_name_is_not_sure(
    which: int, number: int, why: str
) -> None:
    """Or right, where noise explains the bend between both."""
    case = company(which, number, 190)
    layout = recognise(case.rig)
    found = measure(case.rig, case.truth, layout, named=True)
    assert [each for each in found if each.outcome == "surely wrong"] == []
    assert any(f"may be the first part {why}" in remark for remark in layout.remarks) == bool(why)


def test_a_lower_bone_that_begins_at_its_second_joint_is_not_sure() -> None:
    arm = line(
        "clavicle.L upper_arm.L forearm.L forearm.L.001 hand.L",
        "chest",
        (0.04, 1.45, 0),
        (0.16, 1.45, 0),
        (0.3, 1.45, 0),
        (0.42, 1.45, -0.01),
        (0.66, 1.3, 0.1),
    )
    remarks = recognise(rig_with([*TRUNK, *both([*arm, *LEG])])).remarks
    assert sum("'forearm.L' may be the first part of its lower bone" in remark for remark in remarks) == 1
    assert sum("'forearm.R' may be the first part of its lower bone" in remark for remark in remarks) == 1


@pytest.mark.parametrize(
    "called",
    ["Bone.{k:03}", "Bone{k:03}", "joint{k}", "bone_{k}", "Armature_{k}", "Node.{k:03}", "Object_{k}"],
)
def test_names_that_a_program_has_numbered_say_nothing(called: str) -> None:
    """``Bone.001`` at the hips ``Bone`` begins a leg, and is no further part of them."""
    rig = posed_body(Pose("none", knee=5.0, elbow=5.0)).rig
    first = [called.partition(".")[0].format(k=0)] if "." in called else []
    names = ["Armature", *first, *(called.format(k=k) for k in range(1, len(rig) - len(first)))]
    chains, nameless_ones = (recognise(each).chains for each in (replace(rig, names=tuple(names)), rig))
    known, expected = ([(k.name, k.joints, k.confidence) for k in each] for each in (chains, nameless_ones))
    assert sorted(known) == sorted(expected)


@pytest.mark.parametrize(
    ("which", "number", "named", "why"),
    [
        (618, 8, False, "may be a twist joint, like that of the upper bone"),
        (27, 2, False, ""),
        (27, 5, False, "both may be a skirt"),
        (9001, 2, True, "its bones are counted from"),
        (9001, 6, True, "is called as a lower bone is"),
        (6, 4, False, "its middle may be a twist joint of its upper bone"),
        (22, 1, False, "may be a twist joint, and its first bone a clavicle"),
        (26, 0, False, ""),
        (26, 1, False, "it may be an arm below its clavicle"),
        (26, 4, False, "for a trunk leads up to it"),
    ],
)
def test_limbs_of_partial_people_side_by_side_are_not_surely_others(
    which: int, number: int, named: bool, why: str
) -> None:
    """Before, each was sure: without hands, with joints within straight arms, a skirt for missing legs."""
    case = crowd(which, number, 180)
    rig = case.rig if named else nameless(case.rig)
    layout = recognise(rig)
    found = measure(rig, case.truth, layout, named=named)
    assert [each for each in found if each.outcome == "surely wrong"] == []
    assert not why or any(why in remark for remark in layout.remarks)


def test_a_trunk_from_which_legs_and_a_tail_go_is_no_palm() -> None:
    """Before, all that is below its four chains counted as their joints."""
    case = next(population(1, "quadruped 28".__eq__))
    assert recognise(case.rig).characters[0].form == "quadruped"


@pytest.mark.parametrize("names", ["Waist Spine01 Spine02", "Torso1 Torso2 Torso3", "Spine Chest Spine3"])
def test_three_joints_of_a_trunk_are_the_three_bones_of_one(names: str) -> None:
    """Before, one of them had none, and conformed characters had holes in their trunks."""
    case = next(population(1, "person 0".__eq__))
    layout = recognise(case.rig)
    (spine,) = (chain.joints for chain in layout.characters[0].chains if chain.kind == "spine")
    assert len(spine) == 3
    called = dict(zip(spine, names.split(), strict=True))
    rig = replace(case.rig, names=tuple(called.get(k, name) for k, name in enumerate(case.rig.names)))
    bones = {part.joint: part.bone for part in recognise(rig).characters[0].parts}
    assert [bones[joint] for joint in spine] == ["spine", "chest", "upperChest"]


@pytest.mark.parametrize("named", [True, False])
def test_furniture_that_has_arms_legs_and_a_head_is_no_body_that_is_sure(named: bool) -> None:
    """Before, the arms of a chair were sure by their shape, and those of scales by one word of three."""
    for number in range(8):
        rig = furnished(8, number, 200).rig
        layout = recognise(rig if named else nameless(rig))
        assert [chain.name for chain in layout.chains if chain.is_sure and chain.bend] == []


def test_a_trunk_that_is_named_in_another_language_is_that_of_a_body() -> None:
    """Before, ``nothing else of a body is named``, although the arms were known by the same language."""
    french = "bassin colonne poitrine cou tete clavicule bras avantbras main cuisse tibia pied orteil"
    names = {}
    for (part, _, _), word in zip([*TRUNK, *ARM, *LEG], french.split(), strict=True):
        bare = part.removesuffix(".L")
        names |= {bare: word, f"{bare}.L": f"{word}_G", f"{bare}.R": f"{word}_D"}
    sure = [chain.name for chain in renamed(MAN, names).chains if chain.is_sure and chain.bend]
    assert sorted(sure) == ["left arm", "left leg", "right arm", "right leg"]


@pytest.mark.parametrize("one_skin", [True, False])
def test_a_remark_says_whether_one_skin_moves_several_characters(one_skin: bool) -> None:
    other = [(f"{name}.001", above and f"{above}.001", (x + 2.5, y, z)) for name, above, (x, y, z) in MAN]
    rig = rig_with([*MAN, *other])
    if not one_skin:
        (skin,) = rig.skins
        half = len(MAN)
        rows = slice(0, half), slice(half, 2 * half)
        skins = (replace(skin, joints=skin.joints[k], inverse_bind=skin.inverse_bind[k]) for k in rows)
        rig = replace(rig, skins=tuple(skins))
    (remark,) = (remark for remark in recognise(rig).remarks if "characters" in remark)
    words = "that one skin moves" if one_skin else "and no skin has joints of two"
    assert remark == f"2 characters: separate hierarchies, {words}"


def _with_names(**names: str) -> Rig:
    """The man with other names, on both sides: by name without its side."""
    rig = rig_with(MAN)
    parts = [name.partition(".") for name in rig.names]
    return replace(rig, names=tuple(f"{names.get(part, part)}{dot}{side}" for part, dot, side in parts))


def _with_one_name(old: str, new: str) -> Rig:
    rig = rig_with(MAN)
    return replace(rig, names=tuple(new if name == old else name for name in rig.names))


def _split_upper_arm(name: str) -> Rig:
    """The man with one more joint in the middle of his left upper arm."""
    rig = rig_with(
        [
            (
                "part" if joint == "forearm.L" else joint,
                over,
                (0.3, 1.45, 0) if joint == "forearm.L" else place,
            )
            for joint, over, place in MAN
            if joint == "forearm.L" or not _is_left_arm(joint)
        ]
        + [("forearm.L", "part", (0.44, 1.45, -0.005)), ("hand.L", "forearm.L", (0.7, 1.45, 0))]
    )
    return replace(rig, names=tuple(name if old == "part" else old for old in rig.names))


def _is_left_arm(joint: str) -> bool:
    return joint in ("forearm.L", "hand.L") or (joint.endswith(".L") and joint in {n for n, _, _ in FINGERS})


def _short_upper_arm() -> Rig:
    return rig_with([(n, over, (0.25, 1.45, 0) if n == "forearm.L" else place) for n, over, place in MAN])


def _called_in_turn(words: list[str]) -> Rig:
    rig = rig_with(MAN)
    return replace(rig, names=tuple(f"{words[k % len(words)]} {k}" for k in range(len(rig))))


def _counted_arm(side: str, x: float) -> list[Joint]:
    places = [(k * x, 1.45, -0.005 if k == 4 else 0) for k in (1, 2.5, 4, 5.5, 6)]
    return line(" ".join(f"arm_{side}_{k}" for k in range(1, 6)), "chest", *places)


CRANE: list[Joint] = [
    ("base", "", (0, 0, 0)),
    ("arm", "base", (0, 2, 0)),
    ("forearm", "arm", (0, 3, 1)),
    ("hook", "forearm", (0, 2, 2)),
    ("counter", "base", (0, 2, -1)),
]
SURE = ["left arm", "left leg", "right arm", "right leg"]
ARMS, LEGS = SURE[::2], SURE[1::2]


@pytest.mark.parametrize(
    ("make", "unsure_limbs", "remarks"),
    [
        (lambda: rig_with(MAN), [], []),
        (
            lambda: _with_one_name("hand.L", "foot2.L"),
            ["left arm"],
            ["the left arm is not sure: the name of 'foot2.L' is of another limb"],
        ),
        (
            lambda: _with_one_name("clavicle.L", "spine2"),
            ["left arm"],
            ["the left arm is not sure: 'spine2' before it has a name of the trunk"],
        ),
        (
            lambda: _with_one_name("hand.L", "hand_right"),
            ["left arm"],
            ["the left arm is not sure: the name of 'hand_right' says right"],
        ),
        (
            lambda: _split_upper_arm(""),
            ARMS,
            [
                "the left arm is not sure: a joint without a name is between 'upper_arm.L' and 'forearm.L'",
                "the right arm is not sure: the left arm has other bones",
            ],
        ),
        (
            lambda: _split_upper_arm("q"),
            ARMS,
            [
                "the left arm is not sure: the right arm has other bones",
                "the right arm is not sure: the left arm has other bones",
            ],
        ),
        (_short_upper_arm, ARMS, ["the right arm is not sure: the left arm has other bones"]),
        (
            lambda: rig_with([*TRUNK, *both(LEG), *_counted_arm("L", 0.1), *_counted_arm("R", -0.1)]),
            ARMS,
            [
                f"the {side} arm is not sure: its joints are counted on to '{name}', and any three may bend"
                for side, name in (("left", "arm_L_4"), ("right", "arm_R_4"))
            ],
        ),
        (
            lambda: _with_names(thigh="bone", shin="leg1", foot="leg2"),
            LEGS,
            [
                "the left leg is not sure: its bones are counted from 'leg1.L' on",
                "the right leg is not sure: its bones are counted from 'leg1.R' on",
            ],
        ),
        (
            lambda: _with_names(clavicle="y", upper_arm="x", forearm="upperarm", hand="forearm"),
            ARMS,
            [
                "the left arm is not sure: 'forearm.L' is called as a lower bone is",
                "the right arm is not sure: 'forearm.R' is called as a lower bone is",
            ],
        ),
        (
            lambda: _with_names(clavicle="y", upper_arm="shoulder", forearm="upperarm", hand="forearm"),
            ARMS,
            [
                "the left arm is not sure: 'upperarm.L' is called as an upper bone is",
                "the right arm is not sure: 'upperarm.R' is called as an upper bone is",
            ],
        ),
        (lambda: rig_with(CRANE), ["arm"], ["the arm is not sure: nothing else of a body is named"]),
        (
            lambda: rig_with([("hand" if n == "hook" else n, over, place) for n, over, place in CRANE]),
            ["arm"],
            ["the arm is not sure: no other part of a body is named"],
        ),
        (
            # Called as parts of a thing are, all of them; one other name, and it may be a body.
            lambda: _called_in_turn(["pipe", "gear", "lever", "crank"]),
            SURE,
            [
                f"the {limb} is not sure: its name, and all others here, are of parts of things and not of a "
                "body"
                for limb in SURE
            ],
        ),
        (lambda: _called_in_turn(["pipe", "gear", "lever", "zzz"]), [], []),
        (
            lambda: rig_with([(name, over, (x, -y, z)) for name, over, (x, y, z) in MAN], named=False),
            SURE,
            [f"the {limb} is not sure: its legs begin above its arms" for limb in SURE],
        ),
    ],
)
def test_a_remark_says_why_a_limb_is_not_sure(
    make: Callable[[], Rig], unsure_limbs: list[str], remarks: list[str]
) -> None:
    layout = recognise(make())
    assert sorted(chain.name for chain in layout.chains if chain.bend and not chain.is_sure) == unsure_limbs
    assert sorted(layout.remarks) == remarks


@pytest.mark.parametrize(("apart", "one_place"), [(0.0, True), (0.9, True), (1.1, False)])
def test_joints_in_one_place_are_near_each_other_beside_their_limb(apart: float, one_place: bool) -> None:
    """A limb 2 long, whose middle is nearer to its end; its twin's end is off by parts of what is near."""
    at = [Vector(0, 2, 0), Vector(0, 0.5, 0), Vector(0, 0, 0), Vector(2.0 * SAME_PLACE * apart, 0, 0)]
    tree: Any = SimpleNamespace(at=at)
    assert _stand_in_one_place(tree, (0, 1, 2), (0, 1, 3)) is one_place


@pytest.mark.parametrize(
    ("segments", "below", "bends", "parts"),
    [
        ([1], [[1], [2], []], [0.0, 5.0], True),
        ([1], [[1], [2], []], [0.0, 7.0], False),  # in one of two poses
        ([], [[1], [2], []], [0.0, 5.0], False),
        ([1], [[1], [], []], [0.0, 5.0], False),
    ],
)
def test_a_joint_that_names_call_a_part_of_a_bone_and_no_pose_bends_is_one(
    segments: list[int], below: list[list[int]], bends: list[float], parts: bool
) -> None:
    ends = [[np.sin(angle), 2 + np.cos(angle), 0] for angle in np.radians(bends)]
    moving = np.array([[[0, 1, 0], [0, 2, 0], end] for end in ends])
    draft: Any = SimpleNamespace(segments=segments, poses=SimpleNamespace(moving=moving))
    bare: Any = SimpleNamespace(tree=SimpleNamespace(below=below, above=[-1, 0, 1]))
    assert _parts_a_bone(draft, bare, 1) is parts


def test_a_leg_is_not_sure_to_begin_where_a_bone_as_long_leads_on_into_it() -> None:
    """Before, a crooked twist joint was surely the hip of such a leg without names."""
    places = ((0.1, 0.95, 0), (0.1, 0.74, -0.025), (0.1, 0.5, 0.05), (0.1, 0.1, -0.02), (0.1, 0.03, 0.12))
    leg = line("thigh.L part.L shin.L foot.L toe.L", "hips", *places)
    joints = [*TRUNK, *both([*ARM, *leg])]
    assert wrong(joints, recognise(rig_with(joints, named=False))) == []


def test_the_wings_of_a_bird_without_names_are_not_surely_arms() -> None:
    """Before, wings without a joint before the first, or after the third, surely were."""
    trunk = line(
        "hips spine chest neck head",
        "",
        *((0, y, z) for y, z in ((1, 0), (1.04, 0.15), (1.12, 0.45), (1.22, 0.62), (1.55, 0.86))),
    )
    tail = line("tail1 tail2", "hips", (0, 0.97, -0.2), (0, 0.95, -0.3))
    leg = line(
        "thigh.L shin.L ankle.L foot.L toe.L",
        "hips",
        (0.13, 0.95, 0),
        (0.16, 0.62, 0.2),
        (0.16, 0.3, -0.12),
        (0.16, 0.05, 0.03),
        (0.16, 0.02, 0.16),
    )
    wing = line("a.L b.L c.L", "chest", (0.13, 1.02, 0.6), (0.42, 1.1, 0.55), (0.8, 1.12, 0.6))
    (bird,) = recognise(rig_with([*trunk, *tail, *both([*wing, *leg])], named=False)).characters
    assert {chain.kind for chain in bird.limbs if chain.is_sure} == {"leg"}


@pytest.mark.parametrize("lower", [0.0, 0.005])
def test_an_arm_in_line_with_a_clavicle_of_two_bones_is_not_surely_another(lower: float) -> None:
    """As in MakeHuman's T-pose, all bones as long. Before, it surely went from the clavicle to a twist joint
    and from there to the hand, if the second bone stands a little lower."""
    names = "clavicle.L clavicle_2.L upper_arm.L part.L forearm.L part_2.L hand.L"
    along = (0.04, 0.115, 0.243, 0.368, 0.494, 0.605, 0.716)
    places = [(x, 1.4, 0.0) for x in along]
    places[:2] = [(along[0], 1.385, 0.0), (along[1], 1.4 - lower, 0.0)]
    joints = [*TRUNK, *both([*line(names, "chest", *places), *LEG]), *FINGERS]
    assert wrong(joints, recognise(rig_with(joints, named=False))) == []


@pytest.mark.parametrize("arms", [True, False])
def test_ears_where_a_nameless_trunk_ends_are_no_arms(arms: bool) -> None:
    """Of a body that has none, they were called arms, sure at 0.94, and got IK."""
    ear = line("ear.L ear_2.L ear_3.L", "head", (0.08, 1.75, 0), (0.2, 1.9, 0.01), (0.3, 1.75, 0.02))
    body = [*TRUNK, *both([*(ARM if arms else ()), *LEG, *ear])]
    (character,) = recognise(rig_with(body, named=False)).characters
    sure = {body[joint][0] for chain in character.sure_chains if chain.kind == "arm" for joint in chain.bend}
    assert sure == ({name for name, _, _ in both(ARM) if "clavicle" not in name} if arms else set())
