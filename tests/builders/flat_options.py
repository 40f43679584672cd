"""Options of operations from what tests vary: axis styles and selections."""

from __future__ import annotations

from typing import Any

from rigtri.operations.axis_presets import AxisStyle
from rigtri.operations.option_kinds import Selection


def axes_of(style: AxisStyle) -> dict[str, Any]:
    """A style as the options that give it."""
    if style.world:
        return {"world": True}
    return {"aim": style.aim, "up": style.up, "up_from": style.up_from}


def joints_of(selection: Selection) -> dict[str, Any]:
    """A selection as the options that give it."""
    return {
        "joints": selection.joints,
        "chain": selection.chains,
        "below": selection.below,
        "skin": selection.skin,
        "exclude": selection.exclude,
    }
