"""Meshes: what moves their points, and whether the nodes that show them fit.

Source: glTF 2.0 §3.6.2.2 (NaN and infinities must not be present), §3.7.2 (attributes, morph targets),
§3.7.3.3 (skinned meshes).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from rigtri.formats.gltf.accessors import FLOAT
from rigtri.formats.gltf.mesh_reader import DRACO
from rigtri.maths.arrays import Booleans
from rigtri.maths.ranking import first_largest
from rigtri.maths.trigonometry import Floats
from rigtri.text import and_more
from rigtri.verification.checks.gltf.tolerant_reader import BLOCK, FOREIGN, Item, View

_SET = re.compile(r"(JOINTS|WEIGHTS)_([0-9]{1,18})")
_UNSIGNED = (5121, 5123)
# Weights in 32 bits do not sum to 1 exactly; each of n may be off by this.
OFF_EACH = 2e-7
# One step of weights in 8 and in 16 bits.
_STEPS = {5121: 1 / 255, 5123: 1 / 65535}


class Influences(NamedTuple):
    """What moves the points of a primitive: the accessors of its sets. allowed: how far a sum may be off."""

    joints: list[int]
    weights: list[int]
    rows: int
    allowed: float
    attributes: Item

    def blocks(self) -> Iterator[tuple[int, Floats, Floats]]:
        """Some points at a time: the first, and joints and weights, (v, 4·sets) each; none that is broken."""
        view = self.attributes.view
        for start in range(0, self.rows, BLOCK):
            parts = [
                [view.part(k, start, start + BLOCK) for k in kind] for kind in (self.joints, self.weights)
            ]
            joints, weights = ([part for part in kind if part is not None] for kind in parts)
            if len(joints) + len(weights) < 2 * len(self.joints):
                return
            yield start, np.concatenate(joints, axis=1), np.concatenate(weights, axis=1)


class Tally:
    """The points that break a rule: how many, and what is said of the first."""

    def __init__(self) -> None:
        self.count, self.text = 0, ""

    def add(self, wrong: Booleans, message: Callable[[int], str]) -> None:
        """Count those of a block, (v,). message: of a point's place in it."""
        found = np.flatnonzero(wrong)
        if len(found) and not self.count:
            self.text = message(int(found[0]))
        self.count += len(found)

    def note(self, rule: str, influences: Influences) -> None:
        """One finding for all."""
        if self.count:
            text = f"{self.text} ({self.count} of {influences.rows} vertices)"
            influences.attributes.add(rule, text)


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
    if influences is None:
        return
    tallies: dict[str, Tally] = {}
    sums = list[tuple[float, float, int]]()
    joints_of = {skin: len(view.item("skins", skin).items("joints")) for skin in skins}
    for start, joints, weights in influences.blocks():
        _check_weights(start, joints, weights, influences.allowed, tallies, sums)
        for skin, count in joints_of.items():
            if count:  # else reported for the skin
                title = f"{view.item('skins', skin).place} of {count} joints"
                _check_joints(start, joints, weights, count, title, tallies)
    if sums:
        _, total, worst = sums[first_largest([off for off, _, _ in sums])]
        tallies["gltf.mesh.weight-sum"].text = f"the weights of vertex {worst} sum to {total:.7g}"
    for rule, tally in tallies.items():
        tally.note(rule.partition(" ")[0], influences)


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


def _influences(attributes: Item) -> Influences | None:
    sets = {kind: {int(m[2]) for name in attributes.raw if (m := _SET.fullmatch(name)) and m[1] == kind}
            for kind in ("JOINTS", "WEIGHTS")}  # fmt: skip
    every = sets["JOINTS"] | sets["WEIGHTS"]
    if sets["JOINTS"] != sets["WEIGHTS"] or (every and every != set(range(len(every)))):
        text = f"has {and_more(sorted(name for name in attributes.raw if _SET.fullmatch(name)))}"
        attributes.add("gltf.mesh.joints-without-weights", text)
    joints, weights = list[int](), list[int]()
    allowed = 0.0
    for number in sorted(sets["JOINTS"] & sets["WEIGHTS"]):
        places = [_judged(attributes, f"{kind}_{number}") for kind in ("JOINTS", "WEIGHTS")]
        known = [place for place in places if place is not None]
        if len(known) < 2:
            return None
        component = attributes.accessor(f"WEIGHTS_{number}").get("componentType")
        allowed += 4 * (_STEPS.get(int(component or 0), 0.0) / 2 + OFF_EACH)
        joints.append(known[0])
        weights.append(known[1])
    if not joints or not _counts_fit(attributes, [*joints, *weights]):
        return None
    return Influences(joints, weights, attributes.view.accessors.layout(joints[0]).rows, allowed, attributes)


