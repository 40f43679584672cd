"""take-clips between two characters that conform to one skeleton: rest poses count, not bind poses."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from places import SAMPLES, ci
from taken_clips import notices, rig_of, without_skin

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import key_times, locals_at, worlds
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.operations.add_root import add_root
from rigtri.operations.conform import conform
from rigtri.operations.set_rest import set_rest
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.motion_check import MotionCheck, refuse_other_motion
from rigtri.operations.take_clips.standard_rest import standard_rest
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.report import Report

# Bones whose directions a T-pose or A-pose says, as unity, VRM and Godot call the joints at their ends.
LIMBS = [
    (side + start, side + end)
    for side in ("Left", "Right")
    for start, end in (
        ("UpperArm", "LowerArm"),
        ("LowerArm", "Hand"),
        ("UpperLeg", "LowerLeg"),
        ("LowerLeg", "Foot"),
    )
]


@cache
def biped(to: str = "unity") -> Rig:
    return conform(rig_of(), to=to)


@cache
def other_body(to: str = "unity") -> Rig:
    """A body of other proportions, bound in a T-pose where the biped is bound in an A-pose."""
    rig = conform(rig_of(SAMPLES / "tpose.glb"), to=to)
    return replace(rig, clips=())


def pointing(rig: Rig, clip: str, times: Floats) -> Floats:
    """Where limbs point at times of a clip, (k, f, 3), unit."""
    world = worlds(rig, locals_at(rig, rig.clip(clip), times))[..., 3, :3]
    along = [world[:, rig.find(end)] - world[:, rig.find(start)] for start, end in LIMBS]
    return np.array([each / np.linalg.norm(each, axis=-1, keepdims=True) for each in along])


def degrees_apart(one: Floats, two: Floats) -> float:
    return float(np.degrees(2.0 * np.arcsin(np.linalg.norm(one - two, axis=-1) / 2.0)).max())


@pytest.mark.parametrize("to", ["unreal", "vrm", *map(ci, ("unity", "godot", "mixamo"))])
def test_conformed_characters_share_clips(to: str) -> None:
    """Before, their bind poses were compared, and refused: upper arms by 15°."""
    rig, edited = other_body(to), biped(to)
    report = Report()
    home = take_clips(rig, from_=edited, report=report)
    assert "new-clip" in notices(report)
    for clip in edited.clips:
        keys = key_times(clip)
        theirs = worlds(edited, locals_at(edited, clip, keys))
        ours = worlds(home, locals_at(home, home.clip(clip.name), keys))
        # Counted from rest, every joint is rotated in the world as in EDITED.
        for name in (n for n in rig.names if n in edited.names and rig.is_joint[rig.find(n)]):
            here, there = rig.find(name), edited.find(name)
            turns = [
                np.linalg.inv(each.world[node, :3, :3]) @ world[:, node, :3, :3]
                for each, node, world in ((rig, here, ours), (edited, there, theirs))
            ]
            if not name.startswith("ik_"):
                assert np.abs(turns[0] - turns[1]).max() < 1e-5, name
    if to == "unity":
        keys = key_times(edited.clip("walk"))
        assert degrees_apart(pointing(home, "walk", keys), pointing(edited, "walk", keys)) < 0.01


def test_keys_of_rotation_are_the_very_keys() -> None:
    """Axes of one standard are one to rounding: what an engine would play of EDITED is what is written."""
    rig, edited = other_body(), biped()
    home = take_clips(rig, from_=edited)
    for track in (t for t in home.clip("walk").tracks if t.path == "rotation"):
        name = home.names[track.node]
        known = [
            t for t in edited.clip("walk").tracks if (edited.names[t.node], t.path) == (name, "rotation")
        ]
        for each in known:
            rows = np.isin(each.times, track.times)
            assert np.abs(each.values[rows] - track.values).max() < 1e-6, name


def test_bones_that_no_pose_sets_are_reported_with_their_degrees() -> None:
    report = Report()
    take_clips(other_body(), from_=biped(), report=report)
    (text,) = (notice.text for notice in report.warnings if notice.code == "other-proportions")
    assert "rest in one standard pose" in text
    assert "off by" not in text


def test_bodies_that_rest_in_different_poses_are_refused() -> None:
    edited = set_rest(biped(), pose="apose")
    with pytest.raises(GeometryError, match=r"elsewhere at rest \('Left\w+: 45°'.*rest in one pose"):
        take_clips(other_body(), from_=edited)


def test_sides_that_names_exchange_are_refused() -> None:
    edited = biped()
    swapped = {"Left": "Right", "Right": "Left"}
    names = tuple(
        next((new + name[len(old) :] for old, new in swapped.items() if name.startswith(old)), name)
        for name in edited.names
    )
    with pytest.raises(GeometryError, match="another skeleton"):
        take_clips(other_body(), from_=replace(edited, names=names))


def below_the_neck(rig: Rig) -> Rig:
    """The rig with its clavicles below the neck, as 3ds Max's Biped has them; its axes are the world's."""
    neck, parents, translation = rig.find("Neck"), rig.parents.copy(), rig.translation.copy()
    for shoulder in (rig.find("LeftShoulder"), rig.find("RightShoulder")):
        parents[shoulder] = neck
        translation[shoulder] = (rig.world[shoulder] - rig.world[neck])[3, :3]
    return replace(rig, parents=parents, translation=translation)


def test_clavicles_below_the_neck_are_rotated_as_in_edited_and_keep_their_bones() -> None:
    """Before, they were refused: their bones would stretch between neck and chest."""
    rig, edited = below_the_neck(other_body()), biped()
    report = Report()
    home = take_clips(rig, from_=edited, report=report)
    keys = key_times(edited.clip("walk"))
    assert degrees_apart(pointing(home, "walk", keys), pointing(edited, "walk", keys)) < 0.01
    moved = [t for t in home.clip("walk").tracks if t.path == "translation"]
    for shoulder in (home.find("LeftShoulder"), home.find("RightShoulder")):
        for track in (t for t in moved if t.node == shoulder):
            np.testing.assert_allclose(track.values, rig.translation[[shoulder]], atol=1e-6)
    (text,) = (notice.text for notice in report.warnings if notice.code == "other-parents")
    assert "LeftShoulder" in text


def test_a_library_without_a_skin_plays_on_another_character() -> None:
    rig, edited = other_body(), biped()
    home = take_clips(rig, from_=without_skin(edited))
    keys = key_times(edited.clip("walk"))
    assert degrees_apart(pointing(home, "walk", keys), pointing(edited, "walk", keys)) < 0.01


@pytest.mark.parametrize("degrees", [90.0, 8.0])
def test_a_body_that_faces_another_way_keeps_its_own(degrees: float) -> None:
    """Its axes are turned with it, and so is the motion."""
    turn = from_axis_angle(np.array([0.0, 1.0, 0.0]), np.radians(degrees))
    rig = other_body()
    rotation = rig.rotation.copy()
    rotation[rig.find("Hips")] = multiply(turn, rotation[rig.find("Hips")])
    aside = replace(rig, rotation=rotation)
    home, plain = take_clips(aside, from_=biped()), take_clips(rig, from_=biped())
    keys = key_times(plain.clip("walk"))
    about = np.array(
        [
            [np.cos(np.radians(degrees)), 0.0, -np.sin(np.radians(degrees))],
            [0.0, 1.0, 0.0],
            [np.sin(np.radians(degrees)), 0.0, np.cos(np.radians(degrees))],
        ]
    )
    assert degrees_apart(pointing(home, "walk", keys), pointing(plain, "walk", keys) @ about) < 0.01


def test_a_body_that_lies_at_rest_and_stands_in_its_clips_stands() -> None:
    """Before, where only clips say what is up, refused: no rotation by 90° set it upright."""
    edited = biped()
    hips = edited.find("Hips")
    assert {("Hips", "rotation")} <= {(edited.names[t.node], t.path) for t in edited.clip("walk").tracks}
    rotation = edited.rotation.copy()
    rotation[hips] = multiply(from_axis_angle(np.array([1.0, 0.0, 0.0]), np.pi), rotation[hips])
    edited = replace(edited, clips=(edited.clip("walk"),))
    home = take_clips(other_body(), from_=replace(edited, rotation=rotation))
    keys = key_times(edited.clip("walk"))
    assert degrees_apart(pointing(home, "walk", keys), pointing(edited, "walk", keys)) < 0.01


@pytest.mark.ci
def test_ik_bones_of_another_body_are_told_and_follow_again() -> None:
    report = Report()
    home = take_clips(other_body("unreal"), from_=biped("unreal"), report=report)
    (text,) = (notice.text for notice in report.warnings if notice.code == "followers-behind")
    assert "'ik_foot_l'" in text
    assert "add-root --profile unreal" in text
    home = add_root(home, profile="unreal")
    walk = home.clip("walk")
    world = worlds(home, locals_at(home, walk, key_times(walk)))[..., 3, :3]
    assert np.abs(world[:, home.find("ik_foot_l")] - world[:, home.find("foot_l")]).max() < 1e-6


def test_another_skeleton_is_told_what_makes_it_one() -> None:
    """Before, the advice was to export EDITED with its skin, which it had."""
    edited = rig_of(SAMPLES / "tpose.glb")
    rig = rig_of()
    with pytest.raises(GeometryError, match="conform both files to one skeleton") as caught:
        take_clips(rig, from_=edited)
    assert "its skin" not in str(caught.value)


REAL = ("gltf/kaykit_Barbarian.glb", "gltf/khronos_CesiumMan_Binary.glb", "usd/usdwg_CesiumMan.usdz")


@pytest.mark.parametrize("name", REAL)
@pytest.mark.parametrize("to", ["unity", "godot"])
def test_real_characters_take_the_walk_of_the_biped(assets: Path, name: str, to: str) -> None:
    edited = biped(to)
    rig = replace(conform(rig_of(assets / name), to=to), clips=())
    kept = {k for n, title in enumerate(edited.names) if title in rig.names for k in edited.path_to_root(n)}
    clip = edited.clip("walk")
    edited = replace(edited, clips=(replace(clip, tracks=tuple(t for t in clip.tracks if t.node in kept)),))
    home = take_clips(rig, from_=edited)
    keys = key_times(edited.clip("walk"))
    ours, theirs = pointing(home, "walk", keys * home.rules.per_second), pointing(edited, "walk", keys)
    # Of the body's own world: one of the 24 rotations, or a body that faces aside.
    u, _, v = np.linalg.svd(np.einsum("kfi,kfj->ij", theirs, ours))
    assert degrees_apart(ours, theirs @ u @ v) < 0.01


def test_keys_that_stay_in_a_clip_of_the_same_name_are_named_with_the_way_out() -> None:
    """Before, "a rest pose or a hierarchy that take-clips cannot map"."""
    rig = add_root(biped(), name="sway", above="LeftHand")
    sway, hand = rig.find("sway"), rig.find("LeftHand")
    both = SimpleNamespace(of={node: node for node in range(len(rig)) if node != sway})
    seen = SimpleNamespace(taken=SimpleNamespace(name="walk"), tracks={(sway, "rotation"): None})
    check: Any = SimpleNamespace(rig=rig, both=both, seen=seen)
    check.moved_by_rig = partial(MotionCheck.moved_by_rig, check)
    check.found = lambda: ([SimpleNamespace(joint=hand, text="'LeftHand' is off")], [])
    with pytest.raises(GeometryError, match=r"keys of 'sway', which .* --as 'walk=walk_2'"):
        refuse_other_motion(check, (), Report())
    seen.tracks = {}
    with pytest.raises(GeometryError, match="take-clips cannot map"):
        refuse_other_motion(check, (), Report())


def test_no_mesh_is_of_the_one_skin_that_joints_are_bound_by_at_rest() -> None:
    """Before, joints of one skin were looked up in another, or in none."""
    found = standard_rest(Counterparts(other_body(), biped())).counterparts()
    for rig in (found.rig, found.other):
        assert len(rig.skins) == 1
        assert {mesh.skin for mesh in (*rig.content.outlines, *rig.content.read_meshes())} <= {None}
