"""glTF as USD: nothing moves otherwise, and what USD can say is said in its own words."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from convertible import png, write_everything
from gltf_files import glb_bytes, glb_json, glb_parts, small
from morphs import arm
from numpy.testing import assert_allclose
from places import SAMPLES, asset_files, ci, first, sample_files, slow
from program import cli
from pxr import Gf, Tf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel
from second_opinions import usd_errors

import rigtri
from rigtri.errors import FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.adaptive_sampling import WITHIN
from rigtri.evaluation.sampling import Motion, morph_weights, worlds
from rigtri.evaluation.skinning import deformed
from rigtri.export.conversion.usd_values import dictionary

TOLERANCE = 1e-5
# Scales of the sample's clips as the half floats of a SkelAnimation: half a step is 2.4e-4 of each.
HALF_SCALES = 2.4e-4
GLTF = (".glb", ".gltf", ".vrm", ".vrma")


@pytest.fixture(scope="module")
def everything(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("everything")
    return write_everything(folder / "every thing.glb")


@pytest.fixture(scope="module")
def stage(everything: Path) -> Any:
    rigtri.convert(everything, everything.with_suffix(".usda"))
    return Usd.Stage.Open(str(everything.with_suffix(".usda")))


@pytest.mark.parametrize("path", sample_files(".glb"), ids=lambda path: path.name)
def test_a_file_in_usd_looks_the_same_and_is_valid(path: Path, tmp_path: Path) -> None:
    out = tmp_path / f"{path.stem}.usdc"
    outcome = rigtri.convert(path, out)
    assert outcome.verification is not None
    assert outcome.verification.poses > 1
    assert outcome.verification.deviation <= TOLERANCE
    assert not usd_errors(out)


@pytest.mark.parametrize("path", [slow(p) for p in asset_files(*GLTF)] or [slow(None)], ids=str)
def test_a_real_file_in_usd_looks_the_same(path: Path | None, tmp_path: Path, assets: Path) -> None:
    assert path is not None
    out = tmp_path / "out.usdz"
    outcome = rigtri.convert(path, out)
    assert outcome.verification is not None
    assert outcome.verification.deviation <= TOLERANCE
    assert not usd_errors(out)


@pytest.mark.parametrize(
    "look", [{}, {"up_axis": "z", "meters_per_unit": 0.01}], ids=["metres", "centimetres"]
)
@pytest.mark.parametrize("clip", ["wave hand", ci("nod")])
def test_usd_s_own_skinning_puts_every_point_where_gltf_has_it(
    everything: Path, tmp_path: Path, clip: str, look: dict[str, Any]
) -> None:
    out = tmp_path / "out.usdc"
    rigtri.convert(everything, out, clip=[clip], **look)
    stage = Usd.Stage.Open(str(out))
    assert UsdSkel.BakeSkinning(stage.Traverse(), Gf.Interval.GetFullInterval())
    rig = rigtri.read(everything)
    motion, rate = Motion(rig, rig.clip(clip)), stage.GetTimeCodesPerSecond()
    meshes = sorted(rig.meshes, key=lambda mesh: mesh.node)
    prims = {prim.GetName(): prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)}
    assert len(prims) == len(meshes)
    for time in (0.0, 0.5, 1.25):  # keys: between them what is baked goes straight
        world = worlds(rig, motion.locals_at([time]))
        wanted = [
            deformed(mesh, rig, world, morph_weights(mesh, rig.clip(clip), np.array([time])))[0]
            for mesh in meshes
        ]
        cache = UsdGeom.XformCache(time * rate)
        found = []
        for prim in prims.values():
            points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(time * rate), dtype=np.float64)
            place = np.array(cache.GetLocalToWorldTransform(prim))
            found.append((np.c_[points, np.ones(len(points))] @ place)[:, :3])
        if look:
            found = [np.stack([p[:, 0], p[:, 2], -p[:, 1]], axis=1) * 0.01 for p in found]
        for points in wanted:
            assert min(np.abs(points - other).max() for other in found) < 1e-5


def test_joints_and_skins_share_a_skeleton_where_their_bind_poses_agree(stage: Any) -> None:
    skeletons = [prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton)]
    assert len(skeletons) == 2  # the third skin has another bind pose
    assert list(UsdSkel.Skeleton(skeletons[0]).GetJointsAttr().Get())[:2] == [
        "root_joint",
        "root_joint/tip_001",
    ]
    assert "root joint" in UsdSkel.Skeleton(skeletons[0]).GetJointNamesAttr().Get()
    coats = [p for p in stage.Traverse() if p.IsA(UsdGeom.Mesh) and p.GetParent().GetName() == "coat"]
    geom = UsdSkel.BindingAPI(coats[0]).GetGeomBindTransformAttr().Get()
    np.testing.assert_allclose(np.array(geom), np.diag([2.0, 2.0, 2.0, 1.0]), atol=1e-6)


def test_colours_of_points_are_display_colours_and_opacities(stage: Any) -> None:
    coat = next(p for p in stage.Traverse() if p.IsA(UsdGeom.Mesh) and p.GetParent().GetName() == "coat")
    colour, opacity = (
        UsdGeom.PrimvarsAPI(coat).GetPrimvar(f"display{name}") for name in ("Color", "Opacity")
    )
    np.testing.assert_allclose(np.array(colour.Get()), [[0.5, 0.25, 1.0]] * len(opacity.Get()))
    np.testing.assert_allclose(np.array(opacity.Get()), 1.0)


def test_whole_numbers_that_usd_has_no_int_for_are_kept_as_json() -> None:
    least, beyond = -(2**31), 2**31
    assert dictionary({"least": least, "beyond": beyond}) == {"least": least, "beyond": {"json": str(beyond)}}


def test_names_and_extras_are_kept(stage: Any) -> None:
    prop = stage.GetPrimAtPath("/every_thing/prop")
    assert prop.GetCustomDataByKey("extras")["mass"] == 2.5
    assert stage.GetDefaultPrim().GetName() == "every_thing"
    joints = next(p for p in stage.Traverse() if p.IsA(UsdSkel.Skeleton)).GetCustomDataByKey("extras")
    assert joints["root_joint"]["tag"] == "hip"
    assert json.loads(joints["root_joint"]["list"]["json"]) == [1, "two"]
    first = stage.GetPrimAtPath("/every_thing/Animations").GetChildren()[0]
    assert first.GetDisplayName() == "wave hand"


def test_a_material_is_a_preview_surface_with_its_channels(stage: Any) -> None:
    cloth = UsdShade.Material.Get(stage, "/every_thing/Materials/cloth")
    surface = UsdShade.Shader(stage.GetPrimAtPath("/every_thing/Materials/cloth/Surface"))
    assert cloth.ComputeSurfaceSource()[0].GetPath() == surface.GetPath()
    for name, output in (("metallic", "b"), ("roughness", "g"), ("occlusion", "r"), ("opacity", "a")):
        assert surface.GetInput(name).GetConnectedSources()[0][0].sourceName == output
    assert surface.GetInput("opacityThreshold").Get() == pytest.approx(0.3)
    texture = UsdShade.Shader(stage.GetPrimAtPath("/every_thing/Materials/cloth/base"))
    assert list(texture.GetInput("scale").Get()) == pytest.approx([1, 0.5, 0.25, 0.9])
    assert texture.GetInput("wrapS").Get() == "clamp"
    assert texture.GetInput("file").Get().resolvedPath
    body = next(p for p in stage.GetPrimAtPath("/every_thing/Armature/body").GetChildren())
    assert UsdGeom.Mesh(body).GetDoubleSidedAttr().Get() is True
    st = UsdGeom.PrimvarsAPI(body).GetPrimvar("st").Get()
    assert list(st[4]) == pytest.approx([0.0, 0.5])


def test_a_texture_transform_takes_the_same_texel(stage: Any) -> None:
    """By hand: KHR_texture_transform's own formula, then v turned over."""
    node = UsdShade.Shader(stage.GetPrimAtPath("/every_thing/Materials/cloth/base_transform"))
    scale, degrees, offset = (node.GetInput(n).Get() for n in ("scale", "rotation", "translation"))
    u, v, r = 0.3, 0.7, np.radians(degrees)
    x, y = u * scale[0], (1 - v) * scale[1]
    got = np.cos(r) * x - np.sin(r) * y + offset[0], 1 - (np.sin(r) * x + np.cos(r) * y + offset[1])
    c, s = np.cos(0.5), np.sin(0.5)
    assert got == pytest.approx((0.25 + c * 2 * u + s * 3 * v, 0.5 - s * 2 * u + c * 3 * v), abs=1e-6)


