"""set-rest: joints rest in another pose, and every clip plays as before."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from avatars import avatar
from broken_usd import SHAPED
from crowds import bound, crowd, instance
from places import SAMPLES, real_files
from program import cli
from usd_files import MESH, SKELETON, animation, at, deviation, save, scene, skeleton
from vrm_files import vrm_0

import rigtri
from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import key_times, locals_at, worlds
from rigtri.evaluation.zero_pose import ControlsAtZero
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.vectors import normalise
from rigtri.model.animation import Clip, Track
from rigtri.model.animation import Path as AnimatedPath
from rigtri.model.bindings import NodeConstraint
from rigtri.model.rig import Rig
from rigtri.operations.controls_check import refuse_other_rest
from rigtri.operations.set_rest import SetRestOptions, set_rest
from rigtri.recognition.recognise import recognise
from rigtri.report import Report


def places(rig: Rig, number: int) -> np.ndarray:
    """Where nodes are at the keys of a clip, (f, n, 3)."""
    clip = rig.clips[number]
    return worlds(rig, locals_at(rig, clip, key_times(clip)))[..., 3, :3]


@pytest.mark.ci
@pytest.mark.parametrize("pose", ["tpose", "apose"])
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_arms_stand_where_the_pose_has_them(pose: str, suffix: str, tmp_path: Path) -> None:
    out = tmp_path / f"out{suffix}"
    cli("set-rest", SAMPLES / f"biped{suffix}", "-o", out, "--pose", pose, code=0)
    rig = rigtri.read(out)
    (body,) = recognise(rig).characters
    at, bones = rig.world[:, 3, :3], body.bones
    left, up = np.array(body.normal), np.array(body.up)
    arm = left if pose == "tpose" else normalise(left - up)
    for start, end in (("UpperArm", "LowerArm"), ("LowerArm", "Hand")):
        along = normalise(at[bones[f"left{end}"]] - at[bones[f"left{start}"]])
        assert np.allclose(along, arm, atol=1e-5)
    leg = normalise(at[bones["rightFoot"]] - at[bones["rightUpperLeg"]])
    assert np.allclose(leg, -up, atol=1e-5)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_clips_play_as_before(suffix: str, tmp_path: Path) -> None:
    """Also a clip that has no keys of what rests in another way now."""
    source, out = tmp_path / f"in{suffix}", tmp_path / f"out{suffix}"
    rig = rigtri.read(SAMPLES / f"biped{suffix}")
    kept = [track for track in rig.clips[0].tracks if rig.names[track.node] != "upper_arm_L"]
    if suffix == ".glb":
        rig = replace(rig, clips=(replace(rig.clips[0], tracks=tuple(kept)), *rig.clips[1:]))
    rigtri.write(rig, source, verify=False)
    cli("set-rest", source, "-o", out, "--pose", "apose", code=0)
    before, after = rigtri.read(source), rigtri.read(out)
    size = np.ptp(before.world[:, 3, :3], axis=0).max()
    assert not np.allclose(before.world[:, 3, :3], after.world[:, 3, :3], atol=1e-3 * size)
    for number in (k for k, clip in enumerate(before.clips) if not clip.name.endswith("@default")):
        assert np.abs(places(before, number) - places(after, number)).max() < 1e-6 * size


def test_a_joint_that_rests_by_a_matrix_gets_keys(tmp_path: Path) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    arm = rig.find("upper_arm_L")
    clips = tuple(replace(c, tracks=tuple(t for t in c.tracks if t.node != arm)) for c in rig.clips)
    matrix, has_matrix = rig.matrix.copy(), rig.has_matrix.copy()
    matrix[arm], has_matrix[arm] = rig.local[arm], True
    source, out = tmp_path / "in.glb", tmp_path / "out.glb"
    rigtri.write(replace(rig, clips=clips, matrix=matrix, has_matrix=has_matrix), source, verify=False)
    before = rigtri.read(source)
    assert before.has_matrix[arm]
    cli("set-rest", source, "-o", out, "--pose", "tpose", code=0)
    after = rigtri.read(out)
    for number in range(len(before.clips)):
        assert np.abs(places(before, number) - places(after, number)).max() < 1e-6


@pytest.mark.ci
def test_each_of_two_characters_of_a_stage_plays_as_before(tmp_path: Path) -> None:
    shutil.copy(SAMPLES / "biped.usda", tmp_path / "hero.usda")
    arcs = "".join(f'def "{name}" (references = @./hero.usda@)\n{{\n}}\n' for name in ("A", "B"))
    source, out = save(tmp_path, f"#usda 1.0\n{arcs}", "two.usda"), tmp_path / "out.usda"
    cli("set-rest", source, "-o", out, "--pose", "tpose", code=0)
    assert deviation(source, out, at_rest=False) < 1e-6


def test_a_character_that_plays_nothing_rests_otherwise_while_others_play(tmp_path: Path) -> None:
    shutil.copy(SAMPLES / "biped.usda", tmp_path / "hero.usda")
    still = 'over "figure"\n{\nover "skeleton"\n{\nrel skel:animationSource = None\n}\n}\n'
    reference = "(references = @./hero.usda@)"
    arcs = f'def "A" {reference}\n{{\n}}\ndef "B" {reference}\n{{\n{still}}}\n'
    source, out = save(tmp_path, f"#usda 1.0\n{arcs}", "two.usda"), tmp_path / "out.usda"
    cli("set-rest", source, "-o", out, "--pose", "tpose", code=0)
    before, after = rigtri.read(source), rigtri.read(out)
    arms = [node for node, name in enumerate(before.names) if name == "upper_arm_L"]
    assert len(arms) == 2
    for arm in arms:
        assert not np.allclose(before.local[arm], after.local[arm], atol=1e-3)


def test_an_animation_of_some_joints_that_nobody_plays_gets_keys_of_the_old_rest_pose(tmp_path: Path) -> None:
    some = {
        "joints": 'uniform token[] joints = ["a"]',
        "translations": "float3[] translations = [(0, 0, 0)]",
        "rotations": "quatf[] rotations.timeSamples = { 1: [(1, 0, 0, 0)], 5: [(0.6, 0.8, 0, 0)] }",
        "scales": "half3[] scales = [(1, 1, 1)]",
    }
    source = save(tmp_path, scene(skeleton(), animation(), animation("Some", **some), MESH))
    out = tmp_path / "out.usda"
    cli("set-rest", source, "-o", out, "--pose", "Anim@5", code=0)
    for path in (source, out):
        text = path.read_text("utf-8")
        path.write_text(text.replace("Source = </Root/Anim>", "Source = </Root/Some>"), "utf-8")
    assert deviation(source, out, at_rest=False) < 1e-6


def test_a_character_rests_otherwise_beside_instances_that_play_what_it_does_not(tmp_path: Path) -> None:
    source, out = crowd(tmp_path), tmp_path / "out.usda"
    lone = instance("Four", x=9.0, more=bound("/World/Walk")).replace("instanceable = true", "")
    text = source.read_text("utf-8").rstrip().removesuffix("}")
    source.write_text(f"{text}{lone}}}\n", "utf-8")
    cli("set-rest", source, "-o", out, "--pose", "Walk@5", code=0)
    assert deviation(source, out, at_rest=False) < 1e-6


@pytest.mark.ci
def test_a_moment_and_another_file_give_the_rest_pose(tmp_path: Path) -> None:
    out, alike = tmp_path / "out.glb", tmp_path / "alike.glb"
    cli("set-rest", SAMPLES / "biped.glb", "-o", out, "--pose", "walk@0.5", code=0)
    cli("set-rest", SAMPLES / "biped.glb", "-o", alike, "--like", out, code=0)
    before, one, other = (rigtri.read(each) for each in (SAMPLES / "biped.glb", out, alike))
    arm = before.find("upper_arm_L")
    assert not np.allclose(before.rotation[arm], one.rotation[arm], atol=1e-3)
    assert np.allclose(one.rotation[arm], other.rotation[arm], atol=1e-6)


def test_a_moment_is_taken_as_it_is_below_a_scale_that_is_not_uniform() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    scale = rig.scale.copy()
    scale[rig.find("biped")] = 1, 1.5, 1
    uneven = replace(rig, scale=scale, source=None)
    once, plain = (rigtri.set_rest(each, pose="walk@0.3") for each in (uneven, rig))
    assert np.array_equal(once.rotation, plain.rotation)
    assert rigtri.set_rest(once, pose="walk@0.3") is once
    alike = rigtri.set_rest(uneven, like=plain)
    assert np.allclose(np.abs((alike.rotation * plain.rotation).sum(axis=1)), 1.0)


@pytest.mark.ci
def test_the_bind_pose_is_where_the_mesh_is_as_it_was_drawn(tmp_path: Path) -> None:
    posed, out = tmp_path / "posed.glb", tmp_path / "out.glb"
    cli("set-rest", SAMPLES / "biped.glb", "-o", posed, "--pose", "walk@0.5", code=0)
    cli("set-rest", posed, "-o", out, "--pose", "bind", code=0)
    rig = rigtri.read(out)
    skin = rig.skins[0]
    assert np.allclose(skin.bind[:, :3, :3], rig.world[skin.joints, :3, :3], atol=1e-5)


def test_vrm_0_has_no_rest_rotations(tmp_path: Path) -> None:
    rig = rigtri.read(vrm_0().glb(tmp_path / "in.vrm"))
    joint = int(np.flatnonzero(rig.is_joint)[-1])
    turned = rig.rotation.copy()
    turned[joint] = (0, 0, 0.6, 0.8)
    with pytest.raises(GeometryError, match=r"VRM 0\.x forbids rest rotations"):
        rigtri.set_rest(rig, like=replace(rig, rotation=turned, source=None))


@pytest.mark.parametrize(("source", "stays"), [("forearm_L", True), ("upper_arm_L", False)])
def test_what_node_constraints_count_from_stays_where_little_is_to_be_done(source: str, stays: bool) -> None:
    """The pose would turn the forearm by 12 degrees, the upper arm by 38. Before, both were refused."""
    rig, report = rigtri.read(SAMPLES / "biped.glb"), Report()
    node, eyes = rig.find(source), rig.find("eyes")
    rig = replace(rig, node_constraints=(NodeConstraint("rotation", eyes, node, np.zeros(3), key="file"),))
    if not stays:
        with pytest.raises(GeometryError, match=f"the rest pose of {source}: take them out"):
            rigtri.set_rest(rig, pose="tpose")
        return
    out = rigtri.set_rest(rig, pose="tpose", report=report)
    assert np.array_equal(out.rotation[node], rig.rotation[node])
    assert not np.allclose(out.rotation[rig.find("upper_arm_L")], rig.rotation[rig.find("upper_arm_L")])
    (warning,) = report.warnings
    assert warning.text.endswith("of forearm_L, which stay as they are, up to 12 degrees from the pose")


def test_a_scale_that_shears_is_refused() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    scale = rig.scale.copy()
    scale[rig.find("spine")] = 1, 2, 1
    with pytest.raises(GeometryError, match=r"scale of 'spine' is not uniform, so that \d+ joints below it"):
        rigtri.set_rest(replace(rig, scale=scale, source=None), pose="tpose")


def test_the_scale_that_shears_is_named_and_not_the_noise_above_it() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    scale = rig.scale.copy()
    scale[rig.find("hips")], scale[rig.find("spine")] = (1, 1.0000001, 1), (1, 2, 1)
    with pytest.raises(GeometryError, match="The scale of 'spine' is not uniform"):
        rigtri.set_rest(replace(rig, scale=scale, source=None), pose="tpose")


def test_a_sheared_rest_that_a_clip_shows_is_refused_by_name() -> None:
    """USD: what has no keys rests. Before, a key of it was written, and the comparison refused the file."""
    rig = rigtri.read(SAMPLES / "biped.usda")
    node = rig.find("forearm_L")
    matrix, has_matrix = rig.matrix.copy(), rig.has_matrix.copy()
    matrix[node], has_matrix[node] = rig.local[node], True
    matrix[node, 0] += 0.5 * matrix[node, 1]
    clips = tuple(replace(c, tracks=tuple(t for t in c.tracks if t.node != node)) for c in rig.clips)
    sheared = replace(rig, matrix=matrix, has_matrix=has_matrix, clips=clips, source=None)
    with pytest.raises(
        GeometryError, match=r"The rest pose of 'forearm_L' is sheared, and clip '.*' shows it"
    ):
        rigtri.set_rest(sheared, pose="bind")
    rigtri.set_rest(replace(sheared, clips=()), pose="bind")


@pytest.mark.parametrize("path", real_files())
def test_real_files_play_as_before(path: Path, tmp_path: Path) -> None:
    out, again = tmp_path / f"o{path.suffix}", tmp_path / f"a{path.suffix}"
    trust = ("--allow-external-paths",)
    ran = cli("set-rest", path, "-o", out, "--pose", "tpose", *trust)
    if ran.exit_code in (3, 5):
        pytest.skip(ran.stderr.splitlines()[-1])
    assert ran.exit_code == 0, ran.stderr
    cli("set-rest", out, "-o", again, "--pose", "tpose", *trust, code=0)
    assert again.read_bytes() == out.read_bytes()


@pytest.mark.parametrize("pose", ["bind", "tpose"])
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_hips_that_rest_leaning_without_a_root_stand_as_they_were_bound(suffix: str, pose: str) -> None:
    rig = rigtri.read(SAMPLES / f"biped{suffix}")
    hips, rotation, translation = rig.find("hips"), rig.rotation.copy(), rig.translation.copy()
    rotation[hips] = product(from_axis_angle(np.array([1.0, 0, 0]), 0.4), rotation[hips])
    translation[hips] += 0.1
    leaning = replace(rig, rotation=rotation, translation=translation, source=None)
    stands = rigtri.set_rest(leaning, pose=pose)
    assert np.allclose(stands.world[hips], rig.world[hips], atol=1e-5)
    assert np.allclose(places(stands, 0), places(leaning, 0), atol=1e-5)


@pytest.mark.parametrize(("degrees", "told"), [(30, []), (70, ["70°"]), (90, [])])
def test_hips_that_lie_as_no_exporter_binds_stay_with_a_warning(degrees: int, told: list[str]) -> None:
    """Spaces that exporters bind in differ by quarter turns, so 90° may be no pose."""
    rig, report = rigtri.read(SAMPLES / "biped.glb"), Report()
    hips, rotation = rig.find("hips"), rig.rotation.copy()
    rotation[hips] = product(from_axis_angle(np.array([1.0, 0, 0]), np.radians(degrees)), rotation[hips])
    rigtri.set_rest(replace(rig, rotation=rotation, source=None), pose="bind", report=report)
    notices = [each.text for each in report.warnings if each.code == "bind-leaning"]
    assert [word for text in notices for word in ("'hips' rests", *told) if word not in text] == []
    assert len(notices) == len(told)


def test_joints_that_rest_within_a_clip_are_refused(tmp_path: Path) -> None:
    """Where samples of a USD animation are blocked, UsdSkel shows the rest pose."""
    still = "[(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)]"
    rest = SKELETON["rest"].replace(at(0, 2, 0), at(1, 2, 0))
    blocked = f"quatf[] rotations.timeSamples = {{\n1: {still},\n5: None,\n}}"
    source = save(tmp_path, scene(skeleton(rest=rest), animation(rotations=blocked), MESH))
    ran = cli("set-rest", source, "-o", tmp_path / "out.usda", "--pose", "bind", code=5)
    assert "</Root/Anim>.rotations is blocked at 5" in " ".join(ran.stderr.split())


@pytest.mark.parametrize("rotations", ["quatf[] rotations = []", ""])
def test_joints_of_an_animation_that_is_not_played_are_refused(rotations: str, tmp_path: Path) -> None:
    """UsdSkel shows their rest pose all along. Before, the result was refused as one that looks different."""
    rest = SKELETON["rest"].replace(at(0, 2, 0), at(1, 2, 0))
    source = save(tmp_path, scene(skeleton(rest=rest), animation(rotations=rotations), MESH))
    ran = cli("set-rest", source, "-o", tmp_path / "out.usda", "--pose", "bind", code=5)
    assert "does not play </Root/Anim>, which has no rotations" in " ".join(ran.stderr.split())


@pytest.mark.parametrize("lacking", [{"joints": ""}, {"scales": "half3[] scales = [(1, 1, 1)]"}])
def test_joints_rest_where_an_animation_plays_blend_shapes_alone(
    lacking: dict[str, str], tmp_path: Path
) -> None:
    """Its clip shows their rest pose all along. Before, it showed the new one, exit code 0."""
    rest = SKELETON["rest"].replace(at(0, 2, 0), at(1, 2, 0))
    weights = "float[] blendShapeWeights.timeSamples = { 1: [0], 9: [0.5] }"
    moved = animation(blend='uniform token[] blendShapes = ["smile"]', weights=weights, **lacking)
    source = save(tmp_path, scene(skeleton(rest=rest), moved, SHAPED))
    ran = cli("set-rest", source, "-o", tmp_path / "out.usda", "--pose", "bind", code=5)
    assert "plays the blend shapes of </Root/Anim>, which has no values for" in " ".join(ran.stderr.split())


def test_a_clip_of_colours_alone_shows_the_old_rest_pose(tmp_path: Path) -> None:
    """Before, it got no keys, and the result was refused as one that looks different."""
    document = json.loads((SAMPLES / "biped.gltf").read_text("utf-8"))
    sampler = document["animations"][0]["samplers"][0]
    target = {"pointer": "/materials/0/pbrMetallicRoughness/baseColorFactor"}
    document["animations"].append(
        {
            "name": "blush",
            "samplers": [sampler],
            "channels": [
                {
                    "sampler": 0,
                    "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": target}},
                }
            ],
        }
    )
    document["extensionsUsed"] = ["KHR_animation_pointer"]
    source, out = tmp_path / "hero.gltf", tmp_path / "out.gltf"
    source.write_text(json.dumps(document), "utf-8")
    shutil.copy(SAMPLES / "biped.bin", tmp_path)
    cli("set-rest", source, "-o", out, "--pose", "tpose", code=0)
    before, after = rigtri.read(source), rigtri.read(out)
    assert not np.allclose(before.world, after.world, atol=1e-3)
    assert [clip.name for clip in after.clips] == [clip.name for clip in before.clips]
    assert np.allclose(places(after, -1)[0], before.world[:, 3, :3], atol=1e-5)


def test_plain_prims_get_no_other_rest_pose_and_the_error_says_why(tmp_path: Path) -> None:
    """Before, it ended with 3, as if the file were damaged."""
    words = ["--root", "/arm", "--pose", "xforms@10"]
    reason = cli("set-rest", SAMPLES / "arm.usda", "-o", tmp_path / "o.usda", *words, code=5).stderr
    assert "/arm/shoulder/elbow> is a plain prim" in reason


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_character_that_is_placed_in_its_scene_keeps_its_place(suffix: str) -> None:
    rig = rigtri.read(SAMPLES / f"biped{suffix}")
    translation = rig.translation.copy()
    translation[rig.find("biped")] = 5, 0, 3
    placed = replace(rig, translation=translation, source=None)
    assert np.allclose(rigtri.set_rest(placed, pose="bind").world, placed.world, atol=1e-6)


def test_a_skin_is_bound_in_the_space_above_a_node_of_another_size_that_is_placed() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    rig = rig.insert_above({rig.find("biped"): "set"})
    hips = rig.find("hips")
    translation, rotation, scale = rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()
    translation[rig.find("set")], scale[rig.find("biped")] = (5, 0, 3), 0.5
    scale[hips], translation[hips] = 2, 2 * translation[hips]
    bound = replace(rig, translation=translation, scale=scale, source=None).world[hips]
    translation[hips] += 0.1
    rotation[hips] = product(from_axis_angle(np.array([1.0, 0, 0]), 0.4), rotation[hips])
    leaning = replace(rig, translation=translation, rotation=rotation, scale=scale, source=None)
    assert np.allclose(rigtri.set_rest(leaning, pose="bind").world[hips], bound, atol=1e-5)


@pytest.mark.parametrize("pose", ["bind", "tpose"])
def test_joints_that_move_nothing_rest_as_before_however_they_are_bound(pose: str) -> None:
    """As Blender binds its leaf bones: without the transform that the armature has."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    skin, toe = rig.skins[0], rig.find("toe_L")
    row = skin.joints.tolist().index(toe)
    weighted, inverse_bind = skin.weighted.copy(), skin.inverse_bind.copy()
    weighted[row] = False
    inverse_bind[row] = 100 * np.eye(4)
    inverse_bind[row, 3] = 0, 0, 0, 1
    clips = tuple(replace(c, tracks=tuple(t for t in c.tracks if t.node != toe)) for c in rig.clips)
    leaf = replace(skin, inverse_bind=inverse_bind, weigh=lambda: weighted)
    found = rigtri.set_rest(replace(rig, skins=(leaf,), clips=clips, source=None), pose=pose)
    assert np.allclose(found.local[toe], rig.local[toe], atol=1e-6)


