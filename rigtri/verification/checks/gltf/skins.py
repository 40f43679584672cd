"""Skins: joints, inverse bind matrices, and the tree they stand in.

Weights are checked where they are read, in `meshes`.

Source: glTF 2.0 §3.7.3.
"""

from __future__ import annotations

from typing import Any

from rigtri.formats.gltf.rules import OF_ONE_JOINT, bind_violations, joint_violations, joints_outside
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
    joints = [
        view.index(raw, len(view.nodes), "node", place, f"{pointer}/joints/{k}", "gltf.skin.joint-missing")
        for k, raw in enumerate(listed_here)
    ]
    for violation in joint_violations(joints, view.title):
        at = f"/{violation.item}" if joints else ""
        view.add_violation(violation, place, f"{pointer}/joints{at}")
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
    outside = joints_outside(joints, pivot, view.above)
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
    for violation in bind_violations(numbers, component, len(joints)):
        at = place
        if violation.rule in OF_ONE_JOINT:
            joint = joints[violation.item]
            at = f"{place}, {f'joint {violation.item}' if joint is None else view.title(joint)}"
        view.add_violation(violation, at, where)
