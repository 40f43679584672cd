"""Skins of a glTF file: joints and inverse bind matrices, checked.

Source: glTF 2.0 §3.7.3.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.node_reader import Tree, title
from rigtri.formats.gltf.rules import (
    BIND_SINGULAR,
    BIND_TYPE,
    OF_ONE_JOINT,
    bind_violations,
    joint_violations,
    joints_outside,
    refuse,
)
from rigtri.formats.json_values import Value, name_in
from rigtri.maths.arrays import Booleans
from rigtri.maths.trigonometry import Floats
from rigtri.model.skin import Skin
from rigtri.report import Notice


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
        name = name_in(item.object())
        skin = Value(item.raw, f"{gltf.where} skin '{name}' (#{number})" if name else item.where)
        joints = _joints(gltf, skin, tree, notices)
        matrices = _inverse_bind(gltf, skin, accessors, joints, notices, lenient=lenient)
        skins.append(
            Skin(
                name=name,
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
    for violation in joint_violations(joints, partial(title, nodes)):
        refuse(f"{skin.where}:", violation)
    pivot = skin.get("skeleton")
    if pivot is not None:
        root = pivot.index(count, "node")
        if joints_outside(joints, root, tree.above):
            text = f"The skeleton of a skin, {title(nodes, root)}, is not above all its joints; it is kept"
            notices.append(Notice("skeleton-not-above", text))
    return joints


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
    index = item.index(len(accessors), "accessor")
    numbers = accessors.read(index)
    for violation in bind_violations(numbers, accessors.layout(index).component, len(joints)):
        if violation.rule == BIND_TYPE and numbers.shape[1] == 16:
            continue  # numbers are numbers, whatever they are stored as
        if violation.rule in OF_ONE_JOINT:
            name = title(gltf.object().get("nodes", []), joints[violation.item])
            violation = violation._replace(text=f"{name}: {violation.text}")
        if violation.rule != BIND_SINGULAR or not lenient:
            refuse(f"{skin.where}:", violation)
        text = f"{violation.text}, so the joint has no bind pose"
        notices.append(Notice("bind-flat", f"{skin.where}: {text}", joint=name))
        break
    return numbers[: len(joints)].reshape(-1, 4, 4)
