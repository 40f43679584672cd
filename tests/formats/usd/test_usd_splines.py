"""Splines of USD play as they do in USD, and no edit puts anything else in their place."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom
from usd_files import read, save, turned, write

import rigtri
from rigtri.errors import FileError
from rigtri.evaluation.sampling import Motion, worlds
from rigtri.formats.document import ReadOptions

# A lift that eases 9 units up in 20 frames, jumps back and goes on upwards, with an arm that a spline turns.
LIFT = """#usda 1.0
(
    startTimeCode = 1
    endTimeCode = 30
    upAxis = "Y"
    metersPerUnit = 1
)
def Xform "lift" {
    double xformOp:translateY.spline = {
        bezier,
        post: linear,
        1: 0; post curve (1, 3),
        21: 0 & 9; pre (1, 0); post linear,
        25: 1,
    }
    float3 xformOp:scale = (2, 2, 2)
    uniform token[] xformOpOrder = ["xformOp:translateY", "xformOp:scale"]
    def Xform "arm" {
        double3 xformOp:translate = (0, 1, 0)
        double xformOp:rotateZ.spline = {
            bezier,
            1: 0; post curve (1, 10),
            11: 90; pre (1, 0),
        }
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ"]
        def Mesh "blade" {
            point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0.3)]
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
        }
    }
    def Camera "eye" {
        float focalLength.spline = {
            bezier,
            1: 20; post linear,
            21: 50,
        }
    }
}
"""
TIMES = np.array([1.0, 4.0, 11.0, 17.0, 23.0, 28.0])


def _of_usd(path: Path, prim: str) -> np.ndarray:
    stage = Usd.Stage.Open(str(path))
    places = [UsdGeom.XformCache(time).GetLocalToWorldTransform(stage.GetPrimAtPath(prim)) for time in TIMES]
    return np.array(places)


def test_splines_are_read_as_usd_plays_them(tmp_path: Path) -> None:
    path = save(tmp_path, LIFT)
    rig = read(path, root="/lift").rig
    clip = next(clip for clip in rig.clips if clip.name == "xforms")
    found = worlds(rig, Motion(rig, clip).locals_at(TIMES))[:, rig.find("arm")]
    assert np.abs(found - _of_usd(path, "/lift/arm")).max() < 1e-12


@pytest.mark.ci
def test_conversion_follows_splines(tmp_path: Path) -> None:
    steady = LIFT.replace("0 & 9", "9").replace("post: linear,", "")
    path = save(tmp_path, steady)
    outcome = rigtri.convert(path, tmp_path / "out.glb", options=ReadOptions(root="/lift"))
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-5
    rig = rigtri.read(tmp_path / "out.glb")
    found = worlds(rig, Motion(rig, rig.clips[0]).locals_at(TIMES / 24.0))[:, rig.find("arm"), 3]
    assert np.abs(found - _of_usd(path, "/lift/arm")[:, 3]).max() < 1e-4


@pytest.mark.ci
def test_comparison_sees_what_splines_change(tmp_path: Path) -> None:
    first = read(save(tmp_path, LIFT), root="/lift")
    other = read(save(tmp_path, LIFT.replace("11: 90", "11: 80"), "other.usda"), root="/lift")
    assert rigtri.verify(first, other).deviation > 0.1
    lens = read(save(tmp_path, LIFT.replace("21: 50", "21: 40"), "lens.usda"), root="/lift")
    assert any("focalLength" in text for text in rigtri.verify(first, lens).different)


def test_new_axes_leave_splines_as_they_are(tmp_path: Path) -> None:
    document = read(save(tmp_path, LIFT), root="/lift")
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    stages = [Usd.Stage.Open(str(path)) for path in (tmp_path / "in.usda", out)]
    one, other = (s.GetAttributeAtPath("/lift/arm.xformOp:rotateZ").GetSpline() for s in stages)
    assert one == other
    assert rigtri.verify(document, read(out, root="/lift")).deviation < 1e-9


def test_keys_in_the_place_of_a_spline_are_refused(tmp_path: Path) -> None:
    document = read(save(tmp_path, LIFT), root="/lift")
    rig = document.rig
    (clip,) = rig.clips
    halved = tuple(replace(track, values=track.values[::2], times=track.times[::2]) for track in clip.tracks)
    changed = replace(rig, clips=(replace(clip, tracks=halved),))
    with pytest.raises(FileError, match=r"</lift>\.xformOp:translateY moves by a spline"):
        document.write(changed, tmp_path / "out.usda", tmp_path / "out.usda")
