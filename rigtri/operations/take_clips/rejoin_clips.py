"""Clips that an exporter has split, renamed or moved in time, joined as the other file has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from rigtri.errors import GeometryError
from rigtri.evaluation.timelines import Timeline
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.clip_comparison import Comparison
from rigtri.operations.take_clips.clip_matching import ClipNames, Taken
from rigtri.operations.take_clips.lost_motion import warn_lost_motion
from rigtri.report import Report

# As that of take-clips: how far what nobody has edited may be off, as a share of the size.
_TOLERANCE = 1e-5
# Less than that between keys is not reported, as a share of the size: what bake leaves there, too.
_BETWEEN = 1e-3


def joined(
    rig: Rig,
    described: Rig,
    *,
    names: Mapping[str, str] | None = None,
    between: float = _BETWEEN,
    report: Report | None = None,
) -> Rig:
    """The rig with its clips as they are in ``described``, whose clips are known by name and by their times.

    names: what the user calls clips of the rig. between: what may be lost between keys without a word, as a
    share of the size. Clips of which ``described`` has none stay as they are, and so does what plays together
    anyway, as in USD; a clip whose start was moved starts where it did, by the rules of take-clips.
    Raises NameNotFoundError, UsageError (a name).
    """
    report = report if report is not None else Report()
    known = ClipNames(described, rig, names or {}, report)
    if known.one_timeline or any(isinstance(clip.key, tuple) for clip in rig.clips):
        return rig
    both = Counterparts(described, rig)
    clips: list[Clip | None] = list(rig.clips)
    for name, parts in known.together().items():
        homes = known.known.get(name, [])
        if len(homes) > 1 or _meet(parts):
            if not _is(parts, homes[0].clip.name if homes else name):
                called = ", ".join(f"'{part.name}'" for part in parts)
                text = f"{called} have keys of the same nodes; they were not taken together as '{name}'"
                report.warn("two-parts", text)
            continue
        title = homes[0].clip.name if homes else name
        whole = known.merged(name, parts)
        tracks = _as_at_home(both, whole, between, report)
        if _is(parts, title) and tracks is whole.clip.tracks:
            continue
        if not _is(parts, title):
            known.warn_unsure(name, parts)
            report.added.append({"type": "joined", "clip": title, "from": list(whole.parts)})
        for part in parts:
            clips[part.members[0]] = None
        first = parts[0].members[0]
        clips[first] = replace(rig.clips[first], name=title, tracks=tracks)
    if all(now is was for now, was in zip(clips, rig.clips, strict=True)):
        return rig
    report.reposed = True
    return replace(rig, clips=tuple(clip for clip in clips if clip is not None))


def _is(parts: Sequence[Timeline], title: str) -> bool:
    """Whether clips are one that is called so already."""
    return len(parts) == 1 and title in (parts[0].clip.name, parts[0].name)


def _as_at_home(both: Counterparts, whole: Taken, between: float, report: Report) -> tuple[Track, ...]:
    """The tracks of a clip in the time range of the other file's, with a warning about lost motion."""
    tracks = whole.clip.tracks
    if whole.home is None or not both.of:
        return tracks
    seen = Comparison(both, whole, _TOLERANCE)
    try:
        seen.settled()
    except GeometryError:  # its time is not known, so it stays
        return tracks
    warn_lost_motion(seen, between, report)
    if not seen.clock.shift:
        return tracks
    by = seen.clock.shift / seen.clock.factor
    report.added.append({"type": "moved", "clip": whole.home.clip.name, "by": by})
    return tuple(seen.clock.moved(track) for track in tracks)


def _meet(parts: Sequence[Timeline]) -> bool:
    """Whether two of some clips move the same, so that they cannot be parts of one."""
    driven = [(track.node, track.path) for part in parts for track in part.clip.tracks]
    return len(set(driven)) < len(driven)
