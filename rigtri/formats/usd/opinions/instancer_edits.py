"""Point instancers where what they draw, or they themselves, get other frames.

An instance stands at X from its prototype, within the instancer. Where the prim above the prototype gets the
frame Cp and the instancer Ci (``reorient_xforms``), all stay where they are with X' = Cp·X·Ci⁻¹. For sizes
alone that is other positions and scales. Where both are turned alike, by quarter turns, as an up axis is, it
exchanges axes; by other rotations `orientations` of half floats could not hold it.

Source: UsdGeomPointInstancer (ComputeInstanceTransformsAtTime, IncludeProtoXform).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from pxr import Sdf, UsdGeom, Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import DEFAULT, refuse, why_locked
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.opinions.edits import Edit, set_value
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.arrays import Integers
from rigtri.maths.quaternions import IDENTITY, conjugate, to_axes
from rigtri.maths.trigonometry import Floats

# Rotations this near to quarter turns are these.
_QUARTERS = 1e-6

# New rows for those of an array.
Change = Callable[[np.ndarray], np.ndarray]


def move_instancers(source: Source, frame_at: Callable[[Any], tuple[Floats, float]]) -> Iterator[Edit]:
    """Where instances are, and how they are turned and sized. frame_at: how the frame at a prim's path
    differs, as a rotation (4,) and a size.

    FileError where an instancer cannot be edited, or would draw something turned otherwise or mirrored.
    """
    for prim in source.instances.prims():
        if not prim.IsA(UsdGeom.PointInstancer):
            continue
        targets = UsdGeom.PointInstancer(prim).GetPrototypesRel().GetForwardedTargets()
        turn, size = frame_at(prim.GetPath())
        frames = [
            frame_at(path.GetParentPath()) if _is_read(source.stage.GetPrimAtPath(path)) else (IDENTITY, 1.0)
            for path in targets
        ]
        sizes = [held for _, held in frames] or [size]
        axes = to_axes(conjugate(turn))
        quarters = np.rint(axes)
        others = [np.abs(to_axes(conjugate(rotation)) - axes).max() for rotation, _ in frames]
        if max(np.abs(axes - quarters).max(), *others, 0.0) > _QUARTERS:
            raise FileError(
                f"What <{prim.GetPath()}> draws would be turned, and its orientations cannot hold that "
                "exactly. Freeze scale or unit alone, with --scale or --unit, or put all prototypes below it"
            )
        if min(size, *sizes) <= 0:
            raise FileError(
                f"Prototypes of <{prim.GetPath()}> would be mirrored. Put them below one prim without scale"
            )
        # Of a vector in the new axes each number is one of the old numbers, or its opposite.
        order = np.abs(quarters).argmax(axis=0)
        signs = quarters[order, np.arange(3)]
        turned = bool((quarters != np.eye(3)).any())
        if turned or size != 1.0:
            yield from _vectors(prim, order, signs, size)
        factor = sizes[0] / size if len({*sizes}) == 1 else _of_each(prim, np.array(sizes) / size)
        resized = bool(np.any(factor != 1.0))
        if turned or resized:
            resize = partial(_picked, order=order, factor=factor)
            yield from _changed(prim, "scales", resize) or (_scales(prim, factor) if resized else ())


def _is_read(prototype: Any) -> bool:
    """Whether edits reach a prototype: below an ``over`` or ``class`` instancers alone draw it."""
    return not prototype or (prototype.IsDefined() and not prototype.IsAbstract())


def _of_each(prim: Any, factors: Floats) -> Floats:
    """For each instance what its prototype has, (n, 1). FileError where that is not one in all its time."""
    indices = UsdGeom.PointInstancer(prim).GetProtoIndicesAttr()
    every = np.array(indices.Get(DEFAULT) or (), dtype=np.int64)
    scales = [value for _, value in time_samples(prim.GetAttribute("scales"))]
    counts = {len(value) for value in (*scales, prim.GetAttribute("scales").Get(DEFAULT)) if value}
    if indices.GetNumTimeSamples() or counts - {len(every)} or np.any((every < 0) | (every >= len(factors))):
        raise FileError(
            f"Prototypes of <{prim.GetPath()}> would get different sizes, and its instances change in time. "
            "Put all prototypes below it, or below one prim beside it"
        )
    return factors[every][:, np.newaxis]


def _vectors(prim: Any, order: Integers, signs: Floats, size: float) -> Iterator[Edit]:
    """The arrays of vectors in the frame of an instancer, in other axes; lengths in another size, too."""
    turn, move = (partial(_picked, order=order, factor=factor) for factor in (signs, signs / size))
    for name in ("positions", "velocities", "accelerations"):
        yield from _changed(prim, name, move)
    # Corners of a box exchange their numbers.
    yield from _changed(prim, "extent", lambda rows: np.sort(move(rows), axis=0))
    yield from _changed(prim, "angularVelocities", turn)
    for name in ("orientations", "orientationsf"):
        yield from _changed(prim, name, lambda rows: np.hstack([turn(rows[:, :3]), rows[:, 3:]]))


def _picked(rows: Floats, order: Integers, factor: Floats | float) -> Floats:
    return np.asarray(rows[:, order] * factor)


def _changed(prim: Any, name: str, change: Change) -> list[Edit]:
    """An array of vectors or quaternions with other numbers; nothing where it has no value, or keeps them."""
    attribute = prim.GetAttribute(name)
    if not attribute.HasAuthoredValue():
        return []

    def other(value: Any) -> Any:
        if value is None:
            return value
        rows = np.array(value)
        return (
            type(value).FromNumpy(change(rows.astype(np.float64)).astype(rows.dtype)) if len(rows) else value
        )

    times, single = time_samples(attribute), attribute.Get(DEFAULT)
    samples, default = {time: other(value) for time, value in times}, other(single)
    if default == single and all(samples[time] == value for time, value in times):
        return []
    refuse(why_locked(prim, (name,)))
    return [set_value(prim.GetPath(), name, attribute.GetTypeName(), default, samples=samples)]


def _scales(prim: Any, factor: Floats | float) -> list[Edit]:
    """Scales where there were none."""
    indices = UsdGeom.PointInstancer(prim).GetProtoIndicesAttr()
    if indices.GetNumTimeSamples():
        raise FileError(
            f"<{prim.GetPath()}> has no scales, and its instances change in time. Give it scales of 1"
        )
    count = len(indices.Get(DEFAULT) or ())
    value = Vt.Vec3fArray.FromNumpy(np.broadcast_to(factor, (count, 3)).astype(np.float32))
    return [set_value(prim.GetPath(), "scales", Sdf.ValueTypeNames.Float3Array, value)]