def test_a_clip_library_without_a_skin_rests_as_its_character_and_plays_as_before() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    arm = rig.find("upper_arm_L")
    few = tuple(replace(c, tracks=tuple(t for t in c.tracks if t.node != arm)) for c in rig.clips)
    posed, clips = rigtri.set_rest(rig, pose="tpose"), replace(rig, skins=(), clips=few, source=None)
    resting = rigtri.set_rest(clips, like=posed)
    assert np.allclose(resting.world, posed.world, atol=1e-6)
    assert np.allclose(places(resting, 0), places(clips, 0), atol=1e-6)


@pytest.mark.parametrize("up", ["y", "z"])
@pytest.mark.parametrize("skinned", [True, False])
def test_rest_rotations_of_joints_with_other_axes_are_refused(skinned: bool, up: str) -> None:
    """Rolled axes too, in which all bones point alike (x, here with another up)."""
    rig = rigtri.orient_joints(rigtri.read(SAMPLES / "biped.glb"), aim="x", up="z")
    other = rigtri.orient_joints(rig, aim="x" if up == "y" else "y", up=up)
    ours = rig if skinned else replace(rig, skins=(), source=None)
    with pytest.raises(GeometryError, match=r"\d+ of \d+ joints have other axes there"):
        rigtri.set_rest(ours, like=other)


