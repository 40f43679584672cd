"""Cameras of a stage that gets another unit: they see what they saw."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program import cli
from pxr import Usd, UsdGeom
from usd_files import MESH, animation, save, scene, skeleton

CAMERAS = """def Camera "Lens"
{
    float2 clippingRange = (0.1, 50)
    float2 clippingRange.timeSamples = {1: (0.1, 50), 5: (0.2, 60)}
    float focusDistance.timeSamples = {1: 3, 5: 4}
    double3 xformOp:translate = (0, 1, 6)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Camera "Plan"
{
    token projection = "orthographic"
    float horizontalAperture = 20
    float focusDistance = 2
    float focusDistance.timeSamples = {1: 3}
}"""


@pytest.mark.parametrize("camera", ["Lens", "Plan"])
def test_a_camera_sees_the_same_in_another_unit(camera: str, tmp_path: Path) -> None:
    source = save(tmp_path, scene(skeleton(), animation(), MESH, CAMERAS, head="    metersPerUnit = 1\n"))
    out = tmp_path / "out.usda"
    cli("freeze", source, "-o", out, "--unit", "0.01", code=0)
    stages = [Usd.Stage.Open(str(path)) for path in (source, out)]
    for time in (1.0, 3.0, 5.0):
        one, other = (
            UsdGeom.Camera(stage.GetPrimAtPath(f"/Root/{camera}")).GetCamera(time) for stage in stages
        )
        corners = [np.array(each.frustum.ComputeCorners()) for each in (one, other)]
        assert np.allclose(corners[0] * 100.0, corners[1], rtol=1e-6)
        assert other.focusDistance == pytest.approx(one.focusDistance * 100.0)
        assert other.focalLength == one.focalLength
    cli("freeze", out, "-o", tmp_path / "back.usda", "--unit", "1", code=0)
    home = Usd.Stage.Open(str(tmp_path / "back.usda"))
    back = UsdGeom.Camera(home.GetPrimAtPath(f"/Root/{camera}"))
    corners = [np.array(each.frustum.ComputeCorners()) for each in (one, back.GetCamera(5.0))]
    assert np.allclose(*corners, rtol=1e-6)
