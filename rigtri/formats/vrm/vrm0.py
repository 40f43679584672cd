"""VRM 0.x: its bones, which must have no rotations, and the vectors it holds in their frames.

Those are x, y, z with z towards the other side; a `Bound` has them as glTF does.

Source: VRM 0.0 README; the ends of chains: docs/decisions.md.
"""

from __future__ import annotations

from collections.abc import Sequence

from rigtri.formats.json_values import Value
from rigtri.formats.vrm.bindings import Bindings, Follows, Pointer, line

VRM_0 = "VRM 0.x forbids rest rotations"
# What a node shows in itself, by the name of its property.
_SHOWN = ("mesh", "camera")


def read_vrm_0(vrm: Value, above: Sequence[int], found: Bindings) -> None:
    found.facing, found.orient_locked = (0.0, 0.0, -1.0), VRM_0
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
    """A node of VRM 0, which has −1 where there is none."""
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
    swung = _below(tops, above)
    found.bones.update(swung)
    found.swinging.update(swung)
    for node in sorted(found.bones.difference(above)):
        # Viewers hang the end of a chain along its translation, which its parent sees.
        if above[node] >= 0:
            found.constraints.append(Follows("tail", node, above[node]))


def _below(tops: set[int], above: Sequence[int]) -> set[int]:
    """The nodes ``tops`` and all below them."""
    below: list[list[int]] = [[] for _ in above]
    for node, parent in enumerate(above):
        if parent >= 0:
            below[parent].append(node)
    inside, waiting = set(tops), list(tops)
    while waiting:
        fresh = [node for node in below[waiting.pop()] if node not in inside]
        inside.update(fresh)
        waiting += fresh
    return inside


def _bind_0(holder: Value, key: str, node: int, pointer: Pointer, found: Bindings) -> None:
    item = holder.get(key)
    if item is not None:
        raw = item.object()
        x, y, z = Value([raw.get(axis, 0.0) for axis in "xyz"], item.where).numbers(3)
        found.bound.append((node, [x, y, 0.0 - z], (*pointer, key)))


def demand(gltf: Value, above: Sequence[int], found: Bindings) -> None:
    """VRM 0 wants zero rotations on every bone; so nothing above a bone may be turned either.

    What shows something and is no bone keeps its axes: it would have to hand over what it shows.
    """
    joints = {joint.index(len(above), "node") for skin in gltf.each("skins") for joint in skin.each("joints")}
    joints.update(found.humanoid.values())
    shown = {k for k, node in enumerate(gltf.each("nodes")) if not node.object().keys().isdisjoint(_SHOWN)}
    found.bones = joints | (found.bones - shown)
    found.constraints = [c for c in found.constraints if c.kind != "tail" or c.node in found.bones]
    for bone in list(found.bones):
        for node in line(above[bone], above):
            if node in found.bones:
                break
            found.bones.add(node)


def stored_vector(pointer: Pointer, vector: Sequence[float], before: object) -> object:
    """A vector of a `Bound` as its place in the JSON holds it; before: what stands there, if anything."""
    numbers = [float(x) for x in vector]
    if pointer[1] != "VRM":
        return numbers
    x, y, z = numbers
    return {**(before if isinstance(before, dict) else {}), "x": x, "y": y, "z": 0.0 - z}
