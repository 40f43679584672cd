"""Steps that build what moves joints: controls, pole vectors, constraints, rivets, pose readers."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, Strict

from rigtri.pipeline.rigspec.models.base import StepModel, option
from rigtri.pipeline.rigspec.models.values import (
    Above,
    Assignments,
    Direction,
    Driven,
    Flag,
    Joined,
    Limb,
    Node,
    Number,
    OfNodes,
    Tolerance,
    Triples,
)


def _orient(value: Any) -> Any:
    """``rest``, ``none`` or three degrees."""
    if isinstance(value, str) and value not in ("rest", "none"):
        try:
            value = [float(part) for part in value.split(",")]
        except ValueError:
            raise ValueError(f"'{value}': give rest, none or [x, y, z] in degrees") from None
    return value


Degrees = Annotated[float, Strict(), Field(gt=-1e6, lt=1e6)]


class Constrain(StepModel):
    """Let a node follow others by a rule that is stored in the file; nothing moves now."""

    do: Literal["constrain"]
    kind: Literal["parent", "point", "orient", "scale", "aim", "polevector"] = option("type")
    child: Node | None = None
    drivers: Annotated[OfNodes, Field(min_length=1)] = option("driver")
    skip: Joined | None = None
    maintain_offset: Flag = option("maintain-offset", True)
    rotate_order: Literal["xyz", "yzx", "zxy", "xzy", "yxz", "zyx"] = option("rotate-order", "xyz")
    joint_orient: Annotated[
        Literal["rest", "none"] | tuple[Degrees, Degrees, Degrees], BeforeValidator(_orient)
    ] = option("joint-orient", "rest")
    space: Literal["world", "local"] = "world"
    roll_axis: Literal["x", "y", "z"] | None = option("roll-axis", None)
    aim_axis: Direction = option("aim-axis", (1.0, 0.0, 0.0))
    up_axis: Direction = option("up-axis", (0.0, 1.0, 0.0))
    world_up: Literal["vector", "object", "objectrotation", "none"] = option("world-up", "vector")
    up_vector: Direction | None = option("up-vector", None)
    up_object: Node | None = option("up-object", None)
    limb: Limb | None = None
    vrm: Flag = option("vrm-constraints", False)


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
