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
from rigtri.maths.ranking import first_largest
from rigtri.maths.trigonometry import Floats
from rigtri.text import and_more
from rigtri.verification.checks.gltf.tolerant_reader import FOREIGN, Item, View

_SET = re.compile(r"(JOINTS|WEIGHTS)_([0-9]{1,18})")
_UNSIGNED = (5121, 5123)
# Weights in 32 bits do not sum to 1 exactly; each of n may be off by this.
OFF_EACH = 2e-7
# One step of weights in 8 and in 16 bits.
_STEPS = {5121: 1 / 255, 5123: 1 / 65535}


class Primitive(NamedTuple):
    """The influences of a primitive, (v, 4·sets), and its attributes. allowed: how far its sum may be off."""

    joints: Floats
    weights: Floats
    allowed: float
    attributes: Item


def check(view: View) -> None:
    """The meshes that nodes show, each with every skin that moves it."""
    shown: dict[int, set[int]] = {}
    skinned = [_names_joints(mesh) for mesh in view.each("meshes")]
    for index, node in enumerate(view.each("nodes")):
        mesh, skin = node.reference("mesh", "mesh"), node.reference("skin", "skin")
        if mesh is not None and skin is not None:
            shown.setdefault(mesh, set()).add(skin)
            _check_place(view, index, node, skin)
        _check_pair(node, mesh, mesh is not None and skinned[mesh])
    for number in range(len(skinned)):
        primitives = _primitives(view, number)
        for primitive in primitives:
            _check_positions(view, primitive)
        for primitive in primitives if skinned[number] else ():
            _check_influences(view, primitive, sorted(shown.get(number, ())))


def _names_joints(mesh: Item) -> bool:
    names = [name for primitive in mesh.objects("primitives") for name in primitive.object("attributes").raw]
    return any(_SET.fullmatch(name) for name in names)


def _primitives(view: View, number: int) -> list[Item]:
    """The primitives of a mesh, each with its number in what it is called."""
    found = view.item("meshes", number).objects("primitives")
    for k, primitive in enumerate(found):
        primitive.place += f", primitive {k}"
    return found


def _check_pair(node: Item, mesh: int | None, skinned: bool) -> None:
    if "skin" in node.raw and "mesh" not in node.raw:
        node.add("gltf.node.skin-without-mesh", "has a skin and no mesh", "skin")
    elif mesh is not None and ("skin" in node.raw) is not skinned:
        title = node.view.item("meshes", mesh).place
        if skinned:
            text = f"shows {title}, which names joints, without a skin"
            node.add("gltf.node.skinned-mesh-without-skin", text)
        else:
            text = f"has a skin, but {title} names no joints"
            node.add("gltf.node.skin-on-rigid-mesh", text, "skin")


def _check_place(view: View, index: int, node: Item, skin: int) -> None:
    """Where a skinned mesh is parented, which glTF ignores and other programs do not."""
    own = view.item("skins", skin)
    joints = {j for j in own.items("joints") if type(j) is int}
    placed, at = False, index
    while at >= 0:
        raw = view.nodes[at]
        placed = placed or any(key in raw for key in ("translation", "rotation", "scale", "matrix"))
        if at != index and at in joints:
            text = f"is below {view.title(at)}, a joint of its own {own.place}"
            node.add("gltf.node.skinned-mesh-below-joint", text)
            return
        at = view.above[at]
    if placed:
        text = "it shows a skinned mesh, and it or a node above it has a transform"
        node.add("gltf.node.skinned-mesh-placed", text)


def _check_influences(view: View, primitive: Item, skins: list[int]) -> None:
    if DRACO in primitive.object("extensions").raw:
        view.compressed("Meshes are compressed with Draco")
        return
    influences = _influences(primitive.object("attributes"))
    if influences is not None:
        _check_weights(influences)
        for skin in skins:
            _check_joints(view, influences, skin)


