"""Python's and numpy's values as USD's, and JSON as dictionaries of custom data."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, Vt

from rigtri.formats.usd.composition.time_samples import moving_times
from rigtri.maths.trigonometry import Floats

_INT = 2**31


def vectors(values: Floats) -> Any:
    """(n, 2) or (n, 3) as an array of float2 or float3."""
    rows = np.ascontiguousarray(values, dtype=np.float32)
    return (Vt.Vec2fArray if rows.shape[1] == 2 else Vt.Vec3fArray).FromNumpy(rows)


def floats(values: Floats) -> Any:
    """Any shape as an array of float."""
    return Vt.FloatArray.FromNumpy(np.ascontiguousarray(values, dtype=np.float32).reshape(-1))


def integers(values: Any) -> Any:
    """Any shape as an array of int."""
    return Vt.IntArray.FromNumpy(np.ascontiguousarray(values, dtype=np.int32).reshape(-1))


def halves(values: Floats) -> Any:
    """(n, 3) as an array of half3."""
    return Vt.Vec3hArray.FromNumpy(np.ascontiguousarray(values, dtype=np.float16))


def quaternions(values: Floats) -> Any:
    """(n, 4), xyzw and unit, as an array of quatf."""
    rows = np.ascontiguousarray(values, dtype=np.float32).tolist()
    return Vt.QuatfArray([Gf.Quatf(w, x, y, z) for x, y, z, w in rows])


def quaternion(value: Floats) -> Any:
    """(4,), xyzw, as a quatd."""
    x, y, z, w = value.tolist()
    return Gf.Quatd(w, x, y, z)


def matrix(value: Floats) -> Any:
    return Gf.Matrix4d(*value.reshape(-1).tolist())


def matrices(values: Floats) -> Any:
    """(n, 4, 4) as an array of matrix4d."""
    return Vt.Matrix4dArray([matrix(row) for row in values])


def rest_value(attribute: Any) -> Any:
    """An attribute's value at rest: the default, else the first sample; the schema's where there is none."""
    source = attribute.GetResolveInfo(Usd.TimeCode.Default()).GetSource()
    unsaid = source in (Usd.ResolveInfoSourceNone, Usd.ResolveInfoSourceFallback)
    times = moving_times(attribute) if unsaid else []
    return attribute.Get(times[0]) if times else attribute.Get()


class HereOrAbove:
    """Whether something is so for a prim or for one above it. Each is asked once, however deep they are."""

    def __init__(self, is_so: Callable[[Any], bool]) -> None:
        self._is_so = is_so
        self._known = {Sdf.Path.absoluteRootPath: False}

    def __call__(self, prim: Any) -> bool:
        unknown = []
        while prim.GetPath() not in self._known:
            unknown.append(prim)
            prim = prim.GetParent()
        found = self._known[prim.GetPath()]
        for one in reversed(unknown):
            found = found or self._is_so(one)
            self._known[one.GetPath()] = found
        return found


def dictionary(value: Mapping[str, Any]) -> dict[str, Any]:
    """A JSON object as custom data: what USD has no type for becomes ``{"json": text}``."""
    return {key: _value(item) for key, item in value.items()}


def _value(value: Any) -> Any:
    plain = isinstance(value, bool | float | str) or (isinstance(value, int) and -_INT <= value < _INT)
    if plain:
        return value
    if isinstance(value, dict) and value and all(value):
        return dictionary(value)
    return {"json": json.dumps(value, ensure_ascii=False)}


def json_value(value: Any) -> Any:
    """Custom data as JSON; what JSON has no word for becomes a text."""
    if isinstance(value, dict):
        if set(value) == {"json"} and isinstance(value["json"], str):
            return json.loads(value["json"])
        return {str(key): json_value(item) for key, item in value.items()}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if hasattr(value, "__iter__"):
        return [json_value(item) for item in value]
    return str(value)
