"""What each kind of constraint makes of its child, by hand: drivers, weights, offsets, skipped channels."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from rigtri.evaluation.constraint_solver import (
    constraint_pole,
    evaluate_constraint,
    rotate_of,
    to_parts,
    twist_about_axis,
)
from rigtri.maths.matrices import compose
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.constraints import Constraint

X, Y, Z = np.eye(3)
NONE = np.array([0.0, 0.0, 0.0, 1.0])


def turn(axis: Any, degrees: float) -> Floats:
    return from_axis_angle(np.array(axis, dtype=np.float64), np.radians(degrees))


def place(at: Any = (0, 0, 0), rotation: Floats = NONE, scale: Any = (1, 1, 1)) -> Floats:
    return compose(np.array(at, dtype=np.float64), rotation, np.array(scale, dtype=np.float64))


def rule(kind: Any, count: int = 1, weights: Any = None, offsets: Any = None, **more: Any) -> Constraint:
    given = np.ones(count) if weights is None else np.array(weights, dtype=np.float64)
    each = np.tile(np.eye(4), (count, 1, 1)) if offsets is None else np.stack(offsets)
    return Constraint(kind, 0, tuple(range(1, count + 1)), given, each, **more)


def child(
    made: Constraint, *drivers: Floats, parent: Floats | None = None, own: Floats | None = None, **more: Any
) -> Any:
    """Translation, rotation and scale of the child's local matrix."""
    parent, own = (np.eye(4) if each is None else each for each in (parent, own))
    found = evaluate_constraint(
        made, np.stack(drivers)[np.newaxis], parent[np.newaxis], own[np.newaxis], **more
    )
    return [part[0] for part in to_parts(found)]


def alike(a: Any, b: Any) -> None:
    assert_allclose(a if np.dot(a, b) >= 0 else -np.asarray(a), b, atol=1e-9)


def test_a_point_is_the_mean_of_its_drivers_and_keeps_the_rest() -> None:
    own = place((7, 8, 9), turn(X, 30), (2, 2, 2))
    made = rule("point", 2, [1, 3], [place((0, 1, 0)), place((0, 2, 0))])
    at, rotation, scale = child(made, place((4, 0, 0), turn(Z, 90)), place((0, 0, 8)), own=own)
    assert_allclose(at, [1.0, 1.75, 6.0])
    alike(rotation, turn(X, 30))
    assert_allclose(scale, [2, 2, 2])
    parent = place((1, 1, 1), turn(Z, 90), (2, 2, 2))
    at, *_ = child(rule("point"), place((1, 5, 3)), parent=parent, own=own)
    assert_allclose(at, [2, 0, 1], atol=1e-12)


def test_skipped_channels_stay_the_child_s_own() -> None:
    own = place((7, 8, 9), turn(X, 30), (2, 3, 4))
    at, *_ = child(rule("point", skip=frozenset({"ty"})), place((1, 2, 3)), own=own)
    assert_allclose(at, [1, 8, 3])
    made = rule("parent", skip=frozenset({"tx", "sz"}))
    at, _, scale = child(made, place((1, 2, 3), NONE, (5, 5, 5)), own=own)
    assert_allclose(at, [7, 2, 3])
    assert_allclose(scale, [5, 5, 4])
    made = rule("orient", skip=frozenset({"rx"}))
    _, rotation, _ = child(made, place(rotation=turn(Z, 40)), own=own)
    assert_allclose(np.degrees(rotate_of(made, rotation)), [30, 0, 40], atol=1e-9)


def test_a_driver_that_is_no_number_or_has_no_weight_does_not_count() -> None:
    gone = np.full((4, 4), np.nan)
    at, *_ = child(rule("point", 3, [1, 0, 1]), place((4, 0, 0)), place((9, 9, 9)), gone)
    assert_allclose(at, [4, 0, 0])
    own = place((7, 8, 9))
    for kind in ("point", "parent", "orient", "scale"):
        at, *_ = child(rule(kind), gone, own=own)
        assert_allclose(at, [7, 8, 9])
        at, *_ = child(rule(kind, weights=[0.0]), place((1, 1, 1)), own=own)
        assert_allclose(at, [7, 8, 9])


def test_a_parent_carries_the_child_at_its_offset() -> None:
    driver, offset = place((5, 0, 0), turn(Z, 90), (2, 2, 2)), place((1, 0, 0), turn(X, 20))
    at, rotation, scale = child(rule("parent", offsets=[offset]), driver)
    assert_allclose(at, [5, 2, 0], atol=1e-12)
    alike(rotation, multiply(turn(Z, 90), turn(X, 20)))
    assert_allclose(scale, [2, 2, 2])
    at, rotation, scale = child(rule("parent", 2, [3, 1]), place(), place((8, 0, 0), turn(Z, 0), (5, 5, 5)))
    assert_allclose(at, [2, 0, 0])
    assert_allclose(scale, [2, 2, 2])


