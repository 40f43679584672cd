"""What rigtri stores on nodes: one dataclass for each type of record.

schemas/node.schema.json describes the records for other programs. Files may hold anything: `Record.from_dict`
never raises, and says in `Record.problems` what of a record cannot be used. `Record.to_dict` gives back what
was stored, in its order, with keys that this version does not know. What is its default is not stored.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, field, fields, replace
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self, get_args, get_origin, get_type_hints

from rigtri.maths import PoleMethod, PoleOrigin, ReachOf, RotateOrder
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side

VERSION = 1
# The largest whole number up to which floats have all.
_MOST = 2**53
TRANSLATION, ROTATION, SCALE = ("tx", "ty", "tz"), ("rx", "ry", "rz"), ("sx", "sy", "sz")

Triple = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Names = tuple[str, ...]
# Rows of 4 × 4 matrices, one after another.
Matrices = Annotated[tuple[float, ...], 16]
ControlKind = Literal["fk", "ik", "root", "heel", "tip", "ball"]
# The controls about which a foot rolls, each a child of the one before, the first one of the IK control.
PIVOTS: tuple[ControlKind, ...] = ("heel", "tip", "ball")
ConstraintKind = Literal["parent", "point", "orient", "scale", "aim", "polevector"]
ConstraintSpace = Literal["world", "local", "roll"]
RollAxis = Literal["x", "y", "z", ""]
WorldUp = Literal["vector", "object", "objectrotation", "none"]
NodeConstraintKind = Literal["rotation", "roll", "aim"]
ReaderKind = Literal["dot", "cone", "rbf"]
Kernel = Literal["linear", "gaussian"]
ReaderMode = Literal["swing", "twist", "both"]
# Keys of metadata, at any depth, that hold addresses of nodes.
REFERENCES = frozenset(
    [
        *("joint", "to", "driver", "child", "control", "mesh", "worldUpObject", "frame", "node", "middle"),
        *("endAim", "drivers", "chain", "locators", "weightNodes"),
    ]
)
# The channels that each kind of constraint sets on its child.
CHANNELS: Mapping[ConstraintKind, tuple[str, ...]] = {
    "parent": TRANSLATION + ROTATION + SCALE,
    "point": TRANSLATION,
    "orient": ROTATION,
    "scale": SCALE,
    "aim": ROTATION,
    "polevector": (),
}


@dataclass(frozen=True, kw_only=True)
class Stored:
    """Values under keys, as JSON or USD attributes hold them.

    A field is stored under its name in camel case. One without a default must be there.
    stored: what was read, unknown keys included. problems: what of it cannot be used, in words; fields have
    their default then, or an empty value.
    """

    stored: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)
    problems: tuple[str, ...] = field(default=(), compare=False)

    @classmethod
    def from_dict(cls, stored: Mapping[str, Any]) -> Self:
        """The record that is stored so; see `problems` for what is missing or of another kind."""
        values: dict[str, Any] = {}
        problems = []
        for key in _keys(cls):
            if key.name in stored:
                value = key.read(stored[key.name])
                if value is not None:
                    values[key.field] = value
                    continue
                problems.append(f"its {key.name} is {stored[key.name]!r:.60}")
            elif key.required:
                problems.append(f"its {key.name} is missing")
            if key.required:
                values[key.field] = key.empty
        return cls(**values, stored=stored, problems=tuple(problems))

    def to_dict(self) -> dict[str, Any]:
        """What to store: keys that were there keep their order and, where nothing changed, their values."""
        found = dict(self.stored)
        for key in _keys(type(self)):
            value = getattr(self, key.field)
            if value == key.default:
                found.pop(key.name, None)
            elif key.name not in found or key.read(found[key.name]) != value:
                read = key.read(value)  # a whole number that is meant as a float
                found[key.name] = _plain(value if read is None else read)
        return found


@dataclass(frozen=True, kw_only=True)
class Record(Stored):
    """What rigtri stores on one node."""

    type: ClassVar[str] = ""

    def to_dict(self) -> dict[str, Any]:
        found = super().to_dict()
        return found if self.stored else {"v": VERSION, "type": self.type, **found}


@dataclass(frozen=True, kw_only=True)
class ConstraintRecord(Record):
    """A constraint; `rigtri.model.constraints` has it with nodes and arrays.

    weight_nodes: for each driver the node whose x is its weight instead, so that clips can have keys of it.
    """

    type: ClassVar[str] = "constraint"
    kind: ConstraintKind
    child: str
    drivers: Names
    weights: tuple[float, ...]
    weight_nodes: Names = ()
    offsets: Matrices
    chain: Names = ()
    skip: Names = ()
    rotate_order: RotateOrder | None = None
    joint_orient: Quaternion | None = None
    rest: Quaternion | None = None
    space: ConstraintSpace | None = None
    roll_axis: RollAxis | None = None
    aim: Triple | None = None
    up: Triple | None = None
    world_up: WorldUp | None = None
    world_up_vector: Triple | None = None
    world_up_object: str = ""
    vrm: NodeConstraintKind | None = None


@dataclass(frozen=True, kw_only=True)
class ConstraintWeightRecord(Record):
    """A node whose x is the weight of a driver of a constraint, which is its parent.

    clip: the one for which the driver has another offset, so that the child does not jump in it.
    """

    type: ClassVar[str] = "constraintWeight"
    driver: str
    clip: str = ""


@dataclass(frozen=True, kw_only=True)
class ControlRecord(Record):
    """A control: what an animator moves."""

    type: ClassVar[str] = "control"
    kind: ControlKind
    joint: str
    chain: Names = ()
    side: Side | None = None
    shape: str = ""
    size: float | None = None
    shift: float | None = None
    color: Triple | None = None
    named: str = ""
    soft: float | None = None
    stretch: bool | None = None

    @classmethod
    def from_dict(cls, stored: Mapping[str, Any]) -> Self:
        found = super().from_dict(stored)
        has_limb = found.kind in ("ik", *PIVOTS)
        return replace(found, problems=found.problems or _limb_problems(found.chain)) if has_limb else found


@dataclass(frozen=True, kw_only=True)
class FrameRecord(Record):
    """Where the axes of a joint came from. joint: the one whose frame this node is, after a split."""

    type: ClassVar[str] = "frame"
    up: str = ""
    invented: bool = False
    joint: str = ""


@dataclass(frozen=True, kw_only=True)
class GroupRecord(Record):
    """The node above all that rigtri adds."""

    type: ClassVar[str] = "group"


@dataclass(frozen=True, kw_only=True)
class LimbRecord(Record):
    """A joint of a limb that make-limb has built; the first part describes the limb."""

    type: ClassVar[str] = "limb"
    limb: str
    part: int
    chain: Names = ()
    middle: str = ""
    aim: str = ""
    up: str = ""
    up_from: str = ""
    hinge: Triple | None = None
    lengths: tuple[float, ...] = ()
    planar: bool | None = None
    source: str = ""
    locators: Names = ()
    end_aim: str | Triple | None = None


@dataclass(frozen=True, kw_only=True)
class OffsetRecord(Record):
    """The node above a control that has its joint's place.

    axes: how the joint is turned seen from this node, where they have not the same axes. scale: the joint's
    own while the control is zero, where it rests with another one. aim, up, up_from, held: what the control
    is aimed by, "" where it has its joint's axes.
    """

    type: ClassVar[str] = "offset"
    kind: ControlKind
    joint: str
    axes: Quaternion | None = None
    scale: Triple | None = None
    aim: str = ""
    up: str = ""
    up_from: str = ""
    held: bool = False


@dataclass(frozen=True, kw_only=True)
class PoleVectorRecord(Record):
    """A locator that gives the direction in which a limb bends."""

    type: ClassVar[str] = "poleVector"
    chain: Names
    method: PoleMethod | None = None
    from_: PoleOrigin | None = None
    distance: float | None = None
    reach: float | None = None
    reach_of: ReachOf | None = None
    bend: float | None = None
    source: str = ""
    pose: str = ""
    shape: str = ""
    size: float | None = None
    color: Triple | None = None

    @classmethod
    def from_dict(cls, stored: Mapping[str, Any]) -> Self:
        found = super().from_dict(stored)
        return replace(found, problems=found.problems or _limb_problems(found.chain))


@dataclass(frozen=True, kw_only=True)
class TargetRecord(Stored):
    """A target pose of a pose reader, with one of direction, rotation and node."""

    name: str
    direction: Triple | None = None
    rotation: Quaternion | None = None
    node: str = ""


@dataclass(frozen=True, kw_only=True)
class OutputRecord(Stored):
    """What the weight of a target drives: a morph target of a mesh, an attribute of a control, or a joint.

    translation, rotation, scale: what the joint does from rest at a weight of 1, seen from its parent, in its
    own axes and along them.
    """

    target: str
    mesh: str = ""
    morph: str = ""
    control: str = ""
    attribute: str = ""
    joint: str = ""
    translation: Triple | None = None
    rotation: Quaternion | None = None
    scale: Triple | None = None


@dataclass(frozen=True, kw_only=True)
class ReplacedKeysRecord(Stored):
    """Keys of morph targets in a clip, from before a pose reader drove them.

    times: None where nothing drove the mesh. unlisted: those of the morphs that the clip had no word for.
    """

    clip: str
    mesh: str
    morphs: tuple[int, ...]
    interpolation: Literal["LINEAR", "STEP"] | None = None
    times: tuple[float, ...] | None = None
    values: tuple[tuple[float, ...], ...] | None = None
    unlisted: tuple[int, ...] = ()


@dataclass(frozen=True, kw_only=True)
class PoseReaderRecord(Record):
    """A pose-space driver: how much a joint is in each of some poses. inner, outer: in degrees.

    before: the keys that it has replaced, which strip restores.
    """

    type: ClassVar[str] = "poseReader"
    name: str
    driver: str
    frame: str
    axis: Triple
    reader: ReaderKind
    signed: bool = False
    inner: float | None = None
    outer: float | None = None
    kernel: Kernel | None = None
    mode: ReaderMode | None = None
    rest: Quaternion | None = None
    targets: tuple[TargetRecord, ...]
    outputs: tuple[OutputRecord, ...]
    within: float
    fps: float | None = None
    before: tuple[ReplacedKeysRecord, ...] = ()

    @classmethod
    def from_dict(cls, stored: Mapping[str, Any]) -> Self:
        found = super().from_dict(stored)
        return replace(found, problems=(*found.problems, *_target_problems(found), *_output_problems(found)))


@dataclass(frozen=True, kw_only=True)
class PoseWeightRecord(Record):
    """A node whose x is the weight of one target of a pose reader."""

    type: ClassVar[str] = "poseWeight"
    reader: str
    target: str
    control: str = ""
    attribute: str = ""


@dataclass(frozen=True, kw_only=True)
class RivetRecord(Record):
    """A node that follows a point of a mesh: barycentric coordinates in a triangle."""

    type: ClassVar[str] = "rivet"
    name: str
    mesh: str
    primitive: int
    vertices: tuple[int, ...]
    barycentric: Triple
    within: float
    fps: float | None = None


@dataclass(frozen=True, kw_only=True)
class InfluenceRecord(Stored):
    """How many joints each point of a mesh had room for, before its weights were split."""

    mesh: str
    count: int


@dataclass(frozen=True, kw_only=True)
class TwistRecord(Record):
    """A joint along a bone that takes a share of a twist.

    rest, standing: how the driver and the joint itself are turned without twist, where their rest pose has
    changed since.
    """

    type: ClassVar[str] = "twist"
    joint: str
    to: str
    driver: str
    number: int
    count: int
    at: float
    weight: float
    axis: Triple | None = None
    rest: Quaternion | None = None
    standing: Quaternion | None = None
    influences: tuple[InfluenceRecord, ...] = ()


RECORDS: Mapping[str, type[Record]] = {
    kind.type: kind
    for kind in (
        ConstraintRecord,
        ConstraintWeightRecord,
        ControlRecord,
        FrameRecord,
        GroupRecord,
        LimbRecord,
        OffsetRecord,
        PoleVectorRecord,
        PoseReaderRecord,
        PoseWeightRecord,
        RivetRecord,
        TwistRecord,
    )
}
# Types of nodes that are there only because rigtri has added them.
ADDED = frozenset(RECORDS) - {FrameRecord.type}
# Codes of warnings about what exporters drop of metadata; the file that was exported has it.
EXPORT_WARNINGS = ("note-damaged", "rest-lost")


Place = tuple[str | int, ...]


def with_references(stored: Any, change: Callable[[Place, str], str], place: Place = ()) -> Any:
    """Stored metadata with other addresses of nodes. place: the keys and numbers that lead to an address."""
    if isinstance(stored, str):
        key = next((step for step in reversed(place) if isinstance(step, str)), "")
        return change(place, stored) if key in REFERENCES and stored else stored
    if isinstance(stored, Mapping):
        return {key: with_references(value, change, (*place, key)) for key, value in stored.items()}
    if isinstance(stored, list):
        return [with_references(value, change, (*place, number)) for number, value in enumerate(stored)]
    return stored


def references(stored: Any) -> list[str]:
    """The addresses of nodes in stored metadata."""
    found: list[str] = []

    def collect(_: Place, name: str) -> str:
        found.append(name)
        return name

    with_references(stored, collect)
    return found


def kinds(record: type[Stored]) -> Mapping[str, Any]:
    """The annotations of what a record stores, by key."""
    return {key.name: key.kind for key in _keys(record)}


def illegible(stored: Mapping[str, Any]) -> str:
    """Why this version cannot read a record, which stays as it is then; "" where it can."""
    if stored.get("v") != VERSION or isinstance(stored["v"], bool):  # True equals 1
        return f"its version is {stored.get('v')!r:.60}, and this rigtri reads {VERSION}"
    kind = stored.get("type")
    known = isinstance(kind, str) and kind in RECORDS
    return "" if known else f"its type {kind!r:.60} is not one that this version of rigtri has"


def damage(stored: Mapping[str, Any]) -> str:
    """What of a record of this version cannot be used, in words; "" where all can."""
    return ", ".join(RECORDS[stored["type"]].from_dict(stored).problems)


def _target_problems(reader: PoseReaderRecord) -> tuple[str, ...]:
    """What is wrong with the targets of a pose reader, each of which is where it says that a joint goes."""
    if not reader.targets:
        return ("it has no targets",)
    if reader.reader == "rbf":
        lost = [one.name for one in reader.targets if one.rotation is None]
    else:
        lost = [one.name for one in reader.targets if one.direction is None and not one.node]
    what = "rotation" if reader.reader == "rbf" else "direction"
    return tuple(f"its target {name!r:.60} has no {what}" for name in lost)


def _output_problems(reader: PoseReaderRecord) -> tuple[str, ...]:
    """What is wrong with the outputs of a pose reader, each of which follows one of its targets."""
    names = {one.name for one in reader.targets}
    lost = dict.fromkeys(one.target for one in reader.outputs if one.target not in names)
    return tuple(f"it drives something by its target {name!r:.60}, which it does not have" for name in lost)


def _limb_problems(chain: Names) -> tuple[str, ...]:
    """What is wrong with the names of a limb's joints, of which there are three."""
    wrong = f"its chain does not name the three joints of its limb: {list(chain)!r:.60}"
    return () if len(chain) == 3 else (wrong,)


