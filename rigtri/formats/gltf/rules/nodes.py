"""Rules about the transforms of nodes.

Source: glTF 2.0 §3.5.3 (transformations).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from rigtri.formats.rules import Violation
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import SKEW, determinant, skew
from rigtri.maths.quaternions import norm
from rigtri.maths.trigonometry import Floats

# Numbers of each property of a node that channels can drive.
WIDTH = {"translation": 3, "rotation": 4, "scale": 3}
# Rotations further from unit are reported: engines differ in what they make of them.
NON_UNIT = 1e-4
# The last column of an affine matrix, as near as float32 exporters come.
AFFINE = 1e-6
MATRIX_AND_TRS, MATRIX_LAST_ROW = "gltf.node.matrix-and-trs", "gltf.node.matrix-last-row"
ROTATION_ZERO = "gltf.node.rotation-zero"


def transform_violation(node: Mapping[str, Any], *, animated: bool) -> Violation | None:
    """A matrix of a node beside other transforms, or below an animation."""
    beside = [key for key in WIDTH if key in node]
    if beside:
        return Violation(MATRIX_AND_TRS, f"has a matrix and {' and '.join(beside)}")
    if animated:
        return Violation("gltf.node.matrix-animated", "is animated and has a matrix")
    return None


def matrix_violations(matrices: Floats) -> Iterator[Violation]:
    """What is wrong with node matrices, (k, 4, 4), in row vectors."""
    last = wrong_last_row(matrices)
    flat = determinant(matrices) == 0
    with np.errstate(invalid="ignore", divide="ignore"):
        cosine = skew(matrices)
    for k in np.flatnonzero(last | flat | (cosine > SKEW)).tolist():
        if last[k]:
            yield Violation(MATRIX_LAST_ROW, "its matrix has a last row that is not 0 0 0 1", k)
        elif flat[k]:
            yield Violation("gltf.node.matrix-singular", "its matrix is flat", k)
        else:
            text = f"its matrix is sheared: the cosine between two axes is {cosine[k]:.3g}"
            yield Violation("gltf.node.matrix-sheared", text, k)


def wrong_last_row(matrices: Floats) -> Booleans:
    """Which matrices, (k, 4, 4) in row vectors, are not affine; the last row of glTF's is our last column."""
    return np.asarray(np.abs(matrices[:, :, 3] - [0.0, 0.0, 0.0, 1.0]).max(axis=1) > AFFINE)


def rotation_violations(rotations: Floats) -> Iterator[Violation]:
    """Rest rotations, (k, 4), that are no unit quaternions."""
    size = norm(rotations)
    for k in np.flatnonzero(np.abs(size - 1.0) > NON_UNIT).tolist():
        if size[k] == 0:
            yield Violation(ROTATION_ZERO, "has the rotation 0 0 0 0", k)
        else:
            text = f"its rotation has the length {size[k]:.6g}"
            yield Violation("gltf.node.rotation-not-unit", text, k)
