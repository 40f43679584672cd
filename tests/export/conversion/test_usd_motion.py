"""Prims move in glTF as USD itself moves them between samples, and what cannot is measured."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom

import rigtri
from rigtri.errors import DeviationError
from rigtri.evaluation.sampling import Motion, worlds
from rigtri.maths.matrices import compose, decompose


def _stage(path: Path) -> tuple[Any, Any]:
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, "Y")
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.Xform.Define(stage, "/set")
    moved = UsdGeom.Xform.Define(stage, "/set/moved")
    mesh = UsdGeom.Mesh.Define(stage, "/set/moved/blade")
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0.3)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    return stage, moved


def _turned(axis: tuple[float, ...], angle: float) -> Any:
    return Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(*axis), angle))


@pytest.mark.parametrize("ops", ["euler", "matrix"])
def test_prims_go_the_way_of_their_ops_between_samples(ops: str, tmp_path: Path) -> None:
    stage, moved = _stage(tmp_path / "in.usda")
    op = moved.AddRotateXYZOp() if ops == "euler" else moved.AddTransformOp()
    op.Set((0, 0, 0) if ops == "euler" else Gf.Matrix4d(1.0), 0)
    op.Set((0, 720, 90) if ops == "euler" else _turned((0, 1, 0), 60.0), 24)
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-5
    rig = rigtri.read(tmp_path / "out.glb")
    for code in (3.0, 7.1, 17.3):
        there = worlds(rig, Motion(rig, rig.clips[0]).locals_at(np.array([code / 24.0])))
        cache = UsdGeom.XformCache(Usd.TimeCode(code))
        matrix = np.array(cache.GetLocalToWorldTransform(moved.GetPrim()))
        assert np.abs(there[0, rig.find("moved")] - matrix).max() < 1e-5


def test_shear_between_samples_is_reported_and_measured(tmp_path: Path) -> None:
    stage, moved = _stage(tmp_path / "in.usda")
    op = moved.AddTransformOp()
    op.Set(Gf.Matrix4d(1.0), 0)
    op.Set(_turned((1, 1, 1), 60.0), 24)
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    assert any("the shear that matrices of </set/moved>" in n.text for n in outcome.report.warnings)
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-5
    assert outcome.verification.motion is not None
    assert 1e-3 < outcome.verification.motion.deviation < 0.2


def _far(path: Path, ops: str, *, away: float, frames: int = 12) -> Path:
    """A plane of 14 m that a prim turns at some distance, by samples on every frame."""
    stage, moved = _stage(path)
    matrix = ops == "matrix"
    op = moved.AddTransformOp() if matrix else moved.AddRotateXYZOp(UsdGeom.XformOp.PrecisionFloat)
    for frame in range(frames + 1):
        x, y, z = 10 * np.sin(frame / 9), 3.6 * frame, -20 * np.sin(frame / 13)
        op.Set(_turned((0, 1, 0), y) * _turned((1, 0, 0), x) if matrix else (x, y, z), frame)
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/set/moved/blade"))
    mesh.GetPointsAttr().Set([(away, 50, 0), (away + 10, 50, 0), (away, 58, 6)])
    stage.Save()
    return path


@pytest.mark.parametrize(("ops", "away"), [("euler", 50.0), ("euler", 200.0), ("matrix", 200.0)])
def test_what_turns_far_from_its_origin_has_keys_as_near_as_its_size_asks(
    ops: str, away: float, tmp_path: Path
) -> None:
    rigtri.convert(_far(tmp_path / "in.usda", ops, away=away), tmp_path / "out.glb")
    stage = Usd.Stage.Open(str(tmp_path / "in.usda"))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/set/moved/blade"))
    rig = rigtri.read(tmp_path / "out.glb")
    points = np.array(mesh.GetPointsAttr().Get(), dtype=np.float64)
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    times = np.arange(0.0, 12.0, 1.0 / 16.0)
    found = worlds(rig, Motion(rig, rig.clips[0]).locals_at(times / 24.0))[:, rig.find("blade")]
    for time, world in zip(times.tolist(), found, strict=True):
        there = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(mesh.GetPrim()))
        if ops == "matrix":  # glTF cannot say what shears between samples
            there = compose(*decompose(there))
        off = points @ (world - there)[:3, :3] + (world - there)[3, :3]
        assert np.linalg.norm(off, axis=1).max() < 1e-5 * size


def test_what_turns_at_its_origin_has_few_keys(tmp_path: Path) -> None:
    """The keys of what is far away grow with the root of the distance, and what is near pays nothing."""
    counts = []
    for away in (0.0, 100.0):
        source = _far(tmp_path / f"{away:g}.usda", "euler", away=away)
        rigtri.convert(source, source.with_suffix(".glb"))
        clip = rigtri.read(source.with_suffix(".glb")).clips[0]
        counts.append(max(len(track.times) for track in clip.tracks))
    assert 12 < counts[0] < counts[1] <= 4 * counts[0]


def test_prims_that_turn_below_each_other_stay_within_the_limit_together(tmp_path: Path) -> None:
    stage, _ = _stage(tmp_path / "in.usda")
    path = "/set/moved"
    for depth in range(3):
        op = UsdGeom.Xformable(stage.GetPrimAtPath(path)).AddRotateXYZOp()
        for k in range(2):
            op.Set((20.0 * k, (70.0 - 10 * depth) * k, 90.0 * k), 12 * k)
        path = f"{path}/arm{depth}"
        UsdGeom.Xform.Define(stage, path).AddTranslateOp().Set((3.0, 0, 0))
    mesh = UsdGeom.Mesh.Define(stage, f"{path}/hand")
    mesh.CreatePointsAttr([(0, 0, 0), (0.3, 0, 0), (0, 0.3, 0.1)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    stage.RemovePrim("/set/moved/blade")
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-5


def test_where_float32_cannot_say_a_rotation_so_far_away_the_error_says_so(tmp_path: Path) -> None:
    source = _far(tmp_path / "in.usda", "euler", away=20000.0, frames=2)
    with pytest.raises(
        DeviationError, match=r"'moved' turns what is .* sizes from its origin: there the float"
    ):
        rigtri.convert(source, tmp_path / "out.glb")


@pytest.mark.parametrize(("degrees", "slow"), [(0.4, True), (30.0, False)])
def test_rotations_that_openusd_plays_unevenly_go_along_arcs_and_are_listed(
    degrees: float, slow: bool, tmp_path: Path
) -> None:
    stage, moved = _stage(tmp_path / "in.usda")
    op = moved.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    for k in range(3):
        op.Set(Gf.Rotation(Gf.Vec3d(0, 1, 0), k * degrees).GetQuat(), 24 * k)
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    lost = [notice.text for notice in outcome.report.warnings if notice.code == "lost"]
    assert any("slow rotations of </set/moved>" in text for text in lost) == slow
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6
    rig = rigtri.read(tmp_path / "out.glb")
    there = worlds(rig, Motion(rig, rig.clips[0]).locals_at(np.array([0.25, 1.75])))[:, rig.find("moved")]
    angles = np.degrees(np.arctan2(there[:, 2, 0], there[:, 2, 2]))
    assert angles == pytest.approx([0.25 * degrees, 1.75 * degrees], abs=1e-5)


def test_slow_turns_of_instances_of_a_point_instancer_are_not_listed(tmp_path: Path) -> None:
    """OpenUSD plays these by the arrays of the instancer, not by the ops that they are here."""
    stage, _ = _stage(tmp_path / "in.usda")
    rocks = UsdGeom.PointInstancer.Define(stage, "/set/rocks")
    rocks.CreatePrototypesRel().SetTargets(["/set/moved"])
    rocks.CreateProtoIndicesAttr([0, 0])
    rocks.CreatePositionsAttr([(0, 0, 0), (2, 0, 0)])
    turns = rocks.CreateOrientationsfAttr()
    for k in range(3):
        turns.Set([Gf.Quatf(Gf.Rotation(Gf.Vec3d(0, 1, 0), k * 0.4).GetQuat())] * 2, 24 * k)
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    assert not [notice.text for notice in outcome.report.warnings if "slow rotations" in notice.text]
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-5
    assert any(track.path == "rotation" for track in rigtri.read(tmp_path / "out.glb").clips[0].tracks)


def test_half_float_rotations_go_along_the_arcs_of_what_they_mean_and_are_listed(tmp_path: Path) -> None:
    """Before, refused with 6: OpenUSD rounds what lies between samples to half floats, which are not unit."""
    stage, moved = _stage(tmp_path / "in.usda")
    op = moved.AddOrientOp(UsdGeom.XformOp.PrecisionHalf)
    turns = [Gf.Rotation(Gf.Vec3d(1, 0.4, 0.3), 20 + 3 * code).GetQuat() for code in (0, 10, 20)]
    for code, turn in zip((0, 10, 20), turns, strict=True):
        op.Set(Gf.Quath(turn), code)
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    lost = [notice.text for notice in outcome.report.warnings if notice.code == "lost"]
    assert len(lost) == 1
    assert "how OpenUSD plays rotations of </set/moved> in half floats (quath): up to 2.5e-03 rad" in lost[0]
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6
    rig = rigtri.read(tmp_path / "out.glb")
    one, other = (Gf.Quatd(Gf.Quath(turn)).GetNormalized() for turn in turns[:2])
    for share in (0.0, 0.3, 0.5, 1.0):
        there = Motion(rig, rig.clips[0]).locals_at(np.array([share * 10.0 / 24.0]))
        meant = np.array(Gf.Matrix4d().SetRotate(Gf.Slerp(share, one, other).GetNormalized()))
        assert np.abs(there[0, rig.find("moved")] - meant).max() < 1e-6


def test_a_blocked_sample_of_an_orient_op_is_no_rotation(tmp_path: Path) -> None:
    """Before, a traceback."""
    stage, moved = _stage(tmp_path / "in.usda")
    op = moved.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    for code in (0, 24, 48):
        op.Set(Gf.Rotation(Gf.Vec3d(0, 1, 0), 10.0 + code).GetQuat(), code)
    op.GetAttr().Set(Sdf.ValueBlock(), 24)
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6
    rig = rigtri.read(tmp_path / "out.glb")
    there = worlds(rig, Motion(rig, rig.clips[0]).locals_at(np.array([0.0, 1.5])))[:, rig.find("moved")]
    angles = np.degrees(np.arctan2(there[:, 2, 0], there[:, 2, 2]))
    assert angles == pytest.approx([10.0, 0.0], abs=1e-5)
