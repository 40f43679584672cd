"""The options of set-rest."""

from __future__ import annotations

from collections.abc import Collection

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Facing, OneCharacter, RigFile


@dataclass(frozen=True)
class SetRestOptions(OneCharacter):
    """Options of set-rest."""

    pose: str = option(
        "",
        metavar="POSE",
        help="The rest pose.",
        group="what",
        values={
            "bind": "the one that the skin is bound in",
            "tpose": "arms level, palms down",
            "apose": "arms 45° down",
            "CLIP@TIME": "a moment of a clip",
        },
    )
    like: RigFile | None = option(
        None,
        help="Take the rest rotations of the joints with the same names in FILE.",
        group="what",
        excludes=["pose"],
    )
    straight_fingers: bool = option(False, help="With tpose or apose: also straighten the fingers.")
    facing: Facing | None = option(None)

    def check(self, given: Collection[str]) -> None:
        """UsageError where no pose is named."""
        if not self.pose and self.like is None:
            raise UsageError("give the pose with --pose bind|tpose|apose|CLIP@TIME, or --like FILE")
        if self.pose not in ("", "bind", "tpose", "apose", "rest") and "@" not in self.pose:
            raise UsageError(f"--pose {self.pose}: give bind, tpose, apose or CLIP@TIME")
        if self.straight_fingers and self.pose not in ("tpose", "apose"):
            raise UsageError("--straight-fingers is for --pose tpose and apose")
