"""Nodes: the tree, their transforms, and what they show.

Source: glTF 2.0 §3.5.2 (hierarchy), §3.5.3 (transformations), §3.7.3.3 (skinned meshes).
"""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np

from rigtri.formats.gltf.animation_reader import target_of
from rigtri.formats.gltf.rules import WIDTH, matrix_violations, rotation_violations, transform_violation
from rigtri.frames.nonuniform_scale import SAME_SCALE
from rigtri.maths.matrices import determinant
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.text import and_more
from rigtri.verification.checks.gltf.tolerant_reader import View


def check(view: View) -> None:
    """The tree and every node's own transform. Fills ``view.above``, without any cycle."""
    _check_tree(view)
    _check_scenes(view)
    _check_transforms(view)


def _check_tree(view: View) -> None:
    # Each node that another list of children has, too: its first parent, where that list is, and how often.
    again: dict[tuple[int, int], tuple[int, str, int]] = {}
    for index, node in enumerate(view.each("nodes")):
        for number, child in enumerate(node.indices("children", "node")):
            where = f"{node.pointer}/children/{number}"
            if child is not None and view.above[child] >= 0:
                first, reported, times = again.get((index, child), (view.above[child], where, 0))
                again[index, child] = first, reported, times + 1
            elif child is not None:
                view.above[child] = index
    _cut_cycles(view)
    first_below, last_below = _spans(view.above)
    for (parent, child), (first, where, times) in again.items():
        often = f" ({times} times)" if times > 1 else ""
        rule = "gltf.node.two-parents"
        if first == parent:
            text = f"is {times + 1} times among the children of {view.title(parent)}"
        elif first_below[child] <= first_below[parent] <= last_below[child]:
            rule, text = (
                "gltf.node.cycle",
                f"is below itself: {view.title(parent)} is below it and its parent",
            )
            text += often
        else:
            text = f"is below two parents, {and_more(view.titles((first, parent)))}{often}"
        view.add(rule, view.title(child), where, text)


def _spans(above: list[int]) -> tuple[list[int], list[int]]:
    """The nodes' places, and of those below each the last, where all below a node follow it. No cycles."""
    below: list[list[int]] = [[] for _ in above]
    for node, parent in enumerate(above):
        if parent >= 0:
            below[parent].append(node)
    order: list[int] = []
    todo = [node for node, parent in enumerate(above) if parent < 0]
    while todo:
        order.append(todo.pop())
        todo += below[order[-1]]
    place = [0] * len(above)
    for number, node in enumerate(order):
        place[node] = number
    last = list(place)
    for node in reversed(order):
        if above[node] >= 0:
            last[above[node]] = max(last[above[node]], last[node])
    return place, last


def _cut_cycles(view: View) -> None:
    """Name the nodes of each cycle, and take one of its links away so that what follows can end."""
    done = [False] * len(view.nodes)
    for start in range(len(view.nodes)):
        line: dict[int, None] = {}
        node = start
        while node >= 0 and not done[node] and node not in line:
            line[node] = None
            node = view.above[node]
        if node in line:
            members = list(line)[list(line).index(node) :]
            text = f"is below itself: {and_more(view.titles(members[::-1]))}"
            view.add("gltf.node.cycle", view.title(node), f"/nodes/{node}", text)
            view.above[node] = -1
        for member in line:
            done[member] = True


def _check_scenes(view: View) -> None:
    for number, scene in enumerate(view.each("scenes")):
        scene.place = f"scene #{number}"
        reported: set[int] = set()
        for k, node in enumerate(scene.indices("nodes", "node")):
            if node is not None and view.above[node] >= 0 and node not in reported:
                reported.add(node)
                text = f"lists {view.title(node)}, which is below {view.title(view.above[node])}"
                scene.add("gltf.scene.not-root", text, f"nodes/{k}")
    view.file.reference("scene", "scene")


