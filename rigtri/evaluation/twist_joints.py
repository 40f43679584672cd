"""Twist joints: each takes a share of the twist of its driver about a bone.

They are evaluated from their metadata alone (docs/file-description.md), all frames at once; the
twist itself is in `rigtri.maths.quaternions`.

Source: "Matrix parent constraint" (twist distribution, announced).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.maths.matrices import (
    compose,
    handedness,
    inverse,
    multiply,
    transform_directions,
    transform_points,
    unsheared_axes,
)
from rigtri.maths.quaternions import conjugate, from_axes, from_axis_angle, quadruple, rotate, twist_angle
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length, normalise, triple
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import Triple, TwistRecord
from rigtri.model.rig import Rig
from rigtri.text import list_names

# Unit vectors that are nearer are one: products of world matrices leave less.
_SAME_LINE = 1e-7
# Rotations and lines of two files that differ by less went through another program's float32.
_SAME_TURN = 1e-5


@dataclass(frozen=True, eq=False)
class TwistJoint:
    """A twist joint, ready to be evaluated.

    node: the joint. path: the nodes whose locals, multiplied, are what turns: the driver first.
    rest: its rotation at rest, (4,). axis: in the space above the path, (3,). own_axis: the same
    line in the space that the joint stands in, (3,). weight: the share of the twist that the
    joint takes; against the driver where negative. standing: the joint's rotation without twist, (4,).
    """

    node: int
    path: tuple[int, ...]
    rest: Floats
    axis: Floats
    own_axis: Floats
    weight: float
    standing: Floats

    def angles(self, local: Floats) -> Floats:
        """The twist of the driver, (f,), in radians, where the nodes' local matrices are (f, n, 4, 4)."""
        return self.angles_of([local[..., node, :, :] for node in self.path])

    def angles_of(self, path: Sequence[Floats]) -> Floats:
        """As `angles`, of the local matrices of the path alone, (f, 4, 4) each."""
        return twist_angle(product(_rotation(path), conjugate(self.rest)), self.axis)

    def rotations(self, local: Floats) -> Floats:
        """The local rotations of the twist joint, (f, 4)."""
        return self.turned(self.angles(local))

    def turned(self, angles: Floats) -> Floats:
        """Its local rotations, (f, 4), at a twist of the driver, (f,), in radians."""
        return product(from_axis_angle(self.own_axis, self.weight * angles), self.standing)


def twist_joints(rig: Rig) -> list[TwistJoint]:
    """The twist joints of a rig's metadata, in the order of the nodes.

    Raises GeometryError for a joint that is no longer there, or several, for one that is not the parent, and
    for a bone without length.
    """
    return [twist_of(rig, node, record) for node, record in sorted(rig.records(TwistRecord).items())]


def untwisted(rig: Rig, among: Collection[int] | None = None) -> Rig:
    """The rig with its twist joints as they stand without twist, where their rest pose has some.

    among: nodes of which twist joints are meant; None for all.
    """
    twists = {n: r for n, r in rig.records(TwistRecord).items() if among is None or n in among}
    stood = {n: r.standing for n, r in twists.items() if r.standing is not None}
    if not stood:
        return rig
    nodes, turns = list(stood), np.array([*stood.values()])
    rotation, matrix, local = rig.rotation.copy(), rig.matrix.copy(), rig.local[nodes]
    rotation[nodes] = turns  # also what a clip with other channels of a matrix plays
    matrix[nodes] = compose(local[:, 3, :3], turns, length(local[:, :3, :3]))
    return replace(rig, rotation=rotation, matrix=matrix)


def twist_of(rig: Rig, node: int, record: TwistRecord) -> TwistJoint:
    """The twist joint ``node`` of a record. Raises as `twist_joints`."""
    if lost := rig.lost_by(record):
        raise GeometryError(
            f"The twist joint '{rig.title(node)}' takes its twist from {list_names(lost)}, and no one node "
            "is called so: was it renamed, or is there another of that name? Give the joint that name again"
        )
    joint, to, driver = map(rig.find, (record.joint, record.to, record.driver))
    refuse_parted(rig, node, record)
    own_axis = _own_axis(rig, joint, to, record.axis)
    upper = driver == joint
    path = driver_path(rig, driver, -1 if upper else joint)
    local = [rig.local[k] for k in path]
    axis, sign = own_axis, 1.0
    rest = _rotation(local) if record.rest is None else np.array(record.rest)
    if upper:
        whole = _product(local)
        sign = float(handedness(whole))
        back = sign * rotate(rest, own_axis) if record.rest else transform_directions(own_axis, whole)
        axis = normalise(back)
    standing = record.standing or from_axes(unsheared_axes(rig.local[node]))
    return TwistJoint(
        node=node,
        path=path,
        rest=rest,
        axis=axis,
        own_axis=own_axis,
        weight=sign * record.weight,
        standing=np.asarray(standing),
    )


