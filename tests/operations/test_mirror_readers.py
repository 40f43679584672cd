"""What a mirrored pose reader drives, by hand: twins of joints in their own axes, and of morph targets."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from places import SAMPLES
from rigs import rig_of

from rigtri.formats import read
from rigtri.frames.mirroring import Across
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import OutputRecord, PoseReaderRecord, TargetRecord
from rigtri.operations.add_posereader.posereader import add_posereader
from rigtri.operations.mirror import pose_readers
from rigtri.operations.mirror.counterparts import direction
from rigtri.operations.mirror.mirror import MirrorOptions, mirror
from rigtri.operations.mirror.pose_readers import _changed, _goals, _morph, _outputs
from rigtri.report import Report

OPTIONS = MirrorOptions(across=Across())
NONE = np.array([0.0, 0, 0, 1])


def _twin(turn: Any, **changes: Any) -> OutputRecord | None:
    """What the changes of a joint along the world's axes are for its twin, whose axes are turned."""
    rig = rig_of(["root", "a_L", "a_R"], [-1, 0, 0], np.zeros((3, 3)), np.array([NONE, NONE, turn]))
    return _changed(rig, OutputRecord(target="up", joint="a_L", **changes), 1, 2, OPTIONS)


def test_a_scale_is_along_the_axes_of_the_twin() -> None:
    quarter, odd = from_axis_angle([0.0, 0, 1], np.pi / 2), from_axis_angle([0.0, 0, 1], 0.3)
    for turn, scale, twins in (
        (NONE, (1.0, 2.0, 3.0), (1.0, 2.0, 3.0)),
        (quarter, (1.0, 2.0, 3.0), (2.0, 1.0, 3.0)),
        (odd, (2.0, 2.0, 2.0), (2.0, 2.0, 2.0)),
    ):
        found = _twin(turn, scale=scale)
        assert found is not None
        assert found.scale == twins
    assert _twin(odd, scale=(1.0, 2.0, 3.0)) is None


def test_a_move_and_a_rotation_are_mirrored_across_the_plane() -> None:
    found = _twin(NONE, translation=(1.0, 2.0, 3.0), rotation=tuple(from_axis_angle([0.6, 0, 0.8], 0.5)))
    assert found is not None
    assert found.translation == pytest.approx((-1.0, 2.0, 3.0))
    expected = from_axis_angle([0.6, 0, -0.8], 0.5)
    assert found.rotation is not None
    assert abs(np.dot(found.rotation, expected)) == pytest.approx(1.0)
    assert found.scale is None


def test_an_axis_of_a_joint_that_a_negative_scale_has_mirrored_is_its_own() -> None:
    rig = rig_of(["root", "a_L", "a_R"], [-1, 0, 0], np.zeros((3, 3)))
    rig.scale[2, 0] = -1.0
    assert direction(rig, 1, 2, (1.0, 0, 0), OPTIONS) == (1.0, 0.0, 0.0)
    assert direction(rig, 2, 1, (0, 1.0, 0), OPTIONS) == (0.0, 1.0, 0.0)


@pytest.mark.parametrize(("here", "there", "stored"), [(1, 2, 1.0), (2, 1, -1.0)])
def test_a_direction_is_mirrored_to_and_from_a_mirrored_driver(here: int, there: int, stored: float) -> None:
    """A record has the opposite direction for a mirrored driver."""
    rig = rig_of(["root", "a_L", "a_R"], [-1, 0, 0], np.zeros((3, 3)))
    rig.scale[2, 0] = -1.0
    target = TargetRecord(name="up", direction=(0.6 * stored, 0.8 * stored, 0.0))
    about: dict[str, Any] = {"name": "r", "driver": rig.names[here], "frame": "root", "axis": (1.0, 0.0, 0.0)}
    record = PoseReaderRecord(**about, reader="dot", targets=(target,), outputs=(), within=0.1)
    (goal,) = _goals(rig, record, (here, there), (0, 0), OPTIONS)
    assert goal.direction == pytest.approx((-0.6, 0.8, 0.0))


