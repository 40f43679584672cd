"""The options of orient-joints."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, Literal, get_args

from rigtri.errors import UsageError
from rigtri.frames import Mirror, Plane
from rigtri.limits import TOLERANCE
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import Root, Tolerance
from rigtri.model.options import Kind, option, refuse
from rigtri.operations.axis_presets import AXES, AxisStyle, preset_style
from rigtri.operations.option_kinds import (
    Axis,
    Below,
    BodySide,
    Facing,
    JsonFile,
    Limbs,
    Names,
    Node,
    Nodes,
    OnConstraint,
    OneCharacter,
    OnNonuniformScale,
    ReadPose,
    RigFile,
    Selection,
    SignedAxis,
    Skin,
    StandardPose,
    Vector,
    WorldPlane,
    three,
)
from rigtri.operations.options import axes

Branch = Literal["chain", "first", "average", "longest", "incoming", "keep"]
BRANCHES: tuple[Branch, ...] = get_args(Branch)
End = Literal["tip", "parent", "incoming", "keep", "world"]
# What is said of bones and limbs, which axes parallel to the world do not look at.
_OF_BONES = ("aim_at", "branch", "end", "per_joint_plane", "facing")
# Options that say where axes go, which frames from elsewhere have said already.
_GEOMETRY = ("preset", *AXES, *_OF_BONES, "world", "standard_pose")


def _degrees(text: str) -> Vector:
    """Three angles with commas between. ValueError for anything else."""
    with suppress(ValueError):
        angles = three(text)
        if all(abs(angle) <= 360 for angle in angles):
            return angles
    raise ValueError("give three angles in degrees, e.g. 0,0,90")


@dataclass(frozen=True)
class StyledChain:
    """A chain of joints and, where given, the axes that are for it alone."""

    start: Node
    end: Node
    aim: SignedAxis | None = None
    up: SignedAxis | None = None
    up_from: str | None = None

    def style(self, base: AxisStyle) -> AxisStyle:
        """The chain's axes over those of all joints."""
        return base.with_axes(self)


def _chains(_flag: str, chains: Iterable[Any]) -> tuple[StyledChain, ...]:
    """Chains from pairs of names, mappings, or what has the fields of one."""
    names = ("start", "end", *AXES)
    return tuple(
        StyledChain(*chain)
        if isinstance(chain, tuple)
        else StyledChain(**(chain if isinstance(chain, dict) else {n: getattr(chain, n) for n in names}))
        for chain in chains
    )


