"""Where the last joint of a chain aims: heads whatever hangs at them, and fingers and toes at their ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from posed_bodies import NAMES, Pose, posed_body

from rigtri import orient_joints
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.recognition.recognise import recognise
from rigtri.report import Report


def aim(rig: Rig, node: int) -> Floats:
    """Where x of a joint points."""
    axis = rig.world[node, 0, :3]
    return np.asarray(axis / np.linalg.norm(axis))


@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize("ends", [False, True])
def test_a_head_aims_alike_with_and_without_a_face(names: str, ends: bool) -> None:
    """Eyes and jaw are in front of the skull: their average would tilt the head by 45°."""
    plain, face = (posed_body(Pose(names, face=face, ends=ends)) for face in (False, True))
    heads = [aim(orient_joints(body.rig), body.parts["head"]) for body in (plain, face)]
    np.testing.assert_allclose(heads[1], heads[0], atol=1e-6)
    np.testing.assert_allclose(heads[1], (0, 1, 0), atol=1e-6)


@pytest.mark.parametrize("names", NAMES)
def test_the_face_keeps_its_axes(names: str) -> None:
    body = posed_body(Pose(names, face=True))
    out = orient_joints(body.rig)
    for part in ("jaw", "left eye", "right eye"):
        np.testing.assert_allclose(out.world[body.parts[part]], body.rig.world[body.parts[part]], atol=1e-9)


@pytest.mark.parametrize(
    "pose",
    [
        Pose(toes=False),
        Pose("unreal", toes=False, knee=25.0, yaw=90.0, unit=0.01),
        Pose("blender", toes=False, stride=20.0, flip=True),
    ],
)
def test_a_foot_without_toes_points_ahead_and_bends_as_one_with_toes(pose: Pose) -> None:
    """The lower leg points down, and its hinge is the knee's: a foot with its axes would be another joint."""
    body, report = posed_body(pose), Report()
    facing = recognise(body.rig).characters[0].facing
    out = orient_joints(body.rig, report=report)
    rules = {entry["joint"]: entry["aim"] for entry in report.joints}
    for side in ("left", "right"):
        foot = body.parts[f"{side} foot"]
        np.testing.assert_allclose(aim(out, foot), facing, atol=1e-6)
        hinge = out.world[foot, 1, :3] / np.linalg.norm(out.world[foot, 1, :3])
        assert abs(hinge @ body.hinges[foot]) > 0.999
        assert hinge @ body.hinges[foot] * np.linalg.det(out.world[foot, :3, :3]) > 0
        assert rules[out.names[foot]] == "facing"
    again = orient_joints(out)
    np.testing.assert_array_equal(again.rotation, out.rotation)
    copied = orient_joints(body.rig, end="parent")
    np.testing.assert_allclose(
        aim(copied, body.parts["left foot"]), aim(copied, body.parts["left lower leg"]), atol=1e-6
    )


def test_a_head_whose_neck_stands_elsewhere_goes_on_as_the_trunk() -> None:
    body = posed_body(Pose())
    world = body.rig.world
    # The neck above and ahead of the head: the way from it to the head goes down and back.
    place = np.append(world[body.parts["head"], 3, :3] + (0.0, 0.05, 0.2), 1.0)
    moved = place @ np.linalg.inv(world[body.rig.parents[body.parts["neck"]]])
    translation = body.rig.translation.copy()
    translation[body.parts["neck"]] = moved[:3]
    rig = replace(body.rig, translation=translation, skins=())
    back = np.append(world[body.parts["head"], 3, :3], 1.0) @ np.linalg.inv(rig.world[body.parts["neck"]])
    translation = translation.copy()
    translation[body.parts["head"]] = back[:3]
    rig = replace(rig, translation=translation, skins=body.rig.skins)
    out = orient_joints(rig, pose="nodes")
    assert aim(out, body.parts["head"])[1] > 0.9


def test_a_rule_for_branches_that_the_user_names_is_for_heads_too() -> None:
    body = posed_body(Pose(face=True))
    assert aim(orient_joints(body.rig, branch="average"), body.parts["head"])[1] < 0.9


@pytest.mark.parametrize("curl", [5.0, 50.0])
@pytest.mark.parametrize("names", ["mixamo", "unreal", "blender"])
def test_the_last_joint_aims_at_the_one_that_says_where_it_ends(names: str, curl: float) -> None:
    """Such joints have no weight; they are neither sockets nor parts of the chain."""
    body = posed_body(Pose(names, curl=curl, ends=True))
    out = orient_joints(body.rig)
    at = body.rig.world[:, 3, :3]
    fingers = [f"{side} {finger}" for side in ("left", "right") for finger in ("index", "little")]
    ends = {f"{finger} 3": f"{finger} 4" for finger in fingers}
    for last, end in (ends | {"left toes": "left toes end", "head": "head end"}).items():
        bone = at[body.parts[end]] - at[body.parts[last]]
        np.testing.assert_allclose(aim(out, body.parts[last]), bone / np.linalg.norm(bone), atol=1e-5)
        np.testing.assert_allclose(out.world[body.parts[end]], body.rig.world[body.parts[end]], atol=1e-9)


def test_the_head_of_a_numbered_spine_is_its_last_joint() -> None:
    """Rigify numbers spine, neck and head throughout; a longer neck shifts the number of the head."""
    body = posed_body(Pose("blender"))
    called = {"hips": "DEF-spine", "head": "DEF-spine.007"}
    called |= {part: f"DEF-spine.{k:03}" for k, part in enumerate(("spine", "chest", "upper chest"), 1)}
    names = [f"DEF-{name}" if name and name != "Armature" else name for name in body.rig.names]
    for part, name in called.items():
        names[body.parts[part]] = name
    names[body.parts["neck"]] = "DEF-spine.006"
    (character,) = recognise(replace(body.rig, names=tuple(names))).characters
    assert character.bones["head"] == body.parts["head"]
