"""USD as glTF, and there and back: nothing moves otherwise, and materials and lenses come home."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from broken_usd import SHAPED
from calls import calls
from convertible import write_everything
from gltf_files import glb_bytes, glb_json
from gltf_files import glb_parts as read_glb
from places import SAMPLES, asset_files, sample_files, slow
from program import cli
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, UsdSkel
from second_opinions import khronos_errors
from usd_files import MESH, animation, at, deviation, read, save, scene, skeleton

import rigtri
from rigtri.errors import DeviationError
from rigtri.evaluation.sampling import Motion, morph_weights, worlds
from rigtri.evaluation.skinning import deformed
from rigtri.export.conversion.usd_scene import read_scene
from rigtri.formats import read as read_file
from rigtri.formats.usd.document import UsdDocument

TOLERANCE = 1e-5
USD = (".usd", ".usda", ".usdc", ".usdz")


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A glTF with everything, and what it is after a stay in USD, in centimetres with z up."""
    folder = tmp_path_factory.mktemp("home")
    source = write_everything(folder / "source.glb")
    rigtri.convert(source, folder / "there.usdz", up_axis="z", meters_per_unit=0.01)
    rigtri.convert(folder / "there.usdz", folder / "home.glb")
    return source, folder / "home.glb"


def test_openusd_prints_nothing_about_a_stage_that_lacks_what_it_names(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "arm.usda"
    text = (SAMPLES / "arm.usda").read_text("utf-8")
    source.write_text(text.replace("double3 xformOp:translate = (20, 140, 0)", ""), "utf-8")
    cli("convert", source, "-o", tmp_path / "out.glb", code=0)
    assert capfd.readouterr().err == ""


ARC = 'def Xform "A" ({} = @./gone.usda@)\n{{\n}}\n'
CUBE = 'def Cube "B"\n{\n}\n'


@pytest.mark.parametrize(
    ("text", "suffix"),
    [
        (ARC.format("references"), ".usda"),
        (ARC.format("payload"), ".usda"),
        ("(subLayers = [@./gone.usda@])\n", ".usda"),
        (ARC.format("references"), ".usdz"),
    ],
)
def test_nothing_is_converted_where_all_that_a_file_refers_to_is_missing(
    text: str, suffix: str, tmp_path: Path
) -> None:
    """Before, an empty file with a warning."""
    source, out = tmp_path / f"in{suffix}", tmp_path / "out.glb"

    def written(text: str) -> None:
        layer = source.with_suffix(".usda")
        layer.write_text(f"#usda 1.0\n{text}", "utf-8")
        if suffix == ".usdz":
            with Sdf.ZipFileWriter.CreateNew(str(source)) as package:
                package.AddFile(str(layer), layer.name)

    written(text)
    assert "gone.usda" in cli("convert", source, "-o", out, code=3).stderr
    assert not out.exists()
    cli("convert", source, "-o", out, "--allow-missing", code=0)
    written(text + CUBE)  # what is there is converted, with a warning
    assert "gone.usda" in cli("convert", source, "-o", out, "--overwrite", code=0).stderr
    written('def Xform "A"\n{\n}\n')  # nothing is missing here
    cli("convert", source, "-o", out, "--overwrite", code=0)


def test_an_animation_of_empty_samples_is_no_clip(tmp_path: Path) -> None:
    """Before, a TypeError."""
    empty = "quatf[] rotations.timeSamples = { 0: [], 5: [] }"
    source = save(tmp_path, scene(skeleton(), animation(rotations=empty, translations="", scales=""), MESH))
    cli("convert", source, "-o", tmp_path / "out.glb", code=0)
    assert "animations" not in glb_json(tmp_path / "out.glb")


@pytest.mark.parametrize("path", sample_files(".usda", ".usdz"), ids=lambda path: path.name)
@pytest.mark.parametrize("suffix", [".glb", ".gltf"])
def test_a_stage_in_gltf_looks_the_same(path: Path, suffix: str, tmp_path: Path) -> None:
    outcome = rigtri.convert(path, tmp_path / f"out{suffix}")
    assert outcome.verification is not None
    assert outcome.verification.poses > 1
    assert outcome.verification.deviation <= TOLERANCE


@pytest.mark.parametrize(
    ("joints", "weights"),
    [
        ("1, 1, 1, 2, 2, 1", "0.5, 0.5, 0.25, 0.75, 1, 0"),
        ("1, 1, 0, 2, 1, 0, 0, 0, 0, 2, 1, 0, 0, 1, 2", ".1, .2, .3, .2, .2, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0"),
        ("1, 1, 2, 2, 1, 1", "0, 0, 0.5, 0.5, 0, 0.5"),
        ("1, 1, 2, 2, 1, 0", "0.5, -0.5, 0, 0, 0.5, 0"),
        ("2, 1, 2, 1, 2, 1, 0, 0, 0, 0, 0, 0, 0, 1, 2, 0, 1, 2", ".1, " * 6 + ".3, " * 6 + ".2, " * 6),
        ("0, " * 27, "0.1, " * 27),
    ],
    ids=["once again", "five", "without any", "to nothing", "six of two joints", "nine of one"],
)
def test_a_joint_that_a_point_names_twice_is_there_once(joints: str, weights: str, tmp_path: Path) -> None:
    """The validator's rules: weights of a point sum to 1, and no joint is there twice or without weight."""
    mesh = MESH.replace("[1, 0, 0.5, 0.5, 1, 0] (elementSize = 2", f"[{weights}] (elementSize = {{}}")
    mesh = mesh.replace("[0, 1, 1, 2, 2, 1] (elementSize = 2", f"[{joints}] (elementSize = {{}}")
    width = len([one for one in joints.split(",") if one.strip()]) // 3
    source = save(
        tmp_path, scene(skeleton(), animation(), mesh.replace("elementSize = {}", f"elementSize = {width}"))
    )
    rigtri.convert(source, tmp_path / "out.glb")
    gltf, content = read_glb(tmp_path / "out.glb")
    attributes = gltf["meshes"][0]["primitives"][0]["attributes"]
    sets = range(sum(name.startswith("JOINTS") for name in attributes))
    named = np.concatenate([_accessor(gltf, content, attributes[f"JOINTS_{k}"], "<u2") for k in sets], axis=1)
    weigh = np.concatenate(
        [_accessor(gltf, content, attributes[f"WEIGHTS_{k}"], "<f4") for k in sets], axis=1
    )
    assert (np.abs(weigh.sum(axis=1) - 1.0) <= 2e-7 * np.count_nonzero(weigh, axis=1)).all()
    for own, share in zip(named.tolist(), weigh.tolist(), strict=True):
        live = [joint for joint, weight in zip(own, share, strict=True) if weight]
        assert len(set(live)) == len(live)
        assert not any(joint for joint, weight in zip(own, share, strict=True) if not weight)


def _accessor(gltf: dict[str, Any], content: bytes, number: int, kind: str) -> Any:
    """Rows of four numbers of an accessor that begins where its view does."""
    accessor = gltf["accessors"][number]
    view = gltf["bufferViews"][accessor["bufferView"]]
    assert "byteOffset" not in accessor
    found = np.frombuffer(content, kind, 4 * accessor["count"], view.get("byteOffset", 0))
    return found.reshape(-1, 4)


def test_each_file_is_measured_by_its_own_method_of_skinning(tmp_path: Path) -> None:
    bound = "rel skel:skeleton = </Root/Skel>"
    method = f'{bound}\n    uniform token primvars:skel:skinningMethod = "dualQuaternion"'
    source = save(tmp_path, scene(skeleton(), animation(), MESH.replace(bound, method)))
    out = tmp_path / "out.glb"
    outcome = rigtri.convert(source, out)
    found = outcome.verification
    assert found is not None
    assert found.deviation <= TOLERANCE, "linear blending is what glTF has"
    assert found.motion is not None
    far = deviation(source, save(tmp_path, scene(skeleton(), animation(), MESH), "linear.usda"))
    assert found.motion.deviation > 0.3 < far, "how far that moves points is told"
    for files in ((source, out), (out, source)):
        assert "looks different" in cli("verify", *files, code=6).output
    linear = rigtri.convert(tmp_path / "linear.usda", tmp_path / "linear.glb").verification
    assert linear is not None
    assert linear.motion is None


def test_rotations_that_are_not_unit_become_so_and_what_that_changes_is_told(tmp_path: Path) -> None:
    keys = (
        "1: [(1, 0, 0, 0), (1, 0, 0, 0), (0.8, 0.6, 0, 0)],\n5: [({}, 0, {}, 0), (1, 0, 0, 0), (0, 1, 0, 0)]"
    )
    sources = {
        name: save(
            tmp_path,
            scene(
                skeleton(),
                animation(rotations=f"quatf[] rotations.timeSamples = {{\n{keys.format(*turn)}\n}}"),
                MESH,
            ),
            f"{name}.usda",
        )
        for name, turn in {"unit": (0.8, 0.6), "long": (1.2, 0.9)}.items()
    }
    out = tmp_path / "long.glb"
    outcome = rigtri.convert(sources["long"], out)
    found = outcome.verification
    assert found is not None
    assert found.deviation <= TOLERANCE
    assert found.motion is not None
    assert found.motion.deviation > 0.9 * deviation(sources["long"], sources["unit"]) > 0.2
    assert "not unit, by up to 0.5" in " ".join(n.text for n in outcome.report.warnings if n.code == "lost")
    gltf = rigtri.read(out)
    for track in gltf.clips[0].tracks:
        if track.path == "rotation":
            assert np.abs(np.linalg.norm(track.values, axis=1) - 1.0).max() < 1e-6
    assert "looks different" in cli("verify", sources["long"], out, code=6).output
    unit = rigtri.convert(sources["unit"], tmp_path / "unit.glb").verification
    assert unit is not None
    assert unit.motion is None


def test_rotations_of_four_digits_are_made_unit_and_measured_beside(tmp_path: Path) -> None:
    """Of (0.7071, 0.7071) the square is 2e-5 too small: as a scale, more than a conversion may be off."""
    keys = "quatf[] rotations.timeSamples = {\n1: [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)],\n"
    keys += "5: [(0.7071, 0.7071, 0, 0), (1, 0, 0, 0), (0.7071, 0, 0, 0.7071)],\n}"
    source = save(tmp_path, scene(skeleton(), animation(rotations=keys), MESH))
    outcome = rigtri.convert(source, tmp_path / "out.glb")
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6
    assert outcome.verification.motion is not None
    assert outcome.verification.motion.deviation > TOLERANCE
    assert "not unit, by up to 9.6e-06" in " ".join(n.text for n in outcome.report.warnings)


@pytest.mark.parametrize("path", [slow(p) for p in asset_files(*USD)] or [slow(None)], ids=str)
def test_a_real_stage_in_gltf_looks_the_same_and_is_valid(
    path: Path | None, tmp_path: Path, assets: Path
) -> None:
    assert path is not None
    out = tmp_path / "out.glb"
    outcome = rigtri.convert(path, out)
    assert outcome.verification is not None
    assert outcome.verification.deviation <= TOLERANCE
    assert khronos_errors(out) == [{}]


@pytest.mark.parametrize("clip", ["wave hand", "nod"])
def test_every_point_comes_home(home: tuple[Path, Path], clip: str) -> None:
    rigs = [rigtri.read(path) for path in home]
    moved = []
    for rig in rigs:
        played = rig.clip(clip)
        times = np.array([0.0, 0.2, 0.5, 0.9, 1.25])
        world = worlds(rig, Motion(rig, played).locals_at(times))
        moved.append([deformed(m, rig, world, morph_weights(m, played, times)) for m in rig.meshes])
    assert len(moved[0]) == len(moved[1])
    for points in moved[0]:
        assert min(np.abs(points - other).max() for other in moved[1]) < 2e-5


def test_materials_lenses_and_extras_come_home(home: tuple[Path, Path]) -> None:
    source, back = map(glb_json, home)
    cloth = next(m for m in back["materials"] if m["name"] == "cloth")
    was = source["materials"][0]
    plain, old = cloth["pbrMetallicRoughness"], was["pbrMetallicRoughness"]
    for name in ("baseColorFactor", "metallicFactor", "roughnessFactor"):
        assert plain[name] == pytest.approx(old[name])
    for name in ("alphaMode", "doubleSided"):
        assert cloth[name] == was[name]
    assert cloth["emissiveFactor"] == pytest.approx(was["emissiveFactor"])
    assert cloth["normalTexture"]["scale"] == pytest.approx(0.5)
    assert cloth["occlusionTexture"]["strength"] == pytest.approx(0.75)
    change = plain["baseColorTexture"]["extensions"]["KHR_texture_transform"]
    assert change["offset"] == pytest.approx([0.25, 0.5], abs=1e-6)
    assert change["rotation"] == pytest.approx(0.5)
    assert change["scale"] == pytest.approx([2, 3])
    lenses = {camera["type"]: camera[camera["type"]] for camera in back["cameras"]}
    for camera in source["cameras"]:
        assert lenses[camera["type"]] == pytest.approx(camera[camera["type"]], rel=1e-6)
    lights = [
        {light["type"]: light for light in file["extensions"]["KHR_lights_punctual"]["lights"]}
        for file in (source, back)
    ]
    assert lights[0].keys() == lights[1].keys()
    for kind, light in lights[0].items():
        assert lights[1][kind]["intensity"] == pytest.approx(light["intensity"], rel=1e-6)
    torches = [file["spot"] for file in lights]
    assert torches[1]["color"] == pytest.approx(torches[0]["color"], abs=1e-6)
    assert torches[1]["spot"] == pytest.approx(torches[0]["spot"], rel=1e-6)
    extras = {node.get("name"): node["extras"] for node in back["nodes"] if "extras" in node}
    assert extras["root joint"] == {"tag": "hip", "list": [1, "two"]}
    assert extras["prop"] == {"mass": 2.5}
    assert [clip["name"] for clip in back["animations"]] == ["wave hand", "nod"]


@pytest.mark.ci
def test_verify_compares_the_two_formats(home: tuple[Path, Path], tmp_path: Path) -> None:
    source, back = home
    there = source.with_name("there.usdz")
    for pair in ((source, there), (there, source), (there, back), (back, there)):
        shown = cli("verify", *pair, "--json").json
        assert shown["passes"]
        assert shown["poses"] > 10
    moved = read_glb(source)
    moved[0]["nodes"][2]["translation"] = [0, 1.01, 0]
    (tmp_path / "moved.glb").write_bytes(glb_bytes(*moved))
    assert not cli("verify", tmp_path / "moved.glb", there, "--json", code=6).json["passes"]


def test_what_comes_home_is_valid(home: tuple[Path, Path]) -> None:
    assert khronos_errors(home[1]) == [{}]


def _quad(folder: Path) -> Path:
    """A quad and a triangle, with texture coordinates by corner, in two materials; twice, as instances."""
    stage = Usd.Stage.CreateNew(str(folder / "quad.usda"))
    stage.CreateClassPrim("/Proto")
    mesh = UsdGeom.Mesh.Define(stage, "/Proto/faces")
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0)])
    mesh.CreateFaceVertexCountsAttr([4, 3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3, 1, 4, 2])
    mesh.CreateSubdivisionSchemeAttr("none")
    st = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying")
    st.Set([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0), (0, 0.5), (1, 1)])
    for number, name in enumerate(("red", "blue")):
        material = UsdShade.Material.Define(stage, f"/Proto/{name}")
        surface = UsdShade.Shader.Define(stage, f"/Proto/{name}/Surface")
        surface.CreateIdAttr("UsdPreviewSurface")
        surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set((1 - number, 0, number))
        material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
        subset = UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).CreateMaterialBindSubset(name, [number])
        UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(material)
    for number in range(2):
        prim = stage.DefinePrim(f"/Stage/copy_{number}", "Xform")
        prim.GetReferences().AddInternalReference("/Proto")
        prim.SetInstanceable(True)
        UsdGeom.Xformable(prim).AddTranslateOp().Set((0, 0, float(number)))
    stage.Save()
    return folder / "quad.usda"


