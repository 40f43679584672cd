"""An explanation as lines for people: the talk's notation, ours and the numbers side by side."""

from __future__ import annotations

from typing import Any

from rigtri.export.explain.explain import Explanation, plain_numbers, short

_MATRIX = "Aiming node A at node B"


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
    rows = [(step, (step.talk, step.ours, _shown(step.value))) for step in found.steps]
    wide = [max(len(row[k]) for _, row in rows) for k in range(3)]
    slide = ""
    for step, row in rows:
        if step.slide != slide:
            lines += [*(_matrix(found) if slide == _MATRIX else []), "", step.slide]
            slide = step.slide
        line = "  " + "  ".join(word.ljust(size) for word, size in zip(row, wide, strict=True))
        why = step.why if step.value is not None else ""
        beside = len(line) + 2 + len(why) <= width
        lines += [f"{line}  {why}".rstrip()] if beside else [line.rstrip(), f"      {why}"]
    return "\n".join(lines)


def _matrix(found: Explanation) -> list[str]:
    """The rows of the aim matrix; none where it has not all of them."""
    x, z, y, at = (step.value for step in found.steps if step.slide == _MATRIX)
    if not all(isinstance(row, tuple) for row in (x, y, z, at)):
        return []
    cells = [[*map(short, row), last] for row, last in ((x, "0"), (y, "0"), (z, "0"), (at, "1"))]  # type: ignore[arg-type]
    wide = max(len(cell) for row in cells for cell in row)
    names = ("X axis", "Y axis", "Z axis", "Translation")
    rows = [
        f"{name:<11}  {'  '.join(c.rjust(wide) for c in row)}" for name, row in zip(names, cells, strict=True)
    ]
    return ["  M = [aim_X, aim_Y, aim_Z, A_pos]", *(f"    {row}" for row in rows)]


def _shown(value: tuple[Any, ...] | float | None) -> str:
    if value is None:
        return "none"
    return f"({', '.join(map(short, value))})" if isinstance(value, tuple) else short(value)