def _check_positions(view: View, primitive: Item) -> None:
    """The min and max of positions, from which loaders take the size of a mesh."""
    if DRACO in primitive.object("extensions").raw:
        return
    index = primitive.object("attributes").raw.get("POSITION")
    if type(index) is not int or not 0 <= index < len(view.accessors):
        return  # `references` reports it
    accessor = view.raw_accessor(index)
    missing = [key for key in ("min", "max") if key not in accessor]
    if missing:
        text = f"its positions, accessor #{index}, have no {' and no '.join(missing)}"
        view.add("gltf.accessor.bounds", primitive.place, f"/accessors/{index}", text)
    if len(missing) < 2:
        view.judge(index)


def _influences(attributes: Item) -> Primitive | None:
    sets = {kind: {int(m[2]) for name in attributes.raw if (m := _SET.fullmatch(name)) and m[1] == kind}
            for kind in ("JOINTS", "WEIGHTS")}  # fmt: skip
    every = sets["JOINTS"] | sets["WEIGHTS"]
    if sets["JOINTS"] != sets["WEIGHTS"] or (every and every != set(range(len(every)))):
        text = f"has {and_more(sorted(name for name in attributes.raw if _SET.fullmatch(name)))}"
        attributes.add("gltf.mesh.joints-without-weights", text)
    parts: list[tuple[Floats, Floats]] = []
    allowed = 0.0
    for number in sorted(sets["JOINTS"] & sets["WEIGHTS"]):
        joints, weights = _read(attributes, f"JOINTS_{number}"), _read(attributes, f"WEIGHTS_{number}")
        if joints is None or weights is None:
            return None
        component = attributes.accessor(f"WEIGHTS_{number}").get("componentType")
        allowed += 4 * (_STEPS.get(int(component or 0), 0.0) / 2 + OFF_EACH)
        parts.append((joints, weights))
    if not parts or not _counts_fit(attributes, parts):
        return None
    joints, weights = (np.concatenate(columns, axis=1) for columns in zip(*parts, strict=True))
    return Primitive(joints, weights, allowed, attributes)


def _read(attributes: Item, name: str) -> Floats | None:
    """Four numbers a point; None, with a finding, where they are something else."""
    numbers = attributes.read(name)
    if numbers is None:
        return None
    raw = attributes.accessor(name)
    component, normalized = raw.get("componentType"), raw.get("normalized") is True
    if name.startswith("JOINTS"):
        right = component in _UNSIGNED and not normalized
    else:
        right = component == FLOAT or (component in _UNSIGNED and normalized)
    if numbers.shape[1] != 4 or not right:
        kind = f"{raw.get('type')} of component type {component}{' normalized' if normalized else ''}"
        attributes.add("gltf.mesh.influence-type", f"{name} is {kind}", name)
    return numbers if numbers.shape[1] == 4 and len(numbers) else None


def _counts_fit(attributes: Item, parts: list[tuple[Floats, Floats]]) -> bool:
    own = {len(column) for part in parts for column in part}
    index, known = attributes.raw.get("POSITION"), attributes.view.lists["accessors"]
    count = known[index].get("count") if type(index) is int and 0 <= index < len(known) else None
    counts = own | ({count} if type(count) is int else set())
    if len(counts) > 1:
        text = f"positions, joints and weights are {and_more(map(str, sorted(counts)))}"
        attributes.add("gltf.mesh.influence-count", text)
    return len(own) == 1


def _check_weights(primitive: Primitive) -> None:
    weights = primitive.weights
    finite = np.isfinite(weights).all(axis=1)
    known = np.where(np.isfinite(weights), weights, 0.0)
    total = known.sum(axis=1)
    zero = finite & (known == 0).all(axis=1)
    off = finite & ~zero & (np.abs(total - 1.0) > primitive.allowed)
    worst = first_largest(np.where(off, np.abs(total - 1.0), -1.0))
    for rule, wrong, message in (
        ("gltf.mesh.weight-nan", ~finite, lambda k: f"vertex {k} has a weight that is not a number"),
        (
            "gltf.mesh.weight-negative",
            (known < 0).any(axis=1),
            lambda k: f"vertex {k} has {known[k].min():g}",
        ),
        ("gltf.mesh.weight-zero", zero, lambda k: f"all weights of vertex {k} are zero"),
        ("gltf.mesh.weight-sum", off, lambda k: f"the weights of vertex {worst} sum to {total[worst]:.7g}"),
        ("gltf.mesh.joint-repeated", _repeated(primitive), lambda k: f"vertex {k} names a joint twice"),
    ):
        _note(rule, wrong, primitive, message)


