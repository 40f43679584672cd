"""The options of constrain."""

from __future__ import annotations

from collections.abc import Collection
from math import isfinite, sqrt
from typing import Annotated, Literal

from rigtri.errors import UsageError
from rigtri.limits import refuse_unworkable
from rigtri.maths import RotateOrder
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import CHANNELS, ROTATION, SCALE, TRANSLATION, ConstraintKind, WorldUp
from rigtri.model.options import Kind, option, refuse
from rigtri.operations.option_kinds import (
    CoordinateAxis,
    Direction,
    JsonFile,
    LimbNames,
    Node,
    OneCharacter,
    Vector,
    three,
)

OrientWord = Literal["rest", "none"]
_THREE = {"t": TRANSLATION, "r": ROTATION, "s": SCALE}
_AIM_ONLY = ("aim_axis", "up_axis", "world_up", "up_vector", "up_object")
_ROTATION_ONLY = ("rotate_order", "joint_orient")
# Axes whose cross product is shorter lie on one line.
_PARALLEL = 1e-6


def _skip(_flag: str, text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.lower().split(",")) if text else ()


def joint_orient(text: str) -> OrientWord | Vector:
    """``rest``, ``none`` or three degrees with commas between. ValueError for anything else."""
    if text.lower() in ("rest", "none"):
        return "rest" if text.lower() == "rest" else "none"
    try:
        angles = three(text)
    except ValueError:
        raise ValueError(f"'{text}': give rest, none or X,Y,Z in degrees") from None
    if not all(abs(part) < 1e6 for part in angles):
        raise ValueError(f"'{text}': angles are degrees below a million")
    return angles


# NODE=WEIGHT, where the name may hold ``=`` too: only the rig can tell them apart. Python may give pairs.
Drivers = Annotated[tuple[tuple[str, float] | str, ...], Kind("of nodes", "NODE[=WEIGHT]", group="joints")]
Spaces = Annotated[tuple[str, ...], Kind("names", "world|root|NODE", group="joints")]
Switches = Annotated[tuple[str, ...], Kind("names", "CLIP@TIME=NODE")]
Channels = Annotated[tuple[str, ...], Kind("joined", "tx,ty,…", read=_skip)]
JointOrient = Annotated[OrientWord | Vector, Kind("joint orient", "rest|none|X,Y,Z", parse=joint_orient)]


