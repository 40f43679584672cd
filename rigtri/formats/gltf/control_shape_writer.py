"""Control shapes as meshes of lines, with a material for their colour.

Source: glTF 2.0 §3.7.2.1 (mode 1 LINES, 2 LINE_LOOP), §3.9 (materials).
"""

from __future__ import annotations

from typing import Any

from rigtri.errors import FileError
from rigtri.formats.gltf.buffer_writer import Storage
from rigtri.formats.gltf.float32_rounding import to_singles
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.model.control_shapes import Shape
from rigtri.model.rig import Rig

LINES, LINE_LOOP = 1, 2


def write_shapes(draft: CopyOnWrite, storage: Storage, rig: Rig, index: list[int]) -> None:
    """Draw the shapes of ``rig`` at its nodes, whose file indices are ``index``.

    A shape of a node that has a mesh replaces what that mesh draws, in place.
    """
    for node, shape in sorted(rig.pending.shapes.items()):
        holder = draft.edit("nodes", index[node])
        primitive = _primitive(draft, storage, shape)
        mesh = holder.get("mesh")
        if isinstance(mesh, int):
            if _users(draft.gltf, mesh) > 1:
                raise FileError(
                    f"the mesh of '{rig.title(node)}' is drawn elsewhere too; give it one of its own"
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
        if material.get("name") == name and material.get("pbrMetallicRoughness") == look:
            return number
    materials.append({"name": name, "pbrMetallicRoughness": look})
    return len(materials) - 1


def _users(gltf: dict[str, Any], mesh: int) -> int:
    return sum(node.get("mesh") == mesh for node in gltf["nodes"])
