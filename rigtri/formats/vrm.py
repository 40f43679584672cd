"""What VRM, VRMA and node constraints bind to the axes of nodes.

Node numbers here are indices of the file. Vectors that an extension keeps in
the frame of a node turn with it, as frames keep their origin: offsets turn like
directions.

VRM 0 holds vectors as x, y, z with z towards the other side; a `Bound` has them as glTF does.

Source: VRM 0.0 README; VRMC_vrm 1.0 (humanoid, lookAt, tpose);
VRMC_springBone 1.0; VRMC_springBone_extended_collider 1.0;
VRMC_node_constraint 1.0; VRMC_vrm_animation 1.0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from rigtri.formats.gltf.values import Value
from rigtri.report import Notice

VRM_0 = "VRM 0.x forbids rest rotations"
EXTENDED = "VRMC_springBone_extended_collider"
CONSTRAINT = "VRMC_node_constraint"
Pointer = tuple[str | int, ...]
Kind = Literal["rotation", "roll", "aim", "tail"]

_AIM_AXES = {
    f"{word}{letter}": tuple(sign if k == axis else 0.0 for k in range(3))
    for axis, letter in enumerate("XYZ")
    for word, sign in (("Positive", 1.0), ("Negative", -1.0))
}
_ROLL_AXES = {letter: _AIM_AXES[f"Positive{letter}"] for letter in "XYZ"}
# What a node shows in itself, by the name of its property.
_SHOWN = ("mesh", "camera")
# Kind of constraint → the property of its axis, and what it may say.
_KINDS: tuple[Kind, ...] = ("roll", "aim", "rotation")
_AXES: dict[str, tuple[str, dict[str, tuple[float, ...]]]] = {
    "roll": ("rollAxis", _ROLL_AXES),
    "aim": ("aimAxis", _AIM_AXES),
    "rotation": ("", {}),
}


@dataclass(frozen=True)
class Follows:
    """A constraint in the file's own node numbers; see `rigtri.rig.Constraint`. pointer: where it stands."""

    kind: Kind
    node: int
    source: int
    axis: tuple[float, ...] = (0.0, 0.0, 0.0)
    pointer: Pointer | None = None


@dataclass
class Bindings:
    """humanoid: bone → node. fixed: node → reason. bound: node, vector and where it stands in the JSON.

    frozen: why joints may have no axes of their own, "" where they may; bones: the nodes, then,
    that have to be parallel to the world, or whose children have to. aside: nodes that hold
    data in place of a transform.
    """

    humanoid: dict[str, int] = field(default_factory=dict)
    fixed: dict[int, str] = field(default_factory=dict)
    bound: list[tuple[int, list[float], Pointer]] = field(default_factory=list)
    facing: tuple[float, float, float] = (0.0, 0.0, 1.0)
    frozen: str = ""
    bones: set[int] = field(default_factory=set)
    aside: set[int] = field(default_factory=set)
    constraints: list[Follows] = field(default_factory=list)
    notices: list[Notice] = field(default_factory=list)

    def fix(self, node: int, reason: str) -> None:
        """Freeze a node; the first reason stays. −1, the parent of a root, is nothing to freeze."""
        if node >= 0:
            self.fixed.setdefault(node, reason)


def read_bindings(gltf: Value, above: Sequence[int]) -> Bindings:
    """Everything the VRM family binds to nodes. above: the parent of each node. FileError if broken."""
    found, extensions = Bindings(), gltf.get("extensions")
    if extensions is not None:
        for name, read in (
            ("VRM", _vrm_0),
            ("VRMC_vrm", _vrm_1),
            ("VRMC_springBone", _spring_bones),
            ("VRMC_vrm_animation", _animation),
        ):
            extension = extensions.get(name)
            if extension is not None:
                read(extension, above, found)
    for node, item in enumerate(gltf.each("nodes")):
        if "extensions" in item.object():
            constraint = item.need("extensions").get(CONSTRAINT)
            if constraint is not None:
                _constrain(constraint, node, above, found)
    if found.frozen:
        _demand(gltf, above, found)
    _notice_circles(gltf, above, found)
    _notice_dangling(extensions.raw if extensions is not None else {}, len(above), found)
    return found


def _vrm_0(vrm: Value, above: Sequence[int], found: Bindings) -> None:
    found.facing, found.frozen = (0.0, 0.0, -1.0), VRM_0
    count = len(above)
    humanoid = vrm.get("humanoid")
    for bone in humanoid.each("humanBones") if humanoid else ():
        node = _bone(bone, "node", count)
        if node is not None:
            found.humanoid[bone.need("bone").text()] = node
    person = vrm.get("firstPerson")
    if person is not None:
        node = _bone(person, "firstPersonBone", count)
        node = found.humanoid.get("head") if node is None else node
        if node is not None:
            _bind_0(person, "firstPersonBoneOffset", node, ("extensions", "VRM", "firstPerson"), found)
    swinging = vrm.get("secondaryAnimation")
    if swinging is not None:
        _swinging_0(swinging, above, found)


