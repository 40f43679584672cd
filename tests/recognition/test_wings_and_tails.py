"""Bodies without names that have wings, arms over four legs, or a tail that lies askew: what is in front."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from recognition_bodies.skeletons import ARM, HORSE, MAN, Joint, both, line, rig_with

from rigtri.model.content import Content
from rigtri.model.mesh import Mesh
from rigtri.recognition.layout import Character
from rigtri.recognition.recognise import recognise


def found(joints: list[Joint]) -> tuple[Character, dict[str, str]]:
    """The character of joints whose names it does not see, and where each chain begins to bend."""
    (character,) = recognise(rig_with(joints, named=False)).characters
    return character, {chain.name: joints[chain.bend[0]][0] for chain in character.chains if chain.bend}


def turned(joints: list[Joint], ahead: float) -> list[Joint]:
    return [(name, above, (ahead * x, y, ahead * z)) for name, above, (x, y, z) in joints]


@pytest.mark.parametrize("ahead", [1.0, -1.0])
def test_wings_begin_behind_arms(ahead: float) -> None:
    """Before, the longer pair were the arms, and the others nothing."""
    parts = [joint for joint in MAN if not joint[0].startswith(("clavicle", "upper", "fore", "hand"))]
    arm = line(
        "upper_arm.L forearm.L hand.L", "chest", (0.17, 1.45, 0), (0.2, 1.2, -0.02), (0.21, 0.96, 0.05)
    )
    wing = line(
        "wing1.L wing2.L wing3.L", "chest", (0.06, 1.5, -0.12), (0.4, 1.75, -0.25), (0.95, 1.7, -0.35)
    )
    character, bends = found(turned([*parts, *both(arm), *both(wing)], ahead))
    assert bends["left arm"] == "upper_arm.L"
    assert bends["right arm"] == "upper_arm.R"
    wings = [chain for chain in character.chains if chain.kind == "wing"]
    assert sorted((chain.side, chain.is_sure) for chain in wings) == [("left", False), ("right", False)]


def test_what_hangs_beside_front_legs_is_a_pair_of_wings() -> None:
    """Before, it was a pair of arms, as a centaur has."""
    wing = line("wing1.L wing2.L wing3.L", "chest", (0.15, 1.5, 0.5), (0.6, 2.0, 0.3), (1.4, 2.0, 0.0))
    character, _ = found([*HORSE, *both(wing)])
    kinds = [chain.kind for chain in character.chains if chain.bend]
    assert [kinds.count("leg"), kinds.count("wing"), kinds.count("arm")] == [4, 2, 0]


@pytest.mark.parametrize("thumb", [False, True])
def test_wings_of_a_bird_that_end_in_feathers_are_not_sure_arms(thumb: bool) -> None:
    """Before, feathers were fingers, and wings without names arms at 0.94."""
    body = line("pelvis spine chest", "", (0, 0.4, -0.1), (0, 0.44, 0.05), (0, 0.47, 0.2))
    body += line("neck head beak", "chest", (0, 0.55, 0.3), (0, 0.62, 0.38), (0, 0.61, 0.48))
    wing = line("coracoid.L humerus.L ulna.L", "chest", (0.04, 0.48, 0.2), (0.1, 0.5, 0.2), (0.4, 0.52, 0.14))
    wing += line("manus.L", "ulna.L", (0.75, 0.53, 0.2))
    tips = [(1.0, 0.53, 0.2), (0.98, 0.53, 0.12), (0.95, 0.53, 0.05)]
    for number, tip in enumerate(tips[: 2 + thumb]):
        wing += line(f"feather{number}.L", "manus.L", tip)
    leg = line("thigh.L shin.L foot.L", "pelvis", (0.08, 0.36, -0.05), (0.1, 0.22, 0.06), (0.1, 0.04, 0.0))
    for number, aside in enumerate((-0.03, 0.0, 0.03)):
        leg += line(f"claw{number}.L", "foot.L", (0.1 + aside, 0.0, 0.1))
    character, bends = found([*body, *both(wing), *both(leg)])
    assert bends["left leg"] == "thigh.L"
    wings = [chain for chain in character.chains if chain.kind in ("arm", "wing")]
    assert len(wings) == 2
    assert not any(chain.is_sure for chain in wings)


def test_arms_of_a_centaur_may_be_as_short_as_those_of_a_person() -> None:
    """Before, they had to be as long as 60 % of a horse's legs."""
    man = [joint for joint in ARM if "finger" not in joint[0]]
    trunk = line("waist ribs crown", "chest", (0, 1.6, 0.7), (0, 1.8, 0.7), (0, 2.2, 0.72))
    horse = [joint for joint in HORSE if joint[0] not in ("neck", "head", "muzzle")]
    arms = [
        (name, "ribs" if above == "chest" else above, (0.8 * x, y + 0.4, z + 0.7))
        for name, above, (x, y, z) in man
    ]
    names = {name: f"man_{name}" for name, _, _ in arms}
    arms = [(names[name], names.get(above, above), place) for name, above, place in arms]
    _, bends = found([*horse, *trunk, *both(arms)])
    assert {bends.get("left arm"), bends.get("right arm")} == {"man_upper_arm.L", "man_upper_arm.R"}