def test_corners_subsets_and_instances_become_points_primitives_and_nodes(tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    rigtri.convert(_quad(tmp_path), out)
    gltf: dict[str, Any] = glb_json(out)
    shown = [node["mesh"] for node in gltf["nodes"] if "mesh" in node]
    assert shown == [0, 0]
    assert len(gltf["meshes"]) == 1
    red, blue = gltf["meshes"][shown[0]]["primitives"]
    counts = [gltf["accessors"][p["indices"]]["count"] for p in (red, blue)]
    assert counts == [6, 3]
    # Point 1 has two texture coordinates, point 2 the same twice.
    assert gltf["accessors"][red["attributes"]["POSITION"]]["count"] == 6
    colours = [
        gltf["materials"][p["material"]]["pbrMetallicRoughness"]["baseColorFactor"] for p in (red, blue)
    ]
    assert colours == [[1, 0, 0, 1], [0, 0, 1, 1]]


def test_a_mask_that_hides_nothing_comes_home_as_opaque(tmp_path: Path) -> None:
    """An opacityThreshold of 0 means blending in USD."""
    gltf, binary = read_glb(write_everything(tmp_path / "in.glb"))
    (masked,) = (each for each in gltf["materials"] if each.get("alphaMode") == "MASK")
    masked["alphaCutoff"] = 0.0
    (tmp_path / "in.glb").write_bytes(glb_bytes(gltf, binary))
    rigtri.convert(tmp_path / "in.glb", tmp_path / "there.usda")
    rigtri.convert(tmp_path / "there.usda", tmp_path / "home.glb")
    (home,) = (
        each for each in glb_json(tmp_path / "home.glb")["materials"] if each["name"] == masked["name"]
    )
    assert "alphaMode" not in home
    assert "alphaCutoff" not in home


def test_names_that_several_have_become_distinct_and_come_home(tmp_path: Path) -> None:
    gltf, binary = read_glb(write_everything(tmp_path / "in.glb"))
    first, second, *_ = gltf["skins"][0]["joints"]
    gltf["nodes"][first]["name"] = gltf["nodes"][second]["name"] = "hip/1 x"
    gltf["animations"][1]["name"] = gltf["animations"][0]["name"] = "walk"
    gltf["cameras"][0]["extras"] = {"film": 1}
    (tmp_path / "in.glb").write_bytes(glb_bytes(gltf, binary))
    outcome = rigtri.convert(tmp_path / "in.glb", tmp_path / "there.usda")
    told = [notice.text for notice in outcome.report.warnings]
    for words in ("called 'hip/1 x'", "clips are called 'walk': one is 'walk_1'", "extras of cameras (1)"):
        assert any(words in text for text in told)
    rigtri.convert(tmp_path / "there.usda", tmp_path / "home.glb")
    home = glb_json(tmp_path / "home.glb")
    assert {"hip/1 x", "hip/1 x_1"} <= {node.get("name") for node in home["nodes"]}
    assert [clip["name"] for clip in home["animations"][:2]] == ["walk", "walk_1"]


def test_a_pose_that_an_animation_holds_without_samples_is_a_clip(tmp_path: Path) -> None:
    held = "quatf[] rotations = [(1, 0, 0, 0), (0.6, 0, 0, 0.8), (1, 0, 0, 0)]"
    out = tmp_path / "pose.glb"
    rigtri.convert(save(tmp_path, scene(skeleton(), animation(rotations=held), MESH)), out)
    (clip,) = rigtri.read(out).clips
    (turn,) = (track.values for track in clip.tracks if track.path == "rotation" and track.values[0, 3] < 0.9)
    assert np.allclose(turn[0], (0.0, 0.0, 0.8, 0.6))


def test_an_animation_of_blend_shapes_alone_that_nothing_plays_is_a_clip(tmp_path: Path) -> None:
    """It lists no joints: the meshes that have its shapes say which skeleton it is for."""
    shape = 'def BlendShape "smile" { uniform vector3f[] offsets = [(0, 0, 1), (0, 0, 1), (0, 1, 0)]\n}\n}'
    bound = 'uniform token[] skel:blendShapes = ["smile"]\nrel skel:blendShapeTargets = </Root/Skin/smile>\n'
    mesh = MESH.rstrip().removesuffix("}") + bound + shape
    weights = "float[] blendShapeWeights.timeSamples = { 1: [0], 9: [0.5] }"
    blink = f'def SkelAnimation "Blink" {{ uniform token[] blendShapes = ["smile"]\n{weights}\n}}'
    other = blink.replace("smile", "frown").replace("Blink", "Other")
    source = save(tmp_path, scene(skeleton(), animation(), mesh, blink, other))
    report = rigtri.convert(source, tmp_path / "out.glb").report
    assert [clip["name"] for clip in glb_json(tmp_path / "out.glb")["animations"]] == ["Anim", "Blink"]
    (lost,) = [one.text for one in report.warnings if "of no skeleton" in one.text]
    assert "</Root/Other>" in lost


@pytest.mark.parametrize(
    "lacking",
    [
        {"scales": ""},
        {"scales": "half3[] scales = [(1, 1, 1)]"},
        {"translations": "float3[] translations.timeSamples = { 1: None, 9: None }"},
    ],
    ids=["no scales", "one scale for three joints", "blocked translations"],
)
def test_blend_shapes_play_where_joints_lack_an_array(lacking: dict[str, str], tmp_path: Path) -> None:
    """As UsdSkel plays them: it gives the joints alone no pose."""
    moved = animation(
        blend='uniform token[] blendShapes = ["smile"]',
        weights="float[] blendShapeWeights.timeSamples = { 1: [0], 9: [0.5] }",
        **lacking,
    )
    source = save(tmp_path, scene(skeleton(), moved, SHAPED))
    stage = Usd.Stage.Open(str(source))
    assert UsdSkel.BakeSkinning(stage.Traverse(), Gf.Interval.GetFullInterval())
    points = UsdGeom.PointBased(stage.GetPrimAtPath("/Root/Skin")).GetPointsAttr()
    assert not np.allclose(points.Get(9.0), points.Get(1.0))
    rigtri.convert(source, tmp_path / "out.glb")
    (clip,) = rigtri.read(tmp_path / "out.glb").clips
    (weights,) = clip.tracks
    assert weights.path == "weights"
    assert np.allclose(weights.values.ravel(), (0.0, 0.5))


@pytest.mark.parametrize(("second", "told"), [("2, 1, 1", True), ("1, 1, 1", False)])
def test_scales_that_openusd_rounds_between_samples_are_listed(
    second: str, told: bool, tmp_path: Path
) -> None:
    still = "(1, 1, 1), (1, 1, 1)"
    scales = f"half3[] scales.timeSamples = {{ 1: [(1, 1, 1), {still}], 9: [({second}), {still}] }}"
    source = save(tmp_path, scene(skeleton(), animation(scales=scales), MESH))
    warnings = rigtri.convert(source, tmp_path / "out.glb").report.warnings
    lost = [one.text for one in warnings if "half floats" in one.text]
    assert len(lost) == told
    assert all("by up to 9.8e-4" in text for text in lost)


def test_blocked_samples_are_seen_by_verify(tmp_path: Path) -> None:
    whole = save(tmp_path, scene(skeleton(), animation(), MESH), "whole.usda")
    text = whole.read_text().replace("timeSamples = {", "timeSamples = {\n3: None,", 1)
    blocked = save(tmp_path, text, "blocked.usda")
    assert "blocked times" in cli("verify", whole, blocked, code=6).stdout


def _coloured(path: Path, interpolation: str, colours: Any, material: str) -> dict[str, Any]:
    """A triangle with a displayColor in USD, as glTF. material: none, plain, or reader, which shows it."""
    stage = Usd.Stage.CreateNew(str(path))
    mesh = UsdGeom.Mesh.Define(stage, "/leaf")
    stage.SetDefaultPrim(mesh.GetPrim())
    Usd.ModelAPI(mesh.GetPrim()).SetKind("component")
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    mesh.CreateDisplayColorPrimvar(interpolation).Set(colours)
    if material != "none":
        look = UsdShade.Material.Define(stage, "/leaf/look")
        surface = UsdShade.Shader.Define(stage, "/leaf/look/surface")
        surface.CreateIdAttr("UsdPreviewSurface")
        colour = surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
        look.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
        if material == "reader":
            reader = UsdShade.Shader.Define(stage, "/leaf/look/reader")
            reader.CreateIdAttr("UsdPrimvarReader_float3")
            reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("displayColor")
            reader.CreateOutput("result", Sdf.ValueTypeNames.Float3)
            colour.ConnectToSource(reader.ConnectableAPI(), "result")
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(look)
    stage.Save()
    out = path.with_suffix(".glb")
    strict = () if material == "plain" and interpolation == "vertex" else ("--strict",)
    ran = cli("convert", path, "-o", out, *strict, code=0)
    assert ("displayColor" in ran.stderr) == (not strict)
    return glb_json(out)


def test_a_mesh_without_material_is_drawn_in_its_colour(tmp_path: Path) -> None:
    gltf = _coloured(tmp_path / "in.usda", "constant", [(0.5, 0.25, 1.0)], "none")
    (look,) = gltf["materials"]
    assert look["pbrMetallicRoughness"]["baseColorFactor"] == [0.5, 0.25, 1.0, 1.0]
    assert look["pbrMetallicRoughness"]["metallicFactor"] == 0.0
    assert gltf["meshes"][0]["primitives"][0]["material"] == 0


@pytest.mark.parametrize(("material", "shown"), [("none", True), ("reader", True), ("plain", False)])
def test_colours_of_points_are_shown_where_usd_shows_them(material: str, shown: bool, tmp_path: Path) -> None:
    colours = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    gltf = _coloured(tmp_path / "in.usda", "vertex", colours, material)
    assert ("COLOR_0" in gltf["meshes"][0]["primitives"][0]["attributes"]) == shown


def test_the_colour_of_a_whole_mesh_is_shown_where_its_material_reads_it(tmp_path: Path) -> None:
    gltf = _coloured(tmp_path / "in.usda", "constant", [(0.5, 0.25, 1.0)], "reader")
    assert "COLOR_0" in gltf["meshes"][0]["primitives"][0]["attributes"]


_C = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (3, 2), (3, 3), (0, 3)]
_L = [(0, 2), (0, 0), (2, 0), (2, 1), (1, 1), (1, 2)]