def test_cameras_and_lights_keep_their_lenses(stage: Any) -> None:
    by_type = {prim.GetTypeName(): prim for prim in stage.Traverse()}
    cameras = [UsdGeom.Camera(p).GetCamera(0) for p in stage.Traverse() if p.IsA(UsdGeom.Camera)]
    views = {c.projection: c for c in cameras}
    wide = views[Gf.Camera.Perspective]
    assert np.radians(wide.GetFieldOfView(Gf.Camera.FOVVertical)) == pytest.approx(0.8, abs=1e-6)
    assert wide.aspectRatio == pytest.approx(1.5)
    flat = views[Gf.Camera.Orthographic]
    assert (flat.horizontalAperture / 10, flat.verticalAperture / 10) == pytest.approx((4, 2))
    assert UsdLux.DistantLight(by_type["DistantLight"]).GetIntensityAttr().Get() == 3
    cone = UsdLux.ShapingAPI(by_type["SphereLight"])
    assert cone.GetShapingConeAngleAttr().Get() == pytest.approx(np.degrees(0.6))
    assert cone.GetShapingConeSoftnessAttr().Get() == pytest.approx(1.0 - 0.2 / 0.6)


@pytest.mark.parametrize("name", first(["biped.usda", "biped.glb"]))
def test_what_rigtri_has_built_and_motion_that_only_controls_have_is_reported(
    name: str, tmp_path: Path
) -> None:
    built, out = tmp_path / name, tmp_path / ("out.usda" if name.endswith("glb") else "out.glb")
    rig = rigtri.add_twist(rigtri.read(SAMPLES / name), limbs="auto")
    rig = rigtri.add_controls(rig, joints=("head",))
    rotation = rig.rotation.copy()
    rotation[rig.find("head_ctl")] = (0.0, 0.6, 0.0, 0.8)
    rigtri.write(replace(rig, rotation=rotation), built, verify=False)
    lost = [notice.text for notice in rigtri.convert(built, out).report.warnings if notice.code == "lost"]
    assert any("the rig that rigtri has added (" in text for text in lost)
    assert any("Controls move 'head' at rest" in text and "bake --to joints" in text for text in lost)
    assert any("stored on 'upper_arm_L_twist_1'" in text for text in lost)
    assert "only controls" in cli("convert", built, "-o", out, "--overwrite", "--strict", code=5).stderr


@pytest.mark.ci
def test_verify_compares_a_rig_with_what_convert_made_of_its_character(samples: Path, tmp_path: Path) -> None:
    """There are more controls than joints, and USD gets none of them.

    At keys of USD between those of glTF it is as near as straight lines follow a spline, and half floats the
    scales.
    """
    rigged, there = tmp_path / "rigged.glb", tmp_path / "there.usda"
    rigtri.write(rigtri.add_controls(rigtri.read(samples / "biped.glb"), whole_character=True), rigged)
    rigtri.convert(rigged, there)
    assert cli("verify", rigged, there, "--json").json["deviation"] < WITHIN + HALF_SCALES


