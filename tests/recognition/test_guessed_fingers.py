"""Which finger each is where no name says it: by knuckles and first bones, which a fist does not exchange."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from posed_bodies import FINGERS, Pose, posed_body
from recognition_bodies.skeletons import ARM, LEG, TRUNK, Joint, both, line, rig_with
from rigs import rig_of

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition.finger_bends import Curl, curl_of, mean_of_pair
from rigtri.recognition.hand_hinges import _PosedHand
from rigtri.recognition.hands_feet import _like_fingers
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_ends import thumb_of
from rigtri.recognition.limb_triples import _cosines
from rigtri.recognition.recognise import recognise
from rigtri.recognition.thumb_bends import SIMILAR_BEND


@pytest.mark.parametrize("curl", [0.0, 35.0, 70.0])
@pytest.mark.parametrize("hands", [1.0, 1.5])
@pytest.mark.parametrize("metacarpals", [False, True])
def test_a_fist_has_its_thumb_where_an_open_hand_has_it(curl: float, hands: float, metacarpals: bool) -> None:
    body = posed_body(Pose("none", curl=curl, hands=hands, metacarpals=metacarpals))
    (character,) = recognise(body.rig).characters
    known = {chain.name: chain.joints[0] for chain in character.chains if chain.kind == "finger"}
    first = 0 if metacarpals else 1
    for side in ("left", "right"):
        expected = {f"{side} {finger} finger": body.parts[f"{side} {finger} {first}"] for finger in FINGERS}
        assert known.items() >= (expected | {f"{side} thumb": body.parts[f"{side} thumb 1"]}).items()


@pytest.mark.parametrize(
    "curled", [("index",), ("little",), ("index", "middle", "ring"), ("middle", "ring", "little")]
)
def test_signs_that_a_hand_makes_leave_its_thumb_a_thumb(curled: tuple[str, ...]) -> None:
    """A thumb may begin within the breadth of the knuckles. Before, a finger was taken for it."""
    chains, places = list[list[int]](), [np.zeros(3)]
    for finger, z in zip(FINGERS, (4.0, 1.3, -1.3, -4.0), strict=True):
        bends = np.radians([75.0, 160.0] if finger in curled else [0.0, 0.0])
        bones = [(np.cos(bend), -np.sin(bend), 0.0) for bend in bends]
        steps = [(9.0, 0.2, z), *(np.multiply(bone, 4.0) for bone in bones)]
        chains.append([len(places) + k for k in range(3)])
        places += list(np.cumsum(steps, axis=0))
    chains.append([len(places) + k for k in range(3)])
    at = np.array([*places, (2.0, -0.4, 3.6), (5.2, -1.6, 5.7), (7.6, -2.5, 7.3)])
    rig = rig_of([f"bone {k}" for k in range(len(at))], [-1, *[0] * (len(at) - 1)], at)
    assert thumb_of(Tree(rig, range(len(at)), at), 0, chains) == len(FINGERS)


@pytest.mark.parametrize("names", ["none", "unreal", "mixamo"])
@pytest.mark.parametrize("ends", [False, True])
def test_the_first_phalanx_follows_a_metacarpal(names: str, ends: bool) -> None:
    """Before, metacarpals were called proximal, and `rename-joints` and `conform` named them so."""
    body = posed_body(Pose(names, metacarpals=True, ends=ends))
    (character,) = recognise(body.rig).characters
    bones = {joint: bone for bone, joint in character.bones.items()}
    for finger, bone in zip(FINGERS, ("Index", "Middle", "Ring", "Little"), strict=True):
        called = [bones.get(body.parts[f"left {finger} {k}"]) for k in range(4)]
        assert called == [None, *(f"left{bone}{part}" for part in ("Proximal", "Intermediate", "Distal"))]


@pytest.mark.parametrize("names", ["none", "mixamo"])
@pytest.mark.parametrize("metacarpals", [False, True])
def test_where_a_finger_ends_is_none_of_its_joints(names: str, metacarpals: bool) -> None:
    """Before, that of one with a metacarpal was, and `check` left such fingers out."""
    body = posed_body(Pose(names, metacarpals=metacarpals, ends=True))
    (character,) = recognise(body.rig).characters
    fingers = [k for k in character.chains if k.kind == "finger" and "thumb" not in k.name]
    assert {len(finger.joints) for finger in fingers} == {4 if metacarpals else 3}


def test_a_mitten_of_one_numbered_finger_is_what_its_scheme_says() -> None:
    found = _fingers_called(Pose("none", fingers=1, thumb=False), "Bip01 {s} Finger{n1}{b}", "")
    assert {name for name, _ in found.values()} == {"left index finger"}


@pytest.mark.parametrize("slots", [False, True])
def test_the_mitten_of_a_short_arm_may_be_longer_than_its_lower_bone(slots: bool) -> None:
    """Before, the mitten was something held, and the thumb all of the hand."""
    body = posed_body(Pose("none", short=0.5, hands=1.2, fingers=1, ends=True, slots=slots))
    (character,) = recognise(body.rig).characters
    known = {chain.name: chain.joints[0] for chain in character.chains if chain.kind == "finger"}
    for side in ("left", "right"):
        assert known[f"{side} thumb"] == body.parts[f"{side} thumb 1"]
        assert known[f"{side} finger"] == body.parts[f"{side} index 1"]


def test_what_is_held_is_no_finger() -> None:
    """A joint without weight in the hand, of which no name says what it is."""
    body = posed_body(Pose("none", slots=True, curl=10.0))
    (character,) = recognise(body.rig).characters
    fingers = [chain for chain in character.chains if chain.kind == "finger"]
    assert {chain.name for chain in fingers if chain.side == "left"} == {
        "left thumb",
        *(f"left {finger} finger" for finger in FINGERS),
    }
    assert not {joint for chain in fingers for joint in chain.joints}.intersection(body.sockets)


@pytest.mark.parametrize("curl", [0.0, 30.0])
def test_four_fingers_without_a_thumb_are_not_called_after_one(curl: float) -> None:
    body = posed_body(Pose("none", curl=curl, thumb=False))
    (character,) = recognise(body.rig).characters
    fingers = [chain for chain in character.chains if chain.kind == "finger"]
    assert len(fingers) == 8
    assert {chain.name for chain in fingers} == {"left finger", "right finger"}


@pytest.mark.parametrize("names", ["mixamo", "none"])
def test_a_body_that_sits_with_straight_legs_is_upright(names: str) -> None:
    body = posed_body(Pose(names, seated=88.0, arms=20.0))
    (character,) = recognise(body.rig).characters
    assert character.up == pytest.approx((0, 1, 0), abs=1e-3)
    assert character.facing == pytest.approx((0, 0, 1), abs=1e-3)


@pytest.mark.parametrize("short", [0.7, 0.85])
def test_arms_of_nameless_bodies_end_where_five_fingers_begin(short: float) -> None:
    """Short arms before big hands look like clavicle and upper arm before a lower arm."""
    body = posed_body(Pose("none", short=short, hands=1.5, elbow=20.0, curl=20.0))
    (character,) = recognise(body.rig).characters
    arms = {chain.side: chain for chain in character.limbs if chain.kind == "arm"}
    for side in ("left", "right"):
        parts = [body.parts[f"{side} {part}"] for part in ("upper arm", "lower arm", "hand")]
        assert list(arms[side].bend) == parts
        assert arms[side].is_sure


def _fingers_called(pose: Pose, finger: str, thumb: str) -> dict[str, tuple[str, float]]:
    """What the fingers of the left hand are known as, of names with {s} for the side, {n}, {n1} and {n2} for
    the number of the finger, and {k} and {b} for that of the joint."""
    body = posed_body(pose)
    names = list(body.rig.names)
    for part, node in body.parts.items():
        side, _, rest = part.partition(" ")
        kind, _, k = rest.rpartition(" ")
        if kind in (*FINGERS, "thumb") and k != "0":
            pattern = thumb if kind == "thumb" else finger
            n = (*FINGERS, "thumb").index(kind)
            names[node] = pattern.format(
                s=side[0].upper(), n=n, n1=n + 1, n2=n + 2, k=int(k) - 1, b=k.replace("1", "")
            )
    (character,) = recognise(replace(body.rig, names=tuple(names))).characters
    first = {node: part for part, node in body.parts.items()}
    return {
        first[chain.joints[0]].rsplit(" ", 1)[0]: (chain.name, chain.confidence)
        for chain in character.chains
        if chain.kind == "finger" and chain.side == "left"
    }


@pytest.mark.parametrize(
    ("finger", "thumb"),
    [
        ("finger_{s}{n}_{k}_jnt", "thumb_{s}0_{k}_jnt"),  # mGear
        ("finger_{s}{n1}_{k}_jnt", "thumb_{s}0_{k}_jnt"),
        ("Bip01 {s} Finger{n}{b}", "Bip01 {s} Thumb{b}"),
        ("finger_{s}{n1}_{k}", "finger_{s}0_{k}"),  # 3ds Max Biped
        ("Bip01 {s} Finger{n2}{b}", "Bip01 {s} Finger1{b}"),
    ],
)
@pytest.mark.parametrize(
    "pose", [Pose("none"), Pose("none", metacarpals=True, curl=30.0), Pose("none", fingers=2)]
)
def test_numbered_fingers_begin_at_the_index_where_the_thumb_has_a_word(
    pose: Pose, finger: str, thumb: str
) -> None:
    found = _fingers_called(pose, finger, thumb)
    expected = {f"left {one}": f"left {one} finger" for one in FINGERS[: pose.fingers]}
    assert {part: name for part, (name, _) in found.items()} == {**expected, "left thumb": "left thumb"}
    assert min(sure for _, sure in found.values()) >= 0.75


@pytest.mark.parametrize(("joints", "thumb"), [(2, 0), (3, -1)])
def test_of_two_fingers_that_begin_alike_the_one_of_fewer_joints_is_the_thumb(
    joints: int, thumb: int
) -> None:
    """A finger of three joints ahead, and one of two or three aside."""
    aside = [[0.0, 0.1 + 0.03 * k, 0.0] for k in range(joints)]
    ahead = [[0.1 + 0.03 * k, 0.0, 0.0] for k in range(3)]
    places = np.array([[0.0, 0.0, 0.0], *aside, *ahead])
    names = [f"bone {k}" for k in range(len(places))]
    rig = rig_of(names, [-1, *[0] * (len(places) - 1)], places)
    chains = [range(1, joints + 1), range(joints + 1, len(places))]
    assert thumb_of(Tree(rig, range(len(places)), places), 0, chains) == thumb


def test_a_thumb_without_fingers_or_of_one_joint_says_nothing_of_the_side_that_closes() -> None:
    at = np.array([[0.0, 0, 0], [1, 0, 0], [0.2, 0, -0.5], [0.2, 0, -1]])

    def side(thumb: list[int], fingers: list[list[int]]) -> float:
        hand: Any = SimpleNamespace(thumb=thumb, fingers=fingers, at=at, along=np.array([1.0, 0, 0]))
        return _PosedHand._side_of_thumb(hand, np.array([0.0, 1, 0]))

    assert side([2, 3], [[1]]) > 0
    assert side([3], [[1]]) == side([2, 3], []) == side([], []) == 1.0
    at[3] = [0.2, 0, 1]
    assert side([2, 3], [[1]]) < 0


def test_a_finger_and_a_thumb_that_begin_at_one_place_show_no_palm() -> None:
    """As of CMU's mocap. Before, the noise between them was the palm, and every run turned the hand anew."""
    at = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [1.2, 0, 0], [1, 1e-16, 0]])
    joints, lines, arm = (1, 2, 3, 4), [(2, 3)], at[1] - at[0]
    hand = _PosedHand(joints, lines, (4,), 1, arm, at, natural=None, is_left=True, guessed=False)
    assert hand.palm(hand.curl, is_own=False) is None
    at[4, 1] = 0.1
    apart = _PosedHand(joints, lines, (4,), 1, arm, at, None, True, False)
    assert apart.palm(hand.curl, is_own=False) is not None


