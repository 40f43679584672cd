"""What is authored on a stage is converted, or told by name; nothing is drawn that USD does not draw."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from broken_usd import clean
from gltf_files import glb_json
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdSkel

import rigtri
from rigtri.errors import FileError
from rigtri.formats import ReadOptions


def _stage(path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(path))
    camera = UsdGeom.Camera.Define(stage, "/set/zoom")
    camera.CreateFocalLengthAttr().Set(35.0, 0)
    camera.CreateFocalLengthAttr().Set(70.0, 24)
    camera.CreateFStopAttr(2.8)
    camera.CreateStereoRoleAttr("mono")  # as it is where nothing is said
    UsdLux.SphereLight.Define(stage, "/set/flick").CreateIntensityAttr().Set(10.0, 0)
    stage.GetPrimAtPath("/set/flick").CreateAttribute("anything", Sdf.ValueTypeNames.Float).Set(1.0)
    stage.DefinePrim("/set", "Xform").SetCustomDataByKey("dept", "layout")
    UsdGeom.PointInstancer.Define(stage, "/set/scatter").CreateProtoIndicesAttr([0])
    for place in ("/set/scatter/leaf", "/set/blink"):
        mesh = UsdGeom.Mesh.Define(stage, place)
        mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
        mesh.CreateFaceVertexCountsAttr([3])
        mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    UsdGeom.Imageable(mesh).CreateVisibilityAttr().Set("invisible", 0)
    UsdGeom.Imageable(mesh).CreateVisibilityAttr().Set("inherited", 12)
    shape = UsdSkel.BlendShape.Define(stage, "/set/blink/smile")
    shape.CreateOffsetsAttr([(0, 0, 1)] * 3)
    shape.CreateInbetween("half").SetOffsets([(0, 0, 0.5), (1, 0, 0.5), (0, 0, 0.5)])
    shape.GetInbetween("half").SetWeight(0.5)
    UsdSkel.BindingAPI.Apply(mesh.GetPrim()).CreateBlendShapeTargetsRel().SetTargets([shape.GetPath()])
    stage.DefinePrim("/physics", "PhysicsScene")
    stage.DefinePrim("/spare", "Material")
    stage.GetRootLayer().customLayerData = {"studio": "abc", "copyright": "nobody"}
    stage.Save()


@pytest.mark.parametrize("what", ["guide", "instancer", "no faces"])
def test_a_clip_that_moves_only_what_is_not_converted_is_reported(what: str, tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "in.usda"))
    UsdSkel.Root.Define(stage, "/body")
    still = UsdGeom.Mesh.Define(stage, "/body/still")
    prim = UsdGeom.PointInstancer if what == "instancer" else UsdGeom.Mesh
    moved = prim.Define(stage, "/body/moved")
    for mesh in (still, moved):
        if isinstance(mesh, UsdGeom.Mesh):
            mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
            mesh.CreateFaceVertexCountsAttr([3])
            mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    if what == "no faces":
        moved.GetFaceVertexCountsAttr().Set([])
        skeleton = UsdSkel.Skeleton.Define(stage, "/body/skeleton")
        skeleton.CreateJointsAttr(["a"])
        skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1)])
        skeleton.CreateRestTransformsAttr([Gf.Matrix4d(1)])
        animation = UsdSkel.Animation.Define(stage, "/body/in")
        animation.CreateBlendShapesAttr(["smile"])
        for time in (0, 10):
            animation.CreateBlendShapeWeightsAttr().Set([time / 10], time)
        UsdSkel.BlendShape.Define(stage, "/body/moved/smile").CreateOffsetsAttr([(0, 0, 1)] * 3)
        bound = UsdSkel.BindingAPI.Apply(moved.GetPrim())
        bound.CreateBlendShapesAttr(["smile"])
        bound.CreateBlendShapeTargetsRel().SetTargets(["/body/moved/smile"])
        bound.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
        UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets(["/body/in"])
    else:
        moved.CreatePurposeAttr("guide")
        place = moved.AddTranslateOp()
        for time in (0, 10):
            place.Set((time, 0, 0), time)
    stage.Save()
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    told = [n.text for n in outcome.report.warnings if n.code == "lost"]
    assert "not converted: clip 'in', which moves only what is not converted" in told
    assert "animations" not in glb_json(tmp_path / "out.glb")


def _moving(path: Path, *times: float) -> Path:
    stage = Usd.Stage.CreateNew(str(path))
    place = UsdGeom.Xform.Define(stage, "/moved").AddTranslateOp()
    for time in times:
        place.Set((time - times[0], 0, 0), time)
    stage.Save()
    return path


def test_times_that_float32_seconds_cannot_tell_apart_are_reported(tmp_path: Path) -> None:
    """As after a day, by the time code of a film; after an hour nobody sees it."""
    for start, said in ((86_400, False), (2_073_600, True)):
        source = _moving(tmp_path / f"{start:g}.usda", start, start + 1)
        lost = [n.text for n in rigtri.convert(source, source.with_suffix(".glb")).report.warnings]
        assert [text for text in lost if "the float32 seconds of glTF are 0.0078 s apart" in text] == lost
        assert bool(lost) == said


def test_samples_nearer_than_float32_at_the_start_become_a_step_that_begins_at_zero(tmp_path: Path) -> None:
    source = _moving(tmp_path / "in.usda", 0, 1e-50, 1e-45, 1e-44, 10)
    rigtri.convert(source, tmp_path / "out.glb")
    (clip,) = rigtri.read(tmp_path / "out.glb").clips
    (track,) = clip.tracks
    assert track.times[0] == 0
    assert (np.diff(track.times) > 0).all()
    assert track.values[:, 0] == pytest.approx([0, 1e-50, 1e-45, 1e-44, 10])


def test_a_time_beyond_float32_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"clip 'in' has a key 1e\+300 time codes after its start"):
        rigtri.convert(_moving(tmp_path / "in.usda", 0, 1e300), tmp_path / "out.glb")


def test_what_is_not_read_is_reported_and_samples_stand_in_for_defaults(tmp_path: Path) -> None:
    _stage(tmp_path / "in.usda")
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    told = {n.text.removeprefix("not converted: ") for n in outcome.report.warnings if n.code == "lost"}
    assert told == {
        "PointInstancer </set/scatter> with its prototypes",
        "animation of focalLength (</set/zoom>)",
        "animation of visibility (</set/blink>)",
        "anything (</set/flick>)",
        "customData dept (</set>)",
        "customLayerData studio (</>)",
        "materials that no mesh has (</spare>)",
        "fStop (</set/zoom>)",
        # One to the side, of the diagonal √2.
        "inbetweens of blend shapes of mesh /set/blink: at their weights they move points up to 0.71 of the "
        "mesh's size, which is not in the deviation",
        "prims of type PhysicsScene (</physics>)",
    }
    # Before, nothing said so.
    for pair in (("in.usda", "out.glb"), ("out.glb", "in.usda")):
        assert rigtri.verify(*(tmp_path / name for name in pair), options=ReadOptions(empty=True)).unseen == (
            "the inbetweens of blend shapes of mesh /set/blink, which glTF cannot have",
        )
    gltf = glb_json(tmp_path / "out.glb")
    assert [node["name"] for node in gltf["nodes"] if "mesh" in node] == ["blink"]
    assert next(n for n in gltf["nodes"] if n["name"] == "blink")["extensions"]
    assert gltf["cameras"][0]["perspective"]["yfov"] == pytest.approx(0.43012, abs=1e-4)
    (light,) = gltf["extensions"]["KHR_lights_punctual"]["lights"]
    assert light["intensity"] == pytest.approx(10.0 * 3.14159 * 0.25 * 0.01**2, 1e-3), "of centimetres"


def test_weights_that_do_not_sum_to_one_are_reported_with_how_far_that_moves_points(tmp_path: Path) -> None:
    """UsdSkel shows the points nearer to its origin, and glTF knows no such weights."""
    weights = ("[1, 0, 0.5, 0.5, 1, 0]", "[0.7, 0, 0.35, 0.35, 1, 0]")
    (tmp_path / "in.usda").write_text(clean().replace(*weights))
    outcome = rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
    told = [n.text for n in outcome.report.warnings if "that do not sum to 1" in n.text]
    assert len(told) == 1
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-5
    assert outcome.verification.motion is not None
    assert outcome.verification.motion.deviation > 0.1
    (tmp_path / "as_one.usda").write_text(clean())
    outcome = rigtri.convert(tmp_path / "as_one.usda", tmp_path / "as_one.glb")
    assert not [n for n in outcome.report.warnings if "that do not sum to 1" in n.text]
