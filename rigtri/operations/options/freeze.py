"""The options of freeze."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Above, OneCharacter, UpAxis


@dataclass(frozen=True)
class FreezeOptions(OneCharacter):
    """Options of freeze."""

    scale: bool = option(
        False,
        help="Freeze scale: joints, sockets and all above them get scale 1 in the world.",
        group="what",
    )
    up_axis: UpAxis | None = option(
        None,
        help="Freeze the rotation above joints; this becomes the file's up axis (glTF: only y).",
        group="what",
    )
    unit: Above | None = option(
        None,
        metavar="METRES",
        help="Make this the file's unit, in metres, and convert all lengths (glTF: only 1).",
        group="what",
    )
    only: Literal["above", "joints"] | None = option(
        None, help="Freeze only scale and rotation of nodes above joints, or only the scale of joints."
    )

    def check(self, given: Collection[str]) -> None:
        """UsageError for a rotation of nodes that are left out."""
        if self.up_axis is not None and self.only == "joints":
            raise UsageError(
                "--up-axis freezes a rotation above joints, so it does not go with --only joints"
            )

    @property
    def scales(self) -> bool:
        """Whether scale is frozen; with no option both scale and rotation are."""
        return self.scale or self.unit is not None or self.up_axis is None

    @property
    def rotates(self) -> bool:
        """Whether rotation above joints is frozen."""
        return self.up_axis is not None or not (self.scale or self.unit is not None or self.only == "joints")
