"""Groups that stand where a bone begins, pieces of bones, and names that several joints have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from recognition_bodies.skeletons import FINGERS, FLAT, HORSE, MAN, TRUNK, Joint, both, line, rig_with

from rigtri.maths.scalar_vector import Vector
from rigtri.recognition import recognise as module
from rigtri.recognition.arms_legs import AGREED
from rigtri.recognition.arms_on_the_ground import arm_below_a_lying_trunk, arm_called_front
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.found_limb import Found
from rigtri.recognition.guessed_hierarchy import lost_third, out_of_order
from rigtri.recognition.joint_tree import Tree, segments_of
from rigtri.recognition.limb_triples import _cosines, triple_of
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.name_parsing import parse_name
from rigtri.recognition.name_readings import limb_names
from rigtri.recognition.names_of_several import named_twice
from rigtri.recognition.shape_doubts import later_start
from rigtri.recognition.split_bones import split_bone

# What Assimp writes above each joint of an FBX file.
MARKS = ("_$AssimpFbx$_Translation", "_$AssimpFbx$_PreRotation")
ASSIMP = [*MAN, *FINGERS]
HANDS = {name[-1]: at for name, _, at in MAN if name.startswith("hand")}


def held(joints: Sequence[Joint], *bones: str) -> list[Joint]:
    """The joints, with a group in the place of each of these bones, above it."""
    found: list[Joint] = []
    for name, above, at in joints:
        if name.partition(".")[0] in bones:
            found.append((f"{name}_grp", above, at))
            above = f"{name}_grp"
        found.append((name, above, at))
    return found


def drafted(joints: Sequence[Joint], **known: Any) -> Any:
    """What doubts ask of a draft."""
    rig = rig_with(joints)
    own = known.pop("own", False)
    tree = Tree(rig, list(range(len(rig))), rig.world[:, 3, :3], list(rig.parents) if own else None)
    words = {node: limb_words(name) for node, name in enumerate(rig.names)}
    base = {
        "shape": SimpleNamespace(body=None),
        "segments": frozenset[int](),
        "reading": None,
        "up": Vector(0.0, 1.0, 0.0),
    }
    return SimpleNamespace(tree=tree, words=words, **{**base, **known})


def limb(draft: Draft, kind: Any, names: str, **known: Any) -> Found:
    joints = tuple(draft.tree.rig.names.index(name) for name in names.split())
    return Found(kind, "left", joints, (), 0.9, known.pop("evidence", ()), **known)


@pytest.mark.parametrize("bones", [(), ("thigh",), ("upper_arm",), ("clavicle", "upper_arm", "thigh")])
def test_limbs_without_names_begin_at_the_bone_and_not_at_its_group(bones: tuple[str, ...]) -> None:
    """Before, each leg began at the group above its thigh, at 0.94."""
    joints = held(MAN, *bones)
    (found,) = module.recognise(rig_with(joints, named=False)).characters
    bent = {tuple(joints[k][0] for k in each.bend) for each in found.limbs if each.is_sure}
    arms = {(f"upper_arm.{s}", f"forearm.{s}", f"hand.{s}") for s in "LR"}
    assert bent == {(f"thigh.{s}", f"shin.{s}", f"foot.{s}") for s in "LR"} | arms


@pytest.mark.parametrize("named", [False, True])
def test_limbs_end_at_the_joint_that_moves_points_and_not_at_groups_above_it(named: bool) -> None:
    """Before, arms ended at ``hand.L_$AssimpFbx$_Translation``, at 0.94, and a hand was all of one finger."""
    groups = {name: [name + mark for mark in MARKS] for name, above, _ in ASSIMP if above}
    joints = [
        (each, (["", *ways][k] or above), at)
        for name, above, at in ASSIMP
        for ways in [[*groups.get(name, []), name]]
        for k, each in enumerate(ways)
    ]
    names = [name for name, _, _ in joints]
    moves = np.array(["$" not in name and name != "head" for name in names])
    rig = rig_with(joints, named=named)
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moves),))
    (found,) = module.recognise(rig).characters
    bent = {tuple(names[k] for k in each.bend) for each in found.limbs if each.is_sure}
    arms = {(f"upper_arm.{s}", f"forearm.{s}", f"hand.{s}") for s in "LR"}
    assert bent == {(f"thigh.{s}", f"shin.{s}", f"foot.{s}") for s in "LR"} | arms
    held = {names[k] for each in groups.values() for k in map(names.index, each)}
    roles = {names[part.joint]: part.role for part in found.parts}
    assert {name for name, role in roles.items() if role == "helper"} == held


def test_of_ends_that_move_no_points_the_group_is_the_upper_one_where_others_are_held() -> None:
    """Before, arms without names ended at the group above the hand, at 0.94."""
    joints = held(MAN, "hand", "forearm", "upper_arm")
    names = [name for name, _, _ in joints]
    bones = {name for name, _, _ in MAN}
    moves = np.array([name in bones and not name.startswith("hand") for name in names])
    rig = rig_with(joints, named=False)
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moves),))
    (found,) = module.recognise(rig).characters
    ends = {names[each.bend[2]] for each in found.limbs if each.kind == "arm"}
    assert ends == {"hand.L", "hand.R"}


def test_an_empty_joint_below_a_bone_in_its_place_is_none() -> None:
    """Before, a thigh without a name began at that, at 0.94."""
    thighs = {f"thigh.{s}": f"null.{s}" for s in "LR"}
    joints: list[Joint] = []
    for name, over, at in MAN:
        joints.append((name, thighs.get(over, over), at))
        joints += [(thighs[name], name, at)] if name in thighs else []
    names = [name for name, _, _ in joints]
    rig = rig_with(joints, named=False)
    moves = np.array(["null" not in name for name in names])
    (found,) = module.recognise(replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moves),))).characters
    assert {names[each.bend[0]] for each in found.limbs if each.kind == "leg"} == set(thighs)


@pytest.mark.parametrize(
    "names",
    [
        "leg foot toe arm hand fingers",
        "leg foot foot_end arm hand hand_end",
        "thigh foot ball upperarm hand fingers",
        "UpLeg Foot ToeBase Arm Hand HandEnd",
    ],
)
def test_a_hand_or_foot_is_no_elbow_or_knee_of_limbs_of_one_bone(names: str) -> None:
    """Before, ``leg``, ``foot`` and ``toe`` were hip, knee and ankle, at 0.94."""
    leg, foot, toe, arm, hand, fingers = (f"{name}.L" for name in names.split())
    legs = line(f"{leg} {foot} {toe}", "hips", (0.1, 0.9, 0), (0.1, 0.4, 0.02), (0.1, 0.03, 0.25))
    arms = line(f"{arm} {hand} {fingers}", "chest", (0.2, 1.4, 0), (0.5, 1.38, 0), (0.75, 1.36, 0.05))
    (found,) = module.recognise(rig_with([*TRUNK, *both([*legs, *arms])])).characters
    assert not [each for each in found.limbs if each.is_sure]


def test_a_bone_without_weight_is_no_group_above_what_has_its_weight() -> None:
    joints = [(name, above, at) for name, above, at in MAN]
    joints = [*joints, *((f"skin_{k}", f"hand.{s}", at) for k, (s, at) in enumerate(HANDS.items()))]
    names = [name for name, _, _ in joints]
    rig = rig_with(joints)
    moves = np.array([not name.startswith("hand") for name in names])
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moves),))
    (found,) = module.recognise(rig).characters
    ends = {names[each.bend[2]] for each in found.limbs if each.kind == "arm"}
    assert ends == {"hand.L", "hand.R"}


@pytest.mark.parametrize(
    ("name", "side", "place"),
    [
        ("frElbow_L_JNT", "left", "front"),
        ("frElbow_R_JNT", "right", "front"),
        ("leg_FR", "right", "front"),
        ("fl_lleg", "left", "front"),
        ("R_blKnee", "right", "hind"),
    ],
)
def test_a_side_that_stands_by_itself_counts_before_that_of_a_corner(
    name: str, side: str, place: str
) -> None:
    """``fr`` may be front as well as front right: before, the left front leg was the right one, at 0.99."""
    assert (parse_name(name).side, limb_words(name).place) == (side, place)


@pytest.mark.parametrize(
    ("names", "held"),
    [
        ("lowerarm_l_offset_100 lowerarm_l_101", True),
        ("lowerarm_l_offset lowerarm_l", True),
        ("lowerarm_l_offset_100 upperarm_l_101", False),
        ("lowerarm_l_100 lowerarm_l_101", False),
    ],
)
def test_a_group_holds_the_joint_below_it_whatever_their_numbers_are(names: str, *, held: bool) -> None:
    """Before, an offset numbered by its exporter was the elbow, at 0.99."""
    joints = [*TRUNK, ("arm_l", "chest", (0.2, 1.4, 0)), *line(names, "arm_l", (0.4, 1.4, 0), (0.4, 1.4, 0))]
    draft = drafted([*joints, ("hand_l", names.split()[1], (0.6, 1.4, 0))])
    assert (draft.tree.rig.names.index(names.split()[0]) in segments_of(draft.tree)) == held


# The horse as a file has it that parents hands and feet to the root.
LOOSE = [(n, "pelvis" if n[:4] in ("hand", "foot") else above, at) for n, above, at in HORSE]


@pytest.mark.parametrize(
    ("joints", "evidence", "doubt"),
    [(LOOSE, (), True), (LOOSE, (AGREED,), False), (FLAT, (), False)],
)
def test_arms_that_end_as_low_as_legs_below_a_trunk_that_lies_may_be_front_legs(
    joints: list[Joint], evidence: tuple[str, ...], *, doubt: bool
) -> None:
    """Before, front legs with the names of a Biped's arms were sure arms, at 0.97."""
    draft = drafted(joints)
    arm = limb(draft, "arm", "upper_arm.L forearm.L hand.L", evidence=evidence)
    leg = limb(draft, "leg", "thigh.L shin.L foot.L")
    assert bool(arm_below_a_lying_trunk(draft, arm, [arm, leg])) == doubt
    assert not arm_below_a_lying_trunk(draft, leg, [arm, leg])


