"""Value clips whose file is not there: USD plays nothing in their place, and says so only when it reads them.

Source: UsdClipsAPI, `assetPaths` and `active`; measured with Usd.Stage (26.11).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pxr import Sdf, Usd, UsdGeom, UsdSkel

from rigtri.errors import FileError
from rigtri.report import Notice
from rigtri.text import and_more, counted

_ARRAYS = ("rotations", "translations", "scales", "blendShapeWeights")


def check(stage: Any, *, allow_missing: bool) -> list[Notice]:
    """What is missing, as a notice. FileError where a skeleton moves by it, unless ``allow_missing``."""
    missing: dict[str, None] = {}
    for prim in Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()):
        if not prim.HasMetadata("clips"):
            continue
        lost = list(_missing(prim))
        names = dict.fromkeys(name for _, name in lost)
        missing |= names
        times = [] if allow_missing else [time for time, _ in lost]
        if needing := _needing(prim, times):
            raise FileError(
                f"{and_more([*names], 3)}: no such file, which <{prim.GetPath()}> has as a value "
                f"clip, and {needing} needs it. Put it there; with --allow-missing it is left out, and "
                "OUT plays nothing in its place even when it is there again"
            )
    if not missing:
        return []
    verb = "was" if len(missing) == 1 else "were"
    what = counted(len(missing), "value clip")
    return [Notice("unresolved", f"{what} that this one plays {verb} not found: {and_more([*missing], 3)}")]


def _missing(prim: Any) -> Iterator[tuple[float, str]]:
    """The clips of a prim that are played and not there: from when, and their asset paths."""
    clips = Usd.ClipsAPI(prim)
    for name in clips.GetClips():
        paths = list(clips.ComputeClipAssetPaths(name) or ())
        for time, number in clips.GetClipActive(name) or ():
            asset = paths[int(number)] if 0 <= number < len(paths) else Sdf.AssetPath()
            if asset.path and not asset.resolvedPath:
                yield time, asset.path


def _needing(prim: Any, times: list[float]) -> str:
    """Which array of animations, or op that places a skeleton, from a prim down, clips move at some times."""
    for each in Usd.PrimRange(prim, Usd.TraverseInstanceProxies()) if times else ():
        for attribute in _moving(each, prim):
            if any(_is_of_clips(attribute, time) for time in times):
                return f"<{attribute.GetPath()}>"
    return ""


def _moving(each: Any, top: Any) -> Iterator[Any]:
    """The arrays of an animation; the ops that place a Skeleton, of prims up to ``top``."""
    if each.IsA(UsdSkel.Animation):
        yield from filter(None, (each.GetAttribute(name) for name in _ARRAYS))
    elif each.IsA(UsdSkel.Skeleton):
        while each.GetPath().HasPrefix(top.GetPath()):
            yield from (op.GetAttr() for op in UsdGeom.Xformable(each).GetOrderedXformOps())
            each = each.GetParent()


def _is_of_clips(attribute: Any, time: float) -> bool:
    return bool(attribute.GetResolveInfo(time).GetSource() == Usd.ResolveInfoSourceValueClips)
