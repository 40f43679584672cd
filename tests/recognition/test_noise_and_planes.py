"""Bodies with noise, narrow ones, and such as sit: what is left and right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import ARM, HORSE, LEG, TRUNK, Joint, both, line, renamed, rig_with

from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.recognition.layout import Character
from rigtri.recognition.recognise import recognise

PERSON = [*TRUNK, *both([*ARM, *LEG])]
# An arm in a line, of which the upper bone is half as long as the lower one; its fingers are one chain.
LONG_ARM = line(
    "clavicle.L upper.L fore.L hand.L finger.L tip.L",
    "chest",
    (0.1, 1.45, 0),
    (0.13, 1.45, 0),
    (0.33, 1.45, 0.01),
    (0.74, 1.45, 0.04),
    (0.86, 1.45, 0.1),
    (0.91, 1.45, 0.12),
)
BELOW_ELBOW = {"fore.L", "hand.L", "finger.L", "tip.L"}


def moved(joints: Sequence[Joint], far: float, seed: int) -> list[Joint]:
    """The joints, each moved by noise of so much (a standard deviation, in file units)."""
    noise = np.random.default_rng(seed).normal(0.0, far, (len(joints), 3)).tolist()
    return [
        (name, above, (x + a, y + b, z + c))
        for (name, above, (x, y, z)), (a, b, c) in zip(joints, noise, strict=True)
    ]


def limbs(joints: Sequence[Joint], *, sure: bool = False) -> dict[tuple[str, str, str], str]:
    """The joints of each limb of a body without names, by kind, side and first joint."""
    found: dict[tuple[str, str, str], str] = {}
    for body in recognise(rig_with(joints, named=False)).characters:
        for chain in body.chains:
            if len(chain.bend) == 3 and (chain.is_sure or not sure):
                found[chain.kind, chain.side, joints[chain.bend[0]][0]] = joints[chain.bend[2]][0]
    return found


@pytest.mark.parametrize("seed", range(8))
def test_noise_of_a_hundredth_of_the_body_hides_no_limb_and_makes_none_sure_that_is_wrong(seed: int) -> None:
    """Before, bones of twins were too unlike, and of every third such body nothing was found."""
    expected = {
        (kind, {"L": "left", "R": "right"}[side], f"{start}.{side}"): f"{end}.{side}"
        for kind, start, end in (("arm", "upper_arm", "hand"), ("leg", "thigh", "foot"))
        for side in "LR"
    }
    noisy = moved(PERSON, 0.017, seed)
    assert limbs(noisy) == expected
    assert limbs(noisy, sure=True).items() <= expected.items()


def robot(back: float) -> list[Joint]:
    """A robot on four legs, half as wide as long, which stand at corners. back: how far knees are behind."""
    joints: list[Joint] = [("base", "", (0.0, 0.35, 0.0))]
    for place, z in (("front", 0.19), ("rear", -0.19)):
        names = " ".join(f"{place}_{part}.L" for part in ("hip", "thigh", "calf", "foot"))
        joints += both(
            line(names, "base", (0.05, 0.35, z), (0.13, 0.35, z), (0.13, 0.2, z - back), (0.13, 0.02, z))
        )
    return joints


@pytest.mark.parametrize("seed", range(6))
def test_legs_of_a_robot_are_paired_across_it_and_it_looks_away_from_its_knees(seed: int) -> None:
    """Before, lines from a front leg to hind ones, of its side and the other, made front and hind left and
    right; and where it looks was from the pair that the file has first to the other."""
    joints = moved(robot(0.15), 0.003, seed)
    given = [joints, [joints[0], *joints[9:], *joints[1:9]]][seed % 2]
    (found,) = recognise(rig_with(given, named=False)).characters
    assert found.facing[2] > 0.98
    legs = [chain for chain in found.chains if chain.kind == "leg"]
    assert len(legs) == 4
    for chain in legs:
        start = given[chain.bend[0]][0]
        assert (chain.side == "left") == start.endswith("L")
        assert chain.name.endswith("front leg") == start.startswith("front")


def sitting() -> list[Joint]:
    """An animal that sits: its trunk rises, its hind legs are folded, its front ones stand on the ground."""
    at = (0, 0.33, -0.55), (0, 0.69, -0.23), (0, 1.04, 0.1), (0, 1.18, 0.22), (0, 1.41, 0.45)
    trunk = line("hips spine chest neck head", "", *at)
    front = line(
        "upper_arm.L forearm.L hand.L", "chest", (0.15, 0.92, 0.22), (0.15, 0.54, 0.18), (0.15, 0.09, 0.21)
    )
    hind = line(
        "thigh.L shin.L foot.L toe.L",
        "hips",
        (0.12, 0.27, -0.53),
        (0.15, 0.3, -0.23),
        (0.15, 0.1, -0.48),
        (0.15, 0.04, -0.3),
    )
    tail = line("tail0 tail1", "hips", (0, 0.35, -0.62), (0, 0.33, -0.7))
    return [*trunk, *tail, *both([*front, *hind])]


def test_front_legs_of_an_animal_that_sits_are_no_sure_arms() -> None:
    """Before, they were arms at 0.94."""
    assert not any(kind == "arm" for kind, _, _ in limbs(sitting(), sure=True))


def test_wings_of_a_skeleton_without_a_skin_are_found() -> None:
    """Before, what moves no points was a control, also where nothing moves any."""
    wing = line("wing_1.L wing_2.L wing_3.L", "chest", (0.05, 1.4, -0.1), (0.5, 1.6, -0.3), (1.0, 1.3, -0.4))
    rig = replace(rig_with([*PERSON, *both(wing)]), skins=())
    (found,) = recognise(rig).characters
    assert sides(found, "wing") == ["left", "right"]


def sides(body: Character, kind: str) -> list[str]:
    return sorted(chain.side for chain in body.chains if chain.kind == kind)


def sure(joints: Sequence[Joint]) -> dict[str, str]:
    """The joints of the sure limbs of a body whose names say so, by the names of the limbs."""
    (found,) = recognise(rig_with(joints)).characters
    chains = (chain for chain in found.chains if chain.bend and chain.is_sure)
    chains = (chain for chain in chains if chain.evidence[0].startswith("its names"))
    return {chain.name: " ".join(joints[k][0] for k in chain.bend) for chain in chains}


@pytest.mark.parametrize(
    ("front", "hind", "upper", "lower", "foot"),
    [
        ("Vorderbein", "Hinterbein", "oben", "unten", "Huf"),
        ("patte_av", "patte_ar", "haut", "bas", "sabot"),
        ("pata_delantera", "pata_trasera", "superior", "inferior", "pezuna"),
        ("zampa_anteriore", "zampa_posteriore", "superiore", "inferiore", "zoccolo"),
    ],
)
def test_legs_of_animals_have_names_in_other_languages(
    front: str, hind: str, upper: str, lower: str, foot: str
) -> None:
    """Before, none of them said which leg it is, or where along it a joint stands."""
    names = {"clavicle": "x", "upper_arm": f"{front}_{upper}", "forearm": f"{front}_{lower}"}
    names |= {"hand": f"{front}_{foot}", "thigh": f"{hind}_{upper}", "shin": f"{hind}_{lower}"}
    names |= {"foot": f"{hind}_{foot}", "toe": "y", "finger": "z"}
    expected = {
        f"{side} {place} leg": " ".join(f"{leg}_{part}_{side[0].upper()}" for part in (upper, lower, foot))
        for side in ("left", "right")
        for place, leg in (("front", front), ("hind", hind))
    }
    assert sure(renamed(HORSE, names, ("_L", "_R"))) == expected


@pytest.mark.parametrize("sides", [("L", "R"), ("fl", "fr"), ("lf", "rt")])
def test_twins_are_known_by_all_that_says_a_side(sides: tuple[str, str]) -> None:
    """Before, only letters and words of left and right made twins of branches whose bones are not alike."""
    legs = renamed([*TRUNK, *both(LEG)], {}, (f"_{sides[0]}", f"_{sides[1]}"))
    odd = [
        (name, above, (x, y - 0.15, z))
        if name in (f"shin_{sides[1]}", f"foot_{sides[1]}")
        else (name, above, (x, y, z))
        for name, above, (x, y, z) in legs
    ]
    found = limbs_by_name(odd)
    assert [found[start] for start in (f"thigh_{side}" for side in sides)] == [
        f"foot_{side}" for side in sides
    ]


def limbs_by_name(joints: Sequence[Joint]) -> dict[str, str]:
    """The last joint of each leg that was found, by its first one."""
    (found,) = recognise(rig_with(joints)).characters
    legs = (chain for chain in found.chains if chain.kind == "leg" and len(chain.bend) == 3)
    return {joints[leg.bend[0]][0]: joints[leg.bend[2]][0] for leg in legs}


def test_no_limb_begins_at_a_twist_joint_that_noise_has_moved_off_its_bone() -> None:
    """Before, beyond 25° it was an upper arm, and surely."""
    arm = line(
        "collar.L ShldrBend.L ShldrTwist.L ForearmBend.L Hand.L",
        "chest",
        (0.04, 1.45, 0),
        (0.16, 1.45, 0),
        (0.29, 1.5, 0),
        (0.44, 1.45, -0.005),
        (0.7, 1.45, 0),
    )
    found = sure([*TRUNK, *both([*arm, *LEG])])
    assert not any("Twist" in joints for joints in found.values())
    assert found["left arm"] == "ShldrBend.L ForearmBend.L Hand.L"


@pytest.mark.parametrize("seed", range(6))
def test_noise_makes_no_elbow_of_a_joint_within_a_bone(seed: int) -> None:
    """Before, of bones in two pieces a joint that was 6° off was taken for an elbow."""
    parted = line(
        "clavicle.L upper_arm.L a.L forearm.L b.L hand.L",
        "chest",
        (0.04, 1.45, 0),
        (0.16, 1.45, 0),
        (0.3, 1.4, 0),
        (0.44, 1.35, 0),
        (0.56, 1.3, 0.05),
        (0.68, 1.25, 0.1),
    )
    arms = {
        key: end
        for key, end in limbs(moved([*TRUNK, *both([*parted, *LEG])], 0.004, seed)).items()
        if key[0] == "arm"
    }
    assert arms == {("arm", "left", "upper_arm.L"): "hand.L", ("arm", "right", "upper_arm.R"): "hand.R"}


@pytest.mark.parametrize("seed", [5, 14, 30, 33, 35, 41])
def test_of_counted_joints_that_noise_may_take_for_each_other_none_is_sure(seed: int) -> None:
    """Before, the elbow was one too early or too late, surely, in a tenth of such arms."""
    names = "shoulder.L arm_0.L arm_1.L arm_2.L arm_3.L arm_4.L arm_5.L arm_end.L"
    arm = [(0.16 + 0.093 * k, 1.45 - 0.03 * k, 0.012 * max(0, k - 3)) for k in range(7)]
    joints = line(names, "chest", (0.03, 1.45, 0), *arm)
    found = sure(moved([*TRUNK, *both([*joints, *LEG])], 0.012, seed))
    right = {
        f"{side} arm": f"arm_0.{side[0]} arm_3.{side[0]} arm_end.{side[0]}".upper()
        for side in ("left", "right")
    }
    assert all(found.get(name, joints).upper() == joints for name, joints in right.items())


@pytest.mark.parametrize("arms", ["upper_arm.L forearm.L hand.L", "x.L y.L z.L"])
def test_who_sits_in_a_file_with_another_up_is_no_sure_animal(arms: str) -> None:
    """Before, the arms of a driver in a file with z up were front legs, surely, also with names of arms."""
    at = (0, 0, 0.98), (0, 0, 1.1), (0, 0, 1.3), (0, 0, 1.5), (0, -0.02, 1.61)
    arm = line(
        f"clavicle.L {arms}",
        "chest",
        (0.03, -0.03, 1.45),
        (0.15, 0, 1.48),
        (0.27, -0.1, 1.2),
        (0.3, -0.4, 1.2),
    )
    leg = line("thigh.L shin.L foot.L", "hips", (0.1, 0, 0.9), (0.12, -0.43, 0.88), (0.13, -0.45, 0.52))
    rig = rig_with([*line("hips spine chest neck head", "", *at), *both([*arm, *leg])])
    chains = [chain for body in recognise(rig).characters for chain in body.chains]
    assert not any(
        chain.kind == "leg" and chain.is_sure and "arm" in rig.names[chain.bend[0]] for chain in chains
    )
    assert not any(
        chain.kind == "leg" and chain.is_sure and rig.names[chain.bend[0]][0] == "x" for chain in chains
    )


@pytest.mark.parametrize(("degrees", "is_sure"), [(0, False), (30, False), (100, True)])
def test_clips_that_bend_an_elbow_far_show_that_no_noise_has_chosen_it(degrees: float, is_sure: bool) -> None:
    """Before, straight arms whose twins have other lengths were not sure, whatever their clips did."""
    arms = both(LONG_ARM)
    longer = [(name, above, (x + 0.03 * (name in BELOW_ELBOW), y, z)) for name, above, (x, y, z) in arms]
    joints = [*TRUNK, *longer, *both(LEG)]
    rig, row = rig_with(joints, named=False), [name for name, _, _ in joints]
    turn = from_axis_angle(np.array([0.0, 1.0, 0.0]), np.radians(degrees))
    still = np.array([0.0, 0.0, 0.0, 1.0])
    keys = np.stack([still, turn, still, turn])
    tracks = (
        Track(row.index(name), "rotation", "LINEAR", np.arange(4.0), keys) for name in ("fore.L", "fore.R")
    )
    (found,) = recognise(replace(rig, clips=(Clip("wave", tuple(tracks)),))).characters
    arm = {chain.side: chain for chain in found.limbs if chain.kind == "arm"}
    assert {side: row[chain.bend[1]] for side, chain in arm.items()} == {"left": "fore.L", "right": "fore.R"}
    assert [chain.is_sure for chain in arm.values()] == [is_sure] * 2
