"""Sides and twins of nodes, looked up by hand in small rigs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from recognition_bodies.skeletons import MAN, rig_with
from rigs import rig_of

from rigtri.maths.scalar_vector import Vector
from rigtri.model.rig import Rig
from rigtri.recognition import sides
from rigtri.recognition.character_draft import Draft
from rigtri.recognition.layout import Character
from rigtri.recognition.sides import side_of, twin_of, twins

# Two characters below one root, the second with two right arms below its left one and beside it.
NAMES = ["root", "one", "arm_L", "arm_R", "two", "arm_L", "hand", "arm_R", "arm_R", "spine"]
PARENTS = [-1, 0, 1, 1, 0, 4, 5, 4, 5, 4]


def crowd(names: list[str] | None = None, humanoid: Mapping[str, int] | None = None) -> Rig:
    rig = rig_of(names or NAMES, PARENTS, [(0.0, 1.0, 0.0)] * len(PARENTS))
    return replace(rig, humanoid=dict(humanoid or {}))


@pytest.mark.parametrize(
    ("node", "side", "twin"),
    [
        (2, "left", 3),  # they have root and one in common, others only root
        (3, "right", 2),
        (5, "left", 8),  # below it, nearer than the one beside it
        (7, "right", 5),
        (8, "right", 5),
        (6, "", None),
        (9, "", None),
    ],
)
def test_a_twin_is_of_the_same_character(node: int, side: str, twin: int | None) -> None:
    rig = crowd()
    assert side_of(rig, node) == side
    assert twin_of(rig, node) == twin


def test_of_two_that_are_as_near_neither_is_the_twin() -> None:
    rig = replace(crowd(), parents=crowd().parents.copy())
    rig.parents[8] = 4
    assert twin_of(rig, 5) is None
    assert twin_of(rig, 7) == 5


def test_joints_that_mirror_are_those_of_one_side_with_a_twin() -> None:
    assert twins(crowd(), range(len(NAMES)), "left") == {2: 3, 5: 8}
    assert twins(crowd(), range(len(NAMES)), "right") == {3: 2, 7: 5, 8: 5}
    assert twins(crowd(), [3, 5], "left") == {5: 8}


def test_the_bones_of_an_avatar_say_more_than_names() -> None:
    rig = crowd(humanoid={"leftHand": 3, "rightHand": 9, "leftFoot": 7, "spine": 2})
    assert [side_of(rig, node) for node in (3, 9, 7, 2)] == ["left", "right", "left", "left"]
    assert [twin_of(rig, node) for node in (3, 9, 7, 2)] == [9, 3, None, 3]


def test_a_joint_s_twin_is_a_joint() -> None:
    """A mesh of the same name beside the joint is none."""
    rig = rig_with([("root", "", (0, 0, 0)), ("arm_L", "root", (1, 0, 0)), ("arm_R", "root", (-1, 0, 0))])
    more = rig_of([*rig.names, "arm_R"], [-1, 0, 0, 0], [(0.0, 0.0, 0.0)] * 4, skins=rig.skins)
    assert twin_of(more, 1) == 2
    assert twin_of(more, 3) is None


def test_without_sides_in_names_the_shape_tells_twins() -> None:
    """A man whose joints are numbered: of each limb, and of it alone, the joint at the same place."""
    rig = rig_with(MAN)
    numbered = replace(rig, names=tuple(f"bone{k}" for k in range(len(rig))))
    limbs = {"upper_arm", "forearm", "hand", "thigh", "shin", "foot"}
    for node, name in enumerate(rig.names):
        if name.removesuffix(".L").removesuffix(".R") in limbs:
            other = name[:-1] + {"L": "R", "R": "L"}[name[-1]]
            assert twin_of(numbered, node) == rig.find(other)
            assert side_of(numbered, node) == {"L": "left", "R": "right"}[name[-1]]
        elif "." not in name:
            assert twin_of(numbered, node) is None
            assert side_of(numbered, node) == ""


@pytest.mark.parametrize(
    ("limbs", "found"),
    [
        ([("left arm", "left", [1, 2]), ("right arm", "right", [5, 6])], {1: 5, 2: 6, 5: 1, 6: 2}),
        ([("left arm", "left", [1, 2]), ("right arm", "right", [5, 6, 7])], {}),  # not joint for joint
        ([("left arm", "left", [1]), ("left arm", "left", [2]), ("right arm", "right", [5])], {}),
        ([("left arm", "left", [1]), ("right arm", "right", [5]), ("right arm", "right", [6])], {}),
        ([("left arm", "left", [1]), ("tail", "", [8])], {}),
    ],
)
def test_limbs_of_two_sides_are_twins_where_each_is_the_only_one_of_its_name(
    monkeypatch: pytest.MonkeyPatch, limbs: list[tuple[str, str, list[int]]], found: dict[int, int]
) -> None:
    chains = [SimpleNamespace(name=name, side=side, joints=joints) for name, side, joints in limbs]
    body = SimpleNamespace(sure_chains=chains, bones={}, gives_axes=False)
    monkeypatch.setattr(sides, "recognise", lambda rig: SimpleNamespace(characters=[body]))
    assert {node: other for node, (_, other) in sides._by_shape(crowd())} == found


@pytest.mark.parametrize(("axes", "found"), [(True, {3: ("left", 7), 7: ("right", 3)}), (False, {})])
def test_bones_of_a_recognised_body_are_twins_where_it_gives_axes(
    monkeypatch: pytest.MonkeyPatch, axes: bool, found: dict[int, object]
) -> None:
    bones = {"leftHand": 3, "rightHand": 7, "leftFoot": 5, "hips": 1}
    body = SimpleNamespace(sure_chains=[], bones=bones, gives_axes=axes)
    monkeypatch.setattr(sides, "recognise", lambda rig: SimpleNamespace(characters=[body]))
    assert dict(sides._by_shape(crowd())) == found


def test_joints_are_on_the_side_where_the_farthest_of_them_stands() -> None:
    at = [Vector(0, 1, 0), Vector(0.1, 0, 0), Vector(-0.5, 0, 0)]
    tree = SimpleNamespace(at=at)
    draft: Any = SimpleNamespace(left=Vector(1, 0, 0), tree=tree)
    draft.shape = SimpleNamespace(plane=SimpleNamespace(point=Vector()))
    sides = [Draft.side_of(draft, nodes) for nodes in ([0], [1], [2], [0, 1], [1, 2])]
    assert sides == ["", "left", "right", "left", "right"]
    draft.left = Vector()
    assert Draft.side_of(draft, [1]) == ""
    draft.left, draft.shape = Vector(1, 0, 0), SimpleNamespace(plane=None)
    assert Draft.side_of(draft, [1]) == ""


@pytest.mark.parametrize("seed", range(4))
def test_a_body_is_mirrored_whose_left_is_on_the_right_of_where_it_faces(seed: int) -> None:
    up, facing, across = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    left = np.cross(up, facing)
    for normal, mirrored in ((left, False), (-left, True), (left + 2.0 * facing - up, False)):
        body: Any = SimpleNamespace(up=up.tolist(), facing=facing.tolist(), normal=normal.tolist())
        assert Character.is_mirrored.fget(body) is mirrored  # type: ignore[attr-defined]
    assert np.allclose(np.abs(across @ left), 1.0)


@pytest.mark.parametrize(("left", "right"), [("LF", "RF"), ("FL", "FR"), ("LH", "RH"), ("BL", "BR")])
def test_corners_of_an_animal_are_twins_beside_ears_that_names_say_are(left: str, right: str) -> None:
    """Before, ears with sides in their names hid the legs from mirror, which left them out without a word."""
    names = ["root", "one", f"{left}_thigh", f"{right}_thigh", "two", f"{left}_thigh", f"{left}_shin"]
    names += [f"{right}_thigh", "ear.L", "ear.R"]
    rig = crowd(names)
    assert [side_of(rig, node) for node in (2, 3, 8)] == ["left", "right", "left"]
    assert [twin_of(rig, node) for node in (2, 3, 5, 7, 6, 8)] == [3, 2, 7, 5, None, 9]
