"""What rigtri stores in a file as one document, for engines and exporters that drop extras."""

from __future__ import annotations

from typing import Any

from rigtri.model.rig import Rig

VERSION = 1
SUFFIX = ".rig.json"


def description(rig: Rig) -> dict[str, Any]:
    """Every node with metadata of ours, parents first: its name, its parent's, rest pose and metadata.

    ``schemas/rig.schema.json`` describes it. Translations are in file units, rotations xyzw, all
    seen from the parent; a node whose rest pose is a matrix has 16 numbers, row by row, of a
    row-vector matrix.
    """
    return {
        "rigtri": "rig",
        "v": VERSION,
        "nodes": [_node(rig, node) for node in range(len(rig)) if "type" in rig.metadata.get(node, {})],
    }


def _node(rig: Rig, node: int) -> dict[str, Any]:
    parent = int(rig.parents[node])
    entry: dict[str, Any] = {
        "node": rig.address(node),
        "path": rig.path(node),
        "parent": rig.address(parent) if parent >= 0 else None,
        "joint": bool(rig.is_joint[node]),
    }
    if rig.has_matrix[node]:
        entry["matrix"] = rig.matrix[node].reshape(16).tolist()
    else:
        for name in ("translation", "rotation", "scale"):
            entry[name] = getattr(rig, name)[node].tolist()
    return {**entry, "note": dict(rig.metadata[node])}