def test_what_is_up_for_a_body_is_as_it_is_bound_and_not_as_it_rests() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    top, hips, rotation = rig.find("biped"), rig.find("hips"), rig.rotation.copy()
    rotation[top] = from_axis_angle(np.array([1.0, 0, 0]), np.pi / 2)
    lying = replace(rig, rotation=rotation, source=None)
    leaning = rotation.copy()
    leaning[hips] = product(from_axis_angle(normalise(np.array([1.0, 2, 3])), 0.3), rotation[hips])
    stands = rigtri.set_rest(replace(lying, rotation=leaning), pose="tpose")
    assert np.allclose(stands.world, rigtri.set_rest(lying, pose="tpose").world, atol=1e-5)


@pytest.mark.parametrize(
    ("here", "there", "why"),
    [
        (False, True, "the joints of this file have no names"),
        (True, False, "the joints of FILE have no names"),
        (True, True, "no joint of the two files has the same name"),
    ],
)
def test_joints_without_namesakes_are_refused_with_the_reason(here: bool, there: bool, why: str) -> None:
    """Before, the advice was to rename the joints of this file, also where those of FILE have no names."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    ours, theirs = (
        replace(rig, names=tuple(f"{way}{k}" if named else "" for k in range(len(rig))), source=None)
        for way, named in (("a", here), ("b", there))
    )
    if here and there:
        theirs = replace(theirs, names=tuple(f"b{k}" for k in range(len(rig))))
    for call in (rigtri.set_rest, rigtri.orient_joints):
        with pytest.raises(GeometryError, match=f"{why}. Give both files"):
            call(ours, like=theirs)


def test_two_files_of_the_same_nodes_without_names_go_node_by_node() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    bare = replace(rig, names=("",) * len(rig), source=None)
    posed = replace(rigtri.set_rest(rig, pose="apose"), names=bare.names, source=None)
    alike = rigtri.set_rest(bare, like=posed)
    assert np.allclose(np.abs((alike.rotation * posed.rotation).sum(axis=1)), 1.0)


@pytest.mark.parametrize("noise", [0.0, 5e-6])
def test_a_rest_pose_in_which_scale_noise_lets_ik_move_a_limb_otherwise_is_refused(noise: float) -> None:
    """Before, a nearly straight elbow of a real robot moved by 2.3e-5 of the size, without a word."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    scale = rig.scale.copy()
    scale[rig.find("clavicle_L")] = (1.0 + noise, 1.0, 1.0)
    rig = rigtri.add_controls(replace(rig, scale=scale), whole_character=True)
    control = rig.find("hand_L_ik_ctl")
    keys = Track(control, "translation", "STEP", np.zeros(1), rig.translation[[control]] - [0.0, 0.1, 0.0])
    rig = replace(rig, clips=(Clip("reach", (keys,)),))
    refuse_other_rest(rig, rig, [rig.find("clavicle_L")])
    moved = replace(rig, clips=(Clip("reach", (replace(keys, values=keys.values + 1e-4),)),))
    if noise:
        with pytest.raises(GeometryError, match=r"In clip 'reach' .* scale of 'clavicle_L' is not quite"):
            refuse_other_rest(rig, moved, [rig.find("upper_arm_L")])
    else:  # what noise cannot have made is others' to find
        refuse_other_rest(rig, moved, [rig.find("upper_arm_L")])