@pytest.mark.parametrize(("outline", "area"), [(_C, 7.0), (_L, 3.0), (_L[::-1], 3.0)])
@pytest.mark.parametrize("orientation", ["rightHanded", "leftHanded"])
def test_triangles_stay_in_concave_polygons(
    outline: list[tuple[int, int]], area: float, orientation: str, tmp_path: Path
) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "in.usda"))
    mesh = UsdGeom.Mesh.Define(stage, "/leaf")
    stage.SetDefaultPrim(mesh.GetPrim())
    mesh.CreatePointsAttr([(x, y, 0) for x, y in [*outline, (9, 9), (9, 8)]])
    mesh.CreateFaceVertexCountsAttr([3, len(outline)])
    mesh.CreateFaceVertexIndicesAttr([len(outline), len(outline) + 1, 0, *range(len(outline))])
    mesh.CreateOrientationAttr(orientation)
    stage.Save()
    cli("convert", tmp_path / "in.usda", "-o", tmp_path / "out.glb", code=0)
    (found,) = read_file(tmp_path / "out.glb").rig.meshes
    surface = found.surface_now
    assert surface is not None
    a, b, c = np.moveaxis(found.points[surface.corners].reshape(-1, 3, 3)[1:], 1, 0)
    twice = np.cross(b - a, c - a)[:, 2]
    assert np.abs(twice).sum() / 2.0 == pytest.approx(area)
    assert len({np.sign(each) for each in twice}) == 1


