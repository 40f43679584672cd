"""mirror: one side gets what the other has; joints stay in place and nothing else moves."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gltf_files import glb_bytes, glb_parts
from numpy.testing import assert_allclose
from places import slow
from posed_bodies import Pose, posed_body
from program import cli
from pxr import Gf, Sdf, Usd, UsdGeom

from rigtri.errors import GeometryError, NameNotFoundError
from rigtri.formats import read
from rigtri.frames import Mirror
from rigtri.frames.mirroring import Across, mirrored_axes
from rigtri.maths.matrices import from_frame, nearest_rotation
from rigtri.maths.matrices import multiply as matmul
from rigtri.maths.quaternions import from_axes, from_axis_angle, multiply, to_axes, unit
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.mirror.mirror import MirrorOptions, mirror
from rigtri.operations.mirror.symmetry_check import Asymmetry, Pair, asymmetry
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit
from rigtri.recognition.limbs import given
from rigtri.recognition.sides import side_of, twin_of
from rigtri.report import Report

MODES: tuple[Mirror, ...] = ("behavior", "orientation", "blender")
REFLECT = np.array([-1.0, 1.0, 1.0])


@pytest.mark.parametrize(
    ("mode", "x", "y", "z"),
    [
        # A left upper arm that aims +x with y up and z forward, and its right twin by hand.
        ("behavior", (1, 0, 0), (0, -1, 0), (0, 0, -1)),
        ("orientation", (1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ("blender", (1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ],
)
def test_the_twin_of_the_world_s_axes_by_hand(mode: Mirror, x: list[int], y: list[int], z: list[int]) -> None:
    assert_allclose(mirrored_axes(np.eye(3), mode, Across()), [x, y, z])


@pytest.mark.parametrize("mode", MODES)
def test_mirroring_twice_gives_the_axes_back(mode: Mirror) -> None:
    axes = to_axes(unit(np.random.default_rng(1).normal(size=(9, 4))))
    once = mirrored_axes(axes, mode, Across())
    assert_allclose(mirrored_axes(once, mode, Across()), axes)
    assert_allclose(np.linalg.det(once), 1.0)


@pytest.mark.parametrize("name", ["biped.glb", "biped.usda"])
@pytest.mark.parametrize("mode", MODES)
def test_the_axes_of_twins_are_mirror_images(samples: Path, name: str, mode: Mirror) -> None:
    options = MirrorOptions(mode=mode)
    out = mirror(read(samples / name).rig, options=options)
    found = asymmetry(out, options=options)
    bones = ["clavicle", "upper_arm", "forearm", "hand", "fingers", "thigh", "shin", "foot", "toe"]
    assert [pair.node for pair in found.pairs] == [f"{bone}_L" for bone in bones]
    assert [pair.twin for pair in found.pairs] == [f"{bone}_R" for bone in bones]
    assert not found.worse(tolerance=1e-5, degrees=1e-4)


@pytest.mark.parametrize(("name", "count"), [("forearm_L", 1), ("forearm_R", 0), ("spine", 0)])
def test_a_joint_that_the_file_holds_is_reported(samples: Path, name: str, count: int) -> None:
    rig, report = read(samples / "biped.glb").rig, Report()
    joint = rig.find(name)
    rig = replace(rig, rules=replace(rig.rules, fixed={joint: "an extension holds it"}))
    out = mirror(rig, options=MirrorOptions(from_side="right"), report=report)
    assert_allclose(out.world[joint], rig.world[joint], atol=1e-6)
    found = [notice.text for notice in report.warnings if notice.code == "fixed"]
    assert found == [f"skipped: {name}: an extension holds it"] * count


def test_equal_rotations_of_behaviour_mirrored_joints_give_a_mirrored_skin(samples: Path) -> None:
    """The law of the mode: the same delta in both joints' frames mirrors every point that they carry."""
    out = mirror(read(samples / "biped.glb").rig)
    joints = [k for k in np.flatnonzero(out.is_joint).tolist() if side_of(out, k) == "left"]
    twins = [twin_of(out, joint) for joint in joints]
    turns = np.random.default_rng(7)
    rotation = out.rotation.copy()
    for joint, other in zip(joints, twins, strict=True):
        assert other is not None
        delta = from_axis_angle(turns.normal(size=3), 0.8)
        rotation[joint], rotation[other] = (multiply(rotation[k], delta) for k in (joint, other))
    posed = replace(out, rotation=rotation).world
    here, there = posed[joints, 3, :3], posed[twins, 3, :3]  # type: ignore[index]
    assert np.ptp(here - out.world[joints, 3, :3]) > 0.1
    assert_allclose(here * REFLECT, there, atol=1e-6)


