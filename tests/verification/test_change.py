"""Words and short numbers of differences: what differs is shown, however long the values are."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rigtri.maths.quaternions import from_axis_angle, to_axes
from rigtri.verification.checks.gltf.accessor_bounds import fitting
from rigtri.verification.diff.axis_diff import all_moved
from rigtri.verification.diff.change import (
    SHOWN,
    Change,
    arrow,
    furthest,
    number,
    order_of,
    row,
    rows,
    same_numbers,
    same_rows,
    short,
)


def test_a_difference_is_a_line_with_its_sign() -> None:
    assert str(Change("nodes", "added", "'a'")) == "+ 'a'"
    assert str(Change("nodes", "removed", "'a'", "was a joint")) == "- 'a'  was a joint"
    assert [str(Change("", kind, "x"))[0] for kind in ("changed", "moved")] == ["~", ">"]


def test_numbers_have_seven_digits_and_no_noise() -> None:
    assert [number(x) for x in (1.0, -0.0, 1 / 3, 12345678.0)] == ["1", "0", "0.3333333", "1.234568e+07"]
    assert row([1.0, 9e-7, -9e-7, 1.1e-6]) == "1 0 0 1.1e-06"
    assert row(np.array([[1e6, 0.5], [2.0, np.inf]])) == "1000000 0 2 inf"
    assert row([]) == ""


def test_rows_that_read_alike_are_shown_with_all_digits() -> None:
    assert rows([1.0, 2.0], [1.0, 3.0]) == "1 2 → 1 3"
    assert rows([1.0], [1.00000001]) == "1.0 → 1.00000001"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.5, "0.5"),
        ("a  b\n c", "a b c"),
        ("x" * SHOWN, "x" * SHOWN),
        ("x" * (SHOWN + 1), "x" * (SHOWN - 3) + "..."),
    ],
)
def test_a_value_in_a_few_words(value: Any, text: str) -> None:
    assert short(value) == text


def test_of_long_values_the_parts_that_differ_are_shown() -> None:
    assert arrow("a", "b") == "a → b"
    assert arrow("a b", "a  b") == "a b → a  b"
    same = "".join(chr(ord("a") + k % 26) for k in range(100))
    assert arrow(f"{same}!{same}", f"{same}?{same}") == (
        f"...{same[90:]}!{same[:39]}... → ...{same[90:]}?{same[:39]}..."
    )
    assert arrow(f"{same[:58]}1{same}", f"{same[:58]}2{same}").startswith(f"...{same[48:58]}1{same[:10]}")
    early = arrow("  " + same, " " + same)
    assert early == f"...  {same[: SHOWN - 12]}... → ... {same[: SHOWN - 11]}..."


def test_numbers_are_the_same_with_their_shape_sign_and_nan() -> None:
    nan = np.nan
    assert same_numbers([1.0, nan], [1.0, nan], 0.0)
    assert not same_numbers([1.0, 2.0], [[1.0, 2.0]], 0.0)
    assert not same_numbers([0.0], [-0.0], 0.0)
    assert same_numbers([0.0, nan], [-0.0, nan], 0.0)
    assert same_numbers([0.0], [-0.0], 1e-3)
    assert same_numbers([1.0, nan], [1.0009, nan], 1e-3)
    assert not same_numbers([1.0], [1.0011], 1e-3)
    one = np.array([[1.0, 2.0], [3.0, 4.0], [nan, 1.0]])
    other = np.array([[1.0, 2.0], [3.0, 5.0], [nan, 2.0]])
    assert same_rows(one, other, 0.0).tolist() == [True, False, False]
    assert same_rows(one[..., np.newaxis], other[..., np.newaxis], 1.5).tolist() == [True, True, True]
    assert same_rows(one[:0], other[:0], 0.0).tolist() == []


def test_how_many_numbers_differ_and_by_how_much() -> None:
    nan = np.nan
    assert furthest([1.0, 2.0, nan, nan], [1.5, 2.0, nan, 1.0]) == "2 of 4 numbers differ, by up to 0.5"
    assert furthest([np.inf, 3.0], [np.inf, -1.0]) == "1 of 2 numbers differ, by up to 4"


def test_the_order_of_what_both_have() -> None:
    assert order_of(["a", "b", "x"], ["y", "a", "b"]) == ""
    assert order_of(["a", "b", "c"], ["c", "x", "a", "b"]) == "a b c → c a b"


@pytest.mark.parametrize(
    ("stated", "fits"),
    [
        (None, True),
        ([1, 2.0], True),
        ([1 + 1e-6, 2.0], True),
        ([1.1, 2.0], False),
        ([1.0], False),
        ([1.0, 2.0, 3.0], False),
        ([True, 2.0], False),
        (["1", 2.0], False),
        ([1, 10**400], False),
        ([float("nan"), 2.0], False),
        ({"0": 1.0, "1": 2.0}, False),
        ("12", False),
    ],
    ids=repr,
)
def test_bounds_fit_where_they_are_none_or_those_that_are_found(stated: Any, fits: bool) -> None:
    found = np.array([[1.0, 2.0], [5.0, 6.0]])
    assert fitting([stated, [5, 6]], found).tolist() == [fits, True]


def test_frames_differ_in_words_by_rotation_position_and_scale() -> None:
    quarter = to_axes(from_axis_angle([0.0, 0, 1], np.pi / 2))
    before = np.tile(np.eye(4), (5, 1, 1))
    before[:, 3, :3] = (1, 2, 3)
    after = before.copy()
    after[1, :3, :3], after[2, 3, 0], after[3, 1, 1] = quarter, 4.0, 2.0
    after[4, :3, :3] *= 0.5
    assert all_moved(before, after) == [
        f"matrix: {furthest(before[0], after[0])}",
        "rotated 90° about its local +z",
        "position 1 2 3 → 4 2 3",
        "scale 1 1 1 → 1 2 1",
        "scale 1 1 1 → 0.5 0.5 0.5",
    ]
