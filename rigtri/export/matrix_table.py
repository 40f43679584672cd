"""The matrices of nodes at one moment, and the numbers that a DCC shows for them.

Row vectors: a row is an axis, the last the position. ``local = world · inverse(parent world)``, and the
rotation of ``local`` is ``rotate · joint_orient``, as a joint's is in Maya.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import Any

import numpy as np

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
    nodes = sorted(named) or list(range(len(rig)))
    if not nodes:
        return []
    orients = joint_orients(rig, nodes, options.joint_orient)
    local = _numbers(np.stack([posed.local(node)[0] for node in nodes]), options.rotate_order, orients)
    world = _numbers(np.stack([posed.world(node)[0] for node in nodes]), options.rotate_order)
    binds = _inverse_binds(rig, set(nodes), options.rotate_order)
    return [
        {
            "node": rig.address(node),
            "kind": rig.kind_of(node),
            "parent": rig.address(parent) if (parent := int(rig.parents[node])) >= 0 else None,
            "local": here,
            "world": there,
            "inverse_binds": binds[node],
        }
        for node, here, there in zip(nodes, local, world, strict=True)
    ]


def _inverse_binds(rig: Rig, nodes: set[int], order: RotateOrder) -> dict[int, list[dict[str, Any]]]:
    """Of each node the inverse bind matrices, in the order of the skins."""
    found: dict[int, list[dict[str, Any]]] = {node: [] for node in nodes}
    for number, skin in enumerate(rig.skins):
        rows = [row for row, node in enumerate(skin.joints.tolist()) if node in nodes]
        for row, numbers in zip(rows, _numbers(skin.inverse_bind[rows], order), strict=True):
            found[int(skin.joints[row])].append({"skin": skin.name or f"#{number}"} | numbers)
    return found


def joint_orients(rig: Rig, nodes: Sequence[int], chosen: JointOrient = "rest") -> Floats:
    """The rotations after which joints are rotated, (n, 4); only joints have one."""
    turned = np.tile(IDENTITY, (len(nodes), 1))
    joint = rig.is_joint[nodes]
    if chosen == "rest":
        turned[joint] = decompose(rig.normalised_local[nodes])[1][joint]
    elif chosen != "none":
        turned[joint] = from_angles(np.array(chosen) / _DEGREES, "xyz")
    return turned


def _numbers(matrices: Floats, order: RotateOrder, orients: Floats | None = None) -> Iterator[dict[str, Any]]:
    """Matrices, (n, 4, 4), and what each is made of; angles are degrees about x, y, z. orients: (n, 4)."""
    translation, rotation, scale = decompose(matrices)
    turned = rotation if orients is None else multiply(conjugate(orients), rotation)
    angles, sheared = to_angles(turned, order) * _DEGREES, skew(matrices) > SKEW
    orient_angles = None if orients is None else to_angles(orients, "xyz") * _DEGREES
    for k, matrix in enumerate(matrices):
        found = {
            "matrix": [_clean(row) for row in matrix],
            "translation": _clean(translation[k]),
            "rotation": _clean(rotation[k]),
            "order": order,
            "rotate": _clean(angles[k]),
            "scale": _clean(scale[k]),
            "sheared": bool(sheared[k]),
        }
        if orient_angles is not None:
            found["joint_orient"] = _clean(orient_angles[k])
        yield found


def _clean(row: Floats) -> list[float | None]:
    """Numbers for JSON: null for what is none, and 0 for what is nothing beside the largest of a row."""
    numbers = row.tolist()
    least = _NOISE * max((abs(x) for x in numbers if isfinite(x)), default=0.0)
    return [None if not isfinite(x) else 0.0 if abs(x) <= least else x for x in numbers]


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
