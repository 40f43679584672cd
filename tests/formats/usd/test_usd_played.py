"""What a stage plays at once: keys of joints and of prims stand in two clips, and are one motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from baked_files import keyed_file, rigged_file
from places import SAMPLES, slow
from program import cli
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel
from rigs import chain
from usd_files import MESH, animation, save, scene, skeleton, without_notes, write
from usd_files import read as read_text

from rigtri.errors import DeviationError
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import played_at_once, put_tracks, timelines
from rigtri.formats import read
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.usd.document import UsdDocument
from rigtri.maths.quaternions import IDENTITY, from_axis_angle
from rigtri.maths.quaternions import multiply as product
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.pipeline.edit import edit
from rigtri.report import Report
from rigtri.verification.compare.correspondence import match

# A quarter of a turn about z, xyzw, and the keys that lead to it.
TURN = from_axis_angle([0.0, 0.0, 1.0], np.pi / 2)
TIMES = np.array([0.0, 6.0])


def rigged(tmp_path: Path, source: Path = SAMPLES / "biped.usda", *more: str) -> Path:
    out = tmp_path / f"rigged{source.suffix}"
    if source.parent == SAMPLES:
        return rigged_file(source.name, out)
    cli("add-controls", source, "-o", out, "--whole-character", *more, code=0)
    return out


def keyed(path: Path, out: Path, name: str) -> Path:
    """The file with keys for a prim that had none."""
    stage = Usd.Stage.Open(str(path))
    prim = next(prim for prim in stage.TraverseAll() if prim.GetName() == name)

    op = UsdGeom.Xformable(prim).AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    for time, (x, y, z, w) in zip(TIMES, ((0.0, 0.0, 0.0, 1.0), TURN), strict=True):
        op.Set(Gf.Quatd(float(w), float(x), float(y), float(z)), float(time))
    stage.Export(str(out))
    return out


def tracks(rig: Rig, name: str, path: str) -> list[Track]:
    node = rig.find(name)
    return [t for clip in rig.clips for t in clip.tracks if (t.node, t.path) == (node, path)]


@pytest.mark.ci
def test_keys_that_are_new_to_a_control_come_into_a_usd_file(tmp_path: Path) -> None:
    home = rigged(tmp_path)
    edited = keyed(home, tmp_path / "edited.usda", "chest_ctl")
    cli("take-clips", home, "--from", edited, "-o", tmp_path / "out.usda", code=0)
    (track,) = tracks(read(tmp_path / "out.usda").rig, "chest_ctl", "rotation")
    np.testing.assert_allclose(sample(track, TIMES), [[0, 0, 0, 1], TURN], atol=1e-7)


@pytest.mark.slow
def test_a_gltf_motion_comes_into_a_usd_file_whose_controls_have_no_keys(tmp_path: Path) -> None:
    home, other = rigged(tmp_path), rigged(tmp_path, SAMPLES / "biped.glb")
    up = tmp_path / "up.glb"
    cli("bake", other, "-o", up, "--to", "controls", "--clip", "walk", code=0)
    cli("take-clips", home, "--from", up, "-o", tmp_path / "out.usda", "--clip", "walk", code=0)
    assert tracks(read(tmp_path / "out.usda").rig, "chest_ctl", "rotation")


def without_animation(stage: Any) -> None:
    for prim in list(stage.TraverseAll()):
        if prim.IsA(UsdSkel.Skeleton):
            prim.RemoveProperty("skel:animationSource")
    stage.RemovePrim(next(p.GetPath() for p in stage.TraverseAll() if p.IsA(UsdSkel.Animation)))


def held(stage: Any) -> None:
    """One pose instead of an animation."""
    prim = next(p for p in stage.TraverseAll() if p.IsA(UsdSkel.Animation))
    for name in ("translations", "rotations", "scales"):
        attribute = prim.GetAttribute(name)
        value = attribute.Get(0.0)
        attribute.Clear()
        attribute.Set(value)


@pytest.mark.ci
@pytest.mark.parametrize("still", [without_animation, slow(held)])
def test_controls_move_joints_that_have_no_samples(still: Callable[[Any], None], tmp_path: Path) -> None:
    # Of its own: a layer that is opened by its path is the same for all who have it open.
    stage = Usd.Stage.Open(Sdf.Layer.OpenAsAnonymous(str(SAMPLES / "biped.usda")))
    still(stage)
    stage.Export(str(tmp_path / "still.usda"))
    home = rigged(tmp_path, tmp_path / "still.usda", "--frame", "joint")
    edited = keyed(home, tmp_path / "edited.usda", "chest_ctl")
    before, out = read(home).rig, tmp_path / "out.usda"
    cli("bake", edited, "-o", out, "--to", "joints", code=0)
    after = read(out).rig
    rest = before.rotation[before.find("chest")]
    wanted = product(np.array([rest, rest]), np.array([[0.0, 0.0, 0.0, 1.0], TURN]))
    found = sample(next(t for t in tracks(after, "chest", "rotation") if len(t.times) > 1), TIMES)
    signs = np.sign((found * wanted).sum(axis=1, keepdims=True))
    np.testing.assert_allclose(found * signs, wanted, atol=1e-6)
    again = tmp_path / "again.usda"
    cli("bake", out, "-o", again, "--to", "joints", code=0)
    assert again.read_bytes() == out.read_bytes()


GRIP = """def Xform "Grip"
{
double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 6: (1, 0, 0) }
uniform token[] xformOpOrder = ["xformOp:translate"]
}"""
FACE = """def SkelAnimation "Anim"
{
uniform token[] blendShapes = ["smile"]
float[] blendShapeWeights.timeSamples = { 0: [0], 6: [1] }
}"""


@pytest.mark.parametrize("more", [{"source": ""}, {}], ids=["still", "face"])
def test_new_motion_goes_where_it_is_played_not_into_a_clip_that_nothing_plays(
    more: dict[str, str], tmp_path: Path
) -> None:
    source = save(tmp_path, scene(skeleton(**more), MESH, GRIP, animation("Idle"), *([] if more else [FACE])))
    document = read_text(source)
    (timeline,) = timelines(document.rig)
    turn = Track(document.rig.find("b"), "rotation", "LINEAR", TIMES, np.array([IDENTITY, TURN]))
    out = write(document, put_tracks(document.rig, timeline, [turn]), tmp_path / "out.usda")
    stage, before = (Usd.Stage.Open(str(path)) for path in (out, source))
    query = UsdSkel.Cache().GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Root/Skel")))
    np.testing.assert_allclose(
        np.array(query.ComputeJointLocalTransforms(6.0)[1])[0], (0, 1, 0, 0), atol=1e-6
    )
    now, was = (UsdSkel.Animation.Get(each, "/Root/Idle").GetRotationsAttr() for each in (stage, before))
    assert [now.Get(time) for time in now.GetTimeSamples()] == [
        was.Get(time) for time in was.GetTimeSamples()
    ]


def joint_poses(path: Path) -> np.ndarray:
    """The joints' matrices at some times, as USD says."""
    stage = Usd.Stage.Open(str(path))
    prim = next(prim for prim in stage.TraverseAll() if prim.IsA(UsdSkel.Skeleton))
    root, cache = next(p for p in stage.TraverseAll() if p.IsA(UsdSkel.Root)), UsdSkel.Cache()
    cache.Populate(UsdSkel.Root(root), Usd.PrimDefaultPredicate)
    query = cache.GetSkelQuery(UsdSkel.Skeleton(prim))
    return np.array([np.array(query.ComputeJointSkelTransforms(time)) for time in np.arange(0.0, 24.0, 1.5)])


