"""The options of add-socket."""

from __future__ import annotations

from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Direction, Name, Node, OneCharacter, Point


@dataclass(frozen=True)
class AddSocketOptions(OneCharacter):
    """Options of add-socket."""

    name: Name = option(help="Name of the socket.", group="what")
    on: Node = option(help="The joint that the socket follows.")
    at: Point = option((0.0, 0.0, 0.0), help="Its position in the local space of the joint.")
    aim: Direction | None = option(
        None, help="Direction of its x axis, in the world. [it has the axes of the joint]"
    )
    up: Direction | None = option(
        None,
        help="Direction of its y axis, as far as x allows. [the body's up; the next axis if x is along it]",
    )
