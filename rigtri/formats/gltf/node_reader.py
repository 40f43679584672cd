"""Nodes of a glTF file: the tree and the rest pose, checked.

Source: glTF 2.0 §3.5.2 (hierarchy), §3.5.3 (transformations).
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import field

import numpy as np

from rigtri.formats.gltf.rules import (
    MATRIX_AND_TRS,
    MATRIX_LAST_ROW,
    NON_UNIT,
    ROTATION_ZERO,
    WIDTH,
    matrix_violations,
    refuse,
    rotation_violations,
    transform_violation,
)
from rigtri.formats.json_values import LARGEST, Value
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import SKEW, decompose, skew
from rigtri.maths.quaternions import norm
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.report import Notice

_NUMBERS = frozenset([float, int])
_PARTS = {**WIDTH, "matrix": 16}


@dataclass(frozen=True, eq=False)
class Tree:
    """order: file indices, parents first. place: where each file index is in ``order``. above: its parent."""

    order: list[int]
    place: list[int]
    above: list[int]


def title(nodes: list[dict[str, object]], index: int) -> str:
    """What to call a node of the file in a message."""
    name = nodes[index].get("name")
    return f"node '{name}' (#{index})" if isinstance(name, str) and name else f"node #{index}"


def read_tree(gltf: Value) -> Tree:
    """Who is below whom. FileError for two parents and for cycles."""
    nodes = gltf.object().get("nodes", [])
    above = [-1] * len(nodes)
    for index, node in enumerate(nodes):
        if "children" not in node:
            continue
        for child in Value(node, f"{gltf.where} nodes[{index}]").each("children"):
            below = child.index(len(nodes), "node")
            if above[below] >= 0:
                twice = f"{title(nodes, above[below])} and {title(nodes, index)}"
                gltf.fail(f"{title(nodes, below)} has two parents, {twice}; take it away from one")
            above[below] = index
    order: list[int] = []
    place = [-1] * len(nodes)
    for index in range(len(nodes)):
        for node in _line(gltf, nodes, above, place, index):
            place[node] = len(order)
            order.append(node)
    return Tree(order, place, above)


def _line(
    gltf: Value, nodes: list[dict[str, object]], above: list[int], place: list[int], node: int
) -> list[int]:
    """The node and all above it that have no place yet, topmost first."""
    line: dict[int, None] = {}
    while node >= 0 and place[node] < 0:
        if node in line:
            gltf.fail(f"{title(nodes, node)} is below itself; remove it from the children of a node below it")
        line[node] = None
        node = above[node]
    return list(line)[::-1]


@dataclass(frozen=True, eq=False)
class Rest:
    """The rest pose in rig order, as in `rigtri.model.rig.Rig`.

    repaired: file indices of nodes whose matrix and TRS contradicted each other or
    their animation, and that a changed file must hold as TRS. sheared: rig indices.
    """

    translation: Floats
    rotation: Floats
    scale: Floats
    matrix: Floats
    has_matrix: Booleans
    repaired: set[int] = field(default_factory=set)
    sheared: list[int] = field(default_factory=list)


def read_rest(gltf: Value, tree: Tree, animated: Set[int], notices: list[Notice], *, lenient: bool) -> Rest:
    """TRS and matrices as stored, defaults where there are none. animated: file indices of matrices."""
    count = len(tree.order)
    rotation, matrix = np.zeros((count, 4)), np.zeros((count, 4, 4))
    rotation[:, 3] = 1.0
    matrix.reshape(count, 16)[:, ::5] = 1.0
    rest = Rest(np.zeros((count, 3)), rotation, np.ones((count, 3)), matrix, np.zeros(count, dtype=bool))
    nodes = gltf.object().get("nodes", [])
    if not _read_together(nodes, rest, tree.place):  # something is wrong, which reading one by one finds
        for item in gltf.each("nodes"):
            for key, width in _PARTS.items():
                if key in item.raw:
                    item.need(key).numbers(width)
    for index, node in enumerate(nodes):
        violation = transform_violation(node, animated=index in animated) if "matrix" in node else None
        if violation is not None and not lenient:
            refuse(f"{gltf.where} {title(nodes, index)}:", violation)
        if violation is not None:
            _repair(gltf, nodes, index, rest, tree.place[index], split=violation.rule != MATRIX_AND_TRS)
    _check_matrices(gltf, nodes, rest, tree, notices)
    _check_rotations(gltf, nodes, rest, tree, notices)
    return rest


def _read_together(nodes: list[dict[str, object]], rest: Rest, place: list[int]) -> bool:
    """Read the numbers of all nodes at once, as nearly every file allows; False where one is wrong."""
    for key, width in _PARTS.items():
        found = [index for index, node in enumerate(nodes) if key in node]
        if not found:
            continue
        rows: list[float] = []
        for index in found:
            row = nodes[index][key]
            if type(row) is not list or len(row) != width:
                return False
            rows += row
        if not _NUMBERS.issuperset(map(type, rows)) or min(rows) < -LARGEST or max(rows) > LARGEST:
            return False
        places = [place[index] for index in found]
        array: Floats = getattr(rest, key)
        array[places] = np.array(rows, dtype=np.float64).reshape(-1, *array.shape[1:])
        if key == "matrix":
            rest.has_matrix[places] = True
    return True


def _repair(
    gltf: Value, nodes: list[dict[str, object]], index: int, rest: Rest, row: int, *, split: bool
) -> None:
    """Take a node's TRS in place of its matrix, or, where it has none, what the matrix splits into."""
    if split:
        if skew(rest.matrix[row]) > SKEW:
            name = title(nodes, index)
            gltf.fail(f"{name} is animated and its sheared matrix cannot be split; export the file again")
        rest.translation[row], rest.rotation[row], rest.scale[row] = decompose(rest.matrix[row])
    rest.has_matrix[row] = False
    rest.matrix[row] = np.eye(4)
    rest.repaired.add(index)


def _check_matrices(
    gltf: Value, nodes: list[dict[str, object]], rest: Rest, tree: Tree, notices: list[Notice]
) -> None:
    rows = rest.has_matrix.nonzero()[0]
    if not len(rows):
        return
    for violation in matrix_violations(rest.matrix[rows]):
        row = int(rows[violation.item])
        name = title(nodes, tree.order[row])
        if violation.rule == MATRIX_LAST_ROW:
            refuse(f"{gltf.where} {name}:", violation)
        rest.sheared.append(row)
        text = f"The matrix of {name} is sheared or flat, which glTF forbids; it is kept and only multiplied"
        notices.append(Notice("matrix-sheared", text, joint=name))


def _check_rotations(
    gltf: Value, nodes: list[dict[str, object]], rest: Rest, tree: Tree, notices: list[Notice]
) -> None:
    off = np.abs(norm(rest.rotation) - 1.0)
    for violation in rotation_violations(rest.rotation) if (off == 1.0).any() else ():
        if violation.rule == ROTATION_ZERO:
            refuse(f"{gltf.where} {title(nodes, tree.order[violation.item])}:", violation)
    if len(off) and off.max() > NON_UNIT:
        name = title(nodes, tree.order[int(off.argmax())])
        count = (off > NON_UNIT).sum()
        text = f"{count} rest rotations are not unit, the worst is {name}, off by {off.max():.2g}"
        notices.append(Notice("rotation-not-unit", text, joint=name))