def test_orientations_are_taken_over_seen_from_the_parent() -> None:
    parent = place((1, 2, 3), turn(Z, 30), (2, 2, 2))
    _, rotation, scale = child(
        rule("orient"), place((9, 9, 9), turn(Z, 100)), parent=parent, own=place(scale=(3, 3, 3))
    )
    alike(rotation, turn(Z, 70))
    assert_allclose(scale, [3, 3, 3])
    offset = place(rotation=turn(X, 50))
    _, rotation, _ = child(rule("orient", offsets=[offset]), place(rotation=turn(Z, 90)))
    alike(rotation, multiply(turn(Z, 90), turn(X, 50)))
    _, rotation, _ = child(rule("orient", 2), place(rotation=turn(Z, 20)), place(rotation=turn(Z, 60)))
    alike(rotation, turn(Z, 40))
    # As the driver has turned in its own axes.
    _, rotation, _ = child(
        rule("orient", offsets=[offset], space="local"), place(rotation=turn(Z, 90)), parent=parent
    )
    alike(rotation, multiply(turn(X, 50), turn(Z, 90)))


def test_of_a_roll_only_the_part_about_the_axis_counts() -> None:
    made = rule("orient", space="roll", roll="x", rest=turn(Y, 40))
    driver = multiply(turn(Y, 40), turn(X, 70))
    _, rotation, _ = child(made, place(rotation=driver))
    alike(rotation, multiply(turn(Y, 40), turn(X, 70)))
    alike(twist_about_axis(multiply(turn(Z, 30), turn(X, 70)), "x"), turn(X, 70))
    assert twist_about_axis(turn(Z, 180), "x").tolist() == NONE.tolist()
    assert np.isnan(twist_about_axis(np.full(4, np.nan), "x")).all()


def test_a_scale_is_as_long_in_the_world_as_the_driver_s() -> None:
    parent = place((1, 1, 1), turn(Z, 90), (2, 4, 1))
    made = rule("scale", offsets=[np.diag([1.0, 3.0, 1.0, 1.0])])
    at, _, scale = child(
        made,
        place((9, 9, 9), turn(X, 45), (4, 5, 6)),
        parent=parent,
        own=place((7, 8, 9), scale=(-1, -1, -1)),
    )
    assert_allclose(scale, [-4 / 2, -15 / 4, -6 / 1])  # mirrored as its own
    assert_allclose(at, [7, 8, 9])
    _, _, scale = child(rule("scale", 2, [1, 3]), place(scale=(1, 1, 1)), place(scale=(5, 5, 5)))
    assert_allclose(scale, [4, 4, 4])


AIM: dict[str, Any] = {"aim": (1.0, 0.0, 0.0), "up": (0.0, 1.0, 0.0)}


def test_an_aim_points_at_the_mean_of_its_drivers() -> None:
    own = place((1, 1, 0))
    made = rule("aim", 2, [1, 1], [np.eye(4)], **AIM, world_up="none")
    _, rotation, _ = child(made, place((1, 4, 0)), place((1, 6, 0)), own=own)
    alike(rotation, turn(Z, 90))
    _, rotation, _ = child(rule("aim", **AIM, world_up="none", rest=turn(X, 30)), place((1, 4, 0)), own=own)
    alike(rotation, multiply(turn(Z, 90), turn(X, 30)))
    # Where the driver stands in it, its own.
    own = place((1, 1, 0), turn(Y, 25))
    _, rotation, _ = child(rule("aim", **AIM, world_up="none"), place((1, 1, 0)), own=own)
    alike(rotation, turn(Y, 25))


@pytest.mark.parametrize(
    ("world_up", "vector", "up", "rotation"),
    [
        ("vector", (0.0, 0.0, 1.0), None, turn(X, 90)),
        ("vector", (0.0, 0.0, -2.0), None, turn(X, -90)),
        ("vector", (1.0, 0.0, 0.0), None, NONE),  # along the aim: as without
        ("objectrotation", (0.0, 1.0, 0.0), place((9, 9, 9), turn(X, 90)), turn(X, 90)),
        ("object", (0.0, 1.0, 0.0), place((1, 1, 5)), turn(X, 90)),
        ("object", (0.0, 1.0, 0.0), place((1, -5, 0)), turn(X, 180)),
    ],
)
def test_the_up_axis_of_an_aim_leans_to_where_it_is_told(
    world_up: Any, vector: Any, up: Any, rotation: Floats
) -> None:
    made = rule("aim", **AIM, world_up=world_up, up_vector=vector, up_object=2 if up is not None else -1)
    more = {} if up is None else {"up": up[np.newaxis]}
    _, found, _ = child(made, place((5, 1, 0)), own=place((1, 1, 0)), **more)
    alike(found, rotation)


def test_an_aim_is_in_the_space_of_its_parent_and_has_an_offset() -> None:
    parent = place((0, 0, 0), turn(Z, 90))
    made = rule(
        "aim", offsets=[place(rotation=turn(X, 35))], **AIM, world_up="vector", up_vector=(0.0, 0.0, 1.0)
    )
    _, rotation, _ = child(made, place((0, 7, 0)), parent=parent)
    alike(rotation, multiply(turn(X, 90), turn(X, 35)))


def test_a_pole_is_the_mean_of_places_in_the_axes_of_the_drivers() -> None:
    made = rule("polevector", 2, [1, 3], [place((1, 0, 0)), place((0, 0, 2))])
    drivers = np.stack([place((0, 0, 0), turn(Z, 90)), place((4, 0, 0))])[np.newaxis]
    assert_allclose(constraint_pole(made, drivers), [[3.0, 0.25, 1.5]], atol=1e-12)
    assert np.isnan(constraint_pole(rule("polevector", weights=[0.0]), drivers[:, :1])).all()