@dataclass(frozen=True)
class OrientJointsOptions(OneCharacter):
    """Options of orient-joints.

    keep: joints have their axes already; only ``mirror`` re-orients those of the other side. plane: of the
    character's own space; across: the same in the world, where that is known already.
    """

    preset: str | None = axes.preset()
    aim: Axis | None = axes.aim()
    up: Axis | None = axes.up()
    up_from: str | None = axes.up_from()
    joints: Nodes = option((), help="Re-orient these joints. Repeatable.")
    chain: Annotated[
        tuple[StyledChain | tuple[str, str], ...],
        Kind("styled chains", "START END", read=_chains, group="joints"),
    ] = option(
        (),
        help="Re-orient this chain: its start and end, or a mapping with these and --aim, --up or --up-from "
        "for it alone. Repeatable.",
    )
    below: Below = option((), help="Re-orient this joint and all below it.")
    skin: Skin | None = option(None, rare=True)
    exclude: Nodes = option((), help="Leave these joints as they are.")
    aim_at: Annotated[tuple[tuple[str, str] | str, ...], Kind("node to node", "JOINT=NODE")] = option(
        (),
        help="Aim a joint or any other node at a node, even if it is not selected. Repeatable.",
        rare=True,
    )
    limb: Limbs = option(
        (), help="Three joints that bend as one limb and share its hinge. Repeatable.", rare=True
    )
    branch: Names = option(
        (),
        metavar="RULE",
        group="how",
        help="What a joint with several children aims at. [chain]",
        values={
            "chain": "the child that continues the chain; else as average, or incoming if they part widely",
            "first": "the first child in the file, as Maya",
            "average": "the middle of all children, as Houdini",
            "longest": "the child that is farthest away",
            "incoming": "straight on along the bone that ends here",
            "keep": "leaves the joint as it is",
            "NAME": "the child of this name; repeatable",
        },
    )
    end: End = option(
        "tip",
        help="What a joint without children aims at.",
        values={
            "tip": "its leaf node, such as hand_end; without one a foot aims ahead, others as parent",
            "parent": "has the axes of the joint above",
            "incoming": "straight on along the bone that ends here",
            "keep": "leaves the joint as it is",
            "world": "parallel to the world",
        },
    )
    per_joint_plane: bool = option(False, help="Give each joint its own bend plane, for S-bends.", rare=True)
    facing: Facing | None = option(None)
    pose: ReadPose | None = option(
        None,
        help="The pose that positions are read from. [bind where one skin holds the chain, else nodes]",
        rare=True,
    )
    world: bool = option(False, help="Make every frame parallel to the world.", group="what", rare=True)
    standard_pose: StandardPose | None = option(
        None,
        help="Aim joints as the bones of a standard skeleton do, for a recognised body in this pose.",
        values={
            "tpose": "arms to the side",
            "apose": "arms 45° down",
            "godot": "arms to the side; with --preset blender the axes of SkeletonProfileHumanoid",
        },
        rare=True,
    )
    on_nonuniform_scale: OnNonuniformScale = option("snap", rare=True)
    on_constraint: OnConstraint = option("freeze", rare=True)
    snap: bool = option(False, help="Rotate only to the nearest cardinal axes.", rare=True)
    offset: Annotated[Vector, Kind("point", "X,Y,Z", parse=_degrees)] = option(
        (0.0, 0.0, 0.0),
        help="Afterwards rotate about the new axes, in degrees: X, then Y, then Z.",
        rare=True,
    )
    mirror: Mirror | None = option(
        None, help="Give the other side the mirrored axes of --from-side.", values=axes.MIRRORED, rare=True
    )
    from_side: BodySide = option(
        "left", help="With --mirror: the side that is copied onto the other.", rare=True
    )
    plane: Plane | None = option(None, help=axes.BETWEEN_SIDES, rare=True)
    like: RigFile = option(
        None,
        excludes=["frames"],
        help="Give each joint the axes of its namesake in FILE's bind pose.",
        group="what",
    )
    frames: JsonFile = option(
        None, help="Apply the changes of a --save-frames file.", group="what", rare=True
    )
    inverse: bool = option(False, help="With --frames: undo them.", group="what", rare=True)
    root: Root | None = option(None, where="shared")
    tolerance: Tolerance = option(TOLERANCE, where="shared")
    keep: bool = option(False, where="python", help="Only `mirror` re-orients, from axes as they are.")
    across: WorldPlane = option(None, where="python")

    def check(self, given: Collection[str]) -> None:
        """UsageError for options that contradict each other, and for letters that make no frame."""
        elsewhere = self.frames is not None or self.like is not None
        if self.inverse and self.frames is None:
            raise UsageError("--inverse goes with --frames")
        if self.mirror and elsewhere:
            raise UsageError("--mirror does not go with --like or --frames")
        if not self.mirror:
            refuse(given, ["from_side", "plane"], "goes with --mirror")
        if self.frames is not None:
            refuse(given, [*_GEOMETRY, "offset", "snap"], "does not go with --frames")
        if self.like is not None:
            refuse(given, _GEOMETRY, "does not go with --like")
        if self.world or self.preset == "vrm":
            of_bones = [name for name in _OF_BONES if name != "facing" or self.standard_pose is None]
            refuse(given, [*AXES, *of_bones], "does not go with axes parallel to the world")
        if self.world and self.preset not in (None, "vrm"):
            raise UsageError("give --preset or --world, not both")
        if sum(word in BRANCHES for word in self.branch) > 1:
            raise UsageError("give one rule with --branch, and any number of names of children")
        for style in (self.style, *(style for _, _, style in self.chain_styles)):
            style.checked()

    @cached_property
    def style(self) -> AxisStyle:
        """The axes of all joints that have none of their own."""
        base = preset_style(self.preset).with_axes(self)
        return replace(base, world=base.world or self.world)

    @cached_property
    def chain_styles(self) -> tuple[tuple[str, str, AxisStyle], ...]:
        """The chains, from where to where, with their axes."""
        return tuple((chain.start, chain.end, chain.style(self.style)) for chain in _chains("", self.chain))

    @cached_property
    def own_planes(self) -> tuple[tuple[str, str], ...]:
        """The chains, from where to where, that get the plane of their own bones by the user's word."""
        chains = _chains("", self.chain)
        return tuple((k.start, k.end) for k in chains if (k.up_from or "").lower() == "plane")

    @cached_property
    def selection(self) -> Selection:
        """The joints that are named, besides those of chains."""
        return Selection(joints=self.joints, below=self.below, skin=self.skin, exclude=self.exclude)

    @property
    def branch_rule(self) -> Branch:
        """What a joint with several children aims at, where none of them is named."""
        return next((rule for rule in BRANCHES if rule in self.branch), "chain")

    @property
    def branch_to(self) -> tuple[str, ...]:
        """The children that are named."""
        return tuple(word for word in self.branch if word not in BRANCHES)