def _repeated(primitive: Primitive) -> Any:
    """Points that name a joint twice with weight, (v,)."""
    # Those without weight get numbers of their own, which equal no other.
    width = primitive.joints.shape[1]
    joints = np.where(primitive.weights != 0, primitive.joints, -1.0 - np.arange(width))
    ordered = np.sort(joints, axis=1)
    return (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)


def _check_joints(view: View, primitive: Primitive, skin: int) -> None:
    own = view.item("skins", skin)
    count = len(own.items("joints"))
    if not count:
        return  # reported for the skin
    outside, live = primitive.joints >= count, primitive.weights != 0
    used = (outside & live).any(axis=1)
    idle = (outside & ~live).any(axis=1)
    text = f"which {own.place} of {count} joints does not have"
    most = primitive.joints.max(axis=1)
    for rule, wrong in (
        ("gltf.mesh.joint-out-of-range", used),
        ("gltf.mesh.joint-out-of-range-unweighted", idle),
    ):
        _note(rule, wrong, primitive, lambda k: f"vertex {k} names joint {most[k]:g}, {text}")


def _note(rule: str, wrong: Any, primitive: Primitive, message: Callable[[int], str]) -> None:
    """One finding for all vertices of a primitive: how many, and the first."""
    found = np.flatnonzero(wrong)
    if len(found):
        more = f" ({len(found)} of {len(wrong)} vertices)"
        primitive.attributes.add(rule, message(int(found[0])) + more)


# --- numbers of vertices that are none: NaN and Inf, which engines show as holes or not at all


def check_vertices(view: View) -> None:
    """The float attributes and morph targets of all primitives."""
    known: dict[int, tuple[int, int, int]] = {}
    for number in range(view.count("mesh")):
        for primitive in _primitives(view, number):
            for index, name, where in _attributes(view, primitive):
                if index not in known:
                    known[index] = _gaps(view, index)
                first, gone, count = known[index]
                if gone:
                    text = f"vertex {first} is not a finite number ({gone} of {count} vertices)"
                    view.add("gltf.mesh.vertex-nan", f"{primitive.place}, {name}", where, text)


def _attributes(view: View, primitive: Item) -> Iterator[tuple[int, str, str]]:
    """Accessor, name and JSON pointer of all attributes of a primitive's vertices that are floats."""
    own = primitive.object("attributes")
    parts = [("", own)]
    if DRACO in primitive.object("extensions").raw:
        parts = []  # `check` reports that they were not looked at
    parts += [(f"morph target {k} ", target) for k, target in enumerate(primitive.objects("targets"))]
    for prefix, attributes in parts:
        for name, index in attributes.raw.items():
            # Weights with joints are judged together, point by point.
            if name.startswith("WEIGHTS_") and name.replace("WEIGHTS", "JOINTS") in own.raw:
                continue
            if type(index) is not int or not 0 <= index < len(view.accessors):
                continue  # `references` reports it
            accessor = view.raw_accessor(index)
            if accessor.get("componentType") == FLOAT and accessor.get("type") not in FOREIGN:
                yield index, f"{prefix}{name}", f"{attributes.pointer}/{name}"


def _gaps(view: View, index: int) -> tuple[int, int, int]:
    """The first row of an accessor that is not finite, how many are not, and how many there are."""
    first, gone, count = -1, 0, 0
    for block in view.blocks(index):
        wrong = np.flatnonzero(~np.isfinite(block).all(axis=1))
        if len(wrong) and first < 0:
            first = count + int(wrong[0])
        gone, count = gone + len(wrong), count + len(block)
    return first, gone, count
