"""The options of merge-joints."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import Kind, option
from rigtri.operations.option_kinds import Excluded, Nodes, OneCharacter, RigFile

Count = Annotated[int, Kind("number", "N", low=1)]


@dataclass(frozen=True)
class MergeJointsOptions(OneCharacter):
    """Options of merge-joints."""

    joints: Nodes = option((), help="Merge these joints, with all joints below them.", group="what")
    keep_children: bool = option(
        False,
        help="Joints below those of --joints stay, as children of their parents; for joints that never move.",
        group="what",
    )
    still: bool = option(
        False,
        help="Merge joints that never move relative to their parent; those below them that move stay.",
        group="what",
    )
    max_joints: Count | None = option(
        None,
        help="Merge until at most N joints are left; those that move vertices least go first.",
        group="what",
    )
    lod: RigFile | None = option(
        None,
        help="Merge the joints that FILE, another level of detail of the character, does not have.",
        group="what",
    )
    exclude: Excluded = option(())

    def check(self, given: Collection[str]) -> None:
        """UsageError where nothing says what is to be merged."""
        if not (self.joints or self.still or self.max_joints or self.lod is not None):
            raise UsageError("name joints to merge: --joints GLOB, --still, --max-joints N or --lod FILE")
        if self.keep_children and not self.joints:
            raise UsageError("--keep-children is about joints that --joints names")
