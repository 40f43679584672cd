"""A clip of the edited file compared with that of the rig, track by track, and its place in time.

How far a track may be from the rig's and still count as the same has a reason each: what can be seen, how
well the axes of the two files are known, and what a format keeps of the numbers. docs/take-clips.md has
the measurements.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.evaluation.active_controls import controls_and_poles
from rigtri.evaluation.key_reduction import lever_arms, parent_sizes
from rigtri.maths.arrays import Booleans
from rigtri.maths.similarity_fit import SAME_PLACE, SAME_SIZE
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Track, key_values
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.clip_matching import Taken
from rigtri.operations.take_clips.morph_targets import SAME_WEIGHT, MorphPairs
from rigtri.operations.take_clips.proportions import Proportions
from rigtri.operations.take_clips.retargeting import Transfer
from rigtri.operations.take_clips.time_ranges import Clock, Pair, Ranges, ranges
from rigtri.operations.take_clips.track_comparison import (
    BY_HAND,
    MISSED,
    differing,
    lacking,
    same_knots,
    tangents_dropped,
)

# float32 has so much of a number of size 1, half so much.
_FLOAT, _HALF = 2.0**-23, 2.0**-11
# Three angles worked out of a float32 matrix give the rotation within so many bits, over the cosine of the
# middle one; measured: 7.2. Below the least cosine two axes count as one.
_ANGLE_NOISE, _LEAST_COSINE = 10.0 * _FLOAT, 16.0 * _FLOAT
# OpenUSD's sparse writer leaves a sample of an array of halves out that is no farther from the one before.
_SPARSE_HALF = 1e-2


class Tolerances:
    """The bounds for one clip. tolerance: how far things may move in the world, as a share of the size."""

    def __init__(self, both: Counterparts, transfer: Transfer, tolerance: float) -> None:
        self.both, self.transfer = both, transfer
        self.share = max(tolerance, SAME_PLACE)

    def of(self, track: Track, *, in_gaps: bool = False) -> Floats:
        """How far each key of a track of the rig, at the other file's times, may be off, (k,).

        in_gaps: how far what the rig has behind the key may be, and before the next one.
        """
        node, keys = track.node, len(track.times)
        if track.path == "weights":
            return np.full(keys, max(SAME_WEIGHT, self.share))
        if track.path == "translation":
            above = float(self._above[node])
            unit = above if np.isfinite(above) and above > 0 else 1.0
            return np.full(keys, self.share * self.both.size / unit)
        slack = self.both.slack(node)
        if track.path == "scale":
            return np.asarray(max(SAME_SIZE, self.share) + slack + self._halves(track, in_gaps))
        turn = self.share * self.both.size / float(self._reach[node])
        return np.asarray(turn + slack + self._angles(track))

    def unit_of(self, track: Track) -> float:
        """How large a number of the other file's track is here."""
        node = track.node
        if track.path not in ("translation", "scale"):
            return 1.0
        right = float(length(self.both.between(node)[0, :3]))
        size = right if track.path == "translation" else right * float(length(self.both.turns[node][0, :3]))
        return size if np.isfinite(size) else 1.0

    @cached_property
    def _above(self) -> Floats:
        return parent_sizes(self.both.rig)

    @cached_property
    def _reach(self) -> Floats:
        return lever_arms(self.both.rig, self.both.size)

    def _angles(self, track: Track) -> Floats:
        """What angles about three axes lose of turns of USD prims, (k,): much where two axes nearly meet."""
        both = self.both
        noise = np.zeros(len(track.times))
        if not both.other.rules.raw_quaternions:
            return noise
        theirs, _, above = both.line(track.node)
        prims = [k for k in (both.of[track.node], *theirs) if not both.other.is_joint[k]]
        if above >= 0 and self.transfer.is_carried(track.node) and not both.other.is_joint[both.of[above]]:
            prims.append(both.of[above])
        for prim in prims:
            x, y, z = np.moveaxis(self.transfer.local(prim, track.times)[:, 0, :3], -1, 0)
            with np.errstate(divide="ignore", invalid="ignore"):
                cosine = np.sqrt((x * x + y * y) / (x * x + y * y + z * z))
            noise = noise + _ANGLE_NOISE / np.maximum(np.nan_to_num(cosine), _LEAST_COSINE)
        return noise

    def _halves(self, track: Track, in_gaps: bool) -> Floats:
        """What the scales of a UsdSkel animation lose, (k,): halves, and fewer samples than frames."""
        both, theirs = self.both, self.both.of[track.node]
        lost = np.zeros(len(track.times))
        own = self.transfer.driven.get(theirs, {}).get("scale")
        if not (both.other.rules.raw_quaternions and both.other.is_joint[theirs]):
            return np.asarray(lost)
        now = np.abs(key_values(track)).max(axis=1, initial=0.0)
        lost = lost + _HALF * now
        if own is not None and len(own.times) < len(self.transfer.frames):
            # In the unit of their scales, which is not ours where a size stands between.
            sparse = _SPARSE_HALF * now.max() / max(float(np.abs(own.values).max()), _FLOAT)
            lost = lost + np.where(in_gaps | _repeats(own, track, self.transfer.frames[0]), sparse, 0.0)
        return np.asarray(lost)


