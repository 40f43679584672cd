"""Carts, clocks, planes and the like: what is named in one word with a thing is of the thing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
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

from rigtri import orient_joints
from rigtri.model.rig import Rig
from rigtri.recognition.recognise import recognise


def on_legs(root: str, start: str, middle: str, end: str, *more: Joint) -> list[Joint]:
    """A thing on two legs that bend, and what else it has."""
    names = f"{start}.L {middle}.L {end}.L"
    legs = both(line(names, root, (0.3, 0.5, -0.1), (0.32, 0.25, -0.06), (0.32, 0.0, -0.1)))
    return [(root, "", (0.0, 0.6, 0.0)), *legs, *more]


THINGS: dict[str, list[Joint]] = {
    "satellite": on_legs(
        "body",
        "leg_upper",
        "leg_lower",
        "antenna_foot",
        *both(
            line(
                "arm_upper.L arm_lower.L panel.L", "body", (0.4, 0.6, 0.0), (1.4, 0.65, 0.0), (2.4, 0.6, 0.0)
            )
        ),
        ("dish_head", "body", (0.0, 1.0, 0.0)),
    ),
    "excavator": [
        ("base", "", (0.0, 0.5, 0.0)),
        *line(
            "cab boom arm forearm bucket hand",
            "base",
            (0.0, 1.0, 0.0),
            (0.0, 1.2, 0.5),
            (0.0, 2.5, 2.0),
            (0.0, 2.0, 3.5),
            (0.0, 0.8, 4.0),
            (0.0, 0.5, 4.2),
        ),
    ],
    "cart": on_legs("cart_body", "stand_leg", "stand_leg_low", "stand_foot"),
    "clock": on_legs(
        "clock_body",
        "leg",
        "leg_low",
        "foot",
        ("head", "clock_body", (0, 2, 0.1)),
        ("face", "head", (0, 2, 0.2)),
    ),
    "drone": on_legs(
        "body",
        "leg",
        "leg_low",
        "skid",
        *both(line("front_motor.L front_rotor.L", "body", (0.5, 0.6, 0.5), (0.5, 0.7, 0.5))),
    ),
    "grill": on_legs("body", "leg", "leg_lower", "foot", ("lid", "body", (0.0, 0.9, 0.0))),
    "motorcycle": on_legs(
        "steering_neck",
        "fork_upper",
        "fork_lower",
        "fork_foot",
        ("frame", "steering_neck", (0, 0.6, -0.5)),
        ("tail_light", "frame", (0, 0.8, -1)),
    ),
    "helicopter": on_legs(
        "fuselage",
        "skid_strut",
        "skid",
        "skid_tip",
        ("main_rotor", "fuselage", (0, 2, 0)),
        ("tail_boom", "fuselage", (0, 1.2, -2)),
        ("tail_rotor", "tail_boom", (0, 1.5, -4)),
    ),
    "camera": on_legs(
        "mount",
        "leg",
        "leg_mid",
        "leg_foot",
        ("camera_body", "mount", (0, 0.8, 0)),
        ("head", "mount", (0, 0.7, 0)),
    ),
    "lamp": on_legs(
        "lamp",
        "upper_leg",
        "lower_leg",
        "foot",
        ("body", "lamp", (0, 0.8, 0)),
        ("neck", "body", (0, 1, 0)),
        ("head", "neck", (0, 1.1, 0.1)),
    ),
    "plane": on_legs(
        "hull",
        "gear_upper",
        "gear_knee",
        "gear_foot",
        ("nose_wheel", "hull", (0, 0.4, 3)),
        *both(line("wing.L wing_mid.L wing_tip.L", "hull", (1, 0.9, 0.3), (3, 1, -0.2), (5, 1.1, -0.9))),
    ),
}


@pytest.mark.parametrize("thing", THINGS)
def test_no_limb_of_a_thing_is_sure(thing: str) -> None:
    """Before, a cart's body was the trunk of its stand, and a helicopter's tail made its skids sure legs.

    And a camera with a body and a head was a body on two legs, to 0.84.
    """
    layout = recognise(rig_with(THINGS[thing]))
    assert [chain.name for chain in layout.chains if chain.bend and chain.is_sure] == []


@pytest.mark.parametrize("held", ["weapon.R", "lamp.R", "sword"])
def test_who_holds_a_thing_is_a_body(held: str) -> None:
    joints = [*MAN, (held, "hand.R", (-0.7, 1.35, 0.1))]
    layout = recognise(rig_with(joints))
    assert len([chain for chain in layout.chains if chain.bend and chain.is_sure]) == 4


@pytest.mark.parametrize(("prefix", "sure"), [("stool_", 4), ("", 8)])
def test_legs_of_what_one_sits_on_are_not_sure_beside_those_of_who_sits_there(prefix: str, sure: int) -> None:
    """Before, a stool's four legs were legs of its sitter, to 0.78."""
    legs = [
        joint
        for k, ahead in enumerate((0.2, -0.2))
        for joint in both(
            line(
                f"{prefix}leg{k}_0.L {prefix}leg{k}_1.L {prefix}leg{k}_2.L",
                "hips",
                *((0.25 + 0.03 * bent, high, ahead) for high, bent in ((0.9, 0), (0.5, 1), (0.05, 0))),
            )
        )
    ]
    found = [chain for chain in recognise(rig_with([*MAN, *legs])).chains if chain.bend and chain.is_sure]
    assert len(found) == sure


