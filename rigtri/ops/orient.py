"""orient-joints: new axes for chosen joints; nothing that can be seen moves.

Source: R. Katz, "Rigging with Triangles", GDC 2018, "Aiming node A at node B";
"Using Vector Math to Rig an Arm" (hinge of the limb's own triple).
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from rigtri.errors import FileError, GeometryError, UsageError
from rigtri.limbs import Limb, along, recognise
from rigtri.matrices import determinant, transform_directions
from rigtri.ops.aims import Aim, Branch, End, Rules, aim_of
from rigtri.ops.frames import Mirror, like_turns, mirrored_turns, stored_turns, turn_onto
from rigtri.ops.presets import Style
from rigtri.ops.scale import Policy, allowed_turns, nearest_cardinal, splits
from rigtri.ops.select import Selection, select
from rigtri.ops.ups import Hinges, Up, carried, carry_to_joint, crossing, degrees, stated
from rigtri.quaternions import IDENTITY, from_axes, from_axis_angle, multiply, to_axes, turn_angle
from rigtri.reframe import SAME_SCALE, Scales, reframe, split, turned
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.skeleton import Reference, Skeleton, reference, skeleton
from rigtri.triangle import DEGENERATE_SINE, axis_of, frame
from rigtri.trigonometry import Floats
from rigtri.vectors import angle, cross, length, normalise

# A joint that would turn by less than this (radians) is left bit-exact: float32 storage
# re-derives frames with up to this much noise (docs/exactness.md).
UNCHANGED = 2e-6
# … plus this over |sin bend| about the aim axis, where up comes from a plane.
UNCHANGED_PLANE = 2e-7
# However poor the positions are, a turn of more than this (0.06°) is meant.
MOST_NOISE = 1e-3
# Axes copied from a file (--like) hold no positions: only the rounding of rotations.
UNCHANGED_LIKE = 5e-7


@dataclass(frozen=True)
class Options:
    """Everything that `orient_joints` can be told; the defaults are the command's."""

    style: Style = Style()
    selection: Selection = Selection()
    chain_styles: tuple[tuple[str, str, Style], ...] = ()
    branch: Branch = "chain"
    branch_to: tuple[str, ...] = ()
    end: End = "tip"
    aim_at: tuple[tuple[str, str], ...] = ()
    limbs: tuple[Limb, ...] = ()
    per_joint_plane: bool = False
    facing: tuple[float, float, float] | None = None
    pose: str | None = None
    on_nonuniform_scale: Policy = "snap"
    snap: bool = False
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mirror: Mirror | None = None
    from_side: Literal["left", "right"] = "left"
    plane: str = "yz"
    root: str | None = None
    like: Rig | None = None
    frames: object = None
    inverse: bool = False


def orient_joints(rig: Rig, *, options: Options | None = None, report: Report | None = None) -> Rig:
    """Give joints the axes that ``options`` ask for; all that is bound to them follows.

    Joints below the noise of float32 storage are left bit-exact, so that a second
    run changes nothing. Each joint's record goes to ``report.joints``.

    Raises NameNotFoundError, UsageError, GeometryError (a scale that forbids it
    under the policy ``error``), FileError (no skeleton; nothing may turn).
    Not handled: poses stored as differences to rest (additive clips).
    """
    options, report = options or Options(), report if report is not None else Report()
    work = _Work.of(rig, options, report)
    wanted = work.wanted()
    turns = np.broadcast_to(IDENTITY, (len(rig), 4)).copy()
    for joint, turn in wanted.items():
        turns[joint] = turn
    parted = splits(rig, _at_frames(rig, turns)) if options.on_nonuniform_scale == "split" else {}
    exact = turns.copy()
    exact[list(parted)] = IDENTITY
    axis = {joint: axis_of(work.style(joint).aim)[0] for joint in wanted}
    exact = allowed_turns(rig, _at_frames(rig, exact), options.on_nonuniform_scale, axis, report)
    for joint in set(wanted) - set(rig.frame_of) - set(parted):
        if options.frames is None:  # what the snap left over is noise too
            exact[joint] = work.quiet(joint, exact[joint])
        turns[joint] = exact[joint]
    work.check(turns)
    work.record(turns, parted)
    out = _noted(reframe(rig, exact), work, turns)
    for joint in sorted(parted, reverse=True):  # from the back: the indices before stay
        out = split(out, joint, parted[joint])
    return out


