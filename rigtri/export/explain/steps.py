"""What an explanation consists of: steps with their numbers, and how numbers are written."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass

# What is nothing beside the largest number of its row is written as 0: rounding, which nobody meant.
_NOTHING = 1e-12
Row = tuple[float, ...]


@dataclass(frozen=True)
class Step:
    """One line. slide: where the talk has it. talk, ours: what it is called there and here; value: numbers.

    A value is a number, a vector, or the rows of a matrix. why: what the numbers show, or why there are none.
    """

    slide: str
    talk: str
    ours: str
    value: Row | tuple[Row, ...] | float | None
    why: str = ""

    @property
    def rows(self) -> tuple[Row, ...]:
        """The rows of a matrix; none of anything else."""
        value = self.value
        return tuple(row for row in value if isinstance(row, tuple)) if isinstance(value, tuple) else ()

    def as_json(self) -> dict[str, Any]:
        value: Any = [list(row) for row in self.rows] or self.value
        return {
            "slide": self.slide,
            "talk": self.talk,
            "ours": self.ours,
            "value": list(value) if isinstance(value, tuple) else value,
            "why": self.why,
        }


def step(
    slide: str,
    talk: str,
    ours: str,
    value: ArrayLike,
    why: str | Callable[[], str] = "",
    *,
    trouble: str = "",
) -> Step:
    """A step with its numbers, or without where they are none; trouble: why that may be."""
    found = np.asarray(value, dtype=np.float64)
    if not np.isfinite(found).all():
        return Step(slide, talk, ours, None, trouble or "it is too large for a number")
    words = why() if callable(why) else why
    if found.ndim == 2:
        return Step(slide, talk, ours, tuple(tuple(plain_numbers(row)) for row in found), words)
    return Step(slide, talk, ours, tuple(plain_numbers(found)) if found.ndim else float(found) + 0.0, words)


def plain_numbers(vector: Floats) -> list[float]:
    """Numbers without what is only rounding beside the largest of them."""
    largest = float(np.abs(vector).max(initial=0.0))
    return [float(x) + 0.0 if abs(x) > _NOTHING * largest else 0.0 for x in vector.tolist()]


def short(value: float) -> str:
    """A number with six digits at most."""
    return f"{value + 0.0:.6g}"
