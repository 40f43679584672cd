"""What VRM, VRMA and node constraints bind to the axes of nodes.

Node numbers here are indices of the file. Vectors that an extension keeps in
the frame of a node turn with it, as frames keep their origin: offsets turn like
directions.

Source: VRMC_vrm 1.0 (humanoid, lookAt, tpose);
VRMC_springBone 1.0; VRMC_springBone_extended_collider 1.0;
VRMC_node_constraint 1.0; VRMC_vrm_animation 1.0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.json_values import Value, index_of, object_in, short_repr
from rigtri.formats.vrm.bindings import (
    CONSTRAINT,
    Bindings,
    Pointer,
    read_constraint,
    report_cycles,
    report_shared_bones,
)
from rigtri.formats.vrm.vrm0 import demand, read_vrm_0
from rigtri.report import Notice

EXTENDED = "VRMC_springBone_extended_collider"
SPLIT = "in VRM 1.0 every node has a uniform positive scale, which a split joint would not have"


def read_bindings(gltf: Value, above: Sequence[int]) -> Bindings:
    """Everything the VRM family binds to nodes. above: the parent of each node. FileError if broken."""
    found, extensions = Bindings(), gltf.get("extensions")
    if extensions is not None:
        for name, read in (
            ("VRM", read_vrm_0),
            ("VRMC_vrm", _vrm_1),
            ("VRMC_springBone", _spring_bones),
            ("VRMC_vrm_animation", _animation),
        ):
            extension = extensions.get(name)
            if extension is not None:
                read(extension, above, found)
    for node, held in enumerate(gltf.object().get("nodes", [])):
        if "extensions" in held:
            constraint = Value(held, f"{gltf.where} nodes[{node}]").need("extensions").get(CONSTRAINT)
            if constraint is not None:
                read_constraint(constraint, node, above, found)
    if found.orient_locked:
        demand(gltf, above, found)
    report_cycles(above, found)
    report_shared_bones(found)
    _notice_dangling(gltf, found)
    return found


def _human_bones(extension: Value, count: int, found: Bindings) -> None:
    humanoid = extension.get("humanoid")
    bones = humanoid.get("humanBones") if humanoid else None
    for name, bone in bones.members() if bones else ():
        found.humanoid[name] = bone.need("node").index(count, "node")


def _vrm_1(vrm: Value, above: Sequence[int], found: Bindings) -> None:
    found.split_locked = SPLIT
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
    listed = springs.raw.get("springs")
    for number in range(len(listed) if isinstance(listed, list) else 0):
        with suppress(FileError):  # a broken spring swings nothing; `check` has findings of it
            spring = Value(listed[number], f"{springs.where}.springs[{number}]")
            joints = [joint.need("node").index(len(above), "node") for joint in spring.each("joints")]
            found.swinging.update(joints[:-1])  # the last one is only the end of the bone that swings


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
    found.data_nodes.update(data)
    for node, reason in data.items():
        found.fix(node, reason)
    for node in data:
        found.fix(above[node], "a node below it holds VRMA data in its own axes")


def _notice_dangling(gltf: Value, found: Bindings) -> None:
    """Say which expressions and annotations refer to nothing: nodes in VRM 1.0, meshes in VRM 0.x."""
    held = gltf.object()
    extensions = held.get("extensions") or {}
    for paths, kind, section in ((mesh_references, "node", "nodes"), (mesh_references_0, "mesh", "meshes")):
        for path in paths(extensions):
            stands: Any = extensions
            for key in path:
                stands = stands[key]
            if index_of(stands, len(held.get(section, []))) is None:
                place = ".".join(map(str, path))
                text = f"extensions.{place} is {short_repr(stands)}, which is not a {kind} of this file"
                found.notices.append(Notice("vrm-reference", text))


def mesh_references(extensions: Mapping[str, Any]) -> Iterator[Pointer]:
    """Where VRM 1.0 refers to the node that shows a mesh: expressions and first-person annotations."""
    vrm = object_in(extensions, "VRMC_vrm")
    for kind in ("preset", "custom"):
        for name, item in object_in(object_in(vrm, "expressions"), kind).items():
            path: Pointer = ("VRMC_vrm", "expressions", kind, name, "morphTargetBinds")
            yield from _entries(item, path, "node")
    yield from _entries(vrm.get("firstPerson"), ("VRMC_vrm", "firstPerson", "meshAnnotations"), "node")


def mesh_references_0(extensions: Mapping[str, Any]) -> Iterator[Pointer]:
    """Where VRM 0.x refers to meshes: expressions and first-person annotations."""
    vrm = object_in(extensions, "VRM")
    groups = object_in(vrm, "blendShapeMaster").get("blendShapeGroups")
    for number, group in enumerate(groups if isinstance(groups, list) else ()):
        path: Pointer = ("VRM", "blendShapeMaster", "blendShapeGroups", number, "binds")
        yield from _entries(group, path, "mesh")
    yield from _entries(vrm.get("firstPerson"), ("VRM", "firstPerson", "meshAnnotations"), "mesh")


def _entries(holder: Any, path: Pointer, key: str) -> Iterator[Pointer]:
    entries = holder.get(path[-1]) if isinstance(holder, dict) else None
    for number, entry in enumerate(entries if isinstance(entries, list) else ()):
        if isinstance(entry, dict) and key in entry:
            yield (*path, number, key)
