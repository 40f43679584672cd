"""Rows of words as lines with aligned columns, as wide as a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap


def columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows as lines; the last word of a row widens no column."""
    count = max(map(len, rows), default=0)
    widths = [max((len(row[k]) for row in rows if k < len(row) - 1), default=0) for k in range(count)]
    return ["  ".join(_padded(row, widths)).rstrip() for row in rows]


def fitting(rows: Sequence[Sequence[str]], width: int | None, spare: Sequence[int]) -> list[str]:
    """The same, without the columns that make it wider than ``width``.

    spare: the columns that can be done without, the first of them first, each counted among what is left.
    """
    lines = columns(rows)
    for column in spare:
        if width is None or max(map(len, lines), default=0) <= width:
            break
        rows = [[*row[:column], *row[column + 1 :]] if len(row) > column + 1 else row for row in rows]
        lines = columns(rows)
    return lines


def wrapped(text: str, width: int | None) -> list[str]:
    """A line as several that are not wider than ``width``, the others indented; none for no text."""
    if width is None or len(text) <= width:
        return [text] if text else []
    return wrap(text, max(width, 20), subsequent_indent="  ", break_long_words=False)


def _padded(row: Sequence[str], widths: Sequence[int]) -> list[str]:
    """The words of a row as wide as their columns; a column without any words is left out."""
    words = [word.ljust(width) for word, width in zip(row[:-1], widths, strict=False) if width]
    return [*words, row[-1]]