def _check_transforms(view: View) -> None:
    animated = _animated(view)
    rotations: dict[int, list[float]] = {}
    matrices: dict[int, list[float]] = {}
    for index, node in enumerate(view.each("nodes")):
        for key, width in WIDTH.items():
            if key in node.raw and (given := node.numbers(key, width)) is not None and key == "rotation":
                rotations[index] = given
        if "matrix" in node.raw:
            if (given := node.numbers("matrix", 16)) is not None:
                matrices[index] = given
            node.add_violation(transform_violation(node.raw, animated=index in animated), "matrix")
    stacked = np.array(list(matrices.values())).reshape(-1, 4, 4)
    for key, rows, violations in (
        ("rotation", rotations, rotation_violations(np.array(list(rotations.values())).reshape(-1, 4))),
        ("matrix", matrices, matrix_violations(stacked)),
    ):
        nodes = list(rows)
        for violation in violations:
            view.item("nodes", nodes[violation.item]).add_violation(violation, key)


def _animated(view: View) -> set[int]:
    """Nodes whose translation, rotation or scale a channel drives."""
    found = set()
    for animation in view.lists["animations"]:
        channels = animation.get("channels")
        for channel in channels if isinstance(channels, list) else ():
            target = target_of(channel) if isinstance(channel, dict) else None
            if target is not None and target[1] in WIDTH:
                found.add(target[0])
    return found


# --- joints, once the skins are known


def check_joints(view: View) -> None:
    """The names and scales of joints."""
    _check_names(view)
    joints = sorted(view.joints)
    if not joints:
        return
    scales = np.array([_scale(view.nodes[node]) for node in joints])
    size = np.abs(scales)
    uneven = size.max(axis=1) - size.min(axis=1) > SAME_SCALE * size.max(axis=1)
    mirrored = scales[:, 0] * scales[:, 1] * scales[:, 2] < 0
    for k in np.flatnonzero(uneven & (size > 0).all(axis=1)).tolist():
        text = f"its scale is {' '.join(f'{x:g}' for x in scales[k])} at rest"
        view.stretched.setdefault(joints[k], []).insert(0, text)
    for node, texts in sorted(view.stretched.items()):
        more = f" ({len(texts) - 1} channels more)" if len(texts) > 1 else ""
        view.add("gltf.joint.scale-nonuniform", view.title(node), f"/nodes/{node}", texts[0] + more)
    for k in np.flatnonzero(mirrored).tolist():
        view.add("gltf.joint.mirrored", view.title(joints[k]), f"/nodes/{joints[k]}", "its frame is mirrored")
    _check_zero(view)


def _check_names(view: View) -> None:
    names = {node: view.nodes[node].get("name") for node in sorted(view.joints)}
    known = Counter(name for name in names.values() if isinstance(name, str) and name)
    for name, count in known.items():
        if count > 1:
            same = [node for node, other in names.items() if other == name]
            text = f"{count} joints are named '{name}': {and_more(f'#{node}' for node in same)}"
            view.add("gltf.joint.name-twice", f"joint '{name}'", f"/nodes/{same[1]}/name", text)
    for node, own in names.items():
        if not isinstance(own, str) or not own:
            view.add("gltf.joint.unnamed", view.title(node), f"/nodes/{node}", "has no name")


def _check_zero(view: View) -> None:
    """Scales of zero on joints and on what is above them."""
    above: set[int] = set()
    for node in view.joints:
        while node >= 0 and node not in above:
            above.add(node)
            node = view.above[node]
    for node in sorted(above):
        raw = view.nodes[node].get("scale")
        if isinstance(raw, list) and 0 in raw and "matrix" not in view.nodes[node]:
            text = f"its scale is {' '.join(map(str, raw[:3]))}"
            view.add("gltf.joint.scale-zero", view.title(node), f"/nodes/{node}/scale", text)


def _scale(node: dict[str, Any]) -> Floats:
    """A node's own scale; that of a matrix is the length of its axes, negative where it is mirrored."""
    raw = node.get("scale", [1.0, 1.0, 1.0])
    try:
        matrix = np.array(node["matrix"], dtype=np.float64).reshape(4, 4) if "matrix" in node else None
        scale = np.array(raw, dtype=np.float64).reshape(3)
    except (TypeError, ValueError, OverflowError):
        return np.ones(3)  # reported already, where its numbers were read
    if matrix is None:
        return scale if np.isfinite(scale).all() else np.ones(3)
    sign = -1.0 if determinant(matrix) < 0 else 1.0
    scale = length(matrix[:3, :3]) * sign
    return scale if np.isfinite(scale).all() else np.ones(3)