@pytest.mark.parametrize(
    ("purposes", "shown"), [(("", "full", "preview"), "preview"), (("full",), "full"), (("", "full"), "all")]
)
def test_materials_are_those_of_previews(purposes: tuple[str, ...], shown: str, tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "in.usda"))
    mesh = UsdGeom.Mesh.Define(stage, "/leaf")
    stage.SetDefaultPrim(mesh.GetPrim())
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    for purpose in purposes:
        look = UsdShade.Material.Define(stage, f"/leaf/{purpose or 'all'}")
        surface = UsdShade.Shader.Define(stage, look.GetPath().AppendChild("surface"))
        surface.CreateIdAttr("UsdPreviewSurface")
        look.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
        UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(look, materialPurpose=purpose)
    stage.Save()
    cli("convert", tmp_path / "in.usda", "-o", tmp_path / "out.glb", code=0)
    assert [each["name"] for each in glb_json(tmp_path / "out.glb")["materials"]] == [shown]


def test_colours_that_are_spread_in_no_known_way_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "in.usda"
    _coloured(path, "vertex", [(1, 0, 0), (0, 1, 0), (0, 0, 1)], "none")
    path.write_text(path.read_text("utf-8").replace('"vertex"', '"smooth"'), "utf-8")
    ran = cli("convert", path, "-o", tmp_path / "odd.glb", code=0)
    assert "COLOR_0 of mesh /leaf" in ran.stderr + ran.stdout


