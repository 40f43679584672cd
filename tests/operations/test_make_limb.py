"""make-limb: points become an oriented chain of joints and its pole vector."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flat_options import axes_of
from numpy.testing import assert_allclose
from program import cli
from pxr import Usd, UsdGeom, UsdSkel
from rigs import chain, rig_of
from second_opinions import khronos_errors, usd_errors, validator

import rigtri
from rigtri.cli.make_limb import spread
from rigtri.errors import FileError, GeometryError, NoLimbError, UsageError
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.formats import ReadOptions, read, write_blank
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import PRESETS
from rigtri.operations.limb_guides import _readable
from rigtri.operations.make_limb import MakeLimbOptions, make_limb
from rigtri.pipeline.edit import edit
from rigtri.report import Report

TRUSTING = ReadOptions(allow_external_paths=True, empty=True)
# The article's: shoulder, elbow, wrist. AB × BC points along −z.
ARM = ((0.0, 0.0, 0.0), (3.0, 4.0, 0.0), (6.0, 0.0, 0.0))
EMPTY = rig_of([], [], np.zeros((0, 3)), np.zeros((0, 4)))
SUFFIXES = (".glb", ".gltf", ".usda", ".usdc", ".usd", ".usdz")


def made(points: Any = ARM, rig: Rig = EMPTY, **options: Any) -> tuple[Rig, list[int], Report]:
    """The rig with a limb, its joints from the root on, and the report."""
    report = Report()
    out = make_limb(rig, options=MakeLimbOptions(points=points, **options), report=report)
    return out, [out.find(entry["node"]) for entry in report.added], report


def pole(rig: Rig) -> int:
    (node,) = [node for node, note in rig.metadata.items() if note["type"] == "poleVector"]
    return node


def test_the_articles_arm_has_the_articles_numbers() -> None:
    """X along the bone, Y the plane's normal (bend × aim), Z their product; the pole 5 from the root."""
    article = {"method": "ratio", "from_": "root", "distance": 5.0, "orientation": "limb"}
    out, (shoulder, elbow, wrist), _ = made(**article)
    world = out.world
    assert_allclose(world[[shoulder, elbow, wrist], 3, :3], ARM, atol=1e-6)
    assert_allclose(world[shoulder, :3, :3], [[0.6, 0.8, 0], [0, 0, -1], [-0.8, 0.6, 0]], atol=1e-6)
    assert_allclose(world[elbow, :3, :3], [[0.6, -0.8, 0], [0, 0, -1], [0.8, 0.6, 0]], atol=1e-6)
    assert_allclose(world[wrist, :3, :3], world[elbow, :3, :3], atol=1e-6)
    assert_allclose(world[pole(out), 3, :3], [0, 5, 0], atol=1e-6)
    assert_allclose(world[pole(out), :3, :3], world[shoulder, :3, :3], atol=1e-6)


@pytest.mark.parametrize("preset", sorted(set(PRESETS) - {"vrm"}))
def test_every_preset_has_the_aim_and_up_that_it_states(preset: str) -> None:
    style = PRESETS[preset]
    out, joints, _ = made(**axes_of(style))
    points, normal = np.array(ARM), np.array([0.0, 0.0, -1.0])
    for joint, bone in zip(joints, np.diff(points, axis=0), strict=False):
        axes = out.world[joint, :3, :3]
        bone = bone / np.linalg.norm(bone)
        ups = {"plane": normal, "pole": np.cross(bone, normal), "world:+y": np.array([0.0, 1, 0])}
        for axis, wanted in ((style.aim, bone), (style.up, ups[style.up_from])):
            sign = -1.0 if axis[0] == "-" else 1.0
            along = sign * axes["xyz".index(axis[-1])] @ wanted
            assert along > 0.999 if axis == style.aim or style.up_from != "world:+y" else along > 0.5
        assert np.linalg.det(axes) == pytest.approx(1.0)


def test_the_end_aims_along_the_given_axis() -> None:
    out, joints, _ = made(end_aim=(6.0, 0.0, 2.0), up_from="world:+y")
    assert_allclose(out.world[joints[2], :2, :3], [[0, 0, 1], [0, 1, 0]], atol=1e-6)
    with pytest.raises(GeometryError, match="along the limb's hinge"):
        made(end_aim=(6.0, 0.0, 2.0))
    with pytest.raises(GeometryError, match="the end joint is at this position"):
        made(end_aim=(6.0, 0.0, 0.0))


@pytest.mark.parametrize("count", [0, 1])
def test_a_count_that_makes_no_bone_is_reported(count: int) -> None:
    words = f"here is {count}" if count else "give the positions of the joints"
    with pytest.raises(UsageError, match=words):
        made(((0.0, 0.0, 0.0),) * count)


