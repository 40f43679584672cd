"""The matrices of nodes at one moment, and the numbers that a DCC shows for them.

Row vectors: a row is an axis, the last the position. ``local = world · inverse(parent world)``, and the
rotation of ``local`` is ``rotate · joint_orient``, as a joint's is in Maya.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from rigtri.evaluation.pose_cache import PoseCache
from rigtri.maths import RotateOrder
from rigtri.maths.euler import from_angles, to_angles
from rigtri.maths.matrices import SKEW, decompose, skew
from rigtri.maths.quaternions import IDENTITY, conjugate, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.operation import takes_keywords
from rigtri.operations.options.constrain import JointOrient
from rigtri.operations.options.matrix_table import MatrixTableOptions
from rigtri.operations.pose import pose_of
from rigtri.report import Report
from rigtri.text import plain_lines

_DEGREES = 180.0 / np.pi
# Of a matrix's largest number: less is the rounding of a right angle.
_NOISE = 1e-9
_ROWS = ("x", "y", "z", "at")


@takes_keywords(MatrixTableOptions)
def matrix_table(
    rig: Rig, *, options: MatrixTableOptions, report: Report | None = None
) -> list[dict[str, Any]]:
    """For each node its matrices, as `rigtri inspect --matrices --json` prints them, parents first.

    ``local``, ``world`` and each of ``inverse_binds`` have ``matrix`` (four rows: the axes and the position),
    ``translation``, ``rotation`` (x y z w), ``rotate`` (degrees about x, y, z), ``order``, ``scale`` and
    ``sheared``, ``local`` also ``joint_orient`` (degrees). No number is None. Raises NameNotFoundError
    for a name or a clip that is not there, GeometryError for a cycle.
    """
    posed = pose_of(rig, options, report)
    named = {node for glob in options.joints for node in rig.match(glob)}
    return [_entry(rig, posed, node, options) for node in sorted(named) or range(len(rig))]


def _entry(rig: Rig, posed: PoseCache, node: int, options: MatrixTableOptions) -> dict[str, Any]:
    parent, oriented = int(rig.parents[node]), joint_orient(rig, node, options.joint_orient)
    binds = [
        {"skin": skin.name or f"#{number}"} | _numbers(skin.inverse_bind[row], options.rotate_order)
        for number, skin in enumerate(rig.skins)
        for row in np.flatnonzero(skin.joints == node).tolist()
    ]
    return {
        "node": rig.address(node),
        "kind": rig.kind_of(node),
        "parent": rig.address(parent) if parent >= 0 else None,
        "local": _numbers(posed.local(node)[0], options.rotate_order, oriented),
        "world": _numbers(posed.world(node)[0], options.rotate_order),
        "inverse_binds": binds,
    }


def joint_orient(rig: Rig, node: int, chosen: JointOrient = "rest") -> Floats:
    """The rotation after which a joint is rotated, (4,); only joints have one."""
    if not rig.is_joint[node] or chosen == "none":
        return IDENTITY.copy()
    if chosen == "rest":
        return decompose(rig.normalised_local[node])[1]
    return from_angles(np.array(chosen) / _DEGREES, "xyz")


def _numbers(matrix: Floats, order: RotateOrder, oriented: Floats | None = None) -> dict[str, Any]:
    """A matrix, and what it is made of; angles are degrees about x, y, z. oriented: see `joint_orient`."""
    translation, rotation, scale = decompose(matrix)
    turned = rotation if oriented is None else multiply(conjugate(oriented), rotation)
    found = {
        "matrix": [_clean(row) for row in matrix],
        "translation": _clean(translation),
        "rotation": _clean(rotation),
        "order": order,
        "rotate": _clean(to_angles(turned, order) * _DEGREES),
        "scale": _clean(scale),
        "sheared": bool(skew(matrix) > SKEW),
    }
    if oriented is not None:
        found["joint_orient"] = _clean(to_angles(oriented, "xyz") * _DEGREES)
    return found


def _clean(row: Floats) -> list[float | None]:
    """Numbers for JSON: null for what is none, and 0 for what is nothing beside the largest of a row."""
    most = float(np.abs(row[np.isfinite(row)]).max(initial=0.0))
    return [None if not np.isfinite(x) else 0.0 if abs(x) <= _NOISE * most else float(x) for x in row]


def matrix_text(table: Sequence[dict[str, Any]]) -> str:
    """The table as text: four rows of each matrix, and beside them what it is made of."""
    return "\n\n".join(plain_lines(_lines(entry)) for entry in table)


def _lines(entry: dict[str, Any]) -> Iterator[str]:
    below = f", child of {entry['parent']}" if entry["parent"] else ""
    yield f"{entry['node']} ({entry['kind']}{below})"
    blocks = [("local", entry["local"]), ("world", entry["world"])]
    blocks += [(f"inverse bind of skin {bind['skin']}", bind) for bind in entry["inverse_binds"]]
    for title, numbers in blocks:
        yield f"  {title}"
        rows = [[f"{_short(x):>10}" for x in row] for row in numbers["matrix"]]
        for name, row, words in zip(_ROWS, rows, _parts(numbers), strict=True):
            yield f"    {name:2} {' '.join(row)}   {words}".rstrip()


def _parts(numbers: dict[str, Any]) -> list[str]:
    """What a matrix is made of, beside its four rows."""
    orient = f"jointOrient {_row(numbers['joint_orient'])}" if any(numbers.get("joint_orient", ())) else ""
    return [
        f"translate {_row(numbers['translation'])}",
        f"rotate {_row(numbers['rotate'])} ({numbers['order']}, degrees)",
        f"scale {_row(numbers['scale'])}{' and sheared' if numbers['sheared'] else ''}",
        orient,
    ]


def _row(numbers: Sequence[float | None]) -> str:
    return " ".join(map(_short, numbers))


def _short(number: float | None) -> str:
    """Six digits, of what is nothing to a rig 0.

    >>> _short(0.1 + 0.2), _short(-1e-12), _short(None)
    ('0.3', '0', 'none')
    """
    if number is None:
        return "none"
    return f"{0.0 if abs(number) < _NOISE else number:.6g}"
