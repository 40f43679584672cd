"""Clips that an exporter has split per object as the clips that they are, under the names of another file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from rigtri.ops.taking.clip_names import ClipNames
from rigtri.records import Clip
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.timelines import Timeline


def joined(
    rig: Rig, described: Rig, *, names: Mapping[str, str] | None = None, report: Report | None = None
) -> Rig:
    """The rig with its clips as they are in ``described``, whose clips are known by name and by their times.

    names: what the user calls clips of the rig. Clips of which ``described`` has none stay as they are, and
    so does what plays together anyway, as in USD. Raises NameNotFoundError, UsageError (a name).
    """
    report = report if report is not None else Report()
    known = ClipNames(described, rig, names or {}, report)
    if known.one_timeline or any(isinstance(clip.key, tuple) for clip in rig.clips):
        return rig
    clips: list[Clip | None] = list(rig.clips)
    for name, parts in known.together().items():
        homes = known.known.get(name, [])
        title = homes[0].clip.name if homes else name
        if len(parts) == 1 and title in (parts[0].clip.name, parts[0].name):
            continue
        if len(homes) > 1 or _meet(parts):
            called = ", ".join(f"'{part.name}'" for part in parts)
            text = f"{called} have keys of the same nodes; they were not taken together as '{name}'"
            report.warn("two-parts", text)
            continue
        known.tell_unsure(name, parts)
        for part in parts:
            clips[part.members[0]] = None
        whole = known.merged(name, parts)
        first = rig.clips[parts[0].members[0]]
        clips[parts[0].members[0]] = replace(first, name=title, tracks=whole.clip.tracks)
        report.added.append({"type": "joined", "clip": title, "from": list(whole.parts)})
    if all(now is was for now, was in zip(clips, rig.clips, strict=True)):
        return rig
    report.reposed = True
    return replace(rig, clips=tuple(clip for clip in clips if clip is not None))


def _meet(parts: Sequence[Timeline]) -> bool:
    """Whether two of some clips move the same, so that they cannot be parts of one."""
    driven = [(track.node, track.path) for part in parts for track in part.clip.tracks]
    return len(set(driven)) < len(driven)
