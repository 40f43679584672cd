"""Skins: joints, inverse bind matrices, and the tree they stand in.

Weights are checked where they are read, in `meshes`.

Source: glTF 2.0 §3.7.3.
"""

from __future__ import annotations

from rigtri.formats.gltf.rules import OF_ONE_JOINT, bind_violations, joint_violations, joints_outside
from rigtri.text import and_more
from rigtri.verification.checks.gltf.tolerant_reader import Item, View


def check(view: View) -> None:
    """All skins. Fills ``view.joints``."""
    used = {node.get("skin") for node in view.nodes if type(node.get("skin")) is int}
    top = _topmost(view)
    for number, skin in enumerate(view.each("skins")):
        joints = skin.indices("joints", "node", "gltf.skin.joint-missing")
        for violation in joint_violations(joints, view.title):
            skin.add_violation(violation, f"joints/{violation.item}" if joints else "joints")
        present = [joint for joint in joints if joint is not None]
        for joint in present:
            view.joints.setdefault(joint, skin.place)
        _check_tree(view, skin, present, top)
        _check_binds(view, skin, joints)
        if number not in used:
            skin.add("gltf.skin.unused", "no node uses it")


def _check_tree(view: View, skin: Item, joints: list[int], top: list[int]) -> None:
    """top: the root of each node's tree."""
    roots = sorted({top[joint] for joint in joints})
    if len(roots) > 1:
        text = f"its joints are in {len(roots)} hierarchies, below {and_more(view.titles(roots))}"
        skin.add("gltf.skin.no-common-root", text, "joints")
    pivot = skin.reference("skeleton", "node")
    outside = [] if pivot is None else joints_outside(joints, pivot, view.above)
    if pivot is not None and outside:
        text = f"its skeleton, {view.title(pivot)}, is not above {and_more(view.titles(outside), 3)}"
        skin.add("gltf.skin.skeleton-not-above", text, "skeleton")


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


def _check_binds(view: View, skin: Item, joints: list[int | None]) -> None:
    key = "inverseBindMatrices"
    if key not in skin.raw:
        skin.add("gltf.skin.inverse-bind-missing", "has no inverse bind matrices; they count as identity")
        return
    numbers = skin.read(key)
    if numbers is None:
        return
    for violation in bind_violations(numbers, skin.accessor(key).get("componentType"), len(joints)):
        place = skin.place
        if violation.rule in OF_ONE_JOINT:
            joint = joints[violation.item]
            place += f", {f'joint {violation.item}' if joint is None else view.title(joint)}"
        view.add(violation.rule, place, f"{skin.pointer}/{key}", violation.text)