@pytest.mark.parametrize("controlled", [False, True])
def test_a_rest_pose_of_a_joint_that_a_root_control_counts_from_is_refused(controlled: bool) -> None:
    """Before, the body was 0.08 of the size elsewhere in a clip in which the root control has keys."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    rig = rigtri.add_controls(rig, root_control=True, joints=["head", *(["hips"] if controlled else [])])
    (root,) = [node for node in rig.nodes_of("control") if rig.names[node] == "hips_root_ctl"]
    walks = Track(root, "translation", "STEP", np.zeros(1), np.array([[0.1, 0.0, 0.0]]))
    rig = replace(rig, clips=(*rig.clips, Clip("walks", (walks,))))
    hips = rig.find("hips")
    translation = rig.translation.copy()
    translation[hips] += [0.0, 0.0, 0.2]
    after = replace(rig, translation=translation)
    if controlled:
        refuse_other_rest(rig, after, [hips])
        return
    with pytest.raises(
        GeometryError, match=r"'walks' 'hips_root_ctl' would move .* 'hips' without a control"
    ):
        refuse_other_rest(rig, after, [hips])


@pytest.mark.parametrize("controlled", [False, True])
def test_a_rest_pose_of_a_joint_without_a_control_that_ik_counts_from_is_refused(controlled: bool) -> None:
    """Before, a limb on the end joint of a real chain was 0.8 of the size off, without a word."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    rig = rigtri.add_controls(rig, ik=[("upper_arm_L", "forearm_L", "hand_L")])
    if controlled:
        rig = rigtri.add_controls(rig, joints=["clavicle_L"])
    control, clavicle = rig.find("hand_L_ik_ctl"), rig.find("clavicle_L")
    goal = Track(control, "translation", "STEP", np.zeros(1), rig.translation[[control]] - [0.1, 0.2, 0.0])
    up = product(rig.rotation[[clavicle]], np.array([[0.0, 0.0, np.sin(0.2), np.cos(0.2)]]))
    rig = replace(rig, clips=(Clip("shrug", (goal, Track(clavicle, "rotation", "STEP", np.zeros(1), up))),))
    if controlled:
        assert (rigtri.set_rest(rig, pose="shrug@0").rotation[clavicle] != rig.rotation[clavicle]).any()
        return
    with pytest.raises(GeometryError, match=r"In clip 'shrug' IK would .* 'clavicle_L' without a"):
        rigtri.set_rest(rig, pose="shrug@0")


