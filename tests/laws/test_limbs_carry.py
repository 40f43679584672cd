"""A limb that is built again, by make-limb or mirror, carries what counts from its joints."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import rig_of

import rigtri
from rigtri.errors import GeometryError
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.metadata import PoseReaderRecord
from rigtri.model.rig import Rig
from rigtri.operations.make_limb import MakeLimbOptions, make_limb
from rigtri.operations.mirror.mirror import MirrorOptions, mirror
from rigtri.operations.pose import PoseOptions, pose_of
from rigtri.report import Report

ARM = ((0.2, 1.4, 0.0), (0.5, 1.4, -0.05), (0.8, 1.4, 0.0))
LOWER = ((0.2, 1.4, 0.0), (0.45, 1.2, -0.05), (0.7, 1.0, 0.1))
DRIVERS = ("arm_3_L", "arm_3_R")
AIM: dict[str, Any] = {"type": "aim", "driver": ("arm_3_R",), "aim_axis": (0.0, 0.0, 1.0)}
KINDS: dict[str, dict[str, Any]] = {
    "parent": {"type": "parent", "driver": DRIVERS},
    "point": {"type": "point", "driver": DRIVERS},
    "orient": {"type": "orient", "driver": DRIVERS},
    "aim": {**AIM, "up_axis": (0.0, 1.0, 0.0), "up_vector": (0.0, 1.0, 0.0)},
    "aim up as a joint turns": {
        **AIM,
        "up_axis": (0.0, 1.0, 0.0),
        "world_up": "objectrotation",
        "up_object": "arm_2_R",
        "up_vector": (0.2, 1.0, 0.3),
    },
}


@cache
def arms() -> Rig:
    """Two arms in axes that neither make-limb nor mirror gives, a prop between them, and a clip of both."""
    rig = rig_of(["prop"], [-1], np.array([[0.9, 1.2, 0.1]]), np.array([[0.0, 0.0, 0.0, 1.0]]))
    rig = rigtri.make_limb(rig, points=ARM, name="arm", side="left")
    rig = rigtri.orient_joints(rigtri.mirror(rig), preset="blender")
    times = np.array([0.0, 1.0])
    tracks = []
    for name, axis in (("arm_1_L", 0), ("arm_2_L", 1), ("arm_1_R", 2), ("arm_3_R", 0)):
        node = rig.find(name)
        turns = from_axis_angle(np.eye(3)[[axis, axis]], np.array([0.0, 0.7]))
        tracks.append(Track(node, "rotation", "LINEAR", times, multiply(rig.rotation[node], turns)))
    return replace(rig, clips=(Clip("wave", tuple(tracks)),))


def limb_again(rig: Rig, points: Any = ARM) -> tuple[Rig, Report]:
    report = Report()
    return make_limb(
        rig, options=MakeLimbOptions(points=points, name="arm", side="left"), report=report
    ), report


def mirrored(rig: Rig, **options: Any) -> tuple[Rig, Report]:
    report = Report()
    return mirror(rig, options=MirrorOptions(**options), report=report), report


AGAIN = {"make-limb": limb_again, "mirror": mirrored}


def standing(rig: Rig, name: str) -> Floats:
    """Where a node is at rest by what is evaluated, and at three moments of the clip, (4, 4, 4)."""
    poses = ("rest", "wave@0", "wave@0.4", "wave@1")
    return np.stack([pose_of(rig, PoseOptions(pose)).world(rig.find(name))[0] for pose in poses])


def codes(report: Report) -> list[str]:
    return [notice.code for notice in report.warnings]


@pytest.mark.parametrize("command", AGAIN)
@pytest.mark.parametrize("kind", KINDS)
def test_what_follows_joints_that_get_other_axes_moves_as_before(kind: str, command: str) -> None:
    rig = rigtri.constrain(arms(), child="prop", **KINDS[kind])
    out, report = AGAIN[command](rig)
    joint = {"make-limb": "arm_3_L", "mirror": "arm_3_R"}[command]
    assert np.abs(out.world[out.find(joint), :3, :3] - rig.world[rig.find(joint), :3, :3]).max() > 0.5
    assert_allclose(standing(out, "prop"), standing(rig, "prop"), atol=1e-6)
    assert "offsets-measured-anew" not in codes(report)


@pytest.mark.parametrize("command", AGAIN)
def test_joints_and_what_is_below_them_move_as_before_in_other_axes(command: str) -> None:
    rig = rigtri.add_socket(
        rigtri.add_socket(arms(), on="arm_3_R", name="grip_R"), on="arm_3_L", name="grip_L"
    )
    out, _ = AGAIN[command](rig)
    for name in ("arm_3_L", "arm_3_R"):
        assert_allclose(standing(out, name)[:, 3], standing(rig, name)[:, 3], atol=1e-6)
    for name in ("grip_L", "grip_R"):
        assert_allclose(standing(out, name), standing(rig, name), atol=1e-6)


@pytest.mark.parametrize("kind", ["parent", "point", "orient", "aim"])
def test_what_follows_a_limb_by_an_offset_stays_where_its_joints_are_put_elsewhere(kind: str) -> None:
    rig = rigtri.constrain(arms(), child="prop", **{**KINDS[kind], "driver": ("arm_3_L",)})
    out, report = limb_again(rig, LOWER)
    assert_allclose(standing(out, "prop")[0], standing(rig, "prop")[0], atol=1e-6)
    assert "offsets-measured-anew" in codes(report)
    (text,) = [notice.text for notice in report.warnings if notice.code == "offsets-measured-anew"]
    off = np.abs(standing(out, "prop") - standing(rig, "prop"))[1:].max(axis=(0, 2))
    assert ("'prop' by " in text) == bool(off[3] > 1e-5)
    assert ("'prop' turns by " in text) == bool(off[:3].max() > 1e-4)
    assert ("It changes clips: 'prop'" in text) == bool(off.max() > 1e-4)


def test_what_turns_otherwise_in_clips_is_said_in_degrees() -> None:
    """Before, nothing was said of what aims at joints that were put elsewhere, where its offset stays."""
    rig = rigtri.constrain(arms(), child="prop", type="aim", driver=("arm_3_L",))
    rotation = rig.rotation.copy()
    rotation[rig.find("prop")] = from_axis_angle(np.array([0.0, 0.0, 1.0]), 0.3)
    rig = replace(rig, rotation=rotation)
    out, report = limb_again(rig, LOWER)
    (text,) = [notice.text for notice in report.warnings if notice.code == "followers-go-along"]
    (degrees,) = re.findall(r"It changes clips: 'prop' turns by ([\d.]+)° in wave@[\d.]+\.", text)
    was, now = (standing(each, "prop")[1:, :3, :3] for each in (rig, out))
    turns = np.degrees(np.arccos((np.einsum("fij,fij->f", was, now) - 1.0) / 2.0))
    assert float(degrees) >= turns.max() * 0.95
    assert turns.max() > 1.0


def test_what_does_not_rest_by_its_offset_goes_along_and_the_warning_says_how_far() -> None:
    """Before, a locator of a real robot was 0.4 of the size off, without a word."""
    rig = rigtri.constrain(arms(), child="prop", type="point", driver=("arm_3_L",))
    translation = rig.translation.copy()
    translation[rig.find("prop")] += 0.1
    out, report = limb_again(replace(rig, translation=translation), LOWER)
    (text,) = [notice.text for notice in report.warnings if notice.code == "followers-go-along"]
    assert re.search(r"prop goes along: .* It changes clips: 'prop' by [\d.]+ of the size in wave@", text)
    assert np.abs(standing(out, "prop") - standing(rig, "prop"))[1:].max() > 0.01


def test_a_child_without_an_offset_stays_on_its_joint() -> None:
    rig = rigtri.constrain(arms(), child="prop", type="point", driver=("arm_3_L",), maintain_offset=False)
    out, report = limb_again(rig, LOWER)
    assert_allclose(standing(out, "prop")[0, 3, :3], LOWER[-1], atol=1e-6)
    assert "offsets-measured-anew" not in codes(report)


def test_controls_stand_where_the_joints_are_put() -> None:
    rig = rigtri.add_controls(arms(), joints=("arm_*_L",))
    out, _ = limb_again(rig, LOWER)
    for number, place in enumerate(LOWER, 1):
        for name in (f"arm_{number}_L", f"arm_{number}_L_ctl"):
            assert_allclose(out.world[out.find(name), 3, :3], place, atol=1e-6)
            assert_allclose(standing(out, name)[0, 3, :3], place, atol=1e-6)


def test_a_reader_reads_the_same_of_a_limb_in_other_axes() -> None:
    rig = rigtri.add_posereader(
        arms(), driver="arm_2_L", frame="arm_1_L", target=("bent=0,-1,0",), attribute=(), name="bend"
    )
    out, _ = limb_again(rig)
    (was,), (now,) = (each.records(PoseReaderRecord).values() for each in (rig, out))
    for one, seen, node in (
        (was.axis, now.axis, "arm_2_L"),
        (was.targets[0].direction, now.targets[0].direction, "arm_1_L"),
    ):
        assert one is not None
        assert seen is not None
        old, new = (each.world[each.find(node), :3, :3] for each in (rig, out))
        assert_allclose(np.array(seen) @ new, np.array(one) @ old, atol=1e-6)


OWN_AXES: dict[str, dict[str, Any]] = {
    "local": {"type": "orient", "driver_space": "local"},
    "scale": {"type": "scale"},
}


@pytest.mark.parametrize("kind", OWN_AXES)
def test_what_compares_own_axes_refuses_other_ones_by_name(kind: str) -> None:
    rig = rigtri.constrain(arms(), child="prop", driver=("arm_3_L",), **OWN_AXES[kind])
    with pytest.raises(GeometryError, match=r"constrained at '(prop|arm_3_L)' compares own axes.*arm_1_L"):
        limb_again(rig)
    other = rigtri.constrain(arms(), child="prop", driver=("arm_3_R",), **OWN_AXES[kind])
    out, report = mirrored(other, what=("limbs",))
    assert "not-mirrored" in codes(report)
    assert_allclose(standing(out, "prop"), standing(other, "prop"), atol=1e-6)


def test_motion_of_a_limbs_controls_is_no_less_than_that_of_other_joints() -> None:
    """Motion that only controls of joints of make-limb have is refused by a bake to controls, not lost."""
    rig = rigtri.add_controls(arms(), ik=("arm_1_L", "arm_2_L", "arm_3_L"), joints=("arm_2_R",))
    control = rig.find("arm_2_R_ctl")
    turns = from_axis_angle(np.eye(3)[[2, 2]], np.array([0.1, 0.9]))
    track = Track(control, "rotation", "LINEAR", np.array([0.0, 1.0]), multiply(rig.rotation[control], turns))
    keyed = replace(rig, clips=(Clip("wave", (*rig.clips[0].tracks, track)),))
    with pytest.raises(GeometryError, match=r"Controls move 'arm_2_R' in clip 'wave'.*would be lost"):
        rigtri.bake(keyed, to="controls")
    rigtri.bake(rigtri.bake(keyed, to="joints"), to="controls")
    with pytest.raises(GeometryError, match=r"of make-limb.*move in clip 'wave'"):
        rigtri.strip(keyed)
    assert not rigtri.strip(keyed, discard_motion=True).nodes_of("limb")


def test_the_joints_of_limbs_get_another_rest_pose() -> None:
    rig = arms()
    rested = rigtri.set_rest(rig, pose="wave@1")
    joint = rig.find("arm_1_R")
    assert_allclose(rested.rotation[joint], rig.clips[0].tracks[2].values[-1], atol=1e-6)


def test_a_skeleton_of_limbs_alone_is_recognised() -> None:
    """make-limb --guides builds whole skeletons; what other commands look for is found in them, too."""
    limbs = {
        "spine": ([[0, 1, 0], [0, 1.15, 0.02], [0, 1.3, 0.01], [0, 1.45, -0.02]], None, None),
        "arm": ([[0.18, 1.42, -0.01], [0.45, 1.4, -0.06], [0.7, 1.38, 0]], "spine_3", "left"),
        "leg": ([[0.1, 0.95, 0], [0.11, 0.5, 0.05], [0.11, 0.08, -0.02]], "spine_1", "left"),
    }
    rig = rig_of(["prop"], [-1], np.array([[0.9, 1.2, 0.1]]), np.array([[0.0, 0.0, 0.0, 1.0]]))
    for name, (points, parent, side) in limbs.items():
        rig = rigtri.make_limb(rig, points=points, name=name, parent=parent, side=side)
    (character,) = rigtri.recognise(rigtri.mirror(rig)).characters
    assert sorted((limb.kind, limb.side) for limb in character.limbs) == [
        ("arm", "left"),
        ("arm", "right"),
        ("leg", "left"),
        ("leg", "right"),
    ]
