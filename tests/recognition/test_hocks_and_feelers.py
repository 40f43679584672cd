"""Bodies without names that have hocks, feelers or knees that bend back: where they face."""

from __future__ import annotations

import pytest
from recognition_bodies.skeletons import Joint, both, line, rig_with

from rigtri.recognition.layout import Character
from rigtri.recognition.recognise import recognise


def found(joints: list[Joint]) -> tuple[Character, dict[str, str]]:
    """The character of joints whose names it does not see, and where each chain begins to bend."""
    (character,) = recognise(rig_with(joints, named=False)).characters
    return character, {chain.name: joints[chain.bend[0]][0] for chain in character.chains if chain.bend}


def turned(joints: list[Joint], ahead: float) -> list[Joint]:
    return [(name, above, (ahead * x, y, ahead * z)) for name, above, (x, y, z) in joints]


def bird(toes: list[tuple[float, float]], leg: list[tuple[float, float]]) -> list[Joint]:
    """Hips, a neck that rises, wings; legs of joints at heights and depths, and toes at widths and depths."""
    body = line("hips spine", "", (0, 1.0, 0), (0, 1.12, 0.14))
    body += line("neck head", "spine", (0, 1.2, 0.22), (0, 1.6, 0.35))
    names = ["thigh.L", "shin.L", "foot.L", "heel.L"][: len(leg)]
    limbs = line(" ".join(names), "hips", *((0.1, y, z) for y, z in leg))
    high, deep = leg[-1]
    limbs += [(f"toe{k}.L", names[-1], (0.1 + x, high - 0.03, deep + z)) for k, (x, z) in enumerate(toes)]
    limbs += line("wing1.L wing2.L wing3.L", "spine", (0.05, 1.15, 0.1), (0.4, 1.3, -0.05), (0.9, 1.3, -0.2))
    return [*body, *both(limbs)]


TOES = [(-0.06, 0.1), (0.0, 0.1), (0.06, 0.1), (0.1, -0.12)]


@pytest.mark.parametrize("ahead", [1.0, -1.0])
@pytest.mark.parametrize("toes", [[], TOES])
def test_a_bird_whose_hocks_bend_as_far_as_knees_faces_where_its_knees_point(
    ahead: float, toes: list[tuple[float, float]]
) -> None:
    """Before, hocks were taken for knees and shins for thighs: it faced back, and its legs were sure."""
    character, bends = found(
        turned(bird(toes, [(0.9, 0.0), (0.64, 0.16), (0.36, -0.12), (0.04, 0.0)]), ahead)
    )
    assert character.facing[2] * ahead > 0.9
    assert [bends["left leg"], bends["right leg"]] == ["thigh.L", "thigh.R"]


def test_most_toes_of_a_foot_tell_where_it_points() -> None:
    """Before, the longest did, which is behind: which turned a bird with knees that bend back round."""
    character, _ = found(turned(bird(TOES, [(0.8, 0.0), (0.42, -0.1), (0.04, 0.0)]), -1.0))
    assert character.facing[2] < -0.9 or not any(limb.is_sure for limb in character.limbs)


def test_sides_are_not_sure_where_knees_and_elbows_alone_tell_each_the_other() -> None:
    """A machine whose knees bend back. Before, its limbs were sure, each on the wrong side."""
    body = line("hips torso head", "", (0, 3.0, 0), (0, 3.45, 0), (0, 4.2, 0))
    limbs = line("thigh.L shin.L foot.L", "hips", (0.75, 2.8, 0), (0.75, 1.8, -0.75), (0.75, 0.15, 0.3))
    limbs += line("upper.L fore.L hand.L", "torso", (1.1, 3.9, 0), (1.35, 3.1, -0.1), (1.35, 2.55, 0.6))
    for k in range(2):
        limbs += line(f"claw{k}1.L claw{k}2.L", "hand.L", *((1.2 + 0.3 * k, 2.5, z) for z in (0.85, 1.1)))
    character, bends = found([*body, *both(limbs)])
    assert len(bends) == 4
    assert not any(limb.is_sure for limb in character.limbs)


def insect(abdomen: float, feelers: bool) -> list[Joint]:
    body = [
        ("thorax", "", (0, 0.35, 0)),
        ("head", "thorax", (0, 0.38, 0.3)),
        ("rear", "thorax", (0, 0.37, -abdomen)),
    ]
    if feelers:
        body += both(line("f1.L f2.L f3.L", "head", (0.04, 0.4, 0.37), (0.1, 0.5, 0.55), (0.15, 0.5, 0.75)))
    for pair, turn in enumerate((0.9, 0.1, -0.6)):
        steps = [(0.15, 0.35), (0.5, 0.6), (0.9, 0.05)]
        places = [(far, high, turn * far) for far, high in steps]
        body += both(line(f"a{pair}.L b{pair}.L c{pair}.L", "thorax", *places))
    return body


def test_an_insect_has_its_feelers_in_front_however_long_its_head_is() -> None:
    """Before, it had no sides, and its feelers were arms."""
    character, bends = found(insect(0.27, feelers=True))
    assert character.facing[2] > 0.9
    assert bends["left front leg"] == "a0.L"
    assert not any(chain.kind == "arm" for chain in character.chains)


def test_an_abdomen_of_one_joint_that_is_as_long_as_a_head_tells_no_sides() -> None:
    """Before, one that was shorter by noise turned the insect round."""
    character, _ = found(insect(0.25, feelers=False))
    assert {chain.side for chain in character.chains if chain.kind == "leg"} == {""}
