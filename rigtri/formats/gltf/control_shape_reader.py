"""The lines that a node of a glTF file shows, as `control_shape_writer` has drawn them.

Source: glTF 2.0 §3.7.2.1 (mode 1 LINES, 2 LINE_LOOP), §3.9 (materials).
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.json_values import Value
from rigtri.model.control_shapes import Lines

LINES, LINE_LOOP = 1, 2


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