def test_a_tail_whose_box_lies_across_its_bones_is_no_broad_head() -> None:
    """Before, an animal that stands askew had its head where its tail is, and its legs were sure."""
    askew = np.radians(30.0)
    across, along = np.array([np.cos(askew), 0, -np.sin(askew)]), np.array([np.sin(askew), 0, np.cos(askew)])
    body = line("pelvis spine chest", "", (0, 0.4, -0.5), (0, 0.41, 0.0), (0, 0.4, 0.5))
    body += line("neck head jaw", "chest", (0, 0.42, 0.56), (0, 0.45, 0.72), (0, 0.42, 0.78))
    body += line("t1 t2 t3 t4", "pelvis", *((0, 0.42 + 0.02 * k, -0.6 - 0.35 * k) for k in range(4)))
    for over, z in (("pelvis", -0.5), ("chest", 0.5)):
        leg = [(0.15, 0.38, z), (0.45, 0.4, z + 0.1), (0.5, 0.03, z)]
        body += both(line(f"u{over}.L l{over}.L f{over}.L", over, *leg))
    rig = rig_with(
        [(name, over, tuple(across * x + along * z + [0, y, 0])) for name, over, (x, y, z) in body],
        named=False,
    )
    joints = [k for k, (name, _, _) in enumerate(body) if name[0] == "t" or name in ("neck", "head")]
    ends = {name: k for k, (name, _, _) in enumerate(body)}
    after = {"t1": "t2", "t2": "t3", "t3": "t4", "neck": "head", "head": "jaw"}
    points, moved = [], []
    for joint in joints:
        start = rig.world[joint, 3, :3]
        end = rig.world[ends[after[body[joint][0]]], 3, :3] if body[joint][0] in after else start
        for place in (start, end):
            points += [place + across * 0.02, place - across * 0.02]
            moved += [[joint], [joint]]
    mesh = Mesh("body", -1, np.array(points), 0, np.array(moved), np.ones((len(moved), 1)))
    (character,) = recognise(replace(rig, content=Content(read_outlines=partial(list, [mesh])))).characters
    right = float(np.dot(character.facing, along)) > 0.9
    assert right or not any(limb.is_sure for limb in character.limbs)


@pytest.mark.parametrize(("left", "right"), [("Left", "Right"), ("Lt", "Rt"), ("chrL", "chrR")])
def test_wings_with_words_of_arms_behind_a_glued_side_are_wings(left: str, right: str) -> None:
    """Before, those of ``Leftwing_arm`` were a second pair of arms, at 0.92."""
    wing = line(
        "wing_arm.L wing_forearm.L wing_hand.L",
        "chest",
        (0.06, 1.5, -0.12),
        (0.4, 1.75, -0.25),
        (0.9, 1.7, -0.3),
    )
    wings = both([*wing, ("feather_1.L", "wing_hand.L", (1.1, 1.6, -0.4))])
    called = {
        name: {"L": left, "R": right}[name[-1]] + name[:-2] if name[-2:] in (".L", ".R") else name
        for name, _, _ in wings
    }
    joints = [*MAN, *((called[name], called.get(above, above), at) for name, above, at in wings)]
    (character,) = recognise(rig_with(joints)).characters
    kinds = [chain.kind for chain in character.chains if chain.bend]
    assert [kinds.count("arm"), kinds.count("leg"), kinds.count("wing")] == [2, 2, 2]
