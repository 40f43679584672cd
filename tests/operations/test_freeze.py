"""freeze: scale and rotation above joints go into the joints, and nothing that can be seen moves."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scaled_limbs
from gltf_files import glb_bytes, glb_json, glb_parts
from places import SAMPLES, real_files
from program import cli
from pxr import Sdf, Usd
from scaled_limbs import Limb
from usd_files import MESH, SKELETON, animation, deviation, save, scene, skeleton

import rigtri
from rigtri.errors import UsageError
from rigtri.evaluation.sampling import key_times, locals_at, worlds
from rigtri.formats import ReadOptions, read
from rigtri.frames.rescale import rescale
from rigtri.maths.matrices import determinant, multiply
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import Clip, Track
from rigtri.model.bindings import Bound
from rigtri.model.constraints import constraints_of
from rigtri.model.rig import Rig
from rigtri.operations.constrain.maintain_offset import offsets_apart, resting_offsets
from rigtri.operations.options.freeze import FreezeOptions
from rigtri.report import Report
from rigtri.verification.compare.attachments import compare_attached
from rigtri.verification.compare.compare import verify
from rigtri.verification.compare.correspondence import match

SCALED = {"root": (100.0, 100.0, 100.0), "elbow": (0.5, 0.5, 0.5)}
OPS = """{
double3 xformOp:rotateXYZ = (-90, 0, 0)
double3 xformOp:scale = (0.01, 0.01, 0.01)
uniform token[] xformOpOrder = ["xformOp:rotateXYZ", "xformOp:scale"]
def Skeleton"""


def source(folder: Path, suffix: str, **scales: Any) -> Path:
    """A limb with scales; in USD below a prim that is turned and scaled, too."""
    limb = Limb(rest=SCALED | scales)
    if suffix == ".glb":
        return scaled_limbs.gltf(folder / "in.glb", limb, extras=True)
    path = folder / f"in{suffix}"
    text = scaled_limbs.usda(limb).replace("{\ndef Skeleton", OPS, 1)
    path.write_text(text)
    return path


def sizes(rig: Rig) -> Floats:
    """The lengths of the axes of joints in the world, (m, 3)."""
    return length(rig.world[rig.is_joint, :3, :3])


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_joints_have_scale_1_and_look_as_before(suffix: str, tmp_path: Path) -> None:
    path, out = source(tmp_path, suffix), tmp_path / f"out{suffix}"
    cli("freeze", path, "-o", out, code=0)
    assert abs(sizes(read(out).rig) - 1.0).max() < 1e-6
    assert verify(read(path), read(out)).deviation < 1e-6


def test_a_skinned_mesh_gets_no_transform_that_viewers_ignore() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    above, body = rig.find("biped"), rig.find("body")
    parents, rotation, scale = rig.parents.copy(), rig.rotation.copy(), rig.scale.copy()
    parents[body], rotation[above], scale[above] = above, (-0.6, 0, 0, 0.8), 0.01
    out = rigtri.freeze(replace(rig, parents=parents, rotation=rotation, scale=scale))
    assert np.array_equal(out.local[body], np.eye(4))
    assert abs(sizes(out) - 1.0).max() < 1e-6


def test_numbers_by_hand(tmp_path: Path) -> None:
    """Below a root of scale 100 a translation is 100 times as large, and the root's own scale is 1."""
    path, out = source(tmp_path, ".glb"), tmp_path / "out.glb"
    cli("freeze", path, "-o", out, code=0)
    before, after = (glb_json(each)["nodes"] for each in (path, out))
    assert after[0]["scale"] == [1.0, 1.0, 1.0]
    assert np.allclose(after[1]["translation"], 100 * np.array(before[1]["translation"]))
    ring = next(node for node in after if node["name"] == "ring")  # it is drawn, so it keeps its size
    assert np.allclose(ring["scale"], 50.0)


def test_mirrored_axes_become_right_handed(tmp_path: Path) -> None:
    path, out, again = SAMPLES / "mirrored_pair.glb", tmp_path / "out.glb", tmp_path / "again.glb"
    cli("freeze", path, "-o", out, code=0)
    assert (determinant(read(path).rig.world) < 0).any()
    assert (read(out).rig.scale > 0).all()
    assert (determinant(read(out).rig.world) > 0).all()
    assert verify(read(path), read(out)).deviation < 1e-6
    cli("freeze", out, "-o", again, code=0)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize("signs", [(-1.0, 1.0, 1.0), (-1.0, -1.0, -1.0), (2.0, 2.0, -2.0)])
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_mirrored_joints_play_their_clips(signs: tuple[float, ...], suffix: str, tmp_path: Path) -> None:
    path, out = source(tmp_path, suffix, elbow=signs), tmp_path / f"out{suffix}"
    cli("freeze", path, "-o", out, code=0)
    assert (determinant(read(out).rig.world[read(out).rig.is_joint]) > 0).all()
    assert abs(sizes(read(out).rig) - 1.0).max() < 1e-6
    assert verify(read(path), read(out)).deviation < 1e-6


def test_mirrored_axes_that_controls_count_from_stay_and_are_named(tmp_path: Path) -> None:
    built, out = tmp_path / "built.glb", tmp_path / "out.glb"
    chain = ("--chain", "upper_arm_R", "hand_R")
    cli("add-controls", SAMPLES / "mirrored_pair.glb", "-o", built, *chain, code=0)
    assert "stay mirrored" in cli("freeze", built, "-o", out, code=0).stderr
    assert verify(read(built), read(out)).deviation < 1e-6


@pytest.mark.parametrize("kind", ["parent", "point", "orient", "scale", "aim", "polevector"])
@pytest.mark.parametrize("only", [None, "above"])
def test_constraints_to_controls_hold_once_the_scale_above_joints_is_gone(kind: str, only: Any) -> None:
    """Joints lose the scale of 0.01, their controls have none: offsets are between two sizes."""
    rig = replace(rigtri.read(SAMPLES / "biped.glb"), clips=()).insert_above({0: "Armature"})
    rig = rigtri.add_controls(rescale(rig, np.full(len(rig), 0.01)), whole_character=True)
    what: Any = {"limb": ("thigh_L", "shin_L", "foot_L")} if kind == "polevector" else {"child": "hand_L"}
    built = rigtri.constrain(rig, type=kind, driver=("head_ctl",), **what)
    frozen = rigtri.freeze(built, only=only)
    assert np.allclose(sizes(built), 0.01)
    assert np.allclose(sizes(frozen), 1.0)
    (rule,) = constraints_of(frozen).values()
    rests = resting_offsets(frozen, rule)
    assert rests is not None
    assert offsets_apart(frozen, rests, rule.offsets).max() < 1e-6


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_what_is_not_uniform_stays_and_is_named(suffix: str, tmp_path: Path) -> None:
    path, out = source(tmp_path, suffix, elbow=(1.0, 2.0, 1.0)), tmp_path / f"out{suffix}"
    ran = cli("freeze", path, "-o", out, code=0)
    assert "elbow is not uniform" in ran.stderr
    assert np.allclose(read(out).rig.scale[read(out).rig.find("elbow")], (1, 2, 1))


@pytest.mark.ci
def test_rotation_above_joints_is_none_in_the_end(tmp_path: Path) -> None:
    path, out = source(tmp_path, ".usda"), tmp_path / "out.usda"
    cli("freeze", path, "-o", out, "--up-axis", "y", code=0)
    rig = read(out).rig
    above = [node for node in range(len(rig)) if not rig.is_joint[node] and rig.attachment[node] < 0]
    axes = rig.world[above, :3, :3] / length(rig.world[above, :3, :3])[..., np.newaxis]
    assert abs(axes - np.eye(3)).max() < 1e-6


def test_a_rotation_below_a_scale_that_is_not_uniform_is_frozen_once() -> None:
    """All is sheared there, so the axes of the world are those without rotations, not those that are seen."""
    rig = rigtri.read(SAMPLES / "biped.glb").insert_above({0: "holder"})
    scale, rotation = rig.scale.copy(), rig.rotation.copy()
    scale[0], rotation[0] = (1.0, 2.0, 0.5), from_axis_angle(np.array([1.0, 0.0, 0.0]), np.pi / 2)
    rotation[1] = from_axis_angle(np.array([0.0, 0.0, 1.0]), 0.5)
    once = rigtri.freeze(replace(rig, scale=scale, rotation=rotation, clips=()))
    assert abs(once.rotation[:2] - (0.0, 0.0, 0.0, 1.0)).max() < 1e-12
    again = Report()
    rigtri.freeze(once, report=again)
    assert not again.joints
    assert "holder is not uniform" in again.warnings[0].text


def test_a_scale_above_joints_that_has_keys_is_named() -> None:
    rig, report = rigtri.read(SAMPLES / "biped.glb"), Report()
    grows = Track(0, "scale", "LINEAR", np.array([0.0, 1.0]), np.array([[1.0, 1, 1], [2.0, 2, 2]]))
    rigtri.freeze(replace(rig, clips=(Clip("grow", (grows,)),)), report=report)
    assert "biped has keys in clips" in report.warnings[0].text


def test_what_keeps_its_scale_for_an_extension_is_named_and_counts_for_what_is_below_it() -> None:
    rig, report, again = rigtri.read(SAMPLES / "biped.glb"), Report(), Report()
    top, arm, scale = rig.find("biped"), rig.find("upper_arm_L"), rig.scale.copy()
    scale[top] = 0.01
    scaled = replace(rig, scale=scale, source=None, rules=replace(rig.rules, fixed={arm: "it collides"}))
    once = rigtri.freeze(scaled, report=report)
    assert [warning.text for warning in report.warnings] == ["Not frozen: upper_arm_L: it collides"]
    others = [node for node in np.flatnonzero(rig.is_joint).tolist() if node != arm]
    assert abs(length(once.world[others, :3, :3]) - 1.0).max() < 1e-6
    rigtri.freeze(once, report=again)
    assert not again.joints


def test_a_socket_below_a_prop_keeps_scale_1_in_a_second_run() -> None:
    rig = rigtri.add_socket(rigtri.read(SAMPLES / "biped.glb"), name="tip", on="hand_L")
    rig = rig.insert_above({rig.find("tip"): "prop"})
    attachment, scale, again = rig.attachment.copy(), rig.scale.copy(), Report()
    prop = rig.find("prop")
    attachment[prop], scale[prop], scale[rig.find("biped")] = 0, 3.0, 0.01
    once = rigtri.freeze(replace(rig, attachment=attachment, scale=scale, source=None))
    rigtri.freeze(once, report=again)
    assert not again.joints


@pytest.mark.parametrize(("more", "left"), [("", {}), ("int version = 5", {"Blender": {"version": 5}})])
def test_a_root_that_holds_no_turn_is_not_noted_as_blenders_own(
    more: str, left: dict[str, Any], tmp_path: Path
) -> None:
    """Blender leaves out a root with this note, and does not turn what is below it from y up to z up."""
    path, out, other = source(tmp_path, ".usda"), tmp_path / "out.usda", tmp_path / "other.usda"
    note = f"customData = {{ dictionary Blender = {{ bool generated = 1\n{more}\n}} }}"
    api = 'prepend apiSchemas = ["SkelBindingAPI"]'
    text = path.read_text("utf-8").replace(f"({api})", f"(\n{api}\n{note}\n)", 1)
    path.write_text(text, "utf-8")
    assert Usd.Stage.Open(str(path)).GetPrimAtPath("/Root").HasCustomDataKey("Blender:generated")
    cli("freeze", path, "-o", out, code=0)
    assert dict(Sdf.Layer.FindOrOpen(str(out)).GetPrimAtPath("/Root").customData) == left
    cli("freeze", path, "-o", other, "--only", "joints", code=0)
    assert Usd.Stage.Open(str(other)).GetPrimAtPath("/Root").HasCustomDataKey("Blender:generated")
    for options in (["--scale"], ["--unit", "0.1"]):  # nor does it convert units below
        cli("freeze", path, "-o", other, "--overwrite", *options, code=0)
        assert dict(Sdf.Layer.FindOrOpen(str(other)).GetPrimAtPath("/Root").customData) == left


@pytest.mark.ci
@pytest.mark.parametrize("scale", ["(-1, 1, 1)", "(1, 1, -1)", "(-2, -2, -2)"])
def test_a_mirrored_prim_above_a_skeleton_is_frozen(scale: str, tmp_path: Path) -> None:
    path, out = tmp_path / "in.usda", tmp_path / "out.usda"
    order = 'uniform token[] xformOpOrder = ["xformOp:scale"]'
    mirrored = f'def SkelRoot "figure"\n    {{\n        float3 xformOp:scale = {scale}\n        {order}\n'
    path.write_text((SAMPLES / "biped.usda").read_text().replace('def SkelRoot "figure"\n    {\n', mirrored))
    cli("freeze", path, "-o", out, code=0)
    assert deviation(path, out) < 1e-6
    rig = read(out).rig
    assert np.allclose(rig.world[rig.find("figure"), :3, :3], np.eye(3), atol=1e-6)
    assert np.linalg.det(rig.world[rig.find("hips"), :3, :3]) == pytest.approx(1.0)
    # Points are bound where joints stand, as before. Before, they were bound upside down below them.
    (skin,), before = rig.skins, read(path).rig
    assert np.allclose(
        skin.bind[:, 3, :3], multiply(before.skins[0].bind, before.world[before.find("figure")])[:, 3, :3]
    )
    assert np.allclose(np.linalg.det(skin.bind[:, :3, :3]), 1.0)


def test_a_stage_is_converted_to_another_unit_and_up_axis(tmp_path: Path) -> None:
    from pxr import Usd, UsdGeom

    path, out = source(tmp_path, ".usda"), tmp_path / "out.usda"
    cli("freeze", path, "-o", out, "--up-axis", "z", "--unit", "0.01", code=0)
    stage = Usd.Stage.Open(str(out))
    assert (UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)) == ("Z", 0.01)
    before, after = rigtri.read(path), rigtri.read(out)
    x, y, z = before.world[before.find("wrist"), 3, :3]
    assert np.allclose(after.world[after.find("wrist"), 3, :3], (100 * x, -100 * z, 100 * y))
    assert abs(sizes(after) - 1.0).max() < 1e-6