def test_positions_are_given_once() -> None:
    with pytest.raises(UsageError, match="--locators and --points both"):
        made(((0.0, 0, 0), (1.0, 0, 0), (2.0, 0, 0)), locators=("hips", "spine", "head"))


def test_points_on_a_line_need_a_bend_direction() -> None:
    line = ((0.0, 0, 0), (1.0, 0, 0), (2.0, 0, 0))
    with pytest.raises(GeometryError, match=r"lie on a line.*--bend"):
        made(line)
    out, joints, report = made(line, bend=(1.0, 0.0, 3.0))
    assert_allclose(out.world[joints[0], :3, :3], [[1, 0, 0], [0, 1, 0], [0, 0, 1]], atol=1e-6)
    assert_allclose(out.world[pole(out), 3, :3], [1, 0, 1], atol=1e-6)
    assert report.limbs[0]["source"] == "given"
    assert out.metadata[joints[0]]["source"] == "given"
    with pytest.raises(GeometryError, match="runs along the limb"):
        made(line, bend=(1.0, 0.0, 0.01))
    assert [n.code for n in made(bend=(0.0, 1.0, 0.0))[2].warnings] == ["bend-not-needed"]


@pytest.mark.parametrize(
    ("points", "which"),
    [
        (((0, 0, 0), (0, 0, 0), (1, 0, 0)), "0,0,0 and 0,0,0 are"),
        (((0, 0, 0), (1, 0, 0), (1, 1e-9, 0)), "1,0,0 and 1,1e-09,0 are"),
        (((0, 0, 0), (1, 0, 0), (0, 0, 0)), "0,0,0 and 0,0,0, root and end, are"),
    ],
)
def test_points_at_one_place_are_reported(points: Any, which: str) -> None:
    with pytest.raises(GeometryError, match=f"{which} at one place"):
        made(points)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_a_limb_is_the_same_in_any_unit(scale: float) -> None:
    out, joints, _ = made(tuple(map(tuple, (np.array(ARM) * scale).tolist())))
    for joint, other in zip(joints, made()[1], strict=True):
        assert_allclose(out.world[joint, :3, :3], made()[0].world[other, :3, :3], atol=1e-6)


def test_a_longer_chain_is_laid_into_the_plane_and_reports_how_far() -> None:
    """The farthest of the inner points, the third, says where the plane is: z = 0."""
    points = ((0.0, 0, 0), (1.0, 1, 0.25), (2.0, 2, 0), (3.0, 1, -0.5), (4.0, 0, 0))
    out, joints, report = made(points, planar=True)
    assert_allclose(out.world[joints, 3, 2], 0.0, atol=1e-6)
    assert_allclose([entry["moved"] for entry in report.added], [0, 0.25, 0, 0.5, 0], atol=1e-12)
    normals = out.world[joints, 1, :3]
    assert_allclose(normals, np.tile([0, 0, -1.0], (5, 1)), atol=1e-6)
    note = out.metadata[joints[0]]
    assert note["middle"] == "limb_3"
    assert out.metadata[pole(out)]["chain"] == ["limb_1", "limb_3", "limb_5"]
    assert_allclose(out.world[pole(out), 3, 2], 0.0, atol=1e-6)


def test_a_limb_below_a_joint_joins_its_skins_and_otherwise_has_its_own() -> None:
    body = chain((0, 0, 0), (0, 1, 0))
    out, joints, _ = made(rig=body, parent="b")
    assert out.skins[0].joints.tolist() == [0, 1, *joints]
    alone, joints, _ = made(rig=body)
    assert alone.skins[1].joints.tolist() == joints
    assert alone.skins[1].key is None
    plain, joints, _ = made(rig=body, skin=False)
    assert not plain.is_joint[joints].any()
    with pytest.raises(UsageError, match="--no-skin"):
        made(rig=body, parent="b", skin=False)


def test_locators_may_stand_anywhere_below_rotated_and_scaled_nodes() -> None:
    rig = rig_of(["top", "a", "b", "c"], [-1, 0, 0, 0], np.array([[1.0, 2, 3], *ARM]))
    turn = np.tile([0.0, 0, 0, 1], (4, 1))
    turn[0] = from_axis_angle([1, 2, 3], 0.7)
    rig = replace(rig, rotation=turn, scale=np.array([[2.0] * 3, *np.ones((3, 3))]))
    report = Report()
    out = make_limb(rig, options=MakeLimbOptions(locators=("a", "b", "c"), parent="top"), report=report)
    joints = [out.find(f"limb_{k}") for k in (1, 2, 3)]
    assert_allclose(out.world[joints, 3], out.world[[1, 2, 3], 3], atol=1e-5)
    assert out.metadata[joints[0]]["locators"] == ["a", "b", "c"]
    assert report.added[0]["parent"] == "top"


