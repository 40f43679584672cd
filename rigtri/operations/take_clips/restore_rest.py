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
from rigtri.model.metadata import ADDED
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.messages import list_names
from rigtri.report import Report

# Where nothing stands otherwise than there but for rounding, there is nothing to report.
_SAME_PLACE = 1e-5


def with_rest_of(rig: Rig, described: Rig, of: Mapping[int, int], report: Report) -> Rig:
    """The rig with its nodes ``of`` (those of the other by theirs) at rest where they are there.

    What is not rigtri's keeps its own rest, and so does what no clip moves but controls, so that keys
    below it mean what they did; all where there are no clips; and, with a warning, what has another parent
    there and cannot be placed by the worlds of both files.
    """
    moving = {track.node for clip in rig.clips for track in clip.tracks}
    worlds = _Worlds(rig, described)
    # Zero poses seen from what is not rigtri's, and what takes those of the other to the rig's.
    ours, theirs_at = dict[int, Floats](), {node: _zero(described, node) for node in of}
    between = dict[int, Floats]()
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    matrix, names, elsewhere = rig.matrix.copy(), [], []
    size = float(np.abs(described.world[:, 3, :3]).max(initial=0.0)) or 1.0
    for theirs, node in sorted(of.items(), key=lambda pair: pair[1]):
        is_control = rig.type_of(node) == "control"
        above = ours.get(int(rig.parents[node]), np.eye(4))
        ours[node] = above if is_control else multiply(rig.local[node], above)
        their_parent = int(described.parents[theirs])
        between[theirs] = between.get(their_parent, np.eye(4))
        parent = multiply(theirs_at.get(their_parent, np.eye(4)), between[theirs])
        same_above = _same_above(rig, described, node, theirs)
        if not same_above:
            between[theirs] = multiply(inverse(theirs_at[theirs]), ours[node])
        if not ((is_control and moving) or node in moving):  # of no clip, no frame is stored as rest
            continue
        if rig.type_of(node) == "group":
            continue
        place = described.local[theirs]
        moved = not is_control and np.abs(above - parent).max() > _SAME_PLACE * size
        if not same_above:
            seen, moved = worlds.local_of(node, theirs), True
            if seen is None:
                if not _same(rig.local[node], place, size):
                    elsewhere.append(rig.title(node))
                continue
            place = seen
            between[theirs] = multiply(inverse(theirs_at[theirs]), multiply(place, above))
        elif moved:
            place = multiply(multiply(theirs_at[theirs], between[theirs]), inverse(above))
        if not _same(rig.local[node], place, size):
            names.append(rig.title(node))
        if not is_control:
            ours[node] = multiply(place, above)
        if moved or rig.has_matrix[node] or described.has_matrix[theirs]:
            matrix[node] = place
            translation[node], rotation[node], scale[node] = decompose(matrix[node])
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


class _Worlds:
    """Where nodes of the other file stand in the rig's world while controls are zero."""

    def __init__(self, rig: Rig, described: Rig) -> None:
        self.rig, self.described = rig, described
        self.moving = {t.node for clip in rig.clips for t in clip.tracks if np.ptp(t.values, axis=0).any()}

    @cached_property
    def both(self) -> Counterparts:
        return Counterparts(self.described, self.rig)

    def local_of(self, node: int, theirs: int) -> Floats | None:
        """The place that a node has in the other file, seen from its parent in the rig, (4, 4).

        None where that is rigtri's, or moves in a clip, or was put elsewhere in the world by hand.
        """
        parent = int(self.rig.parents[node])
        above = self.rig.path_to_root(parent) if parent >= 0 else []
        if any(k in self.moving or self.rig.type_of(k) in ADDED for k in above):
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


def _same_above(rig: Rig, described: Rig, node: int, theirs: int) -> bool:
    """Whether the parents of two nodes have one name; what changes no place is passed over."""
    return _placing(rig, node) == _placing(described, theirs)


def _placing(rig: Rig, node: int) -> str:
    """The name of the nearest node above that places what is below it; "" for none."""
    above = int(rig.parents[node])
    while above >= 0 and rig.type_of(above) in ("", "group"):
        if np.abs(rig.local[above] - np.eye(4)).max() > 1e-6:
            break
        above = int(rig.parents[above])
    return rig.names[above] if above >= 0 else ""
