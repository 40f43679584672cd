"""Text of files as a terminal may show it."""

from __future__ import annotations

import os
import unicodedata
from collections.abc import Mapping, Sequence
from typing import Any, TextIO


def plain(text: str, *, one_line: bool = False) -> str:
    """Text without control characters: names in files could move the cursor or turn the line round.

    one_line: newlines and tabs become escapes, too.

    >>> plain("a\\x1b[2Jb")
    'a\\\\x1b[2Jb'
    """
    kept = "" if one_line else "\n\t"
    if text.isprintable():
        return text
    return "".join(letter if letter in kept or not _controls(letter) else _escape(letter) for letter in text)


def colored(stream: TextIO) -> bool:
    """Whether to print in colours: NO_COLOR and FORCE_COLOR decide, else whether somebody looks.

    Source: no-color.org and force-color.org: set and not empty.
    """
    if os.environ.get("NO_COLOR"):
        return False
    if os.environ.get("FORCE_COLOR"):
        return os.environ["FORCE_COLOR"] != "0"
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def counted(count: int, noun: str) -> str:
    """A number of things.

    >>> counted(1, "clip"), counted(2, "clip")
    ('1 clip', '2 clips')
    """
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def grown(clips: Sequence[Mapping[str, Any]]) -> str:
    """What is told of clips, as reports have them, whose keys have become more than twice as many.

    >>> grown([{"keys": 9, "keys_before": 2}]), grown([{"keys": 9, "keys_before": 0}])
    ('; the same properties had 2 keys before (a larger --tolerance leaves out more)', '')
    """
    now, before = (sum(entry.get(word, 0) for entry in clips) for word in ("keys", "keys_before"))
    if not before or now <= 2 * before:
        return ""
    return f"; the same properties had {counted(before, 'key')} before (a larger --tolerance leaves out more)"


def _controls(letter: str) -> bool:
    # Format characters join letters of scripts; only those that change direction are kept out.
    if unicodedata.category(letter) in ("Cc", "Zl", "Zp"):
        return True
    turns = ("LRE", "RLE", "LRO", "RLO", "PDF", "LRI", "RLI", "FSI", "PDI")
    return unicodedata.bidirectional(letter) in turns


def _escape(letter: str) -> str:
    return letter.encode("unicode_escape").decode("ascii")
