"""Point instancers where what they draw, or they themselves, get frames of another size.

An instance stands at X from its prototype, within the instancer. Where the prim above the prototype gets the
frame Cp and the instancer Ci (``reorient_xforms``), all stay where they are with X' = Cp·X·Ci⁻¹. For sizes
alone that is other positions and scales; turned, `orientations` of half floats could not hold it.

Source: UsdGeomPointInstancer (ComputeInstanceTransformsAtTime, IncludeProtoXform).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from pxr import Sdf, UsdGeom, Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import DEFAULT, refuse, why_locked
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.opinions.edits import Edit, set_value
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.quaternions import IDENTITY
from rigtri.maths.trigonometry import Floats

# What of an instancer is a length in its own frame.
_LENGTHS = ("positions", "velocities", "accelerations", "extent")


def scale_instancers(source: Source, frame_at: Callable[[Any], tuple[Floats, float]]) -> Iterator[Edit]:
    """The positions and scales of instances. frame_at: how the frame at a prim's path differs, as a rotation
    (4,) and a size.

    FileError where an instancer cannot be edited, or would draw something turned or mirrored.
    """
    for prim in source.instances.prims():
        if not prim.IsA(UsdGeom.PointInstancer):
            continue
        targets = UsdGeom.PointInstancer(prim).GetPrototypesRel().GetForwardedTargets()
        turn, size = frame_at(prim.GetPath())
        frames = [frame_at(target.GetParentPath()) for target in targets]
        sizes = {held for _, held in frames} or {size}
        if any((each != IDENTITY).any() for each in (turn, *(rotation for rotation, _ in frames))):
            raise FileError(
                f"What <{prim.GetPath()}> draws would be turned, and its orientations cannot hold that "
                "exactly. Freeze scale or unit alone, with --scale or --unit"
            )
        if len(sizes) > 1 or min(size, *sizes) <= 0:
            raise FileError(
                f"Prototypes of <{prim.GetPath()}> would get different sizes or be mirrored. Put them below "
                "one prim without scale"
            )
        for name in _LENGTHS if size != 1.0 else ():
            yield from _times(prim, name, 1.0 / size)
        if (factor := sizes.pop() / size) != 1.0:
            yield from _times(prim, "scales", factor) or _scales(prim, factor)


def _times(prim: Any, name: str, factor: float) -> list[Edit]:
    """An array of vectors that is longer; nothing where it has no value."""
    attribute = prim.GetAttribute(name)
    if not attribute.HasAuthoredValue():
        return []
    refuse(why_locked(prim, (name,)))

    def longer(value: Any) -> Any:
        return (
            value if value is None else Vt.Vec3fArray.FromNumpy((np.array(value) * factor).astype(np.float32))
        )

    samples = {time: longer(value) for time, value in time_samples(attribute)}
    default = longer(attribute.Get(DEFAULT))
    return [set_value(prim.GetPath(), name, attribute.GetTypeName(), default, samples=samples)]


def _scales(prim: Any, factor: float) -> list[Edit]:
    """Scales where there were none."""
    indices = UsdGeom.PointInstancer(prim).GetProtoIndicesAttr()
    if indices.GetNumTimeSamples():
        raise FileError(
            f"<{prim.GetPath()}> has no scales, and its instances change in time. Give it scales of 1"
        )
    count = len(indices.Get(DEFAULT) or ())
    value = Vt.Vec3fArray.FromNumpy(np.full((count, 3), factor, dtype=np.float32))
    return [set_value(prim.GetPath(), "scales", Sdf.ValueTypeNames.Float3Array, value)]
