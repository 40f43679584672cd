"""The options of snap."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Literal

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import Kind, option
from rigtri.operations.option_kinds import Auto, Moments, OneCharacter

# By name alone: limbs with an IK end, whose joints need not be below each other.
Limbs = Annotated[tuple[tuple[str, str, str], ...], Kind("limbs", "ROOT MIDDLE END", group="joints")]

IkOrFk = Literal["ik", "fk"]


@dataclass(frozen=True)
class SnapOptions(OneCharacter):
    """Options of snap."""

    to: IkOrFk = option(help="What drives the limbs afterwards, IK or FK.", group="what")
    at: Moments = option()
    limb: Limbs = option((), help="The three joints of a limb with an IK end. Repeatable.")
    limbs: Auto | None = option(None, help="Every limb with an IK end.", group="joints", excludes=["limb"])

    def check(self, given: Collection[str]) -> None:
        """UsageError without limbs, and without a moment."""
        if not (self.limb or self.limbs):
            raise UsageError("name the limbs: --limb ROOT MIDDLE END, or --limbs auto")
        if not self.at:
            raise UsageError("give the moment: --at CLIP@TIME, or --at rest")
