"""How two layers differ, as they are written: specs, fields, samples, and their order.

Source: the SdfLayer API; what a field means is not known here, so that unknown ones are compared too.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from pxr import Sdf

from rigtri.verification.diff.change import (
    Change,
    Kind,
    arrow,
    furthest,
    number,
    order_of,
    rows,
    same_numbers,
    short,
)

_SAMPLES = "timeSamples"
# Fields that are gone through in their own way; Python has no type for a list of offsets.
_COMPARED_SEPARATELY = (_SAMPLES, "subLayers", "subLayerOffsets")
# Numbers up to this many are shown.
FEW = 4


def layer_changes(before: Any, after: Any, name: str, tolerance: float) -> Iterator[Change]:
    """The specs of two layers by path."""
    mine, theirs = _specs(before), _specs(after)
    yield from _sublayers(before, after, name)
    yield from _missing(mine, theirs, name, "removed")
    for path, spec in mine.items():
        other = theirs.get(path)
        if other is not None:
            yield from _fields(path, spec, other, name, tolerance)
            yield from _orders(path, spec, other, name)
    yield from _missing(theirs, mine, name, "added")


def _specs(layer: Any) -> dict[Any, Any]:
    """Every spec of a layer by path, in the file's order."""
    found: dict[Any, Any] = {}

    def visit(path: Any) -> None:
        spec = layer.GetObjectAtPath(path)
        if spec is not None:
            found[path] = spec

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    # Traverse visits what is below first.
    return dict(sorted(found.items(), key=lambda item: item[0]))


def _sublayers(before: Any, after: Any, name: str) -> Iterator[Change]:
    sides = []
    for layer in (before, after):
        offsets = [(offset.offset, offset.scale) for offset in layer.subLayerOffsets]
        sides.append(dict(zip(layer.subLayerPaths, offsets, strict=True)))
    mine, theirs = sides
    for path, offset in mine.items():
        if path not in theirs:
            yield Change(name, "removed", f"sublayer {path}")
        elif theirs[path] != offset:
            yield Change(
                name, "changed", f"sublayer {path}", f"offset and scale {rows(offset, theirs[path])}"
            )
    for path in theirs:
        if path not in mine:
            yield Change(name, "added", f"sublayer {path}")
    if text := order_of(list(mine), list(theirs)):
        yield Change(name, "moved", "sublayers", f"order: {text}")


def _missing(mine: dict[Any, Any], theirs: dict[Any, Any], name: str, kind: Kind) -> Iterator[Change]:
    """What the other layer lacks; what is below it is not reported again."""
    for path, spec in mine.items():
        above = path.GetParentPath()
        if path not in theirs and (above in theirs or above not in mine):
            yield Change(name, kind, str(path), _description(spec))


def _description(spec: Any) -> str:
    """What a spec is: ``def Xform``, ``float3[]``, ``relationship``."""
    if isinstance(spec, Sdf.PrimSpec):
        return f"{str(spec.specifier).rpartition('Specifier')[2].lower()} {spec.typeName}".strip()
    return (
        str(spec.typeName)
        if isinstance(spec, Sdf.AttributeSpec)
        else type(spec).__name__.removesuffix("Spec")
    )


def _fields(path: Any, spec: Any, other: Any, name: str, tolerance: float) -> Iterator[Change]:
    keys = (set(spec.ListInfoKeys()), set(other.ListInfoKeys()))
    for key in sorted(keys[0] | keys[1]):
        if key in _COMPARED_SEPARATELY:
            continue
        where = str(path) if key == "default" else f"{path} {key}"
        if key not in keys[1]:
            yield Change(name, "removed", where, f"was {short(spec.GetInfo(key))}")
        elif key not in keys[0]:
            yield Change(name, "added", where, f"is {short(other.GetInfo(key))}")
        else:
            yield from _values(where, spec.GetInfo(key), other.GetInfo(key), name, tolerance)
    if isinstance(spec, Sdf.AttributeSpec) and _SAMPLES in keys[0] | keys[1]:
        yield from _samples(path, spec.layer, other.layer, name, tolerance)


def _values(where: str, was: Any, now: Any, name: str, tolerance: float) -> Iterator[Change]:
    """Two values of one field; dictionaries are gone through key by key."""
    if isinstance(was, dict) and isinstance(now, dict):
        for key in dict.fromkeys((*was, *now)):
            below = f"{where}:{key}"
            if key not in now:
                yield Change(name, "removed", below, f"was {short(was[key])}")
            elif key not in was:
                yield Change(name, "added", below, f"is {short(now[key])}")
            else:
                yield from _values(below, was[key], now[key], name, tolerance)
    elif text := _difference(was, now, tolerance):
        yield Change(name, "changed", where, text)


def _difference(was: Any, now: Any, tolerance: float) -> str:
    """How two values differ, "" where they do not."""
    if type(was) is not type(now):
        return f"{type(was).__name__} {arrow(was, now)}"
    one, other = _numbers(was), _numbers(now)
    if one is None or other is None:
        return "" if was == now else arrow(was, now)
    if one.shape != other.shape:
        return f"{len(was)} → {len(now)} items"
    if same_numbers(one, other, tolerance):
        return ""
    return rows(one, other) if one.size <= FEW else furthest(one, other)


def _numbers(value: Any) -> np.ndarray[Any, Any] | None:
    """The numbers a value consists of; None for one of something else."""
    if isinstance(value, bool | str):
        return None
    if isinstance(value, int | float):
        return np.array(value, dtype=np.float64)
    if hasattr(value, "real") and hasattr(value, "imaginary"):
        return np.array([value.real, *value.imaginary], dtype=np.float64)
    if not hasattr(value, "__len__"):
        return None
    try:
        array = np.array(value)
    except (TypeError, ValueError):
        return None
    return array.astype(np.float64) if array.dtype.kind in "fiu" else None


def _samples(path: Any, before: Any, after: Any, name: str, tolerance: float) -> Iterator[Change]:
    """Time samples: which times are gone or new, and whose values differ."""
    times = [layer.ListTimeSamplesForPath(path) for layer in (before, after)]
    gone, new = ([t for t in times[i] if t not in set(times[1 - i])] for i in (0, 1))
    where = f"{path} samples"
    if gone:
        yield Change(name, "removed", where, _times(gone, times[0]))
    if new:
        yield Change(name, "added", where, _times(new, times[1]))
    texts = {}
    for time in times[0]:
        if time in set(new) | set(gone):
            continue
        text = _difference(before.QueryTimeSample(path, time), after.QueryTimeSample(path, time), tolerance)
        if text:
            texts[time] = text
    if texts:
        first = next(iter(texts))
        count = len(times[0]) - len(gone)
        yield Change(
            name, "changed", where, f"{len(texts)} of {count}, first at {number(first)}: {texts[first]}"
        )


def _times(some: list[float], every: list[float]) -> str:
    shown = " ".join(number(t) for t in some[:FEW]) + (" ..." if len(some) > FEW else "")
    return f"{len(some)} of {len(every)}: {shown}"


def _orders(path: Any, spec: Any, other: Any, name: str) -> Iterator[Change]:
    """The order in which a spec's children and properties are written."""
    if not isinstance(spec, Sdf.PrimSpec) or not isinstance(other, Sdf.PrimSpec):
        return
    for kind in ("nameChildren", "properties", "variantSets"):
        one, two = (list(getattr(side, kind).keys()) for side in (spec, other))
        if text := order_of(one, two):
            yield Change(
                name, "moved", str(path), f"order of {'prims' if kind == 'nameChildren' else kind}: {text}"
            )
