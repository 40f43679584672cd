"""Points and joints of USD files as OpenUSD's own UsdSkel computes them: a second opinion."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import usd_files as usd
from places import NO_SKELETON, SEVERAL_ANIMATIONS, asset_files, leave_out, sample_files
from program import cli
from pxr import Usd
from usd_files import MESH, animation, save, scene, skeleton

import rigtri
from rigtri.errors import FileError
from rigtri.evaluation.sampling import locals_at, morph_weights, worlds
from rigtri.evaluation.skinned_points import SkinnedPoints
from rigtri.evaluation.skinning import deformed
from rigtri.evaluation.timelines import Timeline
from rigtri.formats import read
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.compare import verify

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
            if expected is None or mesh.skin is None:
                continue
            ours = our_points(mesh, rig, clips[0], float(time))
            size = float(np.abs(expected).max())
            assert np.abs(ours - expected).max() <= FLOAT * size, f"{mesh.name} at {time}"
            compared += 1
    assert compared


UNEVEN = "[0.7, 0.2, 0.9, 0.6, 0, 0]"
PLACED = "double3 xformOp:translate = (3, 1, -2)\nuniform token[] xformOpOrder = ['xformOp:translate']"


@pytest.mark.parametrize("place", ["", PLACED.replace("'", '"')], ids=["at the origin", "elsewhere"])
def test_weights_count_as_they_are(place: str, tmp_path: Path) -> None:
    """Sums of 0.9, 1.5 and 0: UsdSkel scales points towards the origin of the Skeleton."""
    mesh = MESH.replace("[1, 0, 0.5, 0.5, 1, 0]", UNEVEN)
    source = save(tmp_path, scene(skeleton(place=place), animation(), mesh))
    document = read(source)
    rig, stage = document.rig, Usd.Stage.Open(str(source))
    (clip,) = (clip for clip in rig.clips if not clip.name.endswith("@default"))
    (mine,) = document.meshes()
    rows = np.array([2, 0, 1])
    for time in (0.0, 1.0, 2.5, 5.0):
        (expected,) = usd.skinned(stage, Usd.TimeCode(time)).values()
        np.testing.assert_allclose(our_points(mine, rig, clip, time), expected, atol=1e-5)
        some = SkinnedPoints(rig, mine, rows).sample(Timeline(clip, ()), np.array([time]))
        np.testing.assert_allclose(some[0], expected[rows], atol=1e-5)


def test_an_edit_of_weights_is_judged_by_what_usd_shows(tmp_path: Path) -> None:
    """Scaled to sum to 1, these are the same weights, and points are elsewhere."""
    one, other = (
        save(tmp_path, scene(skeleton(), animation(), MESH.replace("[1, 0, 0.5, 0.5, 1, 0]", weights)), name)
        for weights, name in (("[0.6, 0, 0.3, 0.3, 0.6, 0]", "a.usda"), ("[1, 0, 0.5, 0.5, 1, 0]", "b.usda"))
    )
    assert verify(read(one), read(other)).deviation > 0.1
    assert verify(read(one), read(one)).deviation == 0.0


def test_new_axes_leave_points_whose_weights_do_not_sum_to_one(tmp_path: Path) -> None:
    mesh = MESH.replace("[1, 0, 0.5, 0.5, 1, 0]", UNEVEN)
    source = save(tmp_path, scene(skeleton(place=PLACED.replace("'", '"')), animation(), mesh))
    rigtri.write(rigtri.orient_joints(rigtri.read(source), aim="x", up="y"), tmp_path / "out.usda")
    assert usd.deviation(source, tmp_path / "out.usda") < 1e-5
    assert verify(read(source), read(tmp_path / "out.usda")).deviation < 1e-5


def test_weights_that_get_other_sums_are_refused(tmp_path: Path) -> None:
    """Before, the check scaled both to 1, and the points that USD shows elsewhere passed."""
    mesh = MESH.replace("[1, 0, 0.5, 0.5, 1, 0]", "[0.6, 0, 0.3, 0.3, 0.6, 0]")
    source, out = save(tmp_path, scene(skeleton(), animation(), mesh)), tmp_path / "out.usda"
    cli("limit-weights", source, "-o", out, "--normalise", code=6)
    cli("limit-weights", source, "-o", out, code=0)
    assert usd.deviation(source, out) < 1e-6
