"""Constraints as nodes store them: each kind comes back as it was, and damaged ones are left out."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from rigs import chain

from rigtri.model.constraints import Constraint, constraint_of, constraint_record, constraints_of
from rigtri.model.rig import Rig

TURN = np.array([0.0, 0.6, 0.0, 0.8])


def rig() -> Rig:
    return chain(*((float(k), 0.0, 0.0) for k in range(8)))


def offsets(count: int) -> Any:
    made = np.tile(np.eye(4), (count, 1, 1))
    made[:, 3, :3] = np.arange(3.0 * count).reshape(count, 3)
    return made


def made(kind: Any, **more: Any) -> Constraint:
    given: dict[str, Any] = {"weights": np.array([1.0, 0.5]), "offsets": offsets(1 if kind == "aim" else 2)}
    return Constraint(kind, 5, (1, 2), **(given | more))


KINDS = {
    "parent": made(
        "parent", skip=frozenset({"tx", "rz"}), order="zyx", joint_orient=TURN, weight_nodes=(6, 7)
    ),
    "point": made("point", skip=frozenset({"ty"})),
    "orient": made("orient", joint_orient=TURN),
    "local": made("orient", space="local"),
    "roll": made("orient", space="roll", roll="y", rest=TURN),
    "scale": made("scale", skip=frozenset({"sx"})),
    "aim": made("aim", aim=(0.0, 0.0, -1.0), up=(1.0, 0.0, 0.0), world_up="none", rest=TURN),
    "aim, vector": made("aim", world_up="vector", up_vector=(0.0, 0.6, 0.8)),
    "aim, object": made("aim", world_up="object", up_object=3),
    "aim, rotation": made("aim", world_up="objectrotation", up_object=3, up_vector=(1.0, 0.0, 0.0)),
    "polevector": made("polevector", chain=(3, 4, 5)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_constraint_comes_back_as_it_was(kind: str) -> None:
    rule, whole = KINDS[kind], rig()
    found = constraint_of(whole, constraint_record(whole, rule))
    for each in fields(Constraint):
        was, now = getattr(rule, each.name), getattr(found, each.name)
        assert np.array_equal(was, now) if isinstance(was, np.ndarray) else was == now, each.name


def test_what_a_kind_has_no_use_for_is_not_stored() -> None:
    whole = rig()
    used = {
        kind: {
            name
            for name in (
                "rotate_order",
                "joint_orient",
                "rest",
                "space",
                "roll_axis",
                "aim",
                "up",
                "world_up",
            )
            if getattr(constraint_record(whole, rule), name) is not None
        }
        for kind, rule in KINDS.items()
    }
    turns = {"rotate_order", "joint_orient"}
    assert used["point"] == used["scale"] == used["polevector"] == set()
    assert used["parent"] == turns
    assert used["orient"] == used["local"] == turns | {"space"}
    assert used["roll"] == turns | {"space", "rest", "roll_axis"}
    assert used["aim"] == turns | {"rest", "aim", "up", "world_up"}
    vectors = {
        kind for kind, rule in KINDS.items() if constraint_record(whole, rule).world_up_vector is not None
    }
    assert vectors == {"aim, vector", "aim, rotation"}
    objects = {kind for kind, rule in KINDS.items() if constraint_record(whole, rule).world_up_object}
    assert objects == {"aim, object", "aim, rotation"}


def stored(kind: str, **changes: Any) -> Rig:
    whole = rig()
    record = {**constraint_record(whole, KINDS[kind]).to_dict(), **changes}
    return replace(whole, metadata={7: {key: value for key, value in record.items() if value is not None}})


@pytest.mark.parametrize(
    ("kind", "changes", "there"),
    [
        ("parent", {}, True),
        ("parent", {"weights": [1.0]}, False),
        ("parent", {"weights": [1.0, -0.5]}, False),
        ("parent", {"weights": [0.0, 0.0]}, True),
        ("parent", {"weightNodes": ["g"]}, False),
        ("parent", {"weightNodes": None}, True),
        ("parent", {"offsets": [0.0] * 16}, False),
        ("parent", {"child": "nobody"}, False),
        ("parent", {"drivers": ["b", "nobody"]}, False),
        ("aim", {"offsets": [0.0] * 32}, False),
        ("roll", {"rollAxis": None}, False),
        ("orient", {"rollAxis": "x"}, False),
        ("polevector", {"chain": ["c", "d"]}, False),
        ("polevector", {"chain": ["c", "d", "nobody"]}, False),
        ("aim, object", {"worldUpObject": "nobody"}, False),
    ],
)
def test_constraints_that_do_not_fit_or_are_of_unknown_nodes_are_left_out(
    kind: str, changes: dict[str, Any], there: bool
) -> None:
    assert bool(constraints_of(stored(kind, **changes))) is there


def test_what_a_constraint_sets_looks_at_and_whether_it_does_anything() -> None:
    assert KINDS["parent"].sets == {"ty", "tz", "rx", "ry", "sx", "sy", "sz"}
    assert KINDS["point"].sets == {"tx", "tz"}
    assert KINDS["polevector"].sets == set()
    assert KINDS["point"].sources == (1, 2)
    assert KINDS["aim, object"].sources == (1, 2, 3)
    assert replace(KINDS["point"], up_object=0).sources == (1, 2, 0)
    assert KINDS["point"].active
    assert not replace(KINDS["point"], weights=np.zeros(2)).active
    assert replace(KINDS["point"], weights=np.zeros(2), weight_nodes=(6, 7)).active