@pytest.mark.parametrize(
    ("name", "same", "twin"),
    [
        ("smile_L", True, "smile_R"),
        ("smile_L", False, "smile_R"),
        ("blink_L", False, "blink_L"),  # a mesh of its own has the same one
        ("blink_L", True, None),
        ("jaw", False, "jaw"),
        ("jaw", True, None),
        ("gone_L", False, None),
        ("3", False, "3"),  # by its number
        ("4", False, None),
        ("", True, ""),
    ],
)
def test_the_twin_of_a_morph_target(
    name: str, same: bool, twin: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ("smile_L", "smile_R", "blink_L", "jaw")
    mesh = Mesh("face", 1, np.zeros((1, 3)), morph_names=names, morphs=np.zeros((4, 1, 3)))
    monkeypatch.setattr(pose_readers, "meshes_named", lambda rig, path: [mesh])
    rig = rig_of(["root", "face"], [-1, 0], np.zeros((2, 3)))
    assert _morph(rig, 1, OutputRecord(target="up", mesh="face", morph=name), same=same) == twin


def test_what_drives_twins_is_listed_and_what_has_none_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = SimpleNamespace(morph_names=("smile_L", "smile_R"), morphs=np.zeros((2, 1, 3)))
    monkeypatch.setattr(pose_readers, "meshes_named", lambda rig, path: [mesh])
    rig = rig_of(["root", "face", "knob_L", "knob_R"], [-1, 0, 0, 0], np.zeros((4, 3)))
    face, knob = rig.path(1), rig.address(2)
    outputs = (
        OutputRecord(target="up", mesh=face, morph="smile_L"),
        OutputRecord(target="up", mesh=face, morph="frown"),
        OutputRecord(target="down", control=knob, attribute="curl"),
        OutputRecord(target="down", control="gone", attribute="curl"),
    )
    about: dict[str, Any] = {"name": "r", "driver": "knob_L", "frame": "", "axis": (1.0, 0.0, 0.0)}
    record = PoseReaderRecord(**about, reader="dot", targets=(), outputs=outputs, within=0.1)
    report = Report()
    found = _outputs(rig, 2, record, report)
    assert found == ((("up", face, "smile_R"),), (("down", rig.address(3), "curl"),))
    assert [notice.text.count("it has no twin") for notice in report.warnings] == [1, 1]


@pytest.mark.parametrize("reader", ["rbf", "dot"])
def test_a_target_that_is_the_rest_pose_is_that_of_the_twin_and_no_warning(reader: Any) -> None:
    """Before, the twin warned that the target has weight at rest, which its maker had asked for."""
    rig, report = read(SAMPLES / "biped.glb").rig, Report()
    targets = ("rest", "bent=walk@0.4")
    rig = add_posereader(rig, driver="forearm_L", reader=reader, target=targets, report=report)
    rig = mirror(rig, report=report)
    assert not any("'target1'" in notice.text for notice in report.warnings)
    twin = next(each for each in rig.records(PoseReaderRecord).values() if each.driver == "forearm_R")
    if twin.rest is not None:
        assert twin.targets[0].rotation == pytest.approx(twin.rest)


def test_a_reader_of_the_head_that_drives_one_side_alone_is_named() -> None:
    """Before, it was left out without a word."""
    rig, report = read(SAMPLES / "biped.glb").rig, Report()
    about: dict[str, Any] = {"driver": "head", "target": ("out=1,0,0",)}
    rig = add_posereader(rig, **about, joint=(("out", "hand_L", "tx=0.02"),), name="one")
    rig = add_posereader(rig, **about, joint=(("out", "hand_R", "tx=0.02"),), name="other")
    mirror(rig, report=report)
    (told,) = (notice.text for notice in report.warnings if notice.code == "not-mirrored")
    assert told.startswith("pose reader 'one' is not mirrored: 'head' is on neither side")


@pytest.mark.parametrize(
    ("mesh", "why"),
    [
        ("gone", "not exactly one node is called 'gone' now"),
        ("hips", "No mesh is named '/biped/hips'"),  # what another program has made of a mesh of that name
    ],
)
def test_a_reader_whose_mesh_has_another_name_is_named_and_the_others_are_mirrored(
    mesh: str, why: str
) -> None:
    """Before, the second ended with an error, and the first made a reader that drives nothing."""
    rig, report = read(SAMPLES / "biped.glb").rig, Report()
    about: dict[str, Any] = {"target": ("out=1,0,0",)}
    rig = replace(rig, clips=())
    for name, driver, joint in (("lost", "hand_L", "toe_L"), ("kept", "forearm_L", "fingers_L")):
        rig = add_posereader(
            rig, **about, driver=driver, joint=(("out", joint, "tx=0.02"),), name=f"{name}_L"
        )
    node, record = next((n, r) for n, r in rig.records(PoseReaderRecord).items() if r.name == "lost_L")
    lost = replace(record, outputs=(OutputRecord(target="out", mesh=mesh, morph="smile_L"),))
    rig = mirror(replace(rig, metadata={**rig.metadata, node: lost.to_dict()}), report=report)
    (told,) = (notice.text for notice in report.warnings if notice.code == "not-mirrored")
    assert told.startswith(f"pose reader 'lost_L' is not mirrored: {why}")
    assert {one.name for one in rig.records(PoseReaderRecord).values()} == {"lost_L", "kept_L", "kept_R"}
