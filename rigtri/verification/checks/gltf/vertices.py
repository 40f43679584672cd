"""Numbers of vertices that are none: NaN and Inf, which engines show as holes or not at all.

Source: glTF 2.0 §3.6.2.2 (NaN and infinities must not be present), §3.7.2 (attributes, morph targets).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from rigtri.formats.gltf.accessors import FLOAT
from rigtri.formats.gltf.mesh_reader import DRACO
from rigtri.verification.checks.gltf import meshes
from rigtri.verification.checks.gltf.tolerant_reader import FOREIGN, View


def check(view: View) -> None:
    """The float attributes and morph targets of all primitives."""
    known: dict[int, tuple[int, int, int]] = {}
    for number, mesh in enumerate(view.lists["meshes"]):
        title = meshes.title(view, number)
        for k, raw in enumerate(view.objects(mesh, "primitives", title, f"/meshes/{number}")):
            for index, name, where in _attributes(view, raw, title, f"/meshes/{number}/primitives/{k}"):
                if index not in known:
                    known[index] = _gaps(view, index)
                first, gone, count = known[index]
                if gone:
                    place = f"{title}, primitive {k}, {name}"
                    text = f"vertex {first} is not a finite number ({gone} of {count} vertices)"
                    view.add("gltf.mesh.vertex-nan", place, where, text)


def _attributes(view: View, raw: dict[str, Any], place: str, pointer: str) -> Iterator[tuple[int, str, str]]:
    """Accessor, name and JSON pointer of all attributes of a primitive's vertices that are floats."""
    own = view.object(raw, "attributes", place, pointer)
    parts = [("", own, f"{pointer}/attributes")]
    if DRACO in view.object(raw, "extensions", place, pointer):
        parts = []  # `meshes` reports that they were not looked at
    for number, target in enumerate(view.objects(raw, "targets", place, pointer)):
        parts.append((f"morph target {number} ", target, f"{pointer}/targets/{number}"))
    for title, attributes, where in parts:
        for name, index in attributes.items():
            # Weights with joints are judged together, point by point.
            if name.startswith("WEIGHTS_") and name.replace("WEIGHTS", "JOINTS") in own:
                continue
            if type(index) is not int or not 0 <= index < len(view.accessors):
                continue  # `references` reports it
            accessor = view.raw_accessor(index)
            if accessor.get("componentType") == FLOAT and accessor.get("type") not in FOREIGN:
                yield index, f"{title}{name}", f"{where}/{name}"


def _gaps(view: View, index: int) -> tuple[int, int, int]:
    """The first row of an accessor that is not finite, how many are not, and how many there are."""
    first, gone, count = -1, 0, 0
    for block in view.blocks(index):
        wrong = np.flatnonzero(~np.isfinite(block).all(axis=1))
        if len(wrong) and first < 0:
            first = count + int(wrong[0])
        gone, count = gone + len(wrong), count + len(block)
    return first, gone, count
