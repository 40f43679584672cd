"""conform: the standard skeleton of an engine, for any character."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES, ci, every_other, first, real_files
from posed_bodies import Pose, posed_body
from program import cli
from usd_files import MESH, animation, deviation, save, scene, skeleton

import rigtri
from rigtri.errors import FileError, GeometryError
from rigtri.evaluation.sampling import locals_at
from rigtri.maths.matrices import compose, decompose, inverse, multiply
from rigtri.maths.quaternions import angle_between, from_axis_angle, normalise
from rigtri.maths.vectors import cross, dot, length
from rigtri.operations.add_socket import with_joint
from rigtri.operations.body_pose import Directions
from rigtri.operations.conform import ConformOptions, has_axes_of
from rigtri.operations.option_kinds import StandardPose
from rigtri.operations.orient_joints.standard_frames import godot_bones, standard_bones
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.verification.checks import check

TARGETS = ("unreal", "unity", "godot", "vrm", "mixamo")
# One whose sides are not quite even, and one that stands below a scale and a rotation.
REAL = ("khronos_CesiumMan_Binary.glb", "blender_godot_player.usda")
SCALED = """def SkelRoot "figure"
    {
        double3 xformOp:rotateXYZ = (-90, 0, 0)
        double3 xformOp:scale = (0.3, 0.3, 0.3)
        uniform token[] xformOpOrder = ["xformOp:rotateXYZ", "xformOp:scale"]"""


@pytest.mark.ci
@pytest.mark.parametrize(("target", "suffix"), every_other(list(TARGETS), [".glb", ".usda"]))
def test_a_second_time_changes_no_byte(target: str, suffix: str, tmp_path: Path) -> None:
    out, again = tmp_path / f"out{suffix}", tmp_path / f"again{suffix}"
    steps = cli("conform", SAMPLES / f"biped{suffix}", "-o", out, "--to", target, code=0).output
    assert steps.count("orient-joints") == 1
    cli("conform", out, "-o", again, "--to", target, code=0)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("path", real_files(*REAL))
def test_real_characters_look_as_before_and_stay(path: Path, target: str, tmp_path: Path) -> None:
    out, again = tmp_path / f"out{path.suffix}", tmp_path / f"again{path.suffix}"
    cli("conform", path, "-o", out, "--to", target, code=0)
    cli("conform", out, "-o", again, "--to", target, code=0)
    assert again.read_bytes() == out.read_bytes()
    if path.suffix == ".usda":
        assert deviation(path, out, at_rest=False) < 1e-5


def test_a_scaled_skeleton_takes_another_rest_pose_in_the_same_edit(tmp_path: Path) -> None:
    """Points are bound in another size and joints rest elsewhere: clips show the same, by UsdSkel itself."""
    path, out = tmp_path / "in.usda", tmp_path / "out.usda"
    text = (SAMPLES / "biped.usda").read_text("utf-8")
    path.write_text(text.replace('def SkelRoot "figure"\n    {', SCALED, 1), "utf-8")
    cli("conform", path, "-o", out, "--to", "vrm", code=0)
    assert deviation(path, out, at_rest=False) < 1e-5
    rig = rigtri.read(out)
    assert abs(length(rig.world[rig.is_joint, :3, :3]) - 1.0).max() < 1e-6


def test_a_character_without_an_animation_conforms_beside_a_prop_that_moves(tmp_path: Path) -> None:
    path, out = tmp_path / "in.usda", tmp_path / "out.usda"
    still = 'over "figure"\n{\nover "skeleton"\n{\nrel skel:animationSource = None\n}\n}\n'
    ops = "double xformOp:rotateX.timeSamples = {0: 0, 24: 90}\n"
    ops += 'uniform token[] xformOpOrder = ["xformOp:rotateX"]\n'
    shutil.copy(SAMPLES / "biped.usda", tmp_path / "hero.usda")
    hero = f'def "A" (references = @./hero.usda@)\n{{\n{still}}}\n'
    path.write_text(f'#usda 1.0\n{hero}def Cube "Prop"\n{{\n{ops}}}\n', "utf-8")
    cli("conform", path, "-o", out, "--to", "vrm", code=0)
    assert "hips" in rigtri.read(out).names


def test_a_scaled_skeleton_conforms_beside_another_with_an_animation_that_nobody_plays(
    tmp_path: Path,
) -> None:
    path, out = tmp_path / "in.usda", tmp_path / "out.usda"
    text = (SAMPLES / "biped.usda").read_text("utf-8")
    (tmp_path / "hero.usda").write_text(text.replace('def SkelRoot "figure"\n    {', SCALED, 1), "utf-8")
    save(tmp_path, scene(skeleton(), animation(), animation("Run"), MESH), "other.usda")
    path.write_text(
        "#usda 1.0\n"
        + "".join(
            f'def "{name}" (references = @./{file}.usda@)\n{{\n}}\n'
            for name, file in (("A", "hero"), ("B", "other"))
        ),
        "utf-8",
    )
    cli("conform", path, "-o", out, "--to", "vrm", "--character", "A", code=0)
    assert deviation(path, out, at_rest=False) < 1e-5


@pytest.mark.ci
@pytest.mark.parametrize("target", ["unreal", "unity", "godot", "vrm"])
def test_the_engine_finds_what_it_asks_for(target: str, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    cli("conform", SAMPLES / "biped.glb", "-o", out, "--to", target, code=0)
    ids = {item.id for item in check(out, profile=target)}  # type: ignore[arg-type]
    # Nor is it told to have other axes, which the engine's own skeleton has not.
    assert not {found for found in ids if found.startswith(("profile.", "axes."))}


@pytest.mark.ci
def test_two_characters_differ_in_the_lengths_of_their_bones_alone(tmp_path: Path) -> None:
    """The same body from two files, of other axes, names and rest pose."""
    other, one, two = (tmp_path / f"{name}.glb" for name in ("other", "one", "two"))
    cli("orient-joints", SAMPLES / "biped.glb", "-o", other, "--preset", "maya", code=0)
    cli("rename-joints", other, "-o", other, "--overwrite", "--to", "mixamo", code=0)
    cli("set-rest", other, "-o", other, "--overwrite", "--pose", "walk@0.5", code=0)
    for source, out in ((SAMPLES / "biped.glb", one), (other, two)):
        cli("conform", source, "-o", out, "--to", "vrm", code=0)
    mine, theirs = rigtri.read(one), rigtri.read(two)
    shared = [name for name in mine.names if name in theirs.names and name.startswith(("left", "right"))]
    assert "leftLowerArm" in shared
    for name in shared:
        a, b = (rig.rotation[rig.find(name)] for rig in (mine, theirs))
        assert angle_between(normalise(a), normalise(b)) < 1e-4, name


@pytest.mark.parametrize(
    ("target", "degrees"), [("unity", 70.0), *(ci(target, 180.0) for target in ("unity", "godot", "unreal"))]
)
def test_bodies_bound_in_other_poses_and_facing_other_ways_have_the_same_frames(
    target: str, degrees: float, tmp_path: Path
) -> None:
    """A clip of one is right for the other: below the hips, joints rest in the same way in their parents."""
    one, other, bound = (tmp_path / f"{name}.glb" for name in ("one", "other", "bound"))
    rig = rigtri.read(SAMPLES / "biped.glb")
    about_up = from_axis_angle(np.array([0.0, 1.0, 0.0]), np.radians(degrees))
    aside = compose(np.zeros(3), about_up, np.ones(3))
    (hips,) = (body.hips for body in recognise(rig).characters)
    turned = rigtri.set_rest(rig, pose="apose")
    # Bound as it stands now, and facing another way.
    world = multiply(turned.world, aside)
    top = rig.path_to_root(hips)[-1]
    rotation, translation = turned.rotation.copy(), turned.translation.copy()
    translation[top], rotation[top], _ = decompose(world[top])
    skins = tuple(replace(skin, inverse_bind=inverse(world[skin.joints])) for skin in turned.skins)
    still = replace(turned, rotation=rotation, translation=translation, skins=skins, clips=())
    rigtri.write(still, bound, verify=False)
    cli("conform", SAMPLES / "biped.glb", "-o", one, "--to", target, code=0)
    assert "and not +z: its joints" in cli("conform", bound, "-o", other, "--to", target, code=0).stderr
    assert {item.id for item in check(other, profile="unity")} & {"profile.facing"}
    mine, theirs = rigtri.read(one), rigtri.read(other)
    (body,) = recognise(mine).characters
    for bone, node in body.bones.items():
        same = theirs.find(mine.names[node])
        a, b = mine.rotation[node], theirs.rotation[same]
        assert bone == "hips" or angle_between(normalise(a), normalise(b)) < 1e-4, bone
        assert bone == "hips" or np.allclose(mine.translation[node], theirs.translation[same], atol=1e-4), (
            bone
        )


@pytest.mark.parametrize("pose", ["tpose", "apose"])
def test_bones_of_a_standard_skeleton_are_mirror_images(pose: StandardPose) -> None:
    """Aims are mirrored; hinges, about which a positive rotation flexes, are mirrored as rotations are."""
    x, y, z = np.eye(3)
    found = {bone: pair for bone, *pair in standard_bones(Directions(x, y, z), pose)}
    mirror = np.array([-1.0, 1.0, 1.0])
    for bone, (aim, hinge) in found.items():
        assert abs(dot(aim, hinge)) < 1e-12, bone
        assert np.allclose((length(aim), length(hinge)), 1.0), bone
        other = bone.replace("left", "right")
        assert np.allclose(found[other][0], aim * mirror) or bone == other, bone
        assert np.allclose(found[other][1], -hinge * mirror) or bone == other, bone
    # VRMC_vrm 1.0, tpose.md, 1.8: the nail of the left thumb faces −x and +z, so it flexes to +x and −z.
    aim, hinge = found["leftThumbDistal"]
    assert pose == "apose" or np.allclose(cross(hinge, aim), np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0))


# The global rotations of SkeletonProfileHumanoid (Godot 4, skeleton_profile.cpp), as reference poses compose
# them: where x, y and z of a bone point. L is the left of a character that faces +z, which is +x.
GODOT = {
    "hips": "+x +y +z",
    "upperChest": "+x +y +z",
    "head": "+x +y +z",
    "leftShoulder": "+z +x +y",
    "leftUpperArm": "-z +x -y",
    "leftLowerArm": "-y +x +z",
    "leftHand": "-z +x -y",
    "leftIndexDistal": "-z +x -y",
    "rightShoulder": "-z -x +y",
    "rightUpperArm": "+z -x -y",
    "rightLowerArm": "+y -x +z",
    "rightHand": "+z -x -y",
    "leftUpperLeg": "-x -y +z",
    "rightLowerLeg": "+x -y -z",
    "leftFoot": "-x +z +y",
    "rightToes": "+x +z -y",
    "leftEye": "+x +z -y",
    "jaw": "-x +z +y",
}


@pytest.mark.ci
def test_axes_of_godot_are_those_of_its_profile() -> None:
    x, y, z = np.eye(3)
    found = {bone: pair for bone, *pair in godot_bones(Directions(x, y, z))}
    for bone, words in GODOT.items():
        rows = [np.eye(3)["xyz".index(word[1])] * (1 if word[0] == "+" else -1) for word in words.split()]
        aim, side = found[bone]
        assert np.allclose([side, aim, cross(side, aim)], rows), bone
    aim, side = found["leftThumbProximal"]
    # Its own numbers have three digits.
    assert np.allclose([aim, side], [[0.816, 0.0, 0.577], [0.0, 1.0, 0.0]], atol=1e-3)
    out = rigtri.conform(rigtri.read(SAMPLES / "biped.glb"), to="godot")
    (body,) = recognise(out).characters
    for bone, words in GODOT.items():
        if node := body.bones.get(bone):
            rows = [np.eye(3)["xyz".index(word[1])] * (1 if word[0] == "+" else -1) for word in words.split()]
            assert np.allclose(out.world[node, :3, :3], rows, atol=1e-4), bone


STUDIO = """title = "Studio"
like = "unreal"
[write]
sided = "{S}_{name}"
UpperArm = "arm"
Hand = "hand"
hips = "cog"
[skeleton]
pose = "tpose"
axes = "vrm"
"""


def test_a_skeleton_of_a_file_has_its_names_pose_and_axes(tmp_path: Path) -> None:
    scheme, out, again = tmp_path / "studio.toml", tmp_path / "out.glb", tmp_path / "again.glb"
    scheme.write_text(STUDIO, "utf-8")
    cli("conform", SAMPLES / "biped.glb", "-o", out, "--to", scheme, code=0)
    rig = rigtri.read(out)
    assert {"root", "cog", "L_arm", "R_hand"} <= set(rig.names)  # a root as Unreal has
    assert np.allclose(rig.world[rig.find("L_arm"), :3, :3], np.eye(3), atol=1e-5)
    cli("conform", out, "-o", again, "--to", scheme, code=0)
    assert again.read_bytes() == out.read_bytes()
    scheme.write_text(STUDIO.replace('"vrm"', '"blendr"'), "utf-8")
    ran = cli("conform", SAMPLES / "biped.glb", "-o", out, "--to", scheme, "--overwrite", code=3)
    assert "axes: there is no 'blendr'. Did you mean 'blender'" in ran.stderr
    scheme.write_text(STUDIO.replace("pose", "stance").replace('"vrm"', '"blendr"'), "utf-8")
    ran = cli("conform", SAMPLES / "biped.glb", "-o", out, "--to", scheme, "--overwrite", code=3)
    assert "[skeleton]: there is no 'stance'" in ran.stderr
    assert "axes: there is no 'blendr'" in ran.stderr, "all mistakes at once"
    ran = cli("conform", SAMPLES / "biped.glb", "-o", out, "--to", "unrael", "--overwrite", code=2)
    assert "Did you mean 'unreal'" in ran.stderr


def test_a_joint_that_has_the_name_of_a_bone_makes_room(tmp_path: Path) -> None:
    """A second joint of the spine that is called so, as of Quaternius' robot, in every run the same."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    names = ["Hips" if name == "toe_L_end" else name for name in rig.names]
    path, out, again = (tmp_path / f"{name}.glb" for name in ("in", "out", "again"))
    end = rig.find("toe_L_end")
    skin = rig.skins[0]
    more = with_joint(skin, end, np.concatenate([skin.inverse_bind, inverse(rig.world[end])[np.newaxis]]))
    rigtri.write(replace(rig, names=tuple(names), skins=(more,)), path)
    cli("conform", path, "-o", out, "--to", "unity", "--save-spec", tmp_path / "spec.yaml", code=0)
    assert {"Hips", "Hips_2"} <= set(rigtri.read(out).names)
    assert "Hips_2" in (tmp_path / "spec.yaml").read_text("utf-8")
    cli("conform", out, "-o", again, "--to", "unity", code=0)
    assert again.read_bytes() == out.read_bytes()


def test_where_joints_may_not_rotate_a_tpose_is_taken_as_it_is() -> None:
    rig, report = rigtri.set_rest(rigtri.read(SAMPLES / "biped.glb"), pose="tpose"), Report()
    joints = frozenset(np.flatnonzero(rig.is_joint).tolist())
    rules = replace(rig.rules, orient_locked="VRM 0.x forbids it", world_aligned=joints)
    locked = replace(rig, source=None, rules=rules)
    with pytest.raises(GeometryError, match='to="godot" has other axes: take to="unity" or vrm'):
        rigtri.conform(locked, to="godot")
    rigtri.conform(locked, to="unity", report=report)
    assert "set-rest" not in {entry["do"] for entry in report.added if entry["type"] == "step"}
    down = rigtri.set_rest(rig, pose="apose").rotation
    with pytest.raises(GeometryError, match="arms are not stretched out"):
        rigtri.conform(replace(locked, rotation=down), to="unity")


@pytest.mark.parametrize("to", ["unity", "vrm"])
def test_where_joints_may_not_rotate_joints_above_the_hips_have_the_axes_of_all(to: str) -> None:
    """Before, refused: VRM 0.x takes its axes for all joints or none, and those above the hips were named."""
    rig = rigtri.add_root(rigtri.set_rest(rigtri.read(SAMPLES / "biped.glb"), pose="tpose"))
    rules = replace(
        rig.rules,
        orient_locked="VRM 0.x forbids it",
        world_aligned=frozenset(np.flatnonzero(rig.is_joint).tolist()),
    )
    out = rigtri.conform(replace(rig, source=None, rules=rules), to=to)
    for node in np.flatnonzero(out.is_joint).tolist():
        assert np.abs(out.world[node, :3, :3] - np.eye(3)).max() < 1e-6, out.names[node]


def test_a_joint_between_two_bones_has_the_axes_of_the_upper_one() -> None:
    """Before, clips of other characters turned fingers below metacarpals, and forearms below twist joints in
    line, by as much as these had other axes."""
    body = posed_body(Pose("mixamo", arms=0.0, metacarpals=True))
    out = rigtri.orient_joints(body.rig, preset="blender", standard_pose="godot", pose="nodes")
    axes = out.world[:, :3, :3]
    for side in ("left", "right"):
        hand = axes[body.parts[f"{side} hand"]]
        assert np.allclose(axes[body.parts[f"{side} little 0"]], hand, atol=1e-6)
        assert np.allclose(axes[body.parts[f"{side} little 1"]], hand, atol=1e-6), "all of a hand in a T-pose"


def test_a_leg_below_another_joint_is_reported() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    parents = rig.parents.copy()
    foot, hips = rig.find("foot_L"), recognise(rig).characters[0].hips
    parents[foot] = hips
    local = rig.translation.copy()
    local[foot] = multiply(rig.world[foot], inverse(rig.world[hips]))[3, :3]
    report = Report()
    flat = replace(rig, parents=parents, translation=local, clips=(), source=None)
    out = rigtri.conform(flat, to="unity", report=report)
    assert any("LeftFoot (below LeftLowerLeg)" in warning.text for warning in report.warnings)
    assert np.allclose(out.world[out.find("LeftFoot"), :3, :3], np.eye(3), atol=1e-5)


def test_a_leg_below_the_spine_is_reported() -> None:
    """As in a 3ds Max Biped: below the hips all the same, and in an engine clips turn it with the spine."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    parents, local = rig.parents.copy(), rig.translation.copy()
    thigh, spine = rig.find("thigh_L"), recognise(rig).characters[0].bones["spine"]
    parents[thigh] = spine
    local[thigh] = multiply(rig.world[thigh], inverse(rig.world[spine]))[3, :3]
    report = Report()
    flat = replace(rig, parents=parents, translation=local, clips=(), source=None)
    rigtri.conform(flat, to="unity", report=report)
    texts = [warning.text for warning in report.warnings if warning.code == "hierarchy"]
    assert any("LeftUpperLeg (below Spine)" in text for text in texts)


def test_a_body_without_clavicles_is_told_how_far_off_clips_are() -> None:
    """Those of others turn its arms about the axes of the chest instead of the clavicle's."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    parents, translation = rig.parents.copy(), rig.translation.copy()
    names = [name.replace("clavicle", "pauldron") for name in rig.names]
    for arm in (rig.find("upper_arm_L"), rig.find("upper_arm_R")):
        parents[arm] = chest = rig.parents[parents[arm]]
        translation[arm] = multiply(rig.world[arm], inverse(rig.world[chest]))[3, :3]
    flat = replace(rig, names=tuple(names), parents=parents, translation=translation, clips=(), source=None)
    told = {}
    for target in TARGETS:
        report = Report()
        rigtri.conform(flat, to=target, report=report)
        told[target] = [item.text for item in report.warnings if item.code == "bones-missing"]
    assert told["unity"] == told["vrm"] == []
    assert "not here: clavicle_l, clavicle_r. Clips" in told["unreal"][0]
    assert "90 degrees off" in told["mixamo"][0]
    assert "120 degrees off" in told["godot"][0]
    report = Report()
    rigtri.conform(rig, to="godot", report=report)
    assert "bones-missing" not in {item.code for item in report.warnings}


def test_what_stands_against_the_axes_of_the_skeleton_is_reported() -> None:
    """A scale that is not uniform, and names that call left what is on the right."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    scale, report = rig.scale.copy(), Report()
    scale[rig.find("toe_L")] = (1.0, 1.5, 1.0)
    flat = replace(rig, scale=scale, clips=(), source=None)
    (skin,) = flat.skins
    bound = replace(skin, inverse_bind=inverse(flat.world[skin.joints]))
    rigtri.conform(replace(flat, skins=(bound,)), to="mixamo", report=report)
    told = {warning.code: warning.text for warning in report.warnings}
    assert "Other axes than those of the standard skeleton: mixamorig:LeftToeBase" in told["other-axes"]
    assert "With orient-joints --on-nonuniform-scale split," in told["nonuniform-scale"], (
        "whose option that is"
    )
    assert "sides" not in told
    side = {"L": "R", "R": "L"}
    names = [name[:-1] + side.get(name[-1:], name[-1:]) if "_" in name else name for name in rig.names]
    rigtri.conform(replace(rig, names=tuple(names), clips=(), source=None), to="unity", report=report)
    assert any(warning.code == "sides" for warning in report.warnings)


@pytest.mark.ci
def test_the_steps_are_a_spec_that_builds_the_same(tmp_path: Path) -> None:
    out, spec, built = tmp_path / "out.glb", tmp_path / "conform.yaml", tmp_path / "built.glb"
    cli("conform", SAMPLES / "biped.glb", "-o", out, "--to", "unreal", "--save-spec", spec, code=0)
    cli("build", SAMPLES / "biped.glb", "-o", built, "--spec", spec, code=0)
    before, after = rigtri.read(out), rigtri.read(built)
    assert before.names == after.names
    assert np.allclose(before.world, after.world, atol=1e-6)


@pytest.mark.parametrize("suffix", first([".glb", ".usda"]))
def test_a_root_of_another_name_is_the_root(suffix: str) -> None:
    """It gets the name of the skeleton and the axes of the world, and none is added above it."""
    rooted = rigtri.add_root(rigtri.read(SAMPLES / f"biped{suffix}"), name="mixamorig_Root")
    turned = rigtri.orient_joints(rooted, joints=["mixamorig_Root"], preset="blender", aim="z", up="x")
    assert rigtri.add_root(turned).names == turned.names
    # A skeleton that asks for no root takes one that is there, with the same axes.
    for target, name in (("unity", "mixamorig_Root"), ("unreal", "root"), ("godot", "Root")):
        after = rigtri.conform(turned, to=target)
        root = after.find(name)
        assert not after.is_joint[after.path_to_root(root)[1:]].any()
        assert int(after.parents[recognise(after).characters[0].hips]) == root
        axes = after.world[root, :3, :3]
        assert np.allclose(axes / length(axes)[:, np.newaxis], np.eye(3), atol=1e-6)


@pytest.mark.ci
def test_a_joint_between_root_and_hips_keeps_the_axes_of_the_world() -> None:
    """One too high to be the root, that moves no point: the step of the bones aimed it at what it holds."""
    rig = rigtri.add_root(rigtri.read(SAMPLES / "biped.glb"), name="old")
    translation, old = rig.translation.copy(), rig.find("old")
    translation[old, 1] += 1.0
    translation[np.flatnonzero(rig.parents == old), 1] -= 1.0
    world = replace(rig, translation=translation, clips=(), source=None).world
    skins = tuple(replace(skin, inverse_bind=inverse(world[skin.joints])) for skin in rig.skins)
    out = rigtri.conform(
        replace(rig, translation=translation, skins=skins, clips=(), source=None), to="godot"
    )
    assert out.names[out.parents[out.find("old")]] == "Root"
    assert np.allclose(out.world[out.find("old"), :3, :3], np.eye(3), atol=1e-6)


@pytest.mark.parametrize("option", ["facing=", "--facing"])
def test_errors_of_steps_name_options_as_the_caller_writes_them(option: str) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    skin = replace(rig.skins[0], inverse_bind=np.tile(np.eye(4), (len(rig.skins[0].joints), 1, 1)))
    bound_nowhere = replace(rig, skins=(skin,), source=None)
    given = {"to": "unity"} if option == "facing=" else {"options": ConformOptions(to="unity")}
    with pytest.raises(GeometryError, match=f"^set-rest: .* give it with {option}\\.$"):
        rigtri.conform(bound_nowhere, **given)


@pytest.mark.ci
def test_a_body_that_is_bound_facing_aside_is_reported() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    top, report = int(rig.levels[0][0]), Report()
    aside = compose(np.zeros(3), from_axis_angle(np.array([0.0, 1.0, 0.0]), np.radians(40.0)), np.ones(3))
    rotation, translation = rig.rotation.copy(), rig.translation.copy()
    translation[top], rotation[top], _ = decompose(multiply(rig.world[top], aside))
    (skin,) = rig.skins
    turned = replace(rig, rotation=rotation, translation=translation, clips=(), source=None)
    bound = replace(skin, inverse_bind=inverse(multiply(rig.world, aside)[skin.joints]))
    rigtri.conform(replace(turned, skins=(bound,)), to="unreal", report=report)
    assert [warning.code for warning in report.warnings].count("facing") == 1


@pytest.mark.ci
def test_a_clip_library_follows_by_names_then_axes_then_rest_pose() -> None:
    """As docs/one-skeleton.md says: its clips rotate joints as the character's own do after conform."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    body = rigtri.conform(rig, to="unreal")
    named = replace(rigtri.rename_joints(rigtri.freeze(rig), to="unreal"), skins=(), source=None)
    clips = rigtri.set_rest(rigtri.orient_joints(named, like=body), like=body)
    (found,) = recognise(body).characters
    for mine, theirs in zip(body.clips, clips.clips, strict=True):
        for node in found.bones.values():
            a, b = (
                locals_at(each, clip, [0.0, 0.3, 0.5])[:, each.find(body.names[node]), :3, :3]
                for each, clip in ((body, mine), (clips, theirs))
            )
            assert node == found.hips or np.allclose(a, b, atol=1e-5), body.names[node]


def test_without_a_skeleton_nothing_is_conformed() -> None:
    """Before, a traceback, as there is no joint to be on the ground."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    with pytest.raises(FileError, match="no skin lists joints"):
        rigtri.conform(replace(rig, skins=()), to="unreal")


def test_a_body_that_leans_at_rest_below_a_turned_armature_stands_upright(tmp_path: Path) -> None:
    """Converters from FBX bind with z up, below an armature that turns it; freeze takes that turn out."""
    path, out = tmp_path / "in.glb", tmp_path / "out.glb"
    rig = replace(rigtri.read(SAMPLES / "biped.glb"), clips=())
    armature, hips = rig.find("biped"), rig.find("hips")
    turn = compose(np.zeros(3), from_axis_angle(np.array([1.0, 0.0, 0.0]), -np.pi / 2), np.ones(3))
    lean = compose(np.zeros(3), from_axis_angle(np.array([1.0, 0.0, 0.0]), 0.6), np.ones(3))
    there = compose(rig.world[hips, 3, :3], np.array([0.0, 0.0, 0.0, 1.0]), np.ones(3))
    back = inverse(there)
    world = multiply(rig.world[hips], multiply(back, multiply(lean, there)))
    translation, rotation = rig.translation.copy(), rig.rotation.copy()
    translation[armature], rotation[armature], _ = decompose(turn)
    translation[hips], rotation[hips], _ = decompose(multiply(world, inverse(turn)))
    (skin,) = rig.skins
    bound = replace(skin, inverse_bind=multiply(turn, skin.inverse_bind))
    rig = replace(rig, translation=translation, rotation=rotation, skins=(bound,))
    rigtri.write(rig, path, verify=False)
    cli("conform", path, "-o", out, "--to", "unity", code=0)
    made = rigtri.read(out)
    trunk = made.world[made.find("Head"), 3, :3] - made.world[made.find("Hips"), 3, :3]
    assert trunk[1] / length(trunk) > 0.99
    across = made.world[made.find("LeftUpperArm"), 3, :3] - made.world[made.find("RightUpperArm"), 3, :3]
    assert across[0] / length(across) > 0.999
    cli("conform", out, "-o", tmp_path / "again.glb", "--to", "unity", code=0)
    assert (tmp_path / "again.glb").read_bytes() == out.read_bytes()


@pytest.mark.parametrize("to", ["unity", "godot"])
def test_bones_have_the_axes_of_the_skeleton_that_they_conform_to_and_of_no_other(to: str) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    conformed = rigtri.conform(rig, to=to)
    assert has_axes_of(conformed, to)
    assert not has_axes_of(rig, to)
    rotation = conformed.rotation.copy()
    (shin,) = (
        part.joint
        for body in recognise(conformed).characters
        for part in body.parts
        if part.bone == "leftLowerLeg"
    )
    rotation[shin] = normalise(rotation[shin] + 0.05)
    assert not has_axes_of(replace(conformed, rotation=rotation), to)


@pytest.mark.ci
def test_a_second_run_finds_the_axes_of_rotations_that_are_not_unit(tmp_path: Path) -> None:
    """Before, each run turned joints a little: positions were measured as if rotations were sheared."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    off = 1.0 + 1e-3 * np.sin(np.arange(len(rig)))
    source, out, again = (tmp_path / f"{name}.glb" for name in ("in", "out", "again"))
    rigtri.write(replace(rig, rotation=rig.rotation * off[:, np.newaxis]), source, verify=False)
    cli("conform", source, "-o", out, "--to", "godot", code=0)
    cli("conform", out, "-o", again, "--to", "godot", code=0)
    assert again.read_bytes() == out.read_bytes()