def test_names_and_sides() -> None:
    out, joints, _ = made(name="arm", side="left")
    assert [out.names[k] for k in joints] == ["arm_1_L", "arm_2_L", "arm_3_L"]
    out, joints, _ = made(rig=out, name="arm", side="right", names=("shoulder", "elbow", "wrist"))
    assert [out.names[k] for k in joints] == ["shoulder", "elbow", "wrist"]
    assert len(out.skins) == 2
    with pytest.raises(UsageError, match="another node is called 'elbow'"):
        made(rig=out, name="leg", names=("hip", "elbow", "foot"))
    with pytest.raises(UsageError, match="2 names for 3 joints"):
        made(names=("a", "b"))


def test_a_second_run_moves_its_limb() -> None:
    out, joints, _ = made(name="arm")
    moved = tuple((x, y, z + 1.0) for x, y, z in ARM)
    again, same, report = made(moved, rig=out, name="arm")
    assert same == joints
    assert len(again) == len(out)
    assert not any(entry["new"] for entry in report.added)
    assert_allclose(again.world[joints, 3, :3], moved, atol=1e-6)
    assert_allclose(again.world[pole(again), 3, 2], 1.0, atol=1e-6)
    inverse_bind = again.skins[0].inverse_bind
    assert_allclose(inverse_bind, np.linalg.inv(again.world[joints]), atol=1e-6)
    with pytest.raises(UsageError, match="'arm' has 3 joints, and here are 4 points"):
        made((*ARM, (7.0, 1.0, 0.0)), rig=out, name="arm", planar=True)
    with pytest.raises(UsageError, match="keeps its name"):
        made(rig=out, name="arm", names=("a", "b", "c"))
    with pytest.raises(UsageError, match="is a child of 'rigtri_controls'"):
        made(rig=out, name="arm", parent="arm_1_pole" if out.has("arm_1_pole") else "arm_2")


def test_a_second_run_changes_nothing_below_a_slightly_sheared_parent() -> None:
    """Exporters leave shears of 1e-5. Before, a second run turned the joints about by rounding."""
    rig = rig_of(["leg"], [-1], np.zeros((1, 3)), np.array([[0.0, 0, 0, 1]]))
    leaning = np.array([[[0.6, 0.8, 0, 0], [-0.8, 0.6, 0, 0], [1e-5, 2e-5, 1, 0], [0.1, 0.2, 0.3, 1]]])
    rig = replace(rig, matrix=leaning, has_matrix=np.array([True]))
    out, joints, _ = made(rig=rig, parent="leg")
    matrix, has_matrix = out.local.copy(), out.has_matrix.copy()
    has_matrix[joints] = True  # as UsdSkel holds them
    out = replace(out, matrix=matrix, has_matrix=has_matrix)
    again, same, _ = made(rig=out)
    assert same == joints
    assert (again.local == out.local).all()
    assert (again.skins[0].inverse_bind == out.skins[0].inverse_bind).all()


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_new_file_is_whole_and_a_second_run_has_its_bytes(suffix: str, tmp_path: Path) -> None:
    out, again = tmp_path / f"arm{suffix}", tmp_path / f"again{suffix}"
    arguments = ["--points", "0,140,0", "25,140,-5", "50,140,-1", "--name", "arm"]
    for words in (["-o", out], [out, "-o", again]):
        cli("make-limb", *words, *arguments, code=0)
    assert again.read_bytes() == out.read_bytes()
    rig = read(out).rig
    assert_allclose(rig.world[rig.find("arm_3"), 3, :3], [50, 140, -1], atol=1e-4)
    assert [rig.names[k] for k in rig.skins[0].joints] == ["arm_1", "arm_2", "arm_3"]
    for note in rig.metadata.values():
        validator("node").validate(note)
    if "usd" in suffix:
        stage = Usd.Stage.Open(str(out))
        assert UsdGeom.GetStageUpAxis(stage) == "Y"
        assert UsdGeom.GetStageMetersPerUnit(stage) == 0.01
        assert not usd_errors(out)
    else:
        assert not khronos_errors(out)[0]


def test_a_new_usd_file_has_the_units_that_are_requested(tmp_path: Path) -> None:
    out = tmp_path / "arm.usda"
    words = ["make-limb", "-o", str(out), "--points", "0,0,1", "1,-.2,1", "2,0,1"]
    cli(*words, "--up-axis", "z", "--meters-per-unit", "1", code=0)
    stage = Usd.Stage.Open(str(out))
    assert (UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)) == ("Z", 1.0)
    cli("make-limb", "-o", tmp_path / "a.glb", *words[3:], "--up-axis", "z", code=2)


