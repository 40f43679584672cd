"""The options of add-polevector."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

from rigtri.errors import UsageError
from rigtri.maths import PoleMethod, PoleOrigin, ReachOf
from rigtri.model.dataclass import dataclass
from rigtri.model.options import option, refuse
from rigtri.operations.option_kinds import (
    Above,
    Auto,
    Bends,
    Chains,
    EndNode,
    Facing,
    Limbs,
    Node,
    OneCharacter,
    Reach,
    ReadPose,
)


@dataclass(frozen=True)
class PlacementOptions(OneCharacter):
    """Position of the pole vector of a limb."""

    method: PoleMethod = option(
        "perpendicular",
        help="How the mid joint is projected onto the line from root to end, where the pole vector's "
        "direction starts.",
        values={
            "perpendicular": "nearest to the mid joint, as in the talk 'Rigging with Triangles'",
            "ratio": "by the lengths of both bones, as in 'Using Vector Math to Rig an Arm'",
        },
        rare=True,
    )
    from_: PoleOrigin = option(
        "middle",
        help="The point from which the pole vector's distance is measured.",
        values={
            "middle": "the mid joint, as in the talk",
            "root": "the root joint, as in the article",
            "foot": "the projection of the mid joint, where the direction starts",
        },
        rare=True,
    )
    reach: Reach = option(0.5, excludes=["distance"])
    distance: Above | None = option(None, help="Distance of the pole vector, in the file's units.")
    reach_of: ReachOf = option(
        "limb",
        help="What --reach multiplies: the length of both bones, or the distance from root to end.",
        rare=True,
    )
    orientation: Literal["world", "limb", "aim"] | None = option(
        None,
        help="Axes of the pole vector's locator. [its own where it is there already, else world]",
        values={
            "world": "the world's",
            "limb": "those of the limb's root joint, as in the article",
            "aim": "aiming at the mid joint",
        },
        rare=True,
    )

    def check(self, given: Collection[str]) -> None:
        """UsageError for a place that is given twice."""
        if self.distance is not None:
            refuse(given, ["reach_of"], "goes with --reach, not with --distance")


@dataclass(frozen=True)
class AddPolevectorOptions(PlacementOptions):
    """Options of add-polevector.

    bend: by the name of a limb's root, middle or end joint, the direction it bends to.
    as_: None keeps what is there, else it is a locator.
    """

    limb: Limbs = option((), help="The three joints of a limb, e.g. shoulder elbow wrist. Repeatable.")
    chain: Chains = option(
        (),
        help="A limb of more than three joints, which bends at the one farthest from the line from START "
        "to END. Repeatable.",
    )
    bend_joint: Node | None = option(
        None, metavar="NAME", help="With one --chain: the joint at which it bends.", rare=True
    )
    limbs: Auto | None = option(
        None, help="Find arms and legs automatically, as rigtri recognise shows them.", group="joints"
    )
    bend: Bends = option(
        {}, help="Direction in which the limb with this joint bends; required if it is straight."
    )
    facing: Facing | None = option(None)
    name: str | None = option(None, help="Name of the locator. [MIDDLE_pole]", group="what")
    as_: EndNode | None = option(None, rare=True)
    pose: ReadPose = option("nodes", help="The pose that positions are read from.", rare=True)
    check_clips: bool = option(
        False,
        help="List the times of every clip at which the limb is straight or its pole flips side.",
        group="output",
    )

    def check(self, given: Collection[str]) -> None:
        super().check(given)
        if self.bend_joint is not None and len(self.chain) != 1:
            raise UsageError("--bend-joint goes with exactly one --chain")
