"""Skeletons with Japanese names: of Final Fantasy XIV, and of MikuMikuDance with all that animators add."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from recognition_bodies.skeletons import Joint, Place, both, line, rig_with

from rigtri.model.rig import Rig
from rigtri.recognition.recognise import recognise
from rigtri.recognition.written_names import written_names

# The joints between thigh and foot: two of one knee, or knee and calf.
KNEES: dict[str, tuple[Place, Place]] = {
    "two of one knee": ((0.1, 0.52, 0.02), (0.1, 0.46, 0.01)),
    "knee and calf": ((0.1, 0.5, 0.02), (0.1, 0.3, -0.01)),
}


def fantasy(knee: tuple[Place, Place], garment: str) -> Rig:
    """A body of Final Fantasy XIV with chains of a skirt, and those of a garment along the legs."""
    spine = "j_sebo_a j_sebo_b j_sebo_c j_kubi j_kao"
    trunk: list[Joint] = [
        ("n_root", "", (0, 0, 0)),
        ("n_hara", "n_root", (0, 1, 0)),
        ("j_kosi", "n_hara", (0, 0.98, 0)),
    ]
    trunk += line(
        spine, "n_hara", (0, 1.02, 0), (0, 1.15, -0.02), (0, 1.3, -0.02), (0, 1.5, -0.02), (0, 1.58, 0)
    )
    arm = line(
        "j_sako.L j_ude_a.L j_ude_b.L j_te.L",
        "j_sebo_c",
        (0.03, 1.42, 0),
        (0.15, 1.42, -0.02),
        (0.33, 1.25, -0.04),
        (0.5, 1.08, 0),
    )
    arm += [("n_hte.L", "j_ude_b.L", (0.42, 1.16, -0.02)), ("n_hhiji.L", "j_ude_b.L", (0.33, 1.25, -0.04))]
    fingers = [
        joint
        for name, z in zip(("oya", "hito", "naka", "kusu", "ko"), (0.05, 0.03, 0, -0.02, -0.04), strict=True)
        for joint in line(f"j_{name}_a.L j_{name}_b.L", "j_te.L", (0.55, 1.03, z), (0.58, 1.0, z))
    ]
    names = "j_asi_a.L j_asi_b.L j_asi_c.L j_asi_d.L j_asi_e.L"
    leg = line(names, "j_kosi", (0.1, 0.93, 0), *knee, (0.1, 0.08, -0.03), (0.1, 0.02, 0.1))
    skirt = [
        joint
        for name, z in (("f", 0.1), ("b", -0.1), ("s", 0))
        for joint in line(
            f"j_sk_{name}_a.L j_sk_{name}_b.L j_sk_{name}_c.L",
            "j_kosi",
            (0.12, 0.93, z),
            (0.14, 0.65, 1.3 * z),
            (0.16, 0.4, 1.5 * z),
        )
    ]
    worn = line(garment, "j_kosi", (0.13, 0.94, 0.03), (0.13, 0.5, 0.05), (0.13, 0.1, 0)) if garment else []
    joints = [*trunk, *both([*arm, *fingers, *leg, *skirt, *worn])]

    def sided(name: str) -> str:
        return name.replace(".L", "_l").replace(".R", "_r")

    return rig_with([(sided(name), sided(above), place) for name, above, place in joints])


def sure(rig: Rig) -> dict[str, list[str]]:
    """The joints of each sure arm and leg."""
    chains = [k for k in recognise(rig).chains if k.kind in ("arm", "leg") and k.is_sure]
    return {chain.name: [rig.names[k] for k in chain.bend] for chain in chains}


@pytest.mark.parametrize(
    "garment", ["", "thigh.L shin.L foot.L", "trouser_leg.L trouser_knee.L trouser_cuff.L"]
)
@pytest.mark.parametrize("knee", KNEES)
def test_names_of_final_fantasy_are_those_of_its_bones_and_not_of_garments(knee: str, garment: str) -> None:
    """Before, no scheme knew them, and chains of a garment beside the legs were sure legs."""
    found = sure(fantasy(KNEES[knee], garment))
    legs = {f"{side} leg": [f"j_asi_{part}_{side[0]}" for part in "abd"] for side in ("left", "right")}
    arms = {
        f"{side} arm": [f"j_ude_a_{side[0]}", f"j_ude_b_{side[0]}", f"j_te_{side[0]}"]
        for side in ("left", "right")
    }
    assert found == legs | arms


def test_names_of_final_fantasy_are_written_as_they_are_read() -> None:
    bones = recognise(rig := fantasy(KNEES["knee and calf"], "")).characters[0].parts
    read = {part.bone: rig.names[part.joint] for part in bones if part.bone}
    written = written_names("ffxiv")
    assert {bone: written[bone] for bone in read} == read
    assert {"leftThumbMetacarpal", "rightLittleIntermediate", "leftShoulder", "hips", "head"} <= set(read)


TRUNK = [
    ("全ての親", "", (0, 0, 0)),
    *line("センター 下半身", "全ての親", (0, 0.9, 0), (0, 1, 0)),
    *line("上半身 上半身2 首 頭", "センター", (0, 1, 0), (0, 1.2, 0), (0, 1.45, 0), (0, 1.55, 0)),
]
LEG = line(
    "足 ひざ 足首 つま先", "下半身", (0.1, 0.9, 0), (0.1, 0.5, 0.02), (0.1, 0.08, -0.02), (0.1, 0.02, 0.1)
)


def miku(left: Sequence[Joint]) -> list[Joint]:
    """A body of MikuMikuDance with these joints on both sides."""
    middle = {name for name, _, _ in TRUNK}

    def sided(name: str, which: str) -> str:
        return name if name in middle else which + name

    both_sides = [
        (sided(name, which), sided(above, which), (sign * x, y, z))
        for which, sign in (("左", 1.0), ("右", -1.0))
        for name, above, (x, y, z) in left
    ]
    return [*TRUNK, *both_sides]


def limb(kind: str, names: str) -> dict[str, list[str]]:
    return {
        f"{side} {kind}": [which + name for name in names.split()]
        for side, which in (("left", "左"), ("right", "右"))
    }


@pytest.mark.parametrize("clavicle", [True, False])
@pytest.mark.parametrize("off", [0.0, 0.013, 0.043, -0.037])
def test_a_twist_joint_out_of_line_is_no_shoulder_of_a_body_of_mmd(off: float, *, clavicle: bool) -> None:
    """Before, 捩 behind the name of a bone was no word, and the arm began at 腕捩, sure to 0.96."""
    start = (
        [("肩", "上半身2", (0.05, 1.4, 0)), ("腕", "肩", (0.15, 1.4, 0))]
        if clavicle
        else [("腕", "上半身2", (0.15, 1.4, 0))]
    )
    arm = line("腕捩 ひじ 手首", "腕", (0.27, 1.317 + off, 0), (0.38, 1.24, -0.01), (0.58, 1.1, 0))
    found = sure(rig_with(miku([*start, *arm, *LEG])))
    arms = limb("arm", "腕 ひじ 手首")
    assert {name: joints for name, joints in found.items() if arms.get(name) != joints} == limb(
        "leg", "足 ひざ 足首"
    )
    assert off > 0.02 or arms.items() <= found.items()


def test_legs_whose_skin_the_second_chain_of_mmd_moves_are_that_chain() -> None:
    """Before, 足D, ひざD and 足首D were known by their shape alone, to 0.7, which commands do not use."""
    arm = line("腕 ひじ 手首", "上半身2", (0.15, 1.4, 0), (0.38, 1.24, -0.01), (0.58, 1.1, 0))
    second = line("足D ひざD 足首D 足先EX", "下半身", *(place for _, _, place in LEG))
    rig = rig_with(miku([*arm, *LEG, *second]))
    still = {f"{which}{name}" for which in "左右" for name, _, _ in LEG}
    weighs = np.array([name not in still for name in rig.names])
    skin = replace(rig.skins[0], weigh=lambda: weighs)
    assert sure(replace(rig, skins=(skin,))) == limb("arm", "腕 ひじ 手首") | limb("leg", "足D ひざD 足首D")
    assert sure(rig) == limb("arm", "腕 ひじ 手首") | limb("leg", "足 ひざ 足首")
