"""Cameras where a stage gets another unit: what they see is in its units, whatever scales them.

Apertures and focal lengths count only by their ratio in a perspective, and stay as the program of the camera
shows them, in millimetres; an orthographic camera shows as much as its aperture says.

Source: UsdGeomCamera ("Units of Measure"); GfCamera.frustum, which leaves the scale of a camera out.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from pxr import UsdGeom

from rigtri.formats.usd.composition.stage import DEFAULT, refuse, why_locked
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.opinions.edits import Edit, set_value
from rigtri.formats.usd.reading.source import Source

_SEEN = ("clippingRange", "focusDistance")
_FILM = ("horizontalAperture", "verticalAperture", "horizontalApertureOffset", "verticalApertureOffset")


def scale_cameras(source: Source, size: float) -> Iterator[Edit]:
    """Their lengths in another unit, ``size`` times as many. FileError where a camera cannot be edited."""
    for prim in source.instances.prims():
        if not prim.IsA(UsdGeom.Camera):
            continue
        flat = UsdGeom.Camera(prim).GetProjectionAttr().Get(DEFAULT) == UsdGeom.Tokens.orthographic
        for name in (*_SEEN, *(_FILM if flat else ())):
            attribute = prim.GetAttribute(name)
            refuse(why_locked(prim, (name,)))
            samples = {time: _times(value, size) for time, value in time_samples(attribute)}
            default = _times(attribute.Get(DEFAULT), size)
            if samples or not _nothing(default):
                yield set_value(prim.GetPath(), name, attribute.GetTypeName(), default, samples=samples)


def _times(value: Any, size: float) -> Any:
    if value is None or isinstance(value, float):
        return None if value is None else value * size
    return type(value)(*(float(x) * size for x in value))


def _nothing(value: Any) -> bool:
    return value is None or not np.any(np.array(value))
