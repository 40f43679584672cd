"""Which clip of the rig a clip of the edited file is, also where a DCC has split it per object.

In this order: what the user names; the same name; ``Object|clip`` and ``clip_Object``; a name that the DCC
made up (`take_clips.generated_names`), which is the clip of the same times; without a name, the one clip
that is left, of the same length. A clip that is none of these is a new one; so are all made-up ones
of the same times together.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping, Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase

import numpy as np

from rigtri.errors import AmbiguousNameError, GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.timelines import PLAYED, Timeline, timelines
from rigtri.model.animation import Clip, Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.generated_names import MadeNames, span
from rigtri.operations.take_clips.node_matching import as_usd, composed
from rigtri.recognition.one_character import titles
from rigtri.report import Report
from rigtri.text import and_more, list_names

_NUMBER = re.compile(r"#[0-9]+$")


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


class ClipNames:
    """The clips of two files. user_names: the user's names for clips of EDITED, by their names there or
    globs: a name, ``#2`` for a clip by its number, "" for the one without a name.
    """

    def __init__(self, rig: Rig, edited: Rig, user_names: Mapping[str, str], report: Report) -> None:
        self.rig, self.edited, self.report = rig, edited, report
        self.ours, self.theirs = timelines(rig), timelines(edited)
        self.known: dict[str, list[Timeline]] = {}
        for timeline in self.ours:
            self.known.setdefault(timeline.name, []).append(timeline)
        for shared in [known for known in self.known.values() if len(known) > 1]:
            self.known |= {f"#{timeline.members[0]}": [timeline] for timeline in shared}
        self.played = self._played()
        self.user_names = self._named_by_user(user_names)
        self.made = MadeNames(edited, self.theirs, {*rig.names, *edited.names} - {""})
        self.unclear: dict[str, str] = {}  # of parts of some clip: why it is not known of which
        self.paired: dict[str, str] = {}  # of clips that were matched by something else than a name: why
        self.unmatched: dict[str, str] = {}  # of clips that RIG has not: which it may be
        self.homes = {id(timeline): self._home_of(timeline) for timeline in self.theirs}
        self._gather()
        self._pair()

    # --- names that the user gives

    def _named_by_user(self, user_names: Mapping[str, str]) -> dict[str, str]:
        """The clips of the edited file that the user has named, and what they are known as here."""
        found: dict[str, str] = {}
        for name, clip in user_names.items():
            hits = [t for t in self.theirs if matches(name, t, (t.name,), self.theirs)]
            if not hits:
                raise NameNotFoundError("clip", name, [t.name for t in self.theirs])
            for timeline in hits:
                found[timeline.name] = self._called(timeline.name, clip)
        return found

    def _called(self, name: str, clip: str) -> str:
        """The name by which a clip that the user has given is known here."""
        if not clip:
            unnamed = [timeline.name for timeline in self.ours if not timeline.clip.name]
            if len(unnamed) == 1:
                return unnamed[0]
            which = f"give one of {', '.join(unnamed)}" if unnamed else "all of RIG's have names"
            raise UsageError(f"--as '{name}=' means the one clip without a name: {which}")
        if clip in self.known or clip == name or not _NUMBER.match(clip):
            return clip
        numbered = {f"#{t.members[0]}": t.name for t in self.ours}
        if clip not in numbered:
            every = [word for number, known in numbered.items() for word in (number, known)]
            raise NameNotFoundError("clip of RIG", clip, every)
        return numbered[clip]

    # --- which is which

    def _home_of(self, timeline: Timeline) -> str:
        """The clip of the rig that a clip of the edited file belongs to, or its own name."""
        name = timeline.name
        if name in self.user_names:
            return self.user_names[name]
        if name in self.known:
            return name
        if isinstance(self.edited.clips[timeline.members[0]].key, tuple) and len(self.ours) == 1:
            return self.ours[0].name  # a USD file has one clip, whose name means nothing
        for spell in (composed, _as_usd):
            spelled = [known for known in self.known if spell(known) == spell(name)]
            if len(spelled) == 1:
                return spelled[0]
        if part := self.made.part_of(name, self.known):
            return part
        if part := self.made.part_of(name, self.played):
            return self.played[part]
        return self._by_times(timeline) or name

    def _played(self) -> dict[str, str]:
        """The clips of a USD rig by the animations that play in them, which a DCC names its clips after."""
        found: dict[str, set[str]] = {}
        for timeline in self.ours if self.one_timeline else ():
            for member in timeline.members:
                name = self.rig.clips[member].name
                for called in (name, name.rpartition("/")[2]):
                    found.setdefault(called, set()).add(timeline.name)
        return {called: name for called, (name, *others) in found.items() if not others}

    def _by_times(self, timeline: Timeline) -> str | None:
        """The one clip with the times of one whose name the DCC has made up."""
        merged = self.made.is_merged(timeline)
        if not merged and not self.made.is_of_object(timeline):
            return None
        found = [t.name for t in self.ours if self.made.alike(timeline.clip, t.clip, self._factor)]
        if len(found) == 1:
            if merged:
                self.paired[timeline.name] = "the only one with its times"
            return found[0]
        if not merged:
            why = "several clips have" if found else "no clip has"
            self.unclear[timeline.name] = (
                f"'{timeline.name}' may be a part of another clip, but {why} its times; it is taken as a "
                f"clip of its own. Name the clip with --as '{timeline.name}=CLIP'"
            )
        return None

    @property
    def _factor(self) -> float:
        """The rig's units of time in one of the edited file."""
        return self.rig.rules.per_second / self.edited.rules.per_second

    def _gather(self) -> None:
        """Parts that fit no clip, but each other, as one: the one that the user named, or a new one.

        A part of no length goes with those that have one, where these are one clip.
        """
        loose = [t for t in self.theirs if t.name in self.unclear]
        parts = [t for t in self.theirs if self.made.is_of_object(t)]
        named = [t for t in parts if t.name in self.user_names]
        homes = {self.homes[id(t)] for t in parts if t not in loose}
        for timeline in loose:
            start, end = span(timeline.clip)
            first = next(t for t in (*named, *loose) if self.made.alike(t.clip, timeline.clip))
            if start == end and len(homes) == 1:
                (self.homes[id(timeline)],) = homes
            elif first is timeline:
                continue
            else:
                self.homes[id(timeline)] = self.homes[id(first)]
            del self.unclear[timeline.name]
            if first.name in self.unclear and first is not timeline:
                self.unclear[first.name] = (
                    f"'{first.name}' and others of its times, each named after what it moves, fit no one "
                    f"clip; they are taken as one new clip. Name the clip with --as '{first.name}=CLIP'"
                )

    def _pair(self) -> None:
        """The one clip of the edited file that has no counterpart, as the one of the rig that has none.

        Where one of them has no name, and their lengths are the same, to one frame.
        """
        whole = [t for t in self.theirs if not self.made.is_of_object(t)]
        if self.one_timeline and len(self.ours) == len(whole) == 1 and whole[0].name not in self.user_names:
            self.homes[id(whole[0])] = self.ours[0].name  # the name of a USD file's one clip means nothing
        left = [t for name, found in self.known.items() for t in found if name not in self.homes.values()]
        lost = [
            t for t in self.theirs if self.homes[id(t)] not in self.known and t.name not in self.user_names
        ]
        if len(left) != 1 or len({self.homes[id(t)] for t in lost}) != 1 or self.one_timeline:
            return
        if left[0].clip.name and all(t.clip.name for t in lost):
            return
        spans = [span(t.clip) for t in lost]
        theirs = (max(end for _, end in spans) - min(start for start, _ in spans)) * self._factor
        start, end = span(left[0].clip)
        if abs(end - start - theirs) <= self.made.frame * self._factor:
            for timeline in lost:
                self.homes[id(timeline)] = left[0].name
                self.paired[timeline.name] = "the only one that is left, and of the same length"

    # --- warnings

    def warn_unsure(self, name: str, parts: Sequence[Timeline]) -> bool:
        """Warn of parts of a clip that were matched by something else than a name; False where none was."""
        called = parts[0].name
        if called in self.paired:
            self.report.warn(
                "clip-paired",
                f"Clip '{called}' was taken as '{name}', {self.paired[called]}. "
                f"If it is a new one, use --as '{called}={called}'",
            )
            return True
        unclear = [self.unclear[part.name] for part in parts if part.name in self.unclear]
        for text in unclear:
            self.report.warn("split-clip", text)
        return bool(unclear)

    def _warn_unmatched(self, together: Mapping[str, Sequence[Timeline]]) -> None:
        """Warn of clips that were not matched by name, and keep those for which RIG may need a new one."""
        left = [name for name in self.known if name not in self.homes.values()]
        # What has no motion at all gets its one clip, whatever that is called.
        motionless = self.one_timeline and not self.ours
        known = {*self.known, *(clip.name for clip in self.rig.clips if not clip.tracks)}
        for name, parts in together.items():
            called = parts[0].name
            if self.warn_unsure(name, parts) or name in known or motionless:
                continue
            if self.user_names.get(called) != called:
                hint = f" EDITED has none for {', '.join(map(repr, left[:3]))}." if left else ""
                if close := get_close_matches(name, list(self.known), n=3):
                    hint = f" Did you mean {', '.join(map(repr, close))}?"
                self.unmatched[name] = f"{hint} Name the clip of RIG with --as '{called}=CLIP'"

    def warn_new(self, name: str, *, written: bool) -> None:
        """Warn of a clip that was not matched by name, once it is known whether RIG gets it."""
        if name in self.unmatched:
            what = "so it gets a new one" if written else "and it moves nothing in EDITED, so none is written"
            self.report.warn("new-clip", f"RIG has no clip '{name}', {what}.{self.unmatched[name]}")

    # --- clips together

    def taken(self, patterns: Sequence[str]) -> list[Taken]:
        """The clips to be taken, of those that a glob matches by either name."""
        for pattern in patterns:
            if not any(self._is_requested(timeline, pattern) for timeline in self.theirs):
                every = [name for timeline in self.theirs for name in self._names(timeline)]
                raise NameNotFoundError("clip", pattern, every)
        together = self.together(patterns)
        if self.one_timeline and (len(self.ours) < 2 or not self.known.keys() >= together.keys()):
            together = self._alone(together)
        self._warn_unmatched(together)
        return [self.merged(name, parts) for name, parts in together.items()]

    def together(self, patterns: Sequence[str] = ()) -> dict[str, list[Timeline]]:
        """The clips of the edited file by what they are of the rig; those that a glob matches."""
        found: dict[str, list[Timeline]] = {}
        for timeline in self.theirs:
            if not patterns or any(self._is_requested(timeline, pattern) for pattern in patterns):
                found.setdefault(self.homes[id(timeline)], []).append(timeline)
        return found

    def _is_requested(self, timeline: Timeline, pattern: str) -> bool:
        return matches(pattern, timeline, self._names(timeline), self.theirs)

    @property
    def key(self) -> Hashable:
        """The key of a new clip: that of what plays at once where the file can have but one."""
        return PLAYED if self.one_timeline else None

    def _names(self, timeline: Timeline) -> tuple[str, ...]:
        """What a clip of the edited file is called: there, and in the rig."""
        return timeline.name, self.homes[id(timeline)]

    def _alone(self, together: dict[str, list[Timeline]]) -> dict[str, list[Timeline]]:
        """What becomes the one clip of a USD file: all parts of one name. UsageError for several clips."""
        if not self.rig.clips and len(together) == 1:
            return together
        if len(together) > 1:
            raise UsageError(self._which_one([part for parts in together.values() for part in parts]))
        if len(self.ours) > 1:
            (name,), ours = together, ", ".join(f"'{name}'" for name in self.known)
            raise UsageError(f"Instances of RIG play {ours}: say which '{name}' is with --as '{name}=CLIP'")
        known = self.ours or self.rig.clips
        return {known[0].name if known else "": parts for parts in together.values()}

    def _which_one(self, parts: Sequence[Timeline]) -> str:
        """That EDITED has several clips and RIG's format but one, and how to choose."""
        listed, several = ", ".join(f"'{part.name}'" for part in parts), titles(self.rig)
        text = f"A USD file has one clip, EDITED has {listed}; choose one with --clip"
        driven = [(track.node, track.path) for part in parts for track in part.clip.tracks]
        if len(set(driven)) < len(driven):
            return text
        if len(several) > 1:
            text += f" and whose it is with --character ({and_more(several, 6)})"
        return f"{text}, or take all as one with --as '*={self.ours[0].name if self.ours else parts[0].name}'"

    @property
    def one_timeline(self) -> bool:
        """Whether all that the rig plays is one, whatever it is called, as in USD."""
        clips = self.rig.clips
        return any(isinstance(clip.key, tuple) for clip in clips) if clips else self.rig.rules.raw_quaternions

    def merged(self, name: str, parts: list[Timeline]) -> Taken:
        """Clips of the edited file as the one clip of the rig that they are.

        AmbiguousNameError where the rig has several of the name, GeometryError where parts differ.
        """
        homes = self.known.get(name, [])
        if len(homes) > 1:
            raise AmbiguousNameError("clip", name, [f"#{t.members[0]}" for t in homes])
        parts = sorted(parts, key=lambda part: part.name != name)
        tracks: dict[tuple[int, str], Track] = {}
        twice = dict[str, None]()
        for part in parts:
            for track in part.clip.tracks:
                if not _same(tracks.setdefault((track.node, track.path), track), track):
                    twice[self.edited.title(track.node)] = None
        if twice:
            called = ", ".join(f"'{p.name}' (#{p.members[0]})" for p in parts)
            raise GeometryError(
                f"{list_names(twice)} have other keys in each part of '{name}' ({called}), and only one "
                f"can be taken: choose it, e.g. --clip '#{parts[0].members[0]}', or give what is another "
                "clip another name in EDITED"
            )
        clip = Clip(name, tuple(tracks.values()))
        return Taken(name, homes[0] if homes else None, clip, tuple(part.name for part in parts), self.key)


def _same(a: Track, b: Track) -> bool:
    """Whether two tracks have the same keys."""
    return a is b or (
        a.interpolation == b.interpolation
        and np.array_equal(a.times, b.times)
        and np.array_equal(a.values, b.values)
    )


def _as_usd(name: str) -> str:
    """A name as exporters to USD change it, without the underscore before a digit."""
    return as_usd(name).strip("_")


def matches(pattern: str, timeline: Timeline, names: Sequence[str], every: Sequence[Timeline]) -> bool:
    """Whether a glob is a clip's by one of its names, or its number; a name that is there is no glob."""
    if pattern in names or pattern == f"#{timeline.members[0]}":
        return True
    return all(pattern != t.name for t in every) and any(fnmatchcase(name, pattern) for name in names)