class _Key(NamedTuple):
    """One field of a record. read: gives a value of its kind, or None for what is none."""

    field: str
    name: str
    kind: Any
    read: Callable[[Any], Any]
    required: bool
    default: Any
    empty: Any


_KEYS: dict[type[Stored], tuple[_Key, ...]] = {}


def _keys(cls: type[Stored]) -> tuple[_Key, ...]:
    """The stored keys of a record, in the order of its fields."""
    if cls not in _KEYS:
        _KEYS[cls] = tuple(_keys_of(cls))
    return _KEYS[cls]


def _keys_of(cls: type[Stored]) -> list[_Key]:
    kinds, whole = get_type_hints(cls), get_type_hints(cls, include_extras=True)
    found = []
    for one in fields(cls):
        if one.name not in ("stored", "problems"):
            first, *rest = one.name.rstrip("_").split("_")
            name = first + "".join(word.capitalize() for word in rest)
            read, empty = _reader(kinds[one.name])
            required = one.default is MISSING
            found.append(_Key(one.name, name, whole[one.name], read, required, one.default, empty))
    return found


def _reader(kind: Any) -> tuple[Callable[[Any], Any], Any]:
    """What reads a stored value as a kind, None where it is of another; and an empty value of the kind."""
    if kind in _PLAIN:
        return _PLAIN[kind]
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Literal:
        return lambda value: value if isinstance(value, str) and value in inner else None, inner[0]
    if origin is tuple:
        read, _ = _reader(inner[0])
        count = None if inner[-1] is Ellipsis else len(inner)
        return lambda value: _tuple(value, read, count), () if count is None else (0.0,) * count
    if isinstance(kind, type):
        return lambda value: _nested(kind, value), None
    # A union: the first of its kinds that fits.
    readers = [_reader(one)[0] for one in inner if one is not type(None)]
    return lambda value: next((v for r in readers if (v := r(value)) is not None), None), None


