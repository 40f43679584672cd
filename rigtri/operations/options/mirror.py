"""The options of mirror."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property
from typing import Literal, get_args

from rigtri.errors import UsageError
from rigtri.frames import Mirror, Plane
from rigtri.limits import TOLERANCE
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import Root, Tolerance
from rigtri.model.options import option
from rigtri.operations.option_kinds import (
    Below,
    BodySide,
    Excluded,
    Nodes,
    Number,
    OnConstraint,
    OneCharacter,
    OnNonuniformScale,
    ReadPose,
    Selection,
    WorldPlane,
)
from rigtri.operations.options import axes

What = Literal["limbs", "joints", "controls", "polevectors", "twists", "constraints", "rivets", "posereaders"]
# In the order in which they are mirrored: each may be about nodes of those before.
WHAT: tuple[What, ...] = get_args(What)


@dataclass(frozen=True)
class MirrorOptions(OneCharacter):
    """Options of mirror.

    plane_at: None is between most pairs of joints. across: that plane in the world, as
    `rigtri.frames.mirroring` has found it for ``mirror``.
    """

    mode: Mirror = option(
        "behavior",
        help="How the axes of one side are mirrored onto the other.",
        values=axes.MIRRORED,
        group="what",
    )
    from_side: BodySide = option("left", help="The side that is copied onto the other.", group="what")
    plane: Plane | None = option(None, help=axes.BETWEEN_SIDES, rare=True)
    plane_at: Number | None = option(
        None,
        help="Where the plane cuts the axis that it mirrors, in the units of the joints. [between most "
        "pairs]",
        rare=True,
    )
    what: tuple[What, ...] = option((), help="Mirror only these; repeatable. [all]", group="what")
    joints: Nodes = option((), help="Only these joints and their counterparts.")
    below: Below = option((), help="Only this joint, all below, and their counterparts.")
    exclude: Excluded = option(())
    pose: ReadPose | None = option(
        None,
        help="The pose that axes are read from. [bind]",
        rare=True,
    )
    on_nonuniform_scale: OnNonuniformScale = option("snap", rare=True)
    on_constraint: OnConstraint = option("freeze", rare=True)
    root: Root | None = option(None, where="shared")
    tolerance: Tolerance = option(TOLERANCE, where="shared")
    across: WorldPlane = option(None, where="python")

    def check(self, given: Collection[str]) -> None:
        """UsageError for what cannot be mirrored."""
        if not set(self.what) <= set(WHAT):
            raise UsageError(f"choose what to mirror: {', '.join(WHAT)}")

    @cached_property
    def selection(self) -> Selection:
        """The joints, of either side, whose axes take part."""
        return Selection(joints=self.joints, below=self.below, exclude=self.exclude)
