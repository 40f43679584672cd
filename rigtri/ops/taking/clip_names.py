"""Which clip of the rig a clip of the edited file is, also where a DCC has split it per object.

In this order: what the user said; the same name; ``Object|clip`` and ``clip_Object``; ``ObjectAction``,
which is the clip of the same times; without a name, the one clip that is left, of the same length. A clip
that is none of these is a new one.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from fnmatch import fnmatchcase

import numpy as np

from rigtri.errors import AmbiguousNameError, NameNotFoundError, UsageError
from rigtri.ops.taking.fitting import SAME_SIZE
from rigtri.ops.taking.pairing import as_usd
from rigtri.records import Clip, Track
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.timelines import PLAYED, Timeline, timelines

_COPY = re.compile(r"\.\d{3}$")
_ACTION = "Action"
_ARMATURE = "Armature"


@dataclass(frozen=True, eq=False)
class Taken:
    """Clips of the edited file that are one clip of the rig.

    home: None where the rig has none; key: of a new one.
    """

    name: str
    home: Timeline | None
    clip: Clip
    parts: tuple[str, ...]
    key: Hashable = None


def span(clip: Clip) -> tuple[float, float]:
    """The first and the last time of a clip, in its unit."""
    firsts = [float(t.times[0]) for t in clip.tracks if len(t.times)]
    lasts = [float(t.times[-1]) for t in clip.tracks if len(t.times)]
    return min(firsts, default=0.0), max(lasts, default=0.0)


def frame_of(clip: Clip) -> float:
    """The time between two keys where they are densest; 0 where no track has two."""
    distinct = {id(t.times): t.times for t in clip.tracks if len(t.times) > 1}
    return min((float(np.median(np.diff(times))) for times in distinct.values()), default=0.0)


class ClipNames:
    """The clips of two files. said: what the user calls clips of the edited file, by their names there:
    a name, ``#2`` for a clip by its number, "" for the one without a name.
    """

    def __init__(self, rig: Rig, edited: Rig, said: Mapping[str, str], report: Report) -> None:
        self.rig, self.edited, self.report = rig, edited, report
        self.ours, self.theirs = timelines(rig), timelines(edited)
        self.known: dict[str, list[Timeline]] = {}
        for timeline in self.ours:
            self.known.setdefault(timeline.name, []).append(timeline)
        self.objects = {name for name in (*rig.names, *edited.names) if name}
        for name in said:
            if name not in {t.name for t in self.theirs}:
                raise NameNotFoundError("clip", name, [t.name for t in self.theirs])
        for shared in [known for known in self.known.values() if len(known) > 1]:
            self.known |= {f"#{timeline.members[0]}": [timeline] for timeline in shared}
        self.said = {name: self._called(name, clip) for name, clip in said.items()}
        self.unclear: dict[str, str] = {}  # of parts of some clip: why it is not known of which
        self.paired: dict[str, str] = {}
        self.paired = self._pair()

    def _called(self, name: str, clip: str) -> str:
        """The name by which a clip that the user has said is known here."""
        if not clip:
            unnamed = [timeline.name for timeline in self.ours if not timeline.clip.name]
            if len(unnamed) == 1:
                return unnamed[0]
            which = f"give one of {', '.join(unnamed)}" if unnamed else "all of RIG's have names"
            raise UsageError(f"--as '{name}=' means the one clip without a name: {which}")
        numbered = [t.name for t in self.ours if clip == f"#{t.members[0]}" and clip not in self.known]
        return numbered[0] if numbered else clip

    def _pair(self) -> dict[str, str]:
        """The one clip of the edited file that has no counterpart, as the one of the rig that has none.

        Where one of them has no name, and their lengths are the same, to one frame.
        """
        homes = {timeline.name: self._home_of(timeline) for timeline in self.theirs}
        left = [t for name, found in self.known.items() for t in found if name not in homes.values()]
        lost = [t for t in self.theirs if homes[t.name] not in self.known and t.name not in self.said]
        if len(left) != 1 or len({homes[t.name] for t in lost}) != 1 or self._one_timeline:
            return {}
        if left[0].clip.name and all(t.clip.name for t in lost):
            return {}
        factor = self.rig.per_second / self.edited.per_second
        spans = [span(t.clip) for t in lost]
        theirs = (max(end for _, end in spans) - min(start for start, _ in spans)) * factor
        start, end = span(left[0].clip)
        near = max(frame_of(t.clip) for t in self.theirs) * factor * (1.0 + SAME_SIZE)
        return {} if abs(end - start - theirs) > near else {t.name: left[0].name for t in lost}

    def _tell(self, together: Mapping[str, Sequence[Timeline]]) -> None:
        """Tell of clips that were not known by name."""
        left = [name for name in self.known if name not in together]
        for name, parts in together.items():
            called = f"'{parts[0].name}'"
            if parts[0].name in self.paired:
                self.report.warn(
                    "clip-paired",
                    f"EDITED's clip {called} was taken as '{name}', the only one of RIG that EDITED lacks, "
                    f"and of the same length. If it is a new one, say --as {called[:-1]}={parts[0].name}'",
                )
                continue
            for part in parts:
                if part.name in self.unclear:
                    self.report.warn("split-clip", self.unclear[part.name])
            unsaid = self.said.get(parts[0].name) != parts[0].name
            # What has no motion at all gets its one clip, whatever that is called.
            motionless = self._one_timeline and not self.ours
            if (
                name not in self.known
                and unsaid
                and not motionless
                and not any(p.name in self.unclear for p in parts)
            ):
                close = get_close_matches(name, list(self.known), n=3) or left[:3]
                hint = f" Did you mean {', '.join(map(repr, close))}?" if close else ""
                self.report.warn(
                    "new-clip",
                    f"RIG has no clip '{name}', so it gets a new one.{hint} "
                    f"Say which of RIG's it is with --as {called[:-1]}=CLIP'",
                )

    def taken(self, patterns: Sequence[str]) -> list[Taken]:
        """The clips to be taken, of those that a glob matches by either name."""
        names = {id(timeline): self._names(timeline) for timeline in self.theirs}
        for pattern in patterns:
            if not any(_matches(pattern, known) for known in names.values()):
                raise NameNotFoundError("clip", pattern, [name for known in names.values() for name in known])
        together: dict[str, list[Timeline]] = {}
        for timeline in self.theirs:
            known = names[id(timeline)]
            if not patterns or any(_matches(pattern, known) for pattern in patterns):
                together.setdefault(known[-1], []).append(timeline)
        if self._one_timeline:
            together = self._alone(together)
        self._tell(together)
        return [self._merged(name, parts) for name, parts in together.items()]

    @property
    def key(self) -> Hashable:
        """The key of a new clip: that of what plays at once where the file can have but one."""
        return PLAYED if self._one_timeline else None

    def _names(self, timeline: Timeline) -> tuple[str, ...]:
        """What a clip of the edited file is called: there, and in the rig, where names mean something."""
        known = self._home_of(timeline)
        return (known,) if self._one_timeline else (timeline.name, known)

    def _alone(self, together: dict[str, list[Timeline]]) -> dict[str, list[Timeline]]:
        """What becomes the one clip of a USD file: all parts of one name.

        Of several clips the one that has its name; UsageError where none has.
        """
        if not self.rig.clips and len(together) == 1:
            return together
        known = self.ours or self.rig.clips
        ours = known[0].name if known else ""
        if ours in together or len(together) == 1:
            name = ours if ours in together else next(iter(together))
            if left := [f"'{other}'" for other in together if other != name]:
                listed = ", ".join(left)
                self.report.warn("one-clip", f"A USD file has one clip; {listed} of EDITED were left out")
            return {ours: together[name]}
        listed = ", ".join(f"'{name}'" for name in together)
        raise UsageError(f"A USD file has one clip, EDITED has {listed}; choose one with --clip")

    @property
    def _one_timeline(self) -> bool:
        """Whether all that the rig plays is one, whatever it is called, as in USD."""
        clips = self.rig.clips
        return any(isinstance(clip.key, tuple) for clip in clips) if clips else self.rig.raw

    def _home_of(self, timeline: Timeline) -> str:
        """The clip of the rig that a clip of the edited file belongs to, or its own name."""
        name = timeline.name
        if name in self.said:
            return self.said[name]
        if name in self.paired:
            return self.paired[name]
        if name in self.known:
            return name
        if isinstance(timeline.clip.key, tuple) and len(self.ours) == 1:
            return self.ours[0].name  # a USD file has one clip, whose name tells nothing
        spelled = [known for known in self.known if _as_usd(known) == _as_usd(name)]
        if len(spelled) == 1:
            return spelled[0]
        return self._by_pattern(_COPY.sub("", name)) or self._by_times(timeline) or name

    def _by_pattern(self, name: str) -> str | None:
        if name in self.known:
            return name
        for part in name.split("|"):
            if part in self.known:
                return part
        for cut in range(len(name) - 1, 0, -1):
            object_ = _COPY.sub("", name[cut + 1 :])
            if name[cut] == "_" and (object_ in self.objects or object_ == _ARMATURE):
                known = name[:cut] in self.known
                if known or self._is_split(name[:cut]):
                    return name[:cut]
        return None

    def _is_split(self, clip: str) -> bool:
        """Whether several clips of the edited file are parts of one that the rig lacks."""
        return sum(t.name.startswith(f"{clip}_") for t in self.theirs) > 1

    def _by_times(self, timeline: Timeline) -> str | None:
        """The one clip with the times of an action that the DCC has named after its object."""
        name = _COPY.sub("", timeline.name)
        if not name.endswith(_ACTION) or name.removesuffix(_ACTION) not in self.objects:
            return None
        factor = self.rig.per_second / self.edited.per_second
        own = span(timeline.clip)
        near = max(frame_of(timeline.clip), *(frame_of(t.clip) for t in self.theirs)) * (1.0 + SAME_SIZE)
        found = [
            other.name
            for other in self.ours
            if all(abs(a - b / factor) <= near for a, b in zip(own, span(other.clip), strict=True))
        ]
        if len(found) == 1:
            return found[0]
        why = "several clips have" if found else "no clip has"
        self.unclear[timeline.name] = (
            f"'{timeline.name}' may be a part of another clip, but {why} its times; it is taken as a clip of "
            f"its own. Say which it is with --as '{timeline.name}=CLIP'"
        )
        return None

    def _merged(self, name: str, parts: list[Timeline]) -> Taken:
        homes = self.known.get(name, [])
        if len(homes) > 1:
            raise AmbiguousNameError("clip", name, [f"#{t.members[0]}" for t in homes])
        parts = sorted(parts, key=lambda part: part.name != name)
        tracks: dict[tuple[int, str], Track] = {}
        for part in parts:
            for track in part.clip.tracks:
                known = tracks.setdefault((track.node, track.path), track)
                if known is not track:
                    self.report.warn(
                        "two-parts",
                        f"'{self.edited.title(track.node)}' has keys in more than one part of '{name}' "
                        f"({', '.join(p.name for p in parts)}); those of the first were taken",
                    )
        clip = Clip(name, tuple(tracks.values()))
        return Taken(name, homes[0] if homes else None, clip, tuple(part.name for part in parts), self.key)


def _as_usd(name: str) -> str:
    """A name as exporters to USD change it, without the underscore before a digit."""
    return as_usd(name).strip("_")


def _matches(pattern: str, names: Sequence[str]) -> bool:
    return pattern in names or any(fnmatchcase(name, pattern) for name in names)
