"""Targets of pose readers: what their words mean, and where drivers are seen from a frame, by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import SAMPLES
from rigs import chain

import rigtri
from rigtri import add_controls, bake
from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.pose_readers import PoseReader, Target, weights
from rigtri.formats import read
from rigtri.maths.quaternions import IDENTITY, conjugate, from_axis_angle, multiply
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal
from rigtri.operations.add_posereader.targets import ReaderFrame, named_goals
from rigtri.report import Report
from rigtri.verification.checks import check

Z = np.array([0.0, 0.0, 1.0])


def rig(names: tuple[str, ...] = ("a", "b", "c")) -> Rig:
    made = replace(chain((0, 0, 0), (1, 0, 0), (2, 0, 0)), names=names)
    made.rotation[0], made.rotation[1] = from_axis_angle(Z, 0.5), from_axis_angle(Z, 0.7)
    keys = from_axis_angle(Z, np.array([0.7, 1.7]))
    track = Track(1, "rotation", "LINEAR", np.array([0.0, 1.0]), keys)
    return replace(made, clips=(Clip("bend", (track,)),))


@pytest.mark.parametrize(
    ("text", "goal"),
    [
        ("up=0,1,0", Goal("up", direction=(0.0, 1.0, 0.0))),
        ("0,1,-2.5", Goal("target1", direction=(0.0, 1.0, -2.5))),
        ("half=bend@0.5", Goal("half", pose="bend@0.5")),
        ("bend@0.5", Goal("target1", pose="bend@0.5")),
        ("start=Rest", Goal("start", pose="Rest")),
        ("ball=c", Goal("ball", node="c")),
        ("c", Goal("target1", node="c")),
        ("x=0,1", Goal("x", node="0,1")),
        ("x=a,b,c", Goal("x", node="a,b,c")),
    ],
)
def test_a_target_is_a_direction_a_pose_or_a_node(text: str, goal: Goal) -> None:
    options = AddPosereaderOptions(driver="b", reader="dot", target=(text,))  # type: ignore[arg-type]
    assert named_goals(rig(), options) == (goal,)


def test_the_name_of_a_node_that_is_there_wins() -> None:
    made = rig(("a", "up=0,1,0", "1,2,3"))
    options = AddPosereaderOptions(driver="a", target=("up=0,1,0", "x=1,2,3"))  # type: ignore[arg-type]
    assert named_goals(made, options) == (Goal("target1", node="up=0,1,0"), Goal("x", node="1,2,3"))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"target": ("x=0,1,0", "x=1,0,0")}, "each target needs a name of its own"),
        ({"target": ("target2=0,1,0", "1,0,0")}, "each target needs a name of its own"),
        (
            {"target": ("x=0,1,0",), "morph": (("y", "Skin", "m"),)},
            r"'y' \(Skin m\) is not a target: use one of x",
        ),
        ({"target": ("x=0,1,0",), "attribute": (("y", "ctl", "tx"),)}, r"'y' \(ctl tx\) is not a target"),
        (
            {"target": ("x=c",), "reader": "rbf"},
            "rbf reads poses; a node is a target of dot and cone readers",
        ),
    ],
)
def test_targets_that_cannot_be_are_refused(given: dict[str, Any], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        named_goals(rig(), AddPosereaderOptions(driver="b", **({"reader": "dot"} | given)))
    fine = {"target": ("x=0,1,0", "y=1,0,0"), "morph": (("y", "Skin", "m"),)}
    assert len(named_goals(rig(), AddPosereaderOptions(driver="b", reader="dot", **fine))) == 2  # type: ignore[arg-type]


def test_a_driver_is_seen_from_its_frame_or_from_the_world() -> None:
    made = rig()
    local, world = ReaderFrame(made, 1, 0, Report()), ReaderFrame(made, 1, -1, Report())
    assert_allclose(local.resting, from_axis_angle(Z, 0.7), atol=1e-12)
    assert_allclose(world.resting, from_axis_angle(Z, 1.2), atol=1e-12)
    up = np.array([0.0, 1.0, 0.0])
    assert_allclose(world.direction_in_frame((0, 3, 0)), up)
    assert_allclose(local.direction_in_frame((0, 3, 0)), [np.sin(0.5), np.cos(0.5), 0], atol=1e-12)
    assert_allclose(local.rotation_in_pose("rest"), local.resting)
    assert_allclose(local.rotation_in_pose("bend@0.5"), from_axis_angle(Z, 1.2), atol=1e-9)
    assert_allclose(world.rotation_in_pose("bend@1"), from_axis_angle(Z, 2.2), atol=1e-9)
    apart = multiply(conjugate(local.rotation_in_pose("bend@0")), from_axis_angle(Z, 0.7))
    assert_allclose(apart, IDENTITY, atol=1e-9)


def test_a_pose_is_the_one_that_controls_give() -> None:
    """As after a bake: keys of a control alone move its joint, too."""
    built = add_controls(replace(rig(), clips=()), joints="b", frame="joint")
    keys = from_axis_angle(Z, np.array([0.0, 1.0]))
    track = Track(built.find("b_ctl"), "rotation", "LINEAR", np.array([0.0, 1.0]), keys)
    made = replace(built, clips=(Clip("bend", (track,)),))
    driver = made.find("b")
    found = ReaderFrame(made, driver, made.find("a"), Report()).rotation_in_pose("bend@0.5")
    assert_allclose(found, from_axis_angle(Z, 1.2), atol=1e-7)
    baked = ReaderFrame(bake(made, to="joints"), driver, made.find("a"), Report())
    assert_allclose(found, baked.rotation_in_pose("bend@0.5"), atol=1e-6)


@pytest.mark.parametrize("mirrored", [[], [0], [1], [0, 1]])
@pytest.mark.parametrize("frame", [0, -1])
def test_a_driver_meets_the_direction_of_its_axis_if_mirrored(frame: int, mirrored: list[int]) -> None:
    """As where an armature, or the joints of one side, have a negative scale."""
    made = rig()
    made.scale[mirrored, 0] = -1.0
    along = made.world[1, 0, :3]
    seen = ReaderFrame(made, 1, frame, Report()).direction_in_frame(tuple(along.tolist()))
    reader = PoseReader("dot", np.array([1.0, 0, 0]), (Target("along", seen),), signed=True)
    world = made.world[[frame]] if frame >= 0 else np.eye(4)[np.newaxis]
    assert_allclose(weights(reader, made.world[[1]], world, {}), [[1.0]], atol=1e-12)


@pytest.mark.parametrize("direction", [None, (0, 0, 0), (1, 2), (0, np.nan, 1), (np.inf, 0, 0)])
def test_what_is_no_direction_is_refused(direction: Any) -> None:
    with pytest.raises(UsageError, match="a target is a direction other than 0,0,0, a pose or a node"):
        ReaderFrame(rig(), 1, 0, Report()).direction_in_frame(direction)


def test_a_driver_without_axes_is_refused_by_name() -> None:
    made = rig()
    made.scale[1] = 0.0
    with pytest.raises(GeometryError, match="'b' has no axes: a scale on or above it is zero"):
        _ = ReaderFrame(made, 1, 0, Report()).resting


def with_reader(rig: Rig, change: str = "rz=15", **more: Any) -> Rig:
    """The biped with a reader of its right arm that drives the left toes."""
    driven = (("up", "toe_L", change),)
    return rigtri.add_posereader(rig, driver="upper_arm_R", target=("up=0,1,0.2",), joint=driven, **more)


@pytest.mark.parametrize("change", ["rz=15", "tx=0.1"])
def test_a_joint_that_a_constraint_moves_so_is_not_driven(change: str) -> None:
    """Before, the reader took the place of the constraint, counted from what that made of rest."""
    held = rigtri.constrain(rigtri.read(SAMPLES / "biped.glb"), child="toe_L", driver=("hand_L",), type="aim")
    if change == "tx=0.1":
        assert with_reader(held, change).find("toe_L") >= 0
        return
    with pytest.raises(
        GeometryError, match="'toe_L' follows a constraint, which a pose reader would replace"
    ):
        with_reader(held, change)


def test_a_joint_that_a_pose_reader_drives_is_not_constrained() -> None:
    """Before, the constraint moved the same channels, and later edits kept now one and now the other."""
    driven = with_reader(replace(rigtri.read(SAMPLES / "biped.glb"), clips=()))
    given: dict[str, Any] = {"child": "toe_L", "driver": ("hand_L",)}
    assert rigtri.constrain(driven, type="point", **given).find("con_toe_L_point") >= 0
    for kind in ("aim", "parent"):
        with pytest.raises(GeometryError, match="pose readers drive 'toe_L'"):
            rigtri.constrain(driven, type=kind, **given)


@pytest.mark.parametrize("turn", [0.3, 0.0])
def test_a_joint_that_its_control_moves_is_not_driven(turn: float) -> None:
    """Before, the reader took the place of the control's motion, without a word."""
    still = replace(rigtri.read(SAMPLES / "biped.glb"), clips=())
    made = rigtri.add_controls(still, whole_character=True)
    turns = from_axis_angle(Z, np.array([0.0, turn]))
    control = Track(made.find("toe_L_ctl"), "rotation", "LINEAR", np.array([0.0, 1.0]), turns)
    made = replace(made, clips=(Clip("tap", (control,)),))
    if not turn:
        assert with_reader(made).find("toe_L") >= 0
        return
    with pytest.raises(GeometryError, match="'toe_L_ctl' moves 'toe_L' in clip 'tap'"):
        with_reader(made)


