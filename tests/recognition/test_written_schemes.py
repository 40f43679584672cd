"""What is wrong with a table of names, each in words that say what to write."""

from __future__ import annotations

from typing import Any

import pytest

from rigtri.recognition.naming_schemes import FINGERS, _of_skeleton, _of_written

FINGER = FINGERS[0]


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ({FINGER: ["a", "b", "c"]}, ""),
        ({FINGER: []}, ""),
        ({FINGER: ["a", "b", "c", "d"]}, f"[write] {FINGER} is a list: give a list of up to three names"),
        ({FINGER: ["a", 1]}, f"[write] {FINGER} is a list: give a list of up to three names"),
        ({FINGER: "abc"}, f"[write] {FINGER} is a text: give a list of up to three names"),
        ({"Spine": ["a", "b", "c", "d"]}, ""),
        ({"Spine": "abc"}, "[write] Spine is a text: give a list of names, root to tip"),
        ({"hips": "Pelvis"}, ""),
        ({"hips": ""}, "[write] hips is a text: give a name in quotes"),
        ({"hips": 3}, "[write] hips is a number: give a name in quotes"),
        ({"hips": True}, "[write] hips is true or false: give a name in quotes"),
        ({"sided": "{name}_{s}"}, ""),
        ({"sided": "x_{s}"}, "[write] sided: it has no {name}"),
        ({"hipz": "x"}, "[write] hipz: there is no such bone. Did you mean"),
        ({"wheel": "x"}, "[write] wheel: there is no such bone. There are sided"),
        (["hips"], "'write' is a list: make it a table"),
        ("hips", "'write' is a text: make it a table"),
    ],
)
def test_what_is_wrong_with_written_names(value: Any, said: str) -> None:
    found = list(_of_written(value))
    assert len(found) == bool(said)
    assert all(one.startswith(said) for one in found)


def test_a_skeleton_is_a_table_of_texts() -> None:
    assert next(_of_skeleton(3)).startswith("'skeleton' is a number: make it a table")
    assert next(_of_skeleton({"wheels": "x"})).startswith("[skeleton]: there is no 'wheels'.")
