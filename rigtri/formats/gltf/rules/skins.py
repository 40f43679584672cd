"""Rules about skins: their joints and inverse bind matrices.

Source: glTF 2.0 §3.7.3.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from rigtri.formats.gltf.rules.nodes import wrong_last_row
from rigtri.formats.rules import Violation
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import determinant
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length

# Axes that span less than this share of a box of their lengths are flat.
FLAT = 1e-9
BIND_TYPE, BIND_SINGULAR = "gltf.skin.inverse-bind-type", "gltf.skin.inverse-bind-singular"
OF_ONE_JOINT = ("gltf.skin.inverse-bind-nan", "gltf.skin.inverse-bind-last-row", BIND_SINGULAR)
# The component type of 32-bit floats.
FLOAT = 5126


def joint_violations(joints: Sequence[int | None], title: Callable[[int], str]) -> Iterator[Violation]:
    """What is wrong with the list of a skin's joints; None stands for one that is not there."""
    if not joints:
        yield Violation("gltf.skin.no-joints", "has no joints")
    for joint, count in Counter(joints).items():
        if joint is not None and count > 1:
            second = [k for k, other in enumerate(joints) if other == joint][1]
            yield Violation("gltf.skin.joint-twice", f"lists {title(joint)} {count} times", second)


def joints_outside(joints: Sequence[int], pivot: int, above: Sequence[int]) -> list[int]:
    """The joints that are not ``pivot`` or below it. above: the parent of each node, without cycles."""
    inside = {pivot: True, -1: False}
    for joint in joints:
        line, at = [], joint
        while at not in inside:
            line.append(at)
            at = above[at]
        inside |= dict.fromkeys(line, inside[at])
    return [joint for joint in joints if not inside[joint]]


def bind_violations(matrices: Floats, component: object, joints: int) -> Iterator[Violation]:
    """What is wrong with inverse bind matrices, (k, 16), stored as a component type, for so many joints."""
    width = matrices.shape[1]
    if width != 16 or component != FLOAT:
        text = f"its inverse bind matrices have {width} numbers each, of type {component}"
        yield Violation(BIND_TYPE, text)
    if width != 16:
        return
    if len(matrices) < joints:
        text = f"has {len(matrices)} inverse bind matrices for {joints} joints"
        yield Violation("gltf.skin.inverse-bind-count", text)
    # Rows are what glTF calls columns: the flat list is the same for row vectors.
    matrices = matrices[:joints].reshape(-1, 4, 4)
    lost = ~np.isfinite(matrices).all(axis=(1, 2))
    with np.errstate(invalid="ignore", over="ignore"):
        last = ~lost & wrong_last_row(matrices)
        singular = ~lost & ~last & flat(matrices)
    texts = "has a value that is not a number", "has a last row that is not 0 0 0 1", "is flat"
    for rule, wrong, text in zip(OF_ONE_JOINT, (lost, last, singular), texts, strict=True):
        for row in np.flatnonzero(wrong).tolist():
            yield Violation(rule, f"inverse bind matrix {row} {text}", row)


def flat(matrices: Floats) -> Booleans:
    """Which matrices have no inverse worth the name, (m, 4, 4) → (m,)."""
    box = length(matrices[:, :3, :3])
    size = box[:, 0] * box[:, 1] * box[:, 2]
    return np.asarray(np.abs(determinant(matrices)) <= FLAT * size)