class Comparison:
    """One clip in both files. tolerance: a share of the size, by which the same may be off.

    clock: EDITED's times as the rig's, once `settled`.
    """

    def __init__(self, bodies: Proportions, taken: Taken, tolerance: float) -> None:
        self.both, self.taken = bodies.both, taken
        both = self.both
        self.clock = Clock(both.rig, both.other, taken)
        home = taken.home.clip if taken.home is not None else None
        self.transfer = Transfer(bodies, taken.clip, home, self.clock.times)
        self.tolerances = Tolerances(both, self.transfer, tolerance)

    def settled(self) -> Ranges | None:
        """Settle where EDITED's clip lies; see `rigtri.operations.take_clips.time_ranges.ranges`."""
        return ranges(self.both.rig, self.taken, self.clock, lambda: self.pairs, self.agree)

    @cached_property
    def tracks(self) -> dict[tuple[int, str], Track]:
        """What drives each property of the rig in this clip."""
        home = self.taken.home
        return {(t.node, t.path): t for t in home.clip.tracks} if home is not None else {}

    @cached_property
    def nodes(self) -> list[int]:
        """The nodes of the rig that EDITED's clip moves."""
        return self.transfer.nodes()

    @cached_property
    def pairs(self) -> list[Pair]:
        """What both files have keys of, at EDITED's times."""
        theirs = [track for node in self.nodes for track in self.transfer.of(node).tracks]
        olds = ((self.tracks.get((now.node, now.path)), now) for now in theirs)
        return [(old, now) for old, now in olds if old is not None]

    @cached_property
    def morphs(self) -> list[Pair]:
        """The tracks of morph weights of meshes whose targets are the same ones in both files."""
        shapes = self.shapes
        tracks = [track for track in self.taken.clip.tracks if track.path == "weights"]
        homes = [(home, track) for track in tracks for home in shapes.homes.get(track.node, ())]
        pairs = [(self.tracks.get((home, "weights")), track) for home, track in homes]
        return [
            (was, replace(now, node=was.node, key=None))
            for was, now in pairs
            if was is not None
            and was.values.shape[-1] == now.values.shape[-1]
            and shapes.ours[was.node].names == shapes.theirs[now.node].names
        ]

    @cached_property
    def shapes(self) -> MorphPairs:
        """The meshes with morph targets of both files."""
        return MorphPairs(self.both.rig, self.both.other, self.both.of)

    def agree(self, pair: Pair) -> bool:
        """Whether a track gives the motion of RIG, by the clock as it is set."""
        was, now = pair[0], self.clock.to_rig_time(pair[1])
        return (
            not differing(was, now, self.tolerances.of(pair[1])).any()
            or self.same_knots(was, now, self.tolerances.of(pair[1], in_gaps=True)) is not None
        )

    @cached_property
    def controls(self) -> frozenset[int]:
        """The controls and pole vectors of the rig."""
        return controls_and_poles(self.both.rig)

    def changes(self, was: Track, now: Track, theirs: Track) -> tuple[Booleans, float | None]:
        """The keys of a track, (k,), that are not RIG's; how far RIG's spline is off where only that differs.

        now: ``theirs``, a track of EDITED's in RIG's axes, by the clock.
        """
        changed = differing(was, now, self.tolerances.of(theirs))
        gaps, unit = self.tolerances.of(theirs, in_gaps=True), self.tolerances.unit_of(theirs)
        changed |= lacking(was, now, self.frames, gaps, unit, self.by_hand)
        far = self.same_knots(was, now, gaps) if changed.any() else None
        return changed, None if far is not None and _beyond(was, now)[changed].any() else far

    @cached_property
    def frames(self) -> Floats:
        """The times, (f,), of EDITED's frames, by the clock."""
        return self.clock.times(self.transfer.joint_frames)

    def same_knots(self, was: Track, now: Track, bound: Floats) -> float | None:
        """See `rigtri.operations.take_clips.track_comparison.same_knots`."""
        return same_knots(was, now, bound, dropped=self._dropped, by_hand=self.by_hand)

    @property
    def by_hand(self) -> float:
        """How far apart, by the clock, keys are that no DCC has sampled."""
        return BY_HAND * self.both.rig.rules.per_second

    @cached_property
    def _dropped(self) -> bool:
        return tangents_dropped((was, self.clock.to_rig_time(now)) for was, now in self.pairs)


def _repeats(own: Track, track: Track, start: float) -> Booleans:
    """The keys of a track, (k,), at which a sample of EDITED's own may say what was at an earlier time.

    The sparse writer leaves out samples that are near the last one that it has written, which at first is the
    default. Before it goes on it writes that once more, where the last of these was; all others are true. Of
    a track that was worked out at other times any key may be between such. start: of the clip.
    """
    if not np.array_equal(own.times, track.times):
        return np.ones(len(track.times), dtype=bool)
    values = key_values(own)
    again = (values[1:] == values[:-1]).all(axis=1)
    return np.concatenate([[own.times[0] > start], again])


def _beyond(was: Track, now: Track) -> Booleans:
    """The keys of a track, (k,), before the other's first one or after its last."""
    return np.asarray((now.times < was.times[0] - MISSED) | (now.times > was.times[-1] + MISSED))
