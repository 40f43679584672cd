"""Nodes that rigtri adds to a rig: under one group, named by a user's rule, found again by their metadata."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import UsageError
from rigtri.evaluation.constraint_solver import to_parts
from rigtri.evaluation.rig_space import in_rig_space
from rigtri.evaluation.zero_pose import ControlsAtZero, moved_controls, world_at_zero
from rigtri.maths.matrices import compose, from_frame, inverse, multiply, orthonormal_axes
from rigtri.maths.quaternions import IDENTITY, from_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.control_shapes import Shape
from rigtri.model.metadata import ControlRecord, GroupRecord, Record, with_references
from rigtri.model.rig import Rig
from rigtri.report import Report

# float32 readers see no difference below this share; a second run must change no byte.
_SAME_POSITION = 1e-7
# The fields of a rig that hold its rest pose.
_REST = ("translation", "rotation", "scale", "matrix")


def group(rig: Rig, about: int = -1) -> tuple[Rig, int]:
    """The node that holds everything rigtri adds; of several, one for each character, that above a node.

    Where there is none it is new: a root, or a child of `FormatRules.group_parent`.
    """
    if groups := list(rig.nodes_of("group")):
        above = set(rig.path_to_root(about)) if about >= 0 else set[int]()
        return rig, next((node for node in groups if node in above), groups[0])
    return add(rig, rig.rules.group_name, rig.rules.group_parent, GroupRecord())


def home(rig: Rig, joint: int) -> tuple[Rig, int]:
    """The node that new locators and IK controls of a limb go under: its root control, else the group."""
    roots = root_controls(rig, joint)
    return (rig, roots[0]) if roots else group(rig)


def root_controls(rig: Rig, node: int) -> list[int]:
    """The root controls; of several those above a node, or that carry a joint above it, if there are such."""
    every, above = list(find_all(rig, ControlRecord, kind="root")), set(rig.path_to_root(node))
    carried = (rig.known(rig.records(ControlRecord)[root].joint) for root in every)
    mine = [root for root, joint in zip(every, carried, strict=True) if not above.isdisjoint((root, joint))]
    return mine or every


def add(rig: Rig, name: str, parent: int, record: Record) -> tuple[Rig, int]:
    """A new node under ``parent`` (−1: a root) with a free name like ``name`` and a record; and its index."""
    node = len(rig)
    free = free_of(rig.names_beside(parent), rig.rules.valid_name(name))
    rig = rig.with_nodes([free], [parent], np.zeros((1, 3)), IDENTITY[np.newaxis])
    return with_record(rig, node, record), node


def with_record(rig: Rig, node: int, record: Record) -> Rig:
    """The rig with another record on a node."""
    stored = record.to_dict()
    return rig if rig.metadata.get(node) == stored else replace(rig, metadata={**rig.metadata, node: stored})


def find(rig: Rig, of: type[Record], /, **values: Any) -> int | None:
    """The first node with a record of a type that has all of the values; None where there is none."""
    return next(find_all(rig, of, **values), None)


def find_all(rig: Rig, of: type[Record], /, **values: Any) -> Iterator[int]:
    """The nodes with records of a type that have all of the values."""
    for node, record in rig.records(of).items():
        if all(getattr(record, field) == value for field, value in values.items()):
            yield node


def find_named(rig: Rig, of: type[Record], name: str, **about: int) -> int | None:
    """The first node with a record of a name, whose fields ``about`` mean these nodes; None for none."""
    records = rig.records(of)
    for node in find_all(rig, of, name=name):
        if all(rig.known(getattr(records[node], field)) == meant for field, meant in about.items()):
            return node
    return None


def renamed(rig: Rig, node: int, name: str) -> Rig:
    """The rig with another name for a node of ours, made free of others'."""
    names = list(rig.names)
    taken = {names[other] for other in rig.beside(int(rig.parents[node])) if other != node}
    names[node] = free_of(taken, rig.rules.valid_name(name))
    return replace(rig, names=tuple(names))