def test_a_skeleton_that_no_animation_moves_shows_the_new_rest_in_the_clips_of_its_stage(
    tmp_path: Path,
) -> None:
    """Before, the command said that clips play as before."""
    rest = SKELETON["rest"].replace(at(0, 2, 0), at(1, 2, 0))
    lift = (
        'def Xform "lift" {\ndouble3 xformOp:translate.timeSamples = { 1: (0, 0, 0), 9: (0, 1, 0) }\n'
        'uniform token[] xformOpOrder = ["xformOp:translate"]\ndef Cube "box" {}\n}'
    )
    still = skeleton(rest=rest).replace("rel skel:animationSource = </Root/Anim>", "")
    source = save(tmp_path, scene(still, MESH, lift))
    ran = cli("set-rest", source, "-o", tmp_path / "out.usda", "--pose", "bind", code=0)
    assert "1 joint rest in another pose\n" in ran.stderr
    assert "show them in this pose (xforms); no animation moves their skeleton" in ran.stderr


def test_joints_that_springs_swing_keep_their_rest_pose(tmp_path: Path) -> None:
    """Viewers swing them about it. Before, hair swung about how it hung at a moment of a clip."""
    rig = rigtri.read(avatar(1).glb(tmp_path / "avatar.vrm"))
    hair, neck = rig.find("hair"), rig.find("spine")
    rotation = rig.rotation.copy()
    for node in (hair, neck):
        rotation[node] = product(from_axis_angle(np.array([1.0, 0, 0]), 0.4), rotation[node])
    report = Report()
    found = rigtri.set_rest(rig, like=replace(rig, rotation=rotation), report=report)
    assert (found.rotation[hair] == rig.rotation[hair]).all()
    assert (found.rotation[neck] != rig.rotation[neck]).any()
    (notice,) = [each for each in report.warnings if each.code == "spring-kept"]
    assert "swing hair about" in notice.text


