"""Curves of controls: drawn when new, redrawn on request, left alone where a user has edited them.

What was drawn is in the record: shape, size and colour. Lines of the file that are no longer those are
a user's.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar, cast

from rigtri.maths.trigonometry import Floats
from rigtri.model.control_shapes import COLORS, Kind, Shape, drawn
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side
from rigtri.model.metadata import PIVOTS, ControlRecord, PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.operations.options.add_controls import AddControlsOptions
from rigtri.operations.rigtri_nodes import with_record
from rigtri.report import Report

D = TypeVar("D", bound=ControlRecord | PoleVectorRecord)

# Sizes that differ by less, as a share, are one: what float32 leaves of a bone's length.
_SAME_SIZE = 1e-5
# Shapes by the kind of control; of all others circles.
_SHAPES: dict[str, Kind] = {"ik": "cube", "root": "arrow", "pole": "diamond"}


@dataclass(frozen=True, eq=False)
class Drawing:
    """Lines at a node: a shape, its radius in units of the node, how it lies and its linear RGB colour.

    shift: how far along its normal it stands beside the node, in units of that.
    """

    shape: Kind
    size: float
    color: tuple[float, float, float]
    normal: Floats
    ahead: Floats | None = None
    shift: float = 0.0


def requested_drawing(
    options: AddControlsOptions,
    which: Side,
    kind: str,
    size: float,
    normal: Floats,
    front: Floats | None,
    shift: float = 0.0,
) -> Drawing:
    """How a control of a kind on a side is drawn, as the options have it."""
    shape = cast("Kind", options.shape.get(_as_shaped(kind), _SHAPES.get(kind, "circle")))
    size *= 1.0 if options.size is None else options.size
    return Drawing(shape, size, options.color.get(which, COLORS[which]), normal, front, shift)


def requested_members(options: AddControlsOptions, which: Side, kind: str) -> frozenset[str]:
    """What of a drawing the options name."""
    requested = {
        "shape": _as_shaped(kind) in options.shape,
        "size": options.size is not None,
        "color": which in options.color,
    }
    return frozenset(key for key, given in requested.items() if given)


def _as_shaped(kind: str) -> str:
    """What ``--shape`` calls a kind of control."""
    return "roll" if kind in PIVOTS else kind


def draw(rig: Rig, node: int, drawing: Drawing) -> Rig:
    """Draw at a control or pole vector, and store what."""
    record, lines = lines_of(_record(rig, node), drawing)
    pending = replace(rig.pending, shapes={**rig.pending.shapes, node: lines})
    return replace(with_record(rig, node, record), pending=pending)


def lines_of(record: D, drawing: Drawing) -> tuple[D, Shape]:
    """The lines of a drawing, and the record with what they are."""
    color = (float(drawing.color[0]), float(drawing.color[1]), float(drawing.color[2]))
    size = float(drawing.size)
    shift = float(drawing.shift)
    lines = drawn(
        drawing.shape, size=size, normal=drawing.normal, color=color, ahead=drawing.ahead, shift=shift
    )
    record = replace(record, shape=drawing.shape, size=size, color=color)
    if isinstance(record, ControlRecord):
        record = cast("D", replace(record, shift=shift or None))
    return record, lines


def _record(rig: Rig, node: int) -> ControlRecord | PoleVectorRecord:
    record = rig.record(node)
    assert isinstance(record, ControlRecord | PoleVectorRecord)  # nothing else is drawn
    return record


def draw_anew(
    rig: Rig,
    node: int,
    drawing: Drawing,
    requested: frozenset[str],
    report: Report,
    *,
    turned: bool = False,
) -> Rig:
    """Draw at a known node what is ``requested`` of shape, size and color, or all where it has ``turned``.

    The rest stays, and what a user has edited.
    """
    if not (requested or turned):
        return rig
    now = _drawn(rig, node, drawing)
    if now is None or not (node in rig.pending.shapes or _is_shown(rig, node, now)):
        report.warn(
            "shape-kept",
            f"the lines of '{rig.title(node)}' are not those that rigtri has drawn; they stay as they are",
        )
        return rig
    target = replace(
        drawing,
        shape=drawing.shape if "shape" in requested else now.shape,
        size=drawing.size if "size" in requested else now.size,
        shift=drawing.shift if "size" in requested else now.shift,
        color=drawing.color if "color" in requested else now.color,
    )
    off = max(abs(target.size - now.size), abs(target.shift - now.shift))
    same = off <= _SAME_SIZE * now.size
    if same and not turned and (target.shape, target.color) == (now.shape, now.color):
        return rig
    return draw(rig, node, target)


def _is_shown(rig: Rig, node: int, drawing: Drawing) -> bool:
    lines = rig.content.read_lines(rig.keys[node])
    return lines is not None and lines.are(drawing.shape, drawing.size, drawing.color, drawing.shift)


def _drawn(rig: Rig, node: int, like: Drawing) -> Drawing | None:
    """What a node's record says that is drawn there, lying as ``like``; None where it says nothing."""
    record = _record(rig, node)
    if not record.shape or record.size is None or record.color is None:
        return None
    shift = (record.shift or 0.0) if isinstance(record, ControlRecord) else 0.0
    return replace(like, shape=cast("Kind", record.shape), size=record.size, color=record.color, shift=shift)
