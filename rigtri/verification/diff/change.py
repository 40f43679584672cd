"""One difference between two files, and the words and short numbers that describe it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from rigtri.maths.arrays import Booleans
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass

Kind = Literal["added", "removed", "changed", "moved"]
# What stands in front of a line.
SIGNS: dict[Kind, str] = {"added": "+", "removed": "-", "changed": "~", "moved": ">"}
# Characters of a value that a line shows.
SHOWN = 60


@dataclass(frozen=True)
class Change:
    """One difference. group: its heading. where: what it is about. text: what happened to it."""

    group: str
    kind: Kind
    where: str
    text: str = ""

    def __str__(self) -> str:
        return f"{SIGNS[self.kind]} {self.where}{f'  {self.text}' if self.text else ''}"


def number(value: float) -> str:
    """A number in at most seven digits."""
    return f"{value + 0.0:.7g}"


def row(values: Any) -> str:
    """Numbers side by side, without the noise of a millionth of the largest."""
    array = np.asarray(values, dtype=np.float64).reshape(-1)
    largest = float(np.abs(array[np.isfinite(array)]).max(initial=0.0))
    return " ".join(number(0.0 if abs(x) < 1e-6 * largest else x) for x in array.tolist())


def rows(before: Any, after: Any) -> str:
    """Two rows of numbers with an arrow; with all digits where they read alike."""
    one, other = row(before), row(after)
    if one == other:
        one, other = (" ".join(map(repr, np.asarray(x).reshape(-1).tolist())) for x in (before, after))
    return f"{one} → {other}"


def short(value: Any) -> str:
    """A value in a few words."""
    text = number(value) if isinstance(value, float) else str(value)
    text = " ".join(text.split())
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."


def arrow(before: Any, after: Any) -> str:
    """Old and new value; the parts that differ where both are too long to be shown."""
    one, other = short(before), short(after)
    if one == other:
        one, other = str(before), str(after)
        if max(len(one), len(other)) > SHOWN:
            at = next((k for k, (a, b) in enumerate(zip(one, other, strict=False)) if a != b), 0)
            start = max(0, at - 10)
            one, other = (f"...{text[start : start + SHOWN - 10]}..." for text in (one, other))
    return f"{one} → {other}"


def same_numbers(before: Any, after: Any, tolerance: float) -> bool:
    """Whether two arrays have one shape and the same numbers, as `same_rows` compares them."""
    one, other = np.asarray(before), np.asarray(after)
    return one.shape == other.shape and bool(same_rows(one[np.newaxis], other[np.newaxis], tolerance)[0])


def same_rows(before: Floats, after: Floats, tolerance: float) -> Booleans:
    """Which rows of two arrays of one shape hold the same numbers, (k, ...) → (k,), NaN being one of them.

    With a tolerance of 0 also the sign of zero counts, but for rows with a NaN.
    """
    width = int(np.prod(before.shape[1:]))  # of no rows -1 would mean nothing
    one, other = before.reshape(len(before), width), after.reshape(len(after), width)
    if tolerance:
        near = np.asarray(np.isclose(one, other, rtol=0.0, atol=tolerance, equal_nan=True))
        return np.asarray(near.all(axis=1))
    lost = np.isnan(one)
    same = np.all((one == other) | (lost & np.isnan(other)), axis=1)
    signs = np.all(np.signbit(one) == np.signbit(other), axis=1)
    return np.asarray(same & (signs | lost.any(axis=1)))


def furthest(before: Any, after: Any) -> str:
    """How many of the numbers of two arrays of one shape differ, and by how much at most."""
    one, other = (np.asarray(x, dtype=np.float64).reshape(-1) for x in (before, after))
    with np.errstate(invalid="ignore"):
        off = np.abs(one - other)
    differ = (one != other) & ~(np.isnan(one) & np.isnan(other))
    worst = float(off[np.isfinite(off)].max(initial=0.0))
    return f"{int(differ.sum())} of {len(one)} numbers differ, by up to {worst:.3g}"


def order_of(before: Sequence[Any], after: Sequence[Any]) -> str:
    """How the order of what both have differs, "" where it does not."""
    common = set(before) & set(after)
    one, other = ([x for x in side if x in common] for side in (before, after))
    if one == other:
        return ""
    return arrow(" ".join(map(str, one)), " ".join(map(str, other)))
