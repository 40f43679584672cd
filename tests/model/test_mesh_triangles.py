"""Triangles of meshes, which of them are flat, and the nearest one to a point, by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from rigtri.errors import FileError, GeometryError
from rigtri.model.mesh import Mesh, Surface
from rigtri.model.mesh_triangles import FLAT, flat, nearest, triangles, vertices_of


def mesh(kind: str, corners: list[int], sizes: tuple[int, ...] = (), points: int = 8) -> Mesh:
    surface = Surface(
        kind, np.array(sizes, dtype=np.int64), np.array(corners, dtype=np.int64), np.zeros((0, 3))
    )
    return Mesh("m", 0, np.zeros((points, 3)), surface=lambda: surface)


@pytest.mark.parametrize(
    ("kind", "corners", "sizes", "found"),
    [
        ("triangles", [0, 1, 2, 3, 4, 5, 6], (), [[0, 1, 2], [3, 4, 5]]),
        ("triangle strip", [0, 1, 2, 3, 4], (), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]),
        ("triangle fan", [5, 1, 2, 3], (), [[5, 1, 2], [5, 2, 3]]),
        ("Mesh", [0, 1, 2, 3, 4, 5, 6, 7, 0], (4, 0, 2, 3), [[0, 1, 2], [0, 2, 3], [6, 7, 0]]),
        ("lines", [0, 1, 2], (), []),
        ("points", [0, 1, 2], (), []),
    ],
)
def test_faces_are_cut_into_triangles(
    kind: str, corners: list[int], sizes: tuple[int, ...], found: Any
) -> None:
    assert triangles(mesh(kind, corners, sizes)).tolist() == found


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        (Mesh("m", 0, np.zeros((3, 3))), "its faces cannot be read"),
        (mesh("triangles", [0, 1, 8]), "a face names a vertex that is not there"),
        (mesh("triangles", [0, -1, 2]), "a face names a vertex that is not there"),
        (mesh("Mesh", [0, 1, 2], (4,)), "the sizes of faces do not add up to their corners"),
        (mesh("Mesh", [0, 1, 2], (4, -1)), "the sizes of faces do not add up to their corners"),
    ],
)
def test_faces_that_make_no_sense_are_an_error_of_the_file(broken: Mesh, said: str) -> None:
    with pytest.raises(FileError, match=said):
        triangles(broken)
    assert triangles(mesh("triangles", [0, 1, 7])).tolist() == [[0, 1, 7]]


@pytest.mark.parametrize("turn", range(3))
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_a_triangle_is_flat_by_its_height_over_its_longest_side(turn: int, size: float) -> None:
    """Its sides are 1, 1 and 2 long; only the corners' order differs."""

    def of(height: float) -> Any:
        points = np.array([[0.0, 0, 0], [2, 0, 0], [1, height, 0]]) * size + 5.0 * size
        return np.roll(points, turn, axis=0)[np.newaxis]

    # Twice the area is 2 h, and the square of the longest side 4.
    assert flat(of(2.0 * FLAT * 0.5)).tolist() == [True]
    assert flat(of(2.0 * FLAT * 2.0)).tolist() == [False]
    assert flat(of(np.nan)).tolist() == [True]


def test_triangles_far_from_the_origin_are_as_flat_as_near_it() -> None:
    points = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 100 * FLAT, 0]]])
    assert flat(points).tolist() == flat(points + 1000.0).tolist() == [False]
    assert flat(np.zeros((2, 3, 3))).tolist() == [True, True]


TWO = np.array([[[0.0, 0, 0], [4, 0, 0], [0, 4, 0]], [[10.0, 0, 0], [14, 0, 0], [10, 4, 0]]])


@pytest.mark.parametrize(
    ("point", "number", "weights"),
    [
        ((1, 1, 5), 0, (0.5, 0.25, 0.25)),
        ((2, -3, 0), 0, (0.5, 0.5, 0)),
        ((-3, 1, 2), 0, (0.75, 0, 0.25)),
        ((3, 3, 0), 0, (0, 0.5, 0.5)),
        ((-1, -1, 0), 0, (1, 0, 0)),
        ((6, -1, 0), 0, (0, 1, 0)),
        ((-2, 9, 0), 0, (0, 0, 1)),
        ((12, 1, -1), 1, (0.25, 0.5, 0.25)),
        ((7, 0, 0), 0, (0, 1, 0)),  # as near to both
        ((7.5, 0, 0), 1, (1, 0, 0)),
    ],
)
def test_the_nearest_point_is_inside_or_on_an_edge(point: Any, number: int, weights: Any) -> None:
    found, shares = nearest(np.array(point, dtype=np.float64), TWO)
    assert found == number
    assert_allclose(shares, weights, atol=1e-12)


def test_flat_triangles_are_passed_over() -> None:
    flat_first = np.concatenate([np.zeros((1, 3, 3)), TWO])
    assert nearest(np.zeros(3), flat_first)[0] == 1
    with pytest.raises(GeometryError, match="No triangle of the mesh has an area"):
        nearest(np.zeros(3), np.zeros((2, 3, 3)))


def test_every_triangle_with_a_vertex_is_found() -> None:
    rows = [np.array([[0, 1, 2], [2, 3, 0]]), np.array([[5, 2, 6]])]
    assert vertices_of(rows, 2) == [(0, 0, 2), (0, 1, 0), (1, 0, 1)]
    assert vertices_of(rows, 9) == []