@pytest.mark.parametrize(("control", "turn"), [("toe_L_ctl", 0.3), ("toe_L_ctl", 0.0), ("foot_L_ctl", 0.3)])
def test_bake_and_check_tell_of_keys_that_the_control_of_a_driven_joint_has(
    control: str, turn: float, tmp_path: Path
) -> None:
    """The reader takes the place of that motion; before, nothing told of it."""
    made = rigtri.add_controls(replace(rigtri.read(SAMPLES / "biped.glb"), clips=()), whole_character=True)
    driven = with_reader(made, name="lift")
    times = np.array([0.0, 1.0])
    tracks = (
        Track(driven.find(control), "rotation", "LINEAR", times, from_axis_angle(Z, np.array([0.0, turn]))),
        Track(driven.find("upper_arm_R_ctl"), "rotation", "LINEAR", times, from_axis_angle(Z, times)),
    )
    keyed = replace(driven, clips=(Clip("tap", tracks),))
    document = read(SAMPLES / "biped.glb")
    document.write(keyed, tmp_path / "keyed.glb", tmp_path / "keyed.glb")
    report = Report()
    bake(keyed, to="joints", report=report)
    told = [notice.text for notice in report.warnings if notice.code == "driven-twice"]
    told += [each.message for each in check(tmp_path / "keyed.glb") if each.id == "gltf.note.driven-twice"]
    wins = control == "toe_L_ctl" and turn > 0
    assert len(told) == (2 if wins else 0)
    assert all("'lift' drives 'toe_L', which 'toe_L_ctl' moves in clip 'tap'" in text for text in told)


def test_controls_that_have_the_motion_of_a_reader_are_not_told_of() -> None:
    """As `bake --to controls` leaves them: they say the same."""
    made = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True)
    still = [t for t in made.clips[0].tracks if t.node != made.find("toe_L")]
    made = replace(made, clips=(replace(made.clips[0], tracks=tuple(still)),))
    driven = with_reader(made)
    led = bake(driven, to="controls")
    assert any(track.node == led.find("toe_L_ctl") for track in led.clips[0].tracks)
    report = Report()
    bake(led, to="joints", report=report)
    assert "driven-twice" not in {notice.code for notice in report.warnings}
