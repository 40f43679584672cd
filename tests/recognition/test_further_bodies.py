"""Insects, machines, wings and long snouts: what their names and shapes say of limbs and trunk."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from recognition_bodies.population import population
from recognition_bodies.skeletons import ARM, HORSE, LEG, MAN, TRUNK, Joint, both, line, rig_with
from recognition_bodies.truth import nameless

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.layout import Character
from rigtri.recognition.many_legs import _named_ends
from rigtri.recognition.recognise import recognise

# Heights and depths of a centaur's legs, from the top.
FRONT = [(1.1, 0.7), (0.75, 0.55), (0.42, 0.58), (0.05, 0.57)]
HIND = [(1.1, -0.6), (0.75, -0.45), (0.42, -0.72), (0.05, -0.63)]


def insect(pairs: int, joints: int, feelers: bool, name: str) -> list[Joint]:
    """Legs at a thorax, which look alike; ``name`` with the number of the pair, the side and the joint."""
    body: list[Joint] = [("thorax", "", (0, 0.35, 0)), ("abdomen", "thorax", (0, 0.38, -0.3))]
    body.append(("head", "thorax", (0, 0.35, 0.25)))
    if feelers:
        body += both(line("f1.L f2.L", "head", (0.03, 0.4, 0.38), (0.12, 0.5, 0.55)))
    steps = [(0.1, 0.33), (0.4, 0.68), (0.75, 0.23), (0.85, 0.01)][4 - joints :]
    for pair in range(pairs):
        turn = 0.5 - pair / (pairs - 1)
        for side, sign in (("L", 1), ("R", -1)):
            names = " ".join(name.format(pair=pair + 1, side=side, joint=k + 1) for k in range(joints))
            places = [(sign * (0.08 + far), high, 0.3 * turn + turn * far) for far, high in steps]
            body += line(names, "thorax", *places)
    return body


def legs(found: Character) -> list[tuple[str, bool]]:
    return [(chain.side, chain.is_sure) for chain in found.chains if chain.kind == "leg"]


@pytest.mark.parametrize("name", ["leg{pair}_{side}_{joint}", "{side}_Leg_{pair}_0{joint}"])
@pytest.mark.parametrize("joints", [3, 4])
@pytest.mark.parametrize("pairs", [3, 4])
def test_legs_of_an_insect_that_are_only_counted_are_all_sure(pairs: int, joints: int, name: str) -> None:
    """Before, at most one pair was, and auto refused the body."""
    (found,) = recognise(rig_with(insect(pairs, joints, feelers=pairs == 3, name=name))).characters
    assert sorted(legs(found)) == [("left", True)] * pairs + [("right", True)] * pairs


@pytest.mark.parametrize(("pairs", "words"), [(3, "front middle hind"), (4, "front second third hind")])
def test_legs_of_an_insect_are_told_apart_by_their_order(pairs: int, words: str) -> None:
    """Before, all of a side had one name, so that a check of axes looked at one of them alone."""
    rig = rig_with(insect(pairs, 3, False, "leg{pair}_{side}_{joint}"))
    (found,) = recognise(rig).characters
    named = {chain.name: rig.names[chain.joints[0]] for chain in found.chains if chain.kind == "leg"}
    places = [(side, word) for side in ("left", "right") for word in words.split()]
    numbers = [f"leg{pair + 1}_{side}_1" for side in "LR" for pair in range(pairs)]
    assert named == dict(zip([f"{side} {word} leg" for side, word in places], numbers, strict=True))
    assert not any(chain.is_front for chain in found.chains)


@pytest.mark.parametrize("root", [False, True])
@pytest.mark.parametrize("pairs", [3, 4, 5])
def test_spiders_with_legs_of_two_joints_have_all_of_them(pairs: int, *, root: bool) -> None:
    """Before, some pairs were legs, and the body one on two legs or four that faced another way."""
    body = [joint for joint in insect(pairs, 4, False, "leg{pair}_{joint}_{side}") if "_3_" not in joint[0]]
    body = [joint for joint in body if "_4_" not in joint[0]]
    if root:  # on the ground, below all knees
        body = [("root", "", (0, 0, 0)), *((name, over or "root", at) for name, over, at in body)]
    (found,) = recognise(rig_with(body)).characters
    assert found.form == "creature"
    assert found.facing == (0.0, 0.0, 1.0)
    assert sorted(legs(found)) == [("left", True)] * pairs + [("right", True)] * pairs
    names = [chain.name for chain in found.chains if chain.kind == "leg"]
    assert len(set(names)) == len(names) == 2 * pairs


def test_noise_of_a_trunk_of_one_joint_is_no_abdomen() -> None:
    """What names call left decides. Before, 0.002 of a leg told surely which end was behind."""
    body = insect(4, 3, False, "leg{pair}_{joint}_{side}")
    turned = [(name, over, (-x, y, -z)) for name, over, (x, y, z) in body if name not in ("abdomen", "head")]
    trunk = [("root", "", (0, 0, -0.002)), ("thorax", "root", (0, 0.35, 0.001))]
    (found,) = recognise(rig_with([*trunk, *turned[1:]])).characters
    assert found.facing == pytest.approx((0, 0, -1), abs=0.01)


def test_feelers_beside_the_middle_are_no_abdomen() -> None:
    """Before, the trunk was as long in front as behind, and no side was given."""
    body = insect(3, 3, feelers=True, name="{side}{pair}{joint}")
    (found,) = recognise(rig_with(body, named=False)).characters
    assert found.facing == (0.0, 0.0, 1.0)
    assert sorted(legs(found)) == [("left", False)] * 3 + [("right", False)] * 3


def test_words_of_upper_and_lower_bones_make_the_limbs_of_a_mech_sure() -> None:
    """Arms end in guns, and what follows their barrels is long; legs have an upper, middle and lower bone."""
    joints = [
        *TRUNK,
        *both(
            [
                *line(
                    "ArmUpper.L ArmLower.L Gun.L Muzzle.L",
                    "chest",
                    (0.2, 1.4, 0),
                    (0.26, 1.1, -0.04),
                    (0.27, 0.9, 0.15),
                    (0.27, 0.9, 0.6),
                ),
                *line(
                    "LegUpper.L LegMiddle.L LegLower.L Foot.L",
                    "hips",
                    (0.13, 0.9, 0),
                    (0.14, 0.65, 0.2),
                    (0.14, 0.35, -0.2),
                    (0.14, 0.08, 0),
                ),
            ]
        ),
    ]
    rig = rig_with(joints)
    rig = replace(rig, attachment=np.zeros(len(rig), dtype=np.int64))
    limbs = [chain for chain in recognise(rig).chains if chain.kind in ("arm", "leg")]
    assert {(chain.name, *(rig.names[k] for k in chain.bend)) for chain in limbs if chain.is_sure} == {
        (f"{side} {kind}", *(f"{name}.{side[0].upper()}" for name in names.split()))
        for kind, names in (("arm", "ArmUpper ArmLower Gun"), ("leg", "LegUpper LegMiddle LegLower"))
        for side in ("left", "right")
    }


def test_an_arm_that_ends_in_a_gun_is_an_arm() -> None:
    guns = [
        *TRUNK,
        *both(line("arm_a.L arm_b.L gun.L", "chest", (0.2, 1.4, 0), (0.26, 1.1, -0.04), (0.27, 0.9, 0.15))),
        *both(line("leg_a.L leg_b.L foot.L", "hips", (0.1, 0.95, 0), (0.1, 0.5, 0.06), (0.1, 0.1, -0.02))),
    ]
    (found,) = recognise(rig_with(guns)).characters
    names = [name for name, _, _ in guns]
    sure = {chain.name: [names[k] for k in chain.bend] for chain in found.chains if chain.is_sure}
    assert sure["left arm"] == ["arm_a.L", "arm_b.L", "gun.L"]
    assert sure["right leg"] == ["leg_a.R", "leg_b.R", "foot.R"]


def test_a_wing_whose_joints_are_called_as_those_of_an_arm_is_one_though_its_hand_is_long() -> None:
    """Before, its first bone might have been a clavicle, and auto refused the bird."""
    places = ((0.1, 1.5, 0.12), (0.14, 1.42, -0.05), (0.14, 1.5, 0.08), (0.12, 1.4, -0.12))
    bird = [*TRUNK, *both(line("humerus.L radius.L carpus.L feathers.L", "chest", *places))]
    bird += both(line("femur.L tibiotarsus.L tarsometatarsus.L toes.L", "hips", *(k[2] for k in LEG)))
    (found,) = recognise(rig_with(bird)).characters
    names = [name for name, _, _ in bird]
    sure = {chain.name: [names[k] for k in chain.bend] for chain in found.chains if chain.is_sure}
    assert sure["left arm"] == ["humerus.L", "radius.L", "carpus.L"]
    assert sure["right leg"] == ["femur.R", "tibiotarsus.R", "tarsometatarsus.R"]


def test_legs_that_names_put_in_front_are_front_legs_however_high_they_end() -> None:
    def counted(name: str) -> str:
        part, _, side = name.partition(".")
        back, front = ("thigh", "shin", "foot", "toe"), ("upper_arm", "forearm", "hand", "finger")
        for which, parts in (("BackLeg", back), ("FrontLeg", front)):
            if part in parts:
                return f"{which}_{side}_{parts.index(part) + 1}"
        return name

    short = [joint for joint in HORSE if joint[0].partition(".")[0] != "finger"]
    horse = [(counted(name), counted(above), place) for name, above, place in short]
    (found,) = recognise(rig_with(horse)).characters
    assert found.form == "quadruped"
    assert {chain.name for chain in found.chains if chain.kind == "leg" and chain.is_sure} == {
        *("left front leg", "right front leg", "left hind leg", "right hind leg")
    }


def test_a_wing_that_rises_above_a_bowed_head_is_no_neck() -> None:
    bowed = [joint for joint in MAN if joint[0] not in ("neck", "head")]
    bowed += line("neck head", "chest", (0, 1.42, 0.1), (0, 1.46, 0.2))
    wing = line(
        "w1.L w2.L w3.L w4.L", "chest", (0.02, 1.45, -0.1), (0.5, 2, -0.15), (1.2, 2.2, -0.1), (1.6, 2, 0)
    )
    (found,) = recognise(rig_with([*bowed, *both(wing)], named=False)).characters
    called = {joint for chain in found.chains if chain.kind in ("neck", "head") for joint in chain.joints}
    assert max(called, default=-1) < len(bowed)


def test_where_a_chain_goes_on_beyond_five_joints_no_head_is_sure() -> None:
    snout = line("s1 s2 s3", "muzzle", (0, 1.9, 1.7), (0, 1.75, 1.75), (0, 1.6, 1.8))
    (found,) = recognise(rig_with([*HORSE, *snout], named=False)).characters
    assert [chain.is_sure for chain in found.chains if chain.kind in ("neck", "head")] == [False, False]


def test_a_centaur_faces_where_its_arms_are() -> None:
    """Its joints hang from the hips of the man. Before, legs deeper in the tree were in front."""
    man = [*TRUNK, *both(ARM)]
    centaur = [(name, over, (x, y + 0.45, z + 0.6)) for name, over, (x, y, z) in man]
    centaur += line("barrel pelvis", "hips", (0, 1.3, 0.1), (0, 1.3, -0.5))
    centaur += both(
        [
            *line("fu.L fl.L fc.L fh.L", "hips", *((0.15, y, z) for y, z in FRONT)),
            *line("bu.L bl.L bc.L bh.L", "pelvis", *((0.15, y, z) for y, z in HIND)),
        ]
    )
    (found,) = recognise(rig_with(centaur, named=False)).characters
    assert found.facing == (0.0, 0.0, 1.0)
    names = [name for name, _, _ in centaur]
    bends = {names[chain.bend[1]]: chain.side for chain in found.chains if chain.bend}
    assert {side for name, side in bends.items() if name.endswith(".L")} == {"left"}
    assert {"fl.L", "bl.L"} <= bends.keys()


def test_limbs_of_a_tree_by_its_names_are_not_sure() -> None:
    """Its branches stand as arms and legs do. Before, they were, and auto set them up."""
    called = {"hips": "root", "spine": "trunk", "chest": "trunk2", "neck": "crown", "head": "twig"}
    bones = sorted({name.partition(".")[0] for name, *_ in MAN if "." in name})
    called |= {bone: f"branch{k}" for k, bone in enumerate(bones)} | {"": ""}

    def tree(name: str) -> str:
        bone, dot, side = name.partition(".")
        return called[bone] + dot + side

    (found,) = recognise(rig_with([(tree(name), tree(over), at) for name, over, at in MAN])).characters
    assert not any(chain.is_sure for chain in found.chains if chain.bend)
    (found,) = recognise(rig_with(MAN, named=False)).characters
    assert len([chain for chain in found.chains if chain.is_sure and chain.bend]) == 4


@pytest.mark.parametrize("pairs", [3, 4])
def test_an_insect_faces_away_from_what_is_called_its_abdomen(pairs: int) -> None:
    """Its head reaches further from the legs. Before, the longer end was behind."""
    places = {"abdomen": (0, 0.36, -0.1), "head": (0, 0.35, 0.5)}
    body = insect(pairs, 4, feelers=False, name="leg{pair}_{joint}_{side}")
    (found,) = recognise(rig_with([(name, over, places.get(name, at)) for name, over, at in body])).characters
    assert found.facing == (0.0, 0.0, 1.0)
    assert sorted(legs(found)) == [("left", True)] * pairs + [("right", True)] * pairs


def test_head_and_abdomen_are_looked_for_by_name_each_in_its_middle() -> None:
    rig = SimpleNamespace(names=("thorax", "head", "head tip", "abdomen"))
    at = [Vector(0, 1, 0), Vector(0, 1, 3), Vector(0, 1, 5), Vector(0, 2, -2)]
    tree: Any = SimpleNamespace(nodes=range(4), rig=rig, at=at)
    assert list(_named_ends(tree, Vector(0, 1, 1))) == [0, -1, 3 + 3]
    rig.names = ("thorax", "head", "head tip", "tail")
    assert list(_named_ends(tree, Vector(0, 1, 1))) == [0, 0, 3]


def test_segments_of_a_bone_are_on_the_way_along_it() -> None:
    """0 - 1 - 2 - 3 - 4, where 2 and 3 are segments of the bone of 1, which a tree leaves out."""
    rig = SimpleNamespace(parents=np.array([-1, 0, 1, 2, 3]))
    tree = SimpleNamespace(rig=rig, way=lambda start, end: [start, 1, end])
    draft: Any = SimpleNamespace(tree=tree, segments=frozenset([2, 3]), groups=frozenset[int]())
    assert Draft.way(draft, 0, 4) == [0, 1, 2, 3, 4]
    draft.segments, draft.groups = frozenset([2]), frozenset([3])
    assert Draft.way(draft, 0, 4) == [0, 1, 2, 4]
    draft.segments = draft.groups = frozenset()
    assert Draft.way(draft, 0, 4) == [0, 1, 4]


FISH = [
    *line("body head jaw", "", (0, 0, 0), (0, 0, 0.3), (0, -0.03, 0.5)),
    *line("tail1 tail2 tail3", "body", (0, 0, -0.2), (0, 0, -0.5), (0, 0, -0.8)),
    *line("dorsal1 dorsal2", "body", (0, 0.1, 0), (0, 0.25, -0.1)),
    *both(
        line(
            "pectoral1.L pectoral2.L pectoral3.L",
            "body",
            (0.1, -0.05, 0.2),
            (0.25, -0.1, 0.15),
            (0.35, -0.12, 0.05),
        )
    ),
    *both(
        line(
            "pelvic1.L pelvic2.L pelvic3.L",
            "body",
            (0.06, -0.1, -0.1),
            (0.12, -0.2, -0.15),
            (0.15, -0.28, -0.22),
        )
    ),
]


@pytest.mark.parametrize("named", [True, False])
def test_fins_that_start_at_one_joint_are_neither_legs_nor_arms(named: bool) -> None:
    """Before, the hind ones were surely legs, though as arms those in front were not sure."""
    for one in recognise(rig_with(FISH, named=named)).characters:
        assert not any(chain.is_sure for chain in one.limbs)


@pytest.mark.parametrize("word", ["", "bone", "twist", "tail", "ear", "helper", "socket"])
def test_one_more_pair_is_no_limb_where_its_names_say_what_a_body_wears(word: str) -> None:
    rig = nameless(next(population(0, "person 9".__eq__)).rig)
    names = list(rig.names)
    for node in (58, 59, 60, 62, 63, 64):
        names[node] = f"{word}_{node}" if word else ""
    found = recognise(replace(rig, names=tuple(names)))
    more = [chain for chain in found.chains if any("one more pair" in each for each in chain.evidence)]
    assert len(more) == (2 if word in ("", "bone") else 0)


def test_a_wing_ends_where_its_fingers_begin() -> None:
    """Before, where noise made one finger its longest line, it surely bent a joint later."""
    wing = line(
        "wing_01.L wing_02.L wing_03.L", "chest", (0.02, 1.4, -0.2), (0.4, 1.45, -0.4), (0.8, 2.1, -0.5)
    )
    wing += line("wing_03_02.L wing_03_03.L", "wing_03.L", (1.27, 1.74, -0.6), (1.19, 1.15, -0.58))
    joints = [*MAN, *both([*wing, ("wing_03_01.L", "wing_03.L", (0.9, 1.85, -0.53))])]
    (found,) = recognise(rig_with(joints)).characters
    wings = [[joints[k][0][:-2] for k in chain.bend] for chain in found.chains if chain.kind == "wing"]
    assert wings == [["wing_01", "wing_02", "wing_03"]] * 2


@pytest.mark.parametrize(
    ("trunk", "spine"),
    [
        ("pelvis belly spine_01 neck_01 head", ["belly", "spine_01"]),
        ("spine_03 spine_02 spine_01 neck head", []),
    ],
    ids=["a joint between", "numbered the other way round"],
)
def test_a_trunk_without_arms_is_what_stands_between_hips_and_neck(trunk: str, spine: list[str]) -> None:
    """Of birds: before, hips aimed at no spine, or the spine was listed against its hierarchy."""
    names = trunk.split()
    joints = line(trunk, "", *((0, 1 + 0.15 * k, 0.1 * k) for k in range(5)))
    legs = [(name, names[0] if over == "hips" else over, place) for name, over, place in LEG]
    (found,) = recognise(rig_with([*joints, *both(legs)])).characters
    shown = [
        [[name for name, _, _ in joints][k] for k in c.joints] for c in found.chains if c.kind == "spine"
    ]
    assert shown == ([spine] if spine else [])


@pytest.mark.parametrize("lost", [1, 3])
@pytest.mark.parametrize("lying", [False, True])
def test_an_insect_of_which_a_pair_is_lost_stands_as_its_other_legs_do(lost: int, lying: bool) -> None:
    """Noise loses a pair. Before, feelers were arms of a body on end, with its legs in wrong order."""
    joints = insect(3, 4, True, "leg{pair}_{side}_{joint}")
    feelers = line("f1.L f2.L f3.L", "head", (0.03, 0.4, 0.38), (0.12, 0.5, 0.5), (0.14, 0.5, 0.65))
    body = [joint for joint in joints if not joint[0].startswith((f"leg{lost}_R", "f1", "f2"))]
    body += both(feelers)
    if lying:
        body = [(name, above, (x, -z, y)) for name, above, (x, y, z) in body]
    (found,) = recognise(rig_with(body)).characters
    up, ahead = (0, 1, 0), (0, 0, 1)
    if lying:
        up, ahead = (0, 0, 1), (0, -1, 0)
    assert found.up == pytest.approx(up, abs=1e-6)
    assert found.facing == pytest.approx(ahead, abs=0.05)


def test_names_part_legs_of_an_insect_that_shape_takes_for_twins() -> None:
    """Before, a right front leg and a left hind one were a pair, where noise had made these more alike."""
    joints = insect(3, 3, False, "leg{pair}_{side}_{joint}")
    start = {name[:6]: place for name, _, place in joints if name.endswith("_1")}
    noisy = []
    for name, above, place in joints:
        size, first = 1.25 if name[:6] in ("leg1_L", "leg3_R") else 1.0, start.get(name[:6], place)
        x, y, z = (a + size * (b - a) for a, b in zip(first, place, strict=True))
        noisy.append((name, above, (x, y, z)))
    rig = rig_with(noisy)
    (found,) = recognise(rig).characters
    named = {chain.name: rig.names[chain.joints[0]] for chain in found.chains if chain.kind == "leg"}
    assert named["left front leg"] == "leg1_L_1"
    assert named["right front leg"] == "leg1_R_1"
    assert found.facing == pytest.approx((0, 0, 1), abs=0.1)
