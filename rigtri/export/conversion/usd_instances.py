"""Instances of a stage as prims of their own: glTF has no prototypes but meshes.

All is said in the session layer of a stage of its own, so nothing reaches the layers of the file. A point
instancer becomes an Xform with a prim for each instance, which references its prototype.

Source: OpenUSD glossary, "Instancing"; UsdGeomPointInstancer (a prototype's own ops come first, then scale,
orientation and position; ComputeInstanceTransformsAtTime makes matrices of quaternions as they are, where
orient ops take the angle from the real part alone).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel

from rigtri.evaluation.sampling import between_keys
from rigtri.export.conversion.usd_clips import EVEN
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.document import UsdDocument
from rigtri.formats.usd.reading.mesh_reader import EARLIEST
from rigtri.formats.usd.reading.reader import read_source
from rigtri.maths.quaternions import normalise, slerp, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.text import and_more

# More nodes are not made of point instancers: 850 bipeds with a clip are 31,450 nodes, and take 21 s of
# processor time and 0.75 GB, 10,000 rocks 10 s and 0.31 GB.
MOST_NODES = 50_000
# What places instances, by the op that takes it. Those of the second name win over those of the first.
_PLACES = {
    "translate": ("positions",),
    "orient": ("orientations", "orientationsf"),
    "scale": ("scales",),
}
_DOUBLE = UsdGeom.XformOp.PrecisionDouble
# What moves or shows instances in a way that ops have no samples of.
_MOTION = ("velocities", "accelerations", "angularVelocities")
_FIXED = ("protoIndices", "ids", "invisibleIds")
Values = dict[float | None, Any]


def without_instances(document: UsdDocument) -> tuple[UsdDocument, list[str]]:
    """The document with every instance as prims of its own, and what these do not show, in words.

    Point instancers stay that have too many instances, or others at some times than at others.
    """
    stage = document.source.stage
    if not any(prim.IsInstance() or prim.IsA(UsdGeom.PointInstancer) for prim in stage.Traverse()):
        return document, []
    whole = Usd.Stage.Open(stage.GetRootLayer(), Usd.Stage.LoadAll)
    session = whole.GetSessionLayer()
    session.timeCodesPerSecond = whole.GetTimeCodesPerSecond()
    whole.SetEditTarget(session)
    kept, room, rounded = set[Any](), MOST_NODES, dict[str, float]()
    while found := [prim for prim in whole.Traverse() if _is_shared(prim, kept)]:
        for prim in found:
            if not prim:  # below an instancer that was expanded
                continue
            if prim.IsInstance():
                prim.SetInstanceable(False)
            elif made := _expand(whole, UsdGeom.PointInstancer(prim), room):
                room -= made
                rounded[f"<{prim.GetPath()}>"] = _rounding(_authored(prim, _PLACES["orient"]))
            else:
                kept.add(prim.GetPath())
    options = ReadOptions(empty=True)
    expanded = UsdDocument(read_source(document.source.path, options, whole), options, whole.GetRootLayer())
    return expanded, list(_lost(rounded))


def is_made_instance(prim: Any) -> bool:
    """Whether `without_instances` has made a prim for an instance of a point instancer."""
    return any(spec.typeName == "PointInstancer" for spec in prim.GetParent().GetPrimStack())


def _lost(rounded: dict[str, float]) -> Iterator[str]:
    coarse = sorted(path for path, off in rounded.items() if off > EVEN)
    if coarse:
        yield (
            f"how OpenUSD draws instances of {and_more(coarse, 3)} by rotations that are not unit, as "
            f"half floats (quath): up to {max(rounded.values()):.1e} of their size off what is written"
        )


def _is_shared(prim: Any, kept: set[Any]) -> bool:
    return prim.IsInstance() or (prim.IsA(UsdGeom.PointInstancer) and prim.GetPath() not in kept)


def _expand(stage: Any, instancer: Any, room: int) -> int:
    """Give a point instancer a prim for each of its instances; how many nodes these are.

    0 where that cannot be said with ops, or needs more nodes than there is room for.
    """
    prim = instancer.GetPrim()
    prototypes = instancer.GetPrototypesRel().GetForwardedTargets()
    rows = _rows(instancer.GetProtoIndicesAttr())
    fixed = all(len(prim.GetAttribute(name).GetTimeSamples()) < 2 for name in _FIXED)
    moved = any(prim.GetAttribute(name).HasAuthoredValue() for name in _MOTION)
    if not fixed or moved or not all(0 <= row < len(prototypes) for row in rows):
        return 0
    if any(prim.GetPath().HasPrefix(path) or not stage.GetPrimAtPath(path) for path in prototypes):
        return 0
    values = {op: _values(prim, names) for op, names in _PLACES.items()}
    lengths = {-1 if array is None else len(array) for each in values.values() for array in each.values()}
    if not values["translate"] or lengths != {len(rows)}:
        return 0
    mask = instancer.ComputeMaskAtTime(EARLIEST) or [True] * len(rows)
    taken = {child.GetName() for child in prim.GetAllChildren()}
    places = _paths(prim.GetPath(), [prototypes[row].name for row in rows], taken)
    shown = [number for number in range(len(rows)) if mask[number]]
    sizes = [1 + _nodes(stage.GetPrimAtPath(path)) for path in prototypes]
    made = sum(sizes[rows[number]] for number in shown)
    if made > room:
        return 0
    with Sdf.ChangeBlock():
        layer = stage.GetEditTarget().GetLayer()
        Sdf.CreatePrimInLayer(layer, prim.GetPath()).typeName = "Xform"
        for name in taken:  # what is below an instancer is shown by its instances alone
            Sdf.CreatePrimInLayer(layer, prim.GetPath().AppendChild(name)).SetInfo("active", False)
        for number in shown:
            place, prototype = places[number], prototypes[rows[number]]
            above = Sdf.CreatePrimInLayer(layer, place)
            above.specifier, above.typeName = Sdf.SpecifierDef, "Xform"
            spec = Sdf.CreatePrimInLayer(layer, place.AppendChild(prototype.name))
            spec.specifier = Sdf.SpecifierDef
            spec.SetInfo("active", True)
            spec.referenceList.prependedItems = [Sdf.Reference("", prototype)]
    for number in shown:
        _place(UsdGeom.Xformable(stage.GetPrimAtPath(places[number])), values, number)
    return made


def _nodes(prototype: Any) -> int:
    """How many nodes there are in a prototype: its prims, and the joints of its skeletons."""
    prims = list(Usd.PrimRange(prototype, Usd.PrimAllPrimsPredicate))
    joints = (
        UsdSkel.Skeleton(prim).GetJointsAttr().Get() or () for prim in prims if prim.IsA(UsdSkel.Skeleton)
    )
    return len(prims) + sum(map(len, joints))


def _rows(attribute: Any) -> list[int]:
    return list(attribute.Get(EARLIEST) or ())


def _paths(parent: Any, names: Sequence[str], taken: set[str]) -> list[Any]:
    """A path below an instancer for each instance: ``Hero_0``, or with more behind it where that is taken."""
    found = []
    for number, name in enumerate(names):
        one = f"{name}_{number}"
        while one in taken:
            one += "_"
        found.append(parent.AppendChild(one))
    return found


def _authored(prim: Any, names: Sequence[str]) -> Any:
    """The last of some attributes that has any value, or None."""
    attributes = (prim.GetAttribute(name) for name in reversed(names))
    return next((each for each in attributes if each and each.HasAuthoredValue()), None)


def _values(prim: Any, names: Sequence[str]) -> Values:
    """The values of the last of some attributes that has any, at each of its times; None is the default."""
    if not (attribute := _authored(prim, names)):
        return {}
    times = attribute.GetTimeSamples()
    return {time: attribute.Get(time) for time in times} or {None: attribute.Get()}


def _rounding(attribute: Any) -> float:
    """How far OpenUSD draws instances off unit rotations and their arcs, as a share of their size."""
    if not attribute:
        return 0.0

    def turns(time: Any) -> Floats:
        return np.array(attribute.Get(time), dtype=np.float64).reshape(-1, 4)

    keys = np.array(attribute.GetTimeSamples() or [0.0])
    held = attribute.GetStage().GetInterpolationType() == Usd.InterpolationTypeHeld
    most = 0.0
    for time in (keys if held else between_keys(keys)).tolist():
        after = int(np.clip(np.searchsorted(keys, time), 1, max(1, len(keys) - 1)))
        start, end = keys[after - 1], keys[min(after, len(keys) - 1)]
        share = 0.0 if end == start else float(np.clip((time - start) / (end - start), 0.0, 1.0))
        meant = slerp(normalise(turns(start)), normalise(turns(end)), np.array(share))
        apart = to_axes(turns(time)) - to_axes(meant)
        # A turn, scaled or not, moves two of three directions, both equally far.
        most = max(most, float(length(length(apart)).max(initial=0.0)) / np.sqrt(2.0))
    return float(most)


def _place(xformable: Any, values: dict[str, Values], number: int) -> None:
    """Give the prim of an instance its ops."""
    for name, samples in values.items():
        for time, array in samples.items():
            value = array[number]
            if name == "translate":
                op, value = xformable.GetTranslateOp() or xformable.AddTranslateOp(), Gf.Vec3d(value)
            elif name == "orient":
                op = xformable.GetOrientOp() or xformable.AddOrientOp(_DOUBLE)
                value = Gf.Quatd(value).GetNormalized()
            else:
                op = xformable.GetScaleOp() or xformable.AddScaleOp()
            op.Set(value, Usd.TimeCode.Default() if time is None else time)
