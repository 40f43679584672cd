"""The options of draw."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Literal, get_args

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import Kind, option
from rigtri.operations.option_kinds import MOMENT, Below, Chains, Excluded, Moment, Nodes, Selection, Skin
from rigtri.text import is_number

ViewName = Literal["front", "back", "side", "top", "three-quarter"]
VIEWS: tuple[ViewName, ...] = get_args(ViewName)
# Pictures smaller than this show nothing, larger ones are a mistake.
_LEAST, _MOST = 64, 16384


def _size(text: str) -> tuple[int, int]:
    """WIDTHxHEIGHT in pixels. ValueError for anything else."""
    wide, mark, high = text.lower().partition("x")
    if not (mark and is_number(wide) and is_number(high)):
        raise ValueError(f"'{text}' is not a valid size: use WIDTHxHEIGHT in pixels, e.g. 1200x900")
    return int(wide), int(high)


Share = Annotated[float, Kind("number", low=0, high=10)]
Size = Annotated[tuple[int, int], Kind("size", "WIDTHxHEIGHT", parse=_size)]


@dataclass(frozen=True)
class DrawOptions:
    """Options of draw."""

    view: str = option(
        "three-quarter",
        metavar="|".join([*VIEWS, "X,Y,Z"]),
        help="View direction; front looks at the character's face, side at its left.",
        group="what",
    )
    at: Moment = option("rest", help=f"{MOMENT} Active controls move their joints.")
    joints: Nodes = option((), help="Draw only these joints, larger. Repeatable.")
    chain: Chains = option((), help="Draw only this chain. Repeatable.")
    below: Below = option((), help="Draw this joint and all below it. Repeatable.")
    skin: Skin | None = option(None, rare=True)
    exclude: Excluded = option(())
    names: bool = option(True, help="Write the joints' names.")
    axes: Share = option(0.35, help="Length of the axes' arrows as a share of the bone; 0 for none.")
    mesh: bool = option(True, help="Draw the outline of the meshes.")
    size: Size | None = option(
        None, help="Size of the picture in pixels. [1000x900, with --against 1500x900]"
    )

    @property
    def selection(self) -> Selection:
        """The joints that are named."""
        return Selection(self.joints, self.chain, self.below, self.skin, self.exclude)

    def check(self, given: Collection[str]) -> None:
        """UsageError for a size that is no picture's."""
        if self.size is not None and not all(_LEAST <= side <= _MOST for side in self.size):
            raise UsageError(
                f"a picture has {_LEAST} to {_MOST} pixels a side, not {self.size[0]}x{self.size[1]}"
            )