@dataclass(frozen=True, kw_only=True)
class ConstrainOptions(OneCharacter):
    """Options of constrain.

    driver: nodes, in Python also pairs of node and weight. joint_orient: three angles are degrees about
    x, then y, then z.
    """

    type: ConstraintKind = option(
        "parent",
        help="What the child takes over.",
        values={
            "parent": "position and axes, as if it were a child",
            "point": "the position",
            "orient": "the axes",
            "scale": "the scale",
            "aim": "points an axis at the driver",
            "polevector": "the driver says which way a limb bends",
        },
        group="what",
    )
    child: Node | None = option(None, help="The node that follows; for polevector any joint of the limb.")
    driver: Drivers = option((), help="A node that it follows. Repeatable; the ratio of the weights counts.")
    space: Spaces = option(
        (),
        help="A space that the child, or the offset of a control, can follow: world, root (the root "
        "control) or a node. Repeatable; clips switch between them, and the first counts at rest.",
        excludes=["driver"],
    )
    switch: Switches = option(
        (),
        help="From this moment of a clip on (seconds, USD: time codes), only this driver or space counts. "
        "Repeatable.",
    )
    weight_keys: JsonFile = option(
        None,
        metavar="FILE",
        help="Weights in clips: JSON {CLIP: {times: [...], NODE: [...], interpolation: STEP or LINEAR}}, or "
        "CSV with the columns clip, time, each NODE, and interpolation.",
        group="how",
    )
    weight_from: Switches = option(
        (),
        help="Take the weight of a driver from a channel of a node (tx … sz) in every clip. The first "
        "driver without a channel gets the rest of 1.",
        metavar="DRIVER=NODE.CHANNEL",
        rare=True,
    )
    match: bool = option(
        False,
        help="Where a driver takes over in a clip, let the child follow it from where it is, without a jump.",
        group="how",
    )
    skip: Channels = option(
        (), help="Channels that stay the child's own: tx, ty, tz, rx … sz, or t, r, s for three.", group="how"
    )
    maintain_offset: bool = option(
        True,
        help="Maintain the offset between each driver and the child, or take over the driver's transform.",
    )
    rotate_order: RotateOrder = option(
        "xyz", help="Euler order of rx, ry and rz in --skip and in the report.", rare=True
    )
    joint_orient: JointOrient = option(
        "rest",
        help="Joint orient, applied after the rotation, as Maya's (degrees, about x, y, z).",
        rare=True,
    )
    driver_space: Literal["world", "local"] = option(
        "world",
        help="orient: which rotation of the driver the child follows.",
        values={
            "world": "its axes in the world",
            "local": "its rotation from rest, in its own axes",
        },
        rare=True,
    )
    roll_axis: CoordinateAxis | None = option(
        None, help="orient: follow only the roll about this axis of the child.", rare=True
    )
    aim_axis: Direction = option(
        (1.0, 0.0, 0.0), help="aim: the axis of the child that points at the driver.", rare=True
    )
    up_axis: Direction = option(
        (0.0, 1.0, 0.0), help="aim: the axis of the child that aligns with --world-up.", rare=True
    )
    world_up: WorldUp = option(
        "vector",
        help="aim: what the up axis aligns with.",
        values={
            "vector": "a direction of the world",
            "object": "a node's position",
            "objectrotation": "a node's axis",
            "none": "nothing: the least rotation",
        },
        rare=True,
    )
    up_vector: Direction | None = option(
        None,
        help="With --world-up vector: the direction of the world; with objectrotation: the axis of the "
        "node. [the file's up]",
        rare=True,
    )
    up_object: Node | None = option(
        None, help="With --world-up object or objectrotation: the node.", rare=True, group="how"
    )
    limb: LimbNames | None = option(None, help="polevector: the limb that bends towards the driver.")
    vrm_constraints: bool = option(
        False,
        help="glTF: also write a VRMC_node_constraint where it means the same, so that VRM viewers move "
        "the child.",
        group="output",
        rare=True,
    )

    @property
    def skipped(self) -> frozenset[str]:
        """The channels to skip, one by one."""
        return frozenset(c for channel in self.skip for c in _THREE.get(channel, (channel,)))

    def check(self, given: Collection[str]) -> None:
        """UsageError for what makes no constraint, and for options that this type gives no meaning to."""
        if self.type != "aim":
            refuse(given, _AIM_ONLY, f"means nothing for --type {self.type}")
        if self.type not in ("parent", "orient", "aim"):
            words = f"means nothing for --type {self.type}, which does not rotate its child"
            refuse(given, _ROTATION_ONLY, words)
        if self.world_up == "none":
            refuse(given, ["up_axis"], "means nothing with --world-up none")
        if not (self.driver or self.space):
            raise UsageError("name what the child follows: --driver NODE, or --space NODE, repeatable")
        self._check_switching()
        for pair in self.driver:
            if not isinstance(pair, str):
                check_weight(*pair)
        self._check_skip()
        self._check_orient()
        if self.type == "aim":
            self._check_aim()
        if self.limb is not None and self.type != "polevector":
            raise UsageError("--limb is for --type polevector")
        if not self.child and self.limb is None:
            raise UsageError("name the node that follows: --child NODE")

    @property
    def switches(self) -> bool:
        """Whether clips can have keys of the weights."""
        return (
            bool(self.space or self.switch or self.weight_from or self.match) or self.weight_keys is not None
        )

    def _check_switching(self) -> None:
        old = next((word for word in self.space if word == "local"), None)
        if old is not None and self.type == "orient":
            raise UsageError("--space local is now --driver-space local")
        if len(set(self.space)) < len(self.space):
            raise UsageError("a space is named twice")
        if self.space and self.type not in ("parent", "point", "orient", "scale"):
            raise UsageError(f"--space means nothing for --type {self.type}; give --driver and --switch")
        compares = self.driver_space != "world" or self.roll_axis
        if self.match and (self.type in ("aim", "polevector") or compares):
            raise UsageError("--match is for what follows its drivers' places, axes or scale in the world")
        if self.switches and self.vrm_constraints:
            raise UsageError("--vrm-constraints: VRM node constraints have one driver, and no switch")

    def _check_skip(self) -> None:
        known = CHANNELS[self.type]
        for channel in sorted(self.skipped):
            if channel not in CHANNELS["parent"]:
                raise UsageError(f"--skip {channel}: the channels are tx, ty, tz, rx … sz, or t, r, s")
            if channel not in known:
                raise UsageError(f"--skip {channel}: --type {self.type} does not set it")
        if known and self.skipped >= set(known):
            raise UsageError("--skip leaves nothing that the constraint would set")

    def _check_orient(self) -> None:
        local = self.driver_space == "local"
        if self.type != "orient" and (self.roll_axis or local):
            raise UsageError("--driver-space and --roll-axis are for --type orient")
        if self.roll_axis and local:
            raise UsageError("--roll-axis compares what the two parents see; leave --driver-space out")
        if (self.roll_axis or local) and self.skipped:
            raise UsageError("--skip is for rotations in the world; leave out --driver-space and --roll-axis")
        if self.roll_axis and not self.maintain_offset:
            raise UsageError("a roll is counted from rest, so --roll-axis always keeps the offset")

    def _check_aim(self) -> None:
        if self.up_vector is not None and self.world_up not in ("vector", "objectrotation"):
            raise UsageError(f"--up-vector means nothing with --world-up {self.world_up}")
        if self.world_up != "none" and _on_one_line(self.aim_axis, self.up_axis):
            raise UsageError("--aim-axis and --up-axis lie on one line; name two different axes")
        if (self.world_up in ("object", "objectrotation")) != (self.up_object is not None):
            raise UsageError("--up-object goes with --world-up object or objectrotation, and they with it")


def check_weight(name: str, weight: float) -> None:
    """UsageError for a weight of a driver that is none."""
    if not (isfinite(weight) and weight >= 0):
        raise UsageError(f"--driver {name}: the weight {weight:g} is not valid: use a number from 0 on")
    refuse_unworkable(f"--driver {name}", weight)


def _on_one_line(a: Vector, b: Vector) -> bool:
    across = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    of_a, of_b, sine = (sqrt(x * x + y * y + z * z) for x, y, z in (a, b, across))
    return sine < _PARALLEL * of_a * of_b