def free_of(taken: Collection[str], name: str) -> str:
    """A name, with a number where it is taken."""
    free, count = name, 2
    while free in taken:
        free, count = f"{name}_{count}", count + 1
    return free


def given_name(rig: Rig, name: str, report: Report, flag: str = "--name") -> str:
    """A name that a user has given as the file's format can have it; where that is another, a warning.

    UsageError for a name without a letter or a digit, also where the format leaves none: several would
    become the same, and ``*`` or ``.`` mean something else wherever nodes are named. So do ``#3`` and ``/a``.
    """
    valid = rig.rules.valid_name(name)
    if not name.isprintable() or not any(sign.isalnum() for sign in name):
        raise UsageError(f"{flag} {name!r}: a name needs a letter or a digit, and nothing that is not seen")
    rule = "names in this format are letters, digits and underscores, and do not begin with a digit"
    if valid != name and not any(sign.isalnum() for sign in valid):
        raise UsageError(f"{flag} '{name}': {rule}")
    if valid.startswith(("#", "/", "vrm:")):
        raise UsageError(f"{flag} '{name}': #NUMBER, /PATH and vrm:BONE find nodes; choose another name")
    if valid != name:
        report.warn("name-changed", f"'{name}' becomes '{valid}': {rule}")
    return valid


def built_at_zero(rig: Rig, build: Callable[[Rig], Rig]) -> Rig:
    """The rig with what is built, in its own space, on joints as they stand while all controls are zero."""
    return in_rig_space(rig, lambda seen: _built_at_zero(seen, build), building=True)


def _built_at_zero(rig: Rig, build: Callable[[Rig], Rig]) -> Rig:
    """Where a control has been moved or has keys: then the rest pose of the joints may be one that controls
    gave, and keys count from where the controls stood.
    """
    if not moved_controls(rig):
        return build(rig)
    local = ControlsAtZero(rig).local
    posed = np.flatnonzero(rig.is_joint & (local != rig.local).any(axis=(1, 2)))
    parts = {name: getattr(rig, name).copy() for name in _REST}
    for name, values in zip(_REST, (*to_parts(local[posed]), local[posed]), strict=True):
        parts[name][posed] = values
    built = build(replace(rig, **parts) if len(posed) else rig)
    back = {name: getattr(built, name).copy() for name in _REST}
    for name in _REST:
        back[name][posed] = getattr(rig, name)[posed]
    return replace(built, **back) if len(posed) else built


def stand(rig: Rig, node: int, position: Floats, axes: Floats) -> Rig:
    """Put a node at a place in the world, position (3,) and axes as rows (3, 3), seen from its parent.

    What an animator has set on controls above it carries it along: it stands there while they are zero.
    """
    place, noise = seen_from(unposed(rig, int(rig.parents[node])), position, axes)
    return stand_local(rig, node, place, noise=noise)


def seen_from(above: Floats, position: Floats, axes: Floats) -> tuple[Floats, float]:
    """A place in the world as seen from a matrix, (4, 4), and what rounding leaves uncertain about it."""
    place = multiply(from_frame(axes, position), inverse(above))
    # A place near its parent's keeps the rounding of both in the world.
    return place, _SAME_POSITION * max(float(length(position)), float(length(above[3, :3])))


def unposed(rig: Rig, node: int) -> Floats:
    """The world matrix, (4, 4), that a node (−1: none) has while all controls are zero."""
    return world_at_zero(rig, node, set(rig.nodes_of("control")))


