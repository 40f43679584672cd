"""Skeletons whose file does not say which joint follows which, and joints beside those of a limb."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from recognition_bodies.skeletons import FINGERS, MAN, TRUNK, Joint, both, line, rig_with

from rigtri.maths.scalar_vector import Vector
from rigtri.model.rig import Rig
from rigtri.recognition import front_or_hind
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.character_joints import groups_of, left_over
from rigtri.recognition.found_limb import Found
from rigtri.recognition.guessed_hierarchy import lost_third, lower_elsewhere, start_beside
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_words import limb_words
from rigtri.recognition.names_of_several import named_twice
from rigtri.recognition.recognise import recognise


def flat(joints: list[Joint]) -> list[Joint]:
    """All joints as children of the first."""
    return [(name, joints[0][0] if k else "", at) for k, (name, _, at) in enumerate(joints)]


# One who runs, in metres: feet and thighs are images of each other, arms are not.
RUNNER = """
hips 0 0.505 0
spine 0 0.54 0.007
chest 0 0.612 0.022
upper_chest 0 0.684 0.038
neck 0 0.794 0.061
head 0 0.864 0.071
clavicle.L 0.02 0.782 0.068
upper_arm.L 0.092 0.779 0.058
forearm.L 0.149 0.622 0.099
hand.L 0.146 0.631 0.256
thigh.L 0.05 0.486 0
shin.L 0.057 0.269 0.019
foot.L 0.059 0.122 -0.155
clavicle.R -0.02 0.782 0.069
upper_arm.R -0.092 0.779 0.058
forearm.R -0.149 0.622 0.018
hand.R -0.17 0.562 0.163
thigh.R -0.05 0.486 0
shin.R -0.056 0.269 0.019
foot.R -0.059 0.122 -0.156
"""


def running() -> list[Joint]:
    """All joints as children of the first."""
    rows = [row.split() for row in RUNNER.split("\n") if row]
    return [
        (name, "hips" if k else "", (float(x), float(y), float(z))) for k, (name, x, y, z) in enumerate(rows)
    ]


def test_a_flat_body_that_runs_has_its_limbs_of_both_sides() -> None:
    """Before, what was beside the plane of no mirror image was left out of the body."""
    (found,) = recognise(rig_with(running())).characters
    assert sorted((k.kind, k.side, k.is_sure) for k in found.limbs) == [
        ("arm", "left", True),
        ("arm", "right", True),
        ("leg", "left", True),
        ("leg", "right", True),
    ]


def drafted(rig: Rig, *, own: bool = True, segments: tuple[int, ...] = ()) -> Draft:
    """What doubts ask of a draft."""
    nodes = list(range(len(rig)))
    tree = Tree(rig, nodes, rig.world[:, 3, :3], list(rig.parents) if own else None)
    words = {node: limb_words(rig.names[node]) for node in nodes}
    known: Any = SimpleNamespace(tree=tree, words=words, segments=frozenset(segments), reading=None)
    return cast(Draft, known)


def found_at(rig: Rig, names: str) -> Found:
    joints = tuple(rig.names.index(name) for name in names.split())
    return Found("arm", "left", joints, (), 0.9, ())


@pytest.mark.parametrize("own", [True, False])
def test_two_joints_in_a_guessed_hierarchy_are_no_sure_limb(*, own: bool) -> None:
    rig = rig_with([*TRUNK, *line("a.L b.L", "chest", (0.1, 1.4, 0), (0.4, 1.4, 0))])
    assert bool(lost_third(drafted(rig, own=own), found_at(rig, "a.L b.L"))) == own


@pytest.mark.parametrize(("names", "doubt"), [("b.001", ""), ("b.001 b.003", "'b.001' and others follow")])
def test_parts_of_a_bone_that_follow_one_another_may_be_its_limb(names: str, doubt: str) -> None:
    """``FrontLeg.L``, ``FrontLeg.L.001``, ``FrontLeg.L.003``: before, a leg of two joints was sure."""
    places = ((0.1, 1.4, 0), (0.4, 1.4, 0), (0.7, 1.4, 0), (1.0, 1.4, 0))
    rig = rig_with([*TRUNK, *line(f"a.L b {names}", "chest", *places)])
    segments = tuple(rig.names.index(name) for name in names.split())
    assert lost_third(drafted(rig, own=False, segments=segments), found_at(rig, "a.L b")).startswith(doubt)
    assert bool(doubt) == bool(lost_third(drafted(rig, own=False, segments=segments), found_at(rig, "a.L b")))


@pytest.mark.parametrize("name", ["Bip01 L UpperArm", "Bip01 R UpperArm", "upper_arm_twist.L"])
def test_of_two_joints_called_alike_neither_starts_a_flat_limb(name: str) -> None:
    """Before, the upper arm of a centaur's trunk and the forearm of its front leg were one limb."""
    rig = rig_with(flat([*MAN, (name, "chest", (0.2, 1.3, 0.4))]))
    arm = found_at(rig, "upper_arm.L forearm.L hand.L")
    doubt = named_twice(drafted(rig), arm, [arm])
    assert doubt == ("'Bip01 L UpperArm' may be its start as well as 'upper_arm.L'" if " L " in name else "")