@pytest.mark.parametrize(("end", "doubt"), [("front_paw.L", True), ("hand.L", False)])
def test_an_arm_of_which_a_joint_is_called_a_front_one_may_be_a_front_leg(end: str, *, doubt: bool) -> None:
    """Before, front legs of a lizard were sure arms, at 0.94, where noise had lost its hind legs."""
    draft = drafted([(n.replace("hand.L", end), above.replace("hand.L", end), at) for n, above, at in HORSE])
    assert bool(arm_called_front(draft, limb(draft, "arm", f"upper_arm.L forearm.L {end}"))) == doubt


@pytest.mark.parametrize(
    ("body", "right", "hind", "doubt"),
    [(MAN, "rt", "", False), (MAN, "rf", "", False), (HORSE, "rf", "lb rb", True), (HORSE, "rf", "", False)],
)
def test_lf_is_front_left_only_beside_legs_behind(
    body: list[Joint], right: str, hind: str, *, doubt: bool
) -> None:
    """Before, the arms of a man with ``rf_hand`` were called front legs, and were not sure."""

    def renamed(name: str) -> str:
        plain, _, side = name.partition(".")
        behind = hind.split() if plain in ("thigh", "shin", "foot") else []
        sides = behind or ["lf", right]
        return f"{sides[side == 'R']}_{plain}" if side else name

    draft = drafted([(renamed(name), renamed(above), at) for name, above, at in body])
    draft.words = limb_names(draft.tree.rig, draft.tree.nodes, None)
    for side in ("lf", right):
        arm = limb(draft, "arm", f"{side}_upper_arm {side}_forearm {side}_hand")
        assert bool(arm_called_front(draft, arm)) == doubt


