"""The verdict of a comparison in words and numbers: what passes, and what people and machines read."""

from __future__ import annotations

from typing import Any

import pytest

from rigtri.verification.compare.verdict import Comparison, Motion, Worst

NAN, INF = float("nan"), float("inf")
WORST = Worst("body", "walk", 1.5)
UNCHANGED = "; everything that was in the file is unchanged"
STORED = "; rotations as stored: 0.002, off unit length by 0.0005"


def compared(**found: Any) -> Comparison:
    """What a comparison of 7 poses found: nothing, but for ``found``."""
    nothing: dict[str, Any] = {
        "deviation": 0.0,
        "absolute": 0.0,
        "diagonal": 4.0,
        "raw_deviation": 0.0,
        "denormalisation": 0.0,
        "worst": None,
        "poses": 7,
    }
    empty = {name: {} for name in ("per_mesh", "per_clip")}
    lists = dict.fromkeys(("lost", "added", "changed", "different"), ())
    return Comparison(**(nothing | empty | lists | found))


@pytest.mark.parametrize(
    ("found", "largest"),
    [
        ({"deviation": 1e-6, "raw_deviation": 2e-3}, 1e-6),
        ({"deviation": 1e-6, "raw_deviation": 2e-3, "raw_counts": True}, 2e-3),
        ({"deviation": 2e-3, "raw_deviation": 1e-6, "raw_counts": True}, 2e-3),
        ({"deviation": 1e-6, "raw_deviation": INF, "raw_counts": True}, INF),
    ],
)
def test_rotations_as_stored_count_where_the_formats_own_viewer_takes_them_so(
    found: dict[str, Any], largest: float
) -> None:
    result = compared(**found)
    assert result.largest_deviation == largest
    assert result.passes(largest)
    assert not result.passes(largest * 0.99) or largest == INF


def test_what_is_no_number_or_lost_or_different_never_passes() -> None:
    assert not compared(deviation=0.0, raw_deviation=NAN, raw_counts=True).passes()
    assert not compared(deviation=NAN).passes()
    assert not compared(lost=("mesh body",)).passes()
    assert not compared(different=("mesh body: material",)).passes()
    assert compared(added=("joint a",), changed=("joint b",)).passes()


@pytest.mark.parametrize(
    ("found", "identical"),
    [
        ({"poses": 0}, True),
        ({}, False),
        *(
            ({"poses": 0, name: ("a",)}, name == "added")
            for name in ("lost", "added", "changed", "different")
        ),
        ({"poses": 0, "motion": Motion(0.0, None, {})}, False),
    ],
)
def test_only_what_needed_no_pose_and_declared_nothing_is_identical(
    found: dict[str, Any], identical: bool
) -> None:
    assert compared(**found).identical == identical


@pytest.mark.parametrize(
    ("found", "line"),
    [
        ({}, "largest vertex movement: 0 of the model's size"),
        ({"poses": 0}, f"largest vertex movement: 0 of the model's size{UNCHANGED}"),
        (
            {"deviation": 0.001, "worst": WORST},
            "largest vertex movement: 0.001 of the model's size; at body, walk at 1.5",
        ),
        ({"worst": WORST}, "largest vertex movement: 0 of the model's size"),
        (
            {"raw_deviation": 0.002, "denormalisation": 5e-4},
            f"largest vertex movement: 0 of the model's size{STORED}",
        ),
        ({"raw_deviation": 0.002, "denormalisation": 1e-4}, "largest vertex movement: 0 of the model's size"),
        (
            {"raw_deviation": 0.002, "denormalisation": 5e-5, "raw_counts": True},
            "largest vertex movement: 0.002 of the model's size; rotations as stored: 0.002, off unit length "
            "by 5e-05",
        ),
        (
            {"per_mesh": {"hat": NAN, "body": 0.0}},
            "largest vertex movement: 0 of the model's size; nothing could be measured of hat: nothing of it "
            "is a number in either file",
        ),
        (
            {"boxed": ("a", "b")},
            "largest vertex movement: 0 of the model's size; 2 large meshes bounded by th",
        ),
        ({"lost": ("a", "b", "c")}, "lost: a, b, c; what both have does not move"),
        ({"lost": ("a", "b", "c", "d"), "poses": 0}, "lost: a, b, c ...; no pose was compared"),
        (
            {"different": ("a",), "deviation": 0.5},
            "largest vertex movement: 0.5 of the model's size; different: a",
        ),
        (
            {"motion": Motion(0.5, WORST, {}, {"hat": 0.1, "face": 0.2})},
            "largest deviation from the intended result: 0 of the model's size; motion differs from IN by up "
            "to 0.5 of the model's size (body, walk at 1.5)",
        ),
        (
            {"motion": Motion(0.0, None, {})},
            "largest deviation from the intended result: 0 of the model's size; everything that IN shows "
            "moves as in IN",
        ),
    ],
)
def test_a_line_says_how_far_and_what_else(found: dict[str, Any], line: str) -> None:
    said = compared(**found).summary()
    assert said.startswith(line) if line.endswith(" th") else said == line


