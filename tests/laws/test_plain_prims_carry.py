"""Rigs of plain Xform prims (--root) carry what is built on them, whatever ops these stand by, or refuse.

Built, edited, baked: the meshes on the prims stand at every sample where they stand without the edit, by
UsdGeom alone. docs/carrying.md has the table.
"""

from __future__ import annotations

import re
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from places import SAMPLES, slow
from program import Ran, cli
from pxr import Gf, Usd, UsdGeom

from rigtri.evaluation.sampling import sample
from rigtri.formats import ReadOptions, read
from rigtri.formats.usd.reading.sampled_xforms import sampled_tracks
from rigtri.frames.skeleton import skeleton
from rigtri.maths.quaternions import to_axes

SAME = 1e-5
FRAMES = (0, 6, 12, 18, 24)
PLACES = {
    "/rig/hip": ((0, 1, 0), (5, 10, 0)),
    "/rig/hip/upper": ((0.2, 0.3, 0), (10, 20, 30)),
    "/rig/hip/upper/fore": ((0.4, 0, 0.05), (0, 40, 10)),
    "/rig/hip/upper/fore/hand": ((0.4, 0, 0.1), (5, 5, 5)),
    "/rig/hip/other": ((-0.2, 0.3, 0), (15, 0, 25)),
}
OPS = ("rotateXYZ", "rotateZ rotateY rotateX", "rotateXYZ scale", "transform")
THINGS = {
    "controls": ("add-controls", "--chain", "upper", "hand"),
    "constraint": ("constrain", "--type", "orient", "--child", "other", "--driver", "upper"),
}
EDITS = {
    "orient-joints": ("--aim", "x", "--up", "y"),
    "freeze": (),
    "set-rest": ("--pose", "bind"),
    "add-root": ("--above", "hip"),
    "add-socket": ("--on", "hand", "--name", "grip"),
    "add-polevector": ("--limb", "upper", "fore", "hand"),
    "add-controls": ("--whole-character",),
    "prune-joints": (),
    "strip": (),
}
# What says so where an edit or a bake refuses.
REFUSED = "other paths"


def _save(path: Path, ops: str, *, animated: bool) -> Path:
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, "Y")
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/rig").GetPrim())
    for name, (place, angles) in PLACES.items():
        prim = UsdGeom.Xform.Define(stage, name)
        times = FRAMES if animated else (Usd.TimeCode.Default(),)
        turned = [[angle * (1 + k / 4) for angle in angles] for k in range(len(times))]
        if ops == "transform":
            op = prim.AddTransformOp()
            for time, (x, y, z) in zip(times, turned, strict=True):
                parts = zip(np.eye(3).tolist(), (x, y, z), strict=True)
                first, second, third = (Gf.Rotation(Gf.Vec3d(*axis), angle) for axis, angle in parts)
                op.Set(Gf.Matrix4d().SetTransform(first * second * third, Gf.Vec3d(*place)), time)
        else:
            prim.AddTranslateOp().Set(Gf.Vec3d(*place))
            for word in ops.split():
                if word == "scale":
                    prim.AddScaleOp().Set(Gf.Vec3f(1.5 if name.endswith("upper") else 1.0))
                    continue
                op = getattr(prim, f"Add{word[0].upper()}{word[1:]}Op")()
                for time, angled in zip(times, turned, strict=True):
                    op.Set(Gf.Vec3f(*angled) if word == "rotateXYZ" else angled["XYZ".index(word[-1])], time)
        mesh = UsdGeom.Mesh.Define(stage, f"{name}/geo")
        mesh.CreatePointsAttr([(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)])
        mesh.CreateFaceVertexCountsAttr([3, 3])
        mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 0, 2, 3])
    stage.Save()
    return path


def _seen(path: Path) -> np.ndarray:
    """Where the corners of all meshes are, by the names of what they hang on, at all samples and between."""
    stage, found = Usd.Stage.Open(str(path)), []
    meshes = [prim for prim in stage.Traverse() if prim.GetName() == "geo"]
    meshes.sort(key=lambda prim: prim.GetParent().GetName())
    for time in (*range(0, 25, 3), Usd.TimeCode.Default()):
        cache = UsdGeom.XformCache(time)
        for prim in meshes:
            world = np.array(cache.GetLocalToWorldTransform(prim))
            found.append(np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get()) @ world[:3, :3] + world[3, :3])
    return np.array(found)


def _run(*words: Any, root: str = "/rig/hip") -> Ran:
    ran = cli(*words, "--root", root)
    assert ran.exit_code == 0 or re.search(REFUSED, ran.stderr), ran.stderr
    return ran