@pytest.mark.parametrize(("other", "doubt"), [("leg_c_1_L", True), ("leg_c_1_R", False), ("leg_c_4_L", 0)])
def test_joints_that_are_counted_as_others_are_make_no_sure_limb(other: str, *, doubt: bool) -> None:
    """Before, joints of three legs of a crab that has no hierarchy were one leg, at 0.85."""
    legs = [(f"leg_b_{k}_L", "hips", (0.2 * k, 0.4, 0.1 * k)) for k in (1, 2, 3)]
    draft = drafted([*TRUNK, *legs, (other, "hips", (0.5, 0.2, 0.3))], own=True)
    leg = limb(draft, "leg", "leg_b_1_L leg_b_2_L leg_b_3_L")
    assert bool(named_twice(draft, leg, [leg])) == doubt


@pytest.mark.parametrize(("above", "doubt"), [("hips", True), ("leg_b_L_001", False)])
def test_a_piece_of_a_bone_that_nothing_follows_is_no_sure_middle(above: str, *, doubt: bool) -> None:
    """Before, a leg bent at a piece of its upper bone, and its own shin was its end, at 0.78."""
    leg = line("leg_b_L leg_b_L_001", "hips", (0.1, 0.9, 0), (0.2, 1, 0))
    draft = drafted([*TRUNK, *leg, ("leg_c_L", above, (0.3, 1, 0))])
    assert bool(split_bone(draft, limb(draft, "leg", "leg_b_L leg_b_L_001 leg_c_L"))) == doubt


