"""An explanation as text, for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any

from rigtri.export.explain.explain import Explanation
from rigtri.export.explain.steps import Step, plain_numbers, short
from rigtri.text import plain_lines

_ROWS = ("X axis", "Y axis", "Z axis", "Translation")


def text(found: Explanation, *, width: int = 120) -> str:
    """The explanation in lines of up to ``width`` characters where that can be, without a newline at its end.

    A heading is the title of the slide; below it, each line has the talk's notation, rigtri's, the
    numbers, and what they mean.
    """
    lines = []
    for letter, name, point in zip("ABC", found.names, found.points, strict=True):
        lines.append(f"{letter} = {_shown(tuple(plain_numbers(point)))}{f'  {name}' * (name != letter)}")
    if found.trouble:
        lines += ["", f"Note: {found.trouble}."]
    for slide, steps in groupby(found.steps, key=lambda step: step.slide):
        lines += ["", slide, *_lines(list(steps), width)]
    return plain_lines(lines)


def _lines(steps: Sequence[Step], width: int) -> Iterator[str]:
    """The steps of a slide, in columns; what they mean beside them where there is room, else below."""
    rows = [(step.talk, step.ours, _shown(step.value)) for step in steps]
    wide = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for step, row in zip(steps, rows, strict=True):
        line = "  " + "  ".join(word.ljust(size) for word, size in zip(row, wide, strict=True))
        why = step.why if step.value is not None else ""
        beside = len(line) + 2 + len(why) <= width
        yield f"{line}  {why}".rstrip() if beside else line.rstrip()
        if not beside:
            yield f"      {why}"
        yield from _grid(step.rows) if step.rows else ()


def _grid(rows: Sequence[tuple[float, ...]]) -> list[str]:
    """The rows of a matrix, with their names."""
    cells = [[short(x) for x in row] for row in rows]
    wide = max(len(cell) for row in cells for cell in row)
    return [
        f"      {name:<11}  {'  '.join(c.rjust(wide) for c in row)}"
        for name, row in zip(_ROWS, cells, strict=True)
    ]


def _shown(value: tuple[Any, ...] | float | None) -> str:
    """A number or a vector; nothing of a matrix, whose rows stand below."""
    if value is None:
        return "none"
    if not isinstance(value, tuple):
        return short(value)
    return "" if isinstance(value[0], tuple) else f"({', '.join(map(short, value))})"
