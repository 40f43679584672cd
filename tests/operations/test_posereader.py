"""add-posereader: weights that follow a joint's pose, and what they drive."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Golden
from morphs import WEIGHT_TIMES, WEIGHTS, arm, arm_usd
from numpy.testing import assert_allclose
from places import SAMPLES
from program import cli
from pxr import Usd
from rigs import chain
from second_opinions import khronos_errors, usd_errors, validator

import rigtri
from rigtri.errors import FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation import sampling
from rigtri.evaluation.pose_readers import PoseReader, Target, relative, twist, weights
from rigtri.evaluation.sampling import locals_at, sample, worlds
from rigtri.formats import read
from rigtri.limits import TOLERANCE
from rigtri.maths.matrices import compose, identity, multiply, rotate_before
from rigtri.maths.quaternions import IDENTITY, from_axis_angle
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats, exponential
from rigtri.model.animation import Track
from rigtri.model.metadata import PoseReaderRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.add_posereader.corrective_joints import _at_rest
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.edit import Outcome, edit
from rigtri.report import Report
from rigtri.verification.compare.compare import verify
from rigtri.verification.compare.expected_result import ExpectedResult, check_result
from rigtri.verification.compare.morph_changes import MorphChanges

X, Y, Z = np.eye(3)
# Up at rest; the arm's clip turns the lower joint's y axis to −x.
UP = Goal("up", direction=(0, 1, 0))
SIDE = Goal("side", direction=(-1, 0, 0))
BULGE = AddPosereaderOptions(
    driver="lower", axis=(0, 1, 0), target=(SIDE,), morph=(("side", "Skin", "bulge"),), name="reader"
)


def turned(*turns: Floats) -> Floats:
    """World matrices of a driver, (f, 4, 4)."""
    return compose(np.zeros((len(turns), 3)), np.array(turns), np.ones((len(turns), 3)))


def about_z(*degrees: float) -> Floats:
    return np.stack([from_axis_angle(Z, np.radians(d)) for d in degrees])


def read_out(reader: PoseReader, turns: Floats, **nodes: Floats) -> Floats:
    return weights(reader, turned(*turns), identity(len(turns)), nodes)


def posed(*degrees: float, **more: Any) -> PoseReader:
    """An rbf reader of the y axis with poses turned about z."""
    targets = tuple(Target(f"p{k}", rotation=q) for k, q in enumerate(about_z(*degrees)))
    return PoseReader("rbf", Y, targets, **more)


def test_a_dot_reader_is_the_cosine_not_below_zero() -> None:
    reader = PoseReader("dot", Y, (Target("up", direction=Y),))
    assert_allclose(read_out(reader, about_z(0, 60, 90, 120))[:, 0], [1, 0.5, 0, 0], atol=1e-12)


def test_a_node_to_point_at_may_move() -> None:
    """The talk's node: the driver's axis against the way from driver to target."""
    reader = PoseReader("dot", X, (Target("t", node="goal"),))
    goal = identity(3)
    goal[:, 3, :3] = [[5, 0, 0], [3, 4, 0], [-1, 0, 0]]
    assert_allclose(read_out(reader, np.tile(IDENTITY, (3, 1)), goal=goal)[:, 0], [1, 0.6, 0], atol=1e-12)


def test_a_cone_is_one_inside_and_zero_outside() -> None:
    reader = PoseReader("cone", Y, (Target("up", direction=Y),), inner=np.radians(20), outer=np.radians(60))
    assert_allclose(
        read_out(reader, about_z(0, 20, 30, 40, 60, 80))[:, 0], [1, 1, 0.75, 0.5, 0, 0], atol=1e-9
    )


@pytest.mark.parametrize("kernel", ["linear", "gaussian"])
@pytest.mark.parametrize("mode", ["swing", "both"])
def test_an_rbf_reader_is_one_at_its_pose_and_zero_at_the_others(kernel: Any, mode: Any) -> None:
    reader = posed(0, 40, 100, 175, kernel=kernel, mode=mode)
    assert_allclose(read_out(reader, about_z(0, 40, 100, 175)), np.eye(4), atol=1e-9)
    anywhere = read_out(reader, about_z(*np.linspace(-180, 180, 91)))
    assert (anywhere >= 0).all()
    assert (anywhere.sum(axis=1) <= 1 + 1e-12).all()


def test_linear_poses_fade_out_at_the_nearest_other_by_hand() -> None:
    """Poses at 0°, 40° and 100°: they reach 40°, 40° and 60°."""
    found = read_out(posed(0, 40, 100), about_z(10, 60, -20))
    assert_allclose(found, [[0.75, 0.25, 0], [0, 0.5, 1 / 3], [0.5, 0, 0]], atol=1e-9)


def test_two_gaussians_by_hand() -> None:
    """At 60° the functions are e^−4.5 and e^−½, untangled by the matrix 1, e^−2; at 20° both share 1."""
    found = read_out(posed(0, 40, kernel="gaussian"), about_z(60, 20))
    second = (np.exp(-0.5) - np.exp(-2) * np.exp(-4.5)) / (1 - np.exp(-4))
    assert_allclose(found, [[0, second], [0.5, 0.5]], atol=1e-9)


def test_twist_poses_do_not_see_the_swing() -> None:
    turns = np.stack([from_axis_angle(Y, np.radians(d)) for d in (0, 90)])
    targets = tuple(Target(f"p{k}", rotation=q) for k, q in enumerate(turns))
    reader = PoseReader("rbf", Y, targets, mode="twist", rest=IDENTITY)
    assert_allclose(read_out(reader, about_z(0, 30, 90)), [[1, 0]] * 3, atol=1e-9)
    assert_allclose(twist(reader, turns), [0, np.pi / 2], atol=1e-12)
    assert_allclose(read_out(reader, np.array([from_axis_angle(Y, np.pi / 4)])), [[0.5, 0.5]], atol=1e-9)
    assert twist(reader, from_axis_angle(Z, np.pi)) == pytest.approx(0.0, abs=1e-12)


def test_readers_of_many_frames_are_those_of_each() -> None:
    reader, turns = posed(0, 40, 100, kernel="gaussian"), about_z(*range(0, 120, 7))
    together = read_out(reader, turns)
    assert_allclose(together, [read_out(reader, turns[k : k + 1])[0] for k in range(len(turns))], atol=1e-14)


def test_a_driver_without_axes_weighs_nothing() -> None:
    flat = turned(IDENTITY) * np.array([0.0, 0, 0, 1])[:, np.newaxis]
    reader = PoseReader("dot", Y, (Target("up", direction=Y),))
    assert weights(reader, flat, identity(1), {}).tolist() == [[0.0]]


def test_the_exponential_is_the_exponential() -> None:
    x = -np.linspace(0, 699, 20001)
    assert_allclose(exponential(x), np.exp(x), rtol=1e-14, atol=0)
    assert exponential(-1e9) == 0.0


def driven(source: Path, target: Path, options: AddPosereaderOptions = BULGE) -> Outcome:
    return edit(
        source,
        target,
        lambda rig, report: add_posereader(rig, options=options, report=report),
        overwrite=True,
    )


def weights_of(path: Path, times: Floats) -> Floats:
    """The weights of ``bulge`` and ``other`` in the one clip with keys, (f, 2)."""
    rig = read(path).rig
    (mesh,) = (mesh for mesh in rig.meshes if len(mesh.morphs))
    clip = next(clip for clip in rig.clips if any(track.path == "weights" for track in clip.tracks))
    return np.array(sampling.morph_weights(mesh, clip, times))


def source_of(kind: str, folder: Path, **more: Any) -> Path:
    return arm(**more).glb(folder / "in.glb") if kind == "glb" else arm_usd(folder, **more)


def for_kind(kind: str, options: AddPosereaderOptions = BULGE) -> AddPosereaderOptions:
    return options if kind == "glb" else replace(options, driver="b")


@pytest.mark.ci
@pytest.mark.parametrize("kind", ["glb", "usda"])
def test_a_morph_follows_the_pose_and_the_other_keeps_its_keys(kind: str, tmp_path: Path) -> None:
    source = source_of(kind, tmp_path)
    once, twice = tmp_path / f"once.{kind}", tmp_path / f"twice.{kind}"
    outcome = driven(source, once, for_kind(kind))
    assert outcome.verification is not None
    assert outcome.verification.deviation == 0.0
    assert outcome.verification.motion is not None
    assert outcome.verification.motion.deviation > 0.1
    second = 1.0 if kind == "glb" else 24.0
    times = np.linspace(0, 1, 41)
    found = weights_of(once, times * second)
    assert_allclose(found[:, 0], np.sin(np.pi / 2 * times), atol=2e-4)
    assert_allclose(found[:, 1], np.interp(times, WEIGHT_TIMES, np.array(WEIGHTS)[:, 1]), atol=1e-7)
    assert_allclose(weights_of(once, np.array([0.0, second]))[:, 0], [0, 1], atol=1e-7)
    driven(once, twice, for_kind(kind))
    assert once.read_bytes() == twice.read_bytes()
    for note in read(once).rig.metadata.values():
        validator("node").validate(note)


@pytest.mark.parametrize("kind", ["glb", "usda"])
def test_the_same_reader_evaluated_from_its_metadata_gives_the_same(kind: str, tmp_path: Path) -> None:
    source = source_of(kind, tmp_path)
    driven(source, tmp_path / f"out.{kind}", for_kind(kind))
    rig = read(tmp_path / f"out.{kind}").rig
    (note,) = (note for note in rig.metadata.values() if note["type"] == "poseReader")
    second = 1.0 if kind == "glb" else 24.0
    times = np.linspace(0, second, 9)
    world = sampling.worlds(rig, sampling.locals_at(rig, rig.clips[0], times))
    said = weights(
        PoseReader.of_record(PoseReaderRecord.from_dict(note)),
        world[:, rig.find(note["driver"])],
        world[:, rig.find(note["frame"])],
        {},
    )
    assert_allclose(said[:, 0], weights_of(tmp_path / f"out.{kind}", times)[:, 0], atol=2e-4)


@pytest.mark.ci
@pytest.mark.parametrize("kind", ["glb", "usda"])
def test_verify_by_itself_sees_what_was_driven(kind: str, tmp_path: Path) -> None:
    source, target = source_of(kind, tmp_path), tmp_path / f"out.{kind}"
    driven(source, target, for_kind(kind))
    assert not verify(read(source), read(target)).passes()
    cli("verify", source, target, code=6)


@pytest.mark.ci
def test_the_self_check_excludes_driven_targets_alone(tmp_path: Path) -> None:
    source, target = arm().glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    driven(source, target)
    before, after = read(source), read(target)

    def passes(changes: MorphChanges) -> bool:
        return check_result(ExpectedResult(before, before.rig, changes), after, TOLERANCE).passes()

    assert passes({2: {0}})
    assert not passes({2: {1}})
    assert not passes({7: {0}})
    assert passes({2: {0, 1}})


def test_steps_of_other_morphs_stay_steps(tmp_path: Path) -> None:
    source, target = arm(weights="STEP").glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    driven(source, target)
    times = np.array([0, 0.2, 0.499, 0.5, 0.75, 0.999, 1.0])
    assert_allclose(weights_of(target, times)[:, 1], weights_of(source, times)[:, 1], atol=1e-7)


def test_spline_weights_are_refused_by_name(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"'bend'.*'Skin' are splines"):
        driven(arm(weights="CUBICSPLINE").glb(tmp_path / "in.glb"), tmp_path / "out.glb")
    assert not (tmp_path / "out.glb").exists()


@pytest.mark.ci
def test_weights_that_nothing_drove_get_a_channel_of_their_own(tmp_path: Path) -> None:
    source, target = arm(weights=None).glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    driven(source, target)
    found = weights_of(target, np.array([0.0, 1.0]))
    assert_allclose(found, [[0, 0.25], [1, 0.25]], atol=1e-7)
    before, after = khronos_errors(source, target)
    assert not after - before


def test_usd_defaults_of_other_blend_shapes_stay(tmp_path: Path) -> None:
    source = arm_usd(
        tmp_path, weights='uniform token[] blendShapes = ["other"]\nfloat[] blendShapeWeights = [0.3]'
    )
    driven(source, tmp_path / "out.usda", for_kind("usda"))
    stage = Usd.Stage.Open(str(tmp_path / "out.usda"))
    animation = stage.GetPrimAtPath("/Root/Anim")
    assert list(animation.GetAttribute("blendShapes").Get()) == ["other", "bulge"]
    values = animation.GetAttribute("blendShapeWeights")
    assert_allclose(values.Get(24.0), [0.3, 1.0], atol=1e-6)
    assert_allclose(values.Get(), [0.3, 0.0], atol=1e-6)
    assert not usd_errors(tmp_path / "out.usda") - usd_errors(source)


def test_a_blend_shape_of_two_meshes_is_driven_in_both_or_not_at_all(tmp_path: Path) -> None:
    text = arm_usd(tmp_path).read_text("utf-8")
    start = text.index('def Mesh "Skin"')
    twin = text[start : text.rindex("}")].replace("Skin", "Twin")
    source = tmp_path / "twins.usda"
    source.write_text(text[: text.rindex("}")] + twin + "}\n", "utf-8")
    with pytest.raises(FileError, match=r"'bulge' is also one of </Root/Twin>"):
        driven(source, tmp_path / "out.usda", for_kind("usda"))
    both = (("side", "Skin", "bulge"), ("side", "Twin", "bulge"))
    driven(source, tmp_path / "out.usda", replace(for_kind("usda"), morph=both))


@pytest.mark.ci
@pytest.mark.parametrize("kind", ["glb", "usda"])
def test_a_target_without_a_morph_gets_a_node_with_its_weight(kind: str, tmp_path: Path) -> None:
    source, target = source_of(kind, tmp_path), tmp_path / f"out.{kind}"
    options = replace(for_kind(kind), target=(UP, SIDE), morph=())
    outcome = driven(source, target, options)
    assert outcome.verification is not None
    assert outcome.verification.passes()
    assert verify(read(source), read(target)).passes()
    rig = read(target).rig
    node = rig.find("reader_up")
    (track,) = (t for c in rig.clips for t in c.tracks if t.node == node and t.path == "translation")
    second = 1.0 if kind == "glb" else 24.0
    times = np.linspace(0, second, 17)
    assert_allclose(sampling.sample(track, times)[:, 0], np.cos(np.pi / 2 * times / second), atol=2e-4)
    assert rig.translation[node, 0] == pytest.approx(1.0)


def control(rig: Rig, report: Report) -> Rig:
    return add_controls(rig, options=AddControlsOptions(joints=("b",)), report=report)


def with_control(rig: Rig, report: Report) -> Rig:
    rig = control(rig, report)
    options = replace(for_kind("usda"), morph=(), attribute=(("side", "b_ctl", "bulge"),))
    return add_posereader(rig, options=options, report=report)


@pytest.mark.parametrize("stored", [False, True], ids=["a new control", "one that the file has"])
def test_a_control_has_the_value_as_an_attribute_over_time(stored: bool, tmp_path: Path) -> None:
    source = arm_usd(tmp_path)
    if stored:
        edit(source, tmp_path / "before.usda", control)
        source = tmp_path / "before.usda"
    edit(source, tmp_path / "once.usda", with_control)
    edit(tmp_path / "once.usda", tmp_path / "twice.usda", with_control)
    assert (tmp_path / "once.usda").read_bytes() == (tmp_path / "twice.usda").read_bytes()
    stage = Usd.Stage.Open(str(tmp_path / "once.usda"))
    (prim,) = (prim for prim in stage.Traverse() if prim.GetName() == "b_ctl")
    value = prim.GetAttribute("userProperties:bulge")
    assert value.Get(0.0) == pytest.approx(0.0, abs=1e-7)
    assert value.Get(24.0) == pytest.approx(1.0)


def test_values_of_a_control_that_usd_would_call_alike_are_refused(tmp_path: Path) -> None:
    """Before, both were written into one attribute."""
    rig = add_controls(read(arm_usd(tmp_path)).rig, options=AddControlsOptions(joints=("b",)))
    goals, values = (
        (SIDE, Goal("up", direction=(0, 1, 0))),
        (("side", "b_ctl", "手 1"), ("up", "b_ctl", "手_1")),
    )
    options = replace(for_kind("usda"), morph=(), target=goals, attribute=values)
    with pytest.raises(UsageError, match="two targets would drive the value '手_1' of 'b_ctl'"):
        add_posereader(rig, options=options)


def test_a_record_holds_what_its_kind_of_reader_goes_by_and_nothing_else(tmp_path: Path) -> None:
    rig = read(arm().glb(tmp_path / "in.glb")).rig
    more: dict[str, dict[str, Any]] = {
        "dot": {"signed": True},
        "cone": {"inner": 10.0, "outer": 50.0},
        "rbf": {"kernel": "gaussian", "mode": "both"},
    }
    for kind, given in more.items():
        goals = (Goal("half", pose="bend@0.5"),)
        options = AddPosereaderOptions(driver="lower", reader=kind, target=goals, **given)  # type: ignore[arg-type]
        (record,) = add_posereader(rig, options=options).records(PoseReaderRecord).values()
        found = {
            "signed": record.signed,
            "inner": record.inner,
            "outer": record.outer,
            "kernel": record.kernel,
            "mode": record.mode,
        }
        assert found == {"signed": False, "inner": None, "outer": None, "kernel": None, "mode": None} | given
        assert (record.rest is not None) == (kind == "rbf")
        (target,) = record.targets
        assert (target.rotation is not None) == (kind == "rbf")
        assert (target.direction is not None) == (kind != "rbf")


@pytest.mark.ci
def test_a_pose_of_a_clip_is_read_as_one_at_its_time(tmp_path: Path) -> None:
    rig = read(arm().glb(tmp_path / "in.glb")).rig
    for kind in ("dot", "cone", "rbf"):
        goals = (Goal("half", pose="bend@0.5"), Goal("start", pose="rest"))
        out = add_posereader(
            rig, options=AddPosereaderOptions(driver="lower", axis=(0, 1, 0), reader=kind, target=goals)
        )  # type: ignore[arg-type]
        node = out.find("lower_reader_half")
        (track,) = (t for t in out.clips[0].tracks if t.node == node)
        assert sampling.sample(track, [0.5])[0, 0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [
        ({"driver": ""}, UsageError, "--driver"),
        ({"driver": "lowre"}, NameNotFoundError, "Did you mean 'lower'"),
        ({"target": ()}, UsageError, "--target"),
        ({"target": (Goal("side", direction=(0, 0, 0)),)}, UsageError, "other than 0,0,0"),
        ({"target": (Goal("side", pose="bend@then"),)}, UsageError, "CLIP@TIME"),
        ({"target": (Goal("side", pose="walk@1"),)}, NameNotFoundError, "walk"),
        ({"target": (SIDE, SIDE)}, UsageError, "name of its own"),
        ({"morph": (("side", "Skim", "bulge"),)}, NameNotFoundError, "Did you mean 'Skin'"),
        ({"morph": (("side", "Skin", "bulg"),)}, NameNotFoundError, "Did you mean 'bulge'"),
        ({"morph": (("sid", "Skin", "bulge"),)}, UsageError, "use one of side"),
        ({"attribute": (("side", "upper", "x"),)}, UsageError, "is not a control"),
        ({"reader": "cone", "inner": 50.0, "outer": 40.0}, UsageError, "larger outer"),
        ({"reader": "rbf", "target": (Goal("side", node="upper"),)}, UsageError, "reads poses"),
        ({"target": (Goal("side", node="lower"),)}, UsageError, "does not point at itself"),
        ({"name": "upper"}, UsageError, "another node is called so"),
        (
            {"reader": "rbf", "target": (SIDE, Goal("same", pose="bend@1"))},
            GeometryError,
            "'side' and 'same' are the same pose",
        ),
    ],
)
def test_what_reads_no_pose_is_reported(
    changes: dict[str, Any], error: type[Exception], words: str, tmp_path: Path
) -> None:
    rig = read(arm().glb(tmp_path / "in.glb")).rig
    with pytest.raises(error, match=words):
        add_posereader(rig, options=replace(BULGE, **changes))


def test_a_file_without_morphs_is_an_error_that_lists_what_there_is(tmp_path: Path, samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    name = rig.names[rig.meshes[0].node]
    joint = rig.names[int(rig.skins[0].joints[3])]
    options = replace(BULGE, driver=joint, morph=(("side", name, "bulge"),))
    with pytest.raises(GeometryError, match="no other mesh of this file has any"):
        add_posereader(rig, options=options)


def test_without_clips_nothing_is_driven_and_that_is_reported(tmp_path: Path) -> None:
    source, target = arm(clips=False).glb(tmp_path / "in.glb"), tmp_path / "out.glb"
    outcome = driven(source, target)
    assert [notice.code for notice in outcome.report.warnings] == ["reader-without-clips"]
    assert verify(read(source), read(target)).passes()


@pytest.mark.parametrize("kind", ["glb", "usda"])
def test_the_command_does_what_a_reviewer_has_read(kind: str, tmp_path: Path, golden: Golden) -> None:
    source, out = source_of(kind, tmp_path), tmp_path / f"out.{kind}"
    line = [
        "add-posereader",
        source,
        "-o",
        out,
        "--driver",
        "b" if kind == "usda" else "lower",
        "--axis",
        "y",
    ]
    line += ["--target", "side=-1,0,0", "--target", "rest", "--morph", "side", "Skin", "bulge", "--json"]
    result = cli(*line, code=0)
    document = json.loads(result.stdout)
    validator("report").validate(document)
    assert document["verification"]["motion"]["deviation"] > 0.1
    told = cli("inspect", out).stdout
    golden.check(f"add-posereader_{kind}.txt", told.replace(str(out), f"out.{kind}"))


def measured(*line: Any) -> dict[str, Any]:
    """What a command says of how far its result is from its source."""
    document = json.loads(cli(*line, "--json", code=0).stdout)
    return dict(document["verification"])


READER = ["--axis", "y", "--target", "side=-1,0,0", "--morph", "side", "Skin", "bulge", "--name", "r"]


@pytest.mark.parametrize("kind", ["glb", "usda"])
def test_what_goes_with_a_reader_is_said_by_strip(kind: str, tmp_path: Path) -> None:
    """Before, it said that nothing moves."""
    source, target, bare = source_of(kind, tmp_path), tmp_path / f"out.{kind}", tmp_path / f"bare.{kind}"
    driven(source, target, for_kind(kind))
    found = measured("strip", target, "-o", bare)
    far = verify(read(target), read(bare)).deviation
    assert far > 0.1
    assert found["deviation"] <= TOLERANCE
    assert found["motion"]["deviation"] == pytest.approx(far, rel=1e-6)


def test_morph_targets_that_are_driven_beside_joints_are_measured(tmp_path: Path) -> None:
    """Before, they were said to move 1e-9, for what was expected had their weights already."""
    source, out, again = (arm_usd(tmp_path), tmp_path / "out.usda", tmp_path / "again.usda")
    joint = ["--driver", "b", *READER, "--joint", "side", "c", "tx=0.001"]
    seen = measured("add-posereader", source, "-o", out, *joint)["motion"]
    cli("add-posereader", source, "-o", again, "--driver", "b", *READER, code=0)
    assert max(seen["meshes"].values()) == pytest.approx(seen["deviation"])
    assert seen["deviation"] == pytest.approx(verify(read(source), read(again)).deviation, rel=1e-2)


def test_a_build_says_what_each_of_its_steps_drives(tmp_path: Path) -> None:
    """Before, it said so of a last step alone, or that everything in the file was unchanged."""
    source, out, spec = arm().glb(tmp_path / "in.glb"), tmp_path / "out.glb", tmp_path / "a.rig.yaml"
    reader = (
        "{do: add-posereader, driver: lower, axis: y, target: ['side=-1,0,0'], morph: [[side, Skin, bulge]]}"
    )
    spec.write_text(f"steps:\n  - {reader}\n  - {{do: add-controls, joints: [upper]}}\n", "utf-8")
    found = measured("build", source, "--spec", spec, "-o", out)
    alone = measured("add-posereader", source, "-o", tmp_path / "one.glb", "--driver", "lower", *READER)
    assert found["motion"] == alone["motion"]
    assert not found["identical"]


def test_options_of_another_kind_of_reader_are_refused(tmp_path: Path) -> None:
    source = arm().glb(tmp_path / "in.glb")
    line = ["add-posereader", source, "-o", tmp_path / "out.glb", "--driver", "lower", "--target", "rest"]
    result = cli(*line, "--outer", "40", code=2)
    assert "--outer is for --reader cone" in result.stderr


def test_a_pose_outside_its_clip_is_that_at_the_end_and_reported(tmp_path: Path) -> None:
    """In the words of other commands; glTF stores 1.4 s as 1.39999998, which is no moment outside."""
    rig = read(arm().glb(tmp_path / "in.glb")).rig
    (clip,) = rig.clips
    longer = tuple(replace(t, times=np.float32(t.times * 1.4).astype(np.float64)) for t in clip.tracks)
    rig = replace(rig, clips=(replace(clip, tracks=longer),))
    readers = []
    for time, told in (("1.4", 0), ("500", 1)):
        report = Report()
        goal = Goal("side", pose=f"bend@{time}")
        out = add_posereader(rig, options=AddPosereaderOptions(driver="lower", target=(goal,)), report=report)
        texts = [notice.text for notice in report.warnings if notice.code == "pose-outside"]
        assert len(texts) == told
        assert all("has keys from 0 to 1.4; at 500 it holds the nearest pose" in text for text in texts)
        readers.append(
            next(note for note in out.metadata.values() if note["type"] == "poseReader")["targets"]
        )
    assert readers[0] == readers[1]


@pytest.mark.ci
@pytest.mark.parametrize("kind", ["dot", "rbf"])
def test_a_reader_gives_the_same_for_a_pose_after_its_joints_were_reoriented(
    kind: str, samples: Path
) -> None:
    goals = (Goal(name="a", direction=(0.0, 1.0, 0.0)), Goal(name="b", pose="walk@0.5"))
    mode = {"mode": "both"} if kind == "rbf" else {}
    options = AddPosereaderOptions(driver="forearm_R", target=goals, reader=kind, name="e", **mode)  # type: ignore[arg-type]
    rig = add_posereader(read(samples / "biped.glb").rig, options=options)
    out = orient_joints(rig, options=OrientJointsOptions())
    found = []
    for each in (rig, out):
        note = next(note for note in each.metadata.values() if note["type"] == "poseReader")
        clip = each.clip("walk")
        world = sampling.worlds(each, sampling.locals_at(each, clip, sampling.key_times(clip)))
        driver, frame = (world[:, each.find(note[key])] for key in ("driver", "frame"))
        found.append(weights(PoseReader.of_record(PoseReaderRecord.from_dict(note)), driver, frame, {}))
    assert_allclose(found[1], found[0], atol=1e-6)
    assert np.ptp(found[0]) > 0.01


@pytest.mark.ci
def test_a_morph_target_that_another_reader_drives_is_reported(tmp_path: Path) -> None:
    report = Report()
    rig = read(arm().glb(tmp_path / "arm.glb")).rig
    mesh, morph = next((m, m.morph_names[0] if m.morph_names else "0") for m in rig.meshes if len(m.morphs))
    for name in ("one", "two"):
        options = AddPosereaderOptions(
            driver=rig.names[int(rig.skins[0].joints[-1])],
            target=(Goal(name="a", direction=(0.0, 1.0, 0.0)),),
            morph=(("a", rig.names[mesh.node], morph),),
            name=name,
        )
        rig = add_posereader(rig, options=options, report=report)
    assert [notice.code for notice in report.warnings if notice.code == "morph-driven-twice"]


def test_a_reader_that_drives_a_morph_no_longer_gives_its_keys_back(tmp_path: Path) -> None:
    source = read(arm().glb(tmp_path / "arm.glb")).rig
    mesh = next(m for m in source.meshes if len(m.morphs))
    goals = (Goal(name="a", direction=(0.0, 1.0, 0.0)),)
    driving = AddPosereaderOptions(
        driver="lower", target=goals, name="r", morph=(("a", source.names[mesh.node], "bulge"),)
    )
    rig = add_posereader(source, options=driving)
    rig = add_posereader(rig, options=replace(driving, morph=()))
    for was, now in zip(source.clips, rig.clips, strict=True):
        old, new = (next(t for t in c.tracks if t.path == "weights") for c in (was, now))
        assert np.array_equal(old.times, new.times)
        assert_allclose(new.values, old.values, atol=1e-7)


def test_the_axis_is_along_the_bone_unless_another_is_named(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    built = add_posereader(rig, driver="forearm_L", target=("up=0,1,0",), name="reader")
    (record,) = built.records(PoseReaderRecord).values()
    bone = rig.world[rig.find("hand_L"), 3, :3] - rig.world[rig.find("forearm_L"), 3, :3]
    pointed = np.array(record.axis) @ rig.world[rig.find("forearm_L"), :3, :3]
    assert_allclose(pointed, bone / np.linalg.norm(bone), atol=1e-6)


def test_a_signed_reader_is_the_cosine_on_both_sides_and_a_target_met_at_rest_is_warned_of(
    samples: Path,
) -> None:
    rig = read(samples / "biped.glb").rig
    x, y, z = (-rig.world[rig.find("forearm_L"), 0, :3]).tolist()
    for signed, expected in ((True, -1.0), (False, 0.0)):
        report = Report()
        options = AddPosereaderOptions(
            driver="forearm_L", axis=(1, 0, 0), target=(Goal("back", direction=(x, y, z)),), signed=signed
        )
        built = add_posereader(rig, options=options, report=report)
        (entry,) = report.added
        assert abs(entry["rest"]["back"] - expected) < 1e-6
        assert ("target-at-rest" in {notice.code for notice in report.warnings}) == signed
        (note,) = (note for note in built.metadata.values() if note["type"] == "poseReader")
        validator("node").validate(dict(note))
    with pytest.raises(UsageError, match='is for reader="dot"'):
        add_posereader(rig, driver="forearm_L", target=("0,1,0",), reader="cone", signed=True)


@pytest.mark.parametrize(
    ("along", "signed", "told"),
    [(0.65, False, "0.65"), (-0.65, True, "-0.65"), (-0.65, False, ""), (0.2, False, ""), (-0.2, True, "")],
)
def test_a_target_that_is_partly_met_at_rest_is_warned_of(
    along: float, signed: bool, told: str, samples: Path
) -> None:
    rig = read(samples / "biped.glb").rig
    x, y, _ = rig.world[rig.find("forearm_L"), :3, :3]
    goal = Goal("back", direction=tuple((along * x + np.sqrt(1.0 - along**2) * y).tolist()))
    options = AddPosereaderOptions(driver="forearm_L", axis=(1, 0, 0), target=(goal,), signed=signed)
    add_posereader(rig, options=options, report=(report := Report()))
    texts = [notice.text for notice in report.warnings if notice.code == "target-at-rest"]
    assert len(texts) == bool(told)
    assert all(f"the weight {told} at rest" in text for text in texts)
    assert all("without a clip the file looks as before" in text for text in texts)


# --- corrective joints


ELBOW: Any = {"driver": "forearm_L", "target": ("bent=walk@0.5", "rest"), "reader": "rbf", "name": "elbow"}


def _helped(name: str = "biped.glb") -> Rig:
    """The biped with a helper at the left elbow and its end."""
    rig, points = rigtri.read(SAMPLES / name), ((0.4, 1.25, -0.03), (0.4, 1.2, -0.05))
    helper: Any = {"name": "fix", "side": "left", "parent": "upper_arm_L", "up_from": "world:+z"}
    return rigtri.make_limb(rig, points=points, **helper)


def _bent(*joint: tuple[str, str, str]) -> Rig:
    return rigtri.add_posereader(_helped(), joint=joint, **ELBOW)


def _local(rig: Rig, joint: str, time: float) -> Floats:
    clip = next(clip for clip in rig.clips if clip.name == "walk")
    found: Floats = locals_at(rig, clip, np.array([time]))[0, rig.find(joint)]
    return found


def test_a_corrective_joint_moves_turns_and_grows_with_the_weight() -> None:
    rig = _bent(("bent", "fix_1_L", "tx=0.02,ty=-0.01,rz=30,sx=2"))
    rest = rig.local[rig.find("fix_1_L")]
    found = _local(rig, "fix_1_L", 0.5)
    assert_allclose(found[3, :3] - rest[3, :3], [0.02, -0.01, 0], atol=1e-5)
    half, root = 0.5, np.sqrt(0.75)
    turned = np.array([[2 * root, 2 * half, 0], [-half, root, 0], [0, 0, 1]]) @ rest[:3, :3]
    assert_allclose(found[:3, :3], turned, atol=1e-4)
    assert _local(rig, "fix_1_L", 0.5).tolist() != _local(rig, "fix_1_L", 0.25).tolist()
    other = rigtri.add_posereader(
        _helped(), joint=(("bent", "fix_1_L", "tx=0.02"),), **ELBOW | {"name": "twin"}
    )
    bare = rigtri.strip(other)
    assert [len(clip.tracks) for clip in bare.clips] == [len(clip.tracks) for clip in _helped().clips]


@pytest.mark.ci
def test_a_second_run_of_corrective_joints_changes_nothing_and_another_takes_back() -> None:
    rig = _bent(("bent", "fix_1_L", "tx=0.02"))
    again = rigtri.add_posereader(rig, joint=(("bent", "fix_1_L", "TX=+.2e-1"),), **ELBOW)
    assert again.metadata == rig.metadata
    assert all(a is b for a, b in zip(again.clips, rig.clips, strict=True))
    other = rigtri.add_posereader(rig, joint=(("bent", "fix_2_L", "rx=5"),), **ELBOW)
    tracks = {(other.names[t.node], t.path) for t in other.clips[0].tracks if "fix_" in other.names[t.node]}
    assert tracks == {("fix_2_L", "rotation")}


def test_corrective_joints_go_along_with_other_axes_and_to_the_other_side() -> None:
    rig = _bent(("bent", "fix_1_L", "tx=0.02,ry=20"))
    turned = rigtri.orient_joints(rig, preset="blender")
    baked = rigtri.bake(turned, to="joints")
    for other in (turned, baked):
        before, after = (
            worlds(one, locals_at(one, one.clips[0], np.array([0.4])))[0, one.find("fix_1_L")]
            for one in (rig, other)
        )
        assert_allclose(after[3, :3], before[3, :3], atol=1e-5)
    mirrored = rigtri.mirror(rig, from_side="left")
    records = [r for r in mirrored.records(PoseReaderRecord).values() if r.driver == "forearm_R"]
    assert [output.joint for output in records[0].outputs] == ["fix_1_R"]


@pytest.mark.parametrize("pose", ["walk@0.5", "tpose", "bind"])
def test_corrective_joints_of_the_file_rest_where_they_were_in_another_rest_pose(pose: str) -> None:
    rig = replace(_helped(), metadata={})  # its exporter's own helper
    rig = rigtri.add_posereader(rig, joint=(("bent", "fix_1_L", "tx=0.05,rz=30"),), **ELBOW)
    rest = rig.translation.copy()
    rest[rig.find("fix_1_L")] += 0.01  # other than bound
    rig = rigtri.bake(replace(rig, translation=rest), to="joints")
    posed = rigtri.bake(rigtri.set_rest(rig, pose=pose), to="joints")
    before, after = (
        worlds(one, locals_at(one, one.clips[0], np.array([0.2, 0.5])))[:, one.find("fix_1_L")]
        for one in (rig, posed)
    )
    assert_allclose(after, before, atol=1e-5)


@pytest.mark.parametrize(
    ("joint", "error", "words"),
    [
        (("bent", "fix_1_L", "qx=1"), UsageError, "give changes such as"),
        (("bent", "fix_1_L", "tx=inf"), UsageError, "give changes such as"),
        (("bend", "fix_1_L", "tx=1"), UsageError, "no target 'bend'"),
        (("bent", "upper_arm_L", "tx=1"), GeometryError, "moves with it"),
        (("bent", "head", "rx=1"), GeometryError, "keys of its own"),
    ],
)
def test_what_no_corrective_joint_can_do_is_refused(
    joint: tuple[str, str, str], error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=words):
        _bent(joint)


@pytest.mark.parametrize("name", ["biped.usda", "still.glb"])
def test_strip_takes_back_what_moved_joints_of_the_file(name: str, tmp_path: Path) -> None:
    """Before, it ended with 6: the joint was expected to move as with the reader."""
    source, driven, out = tmp_path / name, tmp_path / f"driven_{name}", tmp_path / f"bare_{name}"
    helped = _helped(name if name.endswith("usda") else "biped.glb")
    rigtri.write(replace(helped, metadata={}), source)  # the helper is of the file, not of rigtri
    rigtri.write(
        rigtri.add_posereader(rigtri.read(source), joint=(("bent", "fix_1_L", "tx=0.02"),), **ELBOW), driven
    )
    cli("strip", driven, "-o", out, code=0)
    bare, before = rigtri.read(out), rigtri.read(source)
    clip = next(clip for clip in bare.clips if clip.name == "walk")
    middle = np.array([np.mean(clip.tracks[0].times)])
    found, expected = (worlds(rig, locals_at(rig, rig.clips[0], middle))[0] for rig in (bare, before))
    place = "fix_1_L"
    assert_allclose(found[bare.find(place)], expected[before.find(place)], atol=1e-6)


@pytest.mark.ci
def test_corrective_joints_are_written_as_they_were_declared(tmp_path: Path) -> None:
    for name in ("biped.glb", "biped.usda"):
        out = tmp_path / name
        time = "0.5" if name.endswith("glb") else "12"
        source = tmp_path / f"helped_{name}"
        rigtri.write(_helped(name), source)
        words = [
            "--driver",
            "forearm_L",
            "--target",
            f"bent=walk@{time}",
            "--joint",
            "bent",
            "fix_1_L",
            "tz=0.01",
        ]
        result = cli("add-posereader", source, "-o", out, *words, "--name", "elbow")
        assert result.exit_code == 0, result.stderr
        rig = rigtri.read(out)
        assert [output.joint for r in rig.records(PoseReaderRecord).values() for output in r.outputs]


def test_other_axes_of_a_sheared_driver_are_seen_as_just_that_rotation() -> None:
    """Below a squashed joint; where x would go before the other axes, the weight changes with them."""
    turn, own, seen_from = (
        from_axis_angle(axis, angle)
        for axis, angle in (([0.6, 0.0, 0.8], 2.0), ([0.8, 0.6, 0.0], 0.7), ([0.0, 1.0, 0.0], 0.4))
    )
    squashed = compose(np.zeros(3), IDENTITY, np.array([1.0, 1.5, 0.7]))
    driver = multiply(compose(np.zeros(3), own, np.ones(3)), squashed)
    frame = compose(np.zeros(3), seen_from, np.ones(3))
    expected = product(relative(driver, frame), turn)
    found = relative(rotate_before(turn, driver), frame)
    assert min(abs(found - expected).max(), abs(found + expected).max()) < 1e-12


def test_keys_that_hold_a_joint_where_it_rests_are_none_of_its_own() -> None:
    rig = chain((0, 0, 0), (1, 2, 0))
    times, half = np.array([0.0, 1.0]), np.array([0.0, 0, 0, 1])
    still = {"translation": [1.0, 2, 0], "rotation": half, "scale": [1.0, 1, 1]}
    other = {"translation": [1.0, 2, 0.1], "rotation": [0.1, 0, 0, 1], "scale": [1.0, 1.1, 1]}
    for path, rest in still.items():
        again = -half if path == "rotation" else rest
        for last, rests in ((rest, True), (again, True), (other[path], False)):
            values = np.array([rest, last])
            track = Track(1, path, "LINEAR", times, values)  # type: ignore[arg-type]
            assert _at_rest(rig, track) is rests, path


def test_weights_hold_their_bound_between_the_moments_that_are_tested() -> None:
    """Before, gaussian weights missed it by up to an eighth."""
    values = []
    for within in (1e-4, 1e-6):
        rig = rigtri.add_posereader(
            read(SAMPLES / "biped.glb").rig,
            driver="foot_L",
            reader="rbf",
            kernel="gaussian",
            target=["a=walk@0", "b=walk@0.3", "c=walk@0.6"],
            joint=[("b", "toe_R_end", "tx=1")],
            between=within,
        )
        node = rig.find("toe_R_end")
        (track,) = (track for track in rig.clips[0].tracks if track.node == node)
        values.append(sample(track, np.linspace(0.0, 1.0, 4001))[:, 0])
    assert np.abs(values[0] - values[1]).max() <= 1e-4