def pair_of(draft: Draft, at: tuple[int, int, int], names: str, **known: Any) -> Any:
    path = [draft.tree.rig.names.index(name) for name in names.split()]
    size = sum(draft.tree.bone[k] for k in path[at[0] + 1 : at[2] + 1])
    paths = SimpleNamespace(paths=(path, path), above=0, nodes=frozenset(path))
    return SimpleNamespace(pair=paths, at=at, size=size, named=0.0, **known)


@pytest.mark.parametrize("bones", [(), ("shoulder", "upper_arm"), ("forearm", "hand")])
def test_a_front_leg_may_begin_below_its_blade_also_with_a_group_at_each_joint(
    bones: tuple[str, ...],
) -> None:
    """Before, groups hid the joint within the upper bone, and the leg began at the blade, at 0.94."""
    front = [
        *line("shoulder.L upper_arm.L", "chest", (0.1, 1.5, 0.65), (0.2, 1.2, 0.7)),
        *line("forearm.L hand.L", "upper_arm.L", (0.2, 0.85, 0.55), (0.2, 0.42, 0.65)),
    ]
    joints = held([*HORSE[:7], *front], *bones)
    names = [name for name, _, _ in joints if ".L" in name]
    at = [names.index(name) for name in ("shoulder.L", "forearm.L", "hand.L")]
    draft = drafted(joints)
    pair = pair_of(draft, (at[0], at[1], at[2]), " ".join(names))
    draft.shape = SimpleNamespace(body=SimpleNamespace(form="quadruped", arms=pair, legs=None))
    leg = limb(draft, "leg", "shoulder.L forearm.L hand.L", pair=pair)
    assert "in its upper bone may be where it begins" in later_start(draft, leg)


@pytest.mark.parametrize(
    ("sides", "other", "doubt"),
    [
        (("_izq", "_der"), "tibia_izq", True),  # sides that names do not tell
        ((".L", ".R"), "tibia.L", True),
        ((".L", ".R"), "tibia.R", False),
        ((".L", ".R"), "hind_tibia.L", False),  # of another leg
    ],
)
def test_a_bone_of_a_limb_of_two_joints_may_be_elsewhere_in_any_language(
    sides: tuple[str, str], other: str, *, doubt: bool
) -> None:
    front = "front_" if other.startswith("hind") else ""
    start, end = (f"{front}{word}{sides[0]}" for word in ("femur", "tarsus"))
    leg = line(f"{start} {end}", "hips", (0.1, 0.9, 0), (0.1, 0.1, 0))
    draft = drafted([*TRUNK, *leg, (other, "hips", (0.3, 0.5, 0))])
    found = limb(draft, "leg", f"{start} {end}")
    assert (f"'{other}' is called as a joint" in lost_third(draft, found, [found])) == doubt