def _cases() -> list[Any]:
    every = product(OPS, (False, True), THINGS, EDITS)
    few = (
        ("rotateXYZ", True, "constraint", "orient-joints"),
        (
            "transform",
            True,
            "constraint",
            "orient-joints",
        ),  # its rotation at the default time is not that of rest
        ("transform", False, "controls", "freeze"),
    )
    return [case if case in few else slow(*case) for case in every]


@pytest.mark.parametrize(("ops", "animated", "thing", "edit"), _cases())
def test_prims_carry_what_is_built_on_them(
    ops: str, animated: bool, thing: str, edit: str, tmp_path: Path
) -> None:
    source = _save(tmp_path / "in.usda", ops, animated=animated)
    built, edited = tmp_path / "built.usda", tmp_path / "edited.usda"
    baked, again = tmp_path / "baked.usda", tmp_path / "again.usda"
    assert _run(THINGS[thing][0], source, "-o", built, *THINGS[thing][1:]).exit_code == 0
    assert _run("bake", built, "-o", baked, "--to", "joints").exit_code == 0
    if _run(edit, built, "-o", edited, *EDITS[edit]).exit_code:
        return
    if edit == "strip":
        assert np.abs(_seen(source) - _seen(edited)).max() <= SAME
        return
    assert _run("bake", edited, "-o", again, "--to", "joints").exit_code == 0
    assert np.abs(_seen(baked) - _seen(again)).max() <= SAME


@pytest.mark.parametrize("thing", THINGS)
def test_controls_below_the_root_that_is_edited_are_no_joints(thing: str, tmp_path: Path) -> None:
    """Before, orient-joints turned them with the others, and a bake gave another motion, without a word."""
    source = _save(tmp_path / "in.usda", "rotateXYZ", animated=True)
    built, edited = tmp_path / "built.usda", tmp_path / "edited.usda"
    baked, again = tmp_path / "baked.usda", tmp_path / "again.usda"
    command, *words = THINGS[thing]
    assert _run(command, source, "-o", built, *words, root="/rig").exit_code == 0
    assert _run("bake", built, "-o", baked, root="/rig").exit_code == 0
    assert _run("orient-joints", built, "-o", edited, *EDITS["orient-joints"], root="/rig").exit_code == 0
    assert _run("bake", edited, "-o", again, root="/rig").exit_code == 0
    assert np.abs(_seen(baked) - _seen(again)).max() <= SAME
    rig = read(built, ReadOptions(root="/rig")).rig
    assert rig.own.isdisjoint(skeleton(rig, "/rig").joints)


def test_a_root_that_gets_any_axes_carries_its_controls(tmp_path: Path) -> None:
    """Their group, a Scope, turns with it. Before, rounding of its rotation was refused: it has none."""
    source = _save(tmp_path / "in.usda", "rotateXYZ", animated=True)
    built, edited = tmp_path / "built.usda", tmp_path / "edited.usda"
    baked, again = tmp_path / "baked.usda", tmp_path / "again.usda"
    stage = Usd.Stage.Open(str(source))
    for name, place in {"box": (0.3, -0.4, 0.9), "flag": (0.1, 0.2, -0.8)}.items():
        UsdGeom.Xform.Define(stage, f"/rig/{name}").AddTranslateOp().Set(Gf.Vec3d(*place))
    stage.Save()
    command, *words = THINGS["controls"]
    assert _run(command, source, "-o", built, *words, root="/rig").exit_code == 0
    assert _run("bake", built, "-o", baked, root="/rig").exit_code == 0
    assert _run("orient-joints", built, "-o", edited, *EDITS["orient-joints"], root="/rig").exit_code == 0
    stage = Usd.Stage.Open(str(edited))
    order = stage.GetPrimAtPath("/rig").GetAttribute("xformOpOrder").Get()
    assert "rigtriFrame" in list(order)[-1]
    assert _run("bake", edited, "-o", again, root="/rig").exit_code == 0
    assert np.abs(_seen(baked) - _seen(again)).max() <= SAME


def test_a_root_above_a_prim_is_refused_in_its_own_words(tmp_path: Path) -> None:
    source = _save(tmp_path / "in.usda", "transform", animated=False)
    words = ("add-root", source, "-o", tmp_path / "out.usda", "--root", "/rig/hip", "--above", "hip")
    error = cli(*words, code=2).stderr
    assert "'hip' is a prim" in error
    assert "--on-nonuniform-scale" not in error