def test_two_hands_that_are_bent_alike_count_with_their_mean_bend() -> None:
    x, y = np.array([1.0, 0, 0]), np.array([0.0, 1, 0])
    one = Curl(x, 0.5, 0.75, 1.0, 3.0)
    alike, other = Curl(y, 0.5 + SIMILAR_BEND / 2, 0.25, 0.0, 1.0), Curl(y, 0.5 + SIMILAR_BEND * 2, 0.25)
    mean = (0.5 + SIMILAR_BEND / 4, 0.5, 0.5, 2.0)
    found = mean_of_pair([one, alike])
    assert [each[1:] for each in found] == [pytest.approx(mean)] * 2
    assert [each.hinge is hinge for each, hinge in zip(found, (x, y), strict=True)] == [True, True]
    for curls in ([one, other], [one], [one, alike, one], []):
        assert mean_of_pair(curls) == curls


def test_bends_of_a_path_are_cosines_and_none_at_ends_or_above_bones_without_length() -> None:
    tree: Any = SimpleNamespace(
        at=[Vector(5, 1, 0), Vector(6, 1, 0), Vector(6, 3, 0), Vector(6, 3, 0), Vector(5, 3, 0)]
    )
    assert _cosines(tree, [0, 1, 2]) == [1.0, 0.0, 1.0]
    assert _cosines(tree, [0, 1]) == [1.0, 1.0]
    assert _cosines(tree, [0, 1, 4]) == [1.0, pytest.approx(-(5.0**-0.5)), 1.0]
    assert _cosines(tree, [1, 2, 3, 4]) == [1.0, 1.0, 0.0, 1.0]
    assert _cosines(tree, [2, 3, 4]) == [1.0, 1.0, 1.0]