def refuse_parted(rig: Rig, node: int, record: TwistRecord) -> None:
    """GeometryError for a twist joint that is no child of its joint: another one, or parented elsewhere."""
    if rig.find(record.joint) != rig.parents[node]:
        raise GeometryError(
            f"'{rig.title(node)}' has the metadata of a twist joint of '{record.joint}', and is not its "
            f"child: was it parented elsewhere, or was metadata copied? Parent it to '{record.joint}' again, "
            "or remove that metadata"
        )


def with_stored_rest(rig: Rig, before: Rig) -> Rig:
    """The rig, whose rest pose is another than that of ``before``, with twist counted from the old one.

    Where the bone ends elsewhere than on its line of before, its axis stays that line.
    """
    metadata = dict(rig.metadata)
    for node, record in rig.records(TwistRecord).items():
        was = twist_of(before, node, record)
        turned = any((rig.local[k] != before.local[k]).any() for k in (node, *was.path))
        joint, to = rig.find(record.joint), rig.find(record.to)
        line = was.own_axis if record.axis else normalise(bone(rig, joint, to))
        leaves = not float(length(line - was.own_axis)) <= _SAME_LINE
        if turned or leaves:
            kept = replace(record, rest=quadruple(was.rest), standing=quadruple(was.standing))
            axis = triple(was.own_axis) if leaves else record.axis
            metadata[node] = replace(kept, axis=axis).to_dict()
    return rig if metadata == rig.metadata else replace(rig, metadata=metadata)


def with_twist_of(rig: Rig, described: Rig, of: Mapping[int, int]) -> Rig:
    """The rig with the twist of its twist joints counted from the rest pose of another file.

    of: the rig's nodes by those of the other, whose axes they have. A driver that hangs from something else
    there counts from its own rest.
    """
    metadata, records, theirs = dict(rig.metadata), rig.records(TwistRecord), described.records(TwistRecord)
    for there, node in of.items():
        if there not in theirs or node not in records or rig.lost_by(records[node]):
            continue
        record, now = records[node], twist_of(rig, node, records[node])
        was = twist_of(described, there, theirs[there])
        above = int(described.parents[was.path[-1]])
        if tuple(map(of.get, (*was.path, above))) != (*now.path, int(rig.parents[now.path[-1]])):
            continue
        same = bool(min(np.abs(now.rest - was.rest).max(), np.abs(now.rest + was.rest).max()) <= _SAME_TURN)
        line = bool(length(now.own_axis - was.own_axis) <= _SAME_TURN)
        if not (same and line):
            kept = replace(record, rest=quadruple(was.rest), standing=quadruple(was.standing))
            metadata[node] = replace(kept, axis=record.axis if line else triple(was.own_axis)).to_dict()
    return rig if metadata == rig.metadata else replace(rig, metadata=metadata)


def driver_path(rig: Rig, driver: int, below: int) -> tuple[int, ...]:
    """The nodes from a driver up to, without it, ``below``; −1: the driver, with what holds its axes."""
    path, node = [driver], int(rig.parents[driver])
    while node >= 0 and node != below and (below >= 0 or node in rig.holders):
        path.append(node)
        node = int(rig.parents[node])
    if below >= 0 and node != below:
        raise GeometryError(f"'{rig.title(driver)}' does not lie below '{rig.title(below)}'")
    return tuple(path)


def bone(rig: Rig, joint: int, to: int) -> Floats:
    """Where ``to`` stands at rest as ``joint`` sees it, (3,)."""
    return transform_points(rig.world[to, 3, :3], inverse(rig.world[joint]))


def _own_axis(rig: Rig, joint: int, to: int, given: Triple | None) -> Floats:
    """The axis in the space of ``joint``, (3,): the given one, else the line to ``to``."""
    line = bone(rig, joint, to) if given is None else np.array(given, dtype=np.float64)
    axis = normalise(line)
    if not np.isfinite(axis).all():
        raise GeometryError(
            f"'{rig.title(joint)}' and '{rig.title(to)}' are at one place: there is no bone to twist about"
        )
    return axis


def _product(matrices: Sequence[Floats]) -> Floats:
    total = matrices[0]
    for matrix in matrices[1:]:
        total = multiply(total, matrix)
    return total


def _rotation(matrices: Sequence[Floats]) -> Floats:
    return from_axes(unsheared_axes(_product(matrices)))
