"""Marks for machines: what they show, and nothing that is empty or no number."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from rigs import chain, rig_of

import rigtri
from rigtri.export.drawing.primitives import Mark, as_json
from rigtri.export.drawing.scene import follows, limbs
from rigtri.model.bindings import NodeConstraint
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector


def test_a_mark_says_all_that_it_has_and_leaves_out_what_is_empty() -> None:
    points = np.array([[0.0, 1.0, 2.0]])
    assert Mark("dot", "joint", points).as_json() == {
        "form": "dot",
        "kind": "joint",
        "points": [[0.0, 1.0, 2.0]],
    }
    whole = Mark("line", "control", points, "/a", "a_ctl", "a control", 2.0, True, (1.0, 0.5, 0.0), True)
    assert whole.as_json() == {
        "form": "line",
        "kind": "control",
        "points": [[0.0, 1.0, 2.0]],
        "node": "/a",
        "name": "a_ctl",
        "description": "a control",
        "size": 2.0,
        "closed": True,
        "crooked": True,
        "color": [1.0, 0.5, 0.0],
    }


def test_marks_that_are_no_numbers_are_left_out() -> None:
    clear, none = Mark("dot", "node", np.zeros((1, 3))), Mark("dot", "node", np.full((1, 3), np.nan))
    assert clear.clear
    assert not none.clear
    assert as_json([none, clear]) == [clear.as_json()]


def test_lines_of_constraints_go_from_what_is_followed_to_what_follows() -> None:
    rig = rig_of(["a", "b", "c"], [-1, 0, 0], np.zeros((3, 3)))
    kinds: Any = (("aim", 1, 2), ("length", 1, 2), ("roll", 1, 1), ("rotation", 2, 0))
    own = tuple(NodeConstraint(kind, node, source, np.zeros(3)) for kind, node, source in kinds)
    rig = rigtri.constrain(replace(rig, node_constraints=own), child="b", driver=["c", "a"], type="point")
    assert list(follows(rig)) == [("aim", 2, 1), ("rotation", 0, 2), ("point", 2, 1), ("point", 0, 1)]


def test_limbs_with_a_pole_vector_are_those_all_of_whose_joints_are_there() -> None:
    line = chain((0, 0, 0), (1, 0.2, 0), (2, 0.1, 0), (3, 0, 0))
    rig = add_polevector(line, options=AddPolevectorOptions(limb=(("a", "b", "d"),)))
    (pole,) = rig.nodes_of("poleVector")
    assert {limb: node for limb, node in limbs(rig).items() if node >= 0} == {(0, 1, 3): pole}
    lost = replace(rig, names=tuple("x" if name == "b" else name for name in rig.names))
    assert set(limbs(lost).values()) <= {-1}
