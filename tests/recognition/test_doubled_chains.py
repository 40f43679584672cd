"""Chains that move no point beside the bones that do: those of IK, FK and mechanisms, without names."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import FINGERS, MAN, Joint, rig_with

from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.recognition.recognise import recognise

BONES = [*MAN, *FINGERS]
LIMBS = [
    *("upper_arm.L forearm.L hand.L", "upper_arm.R forearm.R hand.R"),
    *("thigh.L shin.L foot.L", "thigh.R shin.R foot.R"),
]


def doubled(off: float) -> tuple[Rig, list[str]]:
    """A man whose limbs each have a chain before and one behind them that moves nothing; and his names."""
    above = {name: over for name, over, _ in BONES}
    at = {name: place for name, _, place in BONES}

    def idle(mark: str) -> list[Joint]:
        found: list[Joint] = []
        for limb in LIMBS:
            over = above[limb.split()[0]]
            for k, name in enumerate(limb.split()):
                x, y, z = at[name]
                found.append((mark + name, over, (x, y, z + off * (k - 1))))
                over = mark + name
        return found

    trunk = [joint for joint in BONES if "." not in joint[0]]
    clavicles = [joint for joint in BONES if joint[0].startswith("clavicle")]
    rest = [joint for joint in BONES if joint not in trunk and joint not in clavicles]
    joints = [*trunk, *clavicles, *idle("ik "), *rest, *idle("fk ")]
    moved = np.array([" " not in name for name, _, _ in joints])
    rig = rig_with(joints, named=False)
    skin = replace(rig.skins[0], weigh=lambda: moved)
    return replace(rig, skins=(skin,)), [name for name, _, _ in joints]


def test_limbs_without_names_are_the_chains_that_move_points() -> None:
    """Before, one of the three was taken for each limb, and surely."""
    rig, names = doubled(0.0)
    (man,) = recognise(rig).characters
    found = {" ".join(names[k] for k in chain.bend) for chain in man.limbs if chain.is_sure}
    assert found == set(LIMBS)


@pytest.mark.parametrize("off", [0.004, 0.01])
def test_a_chain_beside_the_bones_that_moves_nothing_is_no_sure_limb(off: float) -> None:
    """Of a man whose other leg has no such chain, and with noise between chain and bones."""
    leg = [joint for joint in MAN if joint[0] in ("thigh.R", "shin.R", "foot.R")]
    idle = [
        (f"ik {name}", over if k == 0 else f"ik {over}", (x, y, z))
        for k, (name, over, (x, y, z)) in enumerate(leg)
    ]
    bones = [
        (name, over, (x + off, y, z) if (name, over, (x, y, z)) in leg else (x, y, z))
        for name, over, (x, y, z) in BONES
    ]
    joints = [*bones[:5], *idle, *bones[5:]]
    moved = np.array([" " not in name for name, _, _ in joints])
    rig = rig_with(joints, named=False)
    rig = replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moved),))
    names = [name for name, _, _ in joints]
    sure = {
        " ".join(names[k] for k in chain.bend)
        for chain in recognise(rig).chains
        if chain.is_sure and chain.bend
    }
    assert sure <= set(LIMBS)


def around_a_man(prefix: str, off: float) -> Rig:
    """A man and a second skeleton around him, in one skin."""
    around: list[Joint] = [
        (prefix + name, over and prefix + over, (x, y, z + off)) for name, over, (x, y, z) in BONES
    ]
    return rig_with([*BONES, *around])


def with_controls(prefix: str, off: float, moved: str = "") -> Rig:
    """A man and a second skeleton around him, of which one kind of joints moves no point."""
    rig = around_a_man(prefix, off)
    moves = np.array([name.startswith(prefix) == bool(moved) for name in rig.names])
    return replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moves),))


@pytest.mark.parametrize("off", [0.0, 0.005, 0.02])
@pytest.mark.parametrize("prefix", ["CTRL_", "FK_", "rig_"])
def test_a_skeleton_that_moves_nothing_around_a_body_is_of_controls(prefix: str, off: float) -> None:
    """Before, it was a second character, sure, and `auto` refused to build for its unsure limbs."""
    rig = with_controls(prefix, off)
    layout = recognise(rig)
    (man,) = layout.characters
    found = {" ".join(rig.names[k] for k in chain.bend) for chain in man.limbs if chain.is_sure}
    assert found == set(LIMBS)
    roles = {part.role for part in man.parts if rig.names[part.joint].startswith(prefix)}
    assert roles == {"control"}
    assert not any("characters" in remark for remark in layout.remarks)


def test_of_bones_and_controls_those_that_move_the_mesh_are_the_body_whatever_they_are_called() -> None:
    rig = with_controls("q_", 0.0, moved="q_")
    (man,) = recognise(rig).characters
    assert all(rig.names[k].startswith("q_") for chain in man.limbs for k in chain.bend)


def test_a_body_that_stands_elsewhere_is_a_character_though_it_moves_nothing() -> None:
    """A crowd in one skin, of which somebody has taken a mesh away."""
    assert len(recognise(with_controls("other_", 1.5)).characters) == 2


def without_a_mesh(prefix: str, *turned: str) -> Rig:
    """A man and a second skeleton around him, of a file without meshes; turned: joints that a clip turns."""
    rig = around_a_man(prefix, 0.005)
    tracks = []
    for name, way in zip(turned, (1, -1), strict=False):
        turns = [from_axis_angle(np.array([0.0, 1.0, 0.0]), np.radians(k * way)) for k in (0, 40, 80, 0)]
        tracks.append(Track(rig.find(name, "joint"), "rotation", "LINEAR", np.arange(4.0), np.stack(turns)))
    clips = (Clip("turn", tuple(tracks)),) if turned else ()
    return replace(rig, skins=(replace(rig.skins[0], drawn=False),), clips=clips)


@pytest.mark.parametrize("prefix", ["CTRL_", "FK_", "MCH-", "ORG-"])
def test_where_nothing_has_weight_names_tell_controls_from_the_body(prefix: str) -> None:
    """Before, both were characters, and sure, and `auto` built two rigs in one place."""
    rig = without_a_mesh(prefix)
    (man,) = recognise(rig).characters
    assert {" ".join(rig.names[k] for k in chain.bend) for chain in man.limbs if chain.is_sure} == set(LIMBS)
    roles = {part.role for part in man.parts if rig.names[part.joint].startswith(prefix)}
    assert roles == {"control"}


@pytest.mark.parametrize(
    ("turned", "certain"), [((), False), (("hips",), False), (("hips", "rig_chest"), True)]
)
def test_where_neither_weights_nor_names_tell_no_limb_is_sure(turned: tuple[str, ...], certain: bool) -> None:
    """Before, both skeletons were sure. Actors may rest in one place, but each moves its own way."""
    layout = recognise(without_a_mesh("rig_", *turned))
    sure = [chain for chain in layout.chains if chain.bend and chain.is_sure]
    assert len(sure) == (8 if certain else 0)
    doubts = [remark for remark in layout.remarks if "stands in the same places" in remark]
    assert len(doubts) == (0 if certain else 8)


def in_another_pose(prefix: str, *, scale: float = 1.0, off: float = 0.0, over: str = "") -> Rig:
    """A man in one skin with a skeleton that moves nothing, has his bones, and rests with raised limbs."""
    above, at = {name: top for name, top, _ in BONES}, {name: np.array(place) for name, _, place in BONES}
    posed = dict(at)
    for start, degrees in (("upper_arm", 60.0), ("thigh", 40.0)):
        for side, way in (("L", 1.0), ("R", -1.0)):
            top = f"{start}.{side}"
            c, s = np.cos(np.radians(way * degrees)), np.sin(np.radians(way * degrees))
            turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            below = {top}
            for name, holder in above.items():
                below |= {name} if holder in below else set()
            posed |= {name: at[top] + turn @ (at[name] - at[top]) for name in below}
    first = at[BONES[0][0]]
    around: list[Joint] = []
    for name, holder, _ in BONES:
        x, y, z = (first + scale * (posed[name] - first)).tolist()
        around.append((prefix + name, prefix + holder if holder else over, (x + off, y, z)))
    bones = [(name, holder or over, place) for name, holder, place in BONES]
    rig = rig_with([*([(over, "", (0.0, 0.0, 0.0))] if over else []), *around, *bones])
    moves = np.array([not name.startswith(prefix) and name != over for name in rig.names])
    return replace(rig, skins=(replace(rig.skins[0], weigh=lambda: moves),))


@pytest.mark.parametrize(
    ("prefix", "scale", "off", "over"),
    [
        ("CTRL_", 1.0, 0.0, ""),
        ("rig_", 1.0, 0.0, ""),
        ("rig_", 1.0, 0.02, ""),
        ("rig_", 1.3, 0.0, ""),
        ("CTRL_", 1.0, 1.5, ""),
        ("MCH-", 1.0, 1.5, ""),
        ("rig_", 1.0, 0.0, "armature"),
        ("CTRL_", 1.0, 0.0, "armature"),
    ],
)
def test_controls_may_rest_in_another_pose_than_the_body(
    prefix: str, scale: float, off: float, over: str
) -> None:
    """Before, those were a second person, with sure limbs."""
    rig = in_another_pose(prefix, scale=scale, off=off, over=over)
    (man,) = recognise(rig).characters
    found = {" ".join(rig.names[k] for k in chain.bend) for chain in man.limbs if chain.is_sure}
    assert found == set(LIMBS)


def test_a_body_in_another_pose_elsewhere_is_a_character_though_it_moves_nothing() -> None:
    assert len(recognise(in_another_pose("other_", off=1.5)).characters) == 2