@pytest.mark.parametrize(
    ("place", "own", "doubt"),
    [
        ((0.2, 1.6, 0.1), True, True),
        ((0.2, 1.6, 0.1), False, False),
        ((0.3, 1.45, 0), True, False),  # it twists
        ((0.16, 1.47, 0.02), True, False),  # it corrects
    ],
)
def test_what_stands_beside_the_start_of_a_guessed_limb_may_begin_it(
    place: tuple[float, float, float], *, own: bool, doubt: bool
) -> None:
    """Before, lower arm, hand and claw of a flat kangaroo were an arm, its upper arm a helper."""
    rig = rig_with([*MAN, ("beside", "upper_arm.L", place)])
    assert bool(start_beside(drafted(rig, own=own), found_at(rig, "upper_arm.L forearm.L hand.L"))) == doubt


def test_a_wing_goes_on_in_what_is_called_wing_and_not_in_a_feather() -> None:
    wing = line("wing1.L wing2.L", "chest", (0.1, 1.4, -0.1), (0.5, 1.5, -0.2))
    more = [("feather4.L", "wing2.L", (0.9, 1.5, -0.6)), ("wing3.L", "wing2.L", (0.8, 1.45, -0.2))]
    joints = [*MAN, *both([*wing, *more])]
    (found,) = recognise(rig_with(joints)).characters
    wings = [[joints[k][0][:-2] for k in chain.joints] for chain in found.chains if chain.kind == "wing"]
    assert wings == [["wing1", "wing2", "wing3"]] * 2


def centaur() -> list[Joint]:
    """A tail that rises, no neck of the horse, and hands ahead of the front legs."""
    trunk = line("hips spine chest", "", (0, 1.4, -0.6), (0, 1.5, -0.3), (0, 1.5, 0.3))
    tail = line("tail1 tail2", "hips", (0, 1.6, -0.8), (0, 1.75, -1.0))
    person = line(
        "torso1 torso2 neck head", "chest", (0, 1.55, 0.5), (0, 1.8, 0.6), (0, 2.1, 0.6), (0, 2.2, 0.6)
    )
    arm = line(
        "clavicle.L upper_arm.L forearm.L hand.L",
        "torso2",
        (0.03, 2.05, 0.6),
        (0.2, 2.05, 0.58),
        (0.35, 1.83, 0.6),
        (0.45, 1.65, 0.7),
    )
    hind = line(
        "a.L b.L c.L d.L",
        "hips",
        (0.15, 1.4, -0.6),
        (0.15, 0.95, -0.4),
        (0.15, 0.5, -0.75),
        (0.15, 0.1, -0.7),
    )
    front = line(
        "e.L f.L g.L h.L", "chest", (0.15, 1.1, 0.6), (0.15, 0.8, 0.45), (0.15, 0.35, 0.5), (0.15, 0.08, 0.5)
    )
    return [*trunk, *tail, *person, *both([*arm, *hind, *front])]


