"""Refuse edits that would take the place of splines: rigtri reads them, and writes keys.

Source: UsdAttribute::GetSpline; time samples of the same layer, or an order of ops without it, hide a spline.
"""

from __future__ import annotations

from typing import Any

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import tokens_of
from rigtri.formats.usd.opinions.edits import Setting
from rigtri.formats.usd.passes.usd_edit import UsdEdit

_ORDER = "xformOpOrder"


def keep_splines(edit: UsdEdit) -> None:
    """FileError where an opinion is for an attribute with a spline, or would leave its op unused."""
    for setting in (value for value in edit.values if isinstance(value, Setting)):
        prim = edit.source.stage.GetPrimAtPath(setting.prim)
        if not prim:
            continue
        names = [setting.name]
        if setting.name == _ORDER:
            names = [name for name in tokens_of(prim, _ORDER) if name not in set(setting.value)]
        for name in names:
            if _is_spline(prim, name):
                raise FileError(
                    f"<{prim.GetPath()}>.{name} moves by a spline, which this edit would have to replace. "
                    "Give it time samples instead (in OpenUSD: Get at every frame, then Set), and run again."
                )


def _is_spline(prim: Any, name: str) -> bool:
    attribute = prim.GetAttribute(name)
    return bool(attribute) and attribute.HasSpline()
