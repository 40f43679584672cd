"""What add-polevector can be asked for."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from rigtri.errors import UsageError
from rigtri.operations.declaration.kinds import Above, Auto, Bends, Chains, Direction, EndKind, Limbs, Node
from rigtri.operations.declaration.option import option, refuse


@dataclass(frozen=True)
class PlacementOptions:
    """Where the pole vector of a limb stands."""

    method: Literal["perpendicular", "ratio"] = option(
        "perpendicular",
        help="Which point of the chord the direction starts at: nearest to the middle, or by lengths.",
    )
    from_: Literal["middle", "root", "foot"] = option(
        "middle", help="Where the distance is counted from; foot is that point of the chord."
    )
    reach: Above = option(0.5, help="Distance as a multiple of the limb's length.", excludes=["distance"])
    distance: Above | None = option(None, help="Distance in world units of the file.")
    reach_of: Literal["limb", "chord"] = option(
        "limb", help="What --reach multiplies: both bones, or root to end."
    )
    orientation: Literal["world", "limb", "aim"] = option(
        "world", help="The locator's axes: the world's, the limb's, or aiming at the middle joint."
    )

    def check(self, given: Collection[str]) -> None:
        """UsageError for a place that is given twice."""
        if self.distance is not None:
            refuse(given, ["reach_of"], "goes with --reach, not with --distance")


@dataclass(frozen=True)
class AddPolevectorOptions(PlacementOptions):
    """Add a locator that says which way a limb bends.

    bend: by the name of a limb's root, middle or end joint, the direction it bends to.
    as_: None keeps what is there, else it is a locator.
    """

    limb: Limbs = option((), help="The three joints of a limb, e.g. shoulder elbow wrist. Repeatable.")
    chain: Chains = option(
        (), help="A limb of more joints; it bends at the one farthest from the chord. Repeatable."
    )
    bend_joint: Node | None = option(
        None, metavar="NAME", help="With one --chain: the joint at which it bends."
    )
    limbs: Auto | None = option(
        None, help="Find arms and legs by themselves, as rigtri recognise shows them."
    )
    bend: Bends = option(
        {}, help="The direction in which the limb of that joint bends; needed where it is straight."
    )
    facing: Direction | None = option(
        None, help="Where the character looks: knees bend forward, elbows back. glTF says +z, USD nothing."
    )
    name: str | None = option(None, help="Name of the locator. [MIDDLE_pole]")
    as_: EndKind | None = option(
        None, help="A loose node, or a joint of the limb's skin, which engines import. [locator]"
    )
    pose: str = option("nodes", metavar="nodes|bind|CLIP@TIME", help="Where positions are taken.")
    check_clips: bool = option(
        False, help="List the times of every clip at which the limb is straight or its pole flips side."
    )

    def check(self, given: Collection[str]) -> None:
        super().check(given)
        if self.bend_joint is not None and len(self.chain) != 1:
            raise UsageError("--bend-joint goes with exactly one --chain")
