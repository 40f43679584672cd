"""--split-weights in glTF and USD: how influences are stored afterwards, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gltf_files import Builder, glb_json, small
from numpy.testing import assert_allclose
from places import slow
from program import cli
from second_opinions import khronos_errors, validator

import rigtri
from rigtri import verify
from rigtri.errors import FileError, GeometryError, UsageError
from rigtri.formats import Document, read
from rigtri.limits import TOLERANCE
from rigtri.model.animation import Clip, Track
from rigtri.model.animation import Path as Channel
from rigtri.model.rig import Rig
from rigtri.model.skin import WeightRedistribution
from rigtri.model.skin_weights import folded, shared
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.operations.strip import strip
from rigtri.pipeline.edit import edit
from rigtri.report import Report

# A bone of three twist joints, and a triangle with points at 0, 0.5 and 1 of it.
POINTS = [[0, 1, 0], [1, 1.5, 0], [0, 2, 0]]
SPLIT = AddTwistOptions(joint=("joint 0",), to=("joint 1",), lower=True, count=3, split_weights=True)


def bone(
    weights: Any, joints: Any = ((0, 1, 0, 0),) * 3, kinds: tuple[str, str] = ("u1", "f4"), **more: Any
) -> Builder:
    """The smallest real thing with other influences."""
    builder = small(4)
    (primitive,) = builder.gltf["meshes"][0]["primitives"]
    primitive["attributes"] = {
        "POSITION": builder.points(POINTS),
        "JOINTS_0": builder.accessor(joints, kinds[0]),
        "WEIGHTS_0": builder.accessor(weights, kinds[1], **more),
    }
    return builder


def split(rig: Rig, report: Report) -> Rig:
    return add_twist(rig, options=SPLIT, report=report)


def result(builder: Builder, tmp_path: Path) -> Document:
    source, target = builder.glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    edit(source, target, split)
    return read(target)


def named(document: Document) -> list[dict[str, float]]:
    """The weights of each point by the names of its joints."""
    (mesh,) = document.meshes()
    assert mesh.skin is not None
    names = [document.rig.names[node] for node in document.rig.skins[mesh.skin].joints.tolist()]
    pairs = zip(mesh.joints.tolist(), mesh.weights.tolist(), strict=True)
    return [{names[j]: w for j, w in zip(*row, strict=True) if w} for row in pairs]


def layouts(path: Path) -> dict[str, tuple[int, bool]]:
    gltf = glb_json(path)
    attributes = gltf["meshes"][0]["primitives"][0]["attributes"]
    accessors = {name: gltf["accessors"][index] for name, index in attributes.items() if name != "POSITION"}
    return {name: (a["componentType"], a.get("normalized", False)) for name, a in accessors.items()}


def test_weights_go_to_the_joints_along_the_bone(tmp_path: Path) -> None:
    found = named(result(bone([[0.5, 0.5, 0, 0]] * 3), tmp_path))
    assert found == [
        {"joint 0": 0.5, "joint 1": 0.5},
        {"joint 0_twist_2": 0.5, "joint 1": 0.5},
        {"joint 0_twist_3": 0.5, "joint 1": 0.5},
    ]


@pytest.mark.parametrize(("kind", "full", "code"), [("u1", 255, 5121), ("u2", 65535, 5123)])
def test_whole_weights_stay_whole(kind: str, full: int, code: int, tmp_path: Path) -> None:
    rows = np.array([[full - 9, 9, 0, 0]] * 3)
    builder = bone(rows, kinds=("u1", kind), normalized=True)
    document = result(builder, tmp_path)
    assert layouts(tmp_path / "out.glb") == {"JOINTS_0": (5121, False), "WEIGHTS_0": (code, True)}
    (mesh,) = document.meshes()
    assert_allclose(mesh.weights * full, np.rint(mesh.weights * full), atol=1e-9)
    assert_allclose(mesh.weights.sum(axis=1), 1.0, atol=1e-12)


def test_a_fifth_joint_opens_a_second_set_unless_the_nearest_is_to_take_all(tmp_path: Path) -> None:
    builder = bone([[0.4, 0.3, 0.2, 0.1]] * 3, joints=[[0, 1, 2, 3]] * 3)
    (primitive,) = builder.gltf["meshes"][0]["primitives"]
    primitive["attributes"]["POSITION"] = builder.points([[0, 1, 0], [1, 1.6, 0], [0, 2, 0]])
    source = builder.glb(tmp_path / "in.glb")
    report = Report()
    edit(source, tmp_path / "wide.glb", split, report=report)
    assert "more-influences" in {notice.code for notice in report.warnings}
    assert set(layouts(tmp_path / "wide.glb")) == {"JOINTS_0", "JOINTS_1", "WEIGHTS_0", "WEIGHTS_1"}
    options = replace(SPLIT, max_influences=4)
    edit(source, tmp_path / "same.glb", lambda rig, report: add_twist(rig, options=options, report=report))
    assert set(layouts(tmp_path / "same.glb")) == {"JOINTS_0", "WEIGHTS_0"}
    assert named(read(tmp_path / "same.glb"))[1]["joint 0_twist_2"] == pytest.approx(0.4)
    (before, *after) = khronos_errors(source, tmp_path / "wide.glb", tmp_path / "same.glb")
    assert not [errors - before for errors in after if errors - before]


@pytest.mark.parametrize(("kind", "more"), [("f4", {}), ("u1", {"normalized": True})])
def test_weights_that_twist_joints_have_got_in_the_same_script_are_limited(
    kind: str, more: dict[str, Any], tmp_path: Path
) -> None:
    """As two commands one after the other do. Before, "there is no accessor 42" was said of the file."""
    full = 255 if kind == "u1" else 1
    weights = [[full, 0, 0, 0], [0.4 * full, 0.6 * full, 0, 0], [0, full, 0, 0]]
    source = bone(weights, kinds=("u1", kind), **more).glb(tmp_path / "in.glb")
    limit = {"max_influences": 1, "report": Report()}
    paths = [tmp_path / f"{name}.glb" for name in ("split", "two", "one")]
    edit(source, paths[0], split)
    edit(paths[0], paths[1], lambda rig, _: rigtri.limit_weights(rig, **limit), tolerance=10.0)
    edit(
        source,
        paths[2],
        lambda rig, report: rigtri.limit_weights(split(rig, report), **limit),
        tolerance=10.0,
    )
    one, two = (read(path).rig.meshes[0] for path in paths[1:])
    assert (one.weights == two.weights).all()
    assert (one.joints == two.joints).all()
    assert (one.weights.max(axis=1) == 1.0).all()


@pytest.mark.ci
def test_more_than_256_joints_need_larger_numbers(tmp_path: Path) -> None:
    builder = small(255)
    (primitive,) = builder.gltf["meshes"][0]["primitives"]
    primitive["attributes"]["POSITION"] = builder.points(POINTS)
    result(builder, tmp_path)
    assert layouts(tmp_path / "out.glb")["JOINTS_0"] == (5123, False)


@pytest.mark.parametrize("own", [0, 3], ids=["first", "last"])
@pytest.mark.parametrize("most", [0, 2])
@pytest.mark.parametrize("units", [False, True])
def test_what_a_split_puts_apart_a_fold_puts_back_in_its_place(own: int, most: int, units: bool) -> None:
    """The bone's joint, row 2, may stand at either end of the bone: its twist joints are rows 9, 10, 11."""
    rng = np.random.default_rng(4)
    count, order = 500, [9, 10, 11]
    order.insert(own, 2)
    at = np.linspace(0, 1, 4)
    bone_of = WeightRedistribution(0, np.array(order), at, np.zeros(3), np.array([0.0, 0, 1]), most)
    rows, along = np.arange(12), np.zeros(12)
    rows[9:] = 2
    along[order] = at
    points = rng.uniform(-0.5, 1.5, (count, 3))
    joints = np.array([rng.permutation(6)[:4] for _ in range(count)])
    weights = rng.integers(1, 64, (count, 4)).astype(np.float64)
    weights[np.arange(4) >= rng.integers(1, 5, count)[:, None]] = 0.0
    if not units:
        weights = (weights / 255).astype(np.float32).astype(np.float64)
    apart = shared(bone_of, points, joints, weights, units=units)
    again = shared(bone_of, points, *apart, units=units)
    assert all(map(np.array_equal, again, apart))
    assert not np.array_equal(apart[1][:, :4], weights)
    back_joints, back_weights = folded(rows, along, *apart)
    assert np.array_equal(back_weights, weights)
    assert np.array_equal(back_joints[weights != 0], joints[weights != 0])


