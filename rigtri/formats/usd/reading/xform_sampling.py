"""Animated Xform prims as one clip, for measuring: what moves beside and above the skeletons.

Every prim's local matrix at the samples of its ops, taken apart into tracks.
Between samples Euler angles and pivots go ways that tracks do not; they go the
same way in two files that are compared. Nothing writes these tracks.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from pxr import UsdGeom, Vt

from rigtri.maths.matrices import SKEW, decompose, skew
from rigtri.maths.quaternions import IDENTITY
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import PATHS, Interpolation, Track
from rigtri.report import Notice
from rigtri.text import listed

# The name and key of the clip; the writer leaves it alone.
NAME, KEY = "xforms", ("xforms", "")


def tracks(prims: Mapping[int, Any], interpolation: Interpolation, warnings: list[Notice]) -> list[Track]:
    """Translation, rotation and scale of animated prims, by node: three tracks each."""
    if not prims:
        return []
    shared: dict[tuple[float, ...], Floats] = {}
    times, matrices = [], []
    for prim in prims.values():
        xformable = UsdGeom.Xformable(prim)
        keys = tuple(xformable.GetTimeSamples())
        times.append(shared.setdefault(keys, np.array(keys)))
        matrices += [xformable.GetLocalTransformation(time) for time in keys]
    ends = np.cumsum([len(keys) for keys in times])
    local = np.array(Vt.Matrix4dArray(matrices), dtype=np.float64)
    of = np.repeat(np.arange(len(times)), [len(keys) for keys in times])
    paths = [str(prim.GetPath()) for prim in prims.values()]
    values = _parts(local, [paths[k] for k in of.tolist()], warnings)
    columns = [np.split(part, ends[:-1]) for part in values]
    return [
        Track(node, path, interpolation, times[row], columns[part][row])
        for row, node in enumerate(prims)
        for part, path in enumerate(PATHS)
    ]


def _parts(local: Floats, paths: list[str], warnings: list[Notice]) -> tuple[Floats, Floats, Floats]:
    """Translation, rotation and scale of matrices as far as they have them, with a notice where not."""
    finite = np.asarray(np.isfinite(local).all(axis=(1, 2)))
    if not finite.all():
        text = f"Samples of the ops of {_named(paths, ~finite)} give no finite matrix; they count as none."
        warnings.append(Notice("no-place", text))
        local = np.where(finite[:, np.newaxis, np.newaxis], local, np.eye(4))
    with np.errstate(invalid="ignore", divide="ignore"):
        translation, rotation, scale = decompose(local)
        whole = np.asarray(np.isfinite(rotation).all(axis=1))
        odd = np.asarray(~whole | (skew(local) > SKEW))
    # What is hidden by a scale of zero has no axes; there is nothing to measure about them.
    odd &= (scale != 0).any(axis=1)
    if odd.any():
        text = f"{_named(paths, odd)}: sheared or flat samples are measured by their place and lengths alone."
        warnings.append(Notice("xform-sheared", text))
    return translation, np.where(whole[:, np.newaxis], rotation, IDENTITY), scale


def _named(paths: list[str], which: np.ndarray) -> str:
    names = sorted({paths[k] for k in np.flatnonzero(which).tolist()})
    return listed([f"<{name}>" for name in names])