def _bone(holder: Value, key: str, count: int) -> int | None:
    """A node of VRM 0, which says −1 where there is none."""
    return None if holder.object().get(key, -1) == -1 else holder.need(key).index(count, "node")


def _swinging_0(swinging: Value, above: Sequence[int], found: Bindings) -> None:
    for number, group in enumerate(swinging.each("colliderGroups")):
        node = _bone(group, "node", len(above))
        for place, collider in enumerate(group.each("colliders")):
            pointer: Pointer = ("extensions", "VRM", "secondaryAnimation", "colliderGroups", number)
            if node is not None:
                _bind_0(collider, "offset", node, (*pointer, "colliders", place), found)
    tops = {
        bone.index(len(above), "node")
        for group in swinging.each("boneGroups")
        for bone in group.each("bones")
        if bone.raw != -1
    }
    for node in range(len(above)):
        if not tops.isdisjoint(_line(node, above)):
            found.bones.add(node)
    parents = set(above)
    for node in sorted(found.bones - parents):
        # Viewers hang the end of a chain along its translation, which its parent sees.
        found.constraints.append(Follows("tail", node, above[node]))


def _bind_0(holder: Value, key: str, node: int, pointer: Pointer, found: Bindings) -> None:
    item = holder.get(key)
    if item is not None:
        raw = item.object()
        x, y, z = Value([raw.get(axis, 0.0) for axis in "xyz"], item.where).numbers(3)
        found.bound.append((node, [x, y, 0.0 - z], (*pointer, key)))


def _demand(gltf: Value, above: Sequence[int], found: Bindings) -> None:
    """VRM 0 wants zero rotations on every bone; so nothing above a bone may be turned either.

    What shows something and is no bone keeps its axes: it would have to hand over what it shows.
    """
    joints = {joint.index(len(above), "node") for skin in gltf.each("skins") for joint in skin.each("joints")}
    joints.update(found.humanoid.values())
    shown = {k for k, node in enumerate(gltf.each("nodes")) if not node.object().keys().isdisjoint(_SHOWN)}
    found.bones = joints | (found.bones - shown)
    found.constraints = [c for c in found.constraints if c.kind != "tail" or c.node in found.bones]
    for bone in list(found.bones):
        for node in _line(above[bone], above):
            if node in found.bones:
                break
            found.bones.add(node)


def _human_bones(extension: Value, count: int, found: Bindings) -> None:
    humanoid = extension.get("humanoid")
    bones = humanoid.get("humanBones") if humanoid else None
    for name, bone in bones.members() if bones else ():
        found.humanoid[name] = bone.need("node").index(count, "node")


def _vrm_1(vrm: Value, above: Sequence[int], found: Bindings) -> None:
    _human_bones(vrm, len(above), found)
    _look_at(vrm, "VRMC_vrm", found)


def _look_at(extension: Value, name: str, found: Bindings) -> None:
    look, head = extension.get("lookAt"), found.humanoid.get("head")
    if look is not None and head is not None:
        _bind(look, "offsetFromHeadBone", head, ("extensions", name, "lookAt"), found)


def _bind(
    holder: Value, key: str, node: int, pointer: Pointer, found: Bindings, default: tuple[float, ...] = ()
) -> None:
    item = holder.get(key)
    if item is not None:
        found.bound.append((node, item.numbers(3), (*pointer, key)))
    elif default:
        found.bound.append((node, list(default), (*pointer, key)))


def _spring_bones(springs: Value, above: Sequence[int], found: Bindings) -> None:
    for number, collider in enumerate(springs.each("colliders")):
        node = collider.need("node").index(len(above), "node")
        pointer: Pointer = ("extensions", "VRMC_springBone", "colliders", number)
        _shape(collider, node, pointer, found)
        extensions = collider.get("extensions")
        extended = extensions.get(EXTENDED) if extensions else None
        if extended is not None:
            _shape(extended, node, (*pointer, "extensions", EXTENDED), found)


def _shape(holder: Value, node: int, pointer: Pointer, found: Bindings) -> None:
    shape = holder.get("shape")
    for kind, keys in (("sphere", ["offset"]), ("capsule", ["offset", "tail"]), ("plane", ["offset"])):
        form = shape.get(kind) if shape else None
        if form is None:
            continue
        for key in keys:
            _bind(form, key, node, (*pointer, "shape", kind), found)
        if kind == "plane":
            # Unlike an offset, a normal that is not written is not zero.
            _bind(form, "normal", node, (*pointer, "shape", kind), found, (0.0, 0.0, 1.0))


