"""Curves of controls: drawn when new, redrawn on request, left alone where a user has edited them.

What was drawn is in the note: shape, size and colour. Lines of the file that are no longer those are
a user's.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from rigtri.maths.trigonometry import Floats
from rigtri.model.control_shapes import Kind, drawn
from rigtri.model.rig import Rig
from rigtri.operations.rigtri_nodes import noted
from rigtri.report import Report

# Sizes that differ by less, as a share, are one: what float32 leaves of a bone's length.
_SAME_SIZE = 1e-5
KEYS = ("shape", "size", "color")


@dataclass(frozen=True, eq=False)
class Drawing:
    """Lines at a node: a shape, its radius in units of the node, how it lies and its linear RGB colour."""

    shape: Kind
    size: float
    color: tuple[float, float, float]
    normal: Floats
    ahead: Floats | None = None


def draw(rig: Rig, node: int, drawing: Drawing) -> Rig:
    """Draw at a node, and note what."""
    color = (float(drawing.color[0]), float(drawing.color[1]), float(drawing.color[2]))
    size = float(drawing.size)
    lines = drawn(drawing.shape, size=size, normal=drawing.normal, color=color, ahead=drawing.ahead)
    note = {**rig.metadata[node], "shape": drawing.shape, "size": size, "color": list(color)}
    pending = replace(rig.pending, shapes={**rig.pending.shapes, node: lines})
    return replace(noted(rig, node, note), pending=pending)


def draw_anew(rig: Rig, node: int, drawing: Drawing, requested: frozenset[str], report: Report) -> Rig:
    """Draw at a known node what is ``requested``, of KEYS; the rest stays, and what a user has edited."""
    note = rig.metadata[node]
    if not requested:
        return rig
    if node not in rig.pending.shapes and not _is_ours(rig, node, note):
        report.warn(
            "shape-kept",
            f"the lines of '{rig.title(node)}' are not those that rigtri has drawn; they stay as they are",
        )
        return rig
    target = replace(
        drawing,
        shape=drawing.shape if "shape" in requested else note["shape"],
        size=drawing.size if "size" in requested else note["size"],
        color=drawing.color if "color" in requested else tuple(note["color"]),
    )
    same = abs(target.size - note["size"]) <= _SAME_SIZE * note["size"]
    if same and target.shape == note["shape"] and list(target.color) == list(note["color"]):
        return rig
    return draw(rig, node, target)


def _is_ours(rig: Rig, node: int, note: Mapping[str, Any]) -> bool:
    """Whether the file shows what the note says."""
    lines = rig.content.read_lines(rig.keys[node])
    if lines is None or any(key not in note for key in KEYS):
        return False
    return lines.are(str(note["shape"]), float(note["size"]), note["color"])
