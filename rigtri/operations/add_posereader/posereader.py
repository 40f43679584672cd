"""Pose readers: morph targets and control values that follow a joint's pose, baked to keys."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rigtri.errors import FileError, GeometryError, UsageError
from rigtri.evaluation.pose_readers import (
    KERNELS,
    KINDS,
    MODES,
    Kernel,
    Kind,
    Mode,
    PoseReader,
    same_poses,
)
from rigtri.evaluation.timelines import (
    Timeline,
    merged_weights,
    put_tracks,
)
from rigtri.limits import refuse_unworkable
from rigtri.maths.quaternions import between, rotate
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.animation import Track
from rigtri.model.mesh_triangles import meshes_named
from rigtri.model.metadata import PoseReaderRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader import replaced_keys
from rigtri.operations.add_posereader.morph_drives import morph_drives
from rigtri.operations.add_posereader.reader_frame import ReaderFrame
from rigtri.operations.add_posereader.reader_keys import STILL, ReaderMotion, reader_keys, value_tracks
from rigtri.operations.add_rivet.rebind import rebind_rivets
from rigtri.operations.control_names import refuse_taken
from rigtri.operations.operation import operation
from rigtri.operations.rigtri_nodes import add, find, group, noted
from rigtri.report import Report


@dataclass(frozen=True)
class Goal:
    """A target as a user gives it: one of a direction of the world at rest, a pose, or a node.

    pose: ``CLIP@TIME`` or ``rest``; the last @ splits. rotation: a pose as xyzw of the driver seen
    from the frame.
    """

    name: str = ""
    direction: tuple[float, float, float] | None = None
    pose: str = ""
    node: str = ""
    rotation: tuple[float, float, float, float] | None = None


@dataclass(frozen=True)
class AddPosereaderOptions:
    """A pose reader. ``name`` is what it is found by in a second run.

    driver: the joint that is read. axis: of the driver. frame: what it is seen from, its parent
    unless named, or ``world``. targets: what it looks for. morphs: (target, mesh, morph target),
    by name or number; a target may drive several. attributes: (target, control, attribute). A target
    that drives no morph gets a node whose x translation is its weight. inner, outer: of a cone, in
    degrees. within: how far a weight may be off between keys. fps: additional keys a second.
    """

    driver: str = ""
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)
    frame: str = ""
    reader: Kind = "dot"
    targets: tuple[Goal, ...] = ()
    morphs: tuple[tuple[str, str, str], ...] = ()
    attributes: tuple[tuple[str, str, str], ...] = ()
    inner: float = 0.0
    outer: float = 90.0
    kernel: Kernel = "linear"
    mode: Mode = "swing"
    name: str = ""
    within: float = 1e-4
    fps: float | None = None

    def checked(self) -> AddPosereaderOptions:
        """These options. UsageError where they are incomplete, or contradict each other."""
        if not self.driver:
            raise UsageError("name the joint to read: --driver JOINT")
        if not self.targets:
            raise UsageError("give its target poses: --target X,Y,Z, CLIP@TIME, rest or a node")
        known = self.names()
        if len(set(known)) < len(known):
            raise UsageError("each target needs a name of its own")
        for target, *rest in (*self.morphs, *self.attributes):
            if target not in known:
                raise UsageError(f"'{target}' ({' '.join(rest)}) is no target; there are {', '.join(known)}")
        if self.reader not in KINDS or self.kernel not in KERNELS or self.mode not in MODES:
            raise UsageError(
                f"readers are {', '.join(KINDS)}, of {', '.join(KERNELS)} and {', '.join(MODES)}"
            )
        if not 0 <= self.inner < self.outer <= 180:
            raise UsageError(
                f"a cone goes from an inner to a larger outer angle, not {self.inner:g} to {self.outer:g}"
            )
        if self.reader == "rbf" and any(goal.node for goal in self.targets):
            raise UsageError("rbf reads poses; a node is a target of dot and cone readers")
        if not np.isfinite(self.axis).all() or not any(self.axis):
            raise UsageError("the axis of the driver is a direction, e.g. x or 0,1,0")
        refuse_unworkable("--fps", self.fps)
        if not self.within > 0 or (self.fps is not None and not self.fps > 0):
            raise UsageError("--within and --fps are numbers above 0")
        return self

    def names(self) -> list[str]:
        """The names of the targets: their own, else ``target1``, ``target2`` …"""
        return [goal.name or f"target{k + 1}" for k, goal in enumerate(self.targets)]


@operation(AddPosereaderOptions)
def add_posereader(rig: Rig, *, options: AddPosereaderOptions, report: Report) -> Rig:
    """Read how much a joint is in some poses, and drive morph targets or values by it, in every clip.

    What it drives has other weights on purpose: ``report.morph_changes`` names it, and the self-check
    compares all else. A second run finds the reader by its name. Rivets on meshes whose morph targets
    it drives are baked anew.

    Raises NameNotFoundError, UsageError, GeometryError (no morphs, poses that coincide), FileError.
    """
    options.checked()
    builder = _Builder(rig, options, report)
    return rebind_rivets(builder.build(), {drive.mesh.node for drive in builder.drives}, report)


def options_of(note: Mapping[str, Any]) -> AddPosereaderOptions:
    """The options that a pose reader was made with, from its metadata.

    Goals have their names and nodes; directions and poses of a note are seen from the frame, and stay there.
    """
    outputs = note["outputs"]
    x, y, z = map(float, note["axis"])
    return AddPosereaderOptions(
        driver=note["driver"],
        axis=(x, y, z),
        frame=note["frame"] or "world",
        reader=note["reader"],
        targets=tuple(Goal(str(t["name"]), node=str(t.get("node", ""))) for t in note["targets"]),
        morphs=tuple((str(o["target"]), str(o["mesh"]), str(o["morph"])) for o in outputs if "morph" in o),
        attributes=tuple(
            (str(o["target"]), str(o["control"]), str(o["attribute"])) for o in outputs if "morph" not in o
        ),
        inner=float(note.get("inner", 0.0)),
        outer=float(note.get("outer", 90.0)),
        kernel=note.get("kernel", "linear"),
        mode=note.get("mode", "swing"),
        name=str(note["name"]),
        within=float(note["within"]),
        fps=note.get("fps"),
    )


def rebaked(rig: Rig, node: int, *, clips: Collection[int], report: Report | None = None) -> Rig:
    """The rig with what a pose reader drives baked anew, at rest and in some clips, by their places.

    Raises what `add_posereader` does, where what the note names is not there any more.
    """
    note = rig.metadata[node]
    report = report if report is not None else Report()
    return _Builder(rig, options_of(note).checked(), report, note=note, clips=frozenset(clips)).build()


class _Builder:
    """One run: the rig as it grows. note: of a reader that is there. clips: the places of those baked."""

    def __init__(
        self,
        rig: Rig,
        options: AddPosereaderOptions,
        report: Report,
        *,
        note: Mapping[str, Any] | None = None,
        clips: frozenset[int] | None = None,
    ) -> None:
        self.clips = clips
        self.rig, self.options, self.report = rig, options, report
        self.driver = rig.find(options.driver)
        self.frame = self._frame()
        self.seen = ReaderFrame(rig, self.driver, self.frame, report)
        self.axis = normalise(np.array(options.axis, dtype=np.float64))
        self.note = dict(note) if note is not None else self._note()
        self.reader = PoseReader.of_record(PoseReaderRecord.from_dict(self.note))
        if options.reader == "rbf" and (same := same_poses(self.reader)) is not None:
            raise GeometryError(
                f"Targets '{same[0]}' and '{same[1]}' are one pose of '{rig.title(self.driver)}' "
                f"as to its {options.mode}; leave one of them out"
            )
        self.drives = morph_drives(rig, options.morphs, options.names(), self.name, report)
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
        node = find(rig, type="poseReader", name=self.name)
        if node is None:
            if self.options.name:
                refuse_taken(rig, self.options.name)
            rig, node = add(rig, self.name, parent, self.note)
        else:
            rig = self._given_back(rig, node)
        self.note[replaced_keys.KEY] = list(rig.metadata[node].get(replaced_keys.KEY, ()))
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
                within=self.options.within,
                fps=self.options.fps,
            )
            counts[timeline.name] = len(times)
            tracks = [*self._morph_tracks(timeline, times, found), *value_tracks(values, times, found)]
            self.rig = put_tracks(self.rig, timeline, tracks)
        if not self.note[replaced_keys.KEY]:
            del self.note[replaced_keys.KEY]
        self.rig = noted(self.rig, node, self.note)
        if not counts:
            self.report.warn(
                "reader-without-clips",
                f"There is no clip to bake '{self.name}' into; it is stored, and drives nothing",
            )
        for drive in self.drives if counts else ():
            self.report.morph_changes.setdefault(self.rig.keys[drive.mesh.node], set()).update(drive.columns)
        self._record(node, counts)
        return self.rig

    def _given_back(self, rig: Rig, node: int) -> Rig:
        """The rig with the keys back that this reader has replaced, where it drives others from now on."""
        note = rig.metadata[node]
        required = [(output.get("mesh"), output.get("morph")) for output in self.note["outputs"]]
        had = [(output.get("mesh"), output.get("morph")) for output in note.get("outputs", ())]
        if set(had) <= set(required):
            return rig
        rig, driven = replaced_keys.restore_replaced_keys(rig, [node], self.report)
        for mesh, columns in driven.items():
            self.report.morph_changes.setdefault(rig.keys[mesh], set()).update(columns)
        return noted(rig, node, {key: value for key, value in note.items() if key != replaced_keys.KEY})

    def _note(self) -> dict[str, Any]:
        rig, options = self.rig, self.options
        mine: dict[str, Any] = {}
        if options.reader == "cone":
            mine = {"inner": float(options.inner), "outer": float(options.outer)}
        if options.reader == "rbf":
            mine = {"kernel": options.kernel, "mode": options.mode, "rest": self._numbers(self.seen.resting)}
        names = options.names()
        controls = {name: self._control(name) for _, name, _ in options.attributes}
        outputs = [
            *(
                {"target": t, "mesh": rig.address(meshes_named(rig, mesh)[0].node), "morph": morph}
                for t, mesh, morph in options.morphs
            ),
            *(
                {"target": t, "control": rig.address(controls[control]), "attribute": attribute}
                for t, control, attribute in options.attributes
            ),
        ]
        return {
            "v": 1,
            "type": "poseReader",
            "name": self.name,
            "driver": rig.address(self.driver),
            "frame": rig.address(self.frame) if self.frame >= 0 else "",
            "axis": self._numbers(self.axis),
            "reader": options.reader,
            **mine,
            "targets": [self._target(goal, name) for goal, name in zip(options.targets, names, strict=True)],
            "outputs": outputs,
            "within": float(options.within),
            **({"fps": float(options.fps)} if options.fps is not None else {}),
        }

    def _control(self, name: str) -> int:
        """A control that add-controls has made."""
        node = self.rig.find(name, "node")
        if self.rig.type_of(node) != "control":
            raise UsageError(f"'{name}' is no control; make some with: rigtri add-controls")
        return node

    @staticmethod
    def _numbers(values: Floats) -> list[float]:
        return [float(value) for value in values]

    def _target(self, goal: Goal, name: str) -> dict[str, Any]:
        """A target as the note has it: a node, a direction in the frame, or a rotation in it."""
        if goal.node:
            node = self.rig.find(goal.node, "node")
            if node == self.driver:
                raise UsageError(f"--target {goal.node}: a joint does not point at itself; name another node")
            return {"name": name, "node": self.rig.address(node)}
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
            return {"name": name, "rotation": self._numbers(rotation)}
        return {"name": name, "direction": self._numbers(direction)}

    def _nodes(self) -> dict[str, int]:
        """The nodes that targets name, by address."""
        return {t.node: self.rig.find(t.node, "node") for t in self.reader.targets if t.node}

    def _value_nodes(self, reader: int) -> dict[int, int]:
        """The nodes whose x translation is a weight, by target: of targets that drive no morph."""
        driving = {column for drive in self.drives for column in drive.columns.values()}
        rest = self.motion.weights_at_rest(self.reader)
        found = {}
        outputs = {t: (control, attribute) for t, control, attribute in self.options.attributes}
        for column, name in enumerate(self.options.names()):
            if column in driving and name not in outputs:
                continue
            note: dict[str, Any] = {"v": 1, "type": "poseWeight", "reader": self.name, "target": name}
            if name in outputs:
                control, attribute = outputs[name]
                note |= {"control": self.rig.address(self._control(control)), "attribute": attribute}
            node = find(self.rig, type="poseWeight", reader=self.name, target=name)
            if node is None:
                self.rig, node = add(self.rig, f"{self.name}_{name}", reader, note)
            self.rig = noted(self.rig, node, note)
            if abs(self.rig.translation[node, 0] - rest[column]) > STILL:
                translation = self.rig.translation.copy()
                translation[node] = [rest[column], 0.0, 0.0]
                self.rig = replace(self.rig, translation=translation)
            found[column] = node
        return found

    def _keep(self, title: str, timeline: Timeline) -> None:
        """Note what drives the morph targets until now."""
        for drive in self.drives:
            was, mesh = timeline.track(drive.mesh.node, "weights"), self.rig.address(drive.mesh.node)
            old = self.note[replaced_keys.KEY]
            self.note[replaced_keys.KEY] = replaced_keys.add_replaced_keys(
                old, title, mesh, was, drive.columns
            )

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
        self.report.added.append(
            {
                "node": self.rig.names[node],
                "type": "poseReader",
                "driver": self.rig.title(self.driver),
                "reader": self.options.reader,
                "new": self.rig.keys[node] is None,
                "rest": dict(zip(self.options.names(), map(float, rest), strict=True)),
                "morphs": sum(len(drive.columns) for drive in self.drives) if counts else 0,
                "keys": dict(counts),
            }
        )
