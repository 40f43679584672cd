"""Polygons as triangles: ears are cut where a fan would leave a concave one.

Source: G. H. Meisters, "Polygons have ears", 1975.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot

# What is less, as a share of a polygon's squared area, is rounding.
_FLAT = 1e-9


def turned_over(normals: Floats, whole: Floats) -> NDArray[Any]:
    """Which triangles, (t,), lie face down in their polygons; their normals and the polygons', (t, 3)."""
    return np.asarray(dot(normals, whole) < -_FLAT * dot(whole, whole))


def ears(points: Floats, normal: Floats) -> Integers | None:
    """The corners, (n − 2, 3), of triangles that make a polygon of n points, (n, 3).

    None where it crosses itself. normal: of the polygon, as long as its area is large, (3,).
    """
    flat = _FLAT * float(dot(normal, normal))
    left, found = list(range(len(points))), []
    while len(left) > 3:
        for k, corner in enumerate(left):
            ear = left[k - 1], corner, left[(k + 1) % len(left)]
            if _is_ear(points, ear, left, normal, flat):
                found.append(ear)
                del left[k]
                break
        else:
            return None
    return np.array([*found, left], dtype=np.int64)


def _is_ear(points: Floats, ear: tuple[int, int, int], left: list[int], normal: Floats, flat: float) -> bool:
    """Whether a triangle lies face up, with no other point of the polygon in it or on its edges."""
    a, b, c = (points[k] for k in ear)
    if float(dot(cross(b - a, c - a), normal)) <= flat:
        return False
    others = points[[k for k in left if k not in ear]]
    others = others[~np.any([(others == one).all(axis=1) for one in (a, b, c)], axis=0)]
    within = np.ones(len(others), dtype=bool)
    for start, end in ((a, b), (b, c), (c, a)):
        within &= dot(cross(np.broadcast_to(end - start, others.shape), others - start), normal) >= -flat
    return not within.any()
