"""Plain Xform prims as joints: found with --root, turned by two ops, exactly."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import SAMPLES, slow
from program import cli
from pxr import Gf, Sdf, Usd, UsdGeom
from usd_files import MESH, animation, error_of, read, save, scene, skeleton, skinned, turned, write

from rigtri.errors import FileError, GeometryError, NameNotFoundError
from rigtri.evaluation import sampling
from rigtri.evaluation.sampling import sample
from rigtri.formats.usd.opinions.xform_edits import stands_by, transform_ops
from rigtri.formats.usd.reading.sampled_xforms import matrices_at, sampled_tracks
from rigtri.frames.reframe import reframe
from rigtri.maths.matrices import compose, decompose, nearest_rotation
from rigtri.maths.quaternions import IDENTITY, angle_between, conjugate, from_axis_angle, multiply, unit
from rigtri.model.animation import PATHS, Track
from rigtri.verification.compare.compare import self_check

LEG = """#usda 1.0
def Xform "Rig" {
    double3 xformOp:translate = (0, 9, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    def Xform "thigh" {
        float3 xformOp:rotateXYZ = (10, 20, 30)
        float3 xformOp:rotateXYZ.timeSamples = {1: (10, 20, 30), 9: (50, 0, 10)}
        double3 xformOp:translate = (1, 0, 0)
        float3 xformOp:scale = (1, 2, 1)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ", "xformOp:scale"]
        def Scope "parts" {
            def Xform "shin" {
                matrix4d xformOp:transform = ((0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (0, -4, 0.5, 1))
                uniform token[] xformOpOrder = ["xformOp:transform"]
                def Mesh "bone" {
                    point3f[] points = [(0, 0, 0), (0, 1, 0), (0, 0, 1)]
                }
                def Xform "loose" {
                    double3 xformOp:translate = (5, 5, 5)
                    uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:translate"]
                }
            }
        }
    }
}
"""
SMOOTH = LEG.replace("(1, 2, 1)", "(2, 2, 2)")
MOVES = """#usda 1.0
def Xform "Rig" {
    double3 xformOp:translate.timeSamples = {1: (0, 9, 0), 5: (0, 8, 0)}
    quatf xformOp:orient.timeSamples = {1: (1, 0, 0, 0), 9: (0, 1, 0, 0)}
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]
    def Xform "tip" {
        double3 xformOp:translate = (0, 3, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
}
"""


def places(path: Path) -> dict[tuple[str, float], np.ndarray]:
    """World matrices of all prims at some times, as UsdGeom computes them."""
    stage = Usd.Stage.Open(str(path))
    return {
        (str(prim.GetPath()), time): np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(time))
        for time in (1.0, 3.3, 9.0)
        for prim in stage.Traverse()
        if prim.IsA(UsdGeom.Xformable)
    }


def check_same(one: Path, other: Path, *, still: tuple[str, ...] = ()) -> None:
    """Positions of all prims agree at all times, and whole matrices of those that stand still."""
    before, after = places(one), places(other)
    assert before.keys() == after.keys()
    for (path, time), matrix in before.items():
        rows = slice(None) if path.endswith(still) and still else slice(3, None)
        assert_allclose(after[path, time][rows], matrix[rows], atol=1e-12)


def test_two_ops_rotate_a_prim_and_leave_all_else_where_it_is(tmp_path: Path) -> None:
    source = save(tmp_path, SMOOTH)
    document = read(source, root="/Rig")
    rig = document.rig
    assert [rig.labels[n] for n in rig.skins[0].joints][:3] == ["/Rig", "/Rig/thigh", "/Rig/thigh/parts/shin"]
    assert not rig.skins[0].stored
    out = write(document, turned(rig), tmp_path / "out.usda")
    check_same(source, out, still=("bone",))
    again = read(out, root="Rig")
    assert_allclose(again.rig.world, turned(rig).world, atol=1e-12)
    text = out.read_text()
    # A prim that resets the stack hangs under nobody, so there is nothing to undo on it.
    assert '= ["!resetXformStack!", "xformOp:translate"]' in text
    assert "1: (10, 20, 30)" in text


def test_turning_back_takes_the_ops_away(tmp_path: Path) -> None:
    document = read(save(tmp_path, SMOOTH), root="/Rig")
    rig = document.rig
    thigh = rig.find("thigh")
    there = write(document, turned(rig, only=[thigh]), tmp_path / "there.usda")
    assert "rigtriFrame" in there.read_text()
    again = read(there, root="/Rig")
    turn = np.broadcast_to(IDENTITY, (len(rig), 4)).copy()
    turn[thigh] = conjugate(unit(np.random.default_rng(1).normal(size=(1, 4)))[0])
    back = write(again, reframe(again.rig, turn), tmp_path / "back.usda")
    assert "rigtri" not in back.read_text()
    check_same(tmp_path / "in.usda", back)


def test_meshes_cameras_and_lights_keep_their_axes_and_report_why(tmp_path: Path) -> None:
    rig = read(save(tmp_path, SMOOTH), root="/Rig").rig
    assert "is itself a Mesh" in rig.rules.fixed[rig.find("bone")]
    assert rig.find("shin") not in rig.rules.fixed


def test_animated_translate_and_orient_are_tracks_before_and_after(tmp_path: Path) -> None:
    source = save(tmp_path, MOVES)
    document = read(source, root="/Rig")
    (clip,) = document.rig.clips
    assert [(t.path, t.times.tolist()) for t in clip.tracks] == [
        ("translation", [1, 5]),
        ("rotation", [1, 9]),
    ]
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    check_same(source, out)
    result = self_check(document, read(out, root="/Rig"))
    assert result.passes(1e-9), result.describe()


def test_half_float_rotations_turn_with_what_is_around_them(tmp_path: Path) -> None:
    """Before, refused with 6: they are never unit, and were taken for axes that are scaled and sheared."""
    halves = "{1: (0.96582, 0.247925, 0, 0.0743408), 9: (0.866211, 0.479004, 0, 0.143677)}"
    text = MOVES.replace("quatf", "quath").replace("{1: (1, 0, 0, 0), 9: (0, 1, 0, 0)}", halves)
    text = text.replace('Xform "tip"', 'Cube "tip"').replace("\ndef", '\ndef Xform "Top" {\ndef') + "}\n"
    source, out = save(tmp_path, text), tmp_path / "out.usda"
    cli("freeze", source, "--root", "/Top/Rig", "--up-axis", "z", "-o", out, code=0)
    up = compose([0, 0, 0], from_axis_angle([1, 0, 0], np.pi / 2), [1, 1, 1])
    before, after = places(source), places(out)
    assert before.keys() == after.keys()
    for at, place in before.items():
        if at[0] == "/Top/Rig/tip":
            assert_allclose(after[at][3], (place @ up)[3], atol=1e-12)


def test_one_sample_of_an_op_that_a_track_stands_for_is_a_key_and_survives_a_bake(tmp_path: Path) -> None:
    one, two, three = (tmp_path / f"{name}.usda" for name in ("rigged", "keyed", "baked"))
    cli("auto", SAMPLES / "arm.usda", "-o", one, "--root", "/arm", code=0)
    cli("bake", one, "-o", two, "--root", "/arm", "--to", "controls", code=0)
    cli("bake", two, "-o", three, "--root", "/arm", "--to", "joints", code=0)
    rig = read(three, root="/arm").rig
    (keys,) = (len(track.times) for track in rig.clips[0].tracks if track.node == rig.find("wrist"))
    assert keys == 1


def driven(folder: Path, stack: str) -> Path:
    """A prim that moves by a stack of ops, below one that does; and one beside them that could follow."""
    stage = Usd.Stage.CreateNew(str(folder / "in.usda"))
    UsdGeom.Xform.Define(stage, "/rig")
    places = {"/rig/upper": (0, 1, 0), "/rig/upper/lower": (2, 0, 0), "/rig/child": (3, 2, 1)}
    for path, place in places.items():
        xform = UsdGeom.Xform.Define(stage, path)
        moves = path != "/rig/child"
        if stack == "transform" and moves:
            op = xform.AddTransformOp()
            for time in (0, 10):
                turn = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(0, 0, 1), 10.0 + 4.0 * time))
                op.Set(turn * Gf.Matrix4d().SetTranslate(Gf.Vec3d(*place)), time)
            continue
        xform.AddTranslateOp().Set(Gf.Vec3d(*place))
        kinds = ("RotateZ", "RotateY", "RotateX") if stack == "split" else ("RotateXYZ",)
        for number, kind in enumerate(kinds):
            op = getattr(xform, f"Add{kind}Op")()
            for time in (0, 10) if moves else (0,):
                value = 5.0 * (number + 1) + 6.0 * time
                op.Set(value if stack == "split" else Gf.Vec3f(value, value - 10.0, 3.0 * time), time)
        if stack == "scale" and moves:
            op = xform.AddScaleOp()
            for time in (0, 10):
                op.Set(Gf.Vec3f(1.0 + 0.1 * time), time)
    stage.Save()
    return folder / "in.usda"


@pytest.mark.parametrize("stack", ["euler", slow("split"), "scale", slow("transform")])
def test_drivers_of_any_ops_are_evaluated_as_usd_plays_them(stack: str, tmp_path: Path) -> None:
    source, ruled, baked = driven(tmp_path, stack), tmp_path / "ruled.usda", tmp_path / "baked.usda"
    root = ("--root", "/rig")
    follow = ("--type", "point", "--child", "child", "--driver", "lower")
    cli("constrain", source, "-o", ruled, *root, *follow, code=0)
    cli("bake", ruled, "-o", baked, *root, "--between", "1e-5", code=0)
    one, two = (Usd.Stage.Open(str(path)) for path in (source, baked))

    def place(stage: Usd.Stage, path: str, time: float) -> np.ndarray:
        world = UsdGeom.XformCache(time).GetLocalToWorldTransform(stage.GetPrimAtPath(path))
        return np.array(world)[3, :3]

    offset = place(one, "/rig/child", 0) - place(one, "/rig/upper/lower", 0)
    for time in np.linspace(0.0, 10.0, 23):
        followed = place(one, "/rig/upper/lower", time) + offset
        assert np.abs(place(two, "/rig/child", time) - followed).max() < 1e-4
    cli("orient-joints", source, "-o", tmp_path / "turned.usda", *root, code=0)


@pytest.mark.ci
def test_new_controls_have_ops_to_key_and_euler_keys_of_an_animator_are_baked(tmp_path: Path) -> None:
    rigged, baked = tmp_path / "rigged.usda", tmp_path / "baked.usda"
    options = ("--joints", "neck", "--joints", "head", "--frame", "joint")
    cli("add-controls", SAMPLES / "biped.usda", "-o", rigged, *options, code=0)
    stage = Usd.Stage.Open(str(rigged))
    (control,) = (prim for prim in stage.Traverse() if prim.GetName() == "head_ctl")
    order = ["xformOp:translate", "xformOp:rotateXYZ", "xformOp:scale"]
    assert list(control.GetAttribute("xformOpOrder").Get()) == order
    for time, angles in ((0, (0, 0, 0)), (12, (40, 30, 20))):
        control.GetAttribute("xformOp:rotateXYZ").Set(Gf.Vec3d(*angles), time)
    stage.Save()
    cli("bake", rigged, "-o", baked, "--to", "joints", "--between", "1e-5", code=0)
    rig = read(baked).rig
    (track,) = (t for t in rig.clips[0].tracks if rig.names[t.node] == "head" and t.path == "rotation")
    for time, share in ((12.0, 1.0), (6.0, 0.5)):
        angles = zip(np.eye(3), (40, 30, 20), strict=True)
        x, y, z = (Gf.Rotation(Gf.Vec3d(*axis), share * angle) for axis, angle in angles)
        q = (x * y * z).GetQuat()
        expected = multiply(rig.rotation[track.node], np.array([*q.GetImaginary(), q.GetReal()]))
        found = sampling.sample(track, [time])[0]
        assert min(np.abs(found - expected).max(), np.abs(found + expected).max()) < 2e-4


def test_ops_that_no_track_can_represent_are_noticed_and_stay(tmp_path: Path) -> None:
    order = '["xformOp:translate", "xformOp:{}", "xformOp:{}"]'
    sheared = LEG.replace(order.format("rotateXYZ", "scale"), order.format("scale", "rotateXYZ"))
    document = read(save(tmp_path, sheared), root="/Rig")
    assert [notice.code for notice in document.warnings] == ["reset-stack", "animated-xform"]
    assert not document.rig.clips


def test_bake_writes_translate_orient_scale_where_nothing_moves(tmp_path: Path) -> None:
    source = save(tmp_path, SMOOTH)
    document = read(source, root="/Rig", bake_xform=True)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    check_same(source, out, still=("bone",))
    stage = Usd.Stage.Open(str(out))
    order = [
        str(op) for op in stage.GetPrimAtPath("/Rig/thigh/parts/shin").GetAttribute("xformOpOrder").Get()
    ]
    assert order[:2] == ["xformOp:translate", "xformOp:orient"]
    assert not any("rigtri" in op for op in order)
    assert "not-baked" in [notice.code for notice in document.warnings]


def test_a_moved_prim_is_refused(tmp_path: Path) -> None:
    document = read(save(tmp_path, SMOOTH), root="/Rig")
    matrix = document.rig.matrix.copy()
    matrix[document.rig.find("shin"), 3, 0] += 1
    with pytest.raises(GeometryError, match="no other rest pose"):
        write(document, replace(document.rig, matrix=matrix), tmp_path / "out.usda")


def test_root_is_a_path_or_a_name_that_is_there(tmp_path: Path) -> None:
    source = save(tmp_path, SMOOTH)
    assert read(source, root="thigh").rig.skins[0].key == ("root", "/Rig/thigh")
    with pytest.raises(NameNotFoundError):
        read(source, root="nobody")
    both = save(tmp_path, scene(skeleton(), animation(), MESH), "both.usda")
    assert "is a joint" in error_of(both, root="a/b")


def test_physics_joints_and_constraint_targets_keep_a_prim_in_its_axes(tmp_path: Path) -> None:
    text = """#usda 1.0
def Xform "Car" {
    def Xform "wheel" {}
    def Xform "door" {
        matrix4d constraintTargets:hinge = ((1,0,0,0),(0,1,0,0),(0,0,1,0),(0,0,0,1))
    }
    def PhysicsRevoluteJoint "axle" {
        rel physics:body1 = </Car/wheel>
    }
}
"""
    rig = read(save(tmp_path, text), root="/Car").rig
    assert "physics joint" in rig.rules.fixed[rig.find("wheel")]
    assert "constraintTargets:hinge" in rig.rules.fixed[rig.find("door")]


def test_root_is_refused_above_a_skeleton(tmp_path: Path) -> None:
    source = save(tmp_path, scene(skeleton(), animation(), MESH, 'def Xform "props" {}'))
    for root in ("/Root", "/Root/Skel"):
        assert "there is a skeleton, </Root/Skel>" in error_of(source, root=root)
    assert read(source, root="/Root/props").rig.skins[-1].key == ("root", "/Root/props")


def test_a_prim_that_resets_the_stack_below_the_root_is_reported(tmp_path: Path) -> None:
    document = read(save(tmp_path, SMOOTH), root="/Rig")
    (notice,) = [notice for notice in document.warnings if notice.code == "reset-stack"]
    assert "</Rig/thigh/parts/shin/loose> does not follow" in notice.text
    loose = "/Rig/thigh/parts/shin/loose"
    again = read(document._source.path, root=loose)
    assert not any(notice.code == "reset-stack" for notice in again.warnings)
    assert len(again.rig.skins[0].joints) == 1


def test_a_root_that_is_not_there_is_reported_with_prims_and_no_joints(tmp_path: Path) -> None:
    source = save(
        tmp_path, scene(skeleton(), animation(), MESH).replace('Root"', 'Rooot"').replace("/Root/", "/Rooot/")
    )
    with pytest.raises(NameNotFoundError, match=r"No prim is named '/Root'\. Did you mean '/Rooot'"):
        read(source, root="/Root")


def test_no_root_is_proposed_where_there_is_no_prim(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="there is no skeleton in it, nor any prim that has a place") as error:
        read(save(tmp_path, "#usda 1.0\n"))
    assert "--root" not in str(error.value)


TWITCH = """double3 xformOp:translate = (1, 2, 3)
quatf xformOp:orient.timeSamples = { 1: (1, 0, 0, 0), 9: (1, 0.0001, 0, 0) }
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]"""


def test_a_prim_of_another_unit_is_read_by_its_keys_and_takes_others(tmp_path: Path) -> None:
    # w of float32 has lost so small a rotation, and USD's matrices with it.
    one = save(tmp_path, scene(TWITCH, skeleton(), animation(), MESH))
    out = tmp_path / "out.usda"
    cli("freeze", one, "-o", out, "--unit", "1", code=0)
    before, after = places(one), places(out)
    assert "xformOp:scale:rigtriFrame" in out.read_text()
    size = before["/Root", 1.0][3, 1] / after["/Root", 1.0][3, 1]
    for place in before:
        assert_allclose(after[place][3] * [size, size, size, 1], before[place][3], atol=1e-12)
    document = read(out)
    rig, node = document.rig, document.rig.find("/Root")
    (clip,) = (clip for clip in rig.clips if clip.name == "xforms")
    (track,) = (track for track in clip.tracks if track.node == node)
    turn = replace(track, values=np.array([IDENTITY, [0.6, 0.0, 0.0, 0.8]]))
    tracks = tuple(turn if each is track else each for each in clip.tracks)
    clips = tuple(replace(clip, tracks=tracks) if each is clip else each for each in rig.clips)
    there = places(write(document, replace(rig, clips=clips), tmp_path / "there.usda"))
    assert_allclose(there["/Root", 1.0], after["/Root", 1.0], atol=1e-12)
    assert_allclose(there["/Root", 9.0][2, :3], after["/Root", 1.0][:3, :3].T @ [0, -0.96, 0.28], atol=1e-7)


@pytest.mark.ci
def test_the_notice_of_a_reset_stack_is_true_of_every_command(tmp_path: Path) -> None:
    said = cli("freeze", save(tmp_path, SMOOTH), "-o", tmp_path / "out.usda", "--root", "/Rig").output
    joints = [read(tmp_path / "in.usda", root=root).rig.skins[0].joints for root in ("/Rig", "loose")]
    assert not set(joints[0]) & set(joints[1])
    assert "are not joints of --root /Rig. To have them as joints, run again with --root /Rig/thigh" in said


@pytest.mark.parametrize("edit_target", ["root", "new"])
def test_ops_of_other_layers_keep_the_types_that_those_state(edit_target: str, tmp_path: Path) -> None:
    """An opinion of another type contradicts the asset, which UsdValidation reports."""
    ops = "float3 xformOp:scale = (2, 2, 2)\nquatf xformOp:orient = (0.6, 0, 0.8, 0)\n"
    order = 'uniform token[] xformOpOrder = ["xformOp:orient", "xformOp:scale"]\n'
    save(tmp_path, scene(f"{ops}{order}", skeleton(), animation(), MESH), "hero.usda")
    source = save(tmp_path, '#usda 1.0\ndef "Hero" (references = @./hero.usda@</Root>)\n{\n}\n', "shot.usda")
    out = tmp_path / "out.usda"
    cli("freeze", source, "-o", out, "--unit", 1, "--edit-target", edit_target, code=0)
    stages = [Usd.Stage.Open(str(path)) for path in (source, out)]
    for name in ("xformOp:scale", "xformOp:orient"):
        stack = stages[1].GetAttributeAtPath(f"/Hero.{name}").GetPropertyStack()
        assert len({str(spec.typeName) for spec in stack}) == 1
    before, after = (skinned(stage, Usd.TimeCode(3)) for stage in stages)
    assert np.abs(before["/Hero/Skin"] - 100 * after["/Hero/Skin"]).max() < 1e-4


@pytest.mark.parametrize(("apart", "turned"), [(1.0, 6.0), (4.0, 354.0)])
def test_euler_angles_that_begin_anew_within_a_frame_go_the_short_way(apart: float, turned: float) -> None:
    """Exporters sample frames; from key to key far apart it may be a spin, which USD plays."""
    stage = Usd.Stage.CreateInMemory()
    prim = UsdGeom.Xform.Define(stage, "/hand_ctl")
    op = prim.AddRotateXYZOp()
    for time, angle in ((0.0, 178.0), (apart, -176.0)):
        op.Set((0.0, angle, 0.0), time)
    tracks = sampled_tracks(prim.GetPrim(), 0, "LINEAR")
    assert tracks
    (turn,) = (track for track in tracks if track.path == "rotation")
    way = sample(turn, np.linspace(0.0, apart, 200))
    assert np.degrees(angle_between(way[1:], way[:-1]).sum()) == pytest.approx(turned, abs=0.5)


@pytest.mark.parametrize(("apart", "turned"), [(1.0, 4.0), (4.0, 20.0)])
@pytest.mark.parametrize("order", ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"])
def test_euler_angles_that_flip_within_a_frame_go_the_short_way(
    order: str, apart: float, turned: float
) -> None:
    """180° - b with half a turn more of a and c is the rotation that a, b and c are."""
    stage = Usd.Stage.CreateInMemory()
    prim = UsdGeom.Xform.Define(stage, "/hand_ctl")
    op = getattr(prim, f"AddRotate{order}Op")()
    for time, angles in ((0.0, (92.0, 60.0, -90.0)), (apart, (93.0 - 180.0, 180.0 - 61.0, -91.0 + 180.0))):
        op.Set(tuple(angles[order.index(axis)] for axis in "XYZ"), time)
    (turn,) = (t for t in sampled_tracks(prim.GetPrim(), 0, "LINEAR") or () if t.path == "rotation")
    for time in (0.0, apart):
        shown = decompose(np.array(prim.GetLocalTransformation(time)))[1]
        assert angle_between(sample(turn, [time])[0], shown) < 1e-12
    way = sample(turn, np.linspace(0.0, apart, 200))
    gone = np.degrees(angle_between(way[1:], way[:-1]).sum())
    assert gone < turned if apart == 1.0 else gone > turned


def test_tracks_of_euler_angles_keep_so_near_between_samples_that_a_line_of_prims_is_seen_exactly() -> None:
    """Where other prims have samples, what is baked of these has keys; straight limbs amplify what is off."""
    stage = Usd.Stage.CreateInMemory()
    prim = UsdGeom.Xform.Define(stage, "/elbow")
    op = prim.AddRotateXYZOp()
    for time, angles in ((0.0, (5.0, -20.0, 15.0)), (13.0, (-10.0, 15.0, 40.0))):
        op.Set(angles, time)
    tracks = sampled_tracks(prim.GetPrim(), 0, "LINEAR")
    assert tracks
    times = np.linspace(0.0, 13.0, 60)
    (turn,) = (track for track in tracks if track.path == "rotation")
    locals_ = np.array([prim.GetLocalTransformation(float(time)) for time in times])
    assert angle_between(sample(turn, times), decompose(locals_)[1]).max() < 2e-6


@pytest.mark.parametrize(
    ("tilt", "frames", "told"), [(30.0, 4.0, True), (0.0, 4.0, False), (30.0, 1.0, False)]
)
def test_a_prim_that_matrices_shear_between_its_samples_is_reported(
    tilt: float, frames: float, told: bool, tmp_path: Path
) -> None:
    """USD interpolates their elements: a turn about two axes comes out sheared, one about an axis smaller.

    Before, what followed it was up to 0.08 of the size beside USD's motion, without a word.
    """
    stage = Usd.Stage.CreateNew(str(tmp_path / "in.usda"))
    op = UsdGeom.Xform.Define(stage, "/rig").AddTransformOp()
    for time, angle in ((1.0, 0.0), (1.0 + frames, 40.0)):
        turn = Gf.Rotation(Gf.Vec3d(1, 0, 0), angle) * Gf.Rotation(Gf.Vec3d(0, 1, 0), tilt * (time > 1.0))
        op.Set(Gf.Matrix4d().SetRotate(turn), time)
    stage.Save()
    notices = read(tmp_path / "in.usda", root="/rig").warnings
    assert [notice.code for notice in notices] == ["xform-sheared"] * told
    if told:
        between = np.array(UsdGeom.Xformable(stage.GetPrimAtPath("/rig")).GetLocalTransformation(3.0))
        off = np.abs(between[:3, :3] - nearest_rotation(between)).max() / np.abs(between[:3, :3]).max()
        assert f"by up to {off:.2g} of its axes (at 3)" in notices[0].text


def test_turns_beside_other_ops_go_along_arcs_between_samples() -> None:
    """Before, small angles were what OpenUSD makes of a cosine in float32, 3.5e-4 rad off where a key was."""
    stage = Usd.Stage.CreateInMemory()
    prim = UsdGeom.Xform.Define(stage, "/elbow")
    move = prim.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble)
    move.Set(Gf.Vec3d(3, 0, 1))
    turn = prim.AddOrientOp()
    turn.Set(Gf.Quatf(1, 0, 0, 0), 0.0)
    turn.Set(Gf.Quatf(0.9659258, 0, 0.25881904, 0), 12.0)
    prim.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble, isInverseOp=True)
    tracks = sampled_tracks(prim.GetPrim(), 0, "LINEAR")
    assert tracks
    rotation = tracks[1]
    times = np.linspace(0.0, 12.0, 2000)
    arc = from_axis_angle([0.0, 1, 0], np.radians(30.0) * times / 12.0)
    assert angle_between(sample(rotation, times), arc).max() < 1e-6
    assert len(rotation.times) == 2


@pytest.mark.parametrize(("scaled", "paths"), [(False, ["translation", "rotation"]), (True, list(PATHS))])
def test_prims_have_tracks_of_scale_where_an_op_scales(scaled: bool, paths: list[str]) -> None:
    """What rounding leaves of a scale of 1 is no motion: bake could not write it, and refused."""
    stage = Usd.Stage.CreateInMemory()
    prim = UsdGeom.Xform.Define(stage, "/elbow")
    turn = prim.AddRotateXYZOp()
    for time in range(3):
        turn.Set((10.0 * time, 7.0, 20.0 * time), float(time))
    prim.AddTranslateOp().Set((1.0, 0.0, 0.0))
    if scaled:
        prim.AddScaleOp().Set((2.0, 2.0, 2.0))
    tracks = sampled_tracks(prim.GetPrim(), 0, "LINEAR")
    assert tracks
    assert [track.path for track in tracks] == paths


@pytest.mark.parametrize(
    ("turn", "scale", "ops"),
    [
        (0.0, 1.0, ["translate"]),
        (1e-14, 1.0 + 1e-14, ["translate"]),
        (0.5, 1.0, ["translate", "orient"]),
        (0.0, 2.0, ["translate", "scale"]),
        (-0.5, 0.5, ["translate", "orient", "scale"]),
    ],
)
def test_a_transform_has_the_ops_that_do_something(turn: float, scale: float, ops: list[str]) -> None:
    local = compose(np.array([1.0, 2, 3]), from_axis_angle([0.0, 0, 1], turn), np.array([1.0, scale, 1]))
    assert transform_ops(stands_by(local)) == [f"xformOp:{name}" for name in ops]


def test_an_animated_prim_whose_constant_rotation_is_not_unit_keeps_its_axes(tmp_path: Path) -> None:
    """OpenUSD shears with it. Before, a product of quaternions stood for it, and results were refused."""
    source, out = tmp_path / "in.usda", tmp_path / "out.usda"
    stage = Usd.Stage.CreateNew(str(source))
    above = UsdGeom.Xform.Define(stage, "/top")
    for name, frame in (("a", (1.0, -0.9, 0.1, 0.2)), ("a/b", (1.0, 0.0, 0.0, 0.0))):
        above = UsdGeom.Xform.Define(stage, f"/top/{name}")
        above.AddTranslateOp().Set(Gf.Vec3d(1, 2, 3))
        turn = above.AddOrientOp()
        for time, angle in ((0, 0.0), (12, 0.3), (24, 0.7)):
            turn.Set(Gf.Quatf(np.cos(angle), 0.0, np.sin(angle), 0.0), time)
        above.AddOrientOp(UsdGeom.XformOp.PrecisionDouble, "rigtriFrame").Set(Gf.Quatd(*frame))
    stage.Save()
    result = cli("orient-joints", source, "-o", out, "--root", "top", "--preset", "cmt", code=0)
    assert "skipped: a: </top/a>.xformOp:orient:rigtriFrame is not unit" in result.stderr
    cli("verify", source, out, "--root", "top", code=0)


def test_a_joint_whose_ops_give_no_finite_matrix_is_named(tmp_path: Path) -> None:
    """Before, it was read as if it had no ops, and results were refused with 6 where clips moved it."""
    source = tmp_path / "in.usda"
    text = (SAMPLES / "arm.usda").read_text("utf-8")
    turn = "quatf xformOp:orient = (1, 0, 0, 0)"
    assert turn in text
    source.write_text(text.replace(turn, turn.replace("0)", "inf)"), 1), "utf-8")
    done = cli("orient-joints", source, "-o", tmp_path / "out.usda", "--root", "arm", code=3)
    assert (
        "The ops of </arm/shoulder> give no finite matrix, so nothing says where this joint is" in done.stderr
    )


def test_prims_with_uneven_scales_get_axes_that_their_scales_lie_along(tmp_path: Path) -> None:
    """Before, OpenUSD's way between near rotations was seen in the result alone, which was refused."""
    text = (SAMPLES / "arm.usda").read_text("utf-8")
    stands, ops = "double3 xformOp:translate = (20, 140, 0)", '"xformOp:translate", "xformOp:orient"'
    assert stands in text
    text = text.replace(stands, f"double3 xformOp:scale = (3, 1, 1)\n        {stands}", 1)
    text = text.replace(ops, f'{ops}, "xformOp:scale"', 1)
    path = save(tmp_path, text)
    for preset in ("blender", "maya"):
        cli(
            "orient-joints",
            path,
            "-o",
            out := tmp_path / f"{preset}.usda",
            "--root",
            "arm",
            "--preset",
            preset,
            code=0,
        )
        path = out


@pytest.mark.parametrize(
    "order", [("!reset", "translate"), ("scale", "!reset", "translate"), ("translate", "!reset")]
)
def test_a_prim_that_follows_nothing_takes_keys_and_still_follows_nothing(
    order: tuple[str, ...], tmp_path: Path
) -> None:
    """Ops before !resetXformStack! do nothing. Before, those were replaced with it where it was not first."""
    path, loose = save(tmp_path, SMOOTH), "/Rig/thigh/parts/shin/loose"
    stage = Usd.Stage.Open(str(path))
    words = ["!resetXformStack!" if op == "!reset" else f"xformOp:{op}" for op in order]
    stage.GetPrimAtPath(loose).GetAttribute("xformOpOrder").Set(words)
    stage.Save()
    document = read(path, root=loose)
    node = document.rig.find(loose)
    keys = Track(node, "translation", "LINEAR", np.array([1.0, 9.0]), np.array([[7.0, 8, 9], [1, 2, 3]]))
    (clip,) = document.rig.clips
    rig = replace(document.rig, clips=(replace(clip, tracks=(*clip.tracks, keys)),))
    out = write(document, rig, tmp_path / "out.usda")
    assert_allclose([places(out)[loose, time][3, :3] for time in (1.0, 9.0)], keys.values)


def test_an_orient_op_of_another_type_is_no_traceback(tmp_path: Path) -> None:
    """Before, it was: a damaged crate may hold anything in the place of quaternions."""
    stage = Usd.Stage.CreateNew(str(tmp_path / "in.usda"))
    prim = UsdGeom.Xform.Define(stage, "/a")
    held = prim.GetPrim().CreateAttribute("xformOp:orient", Sdf.ValueTypeNames.Half2)
    for time in (1.0, 3.0):
        held.Set(Gf.Vec2h(1.0, 0.0), time)
    prim.GetXformOpOrderAttr().Set(["xformOp:orient"])
    assert matrices_at(prim, [2.0]).shape == (1, 4, 4)
