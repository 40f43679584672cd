"""Steps that lay out joints: orient-joints, make-limb, add-twist, mirror, strip."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Literal

from pydantic import (
    AfterValidator,
    WithJsonSchema,
)

from rigtri.operations.mirror.mirrored_metadata import WHAT
from rigtri.pipeline.rigspec.models.base import StepModel, option
from rigtri.pipeline.rigspec.models.values import (
    Above,
    Axis,
    EndKind,
    Flag,
    Names,
    Node,
    Nodes,
    Number,
    OneOrMany,
    Point,
    Points,
    Preset,
    TextOrPoint,
    one_of,
)

Scales = Literal["snap", "skip", "split", "error"]
Constraints = Literal["freeze", "error"]
Side = Literal["left", "right"]
Plane = Literal["yz", "xz", "xy"]
Mode = Literal["behavior", "orientation", "blender"]
Mirrored = Annotated[
    str, AfterValidator(partial(one_of, known=WHAT)), WithJsonSchema({"enum": list(WHAT), "type": "string"})
]


class Placing(StepModel):
    """Where the pole vector of a limb stands."""

    method: Literal["perpendicular", "ratio"] = "perpendicular"
    from_: Literal["middle", "root", "foot"] = option("from", "middle")
    reach: Above | None = None
    distance: Above | None = None
    reach_of: Literal["limb", "chord"] = option("reach-of", "limb")
    orientation: Literal["world", "limb", "aim"] = "world"


class MakeLimb(Placing):
    """Make an oriented chain of joints and its pole vector from three locators or points."""

    do: Literal["make-limb"]
    locators: Nodes = ()
    points: Points = ()
    planar: Flag = False
    preset: Preset | None = None
    aim: Axis | None = None
    up: Axis | None = None
    up_from: str | None = option("up-from", None)
    end_aim: TextOrPoint | None = option("end-aim", None)
    bend: Point | None = None
    name: str = "limb"
    side: Side | None = None
    names: Names = ()
    parent: Node | None = None
    skin: Flag = True
    pole: Flag = True
    kind: EndKind | None = option("as", None)
    pose: str = "nodes"
    pole_name: str | None = option("pole-name", None)


class Mirror(StepModel):
    """Give one side of a character what the other has: joint axes, and what rigtri has built."""

    do: Literal["mirror"]
    mode: Mode = "behavior"
    from_side: Side = option("from-side", "left")
    plane: Plane = "yz"
    plane_at: Number | None = option("plane-at", None)
    what: Annotated[tuple[Mirrored, ...], OneOrMany(lambda value: isinstance(value, str))] = ()
    joints: Nodes = ()
    below: Nodes = ()
    exclude: Nodes = ()
    pose: str | None = None
    on_nonuniform_scale: Scales = option("on-nonuniform-scale", "snap")
    on_constraint: Constraints = option("on-constraint", "freeze")