def test_what_usd_cannot_say_is_listed_and_strict_refuses_it(everything: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.usda"
    done = cli("convert", everything, "-o", out, "--json")
    lost = [entry["text"] for entry in done.json["warnings"] if entry["code"] == "lost"]
    assert any("vertex colours" in text for text in lost)
    assert any("eye" in text and "clips but the first" in text for text in lost)
    assert done.json["verification"]["deviation"] <= TOLERANCE
    assert cli("convert", everything, "-o", tmp_path / "b.usda", "--strict", code=5)
    assert not (tmp_path / "b.usda").exists()
    assert not (tmp_path / "b_textures").exists()
    with pytest.raises(GeometryError):
        rigtri.convert(everything, tmp_path / "b.usda", strict=True)


def test_extras_filters_and_materials_without_a_place_in_usd_are_listed(tmp_path: Path) -> None:
    b = small(2)
    b.gltf |= {
        "extras": {"shot": 1},
        "images": [{"mimeType": "image/png", "bufferView": b.view(png((9, 9, 9)))}],
        "samplers": [{"magFilter": 9728}],
        "textures": [{"source": 0, "sampler": 0, "extras": 1}],
        "materials": [{"name": "spare", "normalTexture": {"index": 0, "extras": 2}}],
    }
    b.gltf["meshes"][0] |= {"extras": {"targetNames": ["is converted"]}}
    b.gltf["meshes"][0]["primitives"][0]["extras"] = [3]
    b.gltf["meshes"][0]["primitives"].append({"attributes": {"POSITION": 99}})
    report = rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usda").report
    lost = {n.text.removeprefix("not converted: ") for n in report.warnings if n.code == "lost"}
    where = f"{tmp_path / 'in.glb'}: meshes[0].primitives[1].attributes.POSITION"
    assert lost == {
        f"a mesh that cannot be read: {where}: there is no accessor 99, the file has 6",
        "extras of the file",
        "extras of asset (1)",
        "extras of textures (1)",
        "extras of materials (1)",
        "extras of meshes (1)",
        "the filter NEAREST of image_0.png: USD smooths textures between texels",
        "materials that no mesh has (spare)",
    }


def test_the_textures_of_a_clear_coat_go_along_but_for_its_normals(tmp_path: Path) -> None:
    b, texture = small(2), {"index": 0}
    coat = {"clearcoatFactor": 0.5, "clearcoatTexture": texture, "clearcoatRoughnessTexture": texture}
    coat |= {"clearcoatRoughnessFactor": 0.25, "clearcoatNormalTexture": texture}
    b.gltf |= {
        "extensionsUsed": ["KHR_materials_clearcoat"],
        "images": [{"mimeType": "image/png", "bufferView": b.view(png((9, 9, 9)))}],
        "textures": [{"source": 0}],
        "materials": [{"name": "car", "extensions": {"KHR_materials_clearcoat": coat}}],
    }
    b.gltf["meshes"][0]["primitives"][0]["material"] = 0
    report = rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usda").report
    lost = [n.text.removeprefix("not converted: ") for n in report.warnings if n.code == "lost"]
    assert [one for one in lost if "coat" in one] == [
        "the normal texture of the clear coat of material 'car'"
    ]
    rigtri.convert(tmp_path / "out.usda", tmp_path / "back.glb")
    (look,) = glb_json(tmp_path / "back.glb")["materials"]
    found = look["extensions"]["KHR_materials_clearcoat"]
    assert found == {key: value for key, value in coat.items() if key != "clearcoatNormalTexture"}


def test_an_image_of_a_kind_that_nobody_knows_keeps_its_suffix_and_is_listed(tmp_path: Path) -> None:
    b = small(2)
    (tmp_path / "skin.avif").write_bytes(b"of no known kind")
    b.gltf |= {
        "images": [{"uri": "skin.avif"}],
        "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    }
    b.gltf["meshes"][0]["primitives"][0]["material"] = 0
    report = rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usda").report
    assert [n.text for n in report.warnings if "skin.avif" in n.text]
    assert (tmp_path / "out_textures" / "skin.avif").read_bytes() == b"of no known kind"


@pytest.mark.parametrize("letter", ["n", "手"])
def test_images_with_names_longer_than_a_file_may_have_are_written(letter: str, tmp_path: Path) -> None:
    """Before, an error that OUT has a name that is too long."""
    b = small(2)
    views = [b.view(png((9, 9, shade))) for shade in (1, 2)]
    b.gltf |= {
        "images": [{"name": letter * 300, "mimeType": "image/png", "bufferView": view} for view in views],
        "textures": [{"source": 0}, {"source": 1}],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "normalTexture": {"index": 1}}
        ],
    }
    b.gltf["meshes"][0]["primitives"][0]["material"] = 0
    rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usda")
    written = sorted((tmp_path / "out_textures").iterdir())
    assert {path.read_bytes() for path in written} == {png((9, 9, 1)), png((9, 9, 2))}
    assert all(path.name.startswith(letter * 50) for path in written)
    rigtri.convert(tmp_path / "out.usda", tmp_path / "back.gltf")
    assert len(list((tmp_path / "back_textures").iterdir())) == 2


@pytest.mark.parametrize("names", [["smile", "big brow"], ["a/b", "a b"]])
def test_names_of_morph_targets_and_the_copyright_come_home(names: list[str], tmp_path: Path) -> None:
    b = small(2)
    primitive = b.gltf["meshes"][0]["primitives"][0]
    primitive["targets"] = [{"POSITION": b.points([[0, k, 1]] * 3)} for k in range(2)]
    b.gltf["meshes"][0] |= {"extras": {"targetNames": names}}
    rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "there.usda")
    report = rigtri.convert(tmp_path / "there.usda", tmp_path / "home.glb").report
    home = glb_json(tmp_path / "home.glb")
    assert home["meshes"][0]["extras"] == {"targetNames": names}
    assert home["asset"]["copyright"] == "nobody"
    assert not report.warnings


def test_splines_that_need_many_samples_are_told(tmp_path: Path) -> None:
    """Quaternions whose signs change between keys, as exporters leave them, pass near zero there."""
    b = small(2)
    turns = [[0.02 * k, 0, 0, (-1) ** k] for k in range(5)]
    rows = [row for turn in turns for row in ([0, 0, 0, 0], turn, [0, 0, 0, 0])]
    b.gltf["animations"][0]["name"] = "spin"
    b.gltf["animations"][0]["samplers"] = [
        {"input": b.accessor(range(5)), "output": b.accessor(rows), "interpolation": "CUBICSPLINE"}
    ]
    report = rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usdc", verify=False).report
    (notice,) = [one for one in report.warnings if one.code == "many-samples"]
    assert notice.code == "many-samples"
    assert "samples in USD, where glTF has 5 keys: splines of joint 1 move too fast" in notice.text


