"""Meshes: what moves their points, and whether the nodes that show them fit.

Source: glTF 2.0 §3.6.2.2 (NaN and infinities must not be present), §3.7.2 (attributes, morph targets),
§3.7.3.3 (skinned meshes).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from rigtri.formats.gltf.accessors import FLOAT
from rigtri.formats.gltf.mesh_reader import DRACO
from rigtri.maths.trigonometry import Floats
from rigtri.verification.checks.findings import listed
from rigtri.verification.checks.gltf import skins
from rigtri.verification.checks.gltf.tolerant_reader import FOREIGN, View

_SET = re.compile(r"(JOINTS|WEIGHTS)_(\d+)")
_UNSIGNED = (5121, 5123)
# Weights in 32 bits do not sum to 1 exactly; each of n may be off by this.
OFF_EACH = 2e-7
# One step of weights in 8 and in 16 bits.
_STEPS = {5121: 1 / 255, 5123: 1 / 65535}


class Primitive(NamedTuple):
    """The influences of a primitive, (v, 4·sets), and where it stands. steps: how far its sum may be off."""

    joints: Floats
    weights: Floats
    allowed: float
    place: str
    pointer: str


def check(view: View) -> None:
    """The meshes that nodes show, each with every skin that moves it."""
    meshes = view.lists["meshes"]
    shown: dict[int, set[int]] = {}
    skinned = [_names_joints(view, mesh, k) for k, mesh in enumerate(meshes)]
    for node, raw in enumerate(view.nodes):
        pointer, place = f"/nodes/{node}", view.title(node)
        mesh = view.reference(raw, "mesh", "mesh", place, pointer)
        skin = view.reference(raw, "skin", "skin", place, pointer)
        if mesh is not None and skin is not None:
            shown.setdefault(mesh, set()).add(skin)
            _check_place(view, node, skin)
        _check_pair(view, node, raw, mesh, mesh is not None and skinned[mesh])
    for number in range(len(meshes)):
        _check_positions(view, number)
        if skinned[number]:
            _check_mesh(view, number, sorted(shown.get(number, ())))


def _names_joints(view: View, mesh: dict[str, Any], number: int) -> bool:
    place, pointer = title(view, number), f"/meshes/{number}"
    names: set[str] = set()
    for k, primitive in enumerate(view.objects(mesh, "primitives", place, pointer)):
        names |= view.object(primitive, "attributes", place, f"{pointer}/primitives/{k}").keys()
    return any(_SET.fullmatch(name) for name in names)


def title(view: View, number: int) -> str:
    name = view.lists["meshes"][number].get("name")
    return f"mesh '{name}' (#{number})" if isinstance(name, str) and name else f"mesh #{number}"


def _check_pair(view: View, node: int, raw: dict[str, Any], mesh: int | None, skinned: bool) -> None:
    place, pointer = view.title(node), f"/nodes/{node}"
    if "skin" in raw and "mesh" not in raw:
        view.add("gltf.node.skin-without-mesh", place, f"{pointer}/skin", "has a skin and no mesh")
    elif "skin" in raw and mesh is not None and not skinned:
        text = f"has a skin, but {title(view, mesh)} names no joints"
        view.add("gltf.node.skin-on-rigid-mesh", place, f"{pointer}/skin", text)
    elif "skin" not in raw and mesh is not None and skinned:
        text = f"shows {title(view, mesh)}, which names joints, without a skin"
        view.add("gltf.node.skinned-mesh-without-skin", place, pointer, text)


def _check_place(view: View, node: int, skin: int) -> None:
    """Where a skinned mesh hangs, which glTF ignores and other programs do not."""
    joints = {j for j in view.items(view.lists["skins"][skin], "joints", "", "") if type(j) is int}
    placed, at = False, node
    while at >= 0:
        raw = view.nodes[at]
        placed = placed or any(key in raw for key in ("translation", "rotation", "scale", "matrix"))
        if at != node and at in joints:
            text = f"is below {view.title(at)}, a joint of its own {skins.title(view, skin)}"
            view.add("gltf.node.skinned-mesh-below-joint", view.title(node), f"/nodes/{node}", text)
            return
        at = view.above[at]
    if placed:
        text = "it shows a skinned mesh, and it or a node above it has a transform"
        view.add("gltf.node.skinned-mesh-placed", view.title(node), f"/nodes/{node}", text)


def _check_mesh(view: View, number: int, using: list[int]) -> None:
    mesh = view.lists["meshes"][number]
    for k, raw in enumerate(view.objects(mesh, "primitives", title(view, number), f"/meshes/{number}")):
        place, pointer = f"{title(view, number)}, primitive {k}", f"/meshes/{number}/primitives/{k}"
        if DRACO in view.object(raw, "extensions", place, pointer):
            view.compressed("Meshes are compressed with Draco")
            continue
        attributes = view.object(raw, "attributes", place, pointer)
        primitive = _influences(view, attributes, place, f"{pointer}/attributes")
        if primitive is not None:
            _check_weights(view, primitive)
            for skin in using:
                _check_joints(view, primitive, skin)


def _check_positions(view: View, number: int) -> None:
    """The min and max of positions, from which loaders take the size of a mesh."""
    mesh = view.lists["meshes"][number]
    for k, raw in enumerate(view.objects(mesh, "primitives", title(view, number), f"/meshes/{number}")):
        place, pointer = f"{title(view, number)}, primitive {k}", f"/meshes/{number}/primitives/{k}"
        if DRACO in view.object(raw, "extensions", place, pointer):
            continue
        index = view.object(raw, "attributes", place, pointer).get("POSITION")
        if type(index) is not int or not 0 <= index < len(view.accessors):
            continue  # `references` reports it
        accessor = view.raw_accessor(index)
        missing = [key for key in ("min", "max") if key not in accessor]
        if missing:
            text = f"its positions, accessor #{index}, have no {' and no '.join(missing)}"
            view.add("gltf.accessor.bounds", place, f"/accessors/{index}", text)
        if len(missing) < 2:
            view.judge(index)


def _influences(view: View, attributes: dict[str, Any], place: str, pointer: str) -> Primitive | None:
    sets = {kind: {int(m[2]) for name in attributes if (m := _SET.fullmatch(name)) and m[1] == kind}
            for kind in ("JOINTS", "WEIGHTS")}  # fmt: skip
    every = sets["JOINTS"] | sets["WEIGHTS"]
    if sets["JOINTS"] != sets["WEIGHTS"] or (every and every != set(range(len(every)))):
        text = f"has {listed(sorted(name for name in attributes if _SET.fullmatch(name)))}"
        view.add("gltf.mesh.joints-without-weights", place, pointer, text)
    both = sorted(sets["JOINTS"] & sets["WEIGHTS"])
    parts: list[tuple[Floats, Floats]] = []
    allowed = 0.0
    for number in both:
        joints = _read(view, attributes, f"JOINTS_{number}", place, pointer)
        weights = _read(view, attributes, f"WEIGHTS_{number}", place, pointer)
        if joints is None or weights is None:
            return None
        component = view.raw_accessor(attributes[f"WEIGHTS_{number}"]).get("componentType")
        allowed += 4 * (_STEPS.get(int(component or 0), 0.0) / 2 + OFF_EACH)
        parts.append((joints, weights))
    if not parts or not _counts_fit(view, attributes, parts, place, pointer):
        return None
    joints, weights = (np.concatenate(columns, axis=1) for columns in zip(*parts, strict=True))
    return Primitive(joints, weights, allowed, place, pointer)


def _read(view: View, attributes: dict[str, Any], name: str, place: str, pointer: str) -> Floats | None:
    """Four numbers a point; None, with a finding, where they are something else."""
    where = f"{pointer}/{name}"
    numbers = view.read(attributes[name], place, where)
    if numbers is None:
        return None
    raw = view.raw_accessor(attributes[name])
    component, normalized = raw.get("componentType"), raw.get("normalized") is True
    if name.startswith("JOINTS"):
        right = component in _UNSIGNED and not normalized
    else:
        right = component == FLOAT or (component in _UNSIGNED and normalized)
    if numbers.shape[1] != 4 or not right:
        kind = f"{raw.get('type')} of component type {component}{' normalized' if normalized else ''}"
        view.add("gltf.mesh.influence-type", place, where, f"{name} is {kind}")
    return numbers if numbers.shape[1] == 4 and len(numbers) else None


def _counts_fit(
    view: View, attributes: dict[str, Any], parts: list[tuple[Floats, Floats]], place: str, pointer: str
) -> bool:
    counts = {len(column) for part in parts for column in part}
    if "POSITION" in attributes:
        index = attributes["POSITION"]
        known = view.lists["accessors"]
        count = known[index].get("count") if type(index) is int and 0 <= index < len(known) else None
        counts |= {count} if type(count) is int else set()
    if len(counts) > 1:
        text = f"positions, joints and weights are {listed(map(str, sorted(counts)))}"
        view.add("gltf.mesh.influence-count", place, pointer, text)
    return len({len(column) for part in parts for column in part}) == 1


def _check_weights(view: View, primitive: Primitive) -> None:
    weights = primitive.weights
    finite = np.isfinite(weights).all(axis=1)
    known = np.where(np.isfinite(weights), weights, 0.0)
    total = known.sum(axis=1)
    zero = finite & (known == 0).all(axis=1)
    off = finite & ~zero & (np.abs(total - 1.0) > primitive.allowed)
    worst = int(np.argmax(np.where(off, np.abs(total - 1.0), -1.0)))
    for rule, wrong, message in (
        ("gltf.mesh.weight-nan", ~finite, lambda k: f"point {k} has a weight that is not a number"),
        (
            "gltf.mesh.weight-negative",
            (known < 0).any(axis=1),
            lambda k: f"point {k} has {known[k].min():g}",
        ),
        ("gltf.mesh.weight-zero", zero, lambda k: f"all weights of point {k} are zero"),
        ("gltf.mesh.weight-sum", off, lambda k: f"the weights of point {worst} sum to {total[worst]:.7g}"),
        ("gltf.mesh.joint-repeated", _repeated(primitive), lambda k: f"point {k} names a joint twice"),
    ):
        _note(view, rule, wrong, primitive, message)


def _repeated(primitive: Primitive) -> Any:
    """Points that name a joint twice with weight, (v,)."""
    # Those without weight get numbers of their own, which equal no other.
    width = primitive.joints.shape[1]
    joints = np.where(primitive.weights != 0, primitive.joints, -1.0 - np.arange(width))
    ordered = np.sort(joints, axis=1)
    return (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)


def _check_joints(view: View, primitive: Primitive, skin: int) -> None:
    count = len(view.items(view.lists["skins"][skin], "joints", "", ""))
    if not count:
        return  # reported for the skin
    outside, live = primitive.joints >= count, primitive.weights != 0
    used = (outside & live).any(axis=1)
    idle = (outside & ~live).any(axis=1)
    text = f"which {skins.title(view, skin)} of {count} joints does not have"
    for rule, wrong in (
        ("gltf.mesh.joint-out-of-range", used),
        ("gltf.mesh.joint-out-of-range-unweighted", idle),
    ):
        _note(
            view,
            rule,
            wrong,
            primitive,
            lambda k: f"point {k} names joint {primitive.joints[k].max():g}, {text}",
        )


def _note(view: View, rule: str, wrong: Any, primitive: Primitive, message: Callable[[int], str]) -> None:
    """One finding for all points of a primitive: how many, and the first."""
    found = np.flatnonzero(wrong)
    if len(found):
        more = f" ({len(found)} of {len(wrong)} points)"
        view.add(rule, primitive.place, primitive.pointer, message(int(found[0])) + more)


# --- numbers of vertices that are none: NaN and Inf, which engines show as holes or not at all


def check_vertices(view: View) -> None:
    """The float attributes and morph targets of all primitives."""
    known: dict[int, tuple[int, int, int]] = {}
    for number, mesh in enumerate(view.lists["meshes"]):
        place = title(view, number)
        for k, raw in enumerate(view.objects(mesh, "primitives", place, f"/meshes/{number}")):
            for index, name, where in _attributes(view, raw, place, f"/meshes/{number}/primitives/{k}"):
                if index not in known:
                    known[index] = _gaps(view, index)
                first, gone, count = known[index]
                if gone:
                    text = f"vertex {first} is not a finite number ({gone} of {count} vertices)"
                    view.add("gltf.mesh.vertex-nan", f"{place}, primitive {k}, {name}", where, text)


def _attributes(view: View, raw: dict[str, Any], place: str, pointer: str) -> Iterator[tuple[int, str, str]]:
    """Accessor, name and JSON pointer of all attributes of a primitive's vertices that are floats."""
    own = view.object(raw, "attributes", place, pointer)
    parts = [("", own, f"{pointer}/attributes")]
    if DRACO in view.object(raw, "extensions", place, pointer):
        parts = []  # `check` reports that they were not looked at
    for number, target in enumerate(view.objects(raw, "targets", place, pointer)):
        parts.append((f"morph target {number} ", target, f"{pointer}/targets/{number}"))
    for prefix, attributes, where in parts:
        for name, index in attributes.items():
            # Weights with joints are judged together, point by point.
            if name.startswith("WEIGHTS_") and name.replace("WEIGHTS", "JOINTS") in own:
                continue
            if type(index) is not int or not 0 <= index < len(view.accessors):
                continue  # `references` reports it
            accessor = view.raw_accessor(index)
            if accessor.get("componentType") == FLOAT and accessor.get("type") not in FOREIGN:
                yield index, f"{prefix}{name}", f"{where}/{name}"


def _gaps(view: View, index: int) -> tuple[int, int, int]:
    """The first row of an accessor that is not finite, how many are not, and how many there are."""
    first, gone, count = -1, 0, 0
    for block in view.blocks(index):
        wrong = np.flatnonzero(~np.isfinite(block).all(axis=1))
        if len(wrong) and first < 0:
            first = count + int(wrong[0])
        gone, count = gone + len(wrong), count + len(block)
    return first, gone, count
