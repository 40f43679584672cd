"""Skins of a glTF file: joints and inverse bind matrices, checked.

Source: glTF 2.0 §3.7.3.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.node_reader import AFFINE, Tree, title
from rigtri.formats.json_values import Value
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import determinant
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.skin import Skin
from rigtri.report import Notice

# Axes that span less than this share of a box of their lengths are flat.
FLAT = 1e-9


def read_skins(
    gltf: Value,
    accessors: Accessors,
    tree: Tree,
    notices: list[Notice],
    weigh: Callable[[int, int], Booleans],
    *,
    lenient: bool,
) -> tuple[Skin, ...]:
    """All skins. weigh: which of so many joints of skin k move any point."""
    skins = []
    drawn = {node.get("skin") for node in gltf.object().get("nodes", []) if "mesh" in node}
    for number, item in enumerate(gltf.each("skins")):
        name = item.object().get("name")
        skin = Value(item.raw, f"{gltf.where} skin '{name}' (#{number})" if name else item.where)
        joints = _joints(gltf, skin, tree, notices)
        matrices = _inverse_bind(gltf, skin, accessors, joints, notices, lenient=lenient)
        skins.append(
            Skin(
                name=name if isinstance(name, str) else "",
                joints=np.array([tree.place[joint] for joint in joints], dtype=np.int64),
                inverse_bind=np.tile(np.eye(4), (len(joints), 1, 1)) if matrices is None else matrices,
                stored=matrices is not None,
                weigh=partial(weigh, number, len(joints)),
                key=number,
                drawn=number in drawn,
            )
        )
    return tuple(skins)


def _joints(gltf: Value, skin: Value, tree: Tree, notices: list[Notice]) -> list[int]:
    count, nodes = len(tree.order), gltf.object().get("nodes", [])
    joints = [joint.index(count, "node") for joint in skin.need("joints").items()]
    if not joints:
        skin.fail("has no joints; remove the skin or export the file anew")
    if len(set(joints)) != len(joints):
        twice = next(joint for joint in joints if joints.count(joint) > 1)
        skin.fail(f"lists {title(nodes, twice)} twice; export the file anew")
    pivot = skin.get("skeleton")
    if pivot is not None:
        root = pivot.index(count, "node")
        if not _all_under(tree, joints, root):
            text = f"The skeleton of a skin, {title(nodes, root)}, is not above all its joints; it is kept"
            notices.append(Notice("skeleton-not-above", text))
    return joints


def _all_under(tree: Tree, joints: list[int], root: int) -> bool:
    """Whether all joints are ``root`` or below it."""
    under = {root}
    for node in tree.order:  # parents first
        if tree.above[node] in under:
            under.add(node)
    return under.issuperset(joints)


def _inverse_bind(
    gltf: Value,
    skin: Value,
    accessors: Accessors,
    joints: list[int],
    notices: list[Notice],
    *,
    lenient: bool,
) -> Floats | None:
    """The matrices of the joints, (m, 4, 4), None where the file has none."""
    item = skin.get("inverseBindMatrices")
    if item is None:
        return None
    numbers = accessors.read(item.index(len(accessors), "accessor"))
    if numbers.shape[1] != 16:
        item.fail("inverse bind matrices should be MAT4; export the file anew")
    if len(numbers) < len(joints):
        item.fail(f"{len(numbers)} matrices for {len(joints)} joints; export the file anew")
    # Rows are what glTF calls columns: the flat list is the same for row vectors.
    matrices = numbers[: len(joints)].reshape(-1, 4, 4)
    nodes = gltf.object().get("nodes", [])
    lost = ~np.isfinite(matrices).all(axis=(1, 2))
    for row in np.flatnonzero(lost)[:1].tolist():
        item.fail(f"the inverse bind matrix of {title(nodes, joints[row])} has a value that is not a number")
    off = np.abs(matrices[:, :, 3] - [0.0, 0.0, 0.0, 1.0]).max(axis=1) > AFFINE
    for row in off.nonzero()[0][:1].tolist():
        name = title(nodes, joints[row])
        item.fail(f"the inverse bind matrix of {name} has a last row that is not 0 0 0 1")
    for row in flat(matrices).nonzero()[0][:1].tolist():
        name = title(nodes, joints[row])
        text = f"the inverse bind matrix of {name} is flat, so the joint has no bind pose"
        if not lenient:
            item.fail(f"{text}. Use --lenient to edit the file all the same")
        notices.append(Notice("bind-flat", f"{item.where}: {text}", joint=name))
    return matrices


def flat(matrices: Floats) -> Booleans:
    """Which matrices have no inverse worth the name, (m, 4, 4) → (m,)."""
    box = length(matrices[:, :3, :3])
    size = box[:, 0] * box[:, 1] * box[:, 2]
    return np.asarray(np.abs(determinant(matrices)) <= FLAT * size)
