"""The time samples of an attribute, as an opinion of a stronger layer can repeat them.

`Usd.Attribute.Get` maps a time back into the layer it comes from; under a scaled
or offset layer that can miss the sample by one bit and find its neighbour, which
may be blocked. So samples are taken from their layer. Value clips are read by
time, for their samples lie in many layers. Splines (OpenUSD 25.5) have no
samples; they are read at their knots and at every frame, and never written. What places a prim is what its op
does not do where its samples are blocked, and jumps there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from operator import itemgetter
from typing import Any

import numpy as np
from pxr import Sdf, Ts, Usd, UsdGeom

from rigtri.errors import FileError

DEFAULT = Usd.TimeCode.Default()
Samples = list[tuple[float, Any]]
# The spec of a layer, the offset of its times, its sample times, and their values, or else its default.
_Opinion = tuple[Any, Any, Sequence[float], Sequence[Any]]

# Where between two samples a clip is compared with what its samples alone would show.
_BETWEEN = (0.29, 0.5, 0.93)
# How far that may be off, as a share of the largest number there: float32, interpolated twice.
_SAME = 1e-6
# Into so many steps the time of a spline is divided at most; to each frame belongs one where there are fewer.
_STEPS = 5000


def moving_times(attribute: Any) -> list[float]:
    """When the value of an attribute is known, in the stage's time: its samples, or where its spline is read.

    No time for an attribute that is still. Source: UsdAttribute::GetSpline, TsSpline.
    """
    if not attribute.HasSpline():
        return list(attribute.GetTimeSamples())
    spline, stage = attribute.GetSpline(), attribute.GetStage()
    knots = list(spline.GetKnots().keys())
    if not knots:
        return []
    start, end = knots[0], knots[-1]
    held = (Ts.ExtrapHeld, Ts.ExtrapValueBlock)
    if spline.GetPreExtrapolation().mode not in held:
        start = min(start, stage.GetStartTimeCode())
    if spline.GetPostExtrapolation().mode not in held:
        end = max(end, stage.GetEndTimeCode())
    step = max(1.0, (end - start) / _STEPS)
    frames = np.arange(np.ceil(start), end, step).tolist()
    jumps = [time for time in knots if spline.EvalPreValue(time) != spline.Eval(time)]
    return sorted({start, *knots, *frames, *(t - Usd.TimeCode.SafeStep() for t in jumps), end})


def ops_times(xformable: Any) -> list[float]:
    """When the place of a prim is known: the times of all its ops. None for a prim that is still."""
    found: set[float] = set()
    for op in xformable.GetOrderedXformOps():
        attribute = op.GetAttr()
        times = moving_times(attribute)
        blocked = [attribute.Get(time) is None for time in times]
        jumps = [end for end, (one, other) in zip(times[1:], pairwise(blocked), strict=True) if one or other]
        found.update(times, (time - Usd.TimeCode.SafeStep() for time in jumps))
    return sorted(found)


def has_splines(prim: Any) -> bool:
    """Whether an op that places a prim is a spline."""
    return any(op.GetAttr().HasSpline() for op in UsdGeom.Xformable(prim).GetOrderedXformOps())


def time_samples(attribute: Any) -> Samples:
    """All samples in the stage's time; the value of a blocked one is None.

    FileError where value clips jump in a way that samples cannot express, and for array edits.
    """
    times = attribute.GetTimeSamples()
    if not times:
        return []
    layered = list(_down_to_samples(attribute))
    if edits := _first_edit(layered):
        raise FileError(
            f"{edits}, which rigtri cannot re-orient. Write whole arrays there, or flatten the stage."
        )
    if attribute.GetResolveInfo(times[0]).GetSource() == Usd.ResolveInfoSourceValueClips:
        return _of_clips(attribute, times)
    if not layered or not layered[-1][2]:
        return [(time, attribute.Get(time)) for time in times]
    _, offset, own, values = layered[-1]
    if Sdf.ValueBlock in set(map(type, values)):
        values = [None if isinstance(value, Sdf.ValueBlock) else value for value in values]
    if not offset.IsIdentity():
        own = [offset * time for time in own]
    return sorted(zip(own, values, strict=True), key=itemgetter(0))


def array_edits(attribute: Any) -> str:
    """Which opinion only edits a weaker array although the attribute has samples; "" for none.

    USD holds the edited arrays between samples, which samples cannot. Source: Usd.Attribute.Get (26.11).
    """
    return _first_edit(_down_to_samples(attribute)) if attribute.GetTimeSamples() else ""


def _first_edit(layered: Iterable[_Opinion]) -> str:
    for spec, _, _, values in layered:
        if any(kind.__name__.endswith("ArrayEdit") for kind in set(map(type, values))):
            return f"<{spec.path}> of {spec.layer.identifier} edits an array that moves over time"
    return ""


def _down_to_samples(attribute: Any) -> Iterator[_Opinion]:
    """The opinions on an attribute from the strongest to the first with samples; weaker ones do not count."""
    for spec, offset in attribute.GetPropertyStackWithLayerOffsets(DEFAULT):
        layer, path = spec.layer, spec.path
        own = layer.ListTimeSamplesForPath(path)
        if own:
            yield spec, offset, own, [layer.QueryTimeSample(path, time) for time in own]
            return
        yield spec, offset, own, [spec.default] if spec.HasDefaultValue() else []


def _of_clips(attribute: Any, times: Sequence[float]) -> Samples:
    """The samples of value clips. Where a clip jumps, USD lists a time just before the jump, too."""
    found: Samples = [(time, attribute.Get(time)) for time in times]
    for (start, _), (end, _) in _wrong(attribute, found):
        layer = attribute.GetPropertyStack(start)[0].layer.identifier
        raise FileError(
            f"<{attribute.GetPath()}>: the value clips (of {layer}) do not run straight between "
            f"{start:g} and {end:g}, and time samples would. Flatten the stage, or fix their times."
        )
    return found


def _wrong(attribute: Any, found: Samples) -> list[tuple[tuple[float, Any], tuple[float, Any]]]:
    """Neighbouring samples between which the clips show something else than these samples would."""
    stage = Usd.Stage.CreateInMemory()
    stage.SetInterpolationType(attribute.GetStage().GetInterpolationType())
    straight = stage.DefinePrim("/Twin").CreateAttribute("twin", attribute.GetTypeName())
    for time, value in found:
        straight.Set(Sdf.ValueBlock() if value is None else value, time)
    return [
        (one, other)
        for one, other in pairwise(found)
        if any(
            not _same(attribute.Get(time), straight.Get(time))
            for time in (one[0] + share * (other[0] - one[0]) for share in _BETWEEN)
        )
    ]


def _same(one: Any, other: Any) -> bool:
    if one is None or other is None:
        return one is None and other is None
    first, second = (np.array(value, dtype=np.float64) for value in (one, other))
    if first.shape != second.shape:
        return False
    size = max(1.0, float(np.abs(first).max(initial=0.0)))
    return bool(np.abs(first - second).max(initial=0.0) <= _SAME * size)