def test_meshes_with_the_same_influences_get_each_its_own_back(tmp_path: Path) -> None:
    builder = bone([[0.75, 0.25, 0, 0]] * 3, joints=[[0, 2, 0, 0]] * 3)
    gltf = builder.gltf
    twin = {
        "POSITION": builder.points(POINTS),
        "JOINTS_0": builder.accessor([[0, 2, 0, 0]] * 3, "u1"),
        "WEIGHTS_0": builder.accessor([[0.75, 0.25, 0, 0]] * 3),
    }
    gltf["meshes"].append({"primitives": [{"attributes": twin}]})
    gltf["nodes"].append({"mesh": 1, "skin": 0})
    gltf["scenes"][0]["nodes"].append(5)
    source, built, bare = (tmp_path / f"{name}.glb" for name in ("in", "built", "bare"))
    edit(builder.glb(source), built, split)
    edit(built, bare, lambda rig, report: strip(rig, report=report))
    assert bare.read_bytes() == source.read_bytes()


def test_what_other_meshes_share_stays(tmp_path: Path) -> None:
    builder = bone([[0.5, 0.5, 0, 0]] * 3)
    gltf = builder.gltf
    (primitive,) = gltf["meshes"][0]["primitives"]
    gltf["meshes"][0]["primitives"].append({"attributes": dict(primitive["attributes"]), "mode": 0})
    gltf["meshes"].append({"primitives": [dict(primitive)]})
    gltf["nodes"].append({"mesh": 1})
    gltf["scenes"][0]["nodes"].append(5)
    before = dict(primitive["attributes"])
    result(builder, tmp_path)
    new = glb_json(tmp_path / "out.glb")
    first, second = (p["attributes"] for p in new["meshes"][0]["primitives"])
    assert first == second != before
    assert new["meshes"][1]["primitives"][0]["attributes"] == before


