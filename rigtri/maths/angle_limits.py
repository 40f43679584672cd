"""Limits of angles by which rules choose, a hundredth of a degree below the round ones.

People build and key round angles. Rounding must not decide on them, or two sides of a body, two files of
a library and a second run would get different axes.
"""

from __future__ import annotations

from rigtri.maths.trigonometry import sin_cos

# Degrees. float32 places of short bones are that exact.
BELOW = 0.01
_RADIANS = 0.017453292519943295


def radians_below(degrees: float) -> float:
    """A limit in radians.

    >>> round(radians_below(90), 5)
    1.57062
    """
    return (degrees - BELOW) * _RADIANS


def sine_below(degrees: float) -> float:
    """The sine of a limit."""
    return float(sin_cos(radians_below(degrees))[0])


def cosine_below(degrees: float) -> float:
    """The cosine of a limit: what is ``degrees`` off is beyond it."""
    return float(sin_cos(radians_below(degrees))[1])