@pytest.mark.parametrize(
    ("suffix", "described", "to"),
    [
        ("usda", "rigged", "joints"),
        slow("usda", "rigged", "controls"),
        slow("usdc", "rigged", "joints"),
        slow("usdz", "rigged", "controls"),
        slow("usdz", "biped.glb", "joints"),
        slow("usdc", "biped.glb", "controls"),
    ],
)
@pytest.mark.slow
def test_a_usd_file_that_has_lost_its_metadata_is_baked_with_that_of_another(
    suffix: str, described: str, to: str, tmp_path: Path
) -> None:
    home, up = rigged(tmp_path), keyed_file("biped.usda", tmp_path / "up.usda")
    bare = without_notes(up, tmp_path / f"bare.{suffix}")
    cli("bake", bare, "-o", tmp_path / f"none.{suffix}", code=5)
    rig = home if described == "rigged" else rigged(tmp_path, SAMPLES / described)
    out, again = tmp_path / f"out.{suffix}", tmp_path / f"again.{suffix}"
    result = cli("bake", bare, "-o", out, "--rig", rig, "--to", to, code=0)
    assert "warning" not in result.output
    cli("bake", out, "-o", again, "--to", to, code=0)
    assert again.read_bytes() == out.read_bytes()
    assert np.abs(joint_poses(home) - joint_poses(out)).max() < 1e-5


@pytest.mark.ci
def test_keys_of_controls_read_the_same_with_metadata_and_without(tmp_path: Path) -> None:
    up = keyed_file("biped.usda", tmp_path / "up.usda")
    one, other = read(up).rig, read(without_notes(up, tmp_path / "bare.usda")).rig
    for name in ("shin_L_ctl", "foot_L_ik_ctl", "shin_L_ctl_offset"):
        for path in ("translation", "rotation", "scale"):
            both = (tracks(one, name, path), tracks(other, name, path))
            assert [len(t) for t in both] in ([0, 0], [1, 1])
            for was, now in zip(*both, strict=True):
                assert np.array_equal(was.times, now.times)
                assert np.array_equal(was.values, now.values)


