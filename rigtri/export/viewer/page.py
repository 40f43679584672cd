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
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from rigtri._version import __version__
from rigtri.errors import FileError, UsageError
from rigtri.formats import Embedded
from rigtri.text import plain

MEGABYTE = 1_000_000


@dataclass(frozen=True)
class Shown:
    """A file in the page: what it is called, its `facts`, what it consists of."""

    name: str
    facts: Mapping[str, Any]
    embedded: Embedded
    clips: Sequence[Mapping[str, str]] = ()


def page(
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
    carried = _Carried()
    models = [carried.model(one) for one in shown]
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
    style = _text("page.css")
    words = {
        "policy": _policy(scripts, style, wasm=bool(decoders)),
        "version": __version__,
        "title": html.escape(f"{title} – rigtri view"),
        "style": style,
        "licences": html.escape(_text("page.js.LICENSES.txt").strip(), quote=False),
        "data": "\n".join([facts, *carried.elements]),
        "scripts": "\n".join(f"<script>{script}</script>" for script in scripts),
    }
    return re.sub(r"@([a-z]+)@", lambda found: words[found[1]], _text("page.html"))


class _Carried:
    """Files as elements of the page, each under an id."""

    def __init__(self) -> None:
        self.elements: list[str] = []

    def add(self, content: bytes | Path) -> str:
        name = f"file{len(self.elements)}"
        text = base64.b64encode(_bytes(content)).decode("ascii")
        self.elements.append(f'<script type="application/octet-stream" id="{name}">{text}</script>')
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
    """What the page may do: run its own scripts, wear its own style, show what it carries."""
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
        raise FileError(f"{content} cannot be read: {error.strerror}") from error


def _check_size(shown: Sequence[Shown], limit: float) -> None:
    parts = [part for one in shown for part in (one.embedded.content, *one.embedded.files.values())]
    whole = sum(len(part) if isinstance(part, bytes) else part.stat().st_size for part in parts)
    if whole > limit * MEGABYTE:
        names = " and ".join(one.name for one in shown)
        raise UsageError(
            f"{names}: {whole / MEGABYTE:.0f} MB of meshes and images would make a page a third larger, and "
            f"browsers open pages of some hundred MB. Allow it with --limit {whole / MEGABYTE + 1:.0f}"
        )
