"""The options of bake."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal, get_args

from rigtri.errors import UsageError
from rigtri.limits import refuse_single_name, refuse_unworkable
from rigtri.operations.declaration.option import (
    Above,
    ClipNames,
    Names,
    RigFile,
    Share,
    Tolerance,
    option,
    refuse,
)

Direction = Literal["joints", "controls"]
DIRECTIONS: tuple[Direction, ...] = get_args(Direction)
# How far what lies between samples may be off unless another share of the size is given: less than what
# thirty frames a second leave, and few keys for animators; a hundredth of it takes ten times as many.
BETWEEN = 1e-3


@dataclass(frozen=True)
class BakeOptions:
    """Bake controls and constraints to joint keys, or the motion of joints to their controls.

    fps: None is as many samples as ``between`` needs. tolerance: how far keys that are left out may be
    off, as a share of the rig's size. soft, stretch: of all limbs, instead of their controls' values.
    """

    to: Direction = option(
        "joints",
        help="joints: what controls, IK and constraints make of them. controls: the motion that the "
        "joints have.",
    )
    rig_: RigFile = option(
        None,
        help="Read rigtri's metadata from this file, by name: exporters drop it from IN. To keep the "
        "keys between IN's frames, too, use take-clips first.",
    )
    as_: ClipNames = option(
        {},
        help="With --rig: the clip NAME (or glob) of IN is CLIP of that file, or a part of it. Repeatable.",
    )
    clip: Names = option((), metavar="GLOB", help="Only these clips. Repeatable.")
    fps: Above | None = option(
        None, help="Samples per second besides the keys, and no others. [as many as --between needs]"
    )
    between: Tolerance = option(BETWEEN, help="Largest error between samples, as a share of the rig's size.")
    soft: Share | None = option(
        None,
        metavar="SHARE",
        help="Soft IK: how far before it is straight a limb slows down, as a share of its length. "
        "[as stored, or 0]",
    )
    stretch: bool | None = option(None, help="IK limbs grow to reach their target. [as stored, or not]")
    tolerance: Tolerance = option(1e-5, where="shared")

    def check(self, given: Collection[str]) -> None:
        """UsageError for what cannot be."""
        if self.rig_ is None:
            refuse(given, ["as_"], "names clips of another file: give that file with --rig")
        if self.to not in DIRECTIONS:
            raise UsageError(f"--to {self.to}: use {', '.join(DIRECTIONS)}")
        refuse_single_name("--clip", self.clip)
        numbers = (("--fps", self.fps), ("--tolerance", self.tolerance), ("--soft", self.soft))
        for flag, number in (*numbers, ("--between", self.between)):
            refuse_unworkable(flag, number)
        if self.fps is not None and not self.fps > 0:
            raise UsageError("--fps is a number above 0, e.g. 30")
        if not self.between >= 0:
            raise UsageError("--between is a share of the rig's size, 0 or more")
        if not self.tolerance >= 0:
            raise UsageError("--tolerance is a share of the rig's size, 0 or more")
        if self.soft is not None and not 0 <= self.soft < 1:
            raise UsageError("--soft is a share of the limb, from 0 to below 1")
        if self.stretch is not None and not isinstance(self.stretch, bool):
            raise UsageError(f"stretch={self.stretch!r}: True, False or None (as stored)")
