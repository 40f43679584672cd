"""Points and joints of USD files as OpenUSD's own UsdSkel computes them: a second opinion."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from places import NO_SKELETON, SEVERAL_ANIMATIONS, asset_files, leave_out, sample_files

from rigtri.errors import FileError
from rigtri.evaluation.sampling import locals_at, morph_weights, worlds
from rigtri.evaluation.skinning import deformed
from rigtri.formats import read
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig

# float32 points and UsdSkel's own float arithmetic, as a share of the largest coordinate.
FLOAT = 2e-6


def usd_files() -> list[Path]:
    return [*sample_files(".usda", ".usdz"), *asset_files(".usd", ".usda", ".usdc", ".usdz")]


def skinned_points(stage: Any, time: Any) -> dict[str, Floats]:
    """World points of all skinned meshes by prim path, from UsdSkel's skinning queries."""
    from pxr import Usd, UsdGeom, UsdSkel

    cache, places, found = UsdSkel.Cache(), UsdGeom.XformCache(time), {}
    everything = Usd.TraverseInstanceProxies()
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), everything):
        if not prim.IsA(UsdSkel.Root):
            continue
        root = UsdSkel.Root(prim)
        cache.Populate(root, everything)
        for binding in cache.ComputeSkelBindings(root, everything):
            skeleton = cache.GetSkelQuery(binding.GetSkeleton())
            transforms = skeleton.ComputeSkinningTransforms(time)
            if _moves(binding.GetSkeleton().GetPrim()):
                continue  # a clip of its own in a rig, while UsdSkel plays all at once
            place = np.array(places.GetLocalToWorldTransform(binding.GetSkeleton().GetPrim()))
            for query in binding.GetSkinningTargets():
                points = UsdGeom.PointBased(query.GetPrim()).GetPointsAttr().Get(time)
                if not points or query.HasBlendShapes() or not query.HasJointInfluences():
                    continue
                if query.ComputeSkinnedPoints(transforms, points, time):
                    moved = np.array(points, dtype=float) @ place[:3, :3] + place[3, :3]
                    found[str(query.GetPrim().GetPath())] = moved
    return found


def _moves(prim: Any) -> bool:
    """Whether a prim or one above it is placed by time samples."""
    from pxr import UsdGeom

    while prim and not prim.IsPseudoRoot():
        if UsdGeom.Xformable(prim) and UsdGeom.Xformable(prim).GetTimeSamples():
            return True
        prim = prim.GetParent()
    return False


def our_points(mesh: Mesh, rig: Rig, clip: Clip | None, time: float) -> Floats:
    local = rig.local[np.newaxis] if clip is None else locals_at(rig, clip, time)
    at = np.array([time])
    return np.asarray(deformed(mesh, rig, worlds(rig, local), morph_weights(mesh, clip, at))[0])


def _sums_to_one(mesh: Mesh) -> bool:
    """UsdSkel takes other weights as they are; rigtri scales them as engines do."""
    return bool(np.allclose(mesh.weights.sum(axis=1), 1.0, atol=1e-6))


@pytest.mark.parametrize("path", usd_files(), ids=lambda p: p.name)
def test_points_are_where_usdskel_puts_them(path: Path) -> None:
    from pxr import Usd

    try:
        document = read(path)
    except FileError as error:
        leave_out(path, NO_SKELETON, error)
    stage = Usd.Stage.Open(str(path))
    rig = document.rig
    clips = [clip for clip in rig.clips if not clip.name.endswith("@default")]
    if len(clips) != 1 or not clips[0].tracks:
        leave_out(path, SEVERAL_ANIMATIONS)
    compared = 0
    for time in (*clips[0].tracks[0].times[:: max(1, len(clips[0].tracks[0].times) // 3)], 2.3):
        theirs = skinned_points(stage, Usd.TimeCode(float(time)))
        for mesh in document.meshes():
            expected = theirs.get(rig.labels[mesh.node])
            if expected is None or mesh.skin is None or not _sums_to_one(mesh):
                continue
            ours = our_points(mesh, rig, clips[0], float(time))
            size = float(np.abs(expected).max())
            assert np.abs(ours - expected).max() <= FLOAT * size, f"{mesh.name} at {time}"
            compared += 1
    assert compared