def test_front_limbs_with_elbows_are_legs_whatever_the_file_has_for_up() -> None:
    """Elbow and wrist are words of arms, and of front legs where names say front and hind."""
    bones = "thigh shin foot toe upper_arm forearm hand finger"
    words = "backHip backKnee backAnkle backBall frontShoulder frontElbow frontWrist frontToe"
    called = dict(zip(bones.split(), words.split(), strict=True))

    places = {k[0]: k[2] for k in HORSE} | {"shin.L": (0.2, 0.85, -0.55), "foot.L": (0.2, 0.45, -1.1)}
    places |= {"forearm.L": (0.2, 0.85, 0.5), "hand.L": (0.2, 0.42, 0.4), "toe.L": (0.2, 0.08, -1.0)}
    places |= {f"{k[:-2]}.R": (-x, y, z) for k, (x, y, z) in places.items() if k.endswith(".L")}
    lying = [(k, above, (x, -z, y)) for k, above, _ in HORSE for x, y, z in [places[k]]]
    (horse,) = recognise(rig_with(renamed(lying, called))).characters
    assert horse.form == "quadruped"
    assert sorted((chain.kind, chain.is_front) for chain in horse.limbs if chain.is_sure) == [
        *[("leg", False)] * 2,
        *[("leg", True)] * 2,
    ]


@pytest.mark.parametrize("named", [True, False])
def test_what_a_hand_holds_is_no_finger(named: bool) -> None:
    """A sword is longer than the fingers, and the hand is where these begin."""
    arm = [
        *ARM[:3],
        *line("part1.L part2.L hand.L", "forearm.L", (0.52, 1.45, 0), (0.61, 1.45, 0), (0.7, 1.45, 0)),
    ]
    joints = [*TRUNK, *both([*arm, *LEG]), *FINGERS]
    joints += line("sword sword_tip", "hand.R", (-0.72, 1.4, 0.02), (-0.72, 1.4, 0.8))
    rig = rig_with(joints, named=named)
    arms = [chain for chain in recognise(rig).chains if chain.kind == "arm" and chain.is_sure]
    hands = {joints[chain.bend[2]][0] for chain in arms}
    assert hands == {"hand.L", "hand.R"}


@pytest.mark.parametrize("names", ["index0.L index1.L index2.L", "palm.L index1.L index2.L"])
def test_one_long_finger_is_called_so_by_any_of_its_joints(names: str) -> None:
    """Before, the first joint alone counted, which may be a metacarpal: the finger was a held thing."""
    finger = line(names, "hand.L", (0.75, 1.45, 0), (0.9, 1.45, 0), (1.1, 1.45, 0))
    rig = rig_with([*TRUNK, *both([*ARM, *finger, *LEG])])
    fingers = [chain for chain in recognise(rig).chains if chain.kind == "finger"]
    assert [rig.names[chain.joints[-1]] for chain in fingers] == ["index2.L", "index2.R"]


@pytest.mark.parametrize("apart", ["wing", "a"])
def test_who_has_wings_sits_at_no_wheel(apart: str) -> None:
    """Humerus, radius and carpus are of arms and of front legs, which no up makes surely arms."""
    called = {
        "upper_arm": "humerus",
        "forearm": "radius",
        "hand": "carpus",
        "finger": "phalanx",
        "foot": "tarsus",
    }
    called |= {"thigh": "femur", "shin": "tibia"}

    wings = line(
        f"{apart}1.L {apart}2.L {apart}3.L", "chest", (0.1, 1.5, 0.5), (0.8, 1.9, 0), (1.1, 1.7, 0.4)
    )
    joints = [*renamed(HORSE, called), *both(wings)]
    body = recognise(rig_with([(name, above, (x, -z, y)) for name, above, (x, y, z) in joints]))
    assert [chain.name for chain in body.chains if chain.kind == "arm" and chain.is_sure] == []