def test_hands_of_a_centaur_are_no_tail_of_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before, it surely looked where its tail was, the tail being broader than the fingers."""
    finger = line("x.L y.L z.L", "hand.L", (0.47, 1.6, 0.75), (0.48, 1.58, 0.8), (0.49, 1.56, 0.84))
    joints = [*centaur(), *both(finger)]
    tail = [k for k, joint in enumerate(joints) if joint[0].startswith("tail")]
    broad = {True: (1.0, 1.0), False: (0.0, 0.0)}
    monkeypatch.setattr(front_or_hind, "_breadth", lambda _, nodes, *__: broad[not {*tail}.isdisjoint(nodes)])
    (found,) = recognise(rig_with(joints, named=False)).characters
    assert found.form == "quadruped"
    assert not [k for k in found.limbs if k.is_sure and found.facing[2] < 0]


def test_an_animal_with_short_legs_is_another_body_than_who_walks_beside_it() -> None:
    """Before, both were one body, and the animal looked away from its head."""
    trunk = line("p q r s", "", (2, 0.4, -0.3), (2, 0.42, 0), (2, 0.42, 0.3), (2, 0.6, 0.6))
    tail = line("t1 t2 t3 t4", "p", *((2, 0.4, -0.45 - 0.15 * k) for k in range(4)))
    legs = both(
        [
            *line("k.L l.L m.L", "p", (0.1, 0.38, -0.3), (0.1, 0.2, -0.22), (0.1, 0.03, -0.3)),
            *line("u.L v.L w.L", "r", (0.1, 0.36, 0.3), (0.1, 0.19, 0.25), (0.1, 0.03, 0.3)),
        ]
    )
    animal = [*trunk, *tail, *((name, over, (x + 2, y, z)) for name, over, (x, y, z) in legs)]
    rig = rig_with([*MAN, *FINGERS, *animal], named=False)
    groups = groups_of(Tree(rig, range(len(rig)), np.asarray(rig.world[:, 3, :3])))
    assert [len(group) for group in groups] == [len(MAN) + len(FINGERS), len(animal)]


# A machine on two legs, in metres: its ankles and toes hang at the hips, so its thighs seem to be its legs.
MACHINE: list[Joint] = [
    ("hips", "", (0, 1.2, 0)),
    ("turret", "hips", (0, 1.5, 0.1)),
    *both(
        [
            *line("gun.L barrel.L tip.L", "turret", (0.4, 1.5, 0.1), (0.45, 1.5, 0.5), (0.45, 1.5, 1)),
            *line("hip.L thigh.L knee.L", "hips", (0.2, 1.15, 0), (0.3, 1.1, 0), (0.32, 0.7, 0.25)),
            *line("ankle.L toe.L", "hips", (0.32, 0.3, -0.2), (0.32, 0.05, 0)),
        ]
    ),
]


@pytest.mark.parametrize("low", [0.3, 0.7])
def test_a_leg_ends_where_no_joint_of_its_side_stands_lower(low: float) -> None:
    rig = rig_with(
        [
            (n, a, (x, low, z) if n[:5] in ("ankle", "toe.L", "toe.R") else (x, y, z))
            for n, a, (x, y, z) in MACHINE
        ]
    )
    draft: Any = drafted(rig, own=False)
    draft.up, draft.poses = Vector(0.0, 1.0, 0.0), SimpleNamespace(has_weights=False)
    draft.shape = SimpleNamespace(plane=SimpleNamespace(side_of=lambda point: point.x))
    joints = tuple(rig.names.index(name) for name in ("hip.L", "thigh.L", "knee.L"))
    pair: Any = SimpleNamespace(named=0.0, size=0.6)
    leg = Found("leg", "left", joints, (), 0.9, (), pair=pair)
    doubt = lower_elsewhere(draft, leg, [leg])
    assert doubt.startswith("'ankle.L' stands lower") == (low < 0.5)


COUNT = {
    "upper_arm": "arm_1",
    "forearm": "arm_2",
    "hand": "arm_3",
    "thigh": "leg_1",
    "shin": "leg_2",
    "foot": "leg_3",
}


def counted(down: str) -> list[Joint]:
    """A body with counted limbs; on the sides of ``down`` they count down."""

    def called(name: str) -> str:
        word = COUNT.get(name[:-2], "")
        if word and name[-1] in down:
            word = word[:-1] + str(4 - int(word[-1]))
        return word + name[-2:] if word else name

    return [(called(name), called(above), at) for name, above, at in MAN]


@pytest.mark.parametrize(("down", "sure"), [("", True), ("L", True), ("LR", False)])
def test_names_that_count_down_on_both_sides_may_begin_at_the_end(down: str, sure: bool) -> None:
    (character,) = recognise(rig_with(counted(down))).characters
    limbs = [chain for chain in character.chains if chain.kind in ("arm", "leg")]
    assert len(limbs) == 4
    assert all((chain.confidence >= 0.75) == sure for chain in limbs)


@pytest.mark.parametrize("lost", ["hand", "upper_arm"])
def test_a_limb_whose_count_goes_on_elsewhere_is_not_sure(lost: str) -> None:
    last = "finger" if lost == "hand" else "tip"
    joints = []
    for name, above, at in [
        *MAN,
        *[(f"{last}.{s}", f"hand.{s}", (0.9 if s == "L" else -0.9, 1.45, 0.0)) for s in "LR"],
    ]:
        joints.append((name, above, at))
    numbers = {"clavicle": "arm_0", "upper_arm": "arm_1", "forearm": "arm_2", "hand": "arm_3"}
    renamed = [
        (
            numbers.get(n[:-2], n[:-2]) + n[-2:] if n[-2:-1] == "." else n,
            numbers.get(a[:-2], a[:-2]) + a[-2:] if a[-2:-1] == "." else a,
            at,
        )
        for n, a, at in joints
    ]
    loose = numbers[lost]
    flat_part = [(n, "hips" if n.startswith(loose) and n != "hips" else a, at) for n, a, at in renamed]
    found = recognise(rig_with(flat_part)).characters[0].chains
    names = [n for n, _, _ in flat_part]
    for chain in (chain for chain in found if chain.kind == "arm"):
        said = [names[k][:5] for k in chain.bend or chain.joints]
        assert said == ["arm_1", "arm_2", "arm_3"] or chain.confidence < 0.75


def test_what_is_left_over_of_a_guessed_hierarchy_keeps_it() -> None:
    """Before, its joints had the order of the one and the parents of the file: KeyError."""
    rig = rig_with(MAN)
    turned = [*range(1, len(rig)), -1]
    tree = Tree(rig, [*range(len(rig))][::-1], rig.world[:, 3, :3], turned)
    assert left_over(tree, ()) == []


@pytest.mark.parametrize("lost", ["", "L", "LR"])
def test_an_arm_ends_where_its_count_goes_on_at_the_root(lost: str) -> None:
    """Before, clavicle, upper arm and elbow were an arm at 0.96. lost: sides without that hand."""
    blender = {"clavicle": "Shoulder", "upper_arm": "Arm", "forearm": "Arm.001", "hand": "Arm.002"}

    def called(name: str) -> str:
        part, _, side = name.partition(".")
        word, _, count = blender.get(part, part).partition(".")
        return ".".join(filter(None, (word, side, count)))

    loose = ("hips", "hand.L", "hand.R", "foot.L", "foot.R")
    flat = [(called(n), "root" if n in loose else called(a), at) for n, a, at in MAN]
    bent = [(n, a, (x, y, z - 0.09 * n.endswith(".001"))) for n, a, (x, y, z) in flat]
    kept = [each for each in bent if each[0] not in [f"Arm.{side}.002" for side in lost]]
    joints: list[Joint] = [("root", "", (0.0, 0.0, 0.0)), *kept]
    (character,) = recognise(rig_with(joints)).characters
    arms = [[joints[k][0] for k in one.bend] for one in character.chains if one.kind == "arm" and one.is_sure]
    whole = [[f"Arm.{s}", f"Arm.{s}.001", f"Arm.{s}.002"] for s in "LR"]
    assert sorted(arms) == (whole if not lost else [])
