"""Names that a DCC generates for clips: of objects, hardly of the clip.

Clips that are split per object are ``Object|clip`` or ``clip_Object``. Blender names an action after its
object (``hand_ctlAction``), an animation of each object as the object (Animation Mode "Scene"), and what it
has merged ``Animation`` or ``Scene``.
"""

from __future__ import annotations

import re
from collections.abc import Container, Sequence

import numpy as np

from rigtri.evaluation.timelines import Timeline
from rigtri.maths.arrays import Integers
from rigtri.maths.similarity_fit import SAME_SIZE
from rigtri.model.animation import Clip
from rigtri.model.rig import Rig

_COPY = re.compile(r"\.[0-9]{3}$")
_ACTION = "Action"
_ARMATURE = "Armature"
_MERGED = ("Animation", "Scene")


def span(clip: Clip) -> tuple[float, float]:
    """The first and the last time of a clip, in its unit."""
    firsts = [float(t.times[0]) for t in clip.tracks if len(t.times)]
    lasts = [float(t.times[-1]) for t in clip.tracks if len(t.times)]
    return min(firsts, default=0.0), max(lasts, default=0.0)


def frame_of(clip: Clip) -> float:
    """The time between two keys where they are densest; 0 where no track has two."""
    distinct = {id(t.times): t.times for t in clip.tracks if len(t.times) > 1}
    return min((float(np.median(np.diff(times))) for times in distinct.values()), default=0.0)


def without_copy(name: str) -> str:
    """A name without the number that Blender gives a second thing of one name."""
    return _COPY.sub("", name)


class MadeNames:
    """The clips of a file, ``every``, whose names a DCC made up. objects: the names of all nodes."""

    def __init__(self, edited: Rig, every: Sequence[Timeline], objects: set[str]) -> None:
        self.edited, self.every, self.objects = edited, every, objects
        self.alone = [t for t in every if self._moves_only(without_copy(t.name), t)]

    def part_of(self, name: str, known: Container[str]) -> str | None:
        """The clip that a part belongs to by its name: one of some, or one that has several parts."""
        name = without_copy(name)
        if name in known:
            return name
        for part in name.split("|"):
            if part in known:
                return part
        for cut in range(len(name) - 1, 0, -1):
            object_ = without_copy(name[cut + 1 :])
            if name[cut] == "_" and (object_ in self.objects or object_ == _ARMATURE):
                several = sum(t.name.startswith(name[: cut + 1]) for t in self.every) > 1
                if name[:cut] in known or several:
                    return name[:cut]
        return None

    def is_merged(self, timeline: Timeline) -> bool:
        """Whether it is all that plays, under a name for that."""
        return len(self.every) == 1 and timeline.name in _MERGED

    def is_of_object(self, timeline: Timeline) -> bool:
        """Whether it is named after what it moves."""
        name = without_copy(timeline.name)
        if name.endswith(_ACTION) and not {
            object_ := name.removesuffix(_ACTION),
            without_copy(object_),
        }.isdisjoint(self.objects):
            return True
        return len(self.alone) > 1 and any(timeline is other for other in self.alone)

    @property
    def frame(self) -> float:
        """One frame of this file, as the ends of clips give it: by so much they may be off."""
        return max(frame_of(timeline.clip) for timeline in self.every) * (1.0 + SAME_SIZE)

    def alike(self, a: Clip, b: Clip, factor: float = 1.0) -> bool:
        """Whether two clips run in the same time, to one frame; factor: b's units of time in one of a's."""
        return all(abs(x - y / factor) <= self.frame for x, y in zip(span(a), span(b), strict=True))

    def _moves_only(self, name: str, timeline: Timeline) -> bool:
        """Whether a clip moves nothing but nodes called so and those below them."""
        if name not in self.objects:
            return False
        below = self.edited.at_or_below(np.array([known == name for known in self.edited.names]))
        driven: Integers = np.array([track.node for track in timeline.clip.tracks])
        return bool(below[driven].all())
