"""add-controls: a hierarchy of FK and IK controls over joint chains.

Source: R. Katz, "Rigging with Triangles", GDC 2018, "Build finger": for each joint an
offset at the joint, the control under it with zero channels, the next offset
under the control.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property, partial
from typing import Any

import numpy as np

from rigtri.errors import GeometryError, NoLimbError
from rigtri.evaluation.sampling import world_of
from rigtri.evaluation.zero_pose import (
    SAME_POSITION,
    constrained_controls,
    idle_ik,
    ik_obstacle,
    moved_controls,
)
from rigtri.frames.skeleton import ReferencePose, Skeleton, reference, skeleton
from rigtri.maths.matrices import orthonormal_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import distance, dot
from rigtri.model.constraints import constraints_of
from rigtri.model.joint_names import Side, side, twin
from rigtri.model.metadata import (
    PIVOTS,
    ControlKind,
    ControlRecord,
    OffsetRecord,
    PoleVectorRecord,
)
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.add_posereader.corrective_joints import driven_joints
from rigtri.operations.aim_targets import Rules, aim_targets, limb_children
from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.control_drawing import (
    Drawing,
    draw,
    draw_anew,
    lines_of,
    requested_drawing,
    requested_members,
)
from rigtri.operations.control_frames import ControlAxes, stored_style
from rigtri.operations.control_sizes import ControlSizes
from rigtri.operations.controls_check import refuse_carried
from rigtri.operations.foot_roll import Foot, rolling_feet
from rigtri.operations.joint_selection import chosen
from rigtri.operations.operation import operation
from rigtri.operations.options.add_controls import NAME as NAME
from rigtri.operations.options.add_controls import TOKENS as TOKENS
from rigtri.operations.options.add_controls import AddControlsOptions as AddControlsOptions
from rigtri.operations.rigtri_nodes import (
    NewNodes,
    built_at_zero,
    call,
    find,
    group,
    home,
    remembered,
    seen_from,
    stand,
    stand_local,
    unposed,
    with_record,
)
from rigtri.operations.skin_joints import add_joint, is_joint_kind, move_joint, skin_sibling_parent
from rigtri.progress import counted
from rigtri.recognition.limbs import Limb, built_limbs, forward, named_limbs, upright, with_recognised
from rigtri.recognition.one_character import bodies, within
from rigtri.recognition.recognise import recognised_as
from rigtri.recognition.sides import twin_of
from rigtri.report import Report
from rigtri.text import and_more

# What a control is below, its place, (3,), and its drawing.
Seat = tuple[int, Floats, Drawing]
# What {kind} stands for in a name, by the kind of control.
_WORDS = {"fk": "ctl"} | {kind: f"{kind}_ctl" for kind in ("ik", "root", *PIVOTS)}


@operation(AddControlsOptions)
def add_controls(rig: Rig, *, options: AddControlsOptions, report: Report) -> Rig:
    """Put controls over joints; a second run finds its controls and sets their offsets anew.

    Each control stands at its joint at rest, aimed along the bone or as the options say, its channels zero;
    what a user has since set or drawn on it stays. The record of each goes to ``report.added``.

    Raises NameNotFoundError, UsageError, GeometryError (a joint without a frame), FileError.
    """

    def build(rig: Rig, mine: AddControlsOptions) -> Rig:
        return built_at_zero(rig, lambda rig: _Builder(rig, mine, report).build())

    several = bodies(rig) if options.whole_character or options.root_control else []
    if not several:
        return build(rig, options)
    limbs, joints = named_limbs(rig, options.ik), list[int]()
    if options.selection.named:
        joints = chosen(skeleton(rig, options.root), options.selection)
        options = replace(options, chain=(), below=(), skin=None, exclude=())
    all_of_them = not joints and (options.whole_character or options.limbs is not None or not limbs)
    for nodes in several:
        ik = tuple(limb for limb in limbs if limb.start in nodes)
        own = tuple(rig.address(joint) for joint in joints if joint in nodes)
        if all_of_them or ik or own:
            rig = within(rig, nodes, partial(build, mine=replace(options, ik=ik, joints=own)))
    return rig


class _Builder:
    """One run: the rig as it grows, and what is known of its joints from the start."""

    def __init__(self, rig: Rig, options: AddControlsOptions, report: Report) -> None:
        self.rig, self.options, self.report = rig, options, report
        self.tree: Skeleton = skeleton(rig, options.root)
        self.ref: ReferencePose = reference(self.tree, "nodes")
        self.world = rig.normalised_world
        named = tuple(named_limbs(rig, options.ik))
        self.limbs = (*named, *self._recognised(named)) if self._all_limbs else named
        rules = Rules(limb_child=limb_children(self.tree, self.limbs))
        aims = aim_targets(self.tree, self.ref, self.tree.joints, rules)
        self.sizes = ControlSizes(self.tree, aims, self.ref.extent)
        # Of earlier runs; what this run makes has neither keys nor been moved, and nothing counts from it.
        self.moved = moved_controls(rig) | constrained_controls(rig)
        self.axes = ControlAxes(self.tree, options, self.moved)
        self.bones = {node: bone for bone, node in rig.humanoid.items()}
        self.limb_sides: dict[int, Side] = {limb.start: limb.side for limb in self.limbs}
        self.sides: dict[int, Side] = {}
        self.feet = rolling_feet(self.tree, self.limbs, self.sizes.sections, options, report)
        self.controls: dict[int, int] = {}
        self.above_controls = set[int]()
        # The controls of this run: node, kind and joint.
        self.made: list[tuple[int, ControlKind, int]] = []

    @property
    def _all_limbs(self) -> bool:
        return self.options.whole_character or self.options.limbs is not None

    def _recognised(self, named: tuple[Limb, ...]) -> Iterator[Limb]:
        """The limbs beside those that are named: those of make-limb, then those that are recognised.

        But for those where IK has nothing to move.
        """
        taken = {node for limb in named for node in limb.triple}
        made = (limb for limb in built_limbs(self.rig) if taken.isdisjoint(limb.triple))
        for limb in with_recognised(self.rig, (*named, *made))[len(named) :]:
            if why := idle_ik(self.rig, limb.triple, self.tree.carries):
                title = self.rig.title(limb.end)
                self.report.warn("no-ik", f"No IK end for '{title}': {why}", joint=title)
            else:
                yield limb

    def _chain(self, limb: Limb) -> tuple[str, ...]:
        return tuple(map(self.rig.address, limb.triple))

    def build(self) -> Rig:
        options = self.options
        self.rig, holder = group(self.rig)
        self.above_controls = self.rig.with_ancestors([holder])
        self.new = NewNodes(self.rig)
        joints = self._joints()
        if options.limbs is not None and not (joints or self.limbs or options.root_control):
            raise NoLimbError("--ik")
        known = self.rig.records(ControlRecord).items()
        self.fk = {one.joint: node for node, one in reversed(known) if one.kind == "fk"}
        if options.root_control or (options.whole_character and self._root_carries(joints)):
            self._root()
        self.axes.find([*((joint, "fk") for joint in joints), *((limb.end, "ik") for limb in self.limbs)])
        self._warn_unknown()
        for joint in counted(joints, "controls"):
            address = self.rig.address(joint)
            self.controls[joint] = self._control(joint, "fk", self.fk.get(address), {"joint": address})
        self._add()
        for limb in dict.fromkeys(self.limbs):
            chain = self._chain(limb)
            self._ik(limb, {"joint": chain[-1], "chain": chain})
        for foot in self.feet:
            self._roll(foot)
        self._poles()
        self._give_names()
        _ = self.rig.world  # of all at once
        for control, kind, joint in self.made:
            self._record(control, kind, joint)
        return self.rig

    def _warn_unknown(self) -> None:
        """Warn of what is not known of a body, where its controls are not chosen one by one.

        Not of what an earlier step has warned of: joints and controls have axes by the same rules.
        """
        self.report.extend(self.axes.illegible)
        if self.options.whole_character:
            earlier = self.report.earlier
            self.report.extend(k for k in self.axes.unknown if (k.code, k.joint) not in earlier)

    def _give_names(self) -> None:
        """Names by the user's rule, and a record of those that new controls have."""
        if self.options.name is not None:
            names = {c: self._name(joint, kind, self.options.name) for c, kind, joint in self.made}
            self.rig = call(self.rig, names, self.options.name, self.report)
        self.rig = remembered(self.rig, [c for c, _, _ in self.made if self.rig.keys[c] is None])

    def _joints(self) -> list[int]:
        """The joints that get FK controls, parents first; twist joints follow by themselves, and so do joints
        that a pose reader drives, unless they are named.

        Those of limbs with IK always do, whatever carries weight: theirs hold what IK cannot.
        """
        options, found = self.options, list[int]()
        if options.selection.named or options.whole_character:
            found = [k for k in chosen(self.tree, options.selection) if self.rig.type_of(k) != "twist"]
            if not options.selection.named:
                idle = self.above_controls.union(np.flatnonzero(~self.tree.carries).tolist())
                idle.update(driven_joints(self.rig))
                found = [joint for joint in found if joint not in idle]
        held = {*(node for limb in self.limbs for node in limb.triple), *(foot.toe for foot in self.feet)}
        found = self._below_no_control(found, held)
        missing = held.difference(found)
        return sorted({*found, *missing}) if missing else found

    def _below_no_control(self, joints: list[int], held: set[int]) -> list[int]:
        """The joints without those that controls are below, and so cannot follow any, as the top prim of a
        layer (--root); said in a warning.

        held: those of limbs with IK. GeometryError where there is such a one, or no other joint is named.
        """
        if above := sorted(self.above_controls.intersection({*joints, *held})):
            names = and_more([f"'{self.rig.title(joint)}'" for joint in above])
            text = f"Controls are below {names}, which cannot follow them"
            if not held.isdisjoint(above) or not set(joints).difference(above):
                raise GeometryError(f"{text}: name joints below, or put what is to move below another prim")
            remedy = "to move these, too, put them below another prim first"
            self.report.warn("no-control", f"{text}, so none is made there: {remedy}")
        return [joint for joint in joints if joint not in above]

    def _root_carries(self, joints: list[int]) -> bool:
        """Whether a root control would carry all limbs: IK moves a limb from the node above it, so only
        where a control moves that."""
        rig = self.tree.rig
        moved = {*map(rig.address, joints), *self.fk}
        for limb in self.limbs:
            above = rig.with_ancestors([limb.start]) - {limb.start}
            if moved.isdisjoint(map(rig.address, above)):
                title = rig.title(limb.start)
                text = f"No root control: no joint above '{title}' has a control, so IK leaves it where it is"
                self.report.warn("no-root-control", text, joint=title)
                return False
        return True

    def _root(self) -> None:
        """The control over all: below the first root joint, on the ground, along the world.

        The ground is as low as the skin is at rest; without any, as the lowest joint.
        """
        # A prim that holds the controls, as with --root, cannot follow one of them.
        free = (joint for joint in self.tree.joints if joint not in self.above_controls)
        top = next(free, self.tree.roots[0])
        up = upright(self.tree.rig)
        place = self.ref.position(top).copy()
        low = self.sizes.sections.lowest(top, up)
        if np.isnan(low):
            low = float(dot(self.ref.world[list(self.tree.joints), 3, :3], up).min())
        place = place + up * (low - float(dot(place, up)))
        about = {"joint": self.rig.address(top)}
        control = self._find("root", about)
        front = forward(self.tree.rig)
        drawing = self._drawing("root", top, self.ref.extent * 0.25, up, front)
        if control is None:
            _, parent = group(self.rig)
            control = self._new("root", top, parent, about, drawing, place, np.eye(3))
            self._add()
        else:
            self._again(control, "root", top, drawing)
            if not self.moved:  # keys of poles, and of what else is right below, count from it
                self._stand(control, place, np.eye(3))
        self.made.append((control, "root", top))

    def _find(self, kind: ControlKind, about: Mapping[str, Any]) -> int | None:
        return find(self.rig, ControlRecord, kind=kind, **about)

    def _roll(self, foot: Foot) -> None:
        """The pivots of a foot, each below the one before, the first one below the IK control."""
        chain = self._chain(foot.limb)
        control = self._find("ik", {"chain": chain})
        if control is None or self.rig.is_joint[control]:
            return
        style = self.options.style or AxisStyle()
        for kind, joint, place, size in foot.pivots:
            about = {"joint": self.rig.address(joint), "chain": chain}
            self.axes.styles[joint, kind], self.axes.frames[joint, kind] = style, foot.axes
            drawing = self._drawing(kind, joint, size, foot.normal)
            control = self._control(joint, kind, self._find(kind, about), about, (control, place, drawing))
        self._add()

    def _control(
        self,
        joint: int,
        kind: ControlKind,
        known: int | None,
        about: Mapping[str, Any],
        at: Seat | None = None,
    ) -> int:
        """The control of a kind over a joint, found again or new, its offset at the joint, or elsewhere."""
        parent, place, drawing = at or self._seat(joint, kind)
        if known is None:
            control = self._new(kind, joint, parent, about, drawing, place)
        else:
            control = known
            self._known(control, kind, joint, parent, drawing, place)
        self.made.append((control, kind, joint))
        return control

    def _seat(self, joint: int, kind: ControlKind) -> Seat:
        if kind == "fk":
            size, normal, shift = self.sizes.of_twins(self._with_twin(joint))
        else:
            size, normal, shift = self.sizes.of(joint, self.axes.frames.get((joint, kind)))
        limb = next((limb for limb in self.limbs if kind == "ik" and limb.end == joint), None)
        if limb is not None:
            size = self.sizes.of_ends(zip(self._with_twin(limb.middle), self._with_twin(joint), strict=False))
        drawing = self._drawing(kind, joint, size, normal, shift=shift)
        return self._parent(joint, kind), self.world[joint, 3, :3], drawing

    def _with_twin(self, joint: int) -> dict[int, Floats | None]:
        """A joint and its twin, if any, with the axes of their FK controls.

        Names say it; where they say no side, it is as the character is recognised, if that was asked for.
        """
        rig = self.tree.rig
        name, both = rig.names[joint], [joint]
        if (other := twin(name, self._named)) != name:
            named = self._named.get(other, [])
            both += named if len(named) == 1 else []
        elif self._all_limbs and (known := twin_of(rig, joint)) in self.tree.above:
            both += [known] if known is not None else []
        return {node: self.axes.frames.get((node, "fk")) for node in both}

    @cached_property
    def _named(self) -> dict[str, list[int]]:
        """The joints of each name."""
        found: dict[str, list[int]] = {}
        for joint in self.tree.joints:
            found.setdefault(self.tree.rig.names[joint], []).append(joint)
        return found

    def _known(
        self, control: int, kind: ControlKind, joint: int, parent: int, drawing: Drawing, place: Floats
    ) -> None:
        """A control that is there already: its drawing as requested, its offset at its place."""
        self._again(control, kind, joint, drawing)
        offset = int(self.rig.parents[control])
        record = self.rig.records(OffsetRecord).get(offset)
        if record is not None and int(self.rig.parents[offset]) != parent:
            self._report_kept(control)
        axes, record = self.axes.of_offset(control, joint, kind, record)
        if record is not None:
            self.rig = with_record(self.rig, offset, record)
        self._stand(control, place, axes)

    def _add(self) -> None:
        """Add what is new to the rig."""
        self.rig = self.new.added(self.rig)
        self.new = NewNodes(self.rig)

    def _stand(self, control: int, place: Floats, axes: Floats) -> None:
        """Stand the offset of a control in the world; what is below the control stays, but for its lines."""
        before, offset = self.rig, int(self.rig.parents[control])
        if offset not in before.records(OffsetRecord):  # somebody's node, perhaps a joint
            text = f"'{before.names[control]}' has no offset group above it any more and stays where it is"
            self.report.warn("control-kept-in-place", f"{text}; to rebuild it, strip the file first")
            return
        above = self.new.unposed(int(before.parents[offset]))
        local, noise = seen_from(above, place, axes)
        self.rig = self.new.stood(stand_local(before, offset, local, noise=noise))
        if self.rig is not before and not np.array_equal(before.local[offset], self.rig.local[offset]):
            refuse_carried(before, offset, control)
            for node in before.children[control]:
                if node in before.own - before.drawings:
                    there = unposed(before, node)
                    self.rig = stand(self.rig, node, there[3, :3], orthonormal_axes(there))
            self.new.stood(self.rig)

    def _warn_keyed_pole(self, limb: Limb) -> None:
        """Warn of a pole vector that moves, which did nothing while its limb had no IK control."""
        pole = find(self.rig, PoleVectorRecord, chain=self._chain(limb))
        if pole is None:
            return
        clips = [clip.name for clip in self.rig.clips if any(track.node == pole for track in clip.tracks)]
        title, moved = self.rig.title(pole), "its limb has an IK control now, and IK moves it"
        if self.rig.clips and any(rule.child == pole for rule in constraints_of(self.rig).values()):
            text = f"'{title}' follows a constraint: {moved} in every clip"
            self.report.warn("pole-keyed", text, joint=title)
        elif clips:
            text = f"'{title}' has keys in {and_more(clips)}: {moved} there"
            self.report.warn("pole-keyed", text, joint=title)

    def _ik(self, limb: Limb, about: Mapping[str, Any]) -> None:
        """The IK end of a limb, a control or a joint as an earlier run has made it, or as is wanted."""
        if obstacle := ik_obstacle(self.rig, limb.triple):
            raise GeometryError(f"IK cannot move this limb: {obstacle}. Name other joints, or leave it out")
        known, kind = self._find("ik", about), self.options.as_
        if known is None:
            self._warn_keyed_pole(limb)
        if kind == "joint" if known is None else is_joint_kind(self.rig, known, kind):
            self._ik_joint(limb, known, about)
        else:
            self._control(limb.end, "ik", known, about)
            self._add()
        self._limits(about)

    def _limits(self, about: Mapping[str, Any]) -> None:
        """How an IK limb reaches, in its control's record; what is zero is not stored."""
        control = self._find("ik", about)
        if control is None:
            return
        own, given = self.rig.records(ControlRecord)[control], self.options
        soft = own.soft if given.soft is None else given.soft or None
        stretch = own.stretch if given.stretch is None else given.stretch or None
        self.rig = with_record(self.rig, control, replace(own, soft=soft, stretch=stretch))

    def _ik_joint(self, limb: Limb, known: int | None, about: Mapping[str, Any]) -> None:
        """A joint beside a limb, in the frame of its end; nothing is drawn, engines show bones themselves."""
        place, axes = self.world[limb.end, 3, :3], self.axes.of_joint(limb.end)
        if known is None:
            parent, like = skin_sibling_parent(self.rig, limb.start)
            record = ControlRecord(kind="ik", **about, side=self._side(limb.end))
            name = self._name(limb.end, "ik")
            self.rig, node = add_joint(self.rig, name, parent, record, place, axes, like=like)
        else:
            self.rig, node = move_joint(self.rig, known, place, axes), known
        self.made.append((node, "ik", limb.end))

    def _name(self, joint: int, kind: ControlKind, rule: str = NAME) -> str:
        name = self.rig.names[joint] or f"joint_{joint}"
        return rule.format(joint=name, side=self._side(joint), kind=_WORDS[kind])

    def _new(
        self,
        kind: ControlKind,
        joint: int,
        parent: int,
        about: Mapping[str, Any],
        drawing: Drawing,
        place: Floats,
        axes: Floats | None = None,
    ) -> int:
        """A control and its offset at a place, which `_add` adds. axes: (3, 3); else those of its style."""
        name, new = self._name(joint, kind), self.new
        record, lines = lines_of(ControlRecord(kind=kind, **about, side=self._side(joint)), drawing)
        stored = OffsetRecord(kind=kind, joint=record.joint)
        if axes is None:
            axes, found = self.axes.of_offset(-1, joint, kind, stored)
            stored = found or stored
        local, noise = seen_from(new.unposed(parent), place, axes)
        offset = new.add(f"{name}_offset", parent, stored, local, noise)
        control = new.add(name, offset, record, None)
        new.shapes[control] = lines
        return control

    def _again(
        self,
        control: int,
        kind: ControlKind,
        joint: int,
        drawing: Drawing,
    ) -> None:
        """A control that is there already gets what was requested; drawn again where its axes are others."""
        requested, offset = (
            requested_members(self.options, self._side(joint), kind),
            int(self.rig.parents[control]),
        )
        record = self.rig.records(OffsetRecord).get(offset)
        turned = record is not None and stored_style(self.rig, record) != self.axes.styles.get((joint, kind))
        self.rig = draw_anew(self.rig, control, drawing, requested, self.report, turned=turned)

    def _drawing(
        self,
        kind: str,
        joint: int,
        size: float,
        normal: Floats,
        front: Floats | None = None,
        *,
        shift: float = 0.0,
    ) -> Drawing:
        return requested_drawing(self.options, self._side(joint), kind, size, normal, front, shift)

    def _parent(self, joint: int, kind: ControlKind) -> int:
        """The control of the nearest joint above that has one; IK ends are parented to the root control."""
        above = self.tree.above.get(joint, -1) if kind == "fk" else -1
        while above >= 0:
            found = self.controls.get(above)
            found = found if found is not None else self.fk.get(self.rig.address(above))
            if found is not None:
                return found
            above = self.tree.above[above]
        self.rig, parent = home(self.rig, joint)
        return parent

    def _side(self, joint: int) -> Side:
        """The side that a VRM bone, a name or the limb says, of the joint or the nearest above it."""
        path, node = list[int](), joint
        while node >= 0 and node not in self.sides:
            path.append(node)
            node = self.tree.above.get(node, -1)
        found: Side = self.sides.get(node, "")
        for node in reversed(path):
            known = side(self.bones.get(node, "")) or side(self.tree.rig.names[node])
            found = known or self.limb_sides.get(node, "") or found
            self.sides[node] = found
        return found

    def _poles(self) -> None:
        """A pole vector for every IK limb, drawn where it is new."""
        if not self.limbs:
            return
        before = set(self.rig.metadata)
        if not any(self.rig.is_joint[node] for node, _, _ in self.made):
            recognised_as(self.rig, self.tree.rig)
        limbs = tuple(dict.fromkeys(self.limbs))
        pole_options = AddPolevectorOptions(
            limb=tuple(limb for limb in limbs if not self._keeps_pole(limb)),
            reach=self.options.reach,
            facing=self.options.facing,
            bend=self.options.bend,
            as_=self.options.as_,
        )
        if pole_options.limb:
            self.rig = add_polevector(self.rig, options=pole_options, report=self.report)
        for node in self._drawn_poles(limbs):
            record = self.rig.records(PoleVectorRecord)[node]
            middle = self.rig.find(record.chain[1])
            drawing = self._drawing(
                "pole",
                middle,
                0.5 * self.sizes.of(middle, self.axes.frames.get((middle, "fk")))[0],
                np.array([1.0, 0.0, 0.0]),
            )
            if node not in before:
                self.rig = draw(self.rig, node, drawing)
            elif record.shape:
                requested = requested_members(self.options, self._side(middle), "pole")
                self.rig = draw_anew(self.rig, node, drawing, requested, self.report)

    def _keeps_pole(self, limb: Limb) -> bool:
        """Whether a pole vector stays: no other place is requested, and keys count from it, the limb rests
        as it did, or had no IK. Then it stands elsewhere only where somebody has put it, or asked for it."""
        options, chain = self.options, self._chain(limb)
        pole = find(self.rig, PoleVectorRecord, chain=chain)
        control = find(self.rig, ControlRecord, kind="ik", chain=chain)
        requested = options.bend or options.facing or options.reach != AddControlsOptions().reach
        if pole is None or requested:
            return False
        had_ik = find(self.tree.rig, ControlRecord, kind="ik", chain=chain) is not None
        counted = not had_ik or not self.moved.isdisjoint({pole, control})
        return counted or all(map(self._rests_as_before, limb.triple))

    def _rests_as_before(self, joint: int) -> bool:
        """Whether a joint stood before this run where an earlier one has put its FK control."""
        before, control = self.tree.rig, self.fk.get(self.rig.address(joint))
        if control is None:
            return False
        here, there = self.world[joint, 3, :3], unposed(before, int(before.parents[control]))[3, :3]
        size = max(self.ref.extent, float(np.abs(here).max()))
        return float(distance(here, there)) <= SAME_POSITION * size

    def _drawn_poles(self, limbs: tuple[Limb, ...]) -> list[int]:
        """The pole vectors of limbs that are no joints."""
        chains = (tuple(map(self.rig.address, limb.triple)) for limb in limbs)
        found = [find(self.rig, PoleVectorRecord, chain=chain) for chain in chains]
        return [node for node in found if node is not None and not self.rig.is_joint[node]]

    def _report_kept(self, control: int) -> None:
        self.report.warn(
            "control-kept-in-place",
            f"'{self.rig.names[control]}' was made before the controls above it and stays under "
            f"'{self.rig.title(int(self.rig.parents[self.rig.parents[control]]))}'; to rebuild the tree, "
            "strip the file first",
        )

    def _record(self, control: int, kind: ControlKind, joint: int) -> None:
        offset = control if self.rig.is_joint[control] else int(self.rig.parents[control])
        parent = int(self.rig.parents[offset])
        place = world_of(self.rig, offset)[3, :3]
        self.report.added.append(
            {
                "node": self.rig.names[control],
                "type": "control",
                "kind": kind,
                "joint": self.rig.title(joint),
                "parent": self.rig.names[parent],
                "new": self.rig.keys[control] is None,
                "position": [float(x) for x in place],
                **self.axes.described(joint, kind),
            }
        )