def flat_body(aside: float, at: tuple[int, int, int]) -> tuple[Any, Found]:
    """A body whose file has no hierarchy and no names, with a further joint aside, and its left leg."""
    draft = drafted([*MAN, ("more", "chest", (aside, 1.4, -0.1))], own=True)
    legs = pair_of(draft, at, "thigh.L shin.L foot.L toe.L")
    arms = pair_of(draft, (1, 2, 3), "clavicle.L upper_arm.L forearm.L hand.L")
    for pair, top in ((legs, "thigh.R"), (arms, "clavicle.R")):
        pair.pair.paths = pair.pair.paths[0], draft.tree.branch(draft.tree.rig.names.index(top))
    plane = SimpleNamespace(side_of=lambda point: point.x)
    draft.shape = SimpleNamespace(
        body=SimpleNamespace(form="biped", legs=legs, arms=arms), limbs=[], plane=plane
    )
    joints = tuple(legs.pair.paths[0][k] for k in (0, 1, 2))
    return draft, Found("leg", "left", joints, (), 0.9, (), pair=legs)


_NOT_SAID = "names do not say which joint follows which"


@pytest.mark.parametrize(
    ("aside", "at", "doubt"),
    [
        (0.0, (0, 1, 2), False),
        (0.5, (0, 1, 2), True),  # a wing beside the body need not be a limb that bends
        (0.0, (2, 3, 4), True),  # a leg does not begin two joints from where it hangs
    ],
)
def test_without_hierarchy_and_names_a_leg_may_go_through_joints_beside_it(
    aside: float, at: tuple[int, int, int], *, doubt: bool
) -> None:
    """Before, legs of flat angels, and legs that went through hands beside the hips, were sure."""
    draft, leg = flat_body(aside, (0, 1, 2))
    if leg.pair is not None:
        leg = replace(leg, pair=SimpleNamespace(**{**vars(leg.pair), "at": at}))  # type: ignore[arg-type]
    assert ("names do not say which joint follows which" in out_of_order(draft, leg)) == doubt


@pytest.mark.parametrize("legs", [0.94, 0.6])
def test_a_tail_by_its_shape_is_no_surer_than_the_legs(legs: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, the tail of what may be no animal was sure, at 0.8."""
    monkeypatch.setattr(module, "agreed", lambda _, limbs: [replace(each, confidence=legs) for each in limbs])
    (character,) = module.recognise(rig_with(HORSE, named=False)).characters
    (tail,) = [chain for chain in character.chains if chain.kind == "tail"]
    assert tail.confidence == pytest.approx(min(0.8, legs))


@pytest.mark.parametrize("hands", [True, False])
def test_a_pair_that_ends_in_hands_is_listed_as_arms_of_any_body(*, hands: bool) -> None:
    """Before, a mermaid without names was no character: nothing shows which arm is the left one."""
    fish = [each for each in MAN if each[0].partition(".")[0] not in ("thigh", "shin", "foot", "toe")]
    layout = module.recognise(rig_with([*fish, *(FINGERS if hands else [])], named=False))
    arms = [chain for body in layout.characters for chain in body.chains if chain.kind == "arm"]
    assert [chain.is_sure for chain in arms] == [False, False] * hands


def test_two_joints_that_noise_sets_apart_bend_as_one() -> None:
    """Before, a knee of two joints was none, and the leg had no bend."""
    leg = line("thigh.L shin.L helper.L foot.L", "hips", (0.1, 0.9, 0), (0.1, 0.5, 0.1), (0.102, 0.5, 0.099))
    tree: Any = drafted([*TRUNK, *leg, ("foot.L", "helper.L", (0.1, 0.1, 0))]).tree
    path = [tree.rig.names.index(name) for name in ("thigh.L", "shin.L", "helper.L", "foot.L")]
    found = triple_of(tree, [path], [], {})
    assert found is not None
    assert found.at == (0, 2, 3)
    assert _cosines(tree, path)[1] == 1.0