def _driven_by_matrices(path: Path, shear: float) -> None:
    """A prim beside one that turns by a matrix on every frame, about an axis that is none of its own."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, "Y")
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/rig").GetPrim())
    op = UsdGeom.Xform.Define(stage, "/rig/driver").AddTransformOp()
    for time in range(25):
        matrix = Gf.Matrix4d().SetRotate(Gf.Rotation(Gf.Vec3d(1, 2, 0.5), 90 * time / 24))
        op.Set(Gf.Matrix4d(1, shear, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.1 * time, 0, 0, 1) * matrix, time)
    UsdGeom.Xform.Define(stage, "/rig/child").AddTranslateOp().Set(Gf.Vec3d(3, 1, 0))
    stage.Save()


def test_prims_follow_matrices_and_refuse_sheared_ones(tmp_path: Path) -> None:
    source, built, baked = (tmp_path / f"{name}.usda" for name in ("in", "built", "baked"))
    _driven_by_matrices(source, 0.0)
    words = ("--root", "/rig", "--child", "/rig/child", "--driver", "/rig/driver")
    cli("constrain", source, "-o", built, *words, code=0)
    cli("bake", built, "-o", baked, "--root", "/rig", code=0)
    stage = Usd.Stage.Open(str(baked))

    def places(time: float) -> list[np.ndarray]:
        cache = UsdGeom.XformCache(time)
        prims = map(stage.GetPrimAtPath, ("/rig/child", "/rig/driver"))
        return [np.array(cache.GetLocalToWorldTransform(prim)) for prim in prims]

    child, driver = places(0)
    offset = child @ np.linalg.inv(driver)
    for time, bound in ((7, 1e-5), (24, 1e-5), (7.5, 2e-3)):  # between samples OpenUSD shears the driver
        child, driver = places(time)
        assert np.abs(child - offset @ driver)[3].max() < bound
    _driven_by_matrices(sheared := tmp_path / "sheared.usda", 0.3)
    error = cli("constrain", sheared, "-o", tmp_path / "out.usda", *words, code=5).stderr
    assert "'child' cannot follow 'driver'" in error
    assert "sheared" in error


def test_plain_prims_of_another_file_are_said_to_give_keys_alone(tmp_path: Path) -> None:
    source = _save(tmp_path / "in.usda", "rotateXYZ", animated=False)
    ran = cli("bake", SAMPLES / "biped.usda", "-o", tmp_path / "out.usda", "--rig", source, code=3)
    assert "take-clips RIG --from EDITED --root PRIM" in ran.stderr


def test_a_prim_that_turns_by_euler_angles_gets_no_keys_of_its_place(tmp_path: Path) -> None:
    """Its rotation is sampled where it is on no arc. Before, what stood still had a key at each of these."""
    source, built, baked = (tmp_path / f"{name}.usda" for name in ("in", "built", "baked"))
    _save(source, "rotateXYZ", animated=True)
    assert _run(THINGS["constraint"][0], source, "-o", built, *THINGS["constraint"][1:]).exit_code == 0
    assert _run("bake", built, "-o", baked).exit_code == 0
    stage = Usd.Stage.Open(str(baked))
    place, turn = UsdGeom.Xformable(stage.GetPrimAtPath("/rig/hip/other")).GetOrderedXformOps()
    assert (place.GetOpName(), place.GetNumTimeSamples()) == ("xformOp:translate", 1)
    assert turn.GetNumTimeSamples() > len(FRAMES)


def test_sampled_tracks_keep_the_keys_that_they_need_between_samples(tmp_path: Path) -> None:
    """Up goes a prim on a line, and turns by angles about two axes: its place has the samples' keys."""
    stage = Usd.Stage.Open(str(_save(tmp_path / "in.usda", "rotateXYZ", animated=True)))
    prim = stage.GetPrimAtPath("/rig/hip/upper")
    for time in FRAMES:
        prim.GetAttribute("xformOp:translate").Set(Gf.Vec3d(0.2, 0.3 + time, 0), time)
    place, turn = sampled_tracks(prim, 0, "LINEAR") or ()
    assert place.times.tolist() == list(FRAMES)
    assert set(FRAMES) < set(turn.times.tolist())
    inside = np.linspace(0, 24, 97)
    world = np.array([UsdGeom.Xformable(prim).GetLocalTransformation(time) for time in inside])
    assert np.abs(sample(place, inside) - world[:, 3, :3]).max() < 1e-12
    assert np.abs(to_axes(sample(turn, inside)) - world[:, :3, :3]).max() < 2e-6
