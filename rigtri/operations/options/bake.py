"""The options of bake."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

from rigtri.limits import TOLERANCE
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import Tolerance
from rigtri.model.options import option, refuse
from rigtri.operations.option_kinds import Above, ClipNames, Clips, OneCharacter, RigFile, SoftIk, Stretch

Direction = Literal["joints", "controls"]
# How far what lies between samples may be off unless another share of the size is given: less than what
# thirty frames a second leave, and few keys for animators; a hundredth of it takes ten times as many.
BETWEEN = 1e-3


@dataclass(frozen=True)
class BakeOptions(OneCharacter):
    """Options of bake.

    fps: None is as many samples as ``between`` needs. tolerance: how far keys that are left out may be
    off, as a share of the rig's size. soft, stretch: of all limbs, instead of their controls' values.
    discard_motion: whether controls may lose motion that joints do not have.
    """

    to: Direction = option(
        "joints",
        help="What gets the keys.",
        values={
            "joints": "the result of controls, IK and constraints",
            "controls": "the motion of the joints",
        },
        group="what",
    )
    rig_: RigFile = option(
        None,
        help="Read rigtri's metadata from this file, by name, where an exporter has dropped it from IN. To"
        " keep keys between IN's frames as well, run take-clips first.",
        group="what",
        rare=True,
    )
    as_: ClipNames = option(
        {},
        help="With --rig: the clip NAME (or glob) of IN is CLIP of that file, or a part of it. Repeatable.",
        group="what",
        rare=True,
    )
    clip: Clips = option(())
    fps: Above | None = option(
        None, help="Sample at keys and this many times a second, nowhere else. [as many as --between needs]"
    )
    between: Tolerance = option(
        BETWEEN, help="Largest error between samples, as a share of the rig's size.", group="how"
    )
    soft: SoftIk | None = option(None, rare=True)
    stretch: Stretch | None = option(None, rare=True)
    discard_motion: bool = option(
        False,
        help="With --to controls: also discard motion that only controls have, because it was not baked to "
        "joints.",
        group="what",
        rare=True,
    )
    tolerance: Tolerance = option(
        TOLERANCE,
        where="shared",
        help="Largest error of all removed keys together, as a share of the rig's size.",
    )

    def check(self, given: Collection[str]) -> None:
        """UsageError for what cannot be."""
        if self.rig_ is None:
            refuse(given, ["as_"], "names clips of another file: give that file with --rig")
        if self.to != "controls":
            refuse(given, ["discard_motion"], "is about what --to controls replaces")