@pytest.mark.parametrize("grown", [0.01, 1.0, 100.0])
def test_splines_below_a_scaled_armature_are_followed_within_what_is_visible(
    tmp_path: Path, grown: float
) -> None:
    """Their translations are in the armature's unit, and the size of the model is in the world's."""
    b = small(2)
    for node in b.gltf["nodes"][:2]:
        node["translation"] = [0, 1 / grown, 0]
    b.gltf["nodes"].append({"name": "armature", "scale": [grown] * 3, "children": [0]})
    b.gltf["scenes"][0]["nodes"] = [3, 2]
    bind = np.tile(np.diag([1 / grown] * 3 + [1.0]), (2, 1, 1))
    bind[:, 3, 1] = -np.arange(1, 3) / grown
    b.gltf["skins"][0]["inverseBindMatrices"] = b.accessor(bind.reshape(-1, 16))
    rows = [[[8, 0, 0], [k % 2, 1 + k, 0], [8, 0, 0]] for k in range(3)]
    output = b.accessor(np.array(rows).reshape(-1, 3) / grown)
    animation = b.gltf["animations"][0]
    animation["samplers"] = [
        {"input": b.accessor(range(3)), "output": output, "interpolation": "CUBICSPLINE"}
    ]
    animation["channels"][0]["target"]["path"] = "translation"
    outcome = rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usda")
    assert outcome.verification
    assert outcome.verification.deviation < 2 * WITHIN
    stage = Usd.Stage.Open(str(tmp_path / "out.usda"))
    (prim,) = [one for one in stage.Traverse() if one.IsA(UsdSkel.Animation)]
    # In the unit of the armature as many as in any other.
    assert 300 < prim.GetAttribute("translations").GetNumTimeSamples() < 3000


def test_scales_that_half_floats_do_not_hold_are_measured(samples: Path, tmp_path: Path) -> None:
    outcome = rigtri.convert(samples / "biped.glb", tmp_path / "out.usdz")
    assert any("half floats" in notice.text for notice in outcome.report.warnings)
    motion = outcome.verification and outcome.verification.motion
    assert motion
    assert TOLERANCE < motion.deviation < 1e-3
    # Before, verify between formats compared with the rounded scales, and said 5e-7.
    later = cli("verify", samples / "biped.glb", tmp_path / "out.usdz", "--json", code=6).json["deviation"]
    assert later >= motion.deviation


def test_scales_that_half_floats_hold_at_their_own_keys_are_measured_at_those_of_all(
    tmp_path: Path,
) -> None:
    """All joints of a Skeleton share the times of their samples: 0.3 of the way from 1 to 1.25 is 1.075."""
    b = small(2)
    keys = ([0.0, 1.0], [1.0, 1.25]), ([0.0, 0.3, 1.0], [1.0, 1.5, 1.0])
    b.gltf["animations"] = [{"samplers": [], "channels": []}]
    clip = b.gltf["animations"][0]
    for number, (joint, (times, sizes)) in enumerate(zip(b.gltf["skins"][0]["joints"], keys, strict=True)):
        rows = [[size] * 3 for size in sizes]
        clip["samplers"].append({"input": b.accessor(times), "output": b.accessor(rows)})
        clip["channels"].append({"sampler": number, "target": {"node": joint, "path": "scale"}})
    outcome = rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usdc")
    assert outcome.verification is not None
    assert outcome.verification.motion is not None
    assert outcome.verification.deviation <= 1e-6 < TOLERANCE < outcome.verification.motion.deviation


def test_a_camera_goes_with_its_joint_whose_scale_is_a_half_float(samples: Path, tmp_path: Path) -> None:
    gltf, binary = glb_parts(samples / "biped.glb")
    gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]
    moved = (gltf["nodes"][channel["target"]["node"]] for channel in gltf["animations"][0]["channels"])
    joint = next(node for node in moved if "children" not in node)
    joint["scale"] = [1.1, 1.1, 1.2]
    joint.setdefault("children", []).append(len(gltf["nodes"]))
    gltf["nodes"].append({"name": "eye", "camera": 0, "translation": [0, 0.5, 0]})
    (tmp_path / "in.glb").write_bytes(glb_bytes(gltf, binary))
    outcome = rigtri.convert(tmp_path / "in.glb", tmp_path / "out.usdc")
    assert outcome.verification is not None
    assert outcome.verification.motion is not None
    assert outcome.verification.deviation <= TOLERANCE < outcome.verification.motion.deviation


def test_a_camera_gets_as_many_samples_however_small_the_model_is(samples: Path, tmp_path: Path) -> None:
    counts = []
    for number, scale in enumerate((1.0, 0.01, 0.0001)):
        gltf, binary = glb_parts(samples / "biped.glb")
        top = {"name": "armature", "scale": [scale] * 3, "children": gltf["scenes"][0]["nodes"]}
        gltf["scenes"][0]["nodes"] = [len(gltf["nodes"])]
        gltf["nodes"].append(top)
        path = tmp_path / f"{number}.glb"
        path.write_bytes(glb_bytes(gltf, binary))
        rigtri.convert(path, path.with_suffix(".usdc"))
        stage = Usd.Stage.Open(str(path.with_suffix(".usdc")))
        (camera,) = (prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera))
        counts.append(camera.GetAttribute("xformOp:orient").GetNumTimeSamples())
    assert counts == counts[:1] * 3
    assert counts[0] < 150


def test_a_steady_scale_that_half_floats_do_not_hold_is_in_what_is_below(
    samples: Path, tmp_path: Path
) -> None:
    """An armature of 0.01 with keys, a mesh on a joint, a skin: exact, and told as nothing."""
    _write_small_armature(samples, tmp_path / "in.glb", {})
    outcome = rigtri.convert(tmp_path / "in.glb", tmp_path / "out.usda")
    assert not any("half floats" in notice.text for notice in outcome.report.warnings)
    assert outcome.verification is not None
    assert outcome.verification.deviation <= 1e-6
    assert outcome.verification.motion is None
    assert rigtri.verify(tmp_path / "in.glb", tmp_path / "out.usda").deviation <= 1e-6