@pytest.mark.ci
@pytest.mark.parametrize(
    "built",
    [
        "constrain --type point --child hand_R --driver head",
        "constrain --type aim --child head --driver hand_L --world-up vector --up-vector 0,1,0.3",
        "add-posereader --driver upper_arm_L --target up=0,1,0 --frame world --joint up hand_R tx=0.1",
    ],
)
def test_what_was_built_along_the_world_follows_it_to_another_unit_and_up_axis(
    built: str, tmp_path: Path
) -> None:
    rig, out, baked = (tmp_path / f"{name}.usda" for name in ("built", "frozen", "baked"))
    command, *words = built.split()
    cli(command, SAMPLES / "biped.usda", "-o", rig, *words, code=0)
    cli("freeze", rig, "-o", out, "--up-axis", "z", "--unit", "0.01", code=0)
    places = []
    for path in (rig, out):
        cli("bake", path, "-o", baked, "--overwrite", code=0)
        made = read(baked).rig
        clip = max(made.clips, key=lambda each: len(each.tracks))
        joints = [made.find(name) for name in ("head", "hand_L", "hand_R")]
        places.append(worlds(made, locals_at(made, clip, key_times(clip)))[:, joints])
    turned = np.diag([100.0, 100.0, 100.0]) @ [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
    assert np.allclose(places[0][..., 3, :3] @ turned, places[1][..., 3, :3], atol=1e-4)
    sizes = np.linalg.norm(places[0][..., :3, :3], axis=-1, keepdims=True)
    axes = (places[0][..., :3, :3] / sizes) @ turned / 100.0
    # The axes of joints stay as they are.
    assert np.allclose(axes, places[1][..., :3, :3], atol=1e-5)


def test_channels_along_the_axes_of_the_world_are_not_turned(tmp_path: Path) -> None:
    rig, built, out = (tmp_path / f"{name}.usda" for name in ("prop", "built", "out"))
    rig.write_text((SAMPLES / "biped.usda").read_text() + '\ndef Xform "prop"\n{\n}\n')
    cli("constrain", rig, "-o", built, "--child", "prop", "--driver", "head", "--skip", "ry", code=0)
    ran = cli("freeze", built, "-o", out, "--up-axis", "z", code=5)
    assert "'prop' has channels that its constraint skips" in ran.stderr
    cli("freeze", built, "-o", out, "--unit", "0.01", code=0)


@pytest.mark.parametrize("unit", ["0", "-5"])
def test_a_unit_of_no_size_is_not_converted(unit: str, tmp_path: Path) -> None:
    source = tmp_path / "in.usda"
    text = (SAMPLES / "biped.usda").read_text("utf-8")
    source.write_text(re.sub("metersPerUnit = .*", f"metersPerUnit = {unit}", text), "utf-8")
    assert "Set it above 0" in cli("freeze", source, "-o", tmp_path / "o.usda", "--unit", "1", code=5).stderr
    cli("freeze", source, "-o", tmp_path / "o.usda", "--up-axis", "z", code=0)  # no size changes


def test_gltf_has_one_unit_and_one_up_axis(tmp_path: Path) -> None:
    rig = rigtri.read(source(tmp_path, ".glb"))
    with pytest.raises(UsageError, match="by its specification"):
        rigtri.freeze(rig, unit=0.01)


def test_only_what_is_above_or_only_what_joints_have(tmp_path: Path) -> None:
    rig = rigtri.read(source(tmp_path, ".usda"))
    above, own = rigtri.freeze(rig, scale=True, only="above"), rigtri.freeze(rig, only="joints")
    wrist, root = rig.find("wrist"), rig.find("root")
    assert np.allclose(length(above.world[wrist, :3, :3]), 50.0)
    assert np.allclose(length(own.world[wrist, :3, :3]), 0.01)
    assert np.allclose(above.scale[root], 100.0)


@pytest.mark.parametrize("path", real_files())
def test_real_files_look_as_before(path: Path, tmp_path: Path) -> None:
    out, again = tmp_path / "one" / path.name, tmp_path / "two" / path.name
    for each in (out, again):
        each.parent.mkdir()
    ran = cli("freeze", path, "-o", out, "--allow-external-paths")
    if ran.exit_code == 3 and "no skeleton" in ran.stderr:
        pytest.skip("there is no skeleton")
    assert ran.exit_code == 0, ran.stderr
    cli("freeze", out, "-o", again, "--allow-external-paths", code=0)
    assert again.read_bytes() == out.read_bytes()
    found = sizes(read(out, ReadOptions(allow_external_paths=True)).rig)
    uneven = "is not uniform" in ran.stderr
    # Noise of the source stays. A SkelAnimation rounds scales to half floats: where the keys of a joint at
    # rest become exactly 1, its rest is off by that rounding, at most half a step.
    noise = 2.0**-11 if path.suffix.startswith(".usd") else 1e-4
    assert uneven or not len(found) or abs(found - 1.0).max() < noise


def scaled_middle(rest: float, keys: str, folder: Path) -> Path:
    """A limb whose middle joint rests at a scale, below a prim of the scale 0.01, with half3 keys."""
    scaled = f"(({rest}, 0, 0, 0), (0, {rest}, 0, 0), (0, 0, {rest}, 0), (0, 2, 0, 1))"
    lines = SKELETON["rest"].replace("((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 2, 0, 1))", scaled, 1)
    keyed = f"half3[] scales.timeSamples = {{{keys}}}"
    text = scene(skeleton(rest=lines), animation(scales=keyed), MESH)
    ops = """{
    float3 xformOp:scale = (0.01, 0.01, 0.01)
    uniform token[] xformOpOrder = ["xformOp:scale"]
"""
    return save(folder, text.replace('def SkelRoot "Root"\n{\n', f'def SkelRoot "Root"\n{ops}', 1))


def test_scales_with_keys_that_sixteen_bits_cannot_hold_stay_and_are_named(tmp_path: Path) -> None:
    """The middle joint rests at a scale of 1.7389 and is keyed with 1 and 1.5, which would become 0.8626."""
    keys = "1: [(1, 1, 1), (1, 1, 1), (1, 1, 1)], 5: [(1.5, 1.5, 1.5), (1, 1, 1), (1, 1, 1)]"
    source, out, again = scaled_middle(1.7389, keys, tmp_path), tmp_path / "out.usda", tmp_path / "again.usda"
    ran = cli("freeze", source, "-o", out, code=0)
    assert "The scale of b stays: it has several keys in clips" in " ".join(ran.stderr.split())
    made = read(out).rig
    assert np.allclose(made.scale[made.is_joint][:, 0], [1, 1.7389, 1])
    assert abs(made.world[made.find("a"), :3, :3] - np.eye(3)).max() < 1e-6
    assert verify(read(source), read(out)).deviation < 1e-6
    cli("freeze", out, "-o", again, code=0)
    assert again.read_bytes() == out.read_bytes()
    cli("freeze", source, "-o", out, "--overwrite", "--strict", code=5)


@pytest.mark.parametrize("rest", [0.01, 1.1])
def test_a_scale_that_all_keys_have_is_1_in_all_of_them(rest: float, tmp_path: Path) -> None:
    """As a half float 0.01 is 0.010002136, and what makes 1 of that makes 0.99979 of the rest pose."""
    both = f"[({rest}, {rest}, {rest}), (1, 1, 1), (1, 1, 1)]"
    keys = f"1: {both}, 5: {both}"
    source, out, again = scaled_middle(rest, keys, tmp_path), tmp_path / "out.usda", tmp_path / "again.usda"
    ran = cli("freeze", source, "-o", out, code=0)
    assert "stays" not in ran.stderr
    made = read(out).rig
    keyed = [t.values for t in made.clips[0].tracks if t.path == "scale" and t.node == made.find("b")]
    assert [(values == 1.0).all() for values in keyed] == [True]
    assert np.allclose(made.scale[made.find("b")], rest / float(np.float16(rest)))
    assert verify(read(source), read(out)).deviation < 1e-6
    cli("freeze", out, "-o", again, code=0)
    assert again.read_bytes() == out.read_bytes()


def test_a_clip_library_without_a_skin_is_frozen_as_its_character() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    top, scale, rotation = rig.find("biped"), rig.scale.copy(), rig.rotation.copy()
    scale[top], rotation[top] = 0.01, (-(0.5**0.5), 0, 0, 0.5**0.5)
    character = replace(rig, scale=scale, rotation=rotation, source=None)
    frozen, clips = (rigtri.freeze(each) for each in (character, replace(character, skins=())))
    assert not np.allclose(frozen.translation, rig.translation)
    joints = frozen.is_joint
    assert np.allclose(clips.local[joints], frozen.local[joints], atol=1e-12)
    assert np.allclose(clips.local[top], frozen.local[top], atol=1e-12)


def test_a_rotation_above_joints_does_not_go_with_joints_alone() -> None:
    with pytest.raises(UsageError, match=r"--up-axis .* does not go with --only joints"):
        FreezeOptions(up_axis="y", only="joints").check(())


def test_radii_of_colliders_stay_and_the_warning_has_the_factor() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    scale, head, report = rig.scale.copy(), rig.find("head"), Report()
    scale[int(rig.levels[0][0])] = 0.5
    collider = Bound(head, np.array([0.0, 0.1, 0.0]))
    out = rigtri.freeze(replace(rig, scale=scale, bound=(collider,), source=None), report=report)
    assert np.allclose(out.bound[0].vector, (0.0, 0.05, 0.0))
    (kept,) = (warning.text for warning in report.warnings if warning.code == "radius-kept")
    assert "Colliders at head keep their radii" in kept
    assert kept.endswith("multiply them by 0.5")


@pytest.mark.parametrize("size", [0.5, -1.0])
def test_a_plane_that_collides_faces_as_before_and_its_normal_has_length_1(size: float) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    scale = rig.scale.copy()
    scale[int(rig.levels[0][0])] = size
    normal = Bound(rig.find("head"), np.array([0.0, 0.6, 0.8]), is_direction=True)
    scaled = replace(rig, scale=scale, bound=(normal,), source=None)
    out = rigtri.freeze(scaled)
    assert not compare_attached(scaled, out, match(scaled, out, by_key=True))
    assert np.allclose(length(out.bound[0].vector), 1.0)


@pytest.mark.parametrize(
    "own", [{}, {"translation": [3, 4, 5], "rotation": [0, 0.6, 0, 0.8], "scale": [2, 2, 2]}]
)
def test_a_node_with_a_skinned_mesh_and_a_camera_is_frozen(own: dict[str, Any], tmp_path: Path) -> None:
    """The mesh follows its joints, and the camera its node: below one armature, which loses its scale."""
    path, out, again = (tmp_path / f"{name}.glb" for name in ("in", "out", "again"))
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    body = next(node for node in gltf["nodes"] if "skin" in node)
    gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "zfar": 100.0}}]
    for key in ("translation", "rotation", "scale", "matrix"):
        body.pop(key, None)
    body |= {"camera": len(gltf["cameras"]) - 1, **own}
    armature = {"name": "Armature", "scale": [0.01] * 3, "rotation": [-(0.5**0.5), 0, 0, 0.5**0.5]}
    gltf["nodes"].append({**armature, "children": gltf["scenes"][0]["nodes"]})
    gltf["scenes"][0]["nodes"] = [len(gltf["nodes"]) - 1]
    path.write_bytes(glb_bytes(json.dumps(gltf).encode(), binary))
    cli("freeze", path, "-o", out, code=0)
    cli("freeze", out, "-o", again, code=0)
    assert again.read_bytes() == out.read_bytes()
    before, after = rigtri.read(path), rigtri.read(out)
    node = next(n for n in range(len(before)) if before.names[n] == body["name"])
    assert np.abs(after.world[node, 3, :3] - before.world[node, 3, :3]).max() < 1e-5
    assert np.abs(np.linalg.norm(after.world[after.is_joint, :3, :3], axis=-1) - 1.0).max() < 1e-6