@pytest.mark.parametrize("pose", ["--like", "--pose bind", "--pose Anim@1", "--pose Anim@3"])
@pytest.mark.parametrize("suffix", [".usda", ".glb"])
def test_a_joint_that_is_mirrored_about_one_axis_keeps_the_signs_of_its_scale(
    pose: str, suffix: str, tmp_path: Path
) -> None:
    """A clip that turns it, and does not scale it, shows it mirrored as before."""
    mirrored, end = (at(*place).replace("1", "-1", 1) for place in ((0, 2, 0), (0, 4, 1)))
    bones = skeleton(
        rest=f"uniform matrix4d[] restTransforms = [{at(0, 0, 0)}, {mirrored}, {at(0, 2, 1)}]",
        bind=f"uniform matrix4d[] bindTransforms = [{at(0, 0, 0)}, {mirrored}, {end}]",
    )
    moving = animation(scales="half3[] scales = [(-1, 1, 1), (1, 1, 1), (1, 1, 1)]")
    source = save(tmp_path, scene(bones, moving, MESH))
    if suffix == ".glb":
        cli("convert", source, "-o", tmp_path / "in.glb", code=0)
        source = tmp_path / "in.glb"
    words = ("--like", source) if pose == "--like" else pose.split()
    out = tmp_path / f"out{suffix}"
    told = cli("set-rest", source, "-o", out, *words, code=0).output
    assert ("rest so already" in told) == (pose in ("--like", "--pose bind"))
    if suffix == ".usda":
        assert deviation(source, out, at_rest=False) < 1e-6