def test_a_mesh_that_cannot_be_read_below_such_a_scale_is_lost_and_no_deviation(
    samples: Path, tmp_path: Path
) -> None:
    draco = {"extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {}}}}
    _write_small_armature(samples, tmp_path / "in.glb", draco)
    outcome = rigtri.convert(tmp_path / "in.glb", tmp_path / "out.usda")
    assert any("a mesh that cannot be read" in notice.text for notice in outcome.report.warnings)
    assert outcome.verification is not None
    assert outcome.verification.deviation <= 1e-6


def _write_small_armature(samples: Path, path: Path, more: dict[str, Any]) -> None:
    gltf, binary = glb_parts(samples / "biped.glb")
    del gltf["animations"][1:]
    moved = {channel["target"]["node"] for channel in gltf["animations"][0]["channels"]}
    for node in moved:
        gltf["nodes"][node]["scale"] = [0.9] * 3
    top = gltf["nodes"][min(moved)]
    top["scale"] = [0.01] * 3
    for node in (n for n in top.get("children", []) if "translation" in gltf["nodes"][n]):
        gltf["nodes"][node]["translation"] = [100 * x for x in gltf["nodes"][node]["translation"]]
    gltf["meshes"].append({"primitives": [{"attributes": {"POSITION": _positions(gltf)}, **more}]})
    gltf["nodes"][max(moved)].setdefault("children", []).append(len(gltf["nodes"]))
    gltf["nodes"].append({"name": "prop", "mesh": len(gltf["meshes"]) - 1, "translation": [0, 0.5, 0]})
    path.write_bytes(glb_bytes(gltf, binary))


def _positions(gltf: dict[str, Any]) -> int:
    accessor = gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
    assert isinstance(accessor, int)
    return accessor


def test_a_step_beside_scales_that_half_floats_do_not_hold_is_where_it_was(tmp_path: Path) -> None:
    """The step is at 0.1 s as a float32, the samples are at 3 of 30 a second."""
    b = small(2)
    times = b.accessor([0.0, 0.1, 0.2])
    b.gltf["animations"][0] |= {
        "samplers": [
            {"input": times, "output": b.accessor([[1.0] * 3, [1.3] * 3, [1.1] * 3])},
            {
                "input": times,
                "output": b.accessor([[0, 0, 0, 1], [1, 0, 0, 0], [0, 1, 0, 0]]),
                "interpolation": "STEP",
            },
        ],
        "channels": [
            {"sampler": k, "target": {"node": node, "path": path}}
            for k, (node, path) in enumerate(((0, "scale"), (1, "rotation")))
        ],
    }
    outcome = rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usdc")
    assert outcome.verification is not None
    assert outcome.verification.deviation <= TOLERANCE
    assert any("between keys" in notice.text for notice in outcome.report.warnings)


def test_a_target_of_the_same_format_or_a_clip_that_is_not_there_is_refused(
    samples: Path, tmp_path: Path
) -> None:
    with pytest.raises(UsageError, match="convert writes"):
        rigtri.convert(samples / "hand.glb", tmp_path / "out.gltf")
    with pytest.raises(NameNotFoundError):
        rigtri.convert(samples / "hand.glb", tmp_path / "out.usda", clip=["none"])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("far", [0.0, 300.0], ids=["here", "far"])
def test_a_camera_below_joints_with_keys_at_different_times_goes_where_they_are_played(
    far: float, tmp_path: Path
) -> None:
    """Scales of all joints are rounded at the keys of any, and a camera far out has to be as exact."""
    b = small(3)
    keys = [([0.0, 1.0], [[1.0] * 3, [1.7] * 3], 1), ([0.3, 0.55, 0.9], [[1.1] * 3, [1.3] * 3, [0.9] * 3], 2)]
    parts = [
        ({"input": b.accessor(times), "output": b.accessor(values)}, node, "scale")
        for times, values, node in keys
    ]
    there = b.accessor([[far, 0, 0], [far, 0.1, 0]])
    turns = b.accessor([[0, 0, 0, 1], [0, 0, 0.6, 0.8]])
    parts += [
        ({"input": b.accessor([0.0, 0.7]), "output": there}, 0, "translation"),
        ({"input": b.accessor([0.2, 0.8]), "output": turns}, 1, "rotation"),
    ]
    b.gltf["animations"][0] |= {
        "samplers": [sampler for sampler, _, _ in parts],
        "channels": [
            {"sampler": k, "target": {"node": n, "path": path}} for k, (_, n, path) in enumerate(parts)
        ],
    }
    b.gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]
    b.gltf["nodes"][1]["children"].append(len(b.gltf["nodes"]))
    b.gltf["nodes"].append({"name": "eye", "camera": 0, "translation": [0, 0.5, 0]})
    outcome = rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usdc")
    assert outcome.verification is not None
    assert outcome.verification.deviation <= TOLERANCE


