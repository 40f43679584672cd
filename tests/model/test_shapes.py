"""Control shapes: lines about a node, and how files hold them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gltf_files import glb_json
from numpy.testing import assert_allclose
from places import first
from second_opinions import usd_errors

from rigtri.formats import read
from rigtri.model.control_shapes import KINDS, Lines, drawn
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.rigtri_nodes import add, group
from rigtri.pipeline.edit import edit
from rigtri.report import Report

AXES = [*np.eye(3), *-np.eye(3)]


@pytest.mark.parametrize("kind", KINDS)
def test_a_shape_lies_within_its_size(kind: str) -> None:
    shape = drawn(kind, size=2.5, normal=np.array([1.0, 0, 0]), color=(1, 0, 0))
    points = np.concatenate(shape.strips)
    assert_allclose(np.abs(points).max(), 2.5)
    assert shape.segments.shape[1:] == (2, 3)
    assert (np.linalg.norm(shape.segments[:, 1] - shape.segments[:, 0], axis=1) > 0).all()


@pytest.mark.parametrize("kind", first(KINDS))
def test_lines_are_those_of_their_kind_size_and_colour_however_turned(kind: str) -> None:
    red = (1.0, 0.0, 0.0)
    ways = [(AXES[1], None), (AXES[5], None), (AXES[1], AXES[3]), (AXES[3], AXES[2])]
    for normal, ahead in ways:
        segments = drawn(kind, size=2.0, normal=normal, color=red, ahead=ahead).segments
        lines = Lines(segments, red)
        assert lines.are(kind, 2.0, red)
        assert Lines(segments + 1e-5, red).are(kind, 2.0, red)  # float32
        assert Lines(segments, (1.0, 5e-7, 0.0)).are(kind, 2.0, red)
        assert not Lines(segments + 3e-5, red).are(kind, 2.0, red)
        assert not Lines(segments[1:], red).are(kind, 2.0, red)
        assert not lines.are(kind, 2.1, red)
        assert not lines.are(kind, 2.0, (1.0, 2e-6, 0.0))
        assert not lines.are(kind, 2.0, (*red, 1.0))
        assert not lines.are("spiral", 2.0, red)
        assert [other for other in KINDS if lines.are(other, 2.0, red)] == [kind]
        beside = Lines(drawn(kind, size=2.0, normal=normal, color=red, shift=0.7).segments, red)
        assert beside.are(kind, 2.0, red, 0.7)
        assert not beside.are(kind, 2.0, red)


@pytest.mark.parametrize("normal", AXES)
def test_a_flat_shape_lies_across_its_normal(normal: np.ndarray) -> None:
    for kind in ("circle", "square", "arrow", "cross"):
        shape = drawn(kind, size=1.0, normal=normal, color=(1, 0, 0))
        assert_allclose(np.concatenate(shape.strips) @ normal, 0.0, atol=1e-12)


@pytest.mark.parametrize("normal", AXES)
def test_a_pyramid_points_along_its_normal(normal: np.ndarray) -> None:
    shape = drawn("pyramid", size=1.0, normal=normal, color=(1, 0, 0))
    assert_allclose((np.concatenate(shape.strips) @ normal).max(), 1.0)
    assert_allclose((np.concatenate(shape.strips) @ normal).min(), 0.0, atol=1e-12)


def test_a_diamond_shows_from_every_side() -> None:
    points = np.concatenate(drawn("diamond", size=1.0, normal=AXES[0], color=(1, 0, 0)).strips)
    assert_allclose(np.ptp(points, axis=0), 2.0)


@pytest.mark.parametrize("normal", AXES)
def test_an_arrow_points_ahead(normal: np.ndarray) -> None:
    for ahead in AXES:
        if ahead @ normal == 0:
            shape = drawn("arrow", size=2.0, normal=normal, color=(1, 0, 0), ahead=ahead)
            points = np.concatenate(shape.strips)
            assert_allclose(points @ normal, 0.0, atol=1e-12)
            # The tip is one point, the foot has two.
            assert np.count_nonzero(points @ ahead == 2.0) == 1
            assert np.count_nonzero(points @ ahead == -2.0) == 2


def test_another_kind_is_an_error() -> None:
    with pytest.raises(ValueError, match="banana"):
        drawn("banana", size=1.0, normal=np.eye(3)[0], color=(1, 0, 0))  # type: ignore[arg-type]


def with_shape(rig: Rig, report: Report) -> Rig:
    rig, parent = group(rig)
    for kind in ("circle", "cube"):
        rig, node = add(rig, f"{kind}_ctl", parent, ControlRecord(kind="fk", joint="hips"))
        shape = drawn(kind, size=0.1, normal=np.eye(3)[0], color=(1.0, 0.8, 0.0))
        rig = replace(rig, pending=replace(rig.pending, shapes={**rig.pending.shapes, node: shape}))
    return rig


def test_gltf_holds_shapes_as_lines_with_one_material_a_colour(samples: Path, tmp_path: Path) -> None:
    edit(samples / "biped.glb", tmp_path / "out.glb", with_shape)
    before, after = glb_json(samples / "biped.glb"), glb_json(tmp_path / "out.glb")
    circle, cube = after["meshes"][len(before["meshes"]) :]
    assert [mesh["primitives"][0]["mode"] for mesh in (circle, cube)] == [2, 1]
    assert circle["primitives"][0]["material"] == cube["primitives"][0]["material"]
    assert len(after["materials"]) == len(before.get("materials", [])) + 1
    accessor = after["accessors"][cube["primitives"][0]["attributes"]["POSITION"]]
    assert accessor["count"] == 24
    assert_allclose(accessor["max"], [0.1, 0.1, 0.1], rtol=1e-6)


@pytest.mark.parametrize("name", ["biped.usda", "biped.usdz"])
def test_usd_holds_shapes_as_guide_curves_below_their_control(
    name: str, samples: Path, tmp_path: Path
) -> None:
    from pxr import Usd, UsdGeom

    edit(samples / name, tmp_path / name, with_shape)
    assert not usd_errors(tmp_path / name) - usd_errors(samples / name)
    stage = Usd.Stage.Open(str(tmp_path / name))
    curves = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.BasisCurves)]
    assert [prim.GetParent().GetName() for prim in curves] == ["circle_ctl", "cube_ctl"]
    assert all(UsdGeom.Imageable(prim).GetPurposeAttr().Get() == "guide" for prim in curves)
    assert all(UsdGeom.Imageable(prim.GetParent()).ComputePurpose() == "default" for prim in curves)
    assert list(UsdGeom.BasisCurves(curves[1]).GetCurveVertexCountsAttr().Get()) == [2] * 12
    assert len(read(tmp_path / name).rig) > len(read(samples / name).rig)