@pytest.mark.parametrize("more", [[], ["--unit", "0.01"]])
@pytest.mark.parametrize("blocks", [[], [re.sub(r"point3f\[\] points = .*", "", MESH)]])
def test_a_skeleton_without_points_is_frozen(blocks: list[str], more: list[str], tmp_path: Path) -> None:
    """There is no geomBindTransform to hold the size, and nothing to bind in it."""
    large = "float3 xformOp:scale = (100, 100, 100)\nuniform token[] xformOpOrder = ['xformOp:scale']"
    path = save(tmp_path, scene(large, skeleton(), animation(), *blocks))
    cli("freeze", path, "-o", tmp_path / "out.usda", *more, code=0)


@pytest.mark.parametrize("blocks", [[], [MESH]])
def test_verify_says_of_frozen_joints_what_freeze_does(blocks: list[str], tmp_path: Path) -> None:
    """Before, verify compared joints without points in two units, and was 99 of the size away."""
    small = "float3 xformOp:scale = (0.01, 0.01, 0.01)\nuniform token[] xformOpOrder = ['xformOp:scale']"
    path, out = save(tmp_path, scene(small, skeleton(), animation(), *blocks)), tmp_path / "out.usda"
    cli("freeze", path, "-o", out, code=0)
    cli("verify", path, out, code=0)
    other = out.read_text("utf-8").replace("(0.6, 0.8, 0, 0)", "(0.8, 0.6, 0, 0)")
    assert other != out.read_text("utf-8")
    out.write_text(other, "utf-8")
    cli("verify", path, out, code=6)