def _animation(extension: Value, above: Sequence[int], found: Bindings) -> None:
    _human_bones(extension, len(above), found)
    _look_at(extension, "VRMC_vrm_animation", found)
    data: dict[int, str] = {}
    look, expressions = extension.get("lookAt"), extension.get("expressions")
    if look is not None and "node" in look.object():
        data[look.need("node").index(len(above), "node")] = "its rotation is where the character looks (VRMA)"
    for kind in ("preset", "custom"):
        group = expressions.get(kind) if expressions else None
        for name, item in group.members() if group else ():
            node = item.need("node").index(len(above), "node")
            data[node] = f"its translation is the weight of the expression '{name}' (VRMA)"
    found.aside.update(data)
    for node, reason in data.items():
        found.fix(node, reason)
    for node in data:
        found.fix(above[node], "a node below it holds VRMA data in its own axes")


def _constrain(extension: Value, node: int, above: Sequence[int], found: Bindings) -> None:
    """The constraints of a node; it should have one, and viewers take the first they know."""
    constraint = extension.need("constraint")
    for kind in _KINDS:
        item = constraint.get(kind)
        if item is None:
            continue
        source, (key, words) = item.need("source").index(len(above), "node"), _AXES[kind]
        axis: tuple[float, ...] = (0.0, 0.0, 0.0)
        if key:
            # Where it is not written viewers take the first.
            word = item.object().get(key, next(iter(words)))
            if not isinstance(word, str) or word not in words:
                item.need(key).fail(f"one of {', '.join(words)} should stand here, not {word!r}")
            axis = words[word]
        pointer: Pointer = ("nodes", node, "extensions", CONSTRAINT, "constraint", kind)
        found.constraints.append(Follows(kind, node, source, axis, pointer))


def _notice_circles(gltf: Value, above: Sequence[int], found: Bindings) -> None:
    """Say which constraints wait for each other: viewers refuse or ignore them."""
    driven = {c.node for c in found.constraints if c.kind != "tail"}
    waits = {
        c.node: [k for k in _line(c.source, above) if k in driven]
        for c in found.constraints
        if c.kind != "tail"
    }
    settled: set[int] = set()
    while free := [k for k, others in waits.items() if k not in settled and settled.issuperset(others)]:
        settled.update(free)
    circle = sorted(driven - settled)
    if circle:
        names = ", ".join(f"#{node}" for node in circle[:6])
        text = f"The constraints of nodes {names} wait for each other, so viewers do not evaluate them"
        found.notices.append(Notice("constraint-circle", text))


def _notice_dangling(extensions: Any, count: int, found: Bindings) -> None:
    """Say which expressions and annotations refer to nothing."""
    for path in mesh_references(extensions if isinstance(extensions, dict) else {}):
        node: Any = extensions
        for key in path:
            node = node[key]
        if type(node) not in (int, float) or not 0 <= node < count or node != int(node):
            place = ".".join(map(str, path))
            text = f"extensions.{place} is {node!r}, which is no node of this file"
            found.notices.append(Notice("vrm-reference", text))


def _line(node: int, above: Sequence[int]) -> Iterator[int]:
    """A node and all above it."""
    while node >= 0:
        yield node
        node = above[node]


def stored_vector(pointer: Pointer, vector: Sequence[float], before: object) -> object:
    """A vector of a `Bound` as its place in the JSON holds it; before: what stands there, if anything."""
    numbers = [float(x) for x in vector]
    if pointer[1] != "VRM":
        return numbers
    x, y, z = numbers
    return {**(before if isinstance(before, dict) else {}), "x": x, "y": y, "z": 0.0 - z}


def stored_axis(kind: str, axis: Sequence[float]) -> tuple[str, str]:
    """The property of a constraint's axis and the word for it; of a roll axis the sign does not matter."""
    key, words = _AXES[kind]
    numbers = tuple(abs(x) if kind == "roll" else x for x in axis)
    return key, next(word for word, known in words.items() if known == numbers)


def mesh_references(extensions: Mapping[str, Any]) -> Iterator[Pointer]:
    """Where VRM 1.0 refers to the node that shows a mesh: expressions and first-person annotations."""
    vrm = extensions.get("VRMC_vrm")
    vrm = vrm if isinstance(vrm, dict) else {}
    expressions, person = vrm.get("expressions"), vrm.get("firstPerson")
    for kind in ("preset", "custom"):
        group = expressions.get(kind) if isinstance(expressions, dict) else None
        for name, item in group.items() if isinstance(group, dict) else ():
            path: Pointer = ("VRMC_vrm", "expressions", kind, name, "morphTargetBinds")
            yield from _entries(item, path)
    yield from _entries(person, ("VRMC_vrm", "firstPerson", "meshAnnotations"))


def _entries(holder: Any, path: Pointer) -> Iterator[Pointer]:
    entries = holder.get(path[-1]) if isinstance(holder, dict) else None
    for number, entry in enumerate(entries if isinstance(entries, list) else ()):
        if isinstance(entry, dict) and "node" in entry:
            yield (*path, number, "node")
