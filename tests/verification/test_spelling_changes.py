"""How two JSON texts are spelled: indentation, ends, marks; and values on one line."""

from __future__ import annotations

import pytest

from rigtri.verification.diff.change import SHOWN
from rigtri.verification.diff.json_diff import _arrow, spelled, spelling_changes


def said(before: str, after: str) -> list[str]:
    return [str(change) for change in spelling_changes(before, after)]


def test_a_byte_order_mark_is_added_or_removed() -> None:
    assert said("\ufeff{}", "\ufeff{}") == said("{}", "{}") == []
    assert said("{}", "\ufeff{}") == ["+ byte order mark"]
    assert said("\ufeff{}", "{}") == ["- byte order mark"]


@pytest.mark.parametrize(
    ("after", "name"),
    [
        ('{\n    "a": [\n        1,\n        2\n    ]\n}', "indent"),
        ('{"a": [1, 2]}', ""),
        ('{\n  "a": [\n    1,\n    2\n  ]\n}\n', "blanks at the end"),
        ('{\r\n  "a": [\r\n    1,\r\n    2\r\n  ]\r\n}', ""),
    ],
)
def test_habits_that_differ_are_named(after: str, name: str) -> None:
    before = '{\n  "a": [\n    1,\n    2\n  ]\n}'
    found = said(before, after)
    assert found
    assert not name or any(line.startswith(f"~ {name}") for line in found)
    assert all(" → " in line for line in found)
    assert said(after, after) == []


def test_values_stand_on_one_line_and_are_cut_off() -> None:
    assert spelled({"a": ["ä", {"b": None}], "c": True}) == '{"a": ["ä", {"b": null}], "c": true}'
    long = "x" * 100
    assert spelled(long) == f'"{long[: SHOWN - 4]}...'
    assert spelled("x" * (SHOWN - 2)) == '"' + "x" * (SHOWN - 2) + '"'


def test_of_texts_that_read_alike_the_place_is_told() -> None:
    assert _arrow("a", "b") == '"a" → "b"'
    long = "x" * 80
    assert _arrow(f"{long}1yy", f"{long}2y") == "83 → 82 characters, the first other one at 80"
    assert _arrow(long, f"{long}2") == "80 → 81 characters, the first other one at 0"
