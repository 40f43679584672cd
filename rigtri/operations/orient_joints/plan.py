"""The plan of orient-joints: the options, and for each joint the turn that it should take."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from rigtri.errors import FileError, UsageError
from rigtri.frames.error_bounds import LeverArm
from rigtri.frames.mirror_plane import parting
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.scale_tolerance import same_scales, ties
from rigtri.frames.skeleton import ReferencePose, Skeleton, reference, skeleton
from rigtri.maths.matrices import transform_directions
from rigtri.maths.quaternions import IDENTITY, from_axes, from_axis_angle, multiply, to_axes
from rigtri.maths.triangle import DEGENERATE_SINE, axis_of, frame
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, length, normalise
from rigtri.model.bindings import NodeConstraint
from rigtri.model.rig import Rig
from rigtri.operations.aim_targets import Aim, Rules, aim_of, limb_children
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.joint_selection import Selection, select
from rigtri.operations.options.orient_joints import OrientJointsOptions as OrientJointsOptions
from rigtri.operations.orient_joints.frame_sources import like_turns, mirrored_turns, stored_turns, turn_onto
from rigtri.operations.orient_joints.scale_policy import axes_taken, nearest_cardinal
from rigtri.operations.orient_joints.up_direction import Hinges, Up, carried, crossing, stated
from rigtri.recognition.limbs import Limb, along, named_limbs, with_recognised
from rigtri.report import Report

# A joint that would turn by less than this (radians) is left bit-exact: float32 storage
# re-derives frames with up to this much noise (docs/exactness.md).
UNCHANGED = 2e-6
# … plus this over |sin bend| about the aim axis, where up comes from a plane.
UNCHANGED_PLANE = 2e-7
# However poor the positions are, a turn of more than this (0.06°) is meant.
MOST_NOISE = 1e-3
_AXES = np.eye(3)
# Axes copied from a file (--like) hold no positions: only the rounding of rotations.
UNCHANGED_LIKE = 5e-7


@dataclass(eq=False)
class Plan:
    """One run: what turns, where it aims, and what was decided for each joint.

    ups: what told the up direction of each joint; normals: the same before ``pole`` turns
    it; follows: joints that take the turn of another; straight: limbs and chains without a
    plane; noise: radians per joint that mean nothing.
    """

    tree: Skeleton
    ref: ReferencePose
    options: OrientJointsOptions
    report: Report
    turning: list[int]
    kept: dict[int, str]
    aims: dict[int, Aim]
    limbs: tuple[Limb, ...]
    styles: dict[int, AxisStyle] = field(default_factory=dict)
    ups: dict[int, Up] = field(default_factory=dict)
    normals: dict[int, Up] = field(default_factory=dict)  # before `pole` turns them
    noise: dict[int, float] = field(default_factory=dict)
    follows: dict[int, int] = field(default_factory=dict)
    straight: dict[int, tuple[str, float]] = field(default_factory=dict)

    @staticmethod
    def of(rig: Rig, options: OrientJointsOptions, report: Report) -> Plan:
        # Frames from elsewhere name their joints: all that match are meant, with or without a skin.
        elsewhere = options.like is not None or options.frames is not None
        tree = skeleton(rig, options.root, plain=elsewhere, joints=rig.rules.world_aligned)
        ref = reference(tree, "nodes" if rig.rules.world_aligned else options.pose)
        selection = options.selection
        chains = tuple((start, end) for start, end, _ in options.chain_styles)
        selection = replace(selection, chains=(*selection.chains, *chains))
        everything = elsewhere or options.root is not None or bool(rig.rules.world_aligned)
        turning, kept = select(tree, ref, selection, all_named=everything)
        styles = {}
        for start, end, style in options.chain_styles:
            for joint in along(rig, rig.find(start), rig.find(end)):
                styles[joint] = style
        limbs = with_recognised(rig, tuple(named_limbs(rig, options.limb)))
        rules = Rules(
            options.branch_rule,
            tuple(rig.find(name) for name in options.branch_to),
            options.end,
            {rig.find(a): rig.find(b, "node") for a, b in (_pair(rig, one) for one in options.aim_at)},
            limb_children(tree, limbs),
        )
        if rig.rules.orient_locked:  # names that are not there have been told by now
            _check_parallel(rig, options)
        aims = {joint: aim_of(tree, ref, joint, rules) for joint in turning}
        return Plan(tree, ref, options, report, turning, kept, aims, limbs, styles)

    def style(self, joint: int) -> AxisStyle:
        return self.styles.get(joint, self.options.style)

    def wanted(self) -> dict[int, Floats]:
        """The turn that each joint should take, identity where it already stands so."""
        options, rig = self.options, self.tree.rig
        if options.frames is not None:  # applied as they are, however small
            stored, undo = options.frames, options.inverse
            return stored_turns(rig, self.turning, stored, inverted=undo, report=self.report)
        if options.keep:
            turns = dict.fromkeys(self.turning, IDENTITY)
        elif options.like is not None:
            turns = like_turns(self.tree, self.ref, self.turning, options.like, self.report)
        else:
            turns = self._oriented()
        turns = {joint: self._finished(joint, turn) for joint, turn in turns.items()}
        if options.mirror is not None:
            turns |= mirrored_turns(
                self.tree,
                self.ref,
                turns,
                self._onto,
                mirror=options.mirror,
                from_side=options.from_side,
                across=options.across
                or parting(self.tree, self.ref, options.plane, options.from_side).across,
                report=self.report,
            )
        return {joint: self.quiet(joint, turn) for joint, turn in turns.items()}

    def _finished(self, joint: int, turn: Floats) -> Floats:
        """``--snap`` and ``--offset``: after everything else."""
        if self.options.snap:
            turn = nearest_cardinal(turn)
        for axis, angle_ in zip(_AXES, self.options.offset, strict=True):
            if angle_:
                turn = multiply(turn, from_axis_angle(axis, angle_ * (np.pi / 180.0)))
        return turn

    def quiet(self, joint: int, turn: Floats) -> Floats:
        """Exactly the identity for a turn that is no more than the noise of storage."""
        x, y, z, _ = turn.tolist()
        angle = 2.0 * float(np.sqrt(x * x + y * y + z * z))  # where it is small enough to matter
        if self.options.like is not None:
            return IDENTITY if angle <= UNCHANGED_LIKE else turn
        limit = self._least(joint) + self.noise.get(joint, 0.0)
        limit = min(limit + self._position_noise(joint), MOST_NOISE)
        return IDENTITY if angle <= limit else turn

    def _least(self, joint: int) -> float:
        """The turn that means nothing: float32 rounding, and scale noise that passes as uniform."""
        return UNCHANGED + float(self.scale_noise[joint])

    @cached_property
    def scales(self) -> ScaleTable:
        """Every scale of the rig, at rest and at keys."""
        rig, scales = self.tree.rig, ScaleTable.of(self.tree.rig)
        return replace(scales, same=same_scales(rig, self.tree.joints, scales, *self._faults))

    @cached_property
    def _faults(self) -> tuple[LeverArm, float]:
        """What says how much a small fault of a joint moves, and how much it may."""
        return LeverArm(self.tree.rig), self.options.tolerance

    @cached_property
    def ties(self) -> tuple[NodeConstraint, ...]:
        """Joints that must turn as their parents do, for their rotations are not unit."""
        return ties(self.tree.rig, *self._faults)

    @cached_property
    def unsplittable(self) -> frozenset[int]:
        """Nodes whose own rotation a constraint reads or writes, or is not unit: it must stay with them."""
        constraints = self.tree.rig.node_constraints
        read = {k for c in constraints for k in (c.node, c.source) if c.kind != "aim" or k == c.node}
        return frozenset(read | {tie.node for tie in self.ties})

    @cached_property
    def scale_noise(self) -> Floats:
        """How far apart components that count as equal are in each node and those above it, (n,)."""
        noise = self.scales.noise
        for level in self.tree.rig.levels[1:]:
            noise[level] = np.maximum(noise[level], noise[self.tree.rig.parents[level]])
        return noise

    def _position_noise(self, joint: int) -> float:
        """What float32 positions (inverse binds) leave uncertain about a bone's direction, in radians."""
        bone = self.aims[joint].length if joint in self.aims else 0.0
        return self.ref.rounding * self.ref.extent / max(bone, 1e-3 * self.ref.extent, 1e-30)

    def _plane_noise(self, joint: int) -> float:
        """The same of the plane that tells its up direction: the shortest bone beside it tells it worst."""
        above = self.tree.above[joint]
        around = {joint, above, self.tree.above.get(above, -1), self.aims[joint].node}
        known = [k for k in around if k in self.aims and self.aims[k].length > 0]
        return max((self._position_noise(k) for k in known), default=0.0)

    def _oriented(self) -> dict[int, Floats]:
        hinges = Hinges(
            self.tree,
            self.ref,
            self.aims,
            self.limbs,
            _facing(self.tree.rig, self.options),
            self.options.per_joint_plane,
            self.report,
        )
        hinges.collect()
        turns: dict[int, Floats] = {}
        late = {joint: None for joint in self.turning if self.style(joint).up_from == "child"}
        # An end joint that copies its parent comes after it, whichever way the others are taken.
        copies = {joint: None for joint in self.turning if self.aims[joint].how == "parent"}
        first = [joint for joint in self.turning if joint not in late and joint not in copies]
        order = (*first, *reversed([j for j in late if j not in copies]), *copies)
        if any(self.style(joint).up_from in ("parent", "child") for joint in first):
            for joint in order:
                turns |= self._turns([joint], hinges, turns)
        else:  # no joint asks for the new axes of another but those that copy them
            turns = self._turns(first, hinges, turns)
            after = order[len(first) :]
            while after:  # all at once but those that copy one that is still to come
                left = set(after)
                ready = [joint for joint in after if joint in copies and self.tree.above[joint] not in left]
                now = ready if after[0] in copies else [after[0]]
                turns |= self._turns(now, hinges, turns)
                left.difference_update(now)
                after = tuple(joint for joint in after if joint in left)
        self.straight = hinges.straight
        return turns

    @cached_property
    def bones(self) -> dict[int, Floats]:
        """The direction in the world, (3,), of each bone that has one."""
        joints = [joint for joint, aim in self.aims.items() if aim.direction is not None]
        if not joints:
            return {}
        seen = np.stack([self.aims[joint].direction for joint in joints])  # type: ignore[misc]
        return dict(zip(joints, normalise(transform_directions(seen, self.ref.world[joints])), strict=True))

    def _turns(self, joints: list[int], hinges: Hinges, turns: dict[int, Floats]) -> dict[int, Floats]:
        """The turns of joints that do not ask for each other's; ``turns`` are those found before."""
        found: dict[int, Floats] = {}
        aimed, copying = [], []
        for joint in joints:
            aim = self.aims[joint]
            if self.style(joint).world or aim.how == "world":
                found[joint] = self._onto(joint, np.eye(3))
            elif aim.how == "keep":
                found[joint] = IDENTITY
            elif aim.how == "parent":
                copying.append(joint)
            else:
                self.ups[joint] = self._up(joint, self.bones[joint], hinges, turns)
                aimed.append(joint)
        for style in dict.fromkeys(self.style(joint) for joint in aimed):
            found |= self._framed([joint for joint in aimed if self.style(joint) == style], style)
        for style in dict.fromkeys(self.style(joint) for joint in copying):
            found |= self._copied([joint for joint in copying if self.style(joint) == style], style, turns)
        return found

    def _copied(self, joints: list[int], style: AxisStyle, turns: dict[int, Floats]) -> dict[int, Floats]:
        """The turns onto the new axes of the joints above."""
        above = [self.tree.above[joint] for joint in joints]
        for joint, parent in zip(joints, above, strict=True):
            if parent in self.noise:
                self.noise[joint] = self.noise[parent]
        found = turn_onto(self._axes(above, turns), self.ref, joints, style.aim, style.up)
        return dict(zip(joints, found, strict=True))

    def _onto(self, joint: int, world_axes: Floats) -> Floats:
        """The turn of a joint onto axes of the world (rows), of which it keeps its aim and up."""
        style = self.style(joint)
        return np.asarray(turn_onto(world_axes[np.newaxis], self.ref, [joint], style.aim, style.up)[0])

    def _framed(self, joints: list[int], style: AxisStyle) -> dict[int, Floats]:
        """The turns onto aim and up direction, and what noise of them is to be expected."""
        up = np.stack([self.ups[joint].vector for joint in joints])
        bones = np.stack([self.bones[joint] for joint in joints])
        # A direction near the bone tells the roll badly: its noise grows with 1/sine.
        spread = np.maximum(length(cross(normalise(up), bones)), DEGENERATE_SINE)
        for joint, sine in zip(joints, spread.tolist(), strict=True):
            least = self._least(joint)
            self.noise[joint] = least / sine - least
            if self.ups[joint].step >= 2:
                of_plane = UNCHANGED_PLANE + self._plane_noise(joint)
                self.noise[joint] += of_plane / max(self.ups[joint].sine, DEGENERATE_SINE)
        aims = np.stack([self.aims[joint].direction for joint in joints])  # type: ignore[misc]
        seen = transform_directions(up, self.ref.inverse[joints])
        axes = frame(aims, seen, aim_axis=style.aim, up_axis=style.up)
        return dict(zip(joints, from_axes(axes), strict=True))

    def _axes(self, joints: list[int], turns: dict[int, Floats]) -> Floats:
        """The world axes (rows) that joints will have, (j, 3, 3)."""
        axes = to_axes(np.stack([self.quiet(joint, turns.get(joint, IDENTITY)) for joint in joints]))
        for row, joint in enumerate(joints):
            if not self.scales.uneven[joint] or joint in self.tree.rig.frame_of or joint not in turns:
                continue
            style, policy = self.style(joint), self.options.on_nonuniform_scale
            if policy == "split" and joint in self.unsplittable:
                policy = "skip"
            kept = axis_of(style.aim)[0], axis_of(style.up)[0]
            axes[row] = axes_taken(axes[row], policy, kept, self.scales, joint)
        return normalise(transform_directions(axes, self.ref.world[joints][:, np.newaxis]))

    def _up(self, joint: int, bone: Floats, hinges: Hinges, turns: dict[int, Floats]) -> Up:
        """The up direction in the world by the ladder; for ``pole`` already turned to the bend's side."""
        style = self.style(joint)
        source = stated(self.tree, self.ref, joint, style.up_from, style.up)
        if style.up_from in ("parent", "child"):
            source = self._relative(joint, style, turns)
        if source is not None and crossing(source, bone):
            return Up(source, 1, style.up_from)
        above = self.tree.above[joint]

        def before() -> Up | None:
            if above not in self.ups or self.ups[above].step < 2:
                return None
            normal = hinges.found.get(above) or self.normals.get(above)
            return carried(normal, self.bones[above], bone) if normal else None

        # After an offset or a snap the present axis is not the one that a run before has found.
        present = not any(self.options.offset) and not self.options.snap
        up = hinges.normal(joint, bone, style.up, before, present=present)
        self.normals[joint] = up
        if style.up_from != "plane" and source is not None:
            name = self.tree.rig.title(joint)
            self.report.warn(
                "up-parallel",
                f"'{name}': {style.up_from} runs along the bone; up is taken from: {up.source}.",
                joint=name,
                geometry=True,
            )
        if style.up_from == "pole" and up.step == 8:
            # The present axis is an up direction already, not a normal.
            self.normals[joint] = replace(up, vector=cross(up.vector, bone))
        elif style.up_from == "pole":
            return replace(up, vector=cross(bone, up.vector))
        return up

    def _relative(self, joint: int, style: AxisStyle, turns: dict[int, Floats]) -> Floats | None:
        letter, sign = axis_of(style.up)
        if style.up_from == "parent":
            other: int | None = self.tree.above[joint]
        else:
            other = self.aims[joint].node
            if other not in self.tree.above:
                other = next(iter(self.tree.below[joint]), None)
        if other in self.aims and self.aims[other].how == "parent" and style.up_from == "child":
            other = None  # it copies this joint, so it has nothing to say
        if other is None or other < 0:
            return np.asarray(self.ref.world[joint, letter, :3] * sign)
        return np.asarray(self._axes([other], turns)[0, letter] * sign)