def _tuple(value: Any, read: Callable[[Any], Any], count: int | None) -> tuple[Any, ...] | None:
    if not isinstance(value, list | tuple) or count not in (None, len(value)):
        return None
    items = tuple(map(read, value))
    return None if None in items else items


def _nested(kind: type[Stored], value: Any) -> Stored | None:
    found = kind.from_dict(value) if isinstance(value, Mapping) else None
    return None if found is None or found.problems else found


def _number(value: Any) -> float | None:
    """A finite number; larger ones than any file holds would overflow."""
    fits = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300
    return float(value) if fits else None


def _whole(value: Any) -> int | None:
    """A whole number, also as a float: USD's lists have floats alone. Larger ones fit no array, and count
    nothing that a file can hold."""
    found = _number(value)
    return int(value) if found is not None and abs(found) <= _MOST and value == value // 1 else None


_PLAIN: Mapping[Any, tuple[Callable[[Any], Any], Any]] = {
    str: (lambda value: value if isinstance(value, str) else None, ""),
    bool: (lambda value: value if isinstance(value, bool) else None, False),
    float: (_number, 0.0),
    int: (_whole, 0),
    Mapping[str, Any]: (lambda value: value if isinstance(value, Mapping) else None, {}),
}


def _plain(value: Any) -> Any:
    """A value as JSON has it."""
    if isinstance(value, Stored):
        return value.to_dict()
    return [_plain(item) for item in value] if isinstance(value, tuple) else value
