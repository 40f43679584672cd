"""Steps that lay out joints: orient-joints, make-limb, add-twist, mirror, strip."""

from __future__ import annotations

from functools import partial
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Strict,
    WithJsonSchema,
)
from pydantic_core import CoreSchema, core_schema

from rigtri.operations.mirror.mirrored_metadata import WHAT
from rigtri.pipeline.rigspec.models.base import StepModel, option
from rigtri.pipeline.rigspec.models.values import (
    Above,
    Auto,
    Axis,
    Direction,
    EndKind,
    File,
    Flag,
    Joined,
    Limbs,
    Names,
    Node,
    Nodes,
    NodeToNode,
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


class StyledChain(BaseModel):
    """A chain of joints and, where given, the axes that are for it alone."""

    model_config = ConfigDict(extra="forbid")

    start: Node
    end: Node
    aim: Axis | None = None
    up: Axis | None = None
    up_from: str | None = option("up-from", None)


def _styled(value: Any) -> Any:
    """[START, END] as the mapping of a chain."""
    if isinstance(value, list) and len(value) == 2:
        return {"start": value[0], "end": value[1]}
    return value


def _one_chain(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and bool(value) and isinstance(value[0], str))


class _Chain:
    """A pair of names for a chain without axes of its own; said in the JSON Schema too."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(_styled, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        pair = {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}
        return {"anyOf": [pair, handler(schema)]}


Chain = Annotated[StyledChain, _Chain()]


class OrientJoints(StepModel):
    """Give joints new axes; nothing that can be seen moves."""

    do: Literal["orient-joints"]
    preset: Preset | None = None
    aim: Axis | None = None
    up: Axis | None = None
    up_from: str | None = option("up-from", None)
    joints: Nodes = ()
    chains: Annotated[tuple[Chain, ...], OneOrMany(_one_chain)] = option("chain", ())
    below: Nodes = ()
    skin: str | None = None
    exclude: Nodes = ()
    aim_at: NodeToNode = option("aim-at", ())
    limbs: Limbs = option("limb", ())
    branch: Names = ()
    end: Literal["tip", "parent", "incoming", "keep", "world"] = "tip"
    per_joint_plane: Flag = option("per-joint-plane", False)
    facing: Direction | None = None
    pose: str | None = None
    world: Flag = False
    on_nonuniform_scale: Scales = option("on-nonuniform-scale", "snap")
    on_constraint: Constraints = option("on-constraint", "freeze")
    snap: Flag = False
    offset: Point = (0.0, 0.0, 0.0)
    mirror: Mode | None = None
    from_side: Side = option("from-side", "left")
    plane: Plane = "yz"
    like: File | None = None
    frames: File | None = None
    inverse: Flag = False

    def values(self) -> dict[str, Any]:
        """With the styles in the order of a command line: first all joints', then those of chains."""
        axes = ("aim", "up", "up_from")
        order = [(name, getattr(self, name)) for name in axes if getattr(self, name) is not None]
        for chain in self.chains:
            order.append(("chains", (chain.start, chain.end)))
            order += [(name, getattr(chain, name)) for name in axes if getattr(chain, name) is not None]
        return super().values() | {"order": order}


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


class AddTwist(StepModel):
    """Put twist joints along bones, so that forearms and shoulders turn without wringing."""

    do: Literal["add-twist"]
    limbs: Limbs = option("limb", ())
    auto: Auto | None = option("limbs", None)
    joints: Nodes = option("joint", ())
    children: Nodes = option("to", ())
    upper: Flag = False
    lower: Flag = False
    count: Annotated[int, Strict(), Field(ge=1, le=64)] = 2
    weights: Joined | None = None
    axis: Direction | None = None
    split_weights: Flag = option("split-weights", False)
    most: Annotated[int, Strict(), Field(ge=0)] = option("max-influences", 0)
    keys: Flag = True
    name: str = "{joint}_twist_{number}"


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


class Strip(StepModel):
    """Take out again what rigtri has put in."""

    do: Literal["strip"]
    splits: Flag = False