@pytest.mark.parametrize("keyed", [False, True])
def test_controls_that_stay_in_the_old_rest_pose_are_named_with_what_mends_it(keyed: bool) -> None:
    """Before, a later key of zero moved the mesh back without a word."""
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True)
    assert _off_at_zero(rig) < 1e-6
    if keyed:
        key = Track(rig.find("chest_ctl"), "rotation", "STEP", np.zeros(1), np.array([[0.0, 0.0, 0.6, 0.8]]))
        rig = replace(rig, clips=(*rig.clips, Clip("bows", (key,))))
    report = Report()
    out = set_rest(rig, options=SetRestOptions(pose="tpose"), report=report)
    (told,) = [each for each in report.warnings if each.code == "controls-old-rest"]
    assert {"upper_arm_L_ctl", "foot_R_ik_ctl"} <= {*told.names}
    assert not {"chest_ctl", "head_ctl"} & {*told.names}
    assert told.text.endswith("put them into the new one" if keyed else "puts them into the new one")
    assert _off_at_zero(out) > 0.1
    if keyed:
        assert _off_at_zero(rigtri.add_controls(out, whole_character=True)) > 0.1
        bare = rigtri.strip(rigtri.bake(out, to="joints"))
        mended = rigtri.bake(rigtri.add_controls(bare, whole_character=True), to="controls")
    else:
        mended = rigtri.add_controls(out, whole_character=True)
    assert _off_at_zero(mended) < 1e-6
    back = Report()
    set_rest(out, options=SetRestOptions(pose="bind"), report=back)
    assert not back.warned("controls-old-rest")


