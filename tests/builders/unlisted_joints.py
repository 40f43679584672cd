"""glTF whose skins list fewer joints: a bone that moves no point, as exporters leave them out."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from gltf_files import glb_bytes, glb_parts


def joints_below_joints(gltf: dict[str, Any]) -> list[tuple[int, int]]:
    """Each joint whose parent is one, and that."""
    joints = {joint for skin in gltf["skins"] for joint in skin["joints"]}
    above = {child: k for k, node in enumerate(gltf["nodes"]) for child in node.get("children", ())}
    return [(joint, above[joint]) for joint in sorted(joints) if above.get(joint) in joints]


def unlisted(source: Path, left_out: Collection[int], out: Path) -> Path:
    """The file without some joints in its only skin; their points go with the joint above, or the first."""
    gltf, binary = glb_parts(source)
    content, (skin,) = bytearray(binary), gltf["skins"]
    above = {child: k for k, node in enumerate(gltf["nodes"]) for child in node.get("children", ())}
    old = skin["joints"]
    new = [joint for joint in old if joint not in left_out]
    owners = []
    for joint in old:
        while joint in left_out:
            joint = above[joint]
        owners.append(new.index(joint) if joint in new else 0)
    bound = _rows(gltf, content, skin["inverseBindMatrices"], "<f4")
    bound[: len(new)] = bound[[old.index(joint) for joint in new]].copy()
    gltf["accessors"][skin["inverseBindMatrices"]]["count"] = len(new)
    skin["joints"] = new
    for number in {
        p["attributes"]["JOINTS_0"]
        for mesh in gltf["meshes"]
        for p in mesh["primitives"]
        if "JOINTS_0" in p["attributes"]
    }:
        rows = _rows(
            gltf, content, number, {5121: "u1", 5123: "<u2"}[gltf["accessors"][number]["componentType"]]
        )
        rows[:] = np.array(owners)[rows]
    out.write_bytes(glb_bytes(gltf, bytes(content)))
    return out


def _rows(gltf: dict[str, Any], content: bytearray, number: int, kind: str) -> np.ndarray:
    """The rows of an accessor with a view of its own, to be written to."""
    accessor = gltf["accessors"][number]
    view, width = gltf["bufferViews"][accessor["bufferView"]], {"VEC4": 4, "MAT4": 16}[accessor["type"]]
    step = view.get("byteStride", width * np.dtype(kind).itemsize)
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return np.ndarray((accessor["count"], width), kind, content, start, (step, np.dtype(kind).itemsize))
