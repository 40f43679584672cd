"""Which side limbs bend to, as orient-joints, add-polevector and check take it."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from posed_bodies import Pose, PosedBody, posed_body
from recognition_bodies.skeletons import HORSE, both, line, rig_with

from rigtri import add_polevector, orient_joints
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.recognition.bend_direction import in_motion
from rigtri.recognition.limbs import Limb, unsure
from rigtri.report import Report
from rigtri.verification.checks.axis_check import axis_findings

KNEES, ELBOWS = ("left lower leg", "right lower leg"), ("left lower arm", "right lower arm")


def moved(body: PosedBody, parts: tuple[str, ...], degrees: float, axis: Floats | None = None) -> Rig:
    """The rig with a clip that bends parts there and back: the natural way, or about an axis of the world."""
    rig, tracks = body.rig, []
    for node in (body.parts[part] for part in parts):
        rows = rig.world[node, :3, :3]
        own = (body.hinges[node] if axis is None else axis) @ np.linalg.inv(rows)
        turn = from_axis_angle(normalise(own), np.radians(degrees))
        keys = np.stack([rig.rotation[node], multiply(rig.rotation[node], turn), rig.rotation[node]])
        tracks.append(Track(node, "rotation", "LINEAR", np.arange(3.0), keys))
    return replace(rig, clips=(Clip("walk", tuple(tracks)),))


def left_handed(rig: Rig, root: int) -> Rig:
    """The same places and motion: all joints from one on have left-handed axes, by its scale."""
    below = [node for node in range(len(rig.names)) if node != root and rig.is_below(node, root)]
    scale, translation, rotation = rig.scale.copy(), rig.translation.copy(), rig.rotation.copy()
    scale[root, 0] *= -1.0
    translation[below, 0] *= -1.0
    rotation[below, 1:3] *= -1.0
    clips = []
    for clip in rig.clips:
        signs = {track.node: [1.0, -1.0, -1.0, 1.0] for track in clip.tracks if track.node in below}
        turned = (replace(each, values=each.values * signs.get(each.node, 1.0)) for each in clip.tracks)
        clips.append(replace(clip, tracks=tuple(turned)))
    (skin,) = rig.skins
    bind = skin.inverse_bind.copy()
    bind[np.isin(skin.joints, [root, *below]), :, 0] *= -1.0
    skins = (replace(skin, inverse_bind=bind),)
    return replace(
        rig, translation=translation, rotation=rotation, scale=scale, clips=tuple(clips), skins=skins
    )


def off(rig: Rig, body: PosedBody) -> dict[str, tuple[float, float]]:
    """Degrees by which each middle joint's hinge and its pole are off what the body is made with."""
    out = orient_joints(rig)
    with_poles = add_polevector(rig, limbs="auto")
    found = {}
    for part in (*KNEES, *ELBOWS):
        node, natural = body.parts[part], normalise(body.hinges[body.parts[part]])
        axis = normalise(out.world[node, 1, :3]) * np.sign(np.linalg.det(out.world[node, :3, :3]))
        pole = next(k for k, name in enumerate(with_poles.names) if name == f"{rig.names[node]}_pole")
        above, below = rig.world[rig.parents[node], 3, :3], rig.world[rig.find(end_of(body, part)), 3, :3]
        aside = with_poles.world[pole, 3, :3] - rig.world[node, 3, :3]
        cosines = axis @ natural, normalise(np.cross(aside, below - above)) @ natural
        found[part] = tuple(np.degrees(np.arccos(np.clip(cosines, -1, 1))).tolist())
    return found


def end_of(body: PosedBody, part: str) -> str:
    end = part.replace("lower leg", "foot").replace("lower arm", "hand")
    return body.rig.names[body.parts[end]]


def broken(rig: Rig) -> set[str]:
    """The laws about limbs that check finds broken in a rig with new axes and poles."""
    out = add_polevector(orient_joints(rig), limbs="auto")
    return {rule for rule, _, _ in axis_findings(out)} & {"axes.flex", "axes.pole", "axes.hinge"}


SMALL = [
    (KNEES, -7.0, None, 0.0),
    (KNEES, -7.0, None, 0.4),
    (KNEES[1:], -9.0, None, 0.0),
    (ELBOWS, -7.0, None, 0.4),
    (ELBOWS[:1], -8.0, None, 0.0),
    (KNEES, 7.0, np.array([0.0, 0.0, 1.0]), 0.0),
    (KNEES, 7.0, None, 0.4),
]