def _at_frames(rig: Rig, turns: Floats) -> Floats:
    """The turns of joints whose axes a node of their own holds, moved to that node."""
    if not rig.frame_of:
        return turns
    moved = turns.copy()
    for joint, holder in rig.frame_of.items():
        moved[holder], moved[joint] = turns[joint], IDENTITY
    return moved


@dataclass(eq=False)
class _Work:
    """One run: what turns, where it aims, and what was decided for each joint."""

    tree: Skeleton
    ref: Reference
    options: Options
    report: Report
    turning: list[int]
    kept: dict[int, str]
    aims: dict[int, Aim]
    limbs: tuple[Limb, ...]
    styles: dict[int, Style] = field(default_factory=dict)
    ups: dict[int, Up] = field(default_factory=dict)
    normals: dict[int, Up] = field(default_factory=dict)  # before `pole` turns them
    noise: dict[int, float] = field(default_factory=dict)

    @staticmethod
    def of(rig: Rig, options: Options, report: Report) -> _Work:
        # Frames from elsewhere name their joints: all that match are meant, with or without a skin.
        elsewhere = options.like is not None or options.frames is not None
        tree = skeleton(rig, options.root, plain=elsewhere)
        if rig.frozen:
            raise FileError(f"No joint of this file may turn: {rig.frozen}.")
        ref = reference(tree, options.pose)
        selection = options.selection
        chains = tuple((start, end) for start, end, _ in options.chain_styles)
        selection = replace(selection, chains=(*selection.chains, *chains))
        turning, kept = select(tree, ref, selection, all_named=elsewhere or options.root is not None)
        _tell_fixed(rig, kept, report)
        _check_named(rig, selection)
        styles = {}
        for start, end, style in options.chain_styles:
            for joint in along(rig, rig.find(start), rig.find(end)):
                styles[joint] = style.checked()
        options.style.checked()
        limbs = _limbs(rig, options)
        rules = Rules(
            options.branch,
            tuple(rig.find(name) for name in options.branch_to),
            options.end,
            {rig.find(a): rig.find(b, "node") for a, b in options.aim_at},
            limbs,
        )
        aims = {joint: aim_of(tree, ref, joint, rules) for joint in turning}
        return _Work(tree, ref, options, report, turning, kept, aims, limbs, styles)

    def style(self, joint: int) -> Style:
        return self.styles.get(joint, self.options.style)

    def wanted(self) -> dict[int, Floats]:
        """The turn that each joint should take, identity where it already stands so."""
        options, rig = self.options, self.tree.rig
        if options.frames is not None:  # applied as they are, however small
            stored, undo = options.frames, options.inverse
            return stored_turns(rig, self.turning, stored, inverted=undo, report=self.report)
        if options.like is not None:
            turns = like_turns(self.tree, self.ref, self.turning, options.like, self.report)
        else:
            turns = self._oriented()
        turns = {joint: self._finished(joint, turn) for joint, turn in turns.items()}
        if options.mirror is not None:
            turns |= mirrored_turns(
                self.tree,
                self.ref,
                turns,
                mirror=options.mirror,
                from_side=options.from_side,
                plane=options.plane,
                report=self.report,
            )
        return {joint: self.quiet(joint, turn) for joint, turn in turns.items()}

    def _finished(self, joint: int, turn: Floats) -> Floats:
        """``--snap`` and ``--offset``: after everything else."""
        if self.options.snap:
            turn = nearest_cardinal(turn)
        for axis, angle_ in zip(np.eye(3), self.options.offset, strict=True):
            if angle_:
                turn = multiply(turn, from_axis_angle(axis, angle_ * (np.pi / 180.0)))
        return turn

    def quiet(self, joint: int, turn: Floats) -> Floats:
        """Exactly the identity for a turn that is no more than the noise of storage."""
        if self.options.like is not None:
            return IDENTITY if float(turn_angle(turn)) <= UNCHANGED_LIKE else turn
        limit = self._least(joint) + self.noise.get(joint, 0.0)
        limit = min(limit + self._position_noise(joint), MOST_NOISE)
        return IDENTITY if float(turn_angle(turn)) <= limit else turn

    def _least(self, joint: int) -> float:
        """The turn that means nothing: float32 rounding, and scale noise that passes as uniform."""
        return UNCHANGED + float(self.scale_noise[joint])

    @cached_property
    def scale_noise(self) -> Floats:
        """How far from uniform the scales of each node and those above it are, (n,), where taken as such."""
        spread = Scales.of(self.tree.rig).spread
        noise = np.where(spread <= SAME_SCALE, spread, 0.0)
        for level in self.tree.rig.levels[1:]:
            noise[level] = np.maximum(noise[level], noise[self.tree.rig.parents[level]])
        return noise

    def _position_noise(self, joint: int) -> float:
        """What float32 positions (inverse binds) leave uncertain about a bone's direction, in radians."""
        bone = self.aims[joint].length if joint in self.aims else 0.0
        return self.ref.rounding * self.ref.extent / max(bone, 1e-3 * self.ref.extent, 1e-30)

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
        late = [joint for joint in self.turning if self.style(joint).up_from == "child"]
        # An end joint that copies its parent comes after it, whichever way the others are taken.
        copies = [joint for joint in self.turning if self.aims[joint].how == "parent"]
        first = [joint for joint in self.turning if joint not in late and joint not in copies]
        for joint in (*first, *reversed([j for j in late if j not in copies]), *copies):
            turns[joint] = self._turn(joint, hinges, turns)
        self._tell_straight(hinges)
        return turns

    def _turn(self, joint: int, hinges: Hinges, turns: dict[int, Floats]) -> Floats:
        aim, style, ref = self.aims[joint], self.style(joint), self.ref
        if style.world or aim.how == "world":
            return turn_onto(np.eye(3), ref, joint)
        if aim.how == "keep":
            return IDENTITY
        if aim.how == "parent":
            above = self.tree.above[joint]
            if above in self.noise:
                self.noise[joint] = self.noise[above]
            return turn_onto(self._axes(above, turns), ref, joint)
        assert aim.direction is not None
        bone = normalise(transform_directions(aim.direction, ref.world[joint]))
        up = self._up(joint, bone, hinges, turns)
        self.ups[joint] = up
        # A direction near the bone tells the roll badly: its noise grows with 1/sine.
        spread = float(length(cross(normalise(up.vector), bone)))
        least = self._least(joint)
        self.noise[joint] = least / max(spread, DEGENERATE_SINE) - least
        if up.step >= 2:
            of_plane = UNCHANGED_PLANE + self._position_noise(joint)
            self.noise[joint] += of_plane / max(up.sine, DEGENERATE_SINE)
        axes = frame(
            aim.direction,
            carry_to_joint(ref, joint, up.vector),
            aim_axis=style.aim,
            up_axis=style.up,
        )
        return from_axes(axes)

    def _axes(self, joint: int, turns: dict[int, Floats]) -> Floats:
        """The world axes (rows) that a joint will have."""
        axes = to_axes(self.quiet(joint, turns.get(joint, IDENTITY)))
        return normalise(transform_directions(axes, self.ref.world[joint]))

    def _up(self, joint: int, bone: Floats, hinges: Hinges, turns: dict[int, Floats]) -> Up:
        """The up direction in the world by the ladder; for ``pole`` already turned to the bend's side."""
        style = self.style(joint)
        source = stated(self.tree, self.ref, joint, style.up_from, style.up)
        if style.up_from in ("parent", "child"):
            source = self._relative(joint, style, turns)
        if source is not None and crossing(source, bone):
            return Up(source, 1, style.up_from)
        above = self.tree.above[joint]
        before = None
        if above in self.ups and above in self.aims and self.ups[above].step >= 2:
            other = self.aims[above]
            assert other.direction is not None
            along_ = transform_directions(other.direction, self.ref.world[above])
            normal = hinges.found.get(above) or self.normals.get(above)
            before = carried(normal, normalise(along_), bone) if normal else None
        # After an offset or a snap the present axis is not the one that a run before has found.
        present = not any(self.options.offset) and not self.options.snap
        up = hinges.normal(joint, bone, style.up, before, present=present)
        self.normals[joint] = up
        if style.up_from != "plane" and source is not None:
            self.report.warn(
                "up-parallel",
                f"'{self._name(joint)}': {style.up_from} runs along the bone; up is taken from: {up.source}.",
                joint=self._name(joint),
                geometry=True,
            )
        if style.up_from == "pole" and up.step == 8:
            # The present axis is an up direction already, not a normal.
            self.normals[joint] = replace(up, vector=cross(up.vector, bone))
        elif style.up_from == "pole":
            return replace(up, vector=cross(bone, up.vector))
        return up

    def _relative(self, joint: int, style: Style, turns: dict[int, Floats]) -> Floats | None:
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
        return np.asarray(self._axes(other, turns)[letter] * sign)

    def _name(self, joint: int) -> str:
        return self.tree.rig.title(joint)

    def _tell_straight(self, hinges: Hinges) -> None:
        """One warning per straight limb or chain: how straight, and what told the up direction."""
        said: dict[str, tuple[float, set[int], set[str]]] = {}
        for joint, (name, sine) in hinges.straight.items():
            if joint in self.ups and self.ups[joint].step >= 2:
                entry = said.setdefault(name, (sine, set(), set()))
                entry[1].add(self.ups[joint].step)
                entry[2].add(self.ups[joint].source)
        for name, (sine, steps, sources) in said.items():
            word = "straight" if sine < DEGENERATE_SINE else "nearly straight"
            self.report.warn(
                "straight",
                f"{name} is {word} ({degrees(sine):.3g}° bent); up is taken from: "
                f"{', '.join(sorted(sources))}.",
                joint=name,
                geometry=max(steps) > 3,
            )
        loose = [j for j, up in self.ups.items() if up.step >= 7 and j not in hinges.straight]
        for joint in loose:
            self.report.warn(
                "invented-up",
                f"'{self._name(joint)}': no plane tells its up direction; taken from: "
                f"{self.ups[joint].source}.",
                joint=self._name(joint),
                geometry=True,
            )

    def check(self, turns: Floats) -> None:
        """GeometryError for a turned joint of scale 0; warnings for bones and sources that are doubtful."""
        rig, moves = self.tree.rig, turned(turns)
        flat = np.flatnonzero(moves & (length(rig.local[:, :3, :3]) == 0).any(axis=1)).tolist()
        if flat:
            raise GeometryError(
                f"'{rig.title(flat[0])}' has scale 0 at rest, so its axes mean nothing below it. "
                f"Leave it out with --exclude '{rig.title(flat[0])}'."
            )
        short = [self._name(j) for j, aim in self.aims.items() if aim.how == "descendant"]
        if short:
            names = ", ".join(short[:6]) + (" …" if len(short) > 6 else "")
            self.report.warn(
                "zero-length", f"bones of length 0 aim at the next joint that lies elsewhere: {names}"
            )
        sources = {self.style(joint).up_from for joint in self.aims}
        for source in sorted(text for text in sources if text.startswith("noderot:")):
            node = rig.find(source.split(":", 2)[2], "node")
            if moves[node]:
                self.report.warn(
                    "up-source-turns",
                    f"{source}: '{rig.title(node)}' turns too; a second run would see other axes",
                )

    def record(self, turns: Floats, parted: Container[int]) -> None:
        """One record per joint: what became of it, why, and how sure that is."""
        rig, moves = self.tree.rig, turned(turns)
        mirrored = determinant(self.ref.world) < 0
        for joint in self.tree.joints:
            aim, up = self.aims.get(joint), self.ups.get(joint)
            status = "turned" if moves[joint] else "kept" if joint in self.kept else "unchanged"
            entry: dict[str, Any] = {"joint": rig.title(joint), "address": rig.address(joint)}
            entry |= {"path": rig.path(joint), "status": status}
            if joint in self.kept:
                entry["reason"] = self.kept[joint]
            if aim is not None:
                entry["aim"] = aim.how
                if aim.node is not None:
                    entry["aims_at"] = rig.title(aim.node)
            if up is not None:
                entry |= {"up": up.source, "step": up.step, "invented": up.step >= 7}
            entry["pose"] = self.ref.kind[joint]
            if mirrored[joint]:
                entry["mirrored"] = True
            if joint in parted:
                entry["split"] = True
            if moves[joint]:
                entry["degrees"] = round(float(np.degrees(turn_angle(turns[joint]))), 6)
                entry["turn"] = [float(x) for x in turns[joint]]
                self._check_aim(joint, turns[joint], entry)
            self.report.joints.append(entry)
        named = [rig.title(j) for j in self.tree.joints if mirrored[j] and moves[j]]
        if named:
            self.report.warn(
                "mirrored",
                f"{len(named)} joints are mirrored and stay so (left-handed axes): "
                f"{', '.join(named[:8])}{' …' if len(named) > 8 else ''}",
            )

    def _check_aim(self, joint: int, turn: Floats, entry: dict[str, Any]) -> None:
        aim, style = self.aims[joint], self.style(joint)
        if aim.direction is not None and not style.world:
            letter, sign = axis_of(style.aim)
            off = float(np.degrees(angle(to_axes(turn)[letter] * sign, aim.direction)))
            entry["aim_error_degrees"] = round(off, 6)


