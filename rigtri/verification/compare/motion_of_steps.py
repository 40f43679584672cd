"""How far edits, one after the other, move on purpose what the first of them found.

Steps may add up, or undo each other, so that the largest motion of one says too little, or too much. The
source of the first is measured against the result of the last; its nodes are followed from step to step, as
each may rename, add or remove some.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace

import numpy as np

from rigtri.evaluation.timelines import timelines
from rigtri.frames.rescale import convert
from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip
from rigtri.model.dataclass import dataclass
from rigtri.model.pending_edits import Conversion
from rigtri.model.rig import Rig
from rigtri.verification.compare.compare import DocumentView, Source
from rigtri.verification.compare.correspondence import match
from rigtri.verification.compare.expected_result import (
    ExpectedResult,
    beside_result,
    source_and_result,
)
from rigtri.verification.compare.motion import motion_between
from rigtri.verification.compare.verdict import Motion


@dataclass(frozen=True, eq=False)
class Trail:
    """What some edits have made of the nodes of a file.

    nodes: where they are now, (n,), −1 for those that went; skins: likewise, (s,). free: those that may move,
    as far as they show nothing. bind_sizes, conversions: as in `PendingEdits`, of all edits. still: names of
    the clips that lost all their tracks, which files of some formats are without. moves: how many edits move
    anything on purpose.
    """

    nodes: Integers
    skins: Integers
    free: frozenset[int] = frozenset()
    bind_sizes: Mapping[int, Floats] = field(default_factory=dict)
    conversions: tuple[Conversion, ...] = ()
    still: tuple[str, ...] = ()
    moves: int = 0

    @classmethod
    def of(cls, rig: Rig) -> Trail:
        """Before any edit."""
        return cls(np.arange(len(rig)), np.arange(len(rig.skins)))

    def after(self, expected: ExpectedResult, written: Source, motion: Motion | None) -> Trail:
        """The same with one more edit. motion: what it moves on purpose."""
        pending, keys = expected.rig.pending, expected.source.rig.keys
        was, now = source_and_result(expected, written)
        found = match(was.rig, now.rig, by_key=not pending.strips)
        free = (first for first, node in enumerate(self.nodes) if node >= 0 and keys[node] in expected.moves)
        sizes = dict(self.bind_sizes)
        for first, skin in enumerate(self.skins.tolist()):
            if skin in pending.bind_sizes:
                sizes[first] = sizes.get(first, np.ones(3)) * pending.bind_sizes[skin]
        gone = [clip.name for clip in now.rig.clips[len(written.rig.clips) :]] if pending.strips else []
        return Trail(
            _followed(self.nodes, found.node),
            _followed(self.skins, found.skin),
            self.free | {*free},
            sizes,
            (*self.conversions, *([] if pending.conversion is None else [pending.conversion])),
            (*self.still, *gone),
            self.moves + (motion is not None and motion.deviation != 0),
        )

    def motion(self, source: Source, written: Source, rig: Rig) -> Motion:
        """How far the result of the last edit looks otherwise than the source of the first.

        rig: as the last edit has made it in memory. The axes of nodes that show nothing are not looked at:
        any edit may have given them others.
        """
        before = source.rig
        for conversion in self.conversions:
            before = convert(before, conversion)
        now, clips = written.rig, list(written.rig.clips)
        there = {clip.name for clip in clips}
        clips += [Clip(name, ()) for name in self.still if name not in there]
        keys = tuple(None if node < 0 else now.keys[node] for node in self.nodes.tolist())
        name = next((t.name for t in reversed(timelines(rig))), "")
        lasting = DocumentView(written, replace(now, clips=tuple(clips)))
        was, made = beside_result(DocumentView(source, before), lasting, keys, name, self.bind_sizes)
        return motion_between(was, made, axes=False, free=self.free)


def _followed(places: Integers, onto: Integers) -> Integers:
    """Where what stood at some places is now; ``onto``: where each place went, −1 for nowhere."""
    if not len(onto):
        return np.full(len(places), -1)
    return np.where(places < 0, -1, onto[places])
