"""Control shapes as meshes of lines, with a material for their colour.

Source: glTF 2.0 §3.7.2.1 (mode 1 LINES, 2 LINE_LOOP), §3.9 (materials).
"""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.buffer_writer import Storage
from rigtri.formats.gltf.float32_rounding import to_singles
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.json_values import Value
from rigtri.model.control_shapes import Lines, Shape
from rigtri.model.rig import Rig

LINES, LINE_LOOP = 1, 2
_LOOK = "pbrMetallicRoughness"


def read_lines(gltf: Value, accessors: Accessors, node: Hashable) -> Lines | None:
    """The lines of a node; None where it shows anything else, or nothing that can be read."""
    try:
        return _read(gltf, accessors, node)
    except (FileError, IndexError):
        return None


def _read(gltf: Value, accessors: Accessors, node: Hashable) -> Lines | None:
    if not isinstance(node, int):
        return None
    mesh = gltf.need("nodes").entries()[node].get("mesh")
    if not isinstance(mesh, int):
        return None
    primitives = list(list(gltf.need("meshes").items())[mesh].each("primitives"))
    if len(primitives) != 1 or not {*primitives[0].object()} <= {"attributes", "material", "mode"}:
        return None
    mode, attributes = primitives[0].natural("mode", 4), primitives[0].need("attributes")
    if mode not in (LINES, LINE_LOOP) or {*attributes.object()} != {"POSITION"}:
        return None
    points = accessors.read(attributes.need("POSITION").index(len(accessors), "accessor"))
    if points.shape[1] != 3 or (mode == LINES and len(points) % 2):
        return None
    color = _color(gltf, primitives[0])
    if color is None:
        return None
    if mode == LINES:
        return Lines(points.reshape(-1, 2, 3), color)
    return Lines(np.stack([points, np.roll(points, -1, axis=0)], axis=1), color)


def _color(gltf: Value, primitive: Value) -> tuple[float, ...] | None:
    """The colour of a material that states nothing but that."""
    materials = list(gltf.each("materials"))
    material = materials[primitive.need("material").index(len(materials), "material")]
    look = material.need("pbrMetallicRoughness")
    factor = look.need("baseColorFactor").numbers(4)
    plain = {*material.object()} <= {"name", "pbrMetallicRoughness"} and factor[3] == 1.0
    return tuple(factor[:3]) if plain else None


def write_shapes(draft: CopyOnWrite, storage: Storage, rig: Rig, index: list[int]) -> None:
    """Draw the shapes of ``rig`` at its nodes, whose file indices are ``index``.

    A shape of a node that has a mesh replaces what that mesh draws, in place.
    """
    for node, shape in sorted(rig.pending.shapes.items()):
        holder = draft.edit("nodes", index[node])
        primitive = _primitive(draft, storage, shape)
        mesh = holder.get("mesh")
        if isinstance(mesh, int):
            if sum(node.get("mesh") == mesh for node in draft.gltf["nodes"]) > 1:
                raise FileError(
                    f"the mesh of '{rig.title(node)}' is also drawn by another node; give it its own mesh"
                )
            draft.edit("meshes", mesh)["primitives"] = [primitive]
            continue
        meshes = draft.need("meshes", empty=[])
        meshes.append({"name": f"rigtri_{rig.names[node]}", "primitives": [primitive]})
        holder["mesh"] = len(meshes) - 1


def _primitive(draft: CopyOnWrite, storage: Storage, shape: Shape) -> dict[str, Any]:
    looped = shape.closed and len(shape.strips) == 1
    points = shape.strips[0] if looped else shape.segments.reshape(-1, 3)
    place = storage.add(to_singles(points), "VEC3", "shapes", bounds=True)
    return {
        "attributes": {"POSITION": place},
        "material": _material(draft, shape.color),
        "mode": LINE_LOOP if looped else LINES,
    }


def _material(draft: CopyOnWrite, color: tuple[float, float, float]) -> int:
    """The material of a colour: one of ours that has it, else a new one."""
    look = {"baseColorFactor": [*map(float, color), 1.0], "metallicFactor": 0.0}
    name = "rigtri_" + "".join(f"{round(255 * part):02x}" for part in color)
    materials = draft.need("materials", empty=[])
    for number, material in enumerate(materials):
        if isinstance(material, dict) and (material.get("name"), material.get(_LOOK)) == (name, look):
            return number
    materials.append({"name": name, _LOOK: look})
    return len(materials) - 1
