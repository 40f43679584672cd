"""Numbers that a user may give: finite, and no larger than what files, which keep float32, can work with.

And the tolerance of results where none is given.
"""

from __future__ import annotations

import math
import sys
from numbers import Real

from rigtri.errors import UsageError

# Its square is still a float32, and it is more than any scene is long.
LARGEST = 1e15
# How far a result may be off, relative to the size of what is seen. Random axes on every joint of real files,
# stored as float32, move points by less than 8.7e-6; a visible fault by far more.
TOLERANCE = 1e-5


def refuse_unworkable(flag: str, *numbers: float | None) -> None:
    """UsageError for a number that is not finite or too large; None is none. flag: what it was given by."""
    for number in numbers:
        if number is not None and not fits(number):
            raise UsageError(f"{flag}: {unfit(number)}")


def fits(number: float) -> bool:
    """Whether something is a number, finite and not too large."""
    # No NaN is, and an int may be too large for a float.
    return isinstance(number, Real) and abs(number) <= LARGEST


def unfit(number: float) -> str:
    """What is wrong with a number."""
    if not isinstance(number, Real):
        return f"{number!r} is not a number"
    if not abs(number) < math.inf:
        return f"{number:g} is not a finite number"
    shown = f"{number:g}" if abs(number) < sys.float_info.max else "a number of hundreds of digits"
    return f"{shown} is more than files can hold to work with; {LARGEST:g} is the most"
