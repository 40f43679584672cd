"""What a user gives a pose reader: its targets, the frame it sees its driver from, the morphs it drives."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import field, replace
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.pose_readers import relative
from rigtri.evaluation.timelines import timeline_and_time
from rigtri.maths.matrices import handedness, unsheared_axes
from rigtri.maths.quaternions import conjugate, from_axes, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.mesh_triangles import meshes_named
from rigtri.model.metadata import PoseReaderRecord
from rigtri.model.rig import Rig
from rigtri.operations.options.add_posereader import AddPosereaderOptions, Goal
from rigtri.operations.pose import PoseOptions, pose_of
from rigtri.report import Report

_NAMED = re.compile(r"([^=,@]*[^=,@\s][^=,@]*)=(.*)", re.S)


def named_goals(rig: Rig, options: AddPosereaderOptions) -> tuple[Goal, ...]:
    """The targets, each with a name: its own, else ``target1``, ``target2`` …

    Raises UsageError for names that are not unique, outputs of targets that there are not, and targets that
    the reader cannot have.
    """
    read = [_goal(rig, one) if isinstance(one, str) else one for one in options.target]
    goals = tuple(replace(goal, name=goal.name or f"target{k + 1}") for k, goal in enumerate(read))
    known = [goal.name for goal in goals]
    if len(set(known)) < len(known):
        raise UsageError("each target needs a name of its own")
    for target, *rest in (*options.morph, *options.attribute):
        if target not in known:
            raise UsageError(f"'{target}' ({' '.join(rest)}) is not a target: use one of {', '.join(known)}")
    if options.reader == "rbf" and any(goal.node for goal in goals):
        raise UsageError("rbf reads poses; a node is a target of dot and cone readers")
    return goals


def _goal(rig: Rig, text: str) -> Goal:
    """A target from its words; the name of a node that is there wins over all else."""
    name, words = "", text
    if not rig.has(text) and (found := _NAMED.fullmatch(text)):
        name, words = found[1], found[2]
    if rig.has(words):
        return Goal(name, node=words)
    parts = words.split(",")
    if len(parts) == 3:
        try:
            x, y, z = map(float, parts)
            return Goal(name, direction=(x, y, z))
        except ValueError:
            pass
    if words.lower() == "rest" or "@" in words:
        return Goal(name, pose=words)
    return Goal(name, node=words)


@dataclass(frozen=True, eq=False)
class ReaderFrame:
    """A driver and the node that it is seen from, ``frame`` (−1: the world)."""

    rig: Rig
    driver: int
    frame: int
    report: Report

    @cached_property
    def resting(self) -> Floats:
        """The driver's rotation in the frame at rest, (4,)."""
        frame = self.rig.world[self.frame] if self.frame >= 0 else np.eye(4)
        return self._rotation(self.rig.world[[self.driver]], frame[np.newaxis])

    def _rotation(self, driver: Floats, frame: Floats) -> Floats:
        found = relative(driver, frame)[0]
        if not np.isfinite(found).all():
            raise GeometryError(
                f"'{self.rig.title(self.driver)}' has no axes: a scale on or above it is zero"
            )
        return np.asarray(found)

    def direction_in_frame(self, direction: Sequence[float] | None) -> Floats:
        """A direction of the world at rest as the record of a target has it, (3,)."""
        required = np.array(direction, dtype=np.float64)
        if required.shape != (3,) or not np.isfinite(required).all() or not required.any():
            raise UsageError("a target is a direction other than 0,0,0, a pose or a node")
        required = normalise(required) * handedness(self.rig.world[self.driver])
        if self.frame < 0:
            return np.asarray(required)
        axes = from_axes(unsheared_axes(self.rig.world[self.frame]))
        return np.asarray(rotate(conjugate(axes), required))

    def rotation_in_pose(self, text: str) -> Floats:
        """The driver's rotation in the frame in a pose, as controls and constraints give it, (4,).

        Raises NameNotFoundError (a clip), GeometryError (a cycle).
        """
        if timeline_and_time(self.rig, text)[0] is None:
            return self.resting
        posed = pose_of(self.rig, PoseOptions(at=text), self.report)
        return self._rotation(posed.world(self.driver), posed.world(self.frame))


@dataclass(frozen=True, eq=False)
class MorphDrive:
    """Which weights go to which morph targets of one node: columns (morph) by columns (target)."""

    mesh: Mesh
    columns: dict[int, int] = field(default_factory=dict)


def morph_drives(
    rig: Rig, morphs: Sequence[tuple[str, str, str]], targets: Sequence[str], reader: str, report: Report
) -> list[MorphDrive]:
    """The morph targets that a reader drives, by the node that shows them. targets: the reader's, by name.

    morphs: (target, mesh, morph target) each. Raises NameNotFoundError, UsageError, GeometryError.
    """
    found: dict[int, MorphDrive] = {}
    for target, name, morph in morphs:
        mesh = next((mesh for mesh in meshes_named(rig, name) if len(mesh.morphs)), None)
        if mesh is None:
            raise GeometryError(f"Mesh '{name}' has no morph targets{_with_morphs(rig)}")
        drive = found.setdefault(mesh.node, MorphDrive(mesh))
        column = _column(mesh, morph)
        if column in drive.columns:
            raise UsageError(f"morph target '{morph}' of '{name}' can follow one target, not two")
        drive.columns[column] = targets.index(target)
        _warn_driven_twice(rig, mesh, column, morph, reader, report)
    return list(found.values())


def _warn_driven_twice(rig: Rig, mesh: Mesh, column: int, morph: str, reader: str, report: Report) -> None:
    """Warn where another reader drives a morph target too: the keys will be this one's."""
    names = (str(column), *mesh.morph_names[column : column + 1])
    for other in rig.records(PoseReaderRecord).values():
        for output in other.outputs if other.name != reader else ():
            if rig.known(output.mesh) == mesh.node and output.morph in names:
                report.warn(
                    "morph-driven-twice",
                    f"Morph target '{morph}' of '{mesh.name}' is driven by reader '{other.name}' too; "
                    f"its keys are now those of '{reader}'",
                    geometry=True,
                )


def _with_morphs(rig: Rig) -> str:
    """Which meshes have some, for a message."""
    have = list(dict.fromkeys(rig.title(m.node) for m in rig.meshes if len(m.morphs)))
    return f"; {', '.join(have[:6])} have some" if have else ", and no other mesh of this file has any"


def _column(mesh: Mesh, name: str) -> int:
    """The column of a morph target, by its name or its number."""
    if (column := mesh.morph_column(name)) is not None:
        return column
    if not mesh.morph_names:
        raise NameNotFoundError("morph target", name, map(str, range(len(mesh.morphs))))
    raise NameNotFoundError("morph target", name, mesh.morph_names)
