"""What cameras of a USD stage are set to, in another unit: lengths that they see are in the stage's unit.

In a perspective apertures count only by their ratio to the focal length. Source: UsdGeomCamera ("Units of
Measure").
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_SEEN = ("camera clippingRange", "camera focusDistance")
_FILM = tuple(
    f"camera {name}"
    for name in (
        "horizontalAperture",
        "verticalAperture",
        "horizontalApertureOffset",
        "verticalApertureOffset",
    )
)


def resized_lens(facts: Mapping[str, Any], size: float) -> dict[str, Any]:
    """The facts of a node with the lengths that a camera sees ``size`` times as large."""
    names = (*_SEEN, *_FILM) if facts.get("camera projection") == "orthographic" else _SEEN
    return {
        name: _times(value, size, 2 if name == "camera clippingRange" else 1) if name in names else value
        for name, value in facts.items()
    }


def _times(value: Any, size: float, width: int) -> Any:
    """A number or a pair, one of each time, or a default beside the only sample; times stay."""
    if value is None or isinstance(value, float):
        return value if value is None else value * size
    if width == 2 and all(isinstance(each, float) for each in value):
        return tuple(each * size for each in value)
    timed = [
        isinstance(each, tuple) and isinstance(each[1], tuple if width == 2 else float) for each in value
    ]
    return tuple(
        (each[0], _times(each[1], size, width)) if is_timed else _times(each, size, width)
        for each, is_timed in zip(value, timed, strict=True)
    )
