"""The options of freeze."""

from __future__ import annotations

from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Above, UpAxis


@dataclass(frozen=True)
class FreezeOptions:
    """Options of freeze."""

    scale: bool = option(
        False,
        help="Freeze scale: that of joints, sockets and all above them becomes 1 in the world.",
        group="what",
    )
    up_axis: UpAxis | None = option(
        None,
        help="Freeze the rotation of what is above joints; the file's up axis becomes this (glTF: y alone).",
        group="what",
    )
    unit: Above | None = option(
        None,
        metavar="METRES",
        help="The length of the file's unit, in metres; all lengths become numbers of it (glTF has 1 alone).",
        group="what",
    )
    above: bool = option(
        False,
        excludes=["joints"],
        help="Freeze only the scale that nodes above joints have, not what joints have of their own.",
    )
    joints: bool = option(
        False, help="Freeze only the scale that joints have of their own, not what is above them."
    )

    @property
    def scales(self) -> bool:
        """Whether scale is frozen; with no option both scale and rotation are."""
        return self.scale or self.unit is not None or self.up_axis is None

    @property
    def rotates(self) -> bool:
        """Whether rotation above joints is frozen."""
        return self.up_axis is not None or not (self.scale or self.unit is not None or self.joints)
