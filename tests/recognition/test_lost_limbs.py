"""Bodies that have lost half a leg or arm: the stump is none, and the other one is whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import MAN, both, line, rig_with
from rigs import rig_of

from rigtri.model.rig import Rig
from rigtri.recognition.recognise import recognise

_MIDDLE = {"hips": 1.0, "spine": 1.2, "chest": 1.4, "neck": 1.55, "head": 1.65}
# Along an arm and a leg, from the left: aside, up, ahead.
_ARM = ((0.2, 1.48, 0.0), (0.45, 1.47, -0.02), (0.7, 1.46, 0.0))
_LEG = ((0.1, 0.95, 0.0), (0.1, 0.5, 0.02), (0.1, 0.08, -0.02))
# What the root, the trunk and the joints of arm and leg are called, with the sides.
_CMU = (
    "root",
    "hips lowerback upperback lowerneck head",
    "humerus radius wrist",
    "femur tibia foot",
    "l",
    "r",
)
_LF = ("Root", "cog spineA spineB neck head", "upArm loArm hand", "upLeg loLeg foot", "lf_", "rt_")
_PLAIN = ("Root", "hips spine chest neck head", "UpperArm LowerArm Hand", "Thigh Shin Foot", "Left", "Right")


def _body(
    called: tuple[str, ...], *, end: str = "_end", lost: str = "leg", hair: bool = False, two: bool = False
) -> Rig:
    """A body without what follows its right thigh, or upper arm, but for a joint of that name and ``end``.

    Without an ``end`` the foot, or hand, alone is lost; ``two``: on the left, too.
    """
    root, trunk, arms, legs, left, right = called
    middle = trunk.split()
    places = {root: (0.0, 0.0, 0.0)} | dict(
        zip(middle, ((0.0, y, 0.0) for y in _MIDDLE.values()), strict=True)
    )
    above = dict(zip(middle, [root, *middle], strict=False)) | {root: ""}
    for kind, words, points, over in (("arm", arms, _ARM, middle[2]), ("leg", legs, _LEG, middle[0])):
        for which, sign in ((left, 1.0), (right, -1.0)):
            names = [f"{which}{word}" for word in words.split()]
            if is_lost := kind == lost and (two or which == right):
                names = [names[0], f"{names[0]}{end}" if end else names[1]]
            for k, (name, (x, y, z)) in enumerate(zip(names, points, strict=False)):
                half = 0.5 if end and is_lost and k else 0.0
                below = np.array(points[0]) * half + np.array((x, y, z)) * (1.0 - half)
                places[name] = (sign * float(below[0]), float(below[1]), float(below[2]))
                above[name] = names[k - 1] if k else over
    if hair:
        places["hair_back"], above["hair_back"] = (0.0, 1.7, -0.1), middle[-1]
    order = list(places)
    parents = [order.index(above[name]) if above[name] else -1 for name in order]
    world = np.array([places[name] for name in order])
    local = [world[k] - world[p] if p >= 0 else world[k] for k, p in enumerate(parents)]
    return rig_of(order, parents, np.array(local))


@pytest.mark.parametrize("called", [_CMU, _LF, _PLAIN], ids=["cmu", "lf", "plain"])
@pytest.mark.parametrize("lost", ["arm", "leg"])
def test_half_a_limb_that_an_end_joint_ends_is_none_and_its_twin_is_whole(
    called: tuple[str, ...], lost: str
) -> None:
    rig = _body(called, lost=lost, hair=True)
    (character,) = recognise(rig).characters
    limbs = {chain.name: chain for chain in character.chains if chain.kind in ("arm", "leg")}
    assert f"right {lost}" not in limbs
    words, left = called[2 if lost == "arm" else 3].split(), called[4]
    whole = limbs[f"{lost} left"] if f"{lost} left" in limbs else limbs[f"left {lost}"]
    assert [rig.names[k] for k in whole.bend] == [left + word for word in words]
    assert whole.is_sure
    assert len(limbs) == 3


def test_a_limb_without_its_third_joint_is_not_sure() -> None:
    rig = _body(_PLAIN, end="")
    chains = [chain for chain in recognise(rig).chains if chain.kind == "leg"]
    assert [(chain.side, len(chain.joints), chain.is_sure) for chain in chains] == [
        ("left", 3, True),
        ("right", 2, False),
    ]


@pytest.mark.parametrize("called", [_CMU, _LF, _PLAIN], ids=["cmu", "lf", "plain"])
def test_a_body_with_one_leg_has_hips_and_a_spine(called: tuple[str, ...]) -> None:
    rig = _body(called, hair=True)
    (character,) = recognise(rig).characters
    trunk = called[1].split()
    assert character.form == "biped"
    assert rig.names[character.hips] == trunk[0]
    spine = next(chain for chain in character.chains if chain.kind == "spine")
    assert [rig.names[k] for k in spine.joints] == trunk[1:3]


def test_two_stumps_are_no_sure_legs() -> None:
    rig = _body(_PLAIN, two=True)
    assert [chain.is_sure for chain in recognise(rig).chains if chain.kind == "leg"] == [False, False]


def test_who_crouches_with_half_a_leg_stands_as_the_file_does() -> None:
    """Half a thigh and a whole one go ahead alike, as legs of a body would whose up is there."""
    back = [
        (0, 1.17, 0.07),
        (0, 1.35, 0.17),
        (0, 1.53, 0.26),
        (0, 1.72, 0.38),
        (0, 1.86, 0.49),
        (0, 2.05, 0.54),
    ]
    tail = [(0, 0.85, -0.35), (0, 0.78, -0.52), (0, 0.72, -0.69), (0, 0.64, -0.87), (0, 0.58, -1.04)]
    arm = [(0.06, 1.75, 0.48), (0.39, 1.75, 0.42), (0.65, 1.31, 0.68), (0.64, 1.32, 1.2)]
    joints = [
        ("root", "", (0, 0.99, 0)),
        *line("lowerback upperback thorax thorax1 lowerneck head", "root", *back),
        *both(line("clavicle.L humerus.L radius.L wrist.L", "thorax1", *arm)),
        *line("femur.L tibia.L foot.L", "root", (0.18, 0.92, 0), (0.36, 0.71, 0.61), (0.4, 0.17, 0.31)),
        *line("femur.R femur_end.R", "root", (-0.19, 0.92, 0), (-0.29, 0.79, 0.35)),
        *line("tail_1 tail_2 tail_3 tail_4 tail_5", "root", *tail),
    ]
    (character,) = recognise(rig_with(joints)).characters
    assert character.up == (0, 1, 0)
    assert character.facing == pytest.approx((0, 0, 1), abs=0.02)


@pytest.mark.parametrize("turned", [1.0, -1.0])
@pytest.mark.parametrize("left_first", [False, True])
def test_an_arm_and_a_leg_without_twins_tell_which_side_is_left(turned: float, left_first: bool) -> None:
    """Where nothing else shows where a body faces. Before, the order of joints decided."""
    cape = both(line("cape_1.L cape_2.L cape_3.L", "chest", (0.1, 1.4, 0), (0.1, 1.1, 0), (0.1, 0.8, 0)))
    lost = {"forearm.L", "hand.L", "thigh.R", "shin.R", "foot.R", "toe.R"}
    kept = [joint for joint in (*MAN, *cape) if joint[0] not in lost]
    kept.sort(
        key=lambda joint: "RL".find(joint[0][-1]) * (-1 if left_first else 1) if "." in joint[0] else -2
    )
    rig = rig_with([(name, above, (turned * x, y, turned * z)) for name, above, (x, y, z) in kept])
    dutch = {
        "L": "links",
        "R": "rechts",
        "upper_arm": "bovenarm",
        "forearm": "onderarm",
        "thigh": "bovenbeen",
    }
    dutch |= {"shin": "onderbeen", "foot": "voet", "toe": "tenen", "shoulder": "sleutelbeen"}
    names = ("_".join(dutch.get(word, word) for word in name.split(".")) for name in rig.names)
    rig = replace(rig, names=tuple(names))
    (character,) = recognise(rig).characters
    assert character.facing == pytest.approx((0, 0, turned), abs=0.02)