def test_wings_that_reach_back_are_no_head() -> None:
    """Before, the tips of wings behind the hind legs turned an animal round, and its sides were swapped."""
    wings = line("a.L b.L c.L", "chest", (0.1, 1.5, 0.5), (0.8, 1.9, 0.0), (1.1, 1.7, -0.6))
    fingers = [(f"tip{k}.L", "c.L", (1.0 + 0.1 * k, 1.5, -1.9 + 0.1 * k)) for k in range(3)]
    dragon = rig_with([*HORSE, *both([*wings, *fingers])], named=False)
    (found,) = recognise(dragon).characters
    assert found.facing[2] > 0.9


def test_joints_in_the_middle_of_chains_are_no_middle_fingers() -> None:
    """Before, a working platform was surely a hand with four middle fingers, and auto built its rig."""
    legs = line(
        "scissor.L scissor_mid.L scissor_foot.L", "deck", (0.3, 0.9, 0.3), (0.3, 0.5, -0.3), (0.3, 0.05, 0.3)
    )
    rails = line("rail.L rail_mid.L rail_end.L", "deck", (0.3, 1.2, -0.3), (0.3, 1.6, -0.3), (0.3, 1.6, 0.3))
    layout = recognise(rig_with([("deck", "", (0, 1, 0)), *both([*legs, *rails])]))
    assert [chain.name for chain in layout.chains if chain.is_sure] == []


_SIDES = (("L", 1.0), ("R", -1.0))
# A machine of rigid parts, which looks along +z.
_MACHINE: list[Joint] = [
    ("Pelvis", "", (0, 1.6, 0)),
    ("Torso", "Pelvis", (0, 1.8, 0)),
    ("Cockpit", "Torso", (0, 2.6, 0.1)),
    *(
        joint
        for s, x in _SIDES
        for joint in (
            (f"Hip_{s}", "Pelvis", (0.35 * x, 1.6, 0)),
            (f"Knee_{s}", f"Hip_{s}", (0.4 * x, 0.95, 0.15)),
            (f"Ankle_{s}", f"Knee_{s}", (0.4 * x, 0.2, -0.1)),
            (f"Shoulder_{s}", "Torso", (0.55 * x, 2.4, 0)),
            (f"Elbow_{s}", f"Shoulder_{s}", (0.75 * x, 1.9, -0.05)),
            (f"Gun_{s}", f"Elbow_{s}", (0.75 * x, 1.8, 0.45)),
        )
    ),
]


def _of_rigid_parts(*, meshes_apart: bool) -> Rig:
    """The machine without a skin: its nodes show meshes, or each has a child that does."""
    parts = [(f"{name}_geo", name, place) for name, _, place in _MACHINE] if meshes_apart else []
    rig = rig_with([*_MACHINE, *parts])
    shows = [name.endswith("_geo") or not meshes_apart for name in rig.names]
    return replace(rig, skins=(), attachment=np.where(shows, 0, -1))


@pytest.mark.parametrize("meshes_apart", [False, True])
def test_arms_of_rigid_parts_end_in_guns_and_meshes_are_no_limbs(*, meshes_apart: bool) -> None:
    (machine,) = recognise(rig := _of_rigid_parts(meshes_apart=meshes_apart)).characters
    found = {
        f"{chain.side} {chain.kind}": tuple(rig.names[k] for k in chain.bend)
        for chain in machine.limbs
        if chain.is_sure
    }
    assert found == {
        f"{side} {kind}": tuple(f"{name}_{side[0].upper()}" for name in names)
        for side in ("left", "right")
        for kind, names in (("leg", ("Hip", "Knee", "Ankle")), ("arm", ("Shoulder", "Elbow", "Gun")))
    }
    roles = {rig.names[part.joint]: part.role for part in machine.parts}
    assert {role for name, role in roles.items() if name.endswith("_geo")} <= {"attachment"}


def test_below_a_named_root_feet_of_rigid_parts_aim_ahead() -> None:
    rig = orient_joints(_of_rigid_parts(meshes_apart=True), root="Pelvis")
    ankle = rig.world[rig.find("Ankle_L"), :3, :3]
    assert ankle[0] == pytest.approx([0, 0, 1], abs=1e-6)
    assert ankle[1] == pytest.approx([1, 0, 0], abs=1e-6)
