"""Rules about animations: what channels name, key times, and how many values they need.

Source: glTF 2.0 §3.11.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from rigtri.formats.json_values import short_repr
from rigtri.formats.rules import Violation
from rigtri.maths.trigonometry import Floats

INTERPOLATIONS = ("LINEAR", "STEP", "CUBICSPLINE")
_TYPE = "gltf.animation.output-type"


def node_violation(node: int, count: int) -> Violation | None:
    """A channel that drives a node which a file of ``count`` nodes does not have."""
    if 0 <= node < count:
        return None
    return Violation("gltf.animation.node-missing", f"there is no node {node}, the file has {count}")


def twice_violation(title: str, path: str, first: int) -> Violation:
    """A channel that drives what channel ``first`` of its animation drives."""
    return Violation("gltf.animation.target-twice", f"{title}: channel {first} drives its {path} too")


def sampler_violation(number: Any, count: int) -> Violation | None:
    """A channel whose sampler is none of ``count``."""
    if type(number) is int and 0 <= number < count:
        return None
    text = f"there is no sampler {short_repr(number)}, the animation has {count}"
    return Violation("gltf.animation.sampler-missing", text)


def interpolation_violation(mode: Any) -> Violation | None:
    if mode in INTERPOLATIONS:
        return None
    text = f"interpolation {short_repr(mode)} is none that glTF knows"
    return Violation("gltf.animation.interpolation-unknown", text)


def time_violations(times: Floats, *, lenient: bool = False) -> Iterator[Violation]:
    """Key times, (k,), that are no numbers or not in order. lenient: equal times are allowed."""
    lost = np.flatnonzero(~np.isfinite(times))
    if len(lost):
        yield Violation("gltf.animation.times-nan", f"time {lost[0]} is not a number")
        return
    early = times[1:] < times[:-1] if lenient else times[1:] <= times[:-1]
    wrong = np.flatnonzero(early)
    if len(wrong):
        k = int(wrong[0])
        text = f"time {k + 1}, {times[k + 1]:g} s, does not come after time {k}, {times[k]:g} s"
        more = f" ({len(wrong)} such keys)" if len(wrong) > 1 else ""
        yield Violation("gltf.animation.times-order", text + more)


def time_width_violation(width: int) -> Violation | None:
    """Times that are no single numbers."""
    return None if width == 1 else Violation(_TYPE, f"its times have {width} numbers each, not one")


def value_width_violation(path: str, needed: int, width: int) -> Violation | None:
    """Values of ``width`` numbers where the property needs others."""
    if width == needed:
        return None
    return Violation(_TYPE, f"{path} needs {needed} numbers a key, its output has {width}")


def count_violation(times: int, values: int, mode: Any) -> Violation | None:
    """As many values as key times; in CUBICSPLINE three for each."""
    needed = values_needed(times, mode)
    if values == needed:
        return None
    text = f"{times} times need {needed} values, the output has {values}"
    return Violation("gltf.animation.output-count", text)


def values_needed(times: int, mode: Any) -> int:
    return (3 if mode == "CUBICSPLINE" else 1) * times