def _check_named(rig: Rig, selection: Selection) -> None:
    """GeometryError for a joint that the user named by itself and that may not turn."""
    named = [name for name in selection.joints if rig.has(name)]
    named += [name for chain in selection.chains for name in chain]
    for name in named:
        node = rig.find(name)
        if node in rig.fixed:
            raise GeometryError(f"'{rig.title(node)}' cannot turn: {rig.fixed[node]}")


def _tell_fixed(rig: Rig, kept: dict[int, str], report: Report) -> None:
    """Warn of joints that the file itself holds in place, once per reason."""
    reasons: dict[str, list[str]] = {}
    for joint, reason in kept.items():
        if rig.fixed.get(joint) == reason:
            reasons.setdefault(reason, []).append(rig.title(joint))
    for reason, names in reasons.items():
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        report.warn("fixed", f"kept as it is: {', '.join(names[:3])}{more}: {reason}")


def _limbs(rig: Rig, options: Options) -> tuple[Limb, ...]:
    """The user's limbs, then the recognised ones that share no joint with them."""
    mine = {node for limb in options.limbs for node in limb.triple}
    found = [limb for limb in recognise(rig) if not mine.intersection(limb.triple)]
    return (*options.limbs, *found)


def _facing(rig: Rig, options: Options) -> Floats | None:
    facing = options.facing if options.facing is not None else rig.facing
    if facing is None:
        return None
    direction = np.asarray(facing, dtype=np.float64)
    if not direction.any() or not np.isfinite(direction).all():
        raise UsageError(f"--facing {facing} is no direction")
    return direction


def _noted(rig: Rig, work: _Work, turns: Floats) -> Rig:
    """Mark in the file the turned joints whose up direction was invented, and unmark the others.

    What did not turn keeps its mark or none: nothing was invented for it now.
    """
    notes = {node: dict(note) for node, note in rig.notes.items()}
    moves = turned(turns)
    for joint in (joint for joint in work.turning if moves[joint]):
        up, own = work.ups.get(joint), notes.get(joint, {})
        if up is not None and up.step >= 7:
            notes[joint] = {"v": 1, "type": "frame", "up": up.source, "invented": True}
        elif own.get("type") == "frame" and own.get("invented"):
            del notes[joint]
    return rig if notes == rig.notes else replace(rig, notes=notes)