@pytest.mark.parametrize(
    ("points", "normals", "target"),
    [
        (None, [(1, 0, 0), (0, 2, 0), (0, 0, 3)], [[1, 0, 0], [0, 2, 0], [0, 0, 3]]),
        ([2, 0], [(1, 0, 0), (0, 2, 0)], [[0, 2, 0], [0, 0, 0], [1, 0, 0]]),
        (None, [(1, 0, 0)], None),  # not one for each point
        ([7], [(1, 0, 0)], None),  # of a point that is not there
    ],
)
def test_normals_of_blend_shapes_are_those_of_morph_targets(
    points: list[int] | None, normals: list[Any], target: Any, tmp_path: Path
) -> None:
    path = save(tmp_path, scene(skeleton(), animation(), MESH))
    stage = Usd.Stage.Open(str(path))
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/Root/Skin"))
    mesh.CreateNormalsAttr([(0, 0, 1)] * 3)
    mesh.SetNormalsInterpolation("vertex")
    shape = UsdSkel.BlendShape.Define(stage, "/Root/Skin/smile")
    count = 3 if points is None else len(points)
    shape.CreateOffsetsAttr([(0, 1, 0)] * count)
    shape.CreateNormalOffsetsAttr(normals)
    if points is not None:
        shape.CreatePointIndicesAttr(points)
    binding = UsdSkel.BindingAPI(mesh.GetPrim())
    binding.CreateBlendShapesAttr(["smile"])
    binding.CreateBlendShapeTargetsRel().SetTargets([shape.GetPath()])
    stage.Save()
    rigtri.convert(path, tmp_path / "out.glb", verify=False)
    gltf, binary = read_glb(tmp_path / "out.glb")
    (primitive,) = gltf["meshes"][0]["primitives"]
    (found,) = primitive.get("targets", [{}])
    if target is None:
        assert "NORMAL" not in found
    else:
        accessor = gltf["accessors"][found["NORMAL"]]
        start = gltf["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get(
            "byteOffset", 0
        )
        assert np.frombuffer(binary, "<f4", 9, start).reshape(3, 3).tolist() == target