def settled(was: tuple[Floats, Floats], place: Floats, noise: float = 0.0) -> tuple[Floats, Floats]:
    """Translation and rotation of a local matrix without shear, (4, 4), but for bits of ``noise`` alone."""
    translation, rotation = was
    new = from_axes(orthonormal_axes(place))
    least = max(_SAME_POSITION * float(length(place[3, :3])), noise, 1e-30)
    # q and −q are one rotation; of a half turn, rounding picks either.
    turned = min(np.abs(new - rotation).max(), np.abs(new + rotation).max()) > _SAME_POSITION
    return place[3, :3] if length(place[3, :3] - translation) > least else translation, (
        new if turned else rotation
    )


def stand_local(rig: Rig, node: int, place: Floats, *, noise: float = 0.0) -> Rig:
    """Give a node a local matrix, see `settled`."""
    was = rig.translation[node], rig.rotation[node]
    now = settled(was, place, noise)
    translation, rotation = rig.translation.copy(), rig.rotation.copy()
    translation[node], rotation[node] = now
    if rig.has_matrix[node]:
        matrix = rig.matrix.copy()
        # A matrix keeps its own scale, as translation and rotation beside a scale do.
        size = length(matrix[node, :3, :3])
        moved = from_frame(orthonormal_axes(place) * size[:, np.newaxis], place[3, :3])
        # An element of a matrix moves by up to four times as much as those of a quaternion.
        if np.abs(moved - matrix[node]).max() > 4.0 * _SAME_POSITION * max(1.0, float(np.abs(moved).max())):
            matrix[node] = moved
            # What a clip plays that has other channels of the node.
            rig = replace(rig, translation=translation, rotation=rotation)
        return replace(rig, matrix=matrix)
    if all(np.array_equal(a, b) for a, b in zip(was, now, strict=True)):
        return rig
    return replace(rig, translation=translation, rotation=rotation)


class NewNodes:
    """Nodes that are added to a rig at once, parents first: one by one would cost their number squared.

    zero: where nodes of both stand while controls are zero, (4, 4), once needed.
    """

    def __init__(self, rig: Rig) -> None:
        self.rig, self.first = rig, len(rig)
        self.taken: dict[int, set[str]] = {}
        self.names: list[str] = []
        self.parents: list[int] = []
        self.parts: list[tuple[Floats, Floats]] = []
        self.records: dict[int, Record] = {}
        self.shapes: dict[int, Shape] = {}
        self.zero: dict[int, Floats] = {-1: np.eye(4)}
        self._controls = set(rig.nodes_of("control"))

    def add(self, name: str, parent: int, record: Record, place: Floats | None, noise: float = 0.0) -> int:
        """A new node, and its index. place: its local matrix, (4, 4); None: its parent's own."""
        node = self.first + len(self.names)
        taken = self._taken(parent)
        self.names.append(free_of(taken, self.rig.rules.valid_name(name)))
        taken.add(self.names[-1])
        self.parents.append(parent)
        self.parts.append((np.zeros(3), IDENTITY))
        self.records[node] = record
        above = self.unposed(parent)
        if place is not None:
            self.parts[-1] = settled(self.parts[-1], place, noise)
            above = multiply(compose(*self.parts[-1], np.ones(3)), above)
        self.zero[node] = above
        return node

    def _taken(self, parent: int) -> set[str]:
        """The names that children of a node may not have: one set for all of a skeleton."""
        while parent >= self.first:
            parent = self.parents[parent - self.first]
        skeleton = self.rig.skeleton_of[parent] if parent >= 0 else -1
        if skeleton not in self.taken:
            self.taken[skeleton] = self.rig.names_beside(parent)
        return self.taken[skeleton]

    def unposed(self, node: int) -> Floats:
        """The world matrix, (4, 4), that a node (−1: none) has while all controls are zero."""
        path = []
        while node not in self.zero:
            path.append(node)
            node = int(self.rig.parents[node])
        world = self.zero[node]
        for node in reversed(path):
            world = world if node in self._controls else multiply(self.rig.normalised_local[node], world)
            self.zero[node] = world
        return world

    def stood(self, rig: Rig) -> Rig:
        """The same rig, with nodes elsewhere than before."""
        if rig is not self.rig:
            self.rig = rig
            self.zero = {node: at for node, at in self.zero.items() if node < 0 or node >= self.first}
        return rig

    def added(self, rig: Rig) -> Rig:
        """The rig, as it is now, with the nodes."""
        if not self.names:
            return rig
        translation, rotation = (np.array(rows) for rows in zip(*self.parts, strict=True))
        rig = rig.with_nodes(self.names, self.parents, translation, rotation)
        pending = replace(rig.pending, shapes={**rig.pending.shapes, **self.shapes})
        stored = {node: record.to_dict() for node, record in self.records.items()}
        return replace(rig, metadata={**rig.metadata, **stored}, pending=pending)


