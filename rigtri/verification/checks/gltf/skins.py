"""Skins: joints, inverse bind matrices, and the tree they stand in.

Source: glTF 2.0 §3.7.3.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from rigtri.formats.gltf.accessors import FLOAT
from rigtri.formats.gltf.node_reader import AFFINE
from rigtri.formats.gltf.skin_reader import flat
from rigtri.maths.trigonometry import Floats
from rigtri.verification.checks.findings import listed
from rigtri.verification.checks.gltf.tolerant_reader import View


def check(view: View) -> None:
    """All skins. Fills ``view.joints``."""
    used = {node.get("skin") for node in view.nodes if type(node.get("skin")) is int}
    for number, skin in enumerate(view.lists["skins"]):
        place, pointer = title(view, number), f"/skins/{number}"
        joints = _joints(view, skin, place, pointer)
        _check_tree(view, skin, [joint for joint in joints if joint is not None], place, pointer)
        _check_binds(view, skin, joints, place, pointer)
        if number not in used:
            view.add("gltf.skin.unused", place, pointer, "no node uses it")


def title(view: View, number: int) -> str:
    """What to call a skin."""
    name = view.lists["skins"][number].get("name")
    return f"skin '{name}' (#{number})" if isinstance(name, str) and name else f"skin #{number}"


def _joints(view: View, skin: dict[str, Any], place: str, pointer: str) -> list[int | None]:
    """The joints of a skin, None in place of each that is not there."""
    listed_here = view.items(skin, "joints", place, pointer)
    if not listed_here:
        view.add("gltf.skin.no-joints", place, f"{pointer}/joints", "has no joints")
    joints = [
        view.index(raw, len(view.nodes), "node", place, f"{pointer}/joints/{k}", "gltf.skin.joint-missing")
        for k, raw in enumerate(listed_here)
    ]
    for joint, count in Counter(joints).items():
        if joint is not None and count > 1:
            second = [k for k, other in enumerate(joints) if other == joint][1]
            text = f"lists {view.title(joint)} {count} times"
            view.add("gltf.skin.joint-twice", place, f"{pointer}/joints/{second}", text)
    for joint in joints:
        if joint is not None:
            view.joints.setdefault(joint, place)
    return joints


def _check_tree(view: View, skin: dict[str, Any], joints: list[int], place: str, pointer: str) -> None:
    top = _topmost(view)
    roots = sorted({top[joint] for joint in joints})
    if len(roots) > 1:
        text = f"its joints hang in {len(roots)} trees, below {listed(view.titles(roots))}"
        view.add("gltf.skin.no-common-root", place, f"{pointer}/joints", text)
    pivot = view.reference(skin, "skeleton", "node", place, pointer)
    if pivot is None:
        return
    below = _below(view, pivot)
    outside = [joint for joint in joints if joint not in below]
    if outside:
        text = f"its skeleton, {view.title(pivot)}, is not above {listed(view.titles(outside), 3)}"
        view.add("gltf.skin.skeleton-not-above", place, f"{pointer}/skeleton", text)


def _topmost(view: View) -> list[int]:
    """The root of each node's tree."""
    top = [-1] * len(view.nodes)
    for node in range(len(view.nodes)):
        line, at = [], node
        while at >= 0 and top[at] < 0:
            line.append(at)
            at = view.above[at]
        root = top[at] if at >= 0 else line[-1]
        for member in line:
            top[member] = root
    return top


def _below(view: View, pivot: int) -> set[int]:
    """A node and all below it."""
    children: dict[int, list[int]] = {}
    for node, parent in enumerate(view.above):
        children.setdefault(parent, []).append(node)
    found, todo = {pivot}, [pivot]
    while todo:
        for child in children.get(todo.pop(), ()):
            found.add(child)
            todo.append(child)
    return found


def _check_binds(
    view: View, skin: dict[str, Any], joints: list[int | None], place: str, pointer: str
) -> None:
    where = f"{pointer}/inverseBindMatrices"
    if "inverseBindMatrices" not in skin:
        text = "has no inverse bind matrices; they count as identity"
        view.add("gltf.skin.inverse-bind-missing", place, pointer, text)
        return
    numbers = view.read(skin["inverseBindMatrices"], place, where)
    if numbers is None:
        return
    component = view.raw_accessor(skin["inverseBindMatrices"]).get("componentType")
    if numbers.shape[1] != 16 or component != FLOAT:
        text = f"its inverse bind matrices have {numbers.shape[1]} numbers each, of type {component}"
        view.add("gltf.skin.inverse-bind-type", place, where, text)
    if numbers.shape[1] != 16:
        return
    if len(numbers) < len(joints):
        text = f"has {len(numbers)} inverse bind matrices for {len(joints)} joints"
        view.add("gltf.skin.inverse-bind-count", place, where, text)
    _check_matrices(view, numbers[: len(joints)].reshape(-1, 4, 4), joints, place, where)


def _check_matrices(view: View, matrices: Floats, joints: list[int | None], place: str, where: str) -> None:
    lost = ~np.isfinite(matrices).all(axis=(1, 2))
    with np.errstate(invalid="ignore", over="ignore"):
        last = ~lost & (np.abs(matrices[:, :, 3] - [0.0, 0.0, 0.0, 1.0]).max(axis=1) > AFFINE)
        singular = ~lost & ~last & flat(matrices)
    for rule, wrong, text in (
        ("gltf.skin.inverse-bind-nan", lost, "has a value that is not a number"),
        ("gltf.skin.inverse-bind-last-row", last, "has a last row that is not 0 0 0 1"),
        ("gltf.skin.inverse-bind-singular", singular, "is flat"),
    ):
        for row in np.flatnonzero(wrong).tolist():
            joint = joints[row]
            name = f"joint {row}" if joint is None else view.title(joint)
            view.add(rule, f"{place}, {name}", where, f"inverse bind matrix {row} {text}")