@pytest.mark.parametrize("moves", [False, True])
def test_cameras_and_lights_below_a_scale_that_shears_them_stand_and_look_as_before(
    moves: bool, tmp_path: Path
) -> None:
    """Before, they were written with axes that look elsewhere, and the conversion was refused."""
    b = small(3)
    turn, scale = (
        b.accessor([[0.0, 0.0, 0.0, 1.0], [0.6, 0.0, 0.0, 0.8]]),
        b.accessor([[1, 1, 1], [1, 2, 0.5]]),
    )
    times = b.accessor([0.0, 1.0])
    parts = [(turn, 1, "rotation"), (scale, 0, "scale")] if moves else [(turn, 2, "rotation")]
    b.gltf["animations"][0] |= {
        "samplers": [{"input": times, "output": output} for output, _, _ in parts],
        "channels": [
            {"sampler": k, "target": {"node": n, "path": path}} for k, (_, n, path) in enumerate(parts)
        ],
    }
    nodes = b.gltf["nodes"]
    nodes[0]["scale"], nodes[1]["rotation"] = [1, 2, 0.5], [0.6, 0, 0, 0.8]
    b.gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]
    light = {"type": "spot", "spot": {"outerConeAngle": 0.6}}
    b.gltf["extensions"] = {"KHR_lights_punctual": {"lights": [light]}}
    b.gltf["extensionsUsed"] = ["KHR_lights_punctual"]
    lamp = {"extensions": {"KHR_lights_punctual": {"light": 0}}, "rotation": [0.0, 0.6, 0.0, 0.8]}
    nodes[1]["children"] += [len(nodes), len(nodes) + 1]
    nodes += [{"name": "eye", "camera": 0, "translation": [0, 0.5, 0]}, {"name": "lamp", **lamp}]
    source, out = b.glb(tmp_path / "in.glb"), tmp_path / "out.usda"
    outcome = rigtri.convert(source, out)
    assert outcome.verification is not None
    assert outcome.verification.deviation <= TOLERANCE
    lost = [notice.text for notice in outcome.report.warnings if notice.code == "lost"]
    assert [text for text in lost if "shear" in text] == [
        "not converted: the shear of eye's camera, which stands and looks as before"
    ]
    rig, stage = rigtri.read(source), Usd.Stage.Open(str(out))
    motion = Motion(rig, rig.clips[0])
    (camera,) = (each for each in stage.Traverse() if each.IsA(UsdGeom.Camera))
    # Those that the sheared frames themselves need came first before: 1,492 in all.
    assert camera.GetAttribute("xformOp:orient").GetNumTimeSamples() <= 1300
    for seconds in (0.0, 0.3, 1.0):
        placed = worlds(rig, motion.locals_at(np.array([seconds])))[0]
        for name, kind in (("eye", "Camera"), ("lamp", "SphereLight")):
            prim = next(each for each in stage.Traverse() if each.GetTypeName() == kind)
            time = seconds * stage.GetTimeCodesPerSecond()
            there = np.array(UsdGeom.XformCache(time).GetLocalToWorldTransform(prim))
            looks = placed[rig.find(name), 2, :3]
            assert_allclose(there[3, :3], placed[rig.find(name), 3, :3], atol=2e-5)
            assert_allclose(there[2, :3], looks / np.linalg.norm(looks), atol=2e-5)
            assert_allclose(there[:3, :3] @ there[:3, :3].T, np.eye(3), atol=1e-6)  # without shear
    assert rigtri.verify(source, out).passes(TOLERANCE)


def test_a_stage_is_told_once_of_nodes_however_many_they_are(tmp_path: Path) -> None:
    """Before, a stage looked at all siblings of each: 16,000 took half a minute, and 4,000 half a second."""
    told: list[int] = []
    for count in (2, 40):
        b = small()
        first = len(b.gltf["nodes"])
        b.gltf["nodes"] += [{"name": f"n{k}", "translation": [k, 0, 0]} for k in range(count)]
        b.gltf["scenes"][0]["nodes"] += range(first, first + count)
        b.glb(tmp_path / "in.glb")
        seen: list[Any] = []
        listener = Tf.Notice.RegisterGlobally(
            Usd.Notice.ObjectsChanged, lambda notice, _, to=seen: to.append(1)
        )
        rigtri.convert(tmp_path / "in.glb", tmp_path / "out.usda", overwrite=True)
        listener.Revoke()
        told.append(len(seen))
    assert told[0] == told[1]


@pytest.mark.ci
def test_a_second_run_writes_the_same_bytes(everything: Path, tmp_path: Path) -> None:
    for name in ("a.usdz", "b.usdz"):
        (tmp_path / name[0]).mkdir()
        rigtri.convert(everything, tmp_path / name[0] / "out.usdz")
    assert (tmp_path / "a" / "out.usdz").read_bytes() == (tmp_path / "b" / "out.usdz").read_bytes()


def test_skins_whose_joints_stand_far_apart_share_what_is_between_them(tmp_path: Path) -> None:
    """Three roots at two depths, held together by two skins: the nodes between become joints."""
    b = small(1)
    b.gltf["nodes"] += [
        {"name": "top", "children": [len(b.gltf["nodes"]) + 1, len(b.gltf["nodes"]) + 3]},
        {"name": "left", "translation": [1, 0, 0], "children": [len(b.gltf["nodes"]) + 2]},
        {"name": "deep", "translation": [0, 2, 0]},
        {"name": "right", "translation": [0, 0, 3]},
    ]
    first = len(b.gltf["nodes"]) - 4
    b.gltf["scenes"][0]["nodes"].append(first)
    binds = b.accessor(np.tile(np.eye(4).ravel(), (2, 1)))
    b.gltf["skins"] += [{"joints": [first + 2, first + 3], "inverseBindMatrices": binds}]
    outcome = rigtri.convert(b.glb(tmp_path / "far.glb"), tmp_path / "far.usda")
    assert outcome.verification is not None
    assert outcome.verification.deviation <= TOLERANCE
    stage = Usd.Stage.Open(str(tmp_path / "far.usda"))
    joints = [UsdSkel.Skeleton(p).GetJointsAttr().Get() for p in stage.Traverse() if p.IsA(UsdSkel.Skeleton)]
    assert ["left", "left/deep", "right"] in [list(tokens) for tokens in joints]