@pytest.mark.parametrize(
    ("control", "channels"),
    [
        ("forearm_L_ctl", {"rotation": [0.0, 0.0, 0.6, 0.8]}),
        ("hand_L_ik_ctl", {"translation": [-0.1, 0.1, 0.05]}),
    ],
)
def test_a_control_that_is_posed_at_rest_stays_so_in_clips_without_keys_of_its_joints(
    control: str, channels: dict[AnimatedPath, list[float]]
) -> None:
    """Before, the keys of the old rest pose took over in the next bake: 0.1 of the size, without a word."""
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True)
    node = rig.find(control)
    posed = {path: getattr(rig, path).copy() for path in channels}
    for path, value in channels.items():
        posed[path][node] = value
    rig = replace(rig, **posed)
    wave = next(k for k, clip in enumerate(rig.clips) if clip.name == "wave")
    times = key_times(rig.clips[wave])

    def joints(of: Rig) -> np.ndarray:
        return worlds(of, locals_at(of, of.clips[wave], times))[:, of.is_joint, 3, :3]

    was = joints(rigtri.bake(rig, to="joints"))
    assert np.abs(was - joints(rig)).max() > 0.05
    taken = rigtri.set_rest(rig, pose="apose")
    assert {track.path for track in taken.clips[wave].tracks if track.node == node} == set(channels)
    assert np.abs(joints(rigtri.bake(taken, to="joints")) - was).max() < 1e-6


def _off_at_zero(rig: Rig) -> float:
    """How far joints are from how they rest while all controls are zero, in metres."""
    apart = ControlsAtZero(rig).world[rig.is_joint] - rig.normalised_world[rig.is_joint]
    return float(np.abs(apart[:, 3, :3]).max())


@pytest.mark.ci
@pytest.mark.parametrize("faces", ["+x", "-x", "+y", "0.2,0,-0.1"])
@pytest.mark.parametrize(
    "words",
    [
        ("set-rest", "--pose", "tpose"),
        ("orient-joints", "--preset", "unreal-editor", "--standard-pose", "apose"),
        ("conform", "--to", "unreal"),
    ],
    ids=lambda words: words[0],
)
def test_a_body_is_not_said_to_face_its_side_or_its_head(
    words: tuple[str, ...], faces: str, tmp_path: Path
) -> None:
    """Before, clavicles got frames of a zero vector: numbers that are none, or a traceback."""
    out = tmp_path / "out.usda"
    asked_before = words[0] == "orient-joints" and faces == "+y"  # along the body it is a usage error there
    code, text = (2, "runs along the character") if asked_before else (5, "This body cannot face")
    assert text in cli(*words, SAMPLES / "biped.usda", "-o", out, "--facing", faces, code=code).stderr
    assert not out.exists()


@pytest.mark.ci
def test_the_length_of_a_facing_direction_does_not_count(tmp_path: Path) -> None:
    one, other = tmp_path / "one.usda", tmp_path / "other.usda"
    for out, faces in ((one, "0.3,0,1"), (other, "1.2,0,4")):
        words = ("--pose", "tpose", "--straight-fingers", "--facing", faces)
        cli("set-rest", SAMPLES / "biped.usda", "-o", out, *words, code=0)
    assert np.allclose(rigtri.read(one).world, rigtri.read(other).world, atol=1e-6)


def test_twist_joints_rest_with_their_share_of_the_twist(samples: Path) -> None:
    """Before, they kept the old rest: a forearm was 0.03 of the size off the moment that was named."""
    rig = rigtri.add_twist(rigtri.read(samples / "biped.glb"), limbs="auto")
    clip, twists = rig.clips[0], [node for node in range(len(rig)) if rig.type_of(node) == "twist"]
    moment = Report()
    taken = rigtri.set_rest(rig, pose=f"{clip.name}@0.25", report=moment)
    wanted = locals_at(rig, clip, np.array([0.25]))[0]
    assert np.abs(wanted[twists] - rig.local[twists]).max() > 0.01
    assert np.abs(wanted[twists] - taken.local[twists]).max() < 1e-6
    baked = rigtri.bake(taken)
    times = np.linspace(0.0, 1.0, 17)
    before, after = (locals_at(each, each.clips[0], times)[:, twists] for each in (taken, baked))
    assert np.abs(before - after).max() < 1e-4
    assert np.abs(baked.local[twists] - taken.local[twists]).max() < 1e-6