def without_keys(name: str) -> Callable[[Rig, Report], Rig]:
    """Take a control's keys out, and say that this was meant."""

    def step(rig: Rig, report: Report) -> Rig:
        report.reposed = True
        node = rig.find(name)
        clips = (replace(c, tracks=tuple(t for t in c.tracks if t.node != node)) for c in rig.clips)
        return replace(rig, clips=tuple(clips))

    return step


@pytest.mark.parametrize(("name", "kind"), [("biped.usda", UsdDocument), slow("biped.glb", GltfDocument)])
@pytest.mark.slow
def test_the_self_check_sees_keys_of_a_control_that_were_to_go(
    name: str, kind: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    source = tmp_path / f"up{Path(name).suffix}"
    cli("bake", rigged(tmp_path, SAMPLES / name), "-o", source, "--to", "controls")
    out = tmp_path / f"out{source.suffix}"
    edit(source, out, without_keys("hand_L_ik_ctl"))
    assert not tracks(read(out).rig, "hand_L_ik_ctl", "translation")
    right = kind.write
    monkeypatch.setattr(kind, "write", lambda self, rig, *places: right(self, self.rig, *places))
    with pytest.raises(DeviationError, match="frame of hand_L_ik_ctl"):
        edit(source, tmp_path / f"wrong{source.suffix}", without_keys("hand_L_ik_ctl"))


def test_what_plays_at_once_is_one_clip_whichever_clip_holds_it() -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    values, times = np.array([[0.0, 0, 0], [1, 0, 0]]), np.array([0.0, 1.0])
    a, b = (Track(node, "translation", "LINEAR", times, values) for node in (0, 1))
    still = replace(b, times=times[:1], values=values[:1], interpolation="STEP")
    default = Clip("walk@default", (still,), ("default", "/walk"))
    apart = (Clip("walk", (a,), ("samples", "/walk")), default, Clip("xforms", (b,), ("xforms", "")))
    together = (Clip("walk", (a, b), ("samples", "/walk")), default)
    shown = [played_at_once(replace(rig, clips=clips), "walk").clips for clips in (apart, together)]
    for clips in shown:
        assert [clip.name for clip in clips] == ["walk", "walk@default"]
        assert {t.node: t for t in clips[0].tracks} == {0: a, 1: b}
    # Clips of glTF play one by one, and defaults alone are seen without a time.
    for clips in ((Clip("walk", (a,), 0), Clip("run", (b,), 1)), (default,)):
        one = replace(rig, clips=clips)
        assert played_at_once(one, "walk") is one
        assert timelines(one)


def test_keys_that_repeat_the_rest_pose_of_a_node_of_ours_are_not_lost_and_others_are() -> None:
    rig = chain((0, 0, 0), (1, 2, 3))
    ours = replace(rig, metadata={1: {"v": 1, "type": "control", "kind": "fk", "joint": "a"}})
    times = np.array([0.0, 1.0])

    def lost(path: Any, values: Any, after: Rig = ours) -> tuple[str, ...]:
        track = Track(1, path, "LINEAR", times, np.array(values, dtype=np.float64))
        before = replace(rig, clips=(Clip("walk", (track,)),))
        return match(before, replace(after, clips=(Clip("walk", ()),)), by_key=True).lost

    assert not lost("translation", [[1, 2, 3], [1, 2, 3]])
    assert not lost("rotation", [[0, 0, 0, -1], [0, 0, 0, 1]])
    assert not lost("scale", [[1, 1, 1], [1, 1, 1]])
    assert lost("scale", [[1, 1, 1], [1, 1, 1.001]]) == ("clip walk: scale of b",)
    assert lost("translation", [[1, 2, 3], [1, 2, 3.001]])
    assert lost("rotation", [[0, 0, 0, 1], [0, 0, 0.6, 0.8]])
    assert lost("scale", [[1, 1, 1], [1, 1, 1]], rig)  # of a node of somebody else


@pytest.mark.ci
def test_a_scale_that_sixteen_bits_cannot_hold_is_reported_by_name(tmp_path: Path) -> None:
    def larger(rig: Rig, report: Report, by: float) -> Rig:
        report.reposed = True
        track = tracks(rig, "hips", "scale")[0]
        wide = replace(track, values=np.full_like(track.values, by))
        clips = (replace(c, tracks=tuple(wide if t is track else t for t in c.tracks)) for c in rig.clips)
        return replace(rig, clips=tuple(clips))

    with pytest.raises(DeviationError, match="16-bit numbers, which cannot say the new ones of 'hips'"):
        edit(SAMPLES / "biped.usda", tmp_path / "out.usda", lambda rig, report: larger(rig, report, 1.2589))
    # 1.25 is a number of 16 bits.
    edit(SAMPLES / "biped.usda", tmp_path / "out.usda", lambda rig, report: larger(rig, report, 1.25))
