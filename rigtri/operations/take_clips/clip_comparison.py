"""A clip of the edited file compared with that of the rig, track by track, and its place in time."""

from __future__ import annotations

from functools import cached_property

from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.clip_matching import Taken
from rigtri.operations.take_clips.retargeting import Transfer
from rigtri.operations.take_clips.time_ranges import Clock, Pair, Ranges, ranges
from rigtri.operations.take_clips.tolerances import Tolerances
from rigtri.operations.take_clips.track_comparison import differing, same_knots, tangents_dropped


class Comparison:
    """One clip in both files. tolerance: a share of the size, by which the same may be off.

    clock: EDITED's times as the rig's, once `settled`.
    """

    def __init__(self, both: Counterparts, taken: Taken, tolerance: float) -> None:
        self.both, self.taken = both, taken
        self.clock = Clock(both.rig, both.other, taken)
        home = taken.home.clip if taken.home is not None else None
        self.transfer = Transfer(both, taken.clip, home, self.clock.times)
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

    def agree(self, pair: Pair) -> bool:
        """Whether a track gives the motion of RIG, by the clock as it is set."""
        was, bound = pair[0], self.tolerances.of(pair[1])
        now = self.clock.to_rig_time(pair[1])
        return not differing(was, now, bound).any() or self.same_knots(was, now, bound) is not None

    def same_knots(self, was: Track, now: Track, bound: Floats) -> float | None:
        """See `rigtri.operations.take_clips.track_comparison.same_knots`."""
        return same_knots(was, now, bound, dropped=self._dropped)

    @cached_property
    def _dropped(self) -> bool:
        return tangents_dropped((was, self.clock.to_rig_time(now)) for was, now in self.pairs)
