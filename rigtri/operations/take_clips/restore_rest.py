"""Controls, offsets and poles put at rest where another file has them, whatever frame this one shows.

A DCC stores as rest what the current frame shows; and it may have made bones of an armature of controls,
which then are joints and children of another node.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.maths.matrices import decompose, from_frame, inverse, multiply, nearest_rotation
from rigtri.maths.similarity_fit import SAME_TURN, nearest_axis_turn
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.metadata import ADDED, ControlRecord, GroupRecord, PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.report import Report
from rigtri.text import list_names

# Where nothing stands otherwise than there but for rounding, there is nothing to report.
_SAME_PLACE = 1e-5
_SAME_AXES = np.eye(4)
# What animators pose: joints move as far as these stand from their rest.
POSED = frozenset({ControlRecord.type, PoleVectorRecord.type})
# What controls and constraints may move; a group only holds the others.
_MOVABLE = ADDED - {GroupRecord.type}


def with_rest_of(
    rig: Rig, described: Rig, of: Mapping[int, int], report: Report, turned: Floats | None = None
) -> Rig:
    """The rig with its nodes ``of`` (those of the other by theirs) at rest where they are there.

    turned: the rotation, (3, 3), that takes the rig's world to the other's, where it is known.

    What is not rigtri's keeps its own rest, and so does what no clip moves but controls and poles, so that
    keys below it mean what they did; all where there are no clips; and, with a warning, what has another
    parent there and cannot be placed by the worlds of both files.
    """
    moving = {track.node for clip in rig.clips for track in clip.tracks}
    zero = _ZeroPoses(rig, described, of, turned)
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    matrix, names, elsewhere = rig.matrix.copy(), [], []
    for theirs, node in sorted(of.items(), key=lambda pair: pair[1]):
        zero.enter(node, theirs)
        posed = rig.type_of(node) in POSED
        if not ((posed and moving) or node in moving):  # of no clip, no frame is stored as rest
            continue
        if rig.type_of(node) == "group":
            continue
        place = zero.place(node, theirs)
        same = _same(rig.local[node], described.local[theirs] if place is None else place, zero.size)
        if place is None:
            elsewhere += [] if same else [rig.title(node)]
            continue
        names += [] if same else [rig.title(node)]
        own = np.array_equal(place, described.local[theirs])
        if not own or rig.has_matrix[node] or described.has_matrix[theirs]:
            matrix[node] = place
            translation[node], rotation[node], scale[node] = decompose(matrix[node])
            # An exporter's unit and its inverse leave rounding, which keys at rest would differ from.
            near = np.abs(scale[node] - described.scale[theirs]).max() <= _SAME_PLACE
            scale[node] = described.scale[theirs] if near else scale[node]
        else:
            translation[node] = described.translation[theirs]
            rotation[node], scale[node] = described.rotation[theirs], described.scale[theirs]
    if names:
        report.reposed = True  # lines of controls go along
        report.added.append({"type": "described", "nodes": names})
    if elsewhere:
        text = f"The file of --rig has other parents for {list_names(elsewhere)}, and their rest pose is kept"
        more = "For a file that a DCC has exported: rigtri take-clips RIG --from IN"
        report.warn("rest-kept", f"{text}. {more}", geometry=True, names=elsewhere)
    return replace(rig, translation=translation, rotation=rotation, scale=scale, matrix=matrix)


class _ZeroPoses:
    """Where nodes of both files stand while controls are zero, each seen from what is not rigtri's.

    Nodes are entered parents first. between: what takes the other file's poses to the rig's, by node.
    """

    def __init__(self, rig: Rig, described: Rig, of: Mapping[int, int], turned: Floats | None) -> None:
        self.rig, self.described, self.of = rig, described, of
        self.ours, self.between = dict[int, Floats](), dict[int, Floats]()
        self.theirs = {node: _zero(described, node) for node in of}
        self.size = float(np.abs(described.world[:, 3, :3]).max(initial=0.0)) or 1.0
        self.worlds = _Worlds(rig, described, turned)

    def enter(self, node: int, theirs: int) -> None:
        """Note a node where it rests."""
        other = None if self._same_above(node, theirs) else self.worlds.local_of(node, theirs)
        unit = 1.0 if other is None else self._unit(node, theirs, other)
        self._put(node, theirs, self.rig.local[node], unit)

    def _put(self, node: int, theirs: int, local: Floats, unit: float) -> None:
        above = self._above(node)
        self.ours[node] = above if self.rig.type_of(node) == "control" else multiply(local, above)
        self.between[theirs] = self.between.get(int(self.described.parents[theirs]), _SAME_AXES)
        if not self._same_above(node, theirs):
            self.between[theirs] = multiply(inverse(self.theirs[theirs]), _scaled(self.ours[node], unit))

    def _same_above(self, node: int, theirs: int) -> bool:
        """Whether two nodes have the same above them, under whatever names; what changes no place is passed
        over.
        """
        here, there = _placing(self.rig, node), _placing(self.described, theirs)
        if here < 0 or there < 0:
            return here == there
        if there in self.of:
            return self.of[there] == here
        return self.rig.names[here] == self.described.names[there] or self.worlds.both.of.get(there) == here

    def _above(self, node: int) -> Floats:
        return self.ours.get(int(self.rig.parents[node]), _SAME_AXES)

    def place(self, node: int, theirs: int) -> Floats | None:
        """The local matrix, (4, 4), with which a node stands where it does there; None where that is unknown.

        That of the other file itself where nothing above stands otherwise.
        """
        parent, above, between = int(self.described.parents[theirs]), self._above(node), self.between[theirs]
        place: Floats | None = self.described.local[theirs]
        if not self._same_above(node, theirs):
            place = self.worlds.local_of(node, theirs)
        elif self.rig.type_of(node) != "control":
            there = multiply(self.theirs.get(parent, _SAME_AXES), between)
            if np.abs(above - there).max() > _SAME_PLACE * self.size:
                place = multiply(multiply(self.theirs[theirs], between), inverse(above))
        if place is not None:
            unit = self._unit(node, theirs, place)
            place = _scaled(place, 1.0 / unit) if unit != 1.0 else place
            self._put(node, theirs, place, unit)
        return place

    def _unit(self, node: int, theirs: int, place: Floats) -> float:
        """The unit of what holds a node in the rig, in which keys below it are: 1 where its own scale has it.

        Bones of controls in an armature with a scale have the scale that they have in the other file.
        place: where the node stands in the other file, seen from its parent in the rig.
        """
        files = self.rig.local[node], self.described.local[theirs], place
        ours, there, now = (length(matrix[:3, :3]) for matrix in files)
        unit = float(now.max()) / (float(there.max()) or 1.0)
        same = np.abs(ours - there).max() <= _SAME_PLACE
        even = np.abs(now - unit * there).max() <= _SAME_PLACE * unit
        return unit if same and even and abs(unit - 1.0) > _SAME_PLACE else 1.0


class _Worlds:
    """Where nodes of the other file stand in the rig's world while controls are zero."""

    def __init__(self, rig: Rig, described: Rig, turned: Floats | None) -> None:
        self.rig, self.described, self.turned = rig, described, turned
        self.moving = {t.node for clip in rig.clips for t in clip.tracks if np.ptp(t.values, axis=0).any()}

    @cached_property
    def both(self) -> Counterparts:
        return Counterparts(self.described, self.rig, self.turned)

    def local_of(self, node: int, theirs: int) -> Floats | None:
        """The place that a node has in the other file, seen from its parent in the rig, (4, 4).

        None where that is rigtri's, but not its group, or moves in a clip, or was put elsewhere by hand.
        """
        parent = int(self.rig.parents[node])
        above = self.rig.path_to_root(parent) if parent >= 0 else []
        if any(k in self.moving or self.rig.type_of(k) in _MOVABLE for k in above):
            return None
        held = next((k for k in above if k in self.both.back), -1)
        if held >= 0 and not self._in_place(held):
            return None
        here = multiply(self._zero_world(theirs), inverse(self.both.space))
        return multiply(here, inverse(self.rig.world[parent])) if parent >= 0 else here

    def _in_place(self, node: int) -> bool:
        """Whether a node stands where the other file has it, but for axes of its own."""
        there = multiply(self.described.world[self.both.back[node]], inverse(self.both.space))
        here = self.rig.world[node]
        turn = multiply(
            from_frame(nearest_rotation(there), np.zeros(3)),
            inverse(from_frame(nearest_rotation(here), np.zeros(3))),
        )[:3, :3]
        far = float(np.abs(there[3, :3] - here[3, :3]).max())
        return far <= SAME_TURN * self.size and bool(
            np.abs(turn - nearest_axis_turn(turn[np.newaxis])).max() <= SAME_TURN
        )

    @cached_property
    def size(self) -> float:
        return float(np.abs(self.rig.world[:, 3, :3]).max(initial=0.0)) or 1.0

    def _zero_world(self, theirs: int) -> Floats:
        top = next(
            (k for k in self.described.path_to_root(theirs) if self.described.type_of(k) not in ADDED), -1
        )
        zero = _zero(self.described, theirs)
        return multiply(zero, self.described.world[top]) if top >= 0 else zero


def _scaled(matrix: Floats, factor: float) -> Floats:
    """A matrix, (4, 4), with axes of other lengths."""
    return np.vstack([matrix[:3] * factor, matrix[3:]])


def _same(local: Floats, place: Floats, size: float) -> bool:
    """Whether a node stands at a place but for rounding."""
    apart = np.abs(local - place)
    return bool(apart[:3].max() <= _SAME_PLACE and apart[3].max() <= _SAME_PLACE * size)


def _zero(rig: Rig, node: int) -> Floats:
    """Where a node stands while all controls are zero, seen from what is not rigtri's, (4, 4)."""
    place = np.eye(4)
    while node >= 0 and rig.type_of(node) in ADDED:
        if rig.type_of(node) != "control":
            place = multiply(place, rig.local[node])
        node = int(rig.parents[node])
    return place


def _placing(rig: Rig, node: int) -> int:
    """The nearest node above that places what is below it, −1 for none."""
    above = int(rig.parents[node])
    while above >= 0 and rig.type_of(above) in ("", "group"):
        if np.abs(rig.local[above] - np.eye(4)).max() > 1e-6:
            break
        above = int(rig.parents[above])
    return above