@pytest.mark.ci
@pytest.mark.parametrize(("parts", "degrees", "axis", "bent"), SMALL)
def test_clips_that_bend_a_little_the_wrong_way_are_not_believed(
    parts: tuple[str, ...], degrees: float, axis: Floats | None, bent: float
) -> None:
    body = posed_body(Pose(names="unreal", unit=0.01, knee=bent, elbow=bent))
    rig, report = moved(body, parts, degrees, axis), Report()
    for part, (hinge, pole) in off(rig, body).items():
        assert hinge < 1, part
        assert pole < 1, part
    assert broken(rig) == set()
    orient_joints(rig, report=report)
    doubted = [notice.text for notice in report.warnings if notice.code == "bends-otherwise"]
    natural = degrees > 0 and axis is None
    assert len(doubted) == (0 if natural else len(parts))
    assert all("bent less than 10° in the animation clips" in text for text in doubted)


@pytest.mark.ci
@pytest.mark.parametrize("degrees", [-12.0, -10.0, 10.0])
def test_clips_that_bend_clearly_are_the_truth(degrees: float) -> None:
    """Also where the pose is bent a little to another side."""
    for pose in (Pose(), Pose(knee=-4.0)):
        body = posed_body(pose)
        rig = moved(body, KNEES, degrees - pose.knee)
        found = off(rig, body)
        for part in KNEES:
            assert max(found[part]) < 1 if degrees > 0 else min(found[part]) > 179
        assert "axes.pole" not in broken(rig)


@pytest.mark.parametrize("above", ["hips", "left upper leg", "left clavicle"])
def test_the_motion_of_straight_limbs_is_seen_below_a_negative_scale(above: str) -> None:
    body = posed_body(Pose())
    rig = left_handed(moved(body, (*KNEES, *ELBOWS), 40.0), body.parts[above])
    assert (np.linalg.det(rig.world[:, :3, :3]) < 0).any()
    assert max(max(both) for both in off(rig, body).values()) < 1


@pytest.mark.ci
def test_a_clear_motion_near_the_natural_side_confirms_it_against_the_pose() -> None:
    """And is the plane of a limb whose pose is straight."""
    aside = np.array([1.0, 0.0, 1.0])
    for knee, least, most in ((-1.0, 0.0, 1.0), (0.0, 40.0, 50.0)):
        body = posed_body(Pose(knee=knee))
        found = off(moved(body, KNEES[:1], 30.0, aside), body)
        for degrees in found[KNEES[0]]:
            assert least <= degrees <= most


def test_a_few_clear_bends_go_before_many_small_ones() -> None:
    body = posed_body(Pose())
    locked = moved(body, KNEES, -6.0)
    walking = moved(body, KNEES, 50.0).clips[0]
    rig = replace(locked, clips=(*(replace(locked.clips[0], name=f"idle {k}") for k in range(30)), walking))
    assert max(max(both) for both in off(rig, body).values()) < 1


def test_facing_is_heard_against_small_bends_of_clips_and_reported_where_they_are_clear() -> None:
    body = posed_body(Pose())
    for degrees, clear in ((-7.0, False), (30.0, True)):
        rig, report = moved(body, KNEES, degrees), Report()
        out = add_polevector(rig, limbs="auto", facing="-z", report=report)
        knee = out.find("mixamorig:LeftLeg_pole")
        assert (out.world[knee, 3, 2] > out.world[body.parts[KNEES[0]], 3, 2]) == clear
        unused = [notice.text for notice in report.warnings if notice.code == "facing-unused"]
        assert len(unused) == (2 if clear else 0)
        assert all("it bends clearly in the animation clips" in text for text in unused)


def test_a_straight_limb_follows_the_other_side_only_where_that_is_believed() -> None:
    body = posed_body(Pose())
    for degrees, source in ((-7.0, "facing"), (7.0, "other side"), (-30.0, "other side")):
        report = Report()
        add_polevector(moved(body, KNEES[:1], degrees), limbs="auto", report=report)
        sources = {record["limb"][1]: record["source"] for record in report.limbs}
        assert sources["mixamorig:RightLeg"] == source


@pytest.mark.ci
def test_a_limb_that_is_not_believed_follows_a_clear_motion_of_the_other_side() -> None:
    """Both elbows are bent by 4° to the front, and a clip bends one of them backwards or forwards."""
    body = posed_body(Pose(elbow=-4.0))
    for degrees in (40.0, -40.0):
        found = off(moved(body, ELBOWS[1:], degrees), body)
        for part in ELBOWS:
            assert max(found[part]) < 1 if degrees > 0 else min(found[part]) > 179


@pytest.mark.parametrize("seed", [1, 4, 11, 15])
def test_a_bend_that_noise_of_the_joints_may_have_turned_is_not_taken(seed: int) -> None:
    """Also near the natural side: before, hinges and poles were up to 39° off, without a word."""
    body = posed_body(Pose(elbow=2.0, knee=2.0, forward=25.0, noise=0.6, seed=seed))
    assert max(max(found) for found in off(body.rig, body).values()) < 29


def test_a_small_bend_without_noise_is_the_plane_of_the_limb() -> None:
    body = posed_body(Pose(elbow=2.0, knee=2.0, forward=25.0))
    assert max(max(found) for found in off(body.rig, body).values()) < 0.1


