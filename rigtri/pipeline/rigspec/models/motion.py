"""Steps that move: take-clips, snap, bake, pose."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from rigtri.pipeline.rigspec.models.base import StepModel, option
from rigtri.pipeline.rigspec.models.values import (
    Above,
    Assignments,
    File,
    Flag,
    Limbs,
    Names,
    Share,
    Tolerance,
)


class TakeClips(StepModel):
    """Take the motion of an edited file home into the rig that it was made of."""

    do: Literal["take-clips"]
    edited: File = option("from")
    clips: Names = option("clip", ())
    names: Assignments = option("as", ())


class Snap(StepModel):
    """Match IK to FK, or FK to IK, at some frames: the joints do not move there."""

    do: Literal["snap"]
    limbs: Limbs = option("limb", ())
    all_limbs: Flag = option("all-limbs", False)
    to: Literal["ik", "fk"]
    at: Annotated[Names, Field(min_length=1)]


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


class Pose(StepModel):
    """Make the pose of one moment, evaluated, the rest pose."""

    do: Literal["pose"]
    at: str = "rest"
    evaluate: Flag = True