def _judged(attributes: Item, name: str) -> int | None:
    """The accessor of four numbers a point; None, with a finding, where they are something else."""
    index = attributes.judged(name)
    if index is None:
        return None
    layout = attributes.view.accessors.layout(index)
    raw = attributes.accessor(name)
    component, normalized = raw.get("componentType"), raw.get("normalized") is True
    if name.startswith("JOINTS"):
        right = component in _UNSIGNED and not normalized
    else:
        right = component == FLOAT or (component in _UNSIGNED and normalized)
    if layout.width != 4 or not right:
        kind = f"{raw.get('type')} of component type {component}{' normalized' if normalized else ''}"
        attributes.add("gltf.mesh.influence-type", f"{name} is {kind}", name)
    return index if layout.width == 4 and layout.rows else None


def _counts_fit(attributes: Item, accessors: list[int]) -> bool:
    own = {attributes.view.accessors.layout(index).rows for index in accessors}
    index, known = attributes.raw.get("POSITION"), attributes.view.lists["accessors"]
    count = known[index].get("count") if type(index) is int and 0 <= index < len(known) else None
    counts = own | ({count} if type(count) is int else set())
    if len(counts) > 1:
        text = f"positions, joints and weights are {and_more(map(str, sorted(counts)))}"
        attributes.add("gltf.mesh.influence-count", text)
    return len(own) == 1


def _check_weights(
    start: int,
    joints: Floats,
    weights: Floats,
    allowed: float,
    tallies: dict[str, Tally],
    sums: list[tuple[float, float, int]],
) -> None:
    """Some points from ``start`` on. sums: how far the farthest so far were off 1, their sums, and which."""
    numbers = np.isfinite(weights)
    finite = numbers.all(axis=1)
    known = np.where(numbers, weights, 0.0)
    total = known.sum(axis=1)
    zero = finite & (known == 0).all(axis=1)
    off = finite & ~zero & (np.abs(total - 1.0) > allowed)
    for rule, wrong, message in (
        ("gltf.mesh.weight-nan", ~finite, lambda k: f"vertex {start + k} has a weight that is not a number"),
        (
            "gltf.mesh.weight-negative",
            (known < 0).any(axis=1),
            lambda k: f"vertex {start + k} has {known[k].min():g}",
        ),
        ("gltf.mesh.weight-zero", zero, lambda k: f"all weights of vertex {start + k} are zero"),
        ("gltf.mesh.weight-sum", off, lambda k: ""),  # of the farthest, which is known in the end
        (
            "gltf.mesh.joint-repeated",
            _repeated(joints, weights),
            lambda k: f"vertex {start + k} names a joint twice",
        ),
    ):
        tallies.setdefault(rule, Tally()).add(np.asarray(wrong), message)
    if off.any():
        where = np.flatnonzero(off)
        far = np.abs(total[where] - 1.0)
        # The first of those that are as large as any comes after none that is larger.
        before = np.maximum.accumulate(np.concatenate([[sums[-1][0] if sums else -1.0], far[:-1]]))
        sums += [
            (float(far[k]), float(total[where[k]]), start + int(where[k]))
            for k in np.flatnonzero(far > before)
        ]


def _repeated(joints: Floats, weights: Floats) -> Booleans:
    """Points that name a joint twice with weight, (v,)."""
    # Those without weight get numbers of their own, which equal no other.
    width = joints.shape[1]
    ordered = np.sort(np.where(weights != 0, joints, -1.0 - np.arange(width)), axis=1)
    return np.asarray((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))


def _check_joints(
    start: int, joints: Floats, weights: Floats, count: int, title: str, tallies: dict[str, Tally]
) -> None:
    """Some points from ``start`` on, moved by a skin with so many joints."""
    outside, live = joints >= count, weights != 0
    for rule, wrong in (
        ("gltf.mesh.joint-out-of-range", outside & live),
        ("gltf.mesh.joint-out-of-range-unweighted", outside & ~live),
    ):
        tallies.setdefault(f"{rule} {title}", Tally()).add(
            np.asarray(wrong.any(axis=1)),
            lambda k: f"vertex {start + k} names joint {joints[k].max():g}, which {title} does not have",
        )


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