def test_the_limit_stands_beside_the_figure() -> None:
    assert compared().summary(1e-5) == "largest vertex movement: 0 of the model's size (limit 1e-05)"


def test_where_it_is_has_a_time_but_for_the_defaults_of_usd() -> None:
    assert str(Worst("body", "", 0.0)) == "body, at rest"
    assert str(Worst("body", "walk@default", 3.0)) == "body, walk@default"


@pytest.mark.parametrize(
    ("found", "lines"),
    [
        ({"poses": 0, "lost": ("a",)}, ["deviation   not measured: no pose was compared", "lost        a"]),
        (
            {"poses": 0},
            [
                "deviation   0 of the model's size, nothing can have moved",
                "absolute    0 of 4, in file units",
            ],
        ),
        (
            {"poses": 1, "deviation": 0.5, "absolute": 2.0, "worst": WORST, "per_clip": {"walk": 0.5}},
            [
                "deviation   0.5 of the model's size, in 1 pose",
                "absolute    2 of 4, in file units",
                "worst       body, walk at 1.5",
                "clip        0.5       walk",
            ],
        ),
        (
            {"worst": WORST, "denormalisation": 2e-6, "per_mesh": {"a": 0.1, "hat": NAN, "b": 0.2}},
            [
                "deviation   0 of the model's size, in 7 poses",
                "absolute    0 of 4, in file units",
                "unadjusted  0 of the size where rotations are not normalised; the source's are off unit "
                "length by 2e-06",
                "mesh        -         hat: nothing could be measured, nothing of it is a number in either "
                "file",
                "mesh        0.2       b",
                "mesh        0.1       a",
            ],
        ),
        (
            {"denormalisation": 1e-6, "added": tuple("abcdef"), "changed": ("x",)},
            [
                "deviation   0 of the model's size, in 7 poses",
                "absolute    0 of 4, in file units",
                *(f"added       {name}" for name in "abcde"),
                "changed     x",
            ],
        ),
    ],
)
def test_people_read_the_figure_first_and_five_rows_of_each_kind(
    found: dict[str, Any], lines: list[str]
) -> None:
    result = compared(**found)
    assert result.describe().splitlines() == lines
    more = len(result.describe(verbose=True).splitlines()) - len(lines)
    assert more == max(0, len(result.added) - 5)


def test_machines_read_null_where_there_is_no_number() -> None:
    found = compared(deviation=INF, absolute=NAN, worst=WORST, per_mesh={"a": NAN, "b": 0.5}).as_json()
    assert (found["deviation"], found["absolute"]) == (None, None)
    assert found["meshes"] == {"a": None, "b": 0.5}
    assert found["worst"] == {"what": "body", "clip": "walk", "time": 1.5}
    plain = compared(deviation=0.5, absolute=2.0).as_json()
    assert (plain["deviation"], plain["absolute"], plain["worst"]) == (0.5, 2.0, None)
    assert "motion" not in plain
    unmeasured = compared(poses=0, lost=("a",)).as_json()
    assert (unmeasured["deviation"], unmeasured["absolute"]) == (None, None)
    moved = compared(motion=Motion(0.0, WORST, {"walk": INF}, {"face": 0.1})).as_json()["motion"]
    assert moved == {"deviation": 0.0, "worst": None, "clips": {"walk": None}, "meshes": {"face": 0.1}}
    assert Motion(0.5, WORST, {}).as_json()["worst"] == WORST.as_json()


def test_of_what_is_unseen_people_read_five_and_how_many_more() -> None:
    variants = tuple(f"variant {k}" for k in range(7))
    few, many = compared(unseen=variants[:5]), compared(unseen=variants)
    lines = [f"unseen      not compared: {each}" for each in variants]
    assert few.describe().splitlines()[-5:] == lines[:5]
    assert many.describe().splitlines()[-6:] == [*lines[:5], "unseen      and 2 more (all with -v)"]
    assert many.describe(verbose=True).splitlines()[-7:] == lines