@pytest.mark.parametrize(("armature", "points"), [(1.0, 1.0), (0.01, 1.0), (1.0, 5987.0), (0.3, 0.3)])
def test_bind_poses_have_no_scale_that_all_joints_have(
    armature: float, points: float, tmp_path: Path
) -> None:
    """Of a scaled armature, or of positions in another unit: bones that Blender makes of them have none."""
    b = small(3)
    b.gltf["nodes"] += [
        {"name": "Armature", "scale": [armature] * 3, "children": [0]},
        {"name": "hat", "translation": [0, 1, 0], "mesh": 0},
    ]
    b.gltf["nodes"][2]["children"] = [5]
    b.gltf["scenes"][0]["nodes"] = [4, 3]
    b.glb(tmp_path / "plain.glb")
    rig = rigtri.read(tmp_path / "plain.glb")
    binds = np.diag([points] * 3 + [1.0]) @ np.linalg.inv(rig.world[rig.skins[0].joints])
    b.gltf["skins"][0]["inverseBindMatrices"] = b.accessor(binds.reshape(-1, 16))
    outcome = rigtri.convert(b.glb(tmp_path / "in.glb"), tmp_path / "out.usda")
    assert outcome.verification is not None
    assert outcome.verification.deviation <= 1e-6
    stage = Usd.Stage.Open(str(tmp_path / "out.usda"))
    (skeleton,) = [UsdSkel.Skeleton(p) for p in stage.Traverse() if p.IsA(UsdSkel.Skeleton)]
    axes = np.array(skeleton.GetBindTransformsAttr().Get())[:, :3, :3]
    np.testing.assert_allclose(np.linalg.norm(axes, axis=-1), 1.0, atol=1e-6)


def test_a_broken_reference_is_an_error_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "broken.gltf"
    path.write_text(json.dumps({"asset": {"version": "2.0"}, "nodes": [{"camera": 3}]}))
    with pytest.raises(FileError, match="cameras"):
        rigtri.convert(path, tmp_path / "out.usda")
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("materials", [[], {}, True])
def test_a_material_that_is_not_there_is_an_error_of_the_file(materials: object, tmp_path: Path) -> None:
    builder = small()
    builder.gltf["materials"] = materials
    builder.gltf["meshes"][0]["primitives"][0]["material"] = 0
    source = builder.glb(tmp_path / "in.glb")
    with pytest.raises(FileError, match=r"there is no materials\[0\]"):
        rigtri.convert(source, tmp_path / "out.usda")
    assert list(tmp_path.iterdir()) == [source]


def test_a_clip_is_chosen_by_its_number_and_by_a_name_that_could_be_a_glob(
    samples: Path, tmp_path: Path
) -> None:
    source, out, written = tmp_path / "in.gltf", tmp_path / "out.usda", []
    source.write_text((samples / "biped.gltf").read_text().replace('"walk"', '"walk[1]"'))
    shutil.copy(samples / "biped.bin", tmp_path)
    for clip in ("walk[1]", "#0"):
        rigtri.convert(source, out, clip=[clip], overwrite=True)
        written.append(out.read_text())
    assert written[0] == written[1]
    assert "wave" not in written[0]


@pytest.mark.parametrize(("degrees", "start"), [(0.4, 0.0), (0.5, 30.0), (0.02, 170.0), (0.6, 0.0)])
def test_turns_that_openusd_plays_unevenly_are_listed(degrees: float, start: float, tmp_path: Path) -> None:
    """The middle of a prop, which turns about z, is compared with what OpenUSD makes of the keys."""
    angles = np.radians(start + degrees * np.arange(3)) / 2
    turns = np.stack([0 * angles, 0 * angles, np.sin(angles), np.cos(angles)], axis=1)
    source, out = small(), tmp_path / "out.usda"
    source.gltf["nodes"] += [{"name": "prop"}]
    source.gltf["scenes"][0]["nodes"] += [4]
    sampler = {"input": source.accessor([0.0, 1.0, 2.0]), "output": source.accessor(turns)}
    channel = {"sampler": 0, "target": {"node": 4, "path": "rotation"}}
    source.gltf["animations"] = [{"samplers": [sampler], "channels": [channel]}]
    ran = cli("convert", source.glb(tmp_path / "in.glb"), "-o", out, code=0)
    stage = Usd.Stage.Open(str(out))
    prop = UsdGeom.Xformable(next(prim for prim in stage.Traverse() if prim.GetName() == "prop"))
    rate, off = stage.GetTimeCodesPerSecond(), 0.0
    for share in (0.25, 0.5, 0.75, 1.25, 1.5, 1.75):
        x, y = np.array(prop.GetLocalTransformation(share * rate))[0, :2]
        off = max(off, abs(np.arctan2(y, x) - np.radians(start + share * degrees)))
    told = " ".join(ran.stderr.split())
    assert ("slow rotations of prop" in told) == (off > 1e-5)
    if off > 1e-5:
        assert float(told.partition("up to ")[2].partition(" rad")[0]) == pytest.approx(off, rel=0.05)


@pytest.mark.ci
def test_what_hangs_on_a_hidden_joint_is_hidden_and_its_camera_can_be_looked_through(tmp_path: Path) -> None:
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    names = [node["name"] for node in gltf["nodes"]]
    lamp, light = {"light": 0}, {"type": "point", "name": "lamp"}
    gltf["extensionsUsed"] = ["KHR_node_visibility", "KHR_lights_punctual"]
    gltf["extensions"] = {"KHR_lights_punctual": {"lights": [light]}}
    for name in ("hand_R", "head"):
        gltf["nodes"][names.index(name)]["extensions"] = {"KHR_node_visibility": {"visible": False}}
    gltf["nodes"][names.index("fingers_R")]["extensions"] = {"KHR_lights_punctual": lamp}
    (tmp_path / "in.glb").write_bytes(glb_bytes(gltf, binary))
    rigtri.convert(tmp_path / "in.glb", tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(tmp_path / "out.usda"))
    prims = [UsdGeom.Imageable(prim) for prim in stage.Traverse() if prim.GetTypeName() not in ("Shader", "")]
    seen = {prim.GetPrim().GetName(): prim.ComputeVisibility() != "invisible" for prim in prims}
    assert [name for name, shown in seen.items() if not shown] == ["staff_1", "lamp"]
    rigtri.convert(tmp_path / "out.usda", tmp_path / "back.glb")
    nodes = glb_json(tmp_path / "back.glb")["nodes"]
    hidden = [n["name"] for n in nodes if "KHR_node_visibility" in n.get("extensions", {})]
    assert sorted(hidden) == ["lamp", "staff"]


