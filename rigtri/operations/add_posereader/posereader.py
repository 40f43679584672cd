"""Pose readers: morph targets and control values that follow a joint's pose, baked to keys."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import FileError, GeometryError, UsageError
from rigtri.evaluation.pose_readers import PoseReader, same_poses
from rigtri.evaluation.timelines import Timeline, merged_weights, put_tracks
from rigtri.frames.skeleton import reference, skeleton
from rigtri.maths.quaternions import between, quadruple, rotate
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise, triple
from rigtri.model.animation import Track
from rigtri.model.mesh_triangles import meshes_named
from rigtri.model.metadata import (
    OutputRecord,
    PoseReaderRecord,
    PoseWeightRecord,
    TargetRecord,
)
from rigtri.model.options import check
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader import corrective_joints, replaced_keys
from rigtri.operations.add_posereader.reader_keys import STILL, ReaderMotion, reader_keys, value_tracks
from rigtri.operations.add_posereader.targets import ReaderFrame, morph_drives, named_goals
from rigtri.operations.add_rivet.rebind import rebind_rivets
from rigtri.operations.aim_targets import Rules, aim_targets, limb_children
from rigtri.operations.operation import operation
from rigtri.operations.options.add_posereader import ONLY_OF
from rigtri.operations.options.add_posereader import AddPosereaderOptions as AddPosereaderOptions
from rigtri.operations.options.add_posereader import Goal as Goal
from rigtri.operations.rigtri_nodes import (
    add,
    find_all,
    find_named,
    given_name,
    group,
    refuse_taken,
    with_record,
)
from rigtri.recognition.limbs import with_recognised
from rigtri.report import Report

# A target with so much weight at rest, of either sign, moves what it drives there.
AT_REST = 0.25


@operation(AddPosereaderOptions)
def add_posereader(rig: Rig, *, options: AddPosereaderOptions, report: Report) -> Rig:
    """Read how much a joint is in some poses, and drive morph targets or values by it, in every clip.

    What it drives has other weights on purpose: ``report.morph_changes`` names it, and the self-check
    compares all else. A second run finds the reader by its name. Rivets on meshes whose morph targets
    it drives are baked anew.

    Raises NameNotFoundError, UsageError, GeometryError (no morphs, poses that coincide), FileError.
    """
    options = replace(options, attribute=_valid_attributes(rig, options, report))
    builder = _Builder(rig, options, report)
    return rebind_rivets(builder.build(), {drive.mesh.node for drive in builder.drives}, report)


def _valid_attributes(
    rig: Rig, options: AddPosereaderOptions, report: Report
) -> tuple[tuple[str, str, str], ...]:
    """Targets, controls and the names of their values as the format can have them.

    UsageError where two values of a control would have one name.
    """
    found = [
        (t, control, given_name(rig, name, report, "--attribute")) for t, control, name in options.attribute
    ]
    values = [(rig.known(control), name) for _, control, name in found]
    for (_, control, name), value in zip(found, values, strict=True):
        if values.count(value) > 1:
            raise UsageError(f"--attribute: two targets would drive the value '{name}' of '{control}'")
    return tuple(found)


def options_of(record: PoseReaderRecord) -> AddPosereaderOptions:
    """The options that a pose reader was made with.

    Goals have their names and nodes; directions and poses are seen from the frame, and stay in the record.
    """
    given = {name: getattr(record, name) for name in ONLY_OF.get(record.reader, ())}
    own = {name: value for name, value in given.items() if value is not None}
    return AddPosereaderOptions(
        driver=record.driver,
        axis=record.axis,
        frame=record.frame or "world",
        reader=record.reader,
        target=tuple(Goal(target.name, node=target.node) for target in record.targets),
        morph=tuple((o.target, o.mesh, o.morph) for o in record.outputs if o.morph),
        attribute=tuple((o.target, o.control, o.attribute) for o in record.outputs if o.attribute),
        joint=tuple((o.target, o.joint, corrective_joints.changes_of(o)) for o in record.outputs if o.joint),
        **own,
        name=record.name,
        between=record.within,
        fps=record.fps,
    )


def rebaked(rig: Rig, node: int, *, clips: Collection[int], report: Report | None = None) -> Rig:
    """The rig with what a pose reader drives baked anew, at rest and in some clips, by their places.

    Raises what `add_posereader` does, where what the record names is not there any more.
    """
    record = rig.records(PoseReaderRecord)[node]
    report = report if report is not None else Report()
    options = options_of(record)
    check(options)
    return _Builder(rig, options, report, record=record, node=node, clips=frozenset(clips)).build()


class _Builder:
    """One run: the rig as it grows. record, node: of a reader that is there. clips: the places of those
    baked.
    """

    def __init__(
        self,
        rig: Rig,
        options: AddPosereaderOptions,
        report: Report,
        *,
        record: PoseReaderRecord | None = None,
        node: int | None = None,
        clips: frozenset[int] | None = None,
    ) -> None:
        self.clips, self.node = clips, node
        self.rig, self.options, self.report = rig, options, report
        self.goals = named_goals(rig, options)
        _refuse_unknown_targets(self.goals, options)
        self.driver = rig.find(options.driver)
        self.frame = self._frame()
        self.seen = ReaderFrame(rig, self.driver, self.frame, report)
        axis = along_bone(rig, self.driver) if options.axis is None else np.array(options.axis, np.float64)
        self.axis = normalise(axis)
        self.is_new = record is None
        self.record = record or self._new_record()
        self.reader = PoseReader.of_record(self.record)
        if options.reader == "rbf" and (same := same_poses(self.reader)) is not None:
            raise GeometryError(
                f"Targets '{same[0]}' and '{same[1]}' are the same pose of "
                f"'{rig.title(self.driver)}' in its {options.mode}; leave one of them out"
            )
        self.drives = morph_drives(rig, options.morph, [goal.name for goal in self.goals], self.name, report)
        self.motion = ReaderMotion(rig, self.driver, self.frame, self._nodes())

    @property
    def name(self) -> str:
        return self.options.name or f"{self.rig.names[self.driver] or 'joint'}_reader"

    def _frame(self) -> int:
        """The node that all is seen from; −1 for the world."""
        if not self.options.frame:
            return int(self.rig.parents[self.driver])
        return -1 if self.options.frame == "world" else self.rig.find(self.options.frame, "node")

    def build(self) -> Rig:
        rig, parent = group(self.rig)
        node = self.node
        if node is None:  # without a given name not the reader of another character's joint
            about = {} if self.options.name else {"driver": self.driver}
            node = find_named(self.rig, PoseReaderRecord, self.name, **about)
        before = None if node is None else rig.records(PoseReaderRecord)[node]
        corrective_joints.refuse_moving(rig, self.record, before)
        if node is None:
            if self.options.name:
                given_name(rig, self.options.name, self.report)
                refuse_taken(rig, self.options.name)
            rig, node = add(rig, self.name, parent, self.record)
        else:
            rig = self._given_back(rig, node)
        self.record = replace(self.record, before=rig.records(PoseReaderRecord)[node].before)
        self.rig = rig
        values = self._value_nodes(node)
        counts: dict[str, int] = {}
        for title, timeline in replaced_keys.timelines_by_title(self.rig).items():
            if self.clips is not None and self.clips.isdisjoint(timeline.members):
                continue
            self._keep(title, timeline)
            times, found = reader_keys(
                self.motion,
                self.reader,
                timeline,
                self.name,
                within=self.options.between,
                fps=self.options.fps,
            )
            counts[timeline.name] = len(times)
            tracks = [*self._morph_tracks(timeline, times, found), *value_tracks(values, times, found)]
            names = [goal.name for goal in self.goals]
            tracks += corrective_joints.joint_tracks(self.rig, self.record, names, times, found)
            self.rig = put_tracks(self.rig, timeline, tracks)
        self.rig = with_record(self.rig, node, self.record)
        if not counts:
            self.report.warn(
                "reader-without-clips",
                f"There is no clip to bake '{self.name}' into; it is stored, and drives nothing",
            )
        self.report.reposed |= bool(counts) and any(output.joint for output in self.record.outputs)
        for drive in self.drives if counts else ():
            self.report.morph_changes.setdefault(self.rig.keys[drive.mesh.node], set()).update(drive.columns)
        self._record(node, counts)
        return self.rig

    def _given_back(self, rig: Rig, node: int) -> Rig:
        """The rig with the keys back that this reader has replaced, where it drives others from now on."""
        old = rig.records(PoseReaderRecord)[node]
        stay = corrective_joints.driven_paths(self.record, rig)
        was = corrective_joints.driven_paths(old, rig)
        idle = {joint: paths - stay.get(joint, set()) for joint, paths in was.items()}
        rig = corrective_joints.without_driven(rig, idle)
        self.report.reposed |= any(idle.values())
        required, had = ({(o.mesh, o.morph) for o in record.outputs} for record in (self.record, old))
        if had <= required:
            return rig
        rig, driven = replaced_keys.restore_replaced_keys(rig, [node], self.report)
        for mesh, columns in driven.items():
            self.report.morph_changes.setdefault(rig.keys[mesh], set()).update(columns)
        return with_record(rig, node, replace(old, before=()))

    def _new_record(self) -> PoseReaderRecord:
        rig, options = self.rig, self.options
        cone, rbf = options.reader == "cone", options.reader == "rbf"
        controls = {name: self._control(name) for _, name, _ in options.attribute}
        outputs = [
            *(
                OutputRecord(target=t, mesh=rig.address(meshes_named(rig, mesh)[0].node), morph=morph)
                for t, mesh, morph in options.morph
            ),
            *(
                OutputRecord(target=t, control=rig.address(controls[control]), attribute=attribute)
                for t, control, attribute in options.attribute
            ),
            *(
                corrective_joints.joint_output(rig, t, joint, changes, (self.driver, self.frame))
                for t, joint, changes in options.joint
            ),
        ]
        return PoseReaderRecord(
            name=self.name,
            driver=rig.address(self.driver),
            frame=rig.address(self.frame) if self.frame >= 0 else "",
            axis=triple(self.axis),
            reader=options.reader,
            signed=options.signed,
            inner=options.inner if cone else None,
            outer=options.outer if cone else None,
            kernel=options.kernel if rbf else None,
            mode=options.mode if rbf else None,
            rest=quadruple(self.seen.resting) if rbf else None,
            targets=tuple(map(self._target, self.goals)),
            outputs=tuple(outputs),
            within=options.between,
            fps=options.fps,
        )

    def _control(self, name: str) -> int:
        """A control that add-controls has made."""
        node = self.rig.find(name, "node")
        if self.rig.type_of(node) != "control":
            raise UsageError(f"'{name}' is not a control; add controls with: rigtri add-controls")
        return node

    def _target(self, goal: Goal) -> TargetRecord:
        """A target as the record has it: a node, a direction in the frame, or a rotation in it."""
        if goal.node:
            node = self.rig.find(goal.node, "node")
            if node == self.driver:
                raise UsageError(f"--target {goal.node}: a joint does not point at itself; name another node")
            return TargetRecord(name=goal.name, node=self.rig.address(node))
        if goal.pose or goal.rotation is not None:
            rotation = (
                self.seen.rotation_in_pose(goal.pose) if goal.rotation is None else np.array(goal.rotation)
            )
            direction = rotate(rotation, self.axis)
        else:
            direction = self.seen.direction_in_frame(goal.direction)
            away = between(rotate(self.seen.resting, self.axis), direction)
            rotation = product(away, self.seen.resting)
        if self.options.reader == "rbf":
            return TargetRecord(name=goal.name, rotation=quadruple(rotation))
        return TargetRecord(name=goal.name, direction=triple(direction))

    def _nodes(self) -> dict[str, int]:
        """The nodes that targets name, by address."""
        return {t.node: self.rig.find(t.node, "node") for t in self.reader.targets if t.node}

    def _value_nodes(self, reader: int) -> dict[int, int]:
        """The nodes whose x translation is a weight, by target: of targets that drive no morph."""
        driving = {column for drive in self.drives for column in drive.columns.values()}
        moving = {output.target for output in self.record.outputs if output.joint}
        driving |= {column for column, goal in enumerate(self.goals) if goal.name in moving}
        rest = self.motion.weights_at_rest(self.reader)
        found = {}
        outputs = {t: (control, attribute) for t, control, attribute in self.options.attribute}
        for column, name in enumerate(goal.name for goal in self.goals):
            if column in driving and name not in outputs:
                continue
            record = PoseWeightRecord(reader=self.name, target=name)
            if name in outputs:
                control, attribute = outputs[name]
                address = self.rig.address(self._control(control))
                record = replace(record, control=address, attribute=attribute)
            known = find_all(self.rig, PoseWeightRecord, reader=self.name, target=name)
            node = next((each for each in known if self.rig.parents[each] == reader), None)
            if node is None:
                self.rig, node = add(self.rig, f"{self.name}_{name}", reader, record)
            self.rig = with_record(self.rig, node, record)
            if abs(self.rig.translation[node, 0] - rest[column]) > STILL:
                translation = self.rig.translation.copy()
                translation[node] = [rest[column], 0.0, 0.0]
                self.rig = replace(self.rig, translation=translation)
            found[column] = node
        return found

    def _keep(self, title: str, timeline: Timeline) -> None:
        """Store what drives the morph targets until now."""
        for drive in self.drives:
            was, mesh = timeline.track(drive.mesh.node, "weights"), self.rig.address(drive.mesh.node)
            kept = replaced_keys.add_replaced_keys(self.record.before, title, mesh, was, drive.columns)
            self.record = replace(self.record, before=kept)

    def _morph_tracks(self, timeline: Timeline, times: Floats, found: Floats) -> Iterable[Track]:
        for drive in self.drives:
            mesh = drive.mesh
            was = timeline.track(mesh.node, "weights")
            if was is None:
                still = np.zeros(1) if not len(times) else times[:1]
                was = Track(mesh.node, "weights", "STEP", still, mesh.morph_weights[np.newaxis])
            morphs, columns = list(drive.columns), list(drive.columns.values())
            try:
                yield merged_weights(was, times, morphs, found[:, columns])
            except ValueError:
                raise FileError(
                    f"Clip '{timeline.name}': the morph weights of '{self.rig.title(mesh.node)}' are splines "
                    "(CUBICSPLINE), which cannot take other keys; store them as LINEAR first"
                ) from None

    def _record(self, node: int, counts: Mapping[str, int]) -> None:
        rest = self.motion.weights_at_rest(self.reader)
        for goal, weight in zip(self.goals, rest.tolist(), strict=True):
            if self.is_new and abs(weight) >= AT_REST and goal.pose != "rest":
                self.report.warn(
                    "target-at-rest",
                    f"Target '{goal.name}' of '{self.name}' has the weight {weight:.2g} at rest already, so "
                    "clips show what it drives while its driver rests; without a clip the file looks as "
                    "before. Name another direction or pose, or --axis",
                )
        self.report.added.append(
            {
                "node": self.rig.names[node],
                "type": "poseReader",
                "driver": self.rig.title(self.driver),
                "reader": self.options.reader,
                "new": self.rig.keys[node] is None,
                "rest": {g.name: float(r) for g, r in zip(self.goals, rest, strict=True)},
                "joints": len(corrective_joints.driven_paths(self.record, self.rig)),
                "morphs": sum(len(drive.columns) for drive in self.drives) if counts else 0,
                "keys": dict(counts),
            }
        )


def _refuse_unknown_targets(goals: Sequence[Goal], options: AddPosereaderOptions) -> None:
    names = [goal.name for goal in goals]
    for target, joint, changes in options.joint:
        if target not in names:
            text = f"there is no target '{target}'; they are {', '.join(names)}"
            raise UsageError(f"--joint {target} {joint} {changes}: {text}")


def along_bone(rig: Rig, joint: int) -> Floats:
    """The direction of a joint's bone in its own axes, (3,); x where it has none."""
    tree = skeleton(rig, plain=True)
    if joint not in tree.above:
        return np.array([1.0, 0.0, 0.0])
    rules = Rules(limb_child=limb_children(tree, with_recognised(rig, ())))
    direction = aim_targets(tree, reference(tree, "nodes"), [joint], rules)[joint].direction
    return np.array([1.0, 0.0, 0.0]) if direction is None else direction
