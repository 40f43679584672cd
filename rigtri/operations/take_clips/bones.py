"""Bones of two files side by side, in the bind poses or at rest, and the keys of what they end at.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import inverse, multiply, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length, normalise
from rigtri.model.animation import Path, key_values
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.bind_space import bind_poses

# Of its size: keys that differ by more are not one value.
_VARIES = 1e-2
# The sine of `MOST_DEGREES`: a joint that wanders farther from its mean direction, seen from the joint above,
# is no end of a bone, such as the target of an IK. A bone that stretches, or shakes a little, is one.
_WANDERS = 0.087


@dataclass(frozen=True, eq=False)
class Bone:
    """A joint seen from the nearest joint above that both files have, in that joint's axes in RIG.

    ours, theirs: (3,), in the bind poses where ``bound``, otherwise at rest, EDITED's as its constant keys
    hold it. unit: how long 1 is in the world. slides: it moves against the joint above.
    """

    ours: Floats
    theirs: Floats
    unit: float
    bound: bool
    slides: bool

    @property
    def sizes(self) -> tuple[float, float]:
        """How long it is in RIG and in EDITED, in the world."""
        return float(length(self.ours)) * self.unit, float(length(self.theirs)) * self.unit

    @property
    def holds(self) -> bool:
        """Whether its length and direction stay while it moves, or are those of the bind poses."""
        return self.bound or not self.slides


def bones_of(both: Counterparts, counts: Booleans, *, at_rest: bool = False) -> dict[int, Bone]:
    """The bones whose both ends are nodes of RIG that count, (n,); at_rest: none in the bind poses."""
    rig, held = both.rig, keys(both.other, "translation")
    other = _as_keyed(both.other, held)
    ours, theirs = bind_poses(rig), bind_poses(other)
    sliding = _wandering(keys(rig, "translation")), _wandering(held)
    found = {}
    for node in sorted(both.of):
        between, own, above = both.line(node)
        if above < 0 or not (counts[node] and counts[above]):
            continue
        here, there = both.of[node], both.of[above]
        bound = not at_rest and {node, above} <= both.bound
        mine = _offset(rig, ours if bound else {}, node, above)
        seen = transform_points(
            _offset(other, theirs if bound else {}, here, there), inverse(both.turns[above])
        )
        if np.isfinite(mine).all() and np.isfinite(seen).all():
            slides = bool(sliding[0] & {node, *own} or sliding[1] & {here, *between})
            unit = float(length(rig.world[above, 0, :3]))
            found[node] = Bone(mine, seen, unit if np.isfinite(unit) else 1.0, bound, slides)
    return found


def _offset(rig: Rig, bind: dict[int, Floats], node: int, above: int) -> Floats:
    """Where a node stands in the axes of another, (3,): in the bind pose, or at rest."""
    place, seen_from = (bind.get(k, rig.world[k]) for k in (node, above))
    return np.asarray(multiply(place, inverse(seen_from))[3, :3])


def keys(rig: Rig, path: Path) -> dict[int, Floats]:
    """The translations or scales, (k, 3), that nodes have in all clips."""
    found: dict[int, list[Floats]] = {}
    for track in (t for clip in rig.clips for t in clip.tracks if t.path == path):
        found.setdefault(track.node, []).append(key_values(track))
    return {node: np.concatenate(values) for node, values in found.items()}


def varying(keys: Mapping[int, Floats]) -> set[int]:
    """The nodes whose keys, (k, 3), differ by more than a share of their size."""
    return {
        node
        for node, values in keys.items()
        if float(np.ptp(values, axis=0).max()) > _VARIES * float(length(values).max())
    }


def _wandering(keys: Mapping[int, Floats]) -> set[int]:
    """The nodes whose keys, (k, 3), do not lie in one direction."""
    found = set()
    for node, values in keys.items():
        size = length(values)
        mean = normalise(values.cumsum(axis=0)[-1])
        beside = length(cross(values, mean))
        if not (beside <= _WANDERS * size).all() or not (dot(values, mean) >= 0).all():
            found.add(node)
    return found & varying(keys)


def _as_keyed(rig: Rig, keys: Mapping[int, Floats]) -> Rig:
    """The rig with nodes where its clips hold them, which is not always where they rest."""
    translation = rig.translation.copy()
    for node in keys.keys() - varying(keys):
        translation[node] = keys[node][0]
    return replace(rig, translation=translation)
