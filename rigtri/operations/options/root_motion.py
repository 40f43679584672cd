"""The options of root-motion."""

from __future__ import annotations

from typing import Literal

from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Clips, CoordinateAxis, Node, OneCharacter


@dataclass(frozen=True)
class RootMotionOptions(OneCharacter):
    """Options of root-motion."""

    mode: Literal["extract", "remove"] = option(
        "extract",
        help="What to do with the motion over the ground.",
        values={
            "extract": "moves it from the hips to the root; the character looks as before",
            "remove": "drops it; the character stays in place",
        },
        group="what",
    )
    yaw: bool = option(False, help="Also move the hips' yaw to the root.")
    axis: CoordinateAxis | None = option(None, help="Only along this axis of the ground. [both]")
    clip: Clips = option((), group="how")
    hips: Node | None = option(
        None, help="The joint whose motion is taken. [the hips, or what carries them below the root]"
    )
    to: Node | None = option(None, help="The joint that gets its motion. [the one above the hips]")
