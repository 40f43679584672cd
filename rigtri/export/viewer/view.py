"""From files to the page that shows them: what is read of each, how the page begins, what it is without."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rigtri.errors import UsageError
from rigtri.evaluation.timelines import timeline_and_time
from rigtri.export.viewer.page import Shown, page
from rigtri.export.viewer.page_data import clip_names, clip_place, facts
from rigtri.files.input_stream import opened, title
from rigtri.formats import ReadOptions, read
from rigtri.model.rig import Rig
from rigtri.operations.pose import warn_outside_clip
from rigtri.report import Report

# Warnings that the page shows, too: they are of what is seen there.
# three.js walks a tree of nodes by calls within calls, of which browsers allow some 2,400.
DEEPEST = 2000
_TOO_DEEP = "the page cannot show more than some 2,400, for three.js ends there"
_ON_PAGE = ("no-joints", "not-shown")


@dataclass(frozen=True)
class Begin:
    """How a page begins: a clip that plays, or a moment, CLIP@TIME, that stands still; else at rest."""

    clip: str | None = None
    pose: str | None = None

    def checked(self) -> Begin:
        """UsageError for both."""
        if self.clip is not None and self.pose is not None:
            raise UsageError("give --clip or --pose, not both")
        return self


def view(
    path: Path | str,
    *,
    against: Path | str | None = None,
    clip: str | None = None,
    pose: str | None = None,
    limit: float = 100.0,
    options: ReadOptions | None = None,
    report: Report | None = None,
) -> str:
    """The HTML page that shows a file, as `rigtri view` writes it; to be written as UTF-8.

    against: what the file was before. clip: play it from the start; pose: stand still at CLIP@TIME, in
    seconds (USD: time codes). limit: megabytes that the files may have. What the page cannot show is a
    warning of the report. Raises FileError, NameNotFoundError (a clip), UsageError (files too large).
    """
    text, _ = shown_page(
        [path] if against is None else [path, against],
        begin=Begin(clip, pose),
        limit=limit,
        options=options or ReadOptions(),
        report=report if report is not None else Report(),
    )
    return text


def shown_page(
    sources: Sequence[Path | str], *, begin: Begin, limit: float, options: ReadOptions, report: Report
) -> tuple[str, list[Shown]]:
    """The page of a file, or of a file and what it was before; and what is in it of each.

    See `view`.
    """
    begin = begin.checked()
    options = replace(options, empty=True)
    shown: list[Shown] = []
    start: dict[str, Any] = {}
    for name in sources:
        with opened(name) as path:
            document = read(path, options)
            rig, embedded = document.rig, document.embedded()
            start = start or _start(rig, begin, report)
            called = title(name)
            for notice in document.warnings:
                report.warn(notice.code, f"{called}: {notice.text}")
            if not rig.is_joint.any():
                rest = "its nodes are shown" if len(rig) else "nor any node"
                report.warn("no-joints", f"{called} has no joints; {rest}")
            if (deep := max(rig.depth, default=0)) >= DEEPEST:
                report.warn("deep", f"{called}: {deep + 1} nodes hang one below the other; {_TOO_DEEP}")
            for text in embedded.lacking:
                report.warn("not-shown", f"{called}: {text}")
            content = embedded.content if isinstance(embedded.content, bytes) else path.read_bytes()
            shown.append(Shown(called, facts(rig), replace(embedded, content=content), clip_names(rig)))
    notices = [notice.text for notice in report.warnings if notice.code in _ON_PAGE]
    text = page(shown, **start, notices=notices, limit=limit)
    return text, shown


def _start(rig: Rig, begin: Begin, report: Report) -> dict[str, Any]:
    """The number of a clip, and the time to stand still at, in seconds."""
    if begin.clip is not None:
        return {"clip": clip_place(rig, rig.clip(begin.clip)), "time": None}
    timeline, time = timeline_and_time(rig, begin.pose or "rest")
    if timeline is None:
        return {"clip": -1, "time": None}
    time = warn_outside_clip(timeline, time, report)
    return {"clip": clip_place(rig, timeline.clip), "time": time / rig.rules.per_second}
