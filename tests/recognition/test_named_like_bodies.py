"""Rockets, satellites, lamps and trousers, whose parts are called as limbs are; and parts of bodies."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from recognition_bodies.skeletons import HORSE, Joint, Place, both, line, renamed, rig_with

from rigtri.recognition.recognise import recognise

LEG: tuple[Place, ...] = ((0.3, 1.0, 0.0), (0.5, 0.5, 0.04), (0.55, 0.05, 0.0))
ARM: tuple[Place, ...] = ((0.16, 1.45, 0.0), (0.44, 1.45, -0.01), (0.7, 1.45, 0.05))
# What makers call the three joints of a leg, and of an arm.
LEGS = (
    "leg_upper leg_lower leg_foot",
    "thigh shin foot",
    "hip knee ankle",
    "UpLeg Leg Foot",
    "thigh calf foot",
)
ARMS = ("arm_upper arm_lower arm_hand", "upper_arm forearm hand", "shoulder elbow wrist", "arm_1 arm_2 arm_3")


def pair(names: str, root: str, places: Sequence[Place], *before: Place, prefix: str = "") -> list[Joint]:
    """Two limbs that hang at a root; before: where a clavicle is."""
    words = [f"{prefix}{word}" for word in (["clavicle"] if before else []) + names.split()]
    return both(line(" ".join(f"{word}.L" for word in words), root, *before, *places))


def sided(joints: Sequence[Joint]) -> list[Joint]:
    """``leg_upper.L`` as ``leg_L_upper``."""

    def new(name: str) -> str:
        first, _, more = name[:-2].partition("_")
        return "_".join(filter(None, (first, name[-1], more))) if name[-2:] in (".L", ".R") else name

    return [(new(name), new(above), place) for name, above, place in joints]


THINGS: dict[str, tuple[Joint, ...]] = {
    "rocket": (("rocket", "", (0, 2, 0)), ("nose", "rocket", (0, 9, 0))),
    "rocket with a body": (
        ("body", "", (0, 2, 0)),
        ("nose", "body", (0, 9, 0)),
        ("hatch", "body", (0, 4, 1)),
    ),
    "plane": (("body", "", (0, 1, 0)), ("nose", "body", (0, 1, 4)), ("tail", "body", (0, 1.2, -4))),
    "telescope": (("mount", "", (0, 1, 0)), *line("neck head", "mount", (0, 1.4, 0), (0, 1.6, 0.1))),
    "tripod": (
        ("body", "", (0, 1, 0)),
        *line("{0} {1} {2}", "body", (0, 1, -0.3), (0, 0.5, -0.4), (0, 0, -0.5)),
    ),
    "trousers": (("trousers", "", (0, 1, 0)),),
    "trousers with hips": (("trousers", "", (0, 1, 0)), ("hips", "trousers", (0, 1, 0))),
}


@pytest.mark.parametrize("names", LEGS)
@pytest.mark.parametrize("thing", THINGS)
def test_no_leg_of_a_thing_is_sure_that_is_called_as_a_body_s(thing: str, names: str) -> None:
    """Before, those of a rocket and of trousers alone were sure, to 0.97."""
    own = [
        (name.format(*names.split()), above.format(*names.split()), place)
        for name, above, place in THINGS[thing]
    ]
    joints = [*own, *pair(names, own[1][0] if thing == "trousers with hips" else own[0][0], LEG)]
    for called in (joints, sided(joints)):
        assert [
            chain.name for chain in recognise(rig_with(called)).chains if chain.bend and chain.is_sure
        ] == []


@pytest.mark.parametrize("names", ARMS)
@pytest.mark.parametrize("root", ["satellite", "bus", "rail", "jacket"])
def test_no_arm_of_a_thing_is_sure_that_is_called_as_a_body_s(root: str, names: str) -> None:
    joints = [(root, "", (0, 1, 0)), *pair(names, root, ARM), ("jaw", root, (0, 1.2, 0))]
    for called in (joints, sided(joints)):
        assert [
            chain.name for chain in recognise(rig_with(called)).chains if chain.bend and chain.is_sure
        ] == []


def test_all_that_is_called_as_a_garment_is_one() -> None:
    joints = [
        ("trousers_hips", "", (0, 1, 0)),
        *pair("thigh shin foot", "trousers_hips", LEG, prefix="trousers_"),
    ]
    assert [chain.name for chain in recognise(rig_with(joints)).chains if chain.bend and chain.is_sure] == []


@pytest.mark.parametrize("names", ["base hip knee neck head", "base hip knee ankle shade"])
def test_a_lamp_has_no_sure_leg(names: str) -> None:
    """Before, its neck ended the leg, sure to 0.81."""
    joints = line(names, "", (0, 0, 0), (0, 0.1, 0), (0, 0.6, -0.3), (0, 1, 0.2), (0, 0.9, 0.4))
    assert [chain.name for chain in recognise(rig_with(joints)).chains if chain.bend and chain.is_sure] == []


def test_the_wings_of_a_gate_are_no_sure_wings() -> None:
    wing = line("wing.L wing_mid.L wing_end.L", "arch", (0.5, 1, 0), (1.1, 1, 0.5), (1.9, 1, 0.2))
    post = line("post.L post_mid.L post_foot.L", "arch", (0.5, 0.9, 0), (0.55, 0.5, 0.03), (0.5, 0, 0))
    layout = recognise(rig_with([("arch", "", (0, 1, 0)), *both([*wing, *post])]))
    assert [chain.name for chain in layout.chains if chain.is_sure] == []


# Where the limbs of a part of a body hang, and what else it has.
PARTS: dict[str, tuple[list[Joint], str, tuple[Place, ...]]] = {
    "what a player sees": ([("fps_arms_root", "", (0, 1.2, 0))], ARMS[1], ARM),
    "arms with clavicles": ([("soldier", "", (0, 1.2, 0))], ARMS[1], ((0.04, 1.45, 0.0), *ARM)),
    "legs": ([("Root", "", (0, 1, 0))], LEGS[1], LEG),
    "legs with hips": ([("pelvis", "", (0, 1, 0))], LEGS[2], LEG),
    "legs with toes": ([("soldier", "", (0, 1, 0))], f"{LEGS[4]} toe", (*LEG, (0.55, 0.0, 0.12))),
    "hen": (
        [
            ("body", "", (0, 1, 0)),
            *line("neck head crest", "body", (0, 1.2, 0.3), (0, 1.5, 0.4), (0, 1.7, 0.4)),
        ],
        LEGS[1],
        LEG,
    ),
}


@pytest.mark.parametrize("part", PARTS)
def test_parts_of_bodies_stay_sure(part: str) -> None:
    own, names, places = PARTS[part]
    before = places[:1] if part == "arms with clavicles" else ()
    joints = [*own, *pair(names, own[0][0], places[len(before) :], *before)]
    assert len([chain for chain in recognise(rig_with(joints)).chains if chain.bend and chain.is_sure]) == 2


def test_arms_and_legs_of_one_whose_root_has_any_name_are_sure() -> None:
    joints = [("Steve", "", (0, 1.2, 0)), *pair(ARMS[1], "Steve", ARM), *pair(LEGS[1], "Steve", LEG)]
    assert len([chain for chain in recognise(rig_with(joints)).chains if chain.bend and chain.is_sure]) == 4


# A horse of which neither hips nor spine are named, as riggers of animals call the rest.
ANIMAL = {
    "pelvis": "croup",
    "spine1": "back1",
    "spine2": "back2",
    "chest": "withers",
    "thigh": "hindleg_hip",
    "shin": "hindleg_stifle",
    "foot": "hindleg_hock",
    "toe": "hindleg_fetlock",
    "upper_arm": "foreleg_elbow",
    "forearm": "foreleg_knee",
    "hand": "foreleg_fetlock",
}


@pytest.mark.parametrize(("top", "certain"), [("cog", True), ("cog_jnt", True), ("crane_cog", False)])
def test_a_cog_that_all_limbs_hang_below_is_the_centre_of_gravity(top: str, *, certain: bool) -> None:
    """Before, ``cog`` was a part of a machine wherever it was, so that no leg of a horse was sure."""
    horse = [(name, above or top, place) for name, above, place in renamed(HORSE, ANIMAL)]
    layout = recognise(rig_with([(top, "", (0, 1.4, 0)), *horse]))
    sure = [chain.name for chain in layout.chains if chain.bend and chain.is_sure]
    assert len(sure) == (4 if certain else 0)


def test_a_cog_beside_the_limbs_is_a_wheel() -> None:
    horse = renamed(HORSE, ANIMAL)
    layout = recognise(rig_with([*horse, ("cog", "withers", (0, 1.5, 0.7))]))
    assert [chain.name for chain in layout.chains if chain.bend and chain.is_sure] == []


@pytest.mark.parametrize("prefix", ["", "raptor_", "hero:"])
def test_what_all_names_begin_with_hides_no_trunk(prefix: str) -> None:
    """Before, ``raptor_hip`` was no part of a body beside ``raptor_arm1_L``, and nothing was sure."""
    joints: list[Joint] = [("root", "", (0, 1, 0)), *line("hip skull", "root", (0, 1.1, 0), (0, 1.6, 0.1))]
    joints += [*pair("arm1 arm2 arm3", "hip", ARM), *pair("leg1 leg2 leg3", "hip", LEG)]
    called = [(prefix + name, above and prefix + above, place) for name, above, place in joints]
    assert len([chain for chain in recognise(rig_with(called)).chains if chain.bend and chain.is_sure]) == 4
