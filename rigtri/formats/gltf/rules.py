"""The rules of glTF that reading a file and checking it share: each stands here once.

Functions find what breaks them, in numbers and JSON, and know no file, buffer or rig. A reader refuses a
file at the first violation that it cannot live with (`refuse`), `rigtri check` lists all of them. Ids,
severities and remedies are in `catalogue.toml`.

Source: glTF 2.0 §3.5.3 (transformations), §3.7.3 (skins), §3.11 (animations).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NoReturn

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.json_values import short_repr
from rigtri.formats.rules import Violation, read_rules
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import SKEW, determinant, skew
from rigtri.maths.quaternions import norm
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length

# Numbers of each property of a node that channels can drive.
WIDTH = {"translation": 3, "rotation": 4, "scale": 3}
# Rotations further from unit are reported: engines differ in what they make of them.
NON_UNIT = 1e-4
# The last column of an affine matrix, as near as float32 exporters come.
AFFINE = 1e-6
MATRIX_AND_TRS, MATRIX_LAST_ROW = "gltf.node.matrix-and-trs", "gltf.node.matrix-last-row"
ROTATION_ZERO = "gltf.node.rotation-zero"
# Axes that span less than this share of a box of their lengths are flat.
FLAT = 1e-9
BIND_TYPE, BIND_SINGULAR = "gltf.skin.inverse-bind-type", "gltf.skin.inverse-bind-singular"
OF_ONE_JOINT = ("gltf.skin.inverse-bind-nan", "gltf.skin.inverse-bind-last-row", BIND_SINGULAR)
# The component type of 32-bit floats.
FLOAT = 5126
INTERPOLATIONS = ("LINEAR", "STEP", "CUBICSPLINE")
_TYPE = "gltf.animation.output-type"


def refuse(where: str, violation: Violation) -> NoReturn:
    """Raise a FileError with the place, what is wrong there, and the remedy of the rule."""
    # The catalogue is of use only here: a file that can be read needs none.
    remedy = next(rule.remedy for rule in read_rules("gltf") if rule.id == violation.rule)
    raise FileError(f"{where} {violation.text}. {remedy}")


# --- nodes


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


# --- skins


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
        singular = ~lost & ~last & _flat(matrices)
    texts = "has a value that is not a number", "has a last row that is not 0 0 0 1", "is flat"
    for rule, wrong, text in zip(OF_ONE_JOINT, (lost, last, singular), texts, strict=True):
        for row in np.flatnonzero(wrong).tolist():
            yield Violation(rule, f"inverse bind matrix {row} {text}", row)


def _flat(matrices: Floats) -> Booleans:
    """Which matrices have no inverse worth the name, (m, 4, 4) → (m,)."""
    box = length(matrices[:, :3, :3])
    size = box[:, 0] * box[:, 1] * box[:, 2]
    return np.asarray(np.abs(determinant(matrices)) <= FLAT * size)


# --- animations


def node_violation(node: int, count: int) -> Violation | None:
    """A channel that drives a node which a file of ``count`` nodes does not have."""
    if 0 <= node < count:
        return None
    return Violation("gltf.animation.node-missing", f"there is no node {node}, the file has {count}")


def twice_violation(title: str, path: str, first: int) -> Violation:
    """A channel that drives what channel ``first`` of its animation drives."""
    return Violation("gltf.animation.target-twice", f"{title}: channel {first} drives its {path} too")


def sampler_violation(number: Any, count: int) -> Violation | None:
    """A channel whose sampler is none of ``count``."""
    if type(number) is int and 0 <= number < count:
        return None
    text = f"there is no sampler {short_repr(number)}, the animation has {count}"
    return Violation("gltf.animation.sampler-missing", text)


def interpolation_violation(mode: Any) -> Violation | None:
    if mode in INTERPOLATIONS:
        return None
    text = f"interpolation {short_repr(mode)} is not defined by glTF"
    return Violation("gltf.animation.interpolation-unknown", text)


def time_violations(times: Floats, *, lenient: bool = False) -> Iterator[Violation]:
    """Key times, (k,), that are no numbers or not in order. lenient: equal times are allowed."""
    lost = np.flatnonzero(~np.isfinite(times))
    if len(lost):
        yield Violation("gltf.animation.times-nan", f"time {lost[0]} is not a number")
        return
    early = times[1:] < times[:-1] if lenient else times[1:] <= times[:-1]
    wrong = np.flatnonzero(early)
    if len(wrong):
        k = int(wrong[0])
        text = f"time {k + 1}, {times[k + 1]:g} s, does not come after time {k}, {times[k]:g} s"
        more = f" ({len(wrong)} such keys)" if len(wrong) > 1 else ""
        yield Violation("gltf.animation.times-order", text + more)


def time_width_violation(width: int) -> Violation | None:
    """Times that are no single numbers."""
    return None if width == 1 else Violation(_TYPE, f"its times have {width} numbers each, not one")


def value_width_violation(path: str, needed: int, width: int) -> Violation | None:
    """Values of ``width`` numbers where the property needs others."""
    if width == needed:
        return None
    return Violation(_TYPE, f"{path} needs {needed} numbers a key, its output has {width}")


def count_violation(times: int, values: int, mode: Any) -> Violation | None:
    """As many values as key times; in CUBICSPLINE three for each."""
    needed = values_needed(times, mode)
    if values == needed:
        return None
    text = f"{times} times need {needed} values, the output has {values}"
    return Violation("gltf.animation.output-count", text)


def values_needed(times: int, mode: Any) -> int:
    return (3 if mode == "CUBICSPLINE" else 1) * times
