"""One HTML page that holds everything: files, facts about them, and the program that shows them.

Nothing in it is fetched, and its policy forbids that. Text of the files is in it as JSON alone, in
which no ``<`` is left, or escaped; the program shows it as text.

Source: HTML, "Restrictions for contents of script elements"; Content Security Policy Level 3.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from rigtri._version import __version__
from rigtri.errors import FileError, UsageError, system_reason
from rigtri.evaluation.timelines import timeline_and_time
from rigtri.export.drawing.style import LEGEND, variables
from rigtri.export.viewer.page_data import clip_names, clip_number, facts
from rigtri.files.input_stream import opened, title
from rigtri.formats import Embedded, ReadOptions, read
from rigtri.model.arguments import typed
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.pose import warn_outside_clip
from rigtri.progress import begin_stage
from rigtri.report import Report
from rigtri.text import plain

MEGABYTE = 1_000_000
# three.js walks a tree of nodes by calls within calls, of which browsers allow some 2,400.
DEEPEST = 2000
_TOO_DEEP = "the page cannot show more than some 2,400, for three.js ends there"
# Warnings that the page shows, too: they are of what is seen there.
_ON_PAGE = ("no-joints", "not-shown")


@dataclass(frozen=True)
class Shown:
    """A file in the page: what it is called, its `facts`, what it consists of."""

    name: str
    facts: Mapping[str, Any]
    embedded: Embedded
    clips: Sequence[Mapping[str, str]] = ()


@dataclass(frozen=True)
class Begin:
    """How a page begins: a clip that plays, or a moment, CLIP@TIME, that stands still; else at rest."""

    clip: str | None = None
    at: str | None = None

    def checked(self) -> Begin:
        """UsageError for both."""
        if self.clip is not None and self.at is not None:
            raise UsageError("give --clip or --at, not both")
        return self


@typed
def view(
    path: Path | str,
    *,
    against: Path | str | None = None,
    clip: str | None = None,
    at: str | None = None,
    limit: float = 100.0,
    options: ReadOptions | None = None,
    report: Report | None = None,
) -> str:
    """The HTML page that shows a file, as `rigtri view` writes it; to be written as UTF-8.

    path: the file; options: how it is read. against: what the file was before. clip: play it from the
    start; at: stand still at CLIP@TIME, in seconds (USD: time codes). limit: megabytes that the files may
    have. What the page cannot show is a warning of the report. Raises FileError,
    NameNotFoundError (a clip), UsageError (files too large).
    """
    text, _ = shown_page(
        [path] if against is None else [path, against],
        begin=Begin(clip, at),
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
        begin_stage("read")
        with opened(name) as path:
            document = read(path, options)
            rig, embedded = document.rig, document.embedded()
            start = start or _start(rig, begin, report)
            called = title(name)
            report.sources += document.needed()
            for notice in document.warnings:
                report.warn(notice.code, f"{called}: {notice.text}")
            if not rig.is_joint.any():
                rest = "its nodes are shown" if len(rig) else "nor any node"
                report.warn("no-joints", f"{called} has no joints; {rest}")
            if (deep := max(rig.depth, default=0)) >= DEEPEST:
                report.warn("deep", f"{called}: {deep + 1} nodes are one below the other; {_TOO_DEEP}")
            for text in embedded.lacking:
                report.warn("not-shown", f"{called}: {text}")
            content = embedded.content if isinstance(embedded.content, bytes) else path.read_bytes()
            shown.append(Shown(called, facts(rig), replace(embedded, content=content), clip_names(rig)))
    begin_stage("make the page")
    notices = [notice.text for notice in report.warnings if notice.code in _ON_PAGE]
    text = _page(shown, **start, notices=notices, limit=limit)
    return text, shown


def _start(rig: Rig, begin: Begin, report: Report) -> dict[str, Any]:
    """The number of a clip, and the time to stand still at, in seconds."""
    if begin.clip is not None:
        return {"clip": clip_number(rig.clip(begin.clip)), "time": None}
    timeline, time = timeline_and_time(rig, begin.at or "rest")
    if timeline is None:
        return {"clip": -1, "time": None}
    time = warn_outside_clip(timeline, time, report)
    return {"clip": clip_number(timeline.clip), "time": time / rig.rules.per_second}


def _page(
    shown: Sequence[Shown],
    *,
    clip: int = -1,
    time: float | None = None,
    notices: Sequence[str] = (),
    limit: float = 100.0,
) -> str:
    """The page of a file, or of a file and what it was before.

    clip: the number of the one to begin with, −1 for the rest pose. time: in seconds, to stand still
    at; else it plays. UsageError where the files have more than ``limit`` megabytes.
    """
    _check_size(shown, limit)
    elements = _Elements()
    models = [elements.model(one) for one in shown]
    title = plain(" ← ".join(one.name for one in shown), one_line=True)
    content = {
        "title": title,
        "models": models,
        "start": {"clip": clip, "time": time},
        "notices": list(notices),
    }
    facts = f'<script type="application/json" id="facts">{_json(content)}</script>'
    decoders = {name for one in shown for name in one.embedded.decoders}
    # The decoder of meshopt is so small that it is in the page's own script.
    scripts = [*([_text("page.draco.js")] if "draco" in decoders else []), _text("page.js")]
    style = variables() + _text("page.css")
    words = {
        "policy": _policy(scripts, style, wasm=bool(decoders)),
        "version": __version__,
        "title": html.escape(f"{title} – rigtri view"),
        "style": style,
        "legend": "".join(f'<li class="mark-{name}">{words}</li>' for name, words in LEGEND.items()),
        "licences": html.escape(_text("page.js.LICENSES.txt").strip(), quote=False),
        "data": "\n".join([facts, *elements.found]),
        "scripts": "\n".join(f"<script>{script}</script>" for script in scripts),
    }
    return re.sub(r"@([a-z]+)@", lambda found: words[found[1]], _text("page.html"))


class _Elements:
    """Files as elements of the page, each under an id."""

    def __init__(self) -> None:
        self.found: list[str] = []

    def add(self, content: bytes | Path) -> str:
        name = f"file{len(self.found)}"
        text = base64.b64encode(_bytes(content)).decode("ascii")
        self.found.append(f'<script type="application/octet-stream" id="{name}">{text}</script>')
        return name

    def model(self, one: Shown) -> dict[str, Any]:
        embedded = one.embedded
        return {
            "name": one.name,
            "kind": embedded.kind,
            "decoders": list(embedded.decoders),
            "data": self.add(embedded.content),
            "files": [{"name": name, "id": self.add(content)} for name, content in embedded.files.items()],
            "clips": list(one.clips),
            **one.facts,
        }


def _policy(scripts: Sequence[str], style: str, *, wasm: bool) -> str:
    """What the page may do: run its own scripts, wear its own style, show what is in it."""
    run = [*map(_hash, scripts), *(["'wasm-unsafe-eval'"] if wasm else [])]
    return "; ".join(
        [
            "default-src 'none'",
            f"script-src {' '.join(run)}",
            f"style-src {_hash(style)}",
            "img-src data: blob:",
            "connect-src data: blob:",
            "base-uri 'none'",
            "form-action 'none'",
        ]
    )


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def _json(facts: object) -> str:
    """JSON that can end no element and begin no comment."""
    text = json.dumps(facts, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _text(name: str) -> str:
    return (files(__package__) / name).read_text(encoding="utf-8")


def _bytes(content: bytes | Path) -> bytes:
    if isinstance(content, bytes):
        return content
    try:
        return content.read_bytes()
    except OSError as error:
        raise FileError(f"{content} cannot be read: {system_reason(error)}") from error


def _check_size(shown: Sequence[Shown], limit: float) -> None:
    parts = [part for one in shown for part in (one.embedded.content, *one.embedded.files.values())]
    whole = sum(len(part) if isinstance(part, bytes) else part.stat().st_size for part in parts)
    if whole > limit * MEGABYTE:
        names = " and ".join(one.name for one in shown)
        raise UsageError(
            f"{names}: {whole / MEGABYTE:.3g} MB of meshes and images are more than --limit {limit:g}, and "
            "would make a page a third larger; browsers open pages of some hundred MB. Allow it with --limit "
            f"{whole / MEGABYTE + 1:.0f}"
        )
