"""Files whose twist joints do not turn: what a change of their weights must leave as it was.

Weights that go from a joint to its twist joints change how a twisted pose looks, on purpose. While
the twist joints stand still, at rest and in every clip, nothing may.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rigtri.compare import Comparison, Source, verify
from rigtri.records import Mesh
from rigtri.rig import Rig
from rigtri.scenery import Scenery
from rigtri.twist import is_twist


class Stilled:
    """A document in which no clip turns a twist joint."""

    def __init__(self, document: Source) -> None:
        self._document = document
        still = {node for node, note in document.rig.notes.items() if is_twist(note)}
        self._rig = replace(
            document.rig,
            clips=tuple(
                replace(clip, tracks=tuple(track for track in clip.tracks if track.node not in still))
                for clip in document.rig.clips
            ),
        )

    @property
    def rig(self) -> Rig:
        return self._rig

    def meshes(self) -> Sequence[Mesh]:
        return self._document.meshes()

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        return self._document.outlines(closely=closely)

    def scenery(self, *, closely: bool = False) -> Scenery:
        return self._document.scenery(closely=closely)


def check_split(before: Source, after: Source) -> Comparison:
    """Compare a file with what a split of weights made of it, point for point, while no twist joint turns.

    ``moved`` says how far points are from where they were with all twist joints turning.
    """
    result = verify(Stilled(before), Stilled(after))
    return replace(result, moved=verify(before, after).deviation)