@pytest.mark.parametrize(
    ("sizes", "spread", "alike"),
    [
        ([3, 3, 3, 3, 2], False, True),
        ([3, 3, 3, 3], False, True),
        ([3, 3, 3], False, False),  # below four joints of a hand
        ([3, 3, 2, 2], False, False),  # most of them have fewer joints
        ([3, 3, 3, 9], False, False),  # no finger has so many
        ([3, 3, 3, 3], True, False),  # and they go the same way
    ],
)
def test_chains_like_fingers_have_three_joints_and_go_one_way(
    sizes: list[int], spread: bool, alike: bool
) -> None:
    at, chains = [Vector()], list[list[int]]()
    for number, size in enumerate(sizes):
        turn = number * np.pi / 2 if spread else 0.1 * number
        chains.append([])
        for step in range(1, size + 1):
            chains[-1].append(len(at))
            at.append(Vector(step * float(np.cos(turn)), step * float(np.sin(turn)), 0))
    tree = SimpleNamespace(below={0: [chain[0] for chain in chains]}, at=at)
    draft: Any = SimpleNamespace(tree=tree)
    assert _like_fingers(draft, 0, chains) is alike


@pytest.mark.parametrize("seed", range(4))
def test_of_two_fingers_that_is_the_index_to_which_the_thumb_points(seed: int) -> None:
    """Thumbs begin below both: before, noise of 2 mm said which is nearer, and half of the hands opened."""
    random = np.random.default_rng(seed)
    thumb = [(0.725, 1.438, 0.022), (0.752, 1.422, 0.054), (0.772, 1.41, 0.078)]
    hand = line("thumb1.L thumb2.L thumb3.L", "hand.L", *thumb)
    for name, z in (("index", 0.028), ("middle", 0.008)):
        hand += line(f"{name}1.L {name}2.L", "hand.L", (0.79, 1.45, z), (0.83, 1.45, z))
    body = [*TRUNK, *both([*ARM, *hand, *LEG])]
    joints: list[Joint] = []
    for name, above, at in body:
        x, y, z = (np.array(at) + 0.0012 * random.normal(size=3)).tolist()
        joints.append((name, above, (x, y, z)))
    (character,) = recognise(rig_with(joints, named=False)).characters
    place = {chain.name: joints[chain.joints[0]][0] for chain in character.chains if chain.kind == "finger"}
    found = place["left index finger"], place["right index finger"]
    assert found == ("index1.L", "index1.R")


def test_fingers_in_one_place_show_no_curl() -> None:
    """Before, numpy warned of the width of nothing."""
    shown = curl_of([(0, 1, 2), (3, 4, 5)], 6, np.zeros((7, 3)), None)
    assert np.isnan(shown.hinge).all()
    assert shown.height == 0.0
