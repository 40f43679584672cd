"""The options of make-limb."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property
from typing import Annotated

from rigtri.errors import UsageError
from rigtri.model.dataclass import dataclass
from rigtri.model.options import Kind, key_of, option, refuse
from rigtri.operations.axis_presets import AXES, AxisStyle, preset_style
from rigtri.operations.option_kinds import (
    Axis,
    BodySide,
    EndNode,
    JsonFile,
    MetersPerUnit,
    Names,
    Node,
    Nodes,
    Point,
    ReadPose,
    StageUpAxis,
    Vector,
    three,
)
from rigtri.operations.options import axes
from rigtri.operations.options.add_polevector import AddPolevectorOptions, PlacementOptions

_PLACEMENT = ("method", "from_", "reach", "distance", "reach_of", "orientation")


def is_pattern(name: str) -> bool:
    """Whether a name may mean several nodes."""
    return any(letter in name for letter in "*?[")


def _node_or_point(_flag: str, text: str) -> str | Vector:
    """Coordinates as three numbers, anything else as the name of a node."""
    try:
        return three(text)
    except ValueError:
        return text


@dataclass(frozen=True)
class MakeLimbOptions(PlacementOptions):
    """Options of make-limb.

    Two, or more than three without ``planar``, make a chain, which keeps its curve and has no pole vector.
    locators: nodes at the positions of the joints; or points: these positions, in the world. guides: many
    limbs and chains by their names, each a list of points or the options of its own. guide_nodes: these
    from nodes, by a pattern. end_aim: None
    gives the end joint the axes of the joint before. names: else NAME_1, NAME_2 … with _L or _R of the
    side. skin: that of the parent, else one of their own.
    """

    locators: Nodes = option(
        (),
        metavar="A B C",
        help="Nodes where the joints are to be; a pattern means all that match, in the order of their "
        "numbers.",
    )
    points: Annotated[tuple[Point, ...], Kind("points", "X,Y,Z X,Y,Z X,Y,Z")] = option(
        (), help="Positions in the world; without IN they make a new file."
    )
    guides: JsonFile = option(
        None,
        metavar="FILE",
        help="Build a whole skeleton from a file: JSON {NAME: [[x, y, z], ...] or {points: ..., parent: "
        "...}}, or CSV with the columns name, x, y, z and more options.",
        excludes=["locators", "points", "names", "bend", "end_aim", "pole_name"],
        group="what",
    )
    guide_nodes: str | None = option(
        None,
        metavar="GLOB",
        help="Build a whole skeleton from nodes. Those whose names differ only by a number are one limb; a"
        " limb that starts below a node of another is a child of that joint.",
        excludes=["guides", "locators", "points", "names", "name", "side", "bend", "end_aim", "pole_name"],
        group="what",
    )
    planar: bool = option(
        False,
        help="Make more than three points a limb, with its inner joints moved into its plane, instead of a"
        " chain.",
        rare=True,
    )
    preset: str | None = axes.preset()
    aim: Axis | None = axes.aim()
    up: Axis | None = axes.up()
    up_from: str | None = axes.up_from(axes.WITHOUT_JOINTS)
    end_aim: Annotated[str | Vector, Kind("node or point", "NODE|X,Y,Z", read=_node_or_point)] | None = (
        option(None, help="What the end joint aims at. [it has the axes of the joint before]", group="what")
    )
    bend: Point | None = option(
        None, help="The direction in which points on a straight line bend; only for those."
    )
    name: str = option("limb", help="The limb's name; its joints are NAME_1 …", group="what")
    side: BodySide | None = option(None, help="Add _L or _R to the names.", group="what")
    names: Names = option((), metavar="A B C", help="Names of the joints.", group="what", rare=True)
    parent: Node | None = option(
        None,
        help="Parent of the limb. If it is a joint, the limb joins its skins.",
        group="joints",
    )
    skin: bool = option(True, help="Put the joints into a skin.", rare=True)
    pole: bool | None = option(
        None, help="Add the pole vector. [of limbs, not of chains]", rare=True, group="what"
    )
    as_: EndNode | None = option(None, rare=True)
    pose: ReadPose = option(
        "nodes",
        help="The pose in which the locators are read; nodes is the rest pose.",
        rare=True,
    )
    pole_name: str | None = option(None, help="Name of the pole vector. [MIDDLE_pole]", rare=True)

    def check(self, given: Collection[str]) -> None:
        """UsageError for a count that makes no limb, or options that contradict each other."""
        super().check(given)
        many = self.guides is not None or self.guide_nodes is not None
        if not many and not self.with_pole:
            why = "--no-pole leaves it out" if self.pole is False else "a chain has none without --pole"
            refuse(given, [*_PLACEMENT, "pole_name", "as_"], f"is for the pole vector, and {why}")
        if self.preset == "vrm" and any(getattr(self, name) is not None for name in AXES):
            flags = ", ".join(f"--{key_of(name)}" for name in AXES)
            raise UsageError(f"--preset vrm: its frames are parallel to the world; leave out {flags}")
        if many:
            return
        if self.locators and self.points:
            raise UsageError("--locators and --points both say where the joints are: give one of them")
        if not (self.locators or self.points):
            raise UsageError(
                "give the positions of the joints: --locators A B C, or --points x,y,z x,y,z x,y,z"
            )
        if not (len(self.locators) == 1 and is_pattern(self.locators[0])):
            self._check_count(self.count)
        if self.pose != "nodes" and not (self.locators or isinstance(self.end_aim, str)):
            raise UsageError("--pose is for locators; points have fixed positions")
        self.style.checked()

    def _check_count(self, count: int) -> None:
        what = "locators" if self.locators else "points"
        if count < 2:
            raise UsageError(f"a limb has three {what}, a chain two or more, and here is {count}")
        if count == 2 and self.pole:
            raise UsageError("--pole: a chain of two joints has no bend")
        if len(set(self.locators)) < len(self.locators):
            raise UsageError(f"--locators {' '.join(self.locators)}: one of them is named twice")
        if self.names and len(self.names) != count:
            raise UsageError(f"--names: {len(self.names)} names for {count} joints")

    @property
    def count(self) -> int:
        """How many joints there are to be, where no pattern says so."""
        return len(self.locators or self.points)

    @property
    def is_chain(self) -> bool:
        """Whether it is a chain, and no limb: its joints need no plane."""
        return self.count == 2 or (self.count > 3 and not self.planar)

    @property
    def with_pole(self) -> bool:
        """Whether it gets a pole vector."""
        return not self.is_chain if self.pole is None else self.pole

    @cached_property
    def style(self) -> AxisStyle:
        """The axes of the joints."""
        return preset_style(self.preset).with_axes(self)

    @property
    def placement(self) -> AddPolevectorOptions:
        """How the pole vector is placed."""
        place = {name: getattr(self, name) for name in _PLACEMENT}
        return AddPolevectorOptions(**place, name=self.pole_name, as_=self.as_)


@dataclass(frozen=True)
class NewFileOptions:
    """Options of the command where it writes a new file, without IN."""

    up_axis: StageUpAxis = option("y", group="output", rare=True)
    meters_per_unit: MetersPerUnit = option(0.01, group="output", rare=True)
