"""Steps that move: take-clips, snap, bake, pose."""

from __future__ import annotations

from typing import Literal

from rigtri.pipeline.rigspec.models.base import StepModel, option
from rigtri.pipeline.rigspec.models.values import (
    Above,
    Assignments,
    File,
    Flag,
    Names,
    Share,
    Tolerance,
)


class Bake(StepModel):
    """Work controls and constraints out into joint keys, or joints' motion into controls."""

    do: Literal["bake"]
    to: Literal["joints", "controls"] = "joints"
    described: File | None = option("rig", None)
    names: Assignments = option("as", ())
    clips: Names = option("clip", ())
    fps: Above | None = None
    between: Tolerance = 1e-3
    soft: Share | None = None
    stretch: Flag | None = None
