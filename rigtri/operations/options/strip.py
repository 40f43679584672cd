"""The options of strip."""

from __future__ import annotations

from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import OneCharacter


@dataclass(frozen=True)
class StripOptions(OneCharacter):
    """Options of strip."""

    splits: bool = option(
        False,
        help="Also remove the metadata of nodes that hold the axes of split joints; the nodes stay.",
        group="what",
    )
    discard_motion: bool = option(
        False,
        help="Also discard motion that only controls have, because it was not baked to joints.",
        group="what",
    )