def refuse_taken(rig: Rig, name: str, own: int | None = None, *, parent: int = -1) -> None:
    """UsageError for a name that a user has given to a child of a node, and another node has."""
    if rig.rules.valid_name(name) in {rig.names[node] for node in rig.beside(parent) if node != own}:
        raise UsageError(f"--name {name}: another node is called so")


def call(rig: Rig, targets: Mapping[int, str], rule: str, report: Report) -> Rig:
    """Give controls the names that a rule makes, with their offsets; those that a user has renamed stay.

    UsageError where the rule gives several one name, or one that another node has.
    """
    names = {node: rig.rules.valid_name(name) for node, name in targets.items()}
    names = {node: name for node, name in names.items() if _may_change(rig, node, name, report)}
    for name, count in Counter(names.values()).items():
        if count > 1:
            raise UsageError(
                f"--name {rule}: {count} controls would be called '{name}'; use {{joint}} in the rule"
            )
    others = {rig.names[node]: node for node in range(len(rig)) if node not in names}
    for name in names.values():
        if name in others:
            raise UsageError(f"--name {rule}: another node is called '{name}'")
    before, offsets = rig, {}
    every = list(rig.names)
    for node, name in names.items():
        above = int(rig.parents[node])
        if rig.type_of(above) == "offset" and rig.names[above].startswith(f"{rig.names[node]}_offset"):
            offsets[above] = f"{name}_offset"
        every[node] = name
    rig = replace(rig, names=tuple(every))
    used = Counter(every)
    for offset, name in offsets.items():
        used[every[offset]] -= 1
        if not used[every[offset]]:
            del used[every[offset]]
        every[offset] = free_of(used, name)
        used[every[offset]] += 1
    rig = replace(rig, names=tuple(every))
    rig = readdressed(before, rig, [*names, *offsets])
    return remembered(rig, names)


def remembered(rig: Rig, nodes: Iterable[int]) -> Rig:
    """The rig with what controls are called in their records, so that another name is known as a user's."""
    records = rig.records(ControlRecord)
    named = {node: replace(records[node], named=rig.names[node]).to_dict() for node in nodes}
    return replace(rig, metadata={**rig.metadata, **named}) if named else rig


def _may_change(rig: Rig, node: int, name: str, report: Report) -> bool:
    """Whether a control has the name that it was given, or none yet."""
    if rig.keys[node] is None or rig.names[node] == name:
        return True
    mine = rig.records(ControlRecord)[node].named == rig.names[node]
    if not mine or rig.is_joint[node]:
        why = "joints keep their names" if mine else "that name was not given by rigtri"
        report.warn("name-kept", f"'{rig.title(node)}' is not renamed to '{name}': {why}")
    return mine and not rig.is_joint[node]


def readdressed(before: Rig, rig: Rig, nodes: Iterable[int]) -> Rig:
    """The rig with metadata that finds renamed nodes where they are now."""
    now = {before.address(node): rig.address(node) for node in nodes}
    now = {old: new for old, new in now.items() if old != new}
    if not now:
        return rig
    metadata = {
        node: with_references(stored, lambda _, name: now.get(name, name))
        for node, stored in rig.metadata.items()
    }
    return replace(rig, metadata=metadata)