def test_four_times_as_many_prims_in_a_row_are_read_in_four_times_as_long(tmp_path: Path) -> None:
    """Before, each asked all above it whether they are invisible, and 1,200 took minutes."""

    def row(count: int) -> UsdDocument:
        prims = "".join(f'def Xform "p{k}" {{\n' for k in range(count)) + "}\n" * count
        return read(save(tmp_path, f"#usda 1.0\n{prims}", f"{count}.usda"), empty=True)

    few, many = row(20), row(80)
    once = calls(lambda: read_scene(few, "row"))
    assert calls(lambda: read_scene(many, "row")) < 5 * once


@pytest.mark.parametrize(
    ("axes", "code", "what"),
    [("(1, 0.5, 0, 0), (0, 1, 0, 0)", 6, "sheared"), ("(1, 0.5, 0, 0), (2, 1, 0, 0)", 5, "flat")],
)
def test_a_rest_pose_that_gltf_cannot_say_of_joints_that_move_is_refused_with_what_to_do(
    axes: str, code: int, what: str, tmp_path: Path
) -> None:
    """Blender writes the pose of the first frame as rest, with the shear of bones below stretched ones.

    Of flat axes, before: "out.glb: this is not valid JSON: NaN is not a JSON number".
    """
    odd = f"({axes}, (0, 0, 1, 0), (0, 2, 0, 1))"
    rest = f"uniform matrix4d[] restTransforms = [{at(0, 0, 0)}, {odd}, {at(0, 2, 1)}]"
    source = save(tmp_path, scene(skeleton(rest=rest), animation(), MESH))
    printed = cli("convert", source, "-o", tmp_path / "out.glb", code=code).output
    assert f"The rest pose of 'b' is {what}" in " ".join(printed.split())
    cli("set-rest", source, "--pose", "bind", "-o", tmp_path / "bound.usda", code=0)
    cli("convert", tmp_path / "bound.usda", "-o", tmp_path / "out.glb", code=0)


