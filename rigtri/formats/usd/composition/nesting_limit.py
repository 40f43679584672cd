"""How deep the brackets of a text layer stand in each other, counted before USD reads it.

USD's parser calls itself for each: some ten thousand take gigabytes, or the end of the stack.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.usd.crate import tables
from rigtri.formats.usd.text.statements import COMMENTS, STRINGS

# Tuples, arrays and metadata are some ten deep at most; prims and dictionaries stand in braces.
MOST_BRACKETS, MOST_BRACES = 1000, 5000

# Bytes that are counted at a time.
_CHUNK = 1 << 20
_MARKS = re.compile(rb"[\"'@#/]")
_SKIPPED = re.compile(STRINGS + rb"|" + COMMENTS)
_KINDS = (("brackets", b"([", b")]", MOST_BRACKETS), ("braces", b"{", b"}", MOST_BRACES))


def check_file(path: Path) -> None:
    """FileError, with the line, for a text layer whose brackets USD's parser may not survive."""
    with path.open("rb") as file:
        if file.read(len(tables.MAGIC)) == tables.MAGIC:
            return
    check(path.read_bytes(), str(path))


def check(content: bytes | memoryview, name: str) -> None:
    """The same for the bytes of a layer; ``name`` is for the error."""
    content, plain = bytes(content), b""
    for what, opening, closing, most in _KINDS:
        # As many as there are stand in each other at worst; many files end here.
        if sum(content.count(mark) for mark in _single(opening)) <= most:
            continue
        plain = plain or _without_words(content)
        if (place := _too_deep(plain, opening, closing, most)) >= 0:
            line = plain.count(b"\n", 0, place) + 1
            raise FileError(
                f"{name}: more than {most} {what} stand in each other in line {line}, which USD cannot read. "
                "The file is damaged; export it again"
            )


def _too_deep(plain: bytes, opening: bytes, closing: bytes, most: int) -> int:
    """Where more than ``most`` brackets of a kind are open; −1 where they never are."""
    step = np.zeros(256, np.int32)
    step[list(opening)], step[list(closing)] = 1, -1
    marks, depth = np.frombuffer(plain, np.uint8), 0
    for start in range(0, len(marks), _CHUNK):
        open_there = depth + np.cumsum(step[marks[start : start + _CHUNK]])
        deep = np.flatnonzero(open_there > most)
        if len(deep):
            return start + int(deep[0])
        depth = int(open_there[-1])
    return -1


def _single(marks: bytes) -> list[bytes]:
    return [bytes([mark]) for mark in marks]


def _without_words(content: bytes) -> bytes:
    """The text with strings, asset paths and comments blank, but for their line ends."""
    parts, at, start = [], 0, 0
    while mark := _MARKS.search(content, at):
        word = _SKIPPED.match(content, mark.start())
        at = word.end() if word else mark.end()
        if word:
            parts += [content[start : mark.start()], b"\n" * word[0].count(b"\n")]
            start = at
    return b"".join([*parts, content[start:]])
