"""take-clips: no axes of joints are mistaken in silence, wherever either file rests."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from places import SAMPLES, ci, slow
from taken_clips import notices, resting, rig_of, shown_at, turned_key, without_skin

from rigtri.errors import GeometryError
from rigtri.evaluation import sampling
from rigtri.maths.matrices import from_frame, inverse, multiply
from rigtri.maths.quaternions import conjugate as opposite
from rigtri.maths.quaternions import from_axis_angle, rotate, to_axes
from rigtri.maths.quaternions import multiply as multiply_rotations
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.report import Report

CLOSE = 1e-4
NODES = LEAF, INNER = "fingers_L", "forearm_L"


def rolled(rig: Rig, joint: str, degrees: float = 90.0) -> Rig:
    """The same motion and skin with the axes of a joint turned about its bone, if it has one."""
    node = rig.find(joint)
    below = list(rig.children[node])
    along = rig.translation[below[0]] if below else np.array([1.0, 2.0, 3.0])
    roll = from_axis_angle(normalise(along), np.radians(degrees))
    back = opposite(roll)

    def keyed(track: Track) -> Track:
        values = track.values
        if track.node == node and track.path == "rotation":
            values = multiply_rotations(values, roll)
        elif track.node in below and track.path == "rotation":
            values = multiply_rotations(back, values)
        elif track.node in below and track.path == "translation":
            values = rotate(back, values)
        return replace(track, values=values)

    rotation, translation = rig.rotation.copy(), rig.translation.copy()
    rotation[node] = multiply_rotations(rotation[node], roll)
    rotation[below] = multiply_rotations(back, rotation[below])
    translation[below] = rotate(back, translation[below])
    skins = [replace(skin, inverse_bind=skin.inverse_bind.copy()) for skin in rig.skins]
    for skin in skins:
        rows = skin.joints == node
        turn = inverse(from_frame(to_axes(roll), np.zeros(3)))
        skin.inverse_bind[rows] = multiply(skin.inverse_bind[rows], turn)
    clips = (replace(clip, tracks=tuple(map(keyed, clip.tracks))) for clip in rig.clips)
    turned = resting(rig, translation=translation, rotation=rotation)
    return replace(turned, skins=tuple(skins), clips=tuple(clips))


def skinned(rig: Rig) -> dict[str, Floats]:
    """What moves the points of each joint while ``walk`` plays."""
    times = np.linspace(0.0, 1.0, 9) * rig.rules.per_second
    world = sampling.worlds(rig, sampling.locals_at(rig, rig.clip("walk"), times))
    (skin,) = rig.skins
    moved = multiply(skin.inverse_bind[:, np.newaxis], world[:, skin.joints].swapaxes(0, 1))
    return dict(zip((rig.names[n] for n in skin.joints), moved, strict=True))


@pytest.mark.ci
def test_a_rolled_joint_moves_its_points_as_before() -> None:
    for joint in LEAF, INNER:
        there = skinned(rolled(rig_of(), joint))
        for name, moved in skinned(rig_of()).items():
            np.testing.assert_allclose(there[name], moved, atol=CLOSE)


def cases() -> list[Any]:
    """The whole matrix: what is hidden in a file without a skin at each commit, in one format, else slow."""
    poses = ["bind", "frame"], ["bind", "frame"]
    found = []
    for values in product(
        ["biped.glb", "biped.usda"], [False, True], *poses, [True, False], [True, False], NODES
    ):
        file, new, ours, theirs, skin, roll, _ = values
        hidden = file == "biped.glb" and not new and roll and not skin and "frame" in (ours, theirs)
        found.append(ci(*values) if hidden else slow(*values))
    return found


@pytest.mark.parametrize(("file", "new", "ours", "theirs", "skin", "roll", "joint"), cases())
def test_axes_are_carried_or_refused_or_warned_of(
    file: str, new: bool, ours: str, theirs: str, skin: bool, roll: bool, joint: str
) -> None:
    """Before, limbs were twisted by 90° in silence where the files rest in different poses, and a leaf, too,
    where either rests in a frame."""
    rig = rig_of(SAMPLES / file)
    edited = turned_key(rolled(rig, joint) if roll else rig, "thigh_L")
    if theirs == "frame":
        edited = shown_at(edited, 0.3)
    if ours == "frame":
        rig = shown_at(rig, 0.7)
    if new:
        rig = replace(rig, clips=())
    report, wanted = Report(), skinned(edited)
    try:
        home = take_clips(rig, from_=edited if skin else without_skin(edited), report=report)
    except GeometryError:
        assert roll
        assert not skin
        return
    right = all(np.abs(moved - wanted[name]).max() < CLOSE for name, moved in skinned(home).items())
    assert right or "unsure-axes" in notices(report)
    assert right or (roll and not skin)
    if skin or (theirs == "bind" and not roll):
        assert "unsure-axes" not in notices(report)


def test_rolled_joints_are_reported_with_what_is_edited_of_them_and_poses_are_not() -> None:
    rig = rig_of()
    edited = turned_key(rig, "thigh_L")
    posed = edited.rotation.copy()
    posed[rig.find(INNER)] = multiply_rotations(posed[rig.find(INNER)], from_axis_angle([1.0, 0.0, 0.0], 1.0))
    for theirs, told in (resting(edited, rotation=posed), False), (rolled(edited, INNER), True):
        report = Report()
        take_clips(shown_at(rig, 0.7), from_=without_skin(theirs), report=report)
        texts = [notice.text for notice in report.warnings if notice.code == "unsure-axes"]
        assert bool(texts) is told
    assert re.search(r"\('forearm_L: \d\d\.\d°', 'hand_L: \d\d\.\d°'\)", texts[0])
    (notice,) = (notice for notice in report.warnings if notice.code == "unsure-axes")
    assert notice.as_record()["names"] == ("forearm_L", "hand_L")  # all, however many the text has
    assert "names" not in replace(notice, names=()).as_record()


@pytest.mark.ci
def test_a_frame_that_a_file_without_bind_matrices_rests_in_is_no_other_axes() -> None:
    """Before, it was: a UsdSkel animation alone, which rests as its first frame, was refused."""
    rig = rig_of()
    edited = shown_at(turned_key(rig, "thigh_L"), 0.3)
    unbound = replace(edited, skins=tuple(replace(skin, stored=False) for skin in edited.skins))
    wanted, report = skinned(edited), Report()
    for name, moved in skinned(take_clips(rig, from_=unbound, report=report)).items():
        np.testing.assert_allclose(moved, wanted[name], atol=CLOSE)
    assert "unsure-axes" not in notices(report)
