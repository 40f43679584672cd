"""What was taken for something else before: each kind of body by the numbers of some seeds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from posed_bodies import Pose, posed_body
from recognition_bodies import oddities, seeds
from recognition_bodies.cases import Case
from recognition_bodies.measure import Finding, measure, stands_right
from recognition_bodies.truth import nameless
from rigs import rig_of

from rigtri.maths.matrices import inverse
from rigtri.model.skin import Skin
from rigtri.recognition.layout import Layout
from rigtri.recognition.recognise import recognise


def found(case: Case, *, named: bool) -> tuple[Layout, list[Finding]]:
    """What is recognised, and what came of the limbs."""
    rig = case.rig if named else nameless(case.rig)
    layout = recognise(rig)
    return layout, seeds.of_limbs(measure(rig, case.truth, layout, named=named))


def surely_wrong(make: Callable[[int], Case], numbers: Sequence[int]) -> list[str]:
    """What is sure, and wrong, with names and without."""
    return [
        f"{number}: {one}"
        for number in numbers
        for named in (True, False)
        for one in found(make(number), named=named)[1]
        if one.outcome == "surely wrong"
    ]


@pytest.mark.parametrize("make", [oddities.numbered, oddities.parted], ids=["numbered", "parted"])
def test_parts_and_duplicates_of_bones_are_told_apart(make: Callable[[int], Case]) -> None:
    """``Arm.L.001`` is a forearm where the shape says so, ``ElbowPart1_R`` a part of one."""
    for number in (0, 1, 2, 3, 4, 6, 7):
        _, limbs = found(make(number), named=True)
        right = [one for one in limbs if one.outcome == "right" and round(one.confidence, 2) >= 0.75]
        assert len(right) == 4, (number, [str(one) for one in limbs])


@pytest.mark.parametrize(
    ("make", "numbers"),
    [
        (oddities.bladed, (14, 44, 9, 18, 29)),
        (oddities.armed, range(6)),
        (oddities.symmetric, range(16)),
    ],
    ids=["bladed", "armed", "symmetric"],
)
def test_blades_guns_and_things_are_no_limbs_that_are_sure(
    make: Callable[[int], Case], numbers: Sequence[int]
) -> None:
    assert surely_wrong(make, numbers) == []


def test_a_claw_arm_is_no_neck() -> None:
    for number in range(4):
        case = oddities.clawed(number)
        layout, _ = found(case, named=True)
        heads = [joint for chain in layout.chains if chain.kind in ("neck", "head") for joint in chain.joints]
        assert not [name for k in heads if "claw" in (name := case.rig.names[k].lower())]


def test_a_neck_is_one_whatever_word_all_names_share() -> None:
    """A file's own word, as tools append it to each name, made limbs of neck and head."""
    rig = posed_body(Pose("unreal", arms=90.0)).rig
    rig = replace(rig, names=tuple(f"{name}_arm" for name in rig.names))
    (character,) = recognise(rig).characters
    found = [rig.names[k] for c in character.chains if c.kind in ("neck", "head") for k in c.joints]
    assert found == ["neck_01_arm", "head_arm"]


def test_who_sits_with_legs_stretched_ahead_has_up_along_the_trunk() -> None:
    for number in range(10):
        case = oddities.stretched(number)
        (character,) = found(case, named=True)[0].characters
        assert stands_right(case.truth.characters[0], character) is not False, number


@pytest.mark.ci
def test_toons_with_feet_as_long_as_their_legs_are_not_turned_round() -> None:
    assert surely_wrong(oddities.toon, range(20)) == []
    turned = []
    for number in range(20):
        case = oddities.toon(number)
        (character,) = found(case, named=False)[0].characters
        if stands_right(case.truth.characters[0], character) is False:
            turned.append(number)
    assert turned == []


@pytest.mark.parametrize("fingers", [2, 3])
@pytest.mark.parametrize("spread", [0.5, 0.8, 1.0])
def test_a_middle_finger_whose_palm_bone_begins_nearest_to_the_wrist_is_no_thumb(
    fingers: int, spread: float
) -> None:
    body = posed_body(Pose("none", fingers=fingers, metacarpals=True, spread=spread, arms=60.0))
    parts = {node: part for part, node in body.parts.items()}
    thumbs = [
        parts[chain.joints[0]]
        for chain in recognise(body.rig).chains
        if chain.kind == "finger" and "thumb" in chain.name
    ]
    assert sorted(thumbs) == ["left thumb 1", "right thumb 1"]


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 0, 1, 2), (3, 2, 1, 0)])
def test_an_arm_ends_in_the_middle_of_a_palm_whose_bones_all_begin_at_its_wrist(
    order: tuple[int, ...],
) -> None:
    """In whatever order the file has them; without a hand of their own, and without names."""
    places: dict[str, tuple[float, float, float]] = {
        "hips": (0, 1, 0),
        "spine": (0, 1.2, -0.02),
        "chest": (0, 1.4, 0),
        "neck": (0, 1.55, 0),
        "head": (0, 1.65, 0.02),
        "top": (0, 1.85, 0.02),
    }
    above = {"spine": "hips", "chest": "spine", "neck": "chest", "head": "neck", "top": "head"}
    for s, x in (("L", 1), ("R", -1)):
        for name, (aside, high, ahead), parent in (
            ("thigh", (0.1, 0.95, 0), "hips"),
            ("shin", (0.1, 0.5, 0.02), f"thigh{s}"),
            ("foot", (0.1, 0.08, 0), f"shin{s}"),
            ("toe", (0.1, 0.02, 0.12), f"foot{s}"),
            ("arm", (0.18, 1.45, 0), "chest"),
            ("fore", (0.45, 1.45, -0.02), f"arm{s}"),
        ):
            places[name + s], above[name + s] = (aside * x, high, ahead), parent
        for k in order:
            for j, (out, spread) in enumerate(((0.7, 0.0), (0.79, 1.0), (0.83, 1.2), (0.86, 1.3))):
                places[f"{k}{j}{s}"] = (out * x, 1.45, 0.03 * (k - 1.5) * spread)
                above[f"{k}{j}{s}"] = f"fore{s}" if j == 0 else f"{k}{j - 1}{s}"
    names = list(places)
    parents = [names.index(above[name]) if name in above else -1 for name in names]
    at = np.array([*places.values()])
    local = at - np.where(np.array(parents)[:, np.newaxis] >= 0, at[parents], 0.0)
    rig = rig_of([f"n{k}" for k in range(len(names))], parents, local)
    rig = replace(rig, skins=(Skin("skin", np.arange(len(names)), inverse(rig.world)),))
    ends = {names[chain.bend[2]] for chain in recognise(rig).chains if chain.kind == "arm"}
    assert len(ends) == 2
    assert all(end[0] in "12" for end in ends)