def left_arm(rig: Rig) -> Rig:
    limb = given(rig, "upper_arm_L", "forearm_L", "hand_L")
    options = AddControlsOptions(
        chain=(("clavicle_L", "hand_L"),),
        ik=(limb,),
        shape={"fk": "square"},
        reach=1.25,
    )
    return add_controls(rig, options=options)


def test_what_one_arm_has_the_other_gets(samples: Path) -> None:
    out = mirror(left_arm(read(samples / "biped.glb").rig))
    for name in ("clavicle", "upper_arm", "forearm", "hand"):
        control = out.find(f"{name}_R_ctl", "node")
        note = out.metadata[control]
        assert (note["joint"], note["side"], note["shape"]) == (f"{name}_R", "right", "square")
        joint = out.world[out.find(f"{name}_R")]
        assert_allclose(out.world[control, 3, :3], joint[3, :3], atol=1e-6)
    assert out.metadata[out.find("hand_R_ik_ctl", "node")]["chain"] == ["upper_arm_R", "forearm_R", "hand_R"]
    here, there = (out.world[out.find(f"forearm_{s}_pole", "node")] for s in "LR")
    assert out.metadata[out.find("forearm_R_pole", "node")]["reach"] == 1.25
    assert_allclose(here[3, :3] * REFLECT, there[3, :3], atol=1e-6)


def test_what_an_animator_has_set_is_mirrored(samples: Path) -> None:
    rig = mirror(left_arm(read(samples / "biped.glb").rig))
    control = rig.find("upper_arm_L_ctl", "node")
    rotation, translation = rig.rotation.copy(), rig.translation.copy()
    rotation[control] = from_axis_angle(np.array([0.2, 1.0, -0.4]), 0.7)
    translation[control] = (0.05, 0.02, -0.01)
    out = mirror(replace(rig, rotation=rotation, translation=translation))
    posed = out.world
    for name in ("upper_arm_{}_ctl", "forearm_{}_ctl", "hand_{}_ctl"):
        here, there = (posed[out.find(name.format(s), "node")] for s in "LR")
        assert_allclose(here[3, :3] * REFLECT, there[3, :3], atol=1e-6)
        wanted = mirrored_axes(nearest_rotation(here), "behavior", Across())
        assert_allclose(nearest_rotation(there), wanted, atol=1e-6)
    assert posed[control, 3, 0] != rig.world[control, 3, 0]
    again = mirror(out)
    assert np.array_equal(again.rotation, out.rotation)
    assert np.array_equal(again.translation, out.translation)


def test_the_other_way_round_and_in_another_plane() -> None:
    frame = from_frame(np.eye(3), np.array([1.0, 2.0, 3.0]))
    assert_allclose(Across((0.0, 1.0, 0.0)).points(frame[3, :3]), [1, -2, 3])
    assert_allclose(Across((0.0, 0.0, 1.0), 0.5).points(frame[3, :3]), [1, 2, -2])


def test_the_left_is_reoriented_from_the_right(samples: Path) -> None:
    report = Report()
    mirror(read(samples / "biped.glb").rig, options=MirrorOptions(from_side="right"), report=report)
    turned = {entry["joint"] for entry in report.joints if entry["status"] == "turned"}
    assert turned
    assert all(name.endswith("_L") for name in turned)