def _check_parallel(rig: Rig, options: OrientJointsOptions) -> None:
    """Let nothing through but zero rotations on every bone, where a format asks for that.

    Raises FileError for axes of any other kind, UsageError for a part of the joints.
    """
    style = options.style.world and all(style.world for _, _, style in options.chain_styles)
    elsewhere = options.like is not None or options.frames is not None or options.mirror is not None
    if not rig.rules.world_aligned or not style or elsewhere or options.snap or any(options.offset):
        raise FileError(
            f"No joint of this file may have axes of its own: {rig.rules.orient_locked}. Take --world, "
            "which makes all of them zero, or convert the file to VRM 1.0 first."
        )
    if options.selection != Selection() or options.chain_styles or options.root is not None:
        raise UsageError(f"{rig.rules.orient_locked}, so --world is for all joints of this file: name none")
    if options.pose not in (None, "nodes"):
        raise UsageError(
            f"--pose {options.pose}: {rig.rules.orient_locked}; rotations are zero in the pose of the nodes"
        )


def _facing(rig: Rig, options: OrientJointsOptions) -> Floats | None:
    facing = options.facing if options.facing is not None else rig.rules.facing
    if facing is None:
        return None
    direction = np.asarray(facing, dtype=np.float64)
    if not direction.any() or not np.isfinite(direction).all():
        raise UsageError(f"--facing {facing} is no direction")
    return direction


def _pair(rig: Rig, aim_at: tuple[str, str] | str) -> tuple[str, str]:
    """JOINT=NODE; names may hold ``=`` themselves, so the cut is where both sides are found."""
    if not isinstance(aim_at, str):
        return aim_at
    cuts = [k for k, letter in enumerate(aim_at) if letter == "=" and 0 < k < len(aim_at) - 1]
    if not cuts:
        raise UsageError(f"--aim-at {aim_at}: give JOINT=NODE")
    pairs = [(aim_at[:k], aim_at[k + 1 :]) for k in cuts]
    found = [pair for pair in pairs if all(rig.has(name) for name in pair)]
    joint, node = found[0] if len(found) == 1 else pairs[0]
    if rig.find(joint) == rig.find(node, "node"):
        raise UsageError(f"--aim-at {aim_at}: a joint cannot aim at itself")
    return joint, node
