"""take-clips: no axes of joints are mistaken in silence, wherever either file rests."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from places import SAMPLES, ci, first, slow
from rigs import rig_of as plain_rig
from taken_clips import notices, resting, rig_of, shown_at, turned_key, without_skin

from rigtri.errors import GeometryError
from rigtri.evaluation import sampling
from rigtri.maths.matrices import from_frame, inverse, multiply
from rigtri.maths.quaternions import IDENTITY, from_axis_angle, rotate, to_axes
from rigtri.maths.quaternions import conjugate as opposite
from rigtri.maths.quaternions import multiply as multiply_rotations
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.animation import Clip, Track
from rigtri.model.metadata import ControlRecord, OffsetRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.operations.take_clips.bind_axes import BoundAxes, _at_one_place
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.operations.take_clips.unsure_axes import _shown_by_bones
from rigtri.report import Report

CLOSE = 1e-4
NODES = LEAF, INNER = "fingers_L", "forearm_L"


def rolled(rig: Rig, joint: str, degrees: float = 90.0, about: Any = None) -> Rig:
    """The same motion and skin with the axes of a joint turned about its bone, if it has one, or an axis."""
    node = rig.find(joint)
    below = list(rig.children[node])
    along = rig.translation[below[0]] if below else np.array([1.0, 2.0, 3.0])
    along = along if about is None else np.array(about)
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


def bound_without(rig: Rig, *joints: str) -> Rig:
    """The rig whose skin does not hold some joints and all below them."""
    (skin,) = rig.skins
    left = {node for joint in joints for node in rig.below(rig.find(joint))}
    rows = [row for row, node in enumerate(skin.joints.tolist()) if node not in left]
    held = replace(skin, joints=skin.joints[rows], inverse_bind=skin.inverse_bind[rows], weigh=None)
    return replace(rig, skins=(held,))


ARMS = "clavicle_L", "clavicle_R"


@pytest.mark.parametrize("theirs", [(), ARMS], ids=["held by EDITED", "held by neither"])
def test_other_axes_of_nodes_outside_the_skin_are_refused(theirs: tuple[str, ...]) -> None:
    """Before, they were turned as the joint above is, in silence: by up to 180°."""
    rig = bound_without(rig_of(), *ARMS)
    assert not rig.is_joint[rig.find("hand_L")]
    with pytest.raises(GeometryError, match=r"another skeleton.*_[LR]: \d+°.*limit 5°"):
        take_clips(rig, from_=bound_without(orient_joints(rig_of()), *theirs))


@pytest.mark.parametrize(("joint", "new"), [(LEAF, False), ci(INNER, False), ci(LEAF, True), ci(INNER, True)])
def test_rolled_axes_of_nodes_outside_the_skin_are_warned_of(joint: str, new: bool) -> None:
    """Before, such a node was twisted in silence."""
    rig = bound_without(rig_of(), *ARMS)
    if new:
        rig = replace(rig, clips=())
    turned = rolled(rig_of(), joint)
    for edited, told in (rig_of(), False), (turned, True), (bound_without(turned, *ARMS), True):
        report = Report()
        take_clips(rig, from_=turned_key(edited, "thigh_L"), report=report)
        found = [notice for notice in report.warnings if notice.code == "unsure-axes"]
        assert bool(found) is told
        if told:
            assert found[0].text.startswith("No skins of both files show which axes some nodes have")
            assert joint in found[0].names


def test_bones_outside_the_skin_that_point_a_little_elsewhere_are_warned_of() -> None:
    rig, report = bound_without(rig_of(), *ARMS), Report()
    take_clips(rig, from_=rolled(rig_of(), INNER, 3.0, about=[1.0, 0.0, 0.0]), report=report)
    assert "'hand_L' point in other directions in EDITED, by up to 2.58°" in report.warnings[0].text


def with_binds(rig: Rig, matrix: Floats) -> Rig:
    """The rig with one inverse bind matrix, (4, 4), for all joints."""
    (skin,) = rig.skins
    alike = np.broadcast_to(matrix, skin.inverse_bind.shape).copy()
    return replace(rig, skins=(replace(skin, inverse_bind=alike),))


@pytest.mark.parametrize("whose", ["RIG", "EDITED"])
@pytest.mark.parametrize("row", first([-1, 0]))
def test_inverse_binds_that_are_all_alike_are_no_bind_pose(whose: str, row: int) -> None:
    """Before, joints were 180° off, with warnings of a body that lies and of keys that were there."""
    rig, edited = rig_of(), turned_key(rig_of(), "thigh_L")
    matrix = np.eye(4) if row < 0 else rig.skins[0].inverse_bind[row]
    wanted, report = skinned(edited), Report()
    ours, theirs = (with_binds(rig, matrix), edited) if whose == "RIG" else (rig, with_binds(edited, matrix))
    home = take_clips(ours, from_=theirs, report=report)
    for name, moved in skinned(replace(home, skins=rig.skins)).items():
        np.testing.assert_allclose(moved, wanted[name], atol=CLOSE)
    assert not report.warnings
    turned = orient_joints(edited)
    with pytest.raises(GeometryError, match="another skeleton"):
        take_clips(ours, from_=turned if whose == "RIG" else with_binds(turned, matrix))


def test_axes_that_rest_shows_to_be_others_are_refused_where_both_files_bind_at_one_place() -> None:
    """Before, joints were 177° off."""
    rig, matrix = rig_of(), np.eye(4)
    alike = with_binds(rig, matrix)
    edited = turned_key(alike, "thigh_L")
    for name, moved in skinned(take_clips(alike, from_=edited)).items():
        np.testing.assert_allclose(moved, skinned(edited)[name], atol=CLOSE)
    with pytest.raises(GeometryError, match="another skeleton"):
        take_clips(alike, from_=with_binds(orient_joints(rig), matrix))


def test_joints_that_both_files_bind_at_one_place_are_known_by_it() -> None:
    """Each file in its own place: so bind poses show no bones. Where only one does, nothing is learnt."""
    rig, matrix = rig_of(), np.eye(4)
    alike, same = with_binds(rig, matrix), {node: node for node in range(len(rig))}
    joints = set(rig.skins[0].joints.tolist())
    assert BoundAxes(alike, alike, same).at_one_place == joints
    assert BoundAxes(rig, rig, same).at_one_place == set()
    assert set(BoundAxes(rig, rig, same).turns) == joints
    mixed = BoundAxes(rig, alike, same)
    assert (mixed.at_one_place, mixed.turns) == (set(), {})


def test_a_skin_of_one_joint_binds_nothing_at_one_place() -> None:
    skin = rig_of().skins[0]
    one = replace(skin, joints=skin.joints[:1], inverse_bind=skin.inverse_bind[:1])
    assert not _at_one_place(one)
    assert _at_one_place(replace(skin, inverse_bind=np.tile(np.eye(4), (len(skin.joints), 1, 1))))
    assert not _at_one_place(skin)


def test_two_bones_that_point_as_in_rig_and_not_along_one_line_show_axes() -> None:
    x, y = np.array([1.0, 0, 0]), np.array([0.0, 1, 0])

    def bone(ours: Floats, theirs: Floats, size: float = 1.0, slides: bool = False) -> Any:
        return SimpleNamespace(ours=ours, theirs=theirs, slides=slides, sizes=(1.0, size))

    def shown(*bones: Any) -> set[int]:
        both = SimpleNamespace(size=1.0, line=lambda node: (0, 0, 7))
        bodies: Any = SimpleNamespace(both=both, bones=dict(enumerate(bones)), at_rest={})
        return _shown_by_bones(bodies)

    assert shown(bone(x, x), bone(y, y)) == {7}
    assert shown(bone(x, x)) == shown(bone(x, x), bone(x, x)) == shown(bone(x, x), bone(-x, -x)) == set()
    assert shown(bone(x, x), bone(y, x)) == set()  # points elsewhere
    assert shown(bone(x, x), bone(y, y, slides=True)) == shown(bone(x, x), bone(y, y, size=1e-9)) == set()


@pytest.mark.parametrize("angle", [0.0, 0.3])
def test_a_mirrored_node_moves_as_in_a_file_that_mirrors_all_its_axes(angle: float) -> None:
    """Blender writes one mirrored axis as three and a half turn about it."""
    rig = plain_rig(["top", "arm", "hand"], [-1, 0, 1], np.eye(3))
    scale, times = np.array([[1, 1, 1], [-1, 1, 1], [1, 1, 1]], dtype=float), np.arange(2.0)
    turns = np.stack([from_axis_angle([1, 2, 3], each) for each in (0.0, 0.5)])
    swing = Track(1, "rotation", "LINEAR", times, turns)
    rig = replace(rig, scale=scale, clips=(Clip("swing", (swing,)),))
    half = from_axis_angle([1, 0, 0], np.pi)
    edited = replace(
        swing, values=multiply_rotations(turns, multiply_rotations(from_axis_angle([0, 1, 0], angle), half))
    )
    rotation = rig.rotation.copy()
    rotation[1] = half
    other = replace(rig, scale=np.abs(scale) * [[1], [-1], [1]], rotation=rotation)
    other = replace(other, clips=(Clip("swing", (edited,)),))
    home = take_clips(rig, from_=other)
    there, here = (
        sampling.worlds(each, sampling.locals_at(each, each.clip("swing"), times)) for each in (other, home)
    )
    assert np.abs(here - there).max() <= 1e-9
    assert (home.clips == rig.clips) == (angle == 0.0)


@pytest.mark.parametrize("preset", ["talk", "blender", "maya"])
def test_a_side_that_is_mirrored_by_one_axis_moves_as_in_a_file_with_oblique_axes(preset: str) -> None:
    """Before, this was refused, and keys were asked for that there were."""
    rig = rig_of()
    scale = rig.scale.copy()
    scale[rig.find("clavicle_R")] = [-1.0, 1.0, 1.0]
    rig = replace(rig, scale=scale)
    skins = [replace(skin, inverse_bind=inverse(rig.world[skin.joints])) for skin in rig.skins]
    rig = replace(rig, skins=tuple(skins))
    turned = orient_joints(rig, preset=preset)
    for one, other in ((rig, turned), (turned, rig)):
        times = sampling.key_times(other.clip("walk"))
        home = take_clips(one, from_=other)
        there, here = (
            sampling.worlds(each, sampling.locals_at(each, each.clip("walk"), times))[:, rig.is_joint, 3, :3]
            for each in (other, home)
        )
        assert np.abs(here - there).max() <= 1e-6


def test_controls_of_plain_nodes_are_bones_of_their_own_in_another_world() -> None:
    """Blender's world has z up: nodes stand in it as the top one does, and bones each in their own axes."""
    points = np.array([[0, 0, 0], [0, 2, 0], [1, 2, 0], [0, 0, 0]], dtype=float)
    rig = plain_rig(["World", "arm", "arm_offset", "arm_ctl"], [-1, 0, 0, 2], points)
    notes = {2: OffsetRecord(kind="fk", joint="arm"), 3: ControlRecord(kind="fk", joint="arm")}
    times, still = np.arange(2.0), np.tile(IDENTITY, (2, 1))
    turns = np.stack([from_axis_angle([1, 2, 3], each) for each in (0.0, 0.5)])
    swing = (Track(1, "rotation", "LINEAR", times, turns), Track(3, "rotation", "LINEAR", times, turns))
    metadata = {node: note.to_dict() for node, note in notes.items()}
    rig = replace(rig, metadata=metadata, clips=(Clip("swing", swing),))
    upright = from_axis_angle([1, 0, 0], np.pi / 2)
    rotation, translation = rig.rotation.copy(), points.copy()
    rotation[[0, 2]], translation[2] = upright, rotate(upright, points[2])
    parents, bones = rig.parents.copy(), np.array([2, 3])
    parents[2] = -1
    other = replace(rig, metadata={}, parents=parents, rotation=rotation, translation=translation)
    other = replace(other, rules=replace(rig.rules, up=(0.0, 0.0, 1.0)))
    edited = multiply_rotations(turns, from_axis_angle([0, 1, 0], 0.3))
    tracks = (
        swing[0],
        replace(swing[1], values=edited),
        Track(2, "rotation", "LINEAR", times, still + upright - IDENTITY),
    )
    other = replace(
        other, skins=(Skin("bones", bones, inverse(other.world[bones])),), clips=(Clip("swing", tracks),)
    )
    home = take_clips(rig, from_=other)
    found = {track.node: track.values for track in home.clips[0].tracks}
    assert found.keys() == {1, 3}
    assert np.abs(found[3] - edited).max() <= 1e-9