def test_usdskel_finds_the_new_skeleton_where_it_stands(tmp_path: Path) -> None:
    blank, out = tmp_path / "blank.usda", tmp_path / "out.usda"
    write_blank(blank)
    edit(blank, out, lambda rig, _: make_limb(rig, options=MakeLimbOptions(points=ARM)), options=TRUSTING)
    stage, cache = Usd.Stage.Open(str(out)), UsdSkel.Cache()
    cache.Populate(UsdSkel.Root(stage.GetPrimAtPath("/Root")), Usd.PrimDefaultPredicate)
    query = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Root/rigtri/limb")))
    places = [m.ExtractTranslation() for m in query.ComputeJointSkelTransforms(Usd.TimeCode.Default())]
    assert_allclose(places, ARM, atol=1e-6)


def test_a_scene_of_locators_alone_gets_its_limb_in_usd_too(tmp_path: Path) -> None:
    source, out = tmp_path / "in.usda", tmp_path / "out.usda"
    stage = Usd.Stage.CreateNew(str(source))
    for name, place in zip("abc", ARM, strict=True):
        UsdGeom.XformCommonAPI(UsdGeom.Xform.Define(stage, f"/{name}")).SetTranslate(place)
    stage.Save()
    with pytest.raises(FileError, match="no skeleton"):
        read(source)
    words = ["make-limb", str(source), "-o", str(out), "--locators", "a", "b", "/c"]
    cli(*words, code=0)
    rig = read(out).rig
    assert_allclose(rig.world[rig.skins[0].joints, 3, :3], ARM, atol=1e-6)


def test_words_of_lists_are_taken_up_to_the_next_option() -> None:
    words = ["in.glb", "--points", "-1,0,0", "-.5,1,0", "0,0,0", "--name", "a", "-o", "out.glb"]
    points = ["--points=-1,0,0", "--points=-.5,1,0", "--points=0,0,0"]
    assert spread(words) == ["in.glb", *points, "--name", "a", "-o", "out.glb"]


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (["--points", "0,0,0"], 2, "here is 1"),
        (["--points", "0,0,0", "1,1,0", "2,0,zero"], 2, "not a valid point"),
        (["--points", "0,0,0", "1,1,0", "nan,0,0"], 2, "not a finite number"),
        (["--locators", "a", "b", "c"], 2, "give IN"),
        (["--points", "0,0,0", "1,1,0", "2,0,0", "--no-pole", "--reach", "2"], 2, "--reach is for the pole"),
        (["--points", "0,0,0", "1,1,0", "2,0,0", "--preset", "vrm", "--up", "z"], 2, "leave out --aim"),
        (["--points", "0,0,0", "1,1,0", "2,0,0", "--aim", "y"], 2, "same letter"),
        (["--points", "0,0,0", "1,1,0", "2,0,0", "--up-from", "moon"], 2, "none of plane"),
        (["--points", "0,0,0", "1,1,0", "2,0,0", "--parent", "hips"], 2, "--parent names nodes of a file"),
        (["--points", "0,0,0", "1,1,0", "2,0,0", "--edit-target", "bare"], 2, "there is no IN"),
    ],
)
def test_a_users_mistake_is_reported_and_nothing_written(
    words: list[str], code: int, told: str, tmp_path: Path
) -> None:
    result = cli("make-limb", "-o", tmp_path / "out.usda", *words)
    assert result.exit_code == code, result.output
    assert told in result.output
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("name", "plain"), [("1-2", "_1_2"), ("my limb", "my_limb")])
def test_a_name_that_cannot_be_as_given_is_reported(name: str, plain: str, samples: Path) -> None:
    report = Report()
    points = ((0.3, 1.2, -0.2), (0.5, 1.0, -0.3), (0.6, 0.7, -0.25))
    wanted = MakeLimbOptions(points=points, name=name)
    assert make_limb(read(samples / "biped.glb").rig, options=wanted).has(f"{name}_1")
    out = make_limb(read(samples / "biped.usda").rig, options=wanted, report=report)
    assert out.has(f"{plain}_1")
    with pytest.raises(UsageError, match=f"another node is called '{plain}_1'"):
        make_limb(out, options=replace(wanted, name=plain))
    told = [notice.text for notice in report.warnings if notice.code == "name-changed"]
    assert len(told) == 1
    assert f"'{name}' becomes '{plain}'" in told[0]