def test_only_what_is_named_is_mirrored(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    report = Report()
    mirror(rig, options=MirrorOptions(joints=("thigh_L",)), report=report)
    assert [e["joint"] for e in report.joints if e["status"] == "turned"] == ["thigh_R"]
    pole = add_polevector(
        rig, options=AddPolevectorOptions(limb=(given(rig, "thigh_L", "shin_L", "foot_L"),))
    )
    out = mirror(pole, options=MirrorOptions(what=("polevectors",)))
    assert np.array_equal(out.rotation[: len(rig)], rig.rotation)
    assert out.has("shin_R_pole")


def test_names_that_are_not_there_and_files_without_sides_are_errors(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    with pytest.raises(NameNotFoundError):
        mirror(rig, options=MirrorOptions(joints=("thigh_X",)))
    with pytest.raises(GeometryError, match="says left or right"):
        mirror(read(samples / "tail.glb").rig)


def test_check_reports_what_is_not_symmetric(samples: Path, tmp_path: Path) -> None:
    plain, out = str(samples / "biped.glb"), str(tmp_path / "out.glb")
    before = cli("mirror", plain, "--check", "--json", code=1)
    said = json.loads(before.stdout)
    assert not said["symmetric"]
    assert {pair["node"] for pair in said["asymmetric"]} >= {"thigh_L", "upper_arm_L"}
    cli("mirror", plain, "-o", out, code=0)
    after = cli("mirror", out, "--check", "--json", code=0)
    assert json.loads(after.stdout)["symmetric"]


@pytest.mark.parametrize(
    ("preset", "mode", "expected"),
    [
        ("article", None, "y-reversed"),
        ("unreal-editor", None, "y-reversed"),
        ("mgear", None, "z-reversed"),
        ("blender", None, "blender"),
        ("vrm", None, "orientation"),
        ("article", "behavior", "behavior"),
        ("article", "orientation", "orientation"),
        ("mgear", "blender", "blender"),
    ],
)
def test_check_finds_the_convention_of_a_symmetric_body(
    preset: str, mode: Mirror | None, expected: str
) -> None:
    rig = orient_joints(posed_body(Pose(knee=5.0, elbow=5.0)).rig, preset=preset)
    if mode is not None:
        rig = mirror(rig, mode=mode)
    found = asymmetry(rig)
    assert found.mode == expected
    assert len(found.pairs) > 20
    assert found.worse() == []
    other = "behavior" if expected != "behavior" else "orientation"
    assert len(asymmetry(rig, mode=other).worse()) > 10


def test_check_finds_the_convention_that_noise_hides_where_one_pair_keeps_another_exactly() -> None:
    """Of a body that was measured, no pair is exact but one whose axes are those of the world."""
    rig = orient_joints(posed_body(Pose(knee=5.0, elbow=5.0)).rig, preset="article")
    rotation, (kept, there) = (
        rig.rotation.copy(),
        (rig.find(f"mixamorig:{side}ToeBase") for side in ("Left", "Right")),
    )
    for joint in (k for k in range(len(rig)) if "Right" in rig.names[k]):
        rotation[joint] = multiply(from_axis_angle([0.6, 0.0, 0.8], np.radians(0.6)), rotation[joint])
    bare = replace(rig, rotation=rotation)
    for joint in (kept, there):
        above = nearest_rotation(bare.world[int(rig.parents[joint])])
        rotation[joint] = from_axes(above.T)
    found = asymmetry(replace(rig, rotation=rotation), options=MirrorOptions(pose="nodes"))
    assert found.mode == "y-reversed"
    assert found.keeping <= 1
    worst = sorted(pair.degrees for pair in found.worse())
    assert worst[-1] > 90.0
    assert worst[-3] < 5.0


def test_check_lists_the_worst_pair_first_and_rounding_orders_none() -> None:
    pairs = {
        "a": (0.500005, 1.0),
        "b": (0.500005 - 1e-9, 3.0),
        "c": (0.500005 + 1e-9, 3.0 + 1e-6),
        "d": (0.9, 0.0),
        "e": (0.0, 0.0),
    }
    found = Asymmetry(tuple(Pair(name, f"{name}_r", *off) for name, off in pairs.items()), ())
    assert [pair.node for pair in found.worse()] == ["d", "b", "c", "a"]


def test_check_says_which_convention_it_found_or_was_given(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    cli("orient-joints", samples / "biped.glb", "-o", out, "--preset", "article", code=0)
    document = json.loads(cli("mirror", out, "--check", "--json").stdout)
    assert document["mode"] == "y-reversed"
    assert document["asymmetric"] == []
    given = cli("mirror", out, "--check", "--mode", "behavior", "--json", code=1)
    assert json.loads(given.stdout)["mode"] == "behavior"
    words = cli("mirror", out, "--check").stderr
    assert "axes compared as y-reversed, which most pairs keep" in words


def test_a_run_reports_where_to_write_or_checks(samples: Path, tmp_path: Path) -> None:
    plain = str(samples / "biped.glb")
    assert "give the file to write with -o OUT, or --check" in cli("mirror", plain, code=2).stderr
    both = ["mirror", plain, "--check", "-o", str(tmp_path / "out.glb")]
    assert "--check writes nothing; leave -o out" in cli(*both, code=2).stderr


def moved(name: str, folder: Path, samples: Path) -> Path:
    """The biped, turned by 40° about an oblique axis and carried away by the node above its joints."""
    turn = from_axis_angle(np.array([0.3, 1.0, -0.4]) / np.sqrt(1.25), np.radians(40.0))
    path = folder / name
    if name.endswith(".glb"):
        gltf, binary = glb_parts(samples / name)
        top = next(node for node in gltf["nodes"] if node["name"] == "biped")
        top |= {"translation": [3.0, -1.0, 0.5], "rotation": turn.tolist(), "scale": [2.0, 2.0, 2.0]}
        path.write_bytes(glb_bytes(gltf, binary))
        return path
    stage = Usd.Stage.Open(Sdf.Layer.OpenAsAnonymous(str(samples / name)))
    ops = UsdGeom.Xformable(stage.GetDefaultPrim())
    ops.ClearXformOpOrder()
    ops.AddTranslateOp(opSuffix="away").Set((3.0, -1.0, 0.5))
    ops.AddOrientOp(opSuffix="away").Set(Gf.Quatf(float(turn[3]), *map(float, turn[:3])))
    stage.Export(str(path))
    return path


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
@pytest.mark.parametrize("mode", MODES)
def test_a_character_that_stands_elsewhere_is_mirrored_in_its_own_space(
    name: str, mode: Mirror, samples: Path, tmp_path: Path
) -> None:
    """As the same character at the origin is, seen from the node that carries it."""
    options = MirrorOptions(mode=mode)
    here = mirror(left_arm(read(samples / name).rig), options=options)
    report = Report()
    there = mirror(left_arm(read(moved(name, tmp_path, samples)).rig), options=options, report=report)
    assert not report.warnings
    joint = there.find("hips")
    space = there.world[int(there.parents[joint])]
    assert np.abs(space - np.eye(4)).max() > 0.5
    for node in ("upper_arm_R", "forearm_R", "hand_R", "forearm_R_pole"):
        wanted = matmul(here.world[here.find(node, "node")], space)
        found = there.world[there.find(node, "node")]
        assert_allclose(found[3, :3], wanted[3, :3], atol=4e-6)
        if not node.endswith("pole"):
            assert_allclose(nearest_rotation(found), nearest_rotation(wanted), atol=4e-6)
    found_ = asymmetry(there, options=options)
    assert (found_.plane, found_.at, found_.better) == ("yz", 0.0, None)
    assert not found_.worse(tolerance=1e-5, degrees=1e-3)


def carried(rig: Rig, away: float) -> Rig:
    """The same with its root joint that far along x."""
    translation = rig.translation.copy()
    translation[rig.find("hips"), 0] += away
    return replace(rig, translation=translation, skins=())


def test_the_plane_is_found_between_most_pairs_and_reported(samples: Path) -> None:
    rig, report = carried(left_arm(read(samples / "biped.glb").rig), 2.5), Report()
    out = mirror(rig, options=MirrorOptions(what=("polevectors",), root="biped"), report=report)
    here, there = (out.world[out.find(f"forearm_{s}_pole", "node"), 3, :3] for s in "LR")
    joint = out.world[out.find("forearm_L"), 3, :3] - (2.5, 0, 0)
    assert_allclose(here * REFLECT + (5.0, 0, 0), there, atol=1e-9)
    assert joint[0] > 0.1
    assert [notice.code for notice in report.warnings] == ["mirror-plane"]
    assert "about the plane yz at x = 2.5 in its own space" in report.warnings[0].text
    told = Report()
    asked = MirrorOptions(what=("polevectors",), root="biped", plane_at=2.5)
    again = mirror(rig, options=asked, report=told)
    assert np.array_equal(again.translation, out.translation)
    assert not told.warnings
    assert asymmetry(rig, options=MirrorOptions(root="biped")).at == 2.5


def test_sides_that_lie_about_no_plane_are_a_warning_and_strict_refuses(
    samples: Path, tmp_path: Path
) -> None:
    rig, report = read(samples / "biped.glb").rig, Report()
    mirror(rig, options=MirrorOptions(plane="xy"), report=report)
    assert [(n.code, n.geometry) for n in report.warnings if "plane" in n.code] == [("no-mirror-plane", True)]
    assert asymmetry(rig, options=MirrorOptions(plane="xy")).better == ("yz", 0.0)

    def step(rig: Rig, report: Report) -> Rig:
        return mirror(rig, options=MirrorOptions(plane="xy"), report=report)

    with pytest.raises(GeometryError, match="lie about no xy plane"):
        edit(samples / "biped.glb", tmp_path / "out.glb", step, strict=True)