def test_a_blend_shape_that_is_not_there_moves_nothing(tmp_path: Path) -> None:
    shapes = """uniform token[] skel:blendShapes = ["smile", "gone"]
    rel skel:blendShapeTargets = [</Root/Skin/smile>, </Root/Skin/gone>]
    def BlendShape "smile" { uniform vector3f[] offsets = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    }
}"""
    source = save(tmp_path, scene(skeleton(), animation(), MESH.rstrip("}") + shapes))
    cli("convert", source, "-o", tmp_path / "out.glb", code=0)
    assert rigtri.verify(source, tmp_path / "out.glb").deviation < 1e-6


def test_a_key_whose_rounding_is_what_differs_is_named(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "in.usda"))
    box = UsdGeom.Mesh.Define(stage, "/box")
    box.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    box.CreateFaceVertexCountsAttr([3])
    box.CreateFaceVertexIndicesAttr([0, 1, 2])
    move = box.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble)
    for time, far in ((0.0, 0.0), (24.0, 100000001.3)):
        move.Set(Gf.Vec3d(far, 0, 0), time)
    stage.Save()
    words = r"The translation of 'box' in clip 'xforms' is 1e\+08: the float32"
    with pytest.raises(DeviationError, match=words):
        rigtri.convert(tmp_path / "in.usda", tmp_path / "out.glb")