def test_the_pole_vector_can_be_a_joint_of_the_limbs_skin(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    points = ((0.0, 1.0, -0.2), (0.0, 0.8, -0.3), (0.0, 0.6, -0.2))
    wanted = MakeLimbOptions(points=points, name="tail", parent="hips", as_="joint")
    out = make_limb(rig, options=wanted)
    pole = out.find("tail_2_pole")
    assert out.is_joint[pole]
    assert make_limb(out, options=wanted).names == out.names


def test_locators_are_read_in_the_pose_that_is_named(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    names = ("upper_arm_L", "forearm_L", "hand_L")
    found = {}
    for pose in ("nodes", "walk@0.5"):
        out = make_limb(rig, options=MakeLimbOptions(locators=names, name="copy", pose=pose))
        found[pose] = out.world[[out.find(f"copy_{k}") for k in (1, 2, 3)], 3, :3]
    there = worlds(rig, locals_at(rig, rig.clip("walk"), [0.5]))[0]
    assert_allclose(found["walk@0.5"], there[[rig.find(name) for name in names], 3, :3], atol=1e-9)
    assert np.abs(found["walk@0.5"] - found["nodes"]).max() > 0.01
    with pytest.raises(UsageError, match="--pose is for locators"):
        MakeLimbOptions(points=((0, 0, 0), (1, 1, 0), (2, 0, 0)), pose="bind").check(())


def test_a_limb_beside_a_plain_hierarchy_of_usd_stays_readable_with_its_root(
    samples: Path, tmp_path: Path
) -> None:
    """Before, the skeleton of the new limb made --root of the same hierarchy an error."""
    out, root = tmp_path / "out.usda", ("--root", "/arm")
    points = ("--points", "0,0,0", "0,1,0.1", "0,2,0")
    cli(
        "make-limb",
        samples / "arm.usda",
        "-o",
        out,
        *points,
        "--name",
        "leg",
        "--side",
        "left",
        *root,
        code=0,
    )
    assert "leg_1_L" in cli("inspect", out, *root, code=0).stdout


# --- chains and guides


def _chain(points: Any, **more: Any) -> Rig:
    return rigtri.make_limb(EMPTY, points=tuple(map(tuple, points)), name="tail", **more)


def test_a_curved_chain_keeps_its_points_and_one_normal() -> None:
    points = [(0, 0, 0), (1, 0, 0), (2, 1, 0), (2, 2, 0), (3, 3, 0)]
    rig = _chain(points)
    joints = [rig.find(f"tail_{k}") for k in range(1, 6)]
    assert_allclose(rig.world[joints, 3, :3], points, atol=1e-6)
    bones = np.diff(points, axis=0)
    aims = bones / np.linalg.norm(bones, axis=1)[:, np.newaxis]
    assert_allclose(rig.world[joints[:-1], 0, :3], aims, atol=1e-6)
    # It bends to the left twice and to the right once: one sign, +z, for all joints.
    assert_allclose(rig.world[joints, 1, :3], [(0, 0, 1)] * 5, atol=1e-6)
    assert not rig.nodes_of("poleVector")


def test_joints_of_a_curve_in_space_do_not_roll() -> None:
    turns = np.linspace(0, 6, 20)
    points = np.stack([np.cos(turns), np.sin(turns), 0.2 * turns], axis=1)
    rig = _chain(points)
    world = rig.world[[rig.find(f"tail_{k}") for k in range(1, 20)], :3, :3]
    for one, other in pairwise(world):
        # The least rotation between two bones has its axis across both: nothing about the aim.
        delta = one.T @ other
        axis = np.array([delta[1, 2] - delta[2, 1], delta[2, 0] - delta[0, 2], delta[0, 1] - delta[1, 0]])
        assert abs(axis @ one[0]) < 1e-6


def test_two_joints_take_up_from_the_world() -> None:
    rig = _chain([(0, 0, 0), (2, 0, 0)], up_from="world:+y")
    assert_allclose(rig.world[rig.find("tail_1"), :3, :3], np.eye(3), atol=1e-6)
    assert_allclose(rig.world[rig.find("tail_2"), 3, :3], (2, 0, 0), atol=1e-6)
    with pytest.raises(GeometryError, match=r'up_from="world:\+y", or bend=\(0, 0, 1\)'):
        _chain([(0, 0, 0), (2, 0, 0)])
    with pytest.raises(UsageError, match="no bend"):
        _chain([(0, 0, 0), (2, 0, 0)], pole=True)


def test_a_chain_is_mirrored() -> None:
    rig = rigtri.make_limb(
        EMPTY, points=((1, 0, 0), (2, 0, 0), (3, 1, 0), (4, 1, 0)), name="ear", side="left"
    )
    out = rigtri.mirror(rig, from_side="left")
    assert_allclose(out.world[out.find("ear_3_R"), 3, :3], (-3, 1, 0), atol=1e-6)


GUIDES = {
    "spine": {"points": [[0, 1, 0], [0, 1.2, 0.05], [0, 1.4, 0], [0, 1.6, 0.02]]},
    "clavicle": {
        "points": [[0, 1.5, 0], [0.2, 1.5, 0]],
        "parent": "spine_4",
        "side": "left",
        "up-from": "world:+y",
    },
    "arm": {
        "points": [[0.2, 1.5, 0], [0.5, 1.5, -0.05], [0.8, 1.5, 0]],
        "parent": "clavicle_2_L",
        "side": "left",
        "names": ["upper_arm", "forearm", "hand"],
    },
}
TABLE = """name,joint,x,y,z,parent,side,up-from
spine,,0,1,0,,,
spine,,0,1.2,0.05,,,
spine,,0,1.4,0,,,
spine,,0,1.6,0.02,,,
clavicle,,0,1.5,0,spine_4,left,world:+y
clavicle,,0.2,1.5,0,,,
arm,upper_arm,0.2,1.5,0,clavicle_2_L,left,
arm,forearm,0.5,1.5,-0.05,,,
arm,hand,0.8,1.5,0,,,
"""


@pytest.mark.parametrize("suffix", [".json", ".csv"])
def test_a_file_of_guides_builds_a_skeleton(suffix: str, tmp_path: Path) -> None:
    guides, out = tmp_path / f"guides{suffix}", tmp_path / "out.glb"
    guides.write_text(TABLE if suffix == ".csv" else json.dumps(GUIDES), "utf-8")
    result = cli("make-limb", "-o", out, "--guides", guides)
    assert result.exit_code == 0, result.stderr
    rig = read(out).rig
    assert [
        rig.names[int(rig.parents[rig.find(name)])] for name in ("clavicle_1_L", "upper_arm", "hand")
    ] == [
        "spine_4",
        "clavicle_2_L",
        "forearm",
    ]
    assert [rig.names[node] for node in rig.nodes_of("poleVector")] == ["forearm_pole"]
    assert_allclose(rig.world[rig.find("hand"), 3, :3], (0.8, 1.5, 0), atol=1e-6)
    again = tmp_path / "again.glb"
    assert cli("make-limb", out, "-o", again, "--guides", guides).exit_code == 0
    assert again.read_bytes() == out.read_bytes()


def test_a_pattern_means_locators_in_the_order_of_their_numbers() -> None:
    names = ["tail_10_loc", "tail_2_loc", "tail_1_loc", "other"]
    places = np.array([[2.0, 1, 0], [1, 0, 0], [0, 0, 0], [9, 9, 9]])
    rig = rig_of(names, [-1] * 4, places, np.tile([0.0, 0, 0, 1], (4, 1)))
    out = rigtri.make_limb(rig, locators=("tail_*_loc",), name="tail")
    assert_allclose(
        out.world[[out.find(f"tail_{k}") for k in (1, 2, 3)], 3, :3], places[[2, 1, 0]], atol=1e-6
    )


def _guide_nodes(*named: tuple[str, int, tuple[float, float, float]]) -> Rig:
    """Locators by their names, parents and places in the world."""
    names, parents, places = [each[0] for each in named], [each[1] for each in named], []
    for _, parent, place in named:
        above = np.zeros(3) if parent < 0 else np.array(named[parent][2])
        places.append(np.array(place) - above)
    return rig_of(names, parents, np.array(places), np.tile([0.0, 0, 0, 1], (len(names), 1)))


def test_nodes_that_a_pattern_means_are_guides_of_a_skeleton() -> None:
    # The arm first: a limb below another one waits for it.
    rig = _guide_nodes(
        ("all", -1, (0, 0, 0)),
        ("arm_2_L_loc", 0, (0.5, 1.5, -0.05)),
        ("spine_1_loc", 0, (0, 1, 0)),
        ("spine_2_loc", 2, (0, 1.2, 0.05)),
        ("spine_3_loc", 3, (0, 1.5, 0)),
        ("arm_1_L_loc", 4, (0.2, 1.5, 0)),
        ("arm_3_L_loc", 1, (0.8, 1.5, 0)),
    )
    out = rigtri.make_limb(rig, guide_nodes="*_loc")
    arm = [out.find(f"arm_{k}_L") for k in (1, 2, 3)]
    assert [out.names[int(out.parents[k])] for k in arm] == ["spine_3", "arm_1_L", "arm_2_L"]
    assert_allclose(out.world[arm, 3, :3], rig.world[[5, 1, 6], 3, :3], atol=1e-6)
    assert [out.names[node] for node in out.nodes_of("poleVector")] == ["spine_2_pole", "arm_2_L_pole"]


_TRUNK = (("spine_1_loc", -1, (0, 1, 0)), ("spine_2_loc", 0, (0, 1.2, 0.05)), ("spine_3_loc", 1, (0, 1.5, 0)))


def _clavicle(side: str, first: int) -> tuple[tuple[str, int, tuple[float, float, float]], ...]:
    sign = 1.0 if side == "L" else -1.0
    return (
        (f"clavicle_1_{side}_loc", 2, (0.05 * sign, 1.5, 0)),
        (f"clavicle_2_{side}_loc", first, (0.2 * sign, 1.5, 0)),
    )


def test_a_clavicle_of_two_nodes_rolls_as_the_arm_that_continues_it() -> None:
    """Two points show no plane. Before, they were refused."""
    arm = (
        ("arm_1_L_loc", 4, (0.2, 1.5, 0)),
        ("arm_2_L_loc", 5, (0.5, 1.5, -0.05)),
        ("arm_3_L_loc", 6, (0.8, 1.5, 0)),
    )
    out = rigtri.make_limb(_guide_nodes(*_TRUNK, *_clavicle("L", 3), *arm), guide_nodes="*_loc")
    hinge = out.world[out.find("arm_1_L"), 1, :3]
    assert_allclose(out.world[out.find("clavicle_1_L"), :3, :3], [[1, 0, 0], hinge, [0, 0, -1]], atol=1e-6)
    assert_allclose(hinge, (0, -1, 0), atol=1e-6)
    # It keeps them where it alone is built again.
    points = ((0.05, 1.5, 0), (0.2, 1.5, 0.0))
    again = rigtri.make_limb(out, points=points, name="clavicle", side="left")
    assert_allclose(again.world, out.world, atol=1e-6)


def test_a_clavicle_without_an_arm_rolls_with_its_parent_mirrored_on_the_other_side() -> None:
    rig = _guide_nodes(*_TRUNK, *_clavicle("L", 3), *_clavicle("R", 5))
    out = rigtri.make_limb(rig, guide_nodes="*_loc")
    left, right = (out.world[out.find(f"clavicle_1_{side}"), 1, :3] for side in "LR")
    # The trunk bends about the lateral axis; from its last bone, (0, 0.3, -0.05), to the lateral line.
    assert_allclose(left, np.array([0, 6, -1]) / np.sqrt(37), atol=1e-6)
    assert_allclose(right, -left, atol=1e-6)  # axes of rotation: they turn both ahead


@pytest.mark.parametrize(
    ("rig", "words"),
    [
        (_guide_nodes(("hip_loc", -1, (0, 0, 0))), "guide_nodes=.*: 'hip_loc' has no number"),
        (_guide_nodes(("a_1_loc", -1, (0, 0, 0))), "guide_nodes=, a: .*two or more"),
        (_guide_nodes((f"{'9' * 4400}_loc", -1, (0, 0, 0))), "two or more"),
        (
            _guide_nodes(
                ("a_2_loc", -1, (0, 0, 0)),
                ("b_1_loc", 0, (1, 0, 0)),
                ("b_2_loc", -1, (2, 0, 0)),
                ("a_1_loc", 2, (3, 0, 0)),
            ),
            "'a', 'b' are each below one another",
        ),
    ],
)
def test_nodes_that_are_no_guides_are_refused_by_name(rig: Rig, words: str) -> None:
    with pytest.raises(UsageError, match=words):
        rigtri.make_limb(rig, guide_nodes="*_loc")


def test_controls_move_limbs_that_were_built_by_ik() -> None:
    """Before, they got FK alone with --whole-character, and nothing with --limbs auto."""
    spine, arm = (
        ((0, 1, 0), (0, 1.2, 0.02), (0, 1.4, 0), (0, 1.6, 0)),
        ((0.2, 1.4, 0), (0.5, 1.4, -0.05), (0.8, 1.4, 0)),
    )
    rig = rigtri.make_limb(EMPTY, guides={"spine": spine, "arm_L": {"points": arm, "parent": "spine_3"}})
    for options in ({"whole_character": True}, {"limbs": "auto"}):
        built = rigtri.add_controls(rig, **options)
        (end,) = [one.joint for one in built.records(ControlRecord).values() if one.kind == "ik"]
        assert end == "arm_L_3"
        assert built.find("arm_L_2_pole") == rig.find("arm_L_2_pole")
        np.testing.assert_array_equal(rigtri.add_controls(built, **options).local, built.local)


def test_a_limb_of_guides_named_as_parent_is_its_last_joint() -> None:
    """Before, there was no such node, which was told only where the first limb bends."""
    clavicle, arm = [(0, 1.4, 0), (0.2, 1.42, 0)], [(0.2, 1.42, 0), (0.5, 1.42, -0.05), (0.8, 1.42, 0)]
    by_limb, by_joint = (
        rigtri.make_limb(EMPTY, guides={"clav": clavicle, "arm": {"points": arm, "parent": parent}})
        for parent in ("clav", "clav_2")
    )
    assert by_limb.names == by_joint.names
    np.testing.assert_array_equal(by_limb.parents, by_joint.parents)
    np.testing.assert_array_equal(by_limb.local, by_joint.local)


def test_controls_of_no_limb_are_refused() -> None:
    """Before, a file was written as it was, with "0 controls ()"."""
    rig = rigtri.make_limb(EMPTY, points=((0, 0, 0), (0, 1, 0)), up_from="world:+x")
    with pytest.raises(NoLimbError, match=r"Name the limbs with ik=\(ROOT"):
        rigtri.add_controls(rig, limbs="auto")


def test_a_straight_limb_among_guides_is_reported_where_its_bend_goes(tmp_path: Path) -> None:
    points = [[0, 1, 0], [1, 1, 0], [2, 1, 0]]
    with pytest.raises(GeometryError, match=r"lie on a line.*key of 'arm', \"bend\": \[0, 0, 1\]"):
        rigtri.make_limb(EMPTY, guides={"arm": points})
    rig = rigtri.make_limb(EMPTY, guides={"arm": {"points": points, "bend": [0, 0, 1]}})
    assert "arm_2_pole" in rig.names


def test_up_from_is_advised_for_a_straight_chain_and_not_for_a_straight_limb() -> None:
    """Which way a limb bends, and so where its pole vector stands, no up direction says."""
    points = [[0, 1, 0], [1, 1, 0], [2, 1, 0]]
    for guides in ({"arm": points}, {"arm": {"points": points, "up-from": "world:+z"}}):
        with pytest.raises(GeometryError) as refused:
            rigtri.make_limb(EMPTY, guides=guides)
        assert '"up-from"' not in str(refused.value)
    assert "leaves the bend direction open, also with" in str(refused.value)
    with pytest.raises(GeometryError, match=r'key of \'tail\', "bend": \[0, 0, 1\] or "up-from"'):
        rigtri.make_limb(EMPTY, guides={"tail": [*points, [3, 1, 0]]})
    with pytest.raises(GeometryError, match=r"^arm: .* are at one place.*no bone between them$"):
        rigtri.make_limb(EMPTY, guides={"arm": [points[0], points[0], points[1]]})


@pytest.mark.parametrize(
    ("guides", "words"),
    [
        ({}, "NAME"),
        ({"arm": [[0, 0, 0]]}, "arm: .*two or more"),
        ({"arm": {"points": [[0, 0, 0], [1, 0, 0]], "colour": 1}}, "colour"),
        ([{"name": "a", "x": "1", "y": "b", "z": "0"}], "row 1, a"),
        ([{"x": "1"}], "row 1"),
    ],
)
def test_what_is_no_guide_is_refused_by_name(guides: Any, words: str) -> None:
    with pytest.raises(UsageError, match=words):
        rigtri.make_limb(EMPTY, guides=guides)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("more.csv", "name,x,y,z\narm,0,0,0,left\n", "row 1: it has more cells than the header"),
        ("columns.csv", "name,x,x,z\narm,0,0,0\n", "two columns 'x'"),
        ("digits.csv", "name,x,y,z\narm,1_0,0,0\n", "row 1, arm, column x: '1_0' is not a number"),
        ("arabic.csv", "name,x,y,z\narm,٣,0,0\n", "row 1, arm, column x: '٣' is not a number"),
        ("twice.json", '{"arm": [[0, 0, 0]], "arm": [[0, 1, 0]]}', "'arm' is there twice"),
    ],
)
def test_guides_that_say_more_than_is_read_are_refused(
    name: str, content: str, words: str, samples: Path, tmp_path: Path
) -> None:
    guides = tmp_path / name
    guides.write_text(content, "utf-8")
    out = tmp_path / "out.glb"
    told = cli("make-limb", samples / "biped.glb", "-o", out, "--guides", guides).stderr
    assert words in told
    assert not out.exists()


@pytest.mark.parametrize(
    ("given", "read"),
    [
        ({"points": "0,1,2 3,4,5", "bend": "0,0,1"}, {"points": ((0, 1, 2), (3, 4, 5)), "bend": (0, 0, 1)}),
        ({"points": [[0, 1, 2]], "bend": None}, {"points": [[0, 1, 2]], "bend": None}),
        ({"end_aim": ["x", "child"]}, {"end_aim": ("x", "child")}),
        ({"end_aim": "x", "name": "1,2,3"}, {"end_aim": "x", "name": "1,2,3"}),
    ],
)
def test_guides_have_points_as_words_or_numbers(given: dict[str, Any], read: dict[str, Any]) -> None:
    assert _readable(given) == read


def test_words_of_guides_that_are_no_points_are_refused() -> None:
    with pytest.raises(UsageError):
        _readable({"points": "0,1"})
