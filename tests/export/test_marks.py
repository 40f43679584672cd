"""Marks for machines: what they show, and nothing that is empty or no number."""

from __future__ import annotations

import numpy as np

from rigtri.export.drawing.primitives import Mark, as_json


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
