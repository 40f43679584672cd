"""The options of add-twist."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import Kind, option
from rigtri.operations.option_kinds import Auto, Direction, Limbs, Nodes, OneCharacter, check_tokens

MOST = 64
NAME = "{joint}_twist_{number}"
TOKENS = ("joint", "number")


def _weights(flag: str, text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError as error:
        raise UsageError(f"{flag} {text}: give numbers with commas between them") from error


@dataclass(frozen=True)
class AddTwistOptions(OneCharacter):
    """Options of add-twist.

    joint, to: a bone for each pair of both; whether the child's twist spreads up or the joint's own is
    taken away is what its limb says, else the former.
    """

    limb: Limbs = option(
        (), help="Both bones of this limb, or with --upper or --lower one of them. Repeatable."
    )
    limbs: Auto | None = option(None, help="Every limb that is recognised.", group="joints")
    joint: Nodes = option(
        (), metavar="JOINT", help="Start of a bone that gets twist joints. Repeatable, each with its --to."
    )
    to: Nodes = option(
        (),
        metavar="CHILD",
        help="End of that bone, a joint below it; one --to for each --joint.",
        group="joints",
    )
    upper: bool = option(
        False, help="Upper bones: remove the joint's own twist towards its root.", group="joints"
    )
    lower: bool = option(
        False, help="Lower bones: spread the twist of the bone's end up the bone.", group="joints"
    )
    count: Annotated[int, Kind("number", low=1, high=MOST)] = option(
        2, help="Number of twist joints on a bone, at equal distances.", group="what"
    )
    weights: Annotated[tuple[float, ...], Kind("joined", "W1,W2,…", read=_weights)] = option(
        (),
        help="Share of the twist that each twist joint takes, from -1 to 1. [i/(n+1) on lower, i/(n+1) - 1"
        " on upper bones]",
        group="what",
    )
    axis: Direction | None = option(
        None, help="The twist axis in the space of the bone's joint. [along the bone]", rare=True
    )
    split_weights: bool = option(
        False,
        help="Distribute the bone's skin weights to its joint and the twist joints, by position along it.",
    )
    max_influences: Annotated[int, Kind("number", low=0)] = option(
        0,
        metavar="N",
        help="With --split-weights: at most N joints for a vertex, those nearest to it; 0 for any number.",
        rare=True,
    )
    keys: bool = option(True, help="Write keys to every clip, so that the twist joints follow.")
    name: str = option(
        NAME, help="Names of the twist joints, with the tokens {joint} and {number}.", group="what"
    )

    @property
    def bones(self) -> tuple[tuple[str, str], ...]:
        """The bones that are named, each by its joint and the child."""
        return tuple(zip(self.joint, self.to, strict=True))

    def check(self, given: Collection[str]) -> None:
        """UsageError for what fits no twist joint."""
        if len(self.joint) != len(self.to):
            raise UsageError(f"{len(self.joint)} --joint and {len(self.to)} --to: each bone has one of both")
        if self.max_influences and not self.split_weights:
            raise UsageError("--max-influences needs --split-weights")
        if not (self.limb or self.limbs or self.joint):
            raise UsageError(
                "name the bones: --limb ROOT MIDDLE END, --joint JOINT --to CHILD, or --limbs auto"
            )
        if self.weights and len(self.weights) != self.count:
            raise UsageError(
                f"--weights: give one weight for each of {self.count} twist joints, not {len(self.weights)}"
            )
        if not all(-1.0 <= weight <= 1.0 for weight in self.weights):
            raise UsageError("--weights: each lies between -1 and 1")
        if self.weights and (self.limb or self.limbs) and self.upper == self.lower:
            raise UsageError("--weights: choose the bone of the limbs, --upper or --lower")
        check_tokens(self.name, TOKENS)