@pytest.mark.parametrize("dry_run", [True, False])
def test_a_dry_run_converts_and_writes_nothing(dry_run: bool, tmp_path: Path) -> None:
    target = tmp_path / "out.usda"
    outcome = rigtri.convert(small().glb(tmp_path / "in.glb"), target, dry_run=dry_run)
    assert outcome.written is target.exists() is not dry_run
    assert outcome.changed
    assert outcome.verification is not None


@pytest.mark.parametrize("clips", [True, False])
def test_morph_targets_of_a_mesh_without_a_skin_are_blend_shapes(clips: bool, tmp_path: Path) -> None:
    """A skeleton of its own drives them, in clips or as they rest; `convert` compares every pose."""
    builder = arm(clips=clips)
    del builder.gltf["nodes"][2]["skin"]
    (primitive,) = builder.gltf["meshes"][0]["primitives"]
    for name in ("JOINTS_0", "WEIGHTS_0"):
        del primitive["attributes"][name]
    outcome = rigtri.convert(builder.glb(tmp_path / "in.glb"), tmp_path / "out.usda")
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6
    stage = Usd.Stage.Open(str(tmp_path / "out.usda"))
    (mesh,) = (prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    binding = UsdSkel.BindingAPI(mesh)
    assert list(binding.GetBlendShapesAttr().Get()) == ["bulge", "other"]
    skeleton = binding.GetInheritedSkeleton()
    assert list(skeleton.GetJointsAttr().Get()) == ["Skin"]
    animation = UsdSkel.Animation(UsdSkel.BindingAPI(skeleton.GetPrim()).GetInheritedAnimationSource())
    weights = animation.GetBlendShapeWeightsAttr()
    assert bool(weights.GetNumTimeSamples()) is clips
    assert list(weights.Get(0.0 if clips else Usd.TimeCode.Default()))[1] == 0.25
    back = tmp_path / "back.glb"
    rigtri.convert(tmp_path / "out.usda", back)
    (shown,) = rigtri.read(back).meshes
    assert shown.morphs[0].tolist() == [[0, 0, 1]] * 3


def test_characters_of_a_crowd_share_their_points_and_are_edited_each_by_itself(tmp_path: Path) -> None:
    shutil.copy(SAMPLES / "biped.usda", tmp_path / "hero.usda")
    shot, out, edited = (tmp_path / name for name in ("shot.usda", "out.usda", "edited.usda"))
    each = (f'def Xform "{name}" (references = @./hero.usda@)\n{{\n}}\n' for name in "AB")
    shot.write_text("#usda 1.0\n" + "".join(each), "utf-8")
    rigtri.convert(shot, tmp_path / "shot.glb")
    rigtri.convert(tmp_path / "shot.glb", out)
    stage = Usd.Stage.Open(str(out))
    shown = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    stacks = [prim.GetAttribute("points").GetPropertyStack() for prim in shown]
    assert len(shown) == 2 * len({stack[-1].path for stack in stacks})
    sources = [
        UsdSkel.BindingAPI(prim).GetAnimationSource()
        for prim in stage.Traverse()
        if prim.IsA(UsdSkel.Skeleton)
    ]
    assert len(sources) == 2, "each has its skeleton"
    assert sources[0] == sources[1], "and both play one animation"
    assert len([prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Animation)]) == 1
    assert all(len(stack) == 1 for stack in stacks)
    rigtri.convert(out, tmp_path / "back.glb")
    assert len(glb_json(tmp_path / "back.glb")["meshes"]) == len(glb_json(tmp_path / "shot.glb")["meshes"])
    cli("orient-joints", out, "-o", edited, "--character", "A", code=0)


def test_blend_shapes_of_another_skeleton_have_the_same_names(tmp_path: Path) -> None:
    builder = arm(clips=False)
    del builder.gltf["nodes"][2]["skin"]
    (primitive,) = builder.gltf["meshes"][0]["primitives"]
    for name in ("JOINTS_0", "WEIGHTS_0"):
        del primitive["attributes"][name]
    builder.gltf["nodes"].append({**builder.gltf["nodes"][2], "name": "Twin"})
    builder.gltf["scenes"][0]["nodes"].append(len(builder.gltf["nodes"]) - 1)
    rigtri.convert(builder.glb(tmp_path / "in.glb"), tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(tmp_path / "out.usda"))
    shown = [UsdSkel.BindingAPI(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    assert [list(one.GetBlendShapesAttr().Get()) for one in shown] == [["bulge", "other"]] * 2


def test_verify_sees_keys_that_only_the_stage_has(tmp_path: Path) -> None:
    source, out = SAMPLES / "biped.glb", tmp_path / "out.usda"
    rigtri.convert(source, out)
    assert rigtri.verify(source, out).passes(HALF_SCALES)
    stage = Usd.Stage.Open(str(out))
    (animation, *_) = (UsdSkel.Animation(p) for p in stage.Traverse() if p.IsA(UsdSkel.Animation))
    rotations = animation.GetRotationsAttr()
    start, end = rotations.GetTimeSamples()[:2]
    # Between two keys, where no time of the glTF file is looked at, one joint turns and turns back.
    turned, *before_and_after = (
        (start + share * (end - start), rotations.Get(start + share * (end - start)))
        for share in (0.4, 0.38, 0.42)
    )
    turned[1][1] *= Gf.Quatf(Gf.Rotation(Gf.Vec3d(1, 0, 0), 40).GetQuat())
    for time, values in (turned, *before_and_after):
        rotations.Set(values, time)
    stage.GetRootLayer().Save()
    for one, other in ((source, out), (out, source)):
        assert not rigtri.verify(one, other).passes(10 * HALF_SCALES)


def test_verify_knows_clips_without_names(tmp_path: Path) -> None:
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    for clip in gltf["animations"]:
        clip["name"] = ""
    (tmp_path / "in.glb").write_bytes(glb_bytes(gltf, binary))
    rigtri.convert(tmp_path / "in.glb", tmp_path / "out.usda")
    found = rigtri.verify(tmp_path / "in.glb", tmp_path / "out.usda")
    assert found.passes(HALF_SCALES)
    assert found.poses > 1
    assert not found.lost
