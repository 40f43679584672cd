"""Steps that build what moves joints: controls, pole vectors, constraints, rivets, pose readers."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from rigtri.pipeline.rigspec.models.base import StepModel, option
from rigtri.pipeline.rigspec.models.values import (
    Above,
    Assignments,
    Direction,
    Driven,
    Node,
    Number,
    Tolerance,
    Triples,
)


def _targets(value: Any) -> Any:
    """Targets by name as texts NAME=WHAT; of lists of three numbers X,Y,Z."""
    if isinstance(value, dict):
        return [f"{name}={_said(what)}" for name, what in value.items()]
    if isinstance(value, list):
        return [_said(what) for what in value]
    return [value] if isinstance(value, str) else value


def _said(what: Any) -> Any:
    numbers = isinstance(what, list) and all(isinstance(part, int | float) for part in what)
    return ",".join(str(part) for part in what) if numbers else what


class AddPosereader(StepModel):
    """Let morph targets or values follow a joint's pose, baked to keys of every clip."""

    do: Literal["add-posereader"]
    driver: Node
    axis: Direction = (1.0, 0.0, 0.0)
    frame: str = ""
    targets: Annotated[Assignments, BeforeValidator(_targets)] = option("target", ())
    reader: Literal["dot", "cone", "rbf"] = "dot"
    inner: Number = 0.0
    outer: Number = 90.0
    kernel: Literal["linear", "gaussian"] = "linear"
    mode: Literal["swing", "twist", "both"] = "swing"
    morphs: Triples = option("morph", ())
    attributes: Driven = option("attribute", ())
    name: str = ""
    within: Tolerance = 1e-4
    fps: Above | None = None
