"""What recognition asks of names and joints it asks once: large rigs take as long as they are large."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from calls import calls as calls_of
from places import SAMPLES
from rigs import random_rig, rig_of

from rigtri.formats import read
from rigtri.maths.ranking import ranked
from rigtri.recognition import character_joints, limb_words, name_parsing
from rigtri.recognition.character_joints import groups_of
from rigtri.recognition.joint_roles import parts_of
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.pose_samples import Poses
from rigtri.recognition.recognise import _drafts, recognise


def counted(monkeypatch: pytest.MonkeyPatch, module: Any, name: str) -> list[Any]:
    """What a function of a module is called with, from now on."""
    calls: list[Any] = []
    whole = getattr(module, name)

    def call(*values: Any, **named: Any) -> Any:
        calls.append(values)
        return whole(*values, **named)

    monkeypatch.setattr(module, name, call)
    return calls


def test_a_name_is_cut_into_words_once(monkeypatch: pytest.MonkeyPatch) -> None:
    calls = [counted(monkeypatch, module, "words") for module in (limb_words, name_parsing)]
    name = "asked_once_front_upper_arm_L"
    assert name_parsing.parse_name(name).side == "left"
    assert limb_words.limb_words(name).levels == {"upper": 1.0}
    assert limb_words.other_words(name) == ("asked", "once")
    assert sum(map(len, calls)) == 1


def test_of_many_branches_each_is_measured_once(monkeypatch: pytest.MonkeyPatch) -> None:
    parents, places = [-1, 0, 1, 2, 3, 1, 5, 6], [(0, 1, 0), (0, 1, 0)]
    places += [(side, 0.1 * k, 0) for side in (1, -1) for k in range(3)]
    count = 4
    rig = rig_of(
        [f"n{k}" for k in range(count * len(parents))],
        [above + body * len(parents) if above >= 0 else -1 for body in range(count) for above in parents],
        [(x + 20.0 * body * (above < 0), y, z) for body in range(count)
         for above, (x, y, z) in zip(parents, places, strict=True)],
    )  # fmt: skip
    calls = counted(monkeypatch, character_joints, "pairs_of")
    groups = groups_of(Tree(rig, range(len(rig)), rig.world[:, 3, :3]))
    assert [len(group) for group in groups] == [len(parents)] * count
    assert len(calls) == count


def test_roles_walk_no_branch_of_each_joint(monkeypatch: pytest.MonkeyPatch) -> None:
    (draft,) = _drafts(read(SAMPLES / "biped.glb").rig)
    calls = counted(monkeypatch, Tree, "branch")
    assert {part.role for part in parts_of(draft)} >= {"deform"}
    assert not calls


def test_each_value_is_compared_with_the_largest_of_its_kind_alone() -> None:
    compared = []

    class Value(float):
        def __ge__(self, other: float) -> bool:
            compared.append(self)
            return float.__ge__(self, other)

    values = [Value(k) for k in np.random.default_rng(7).permutation(200)]
    assert ranked(values, lambda value: value, 0.5) == sorted(values, reverse=True)
    assert len(compared) < 2 * len(values)


def test_a_joint_is_below_those_on_its_way_up() -> None:
    """Also of a tree that is not the file's."""
    rig = random_rig(3, joints=12)
    order = np.random.default_rng(3).permutation(len(rig)).tolist()
    above = [-1] * len(rig)
    for k, node in enumerate(order[1:8]):
        above[node] = order[k // 2]
    tree = Tree(rig, order[:8], rig.world[:, 3, :3], above)
    for node in range(len(rig)):
        for other in range(len(rig)):
            assert tree.is_below(node, other) == (other in tree.way(-1, node))
        assert tree.is_below(node, -1)


# Names, shape and doubts of the sample; with a doubt that asks of the whole body for each limb it was 40,260.
_BIPED = 32_000


def test_a_body_is_recognised_in_so_many_calls() -> None:
    recognise(read(SAMPLES / "biped.glb").rig)  # what is found out once for all files
    rig = read(SAMPLES / "biped.glb").rig
    assert calls_of(lambda: recognise(rig)) < _BIPED


def test_where_clips_take_a_body_is_looked_up_once(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = read(SAMPLES / "biped.glb").rig
    poses, nodes = Poses(rig), list(range(len(rig)))
    calls = counted(monkeypatch, Poses, "_travel")
    assert [*poses.travel(nodes)] == [*poses.travel(nodes)] == [*poses.without_names().travel(nodes)]
    assert len(calls) == 1
