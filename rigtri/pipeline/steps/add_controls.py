"""The step add-controls"""

from __future__ import annotations

from typing import Any

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_polevector import AddPolevectorOptions
from rigtri.operations.declaration.kinds import vector
from rigtri.operations.joint_selection import Selection
from rigtri.pipeline.steps.request import Request, Step
from rigtri.recognition.limbs import given
from rigtri.report import Report

_SIDES = {"left": "left", "right": "right", "centre": ""}


def step(request: Request) -> Step:
    """Raises UsageError for shapes of no kind of control, and colours that are none."""
    shapes = dict(pair for text in request["shapes"] for pair in _shapes(text))
    colors = dict(_color(text) for text in request["colors"])

    def applied(rig: Rig, report: Report) -> Rig:
        options = AddControlsOptions(
            selection=Selection(
                joints=request["joints"],
                chains=request["chains"],
                below=request["below"],
                skin=request["skin"],
                exclude=request["exclude"],
            ),
            whole_character=request["whole_character"],
            root_control=request["root_control"],
            ik=tuple(given(rig, *names) for names in request["ik"]),
            ik_auto=request["auto"] == "auto",
            size=request["size"],
            name=request["name"],
            shapes=shapes,
            colors=colors,
            root=request["root"],
            ends=request["kind"],
            soft=request["soft"],
            stretch=request["stretch"],
            poles=AddPolevectorOptions(reach=request["reach"], facing=request["facing"]),
        )
        return add_controls(rig, options=options, report=report)

    return applied


def _shapes(text: str) -> list[tuple[str, Any]]:
    """One kind of control and its shape, or the shape of FK and IK controls."""
    kind, mark, shape = text.rpartition("=")
    if mark and kind not in ("fk", "ik", "root", "pole"):
        raise UsageError(f"--shape {text}: the kinds of control are fk, ik, root and pole")
    return [(kind, shape)] if mark else [("fk", shape), ("ik", shape)]


def _color(text: str) -> tuple[str, tuple[float, float, float]]:
    which, _, numbers = text.partition("=")
    if which not in _SIDES:
        raise UsageError(f"--color {text}: give left=R,G,B, right=R,G,B or centre=R,G,B")
    try:
        r, g, b = (float(part) for part in vector(numbers))
    except ValueError as error:
        raise UsageError(f"--color {text}: {error}") from error
    if not all(0 <= part <= 1 for part in (r, g, b)):
        raise UsageError(f"--color {text}: red, green and blue lie between 0 and 1")
    return _SIDES[which], (r, g, b)