def test_front_legs_that_are_not_sure_have_the_hinge_of_their_own_bend() -> None:
    """A clear bend is the truth whatever they are, and no joint above or below them has a vote."""
    trunk = [(0.5, -0.3), (0.52, -0.1), (0.52, 0.1), (0.62, 0.28), (0.82, 0.48)]
    hind = [(0.45, -0.3), (0.295, -0.23), (0.15, -0.29), (0.04, -0.25), (0.01, -0.18)]
    front = [(0.6, 0.23), (0.457, 0.33), (0.327, 0.27), (0.173, 0.3), (0.123, 0.37)]
    named = "{0}_scapula {0}_upper_arm {0}_lower_arm {0}_hand {0}_tip"
    joints = line("pelvis spine_01 spine_03 neck_01 head", "", *((0.0, y, z) for y, z in trunk))
    for side, x in (("l", 0.1), ("r", -0.1)):
        legs = f"thigh_{side} calf_{side} {side}_shank foot_{side} ball_{side}"
        joints += line(legs, "pelvis", *((x, y, z) for y, z in hind))
        joints += line(named.format(side), "spine_03", *((x, y, z) for y, z in front))
    rig, report = rig_with(joints), Report()
    assert [rig.names[chain.bend[1]][2:] for chain in unsure(rig)] == ["lower_arm"] * 2
    out = orient_joints(rig, report=report)
    for name in ("l_upper_arm", "l_lower_arm", "r_lower_arm"):
        assert out.world[out.find(name), 1, 0] < -0.99, name
    for name in ("thigh_l", "calf_l"):
        assert out.world[out.find(name), 1, 0] > 0.99, name
    assert "unsure-limb" in [notice.code for notice in report.warnings]


def test_front_legs_behind_shoulder_blades_need_no_names_for_the_hinge_of_their_own_bend() -> None:
    """A shoulder bends ahead as a knee does, and an elbow back: before, one sign was for both."""
    front = [
        (0.12, 1.49, 0.63),
        (0.14, 1.15, 0.8),
        (0.14, 0.83, 0.65),
        (0.14, 0.38, 0.68),
        (0.14, 0.19, 0.71),
    ]
    leg = line("blade.L upper.L elbow.L wrist.L paw.L", "chest", *front)
    for toe, x in (("inner", 0.12), ("outer", 0.16)):
        leg += line(f"{toe}.L {toe}_end.L", "paw.L", (x, 0.16, 0.76), (x, 0.14, 0.82))
    kept = [
        joint for joint in HORSE if joint[0].split(".")[0] not in ("upper_arm", "forearm", "hand", "finger")
    ]
    named = rig_with([*kept, *both(leg)])
    rig, report = replace(named, names=("",) * len(named)), Report()
    assert [named.names[chain.bend[1]] for chain in unsure(rig)] == ["elbow.L", "elbow.R"]
    out = orient_joints(rig, report=report)
    lateral = {name: round(float(x)) for name, x in zip(named.names, out.world[:, 1, 0], strict=True)}
    for side in "LR":
        assert [lateral[f"{part}.{side}"] for part in ("upper", "elbow")] == [-1, -1]
        assert [lateral[f"{part}.{side}"] for part in ("thigh", "shin", "wrist", "paw")] == [1, 1, 1, 1]
    assert "unsure-limb" in [notice.code for notice in report.warnings]


def test_the_motion_of_several_limbs_is_that_of_each_alone_to_the_bit() -> None:
    """Each has key times of its own, and only its own are looked at."""
    rig = rig_with(line("a b c d e f", "", *((0.0, float(y), 0.0) for y in range(6))))

    def swung(node: int, times: list[float], degrees: list[float]) -> Track:
        axis = normalise(np.array([1.0, 0.3, 0.2]))
        turns = np.stack([from_axis_angle(axis, np.radians(each)) for each in degrees])
        return Track(node, "rotation", "LINEAR", np.array(times), turns)

    walk = Clip("walk", (swung(2, [0, 0.4, 1.1], [0, 4, -3]), swung(3, [0.1, 0.7], [30, 50])))
    run = Clip("run", (swung(3, [0, 0.3, 0.5], [0, 40, 0]), swung(4, [0.2], [20]), swung(0, [0, 5], [0, 90])))
    rig = replace(rig, clips=(walk, run, Clip("none", ())))
    limbs = [Limb(k, k + 1, k + 2) for k in range(4)]
    alone = [in_motion(rig, [limb], rig.world, None)[0] for limb in limbs]
    together = in_motion(rig, limbs, rig.world, None)
    assert [bend is None for bend in alone] == [True, True, False, False]
    assert [pickle.dumps(bend) for bend in together] == [pickle.dumps(bend) for bend in alone]
