"""How two meshes differ, in words with numbers by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rigtri.model.mesh import Mesh
from rigtri.verification.diff.mesh_diff import _mesh

POINTS = np.arange(15.0).reshape(5, 3)
MESH = Mesh(
    "body",
    0,
    POINTS,
    0,
    np.array([[0, 1]] * 5),
    np.array([[0.5, 0.5], [0.75, 0.25], [1.0, 0.0], [1.0, 0.0], [0.25, 0.75]]),
    morphs=np.zeros((1, 5, 3)),
    morph_weights=np.array([0.5]),
)


def said(other: Mesh, mesh: Mesh = MESH, tolerance: float = 0.0) -> list[str]:
    return [f"{c.group}: {c.kind} {c.where} {c.text}" for c in _mesh(mesh, other, "body", tolerance)]


def with_item(array: Any, place: Any, value: float) -> Any:
    changed = array.copy()
    changed[place] = value
    return changed


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, []),
        ({"points": POINTS[:3]}, ["meshes: changed body points 5 → 3"]),
        (
            {"points": with_item(POINTS, (1, 2), 5.25)},
            ["meshes: changed body points: 1 of 15 numbers differ, by up to 0.25"],
        ),
        ({"skin": None}, ["meshes: changed body is no longer skinned"]),
        ({"joints": with_item(MESH.joints, (2, 1), 0)}, []),  # of no weight
        (
            {"joints": with_item(MESH.joints, (1, 1), 0)},
            ["skins: changed weights of body 1 of 5 {} differ, by up to 0"],
        ),
        (
            {"weights": with_item(MESH.weights, ([0, 4], [0, 1]), 0.375)},
            ["skins: changed weights of body 2 of 5 {} differ, by up to 0.375"],
        ),
        (
            {"joints": np.zeros((5, 4), np.int64), "weights": np.zeros((5, 4))},
            ["skins: changed weights of body 2 → 4 joints for each {}"],
        ),
        ({"morphs": np.zeros((2, 5, 3))}, ["meshes: changed body morphs 1 → 2"]),
        (
            {"morphs": with_item(MESH.morphs, (0, 1, 1), -0.5)},
            ["meshes: changed body morphs: 1 of 15 numbers differ, by up to 0.5"],
        ),
        ({"morph_weights": np.array([0.75])}, ["meshes: changed body morph weights 0.5 → 0.75"]),
    ],
)
def test_what_differs_is_said_with_its_numbers(change: dict[str, Any], words: list[str]) -> None:
    found = said(replace(MESH, **change))
    options = [[text.format(word) for text in words] for word in ("vertices", "vertex")]
    assert found in options


def test_a_mesh_that_gets_a_skin_and_a_bind_that_moves() -> None:
    assert said(MESH, replace(MESH, skin=None)) == ["meshes: changed body is now skinned"]
    bind = np.eye(4)
    bind[3, 0] = 2.0
    (text,) = said(replace(MESH, bind=bind))
    assert text.startswith("bind pose: changed body geometry bind ")


def test_what_is_within_the_tolerance_is_the_same() -> None:
    near = replace(MESH, points=POINTS + 0.01, weights=MESH.weights + 0.01, morphs=MESH.morphs + 0.01)
    assert said(near, tolerance=0.02) == []
    assert len(said(near, tolerance=0.005)) == 3