def test_a_mesh_of_two_skins_is_refused_by_name(tmp_path: Path) -> None:
    builder = bone([[0.5, 0.5, 0, 0]] * 3)
    gltf = builder.gltf
    gltf["meshes"][0]["name"] = "twins"
    gltf["skins"].append(dict(gltf["skins"][0]))
    gltf["nodes"].append({"mesh": 0, "skin": 1})
    gltf["scenes"][0]["nodes"].append(5)
    with pytest.raises(FileError, match="'twins' is drawn with several skins"):
        result(builder, tmp_path)
    assert not (tmp_path / "out.glb").exists()


def test_a_draco_mesh_is_refused_by_name(tmp_path: Path) -> None:
    builder = bone([[0.5, 0.5, 0, 0]] * 3)
    gltf = builder.gltf
    stream = builder.view(b"DRACO, or so it says")
    draco = {"bufferView": stream, "attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}
    gltf["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": draco}
    gltf["meshes"][0]["name"] = "packed"
    gltf["extensionsUsed"] = gltf["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    with pytest.raises(FileError, match="'packed' is compressed with KHR_draco"):
        result(builder, tmp_path)


@pytest.mark.ci
def test_usd_influences_keep_their_form(samples: Path, tmp_path: Path) -> None:
    from pxr import Usd

    options = AddTwistOptions(limbs="auto", split_weights=True)
    target = tmp_path / "out.usda"
    edit(samples / "biped.usda", target, lambda r, report: add_twist(r, options=options, report=report))
    stages = [Usd.Stage.Open(str(path)) for path in (samples / "biped.usda", target)]
    bodies = [stage.GetPrimAtPath("/biped/figure/body") for stage in stages]
    for name in ("jointIndices", "jointWeights"):
        old, new = (body.GetAttribute(f"primvars:skel:{name}") for body in bodies)
        assert new.GetTypeName() == old.GetTypeName()
        assert new.GetMetadata("interpolation") == "vertex"
        width = int(new.GetMetadata("elementSize"))
        assert len(new.Get()) == width * len(bodies[1].GetAttribute("points").Get())


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", slow(".usda")])
def test_the_command_reports_every_twist_joint(suffix: str, samples: Path, tmp_path: Path) -> None:
    arguments: list[Any] = ["add-twist", samples / f"biped{suffix}", "-o", tmp_path / f"out{suffix}"]
    arguments += ["--limbs", "auto", "--count", "3", "--split-weights", "--json", "-q"]
    run = cli(*arguments, code=0)
    document = json.loads(run.stdout)
    validator("report").validate(document)
    assert len(document["added"]) == 24
    assert document["verification"]["motion"]["deviation"] > 0
    assert {entry["weight"] < 0 for entry in document["added"]} == {False, True}
    assert all((entry["driver"] == entry["joint"]) is (entry["weight"] < 0) for entry in document["added"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--joint", "forearm_L"], "1 --joint and 0 --to"),
        (["--limbs", "auto", "--max-influences", "4"], "needs --split-weights"),
        (["--limbs", "auto", "--upper", "--weights", "a,b"], "commas"),
    ],
)
def test_options_that_do_not_fit_are_reported(
    arguments: list[str], words: str, samples: Path, tmp_path: Path
) -> None:
    run = cli("add-twist", samples / "biped.glb", "-o", tmp_path / "o.glb", *arguments, code=2)
    assert words in run.output


@pytest.mark.ci
@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda")])
def test_rigid_lines_of_controls_do_not_disturb_the_check(samples: Path, tmp_path: Path, name: str) -> None:
    built, out = tmp_path / f"built_{name}", tmp_path / name
    edit(
        samples / name,
        built,
        lambda rig, _: add_controls(rig, options=AddControlsOptions(whole_character=True)),
    )
    outcome = edit(
        built, out, lambda rig, _: add_twist(rig, options=AddTwistOptions(limbs="auto", split_weights=True))
    )
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6


@pytest.mark.ci
@pytest.mark.parametrize("before", [False, True], ids=["at once", "later"])
def test_a_skin_without_inverse_binds_gets_them_where_twist_joints_get_weight(
    before: bool, tmp_path: Path
) -> None:
    """Without, a matrix is the identity, so the first twist joint with weight would move its vertices."""
    builder = bone([[0.5, 0.5, 0, 0]] * 3)
    builder.gltf["skins"][0].pop("inverseBindMatrices")
    source, target = builder.glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    if before:
        rigged = tmp_path / "rigged.glb"
        edit(source, rigged, lambda r, report: add_twist(r, options=replace(SPLIT, split_weights=False)))
        assert "inverseBindMatrices" not in glb_json(rigged)["skins"][0]
        source = rigged
    edit(source, target, split)
    assert any("twist" in name for row in named(read(target)) for name in row)
    assert read(target).rig.skins[0].stored
    edit(target, tmp_path / "bare.glb", lambda rig, report: strip(rig))
    assert verify(source, tmp_path / "bare.glb").deviation <= TOLERANCE


# What may stand where an attribute, a primitive or a mesh should.
WRONG = (999, -1, 1.5, "x", [1])


@pytest.mark.parametrize("key", ["JOINTS_0", "WEIGHTS_0", "POSITION", "attributes", "primitives", "mesh"])
def test_weights_that_cannot_be_read_are_refused_where_they_are_stored(key: str, tmp_path: Path) -> None:
    """All else of such a file can be edited, with the warning that its mesh is kept and not checked."""
    for wrong in WRONG:
        builder = bone([[1, 0, 0, 0]] * 3)
        owners = [*builder.gltf["nodes"], *builder.gltf["meshes"], *builder.gltf["meshes"][0]["primitives"]]
        (owner,) = (x for x in [*owners, owners[-1]["attributes"]] if key in x)
        owner[key] = wrong
        with pytest.raises(FileError, match=r"in\.glb: (meshes|nodes)\["):
            result(builder, tmp_path)


@pytest.mark.parametrize("path", ["translation", "scale"])
@pytest.mark.parametrize("way", ["STEP", "CUBICSPLINE"])
def test_no_weight_goes_to_a_twist_joint_that_a_clip_moves(path: Channel, way: Any, tmp_path: Path) -> None:
    rig = read(bone([[1, 0, 0, 0]] * 3).glb(tmp_path / "in.glb")).rig
    rig = add_twist(rig, options=replace(SPLIT, split_weights=False), report=Report())
    (node, *_) = rig.nodes_of("twist")
    rest = {"translation": rig.translation, "scale": rig.scale}[path][node]
    for off in (1.0, 1.001):
        values = rest[np.newaxis] * off if way == "STEP" else np.stack([0 * rest, rest * off, 0 * rest])[None]
        track = Track(node, path, way, np.zeros(1), values)
        moved = replace(rig, clips=(Clip("wave", (track,)),))
        if off == 1.0:
            assert split(moved, Report()).pending.weight_redistributions
        else:
            with pytest.raises(GeometryError, match=f"another {path} in clip 'wave'"):
                split(moved, Report())


def test_sets_of_other_lengths_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"meshes\[0\]\.primitives\[0\]: .* not as many"):
        result(bone([[1, 0, 0, 0]] * 2), tmp_path)


def test_a_mesh_that_only_new_joints_make_readable_is_compared_with_none(tmp_path: Path) -> None:
    builder = bone([[1, 0, 0, 0], [0.5, 0.5, 0, 0], [0, 1, 0, 0]])
    (primitive,) = builder.gltf["meshes"][0]["primitives"]
    beyond = builder.accessor([[0, len(builder.gltf["skins"][0]["joints"]), 0, 0]] * 3, "u1")
    other = {"attributes": primitive["attributes"] | {"JOINTS_0": beyond}}
    builder.gltf["meshes"][0]["primitives"].insert(0, other)
    written = result(builder, tmp_path)
    assert written.rig.nodes_of("twist")


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_second_split_after_pose_changes_no_byte_and_strip_takes_it_out(
    suffix: str, samples: Path, tmp_path: Path
) -> None:
    """Before, twist joints were bound anew where they stood posed, and so compared: both ended with 6."""
    split, posed, again = (tmp_path / f"{name}{suffix}" for name in ("split", "posed", "again"))
    twist = ("--limbs", "auto", "--split-weights")
    cli("add-twist", samples / f"biped{suffix}", "-o", split, *twist, code=0)
    cli("pose", split, "--at", "walk@0.3", "-o", posed, code=0)
    cli("add-twist", posed, "-o", again, *twist, code=0)
    assert again.read_bytes() == posed.read_bytes()
    stripped = cli("strip", posed, "-o", tmp_path / f"bare{suffix}", "--json", code=0).json["verification"]
    assert stripped["deviation"] < 1e-6 < 1e-3 < stripped["motion"]["deviation"]


SHARED = AddTwistOptions(limbs="auto", split_weights=True)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_one_edit_shares_weights_and_gives_the_joints_another_rest_pose(
    suffix: str, samples: Path, tmp_path: Path
) -> None:
    """Before, it was refused with 6: what the new pose moves was held against the old one."""

    def step(rig: Rig, report: Report) -> Rig:
        shared = add_twist(rig, options=SHARED, report=report)
        return rigtri.set_rest(shared, pose="tpose", report=report)

    outcome = edit(samples / f"biped{suffix}", tmp_path / f"out{suffix}", step)
    assert outcome.verification is not None
    assert outcome.verification.deviation < 1e-6 < 0.1 < outcome.verification.motion.deviation


def test_joints_leave_no_skin_whose_weights_wait_to_be_shared(samples: Path) -> None:
    """Before, a rivet there ended with a traceback: rows of the skin were counted with and without them."""
    shared = add_twist(read(samples / "biped.glb").rig, options=SHARED)
    with pytest.raises(UsageError, match="write the file between the two"):
        rigtri.merge_joints(shared, joints=["fingers_*"])
