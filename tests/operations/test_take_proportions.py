"""take-clips: motion of a character whose bones are longer or shorter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from gltf_files import standing_along_z
from places import SAMPLES, every_other
from rigs import chain
from rigs import rig_of as nodes
from taken_clips import notices, places, rig_of

from rigtri import read
from rigtri.errors import GeometryError
from rigtri.maths.matrices import compose, decompose, inverse
from rigtri.maths.matrices import multiply as multiply_matrices
from rigtri.maths.quaternions import from_axis_angle, multiply, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length
from rigtri.model.animation import Clip, Track
from rigtri.model.animation import Path as TrackPath
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.report import Report

TIMES = np.linspace(0.0, 1.0, 9)
# As FBX lays the node above a skeleton: on its back, in centimetres.
LAID = from_axis_angle([1.0, 0.0, 0.0], -np.pi / 2.0), np.full(3, 0.01)
LEGS = ("shin_L", "foot_L", "shin_R", "foot_R")
BODIES = {
    "longer legs": dict.fromkeys(LEGS, 1.5),
    "legs a little longer": dict.fromkeys(LEGS, 1.002),
    "shorter legs": dict.fromkeys(LEGS, 0.7),
    "longer arms": dict.fromkeys(("forearm_L", "hand_L", "forearm_R", "hand_R"), 1.5),
    "one longer hand": {"hand_L": 1.2},
    "longer spine": dict.fromkeys(("spine", "chest", "neck"), 1.5),
    "all": dict.fromkeys(LEGS, 1.3) | {"chest": 1.2, "forearm_L": 0.8, "hand_R": 0.9},
}


def body(rig: Rig, lengths: Mapping[str, float], *, whole: float = 1.0) -> Rig:
    """The rig with bones so many times as long, bound as it stands, and ``whole`` times as large."""
    translation = rig.translation * whole
    for name, size in lengths.items():
        translation[rig.find(name)] *= size
    clips = tuple(
        replace(
            clip,
            tracks=tuple(
                replace(t, values=t.values * whole) if t.path == "translation" else t for t in clip.tracks
            ),
        )
        for clip in rig.clips
    )
    made = replace(rig, translation=translation, clips=clips)
    skins = (replace(skin, inverse_bind=inverse(made.world[skin.joints])) for skin in rig.skins)
    return replace(made, skins=tuple(skins))


def held(rig: Rig, path: TrackPath = "translation") -> Rig:
    """The rig with keys of what no clip moves of its joints, as a DCC writes them."""
    clips = []
    for clip in rig.clips:
        known = {(t.node, t.path) for t in clip.tracks}
        times = clip.tracks[0].times[[0, -1]]
        new = (
            Track(node, path, "LINEAR", times, np.tile(getattr(rig, path)[node], (2, 1)))
            for node in np.flatnonzero(rig.is_joint).tolist()
            if (node, path) not in known
        )
        clips.append(replace(clip, tracks=(*clip.tracks, *new)))
    return replace(rig, clips=tuple(clips))


def bones(rig: Rig) -> dict[str, Floats]:
    """Where joints are seen from their parents in the world while the clip plays, (t, 3) each."""
    at, joints = places(rig, "walk", TIMES), np.flatnonzero(rig.is_joint).tolist()
    above = {rig.names[n]: rig.names[rig.parents[n]] for n in joints if rig.is_joint[rig.parents[n]]}
    return {name: at[name] - at[parent] for name, parent in above.items() if parent in at}


def lowest(rig: Rig) -> float:
    return min(float(at[:, 1].min()) for name, at in places(rig, "walk", TIMES).items() if "toe" in name)


@pytest.mark.ci
@pytest.mark.parametrize(
    ("name", "file"),
    every_other(list(BODIES), ["with keys", "as it is", "without skin", "without skin, with keys"], of=4),
)
def test_bones_point_as_in_edited_and_keep_their_lengths(name: str, file: str) -> None:
    """Before, they went to where EDITED's were: up to 33° off, and 0.6 to 1.1 times as long."""
    rig = rig_of()
    lengths = BODIES[name]
    edited = body(rig, lengths)
    edited = held(edited) if "with keys" in file else edited
    edited = replace(edited, skins=()) if "without skin" in file else edited
    home = take_clips(rig, from_=edited)
    theirs, was = bones(body(rig, lengths)), bones(rig)
    for joint, bone in bones(home).items():
        assert float(angle(bone, theirs[joint]).max()) < np.radians(0.01), joint
        np.testing.assert_allclose(length(bone), length(was[joint]), rtol=1e-6)


@pytest.mark.parametrize("edit", ["longer legs", "turned aside"])
def test_bodies_that_stand_along_z_get_the_motion_of_those_along_y(edit: str, tmp_path: Path) -> None:
    """Before, its legs were sought along the file's up, 4 mm off, and one turned by 60° was said to lie."""
    lying = tmp_path / "lying.glb"
    lying.write_bytes(standing_along_z(SAMPLES / "biped.glb"))
    found = []
    for file, up in ((SAMPLES / "biped.glb", [0.0, 1.0, 0.0]), (lying, [0.0, 0.0, 1.0])):
        rig = read(file)
        edited = body(rig, BODIES["longer legs"])
        if edit == "turned aside":
            aside, rotation = from_axis_angle(up, np.radians(60)), rig.rotation.copy()
            top = int(np.flatnonzero(rig.parents < 0)[0])
            rotation[top] = multiply(aside, rotation[top])
            edited = replace(rig, rotation=rotation, skins=())
        found.append(places(take_clips(rig, from_=edited), "walk", TIMES))
    for name, at in found[0].items():
        expected = np.stack([at[:, 0], -at[:, 2], at[:, 1]], axis=1)
        np.testing.assert_allclose(found[1][name], expected, atol=1e-6)


@pytest.mark.ci
@pytest.mark.parametrize("size", [1.0, 1.2, 3.0, 0.01])
def test_what_carries_the_body_is_scaled_with_its_legs(size: float) -> None:
    rig, report = rig_of(), Report()
    hips = rig.translation[rig.find("hips")]
    home = take_clips(rig, from_=body(rig, dict.fromkeys(LEGS, 1.25), whole=size), report=report)
    (text,) = (notice.text for notice in report.warnings if notice.code == "other-proportions")
    assert "'shin_L'" in text
    assert "Translations of 'hips' were scaled by 0.839" in text
    thigh, shin, foot, toe = (
        float(length(rig.translation[rig.find(f"{name}_L")])) for name in ("thigh", "shin", "foot", "toe")
    )
    share = (thigh + shin + foot + toe) / (thigh + 1.25 * (shin + foot) + toe)
    was, now = (places(each, "walk", TIMES)["hips"] - hips for each in (rig, home))
    assert np.abs(was).max() > 0.01
    np.testing.assert_allclose(now, share * was, atol=1e-5)
    assert abs(lowest(home) - lowest(rig)) < 5e-3


def test_feet_stay_on_the_ground_where_edited_rests_in_another_pose() -> None:
    rig = rig_of()
    edited = body(rig, dict.fromkeys(LEGS, 1.5))
    rotation = edited.rotation.copy()
    rotation[[edited.find("thigh_L"), edited.find("upper_arm_R")]] = [0.3, 0.0, 0.0, 0.9539392]
    home = take_clips(rig, from_=replace(edited, rotation=rotation))
    assert abs(lowest(home) - lowest(rig)) < 5e-3


@pytest.mark.ci
@pytest.mark.parametrize("size", [1.0, 1.2, 0.5, 100.0])
def test_a_larger_copy_with_keys_of_scale_gives_back_the_motion_of_the_rig(size: float) -> None:
    """Before, a copy 1.2 times as large made the character float by 0.2 and grow by 1.2."""
    rig, report = rig_of(), Report()
    home = take_clips(rig, from_=held(body(rig, {}, whole=size), "scale"), report=report)
    assert "other-proportions" not in notices(report)
    for name, at in places(home, "walk", TIMES).items():
        np.testing.assert_allclose(at, places(rig, "walk", TIMES)[name], atol=1e-5, err_msg=name)


@pytest.mark.ci
def test_a_bone_that_stretches_in_edited_stretches_by_as_much() -> None:
    rig = rig_of()
    edited = body(rig, {"forearm_L": 0.8})
    arm = edited.find("forearm_L")
    values = edited.translation[arm] * np.array([[1.0], [1.5]])
    track = Track(arm, "translation", "LINEAR", TIMES[[0, -1]], values)
    clips = (replace(c, tracks=(*c.tracks, track)) if c.name == "walk" else c for c in edited.clips)
    home = take_clips(rig, from_=replace(edited, clips=tuple(clips)))
    longer = length(bones(home)["forearm_L"]) / length(bones(rig)["forearm_L"])
    np.testing.assert_allclose(longer, 1.0 + 0.5 * TIMES, atol=1e-6)


@pytest.mark.ci
def test_bind_poses_in_another_unit_than_the_world_are_the_same_bodies() -> None:
    rig = rig_of()
    edited = body(rig, BODIES["all"])
    skins = []
    for skin in edited.skins:
        bind = inverse(skin.inverse_bind)
        bind[:, :3, :3] *= 100.0
        bind[:, 3, :3] *= 100.0
        skins.append(replace(skin, inverse_bind=inverse(bind)))
    home = bones(take_clips(rig, from_=replace(edited, skins=tuple(skins))))
    for name, bone in bones(take_clips(rig, from_=edited)).items():
        np.testing.assert_allclose(home[name], bone, atol=1e-6)


def test_joints_with_another_parent_and_another_length_are_refused() -> None:
    rig = rig_of()
    edited = body(rig, {"head": 1.3})
    head, chest = edited.find("head"), edited.find("chest")
    parents, translation = edited.parents.copy(), edited.translation.copy()
    parents[head] = chest
    translation[head] = (edited.world[head] - edited.world[chest])[3, :3]
    edited = replace(edited, parents=parents, translation=translation)
    with pytest.raises(GeometryError, match="'head' has another parent and another length"):
        take_clips(rig, from_=edited)


def aside(rig: Rig, by: Floats) -> Rig:
    """The rig and where it is bound, at another place of the world, with the keys that it has."""
    translation = rig.translation.copy()
    translation[rig.parents < 0] += by
    made = replace(rig, translation=translation)
    skins = (replace(skin, inverse_bind=inverse(made.world[skin.joints])) for skin in rig.skins)
    return replace(made, skins=tuple(skins))


def posed(rig: Rig, seed: int, most: float) -> Rig:
    """The rig resting in another pose than that in which it is bound."""
    random = np.random.default_rng(seed)
    rotation = rig.rotation.copy()
    for node in np.flatnonzero(rig.is_joint).tolist():
        turn = from_axis_angle(random.normal(size=3), random.uniform(-most, most))
        rotation[node] = multiply(rotation[node], turn)
    return replace(rig, rotation=rotation)


@pytest.mark.ci
@pytest.mark.parametrize("by", [(5.0, 0.0, 0.0), (0.0, 0.0, 5.0), (3.0, 0.0, -2.0)])
def test_a_character_that_stands_aside_is_not_turned(by: tuple[float, float, float]) -> None:
    rig = rig_of()
    taken = take_clips(rig, from_=aside(rig, np.array(by)))
    there = bones(rig)
    for name, found in bones(taken).items():
        np.testing.assert_allclose(found, there[name], atol=1e-6)


@pytest.mark.ci
@pytest.mark.parametrize("seed", range(6))
def test_both_files_may_rest_in_poses_of_their_own(seed: int) -> None:
    rig = held(rig_of(), "rotation")
    ours, theirs = posed(rig, seed, 0.7), posed(rig, seed + 100, 0.7)
    assert take_clips(ours, from_=theirs).clips == ours.clips


@pytest.mark.parametrize(("ours", "theirs"), [(0.0, 0.3), (0.4, 0.1)])
def test_a_root_that_is_bound_elsewhere_leaves_feet_on_the_ground(ours: float, theirs: float) -> None:
    def walker(root: float) -> Rig:
        rig = chain((0, root, 0), (0, 1, 0), (0.1, 0.5, 0.05), (0.1, 0, 0), (0.1, 0, 0.2))
        swing = np.array([[0, 0, 0, 1.0], [np.sin(0.2), 0, 0, np.cos(0.2)]])
        times, still = np.array([0.0, 1.0]), np.tile(rig.translation[0], (2, 1))
        tracks = Track(0, "translation", "LINEAR", times, still), Track(2, "rotation", "LINEAR", times, swing)
        return replace(rig, clips=(Clip("walk", tracks, 0),))

    rig, edited = walker(ours), walker(theirs)
    twice = replace(edited.clips[0].tracks[1], values=edited.clips[0].tracks[1].values[::-1])
    edited = replace(edited, clips=(Clip("walk", (edited.clips[0].tracks[0], twice), 0),))
    taken = take_clips(rig, from_=edited)
    assert taken is not rig
    for time, found in zip(TIMES, places(taken, "walk", TIMES)["d"], strict=True):
        np.testing.assert_allclose(found, places(edited, "walk", np.array([time]))["d"][0], atol=1e-6)


def test_a_root_that_is_keyed_where_ours_is_stands_there_wherever_it_is_bound() -> None:
    """Blender binds a root in centimetres as one in metres. Before, it was lifted by its own height."""
    names = ["armature", "hips", "thigh", "shin", "foot", "head"]
    offsets = np.array(
        [(0, 0, 0), (0, 95, 0), (9, -5, 0), (0, -42, 1), (0, -42, -1), (0, 60, 0)], dtype=float
    )

    def walker(rest: float, head: float) -> Rig:
        rig = nodes(names, [-1, 0, 1, 2, 3, 1], offsets * np.array([1, rest, 1, 1, 1, 1])[:, np.newaxis])
        rig = replace(rig, scale=np.where(np.arange(6)[:, np.newaxis] == 0, 0.01, rig.scale))
        rig = replace(rig, skins=(Skin("skin", np.arange(1, 6), inverse(rig.world[1:])),))
        turns = from_axis_angle(np.tile([1.0, 0.0, 0.0], (2, 1)), np.array([0.0, head]))
        moves = offsets[1] + np.array([[0, 3, 0], [0, 4, 0]])
        times = np.array([0.0, 1.0])
        tracks = Track(1, "translation", "LINEAR", times, moves), Track(5, "rotation", "LINEAR", times, turns)
        return replace(rig, clips=(Clip("walk", tracks, 0),))

    home = take_clips(walker(1.0, 0.0), from_=walker(0.01, 0.5)).clips[0]
    for found, expected in zip(home.tracks, walker(1.0, 0.5).clips[0].tracks, strict=True):
        np.testing.assert_allclose(found.values, expected.values, atol=1e-6)


@pytest.mark.parametrize(
    ("shown", "keyed", "place"), every_other([0, 1], [True, False], [(0.0, 0.0, 0.0), (0.0, 0.5, 0.0)])
)
def test_a_node_above_that_rests_otherwise_puts_the_body_where_edited_has_it(
    place: tuple[float, float, float], keyed: bool, shown: int
) -> None:
    """FBX lays it on its back, in centimetres. Before, a character was a metre beside, without a word."""
    rig = replace(rig_of(), clips=())
    hips, parts = 1, [rig.translation.copy(), rig.rotation.copy(), rig.scale.copy()]
    lies = compose(np.array(place), *((np.array([0, 0, 0, 1.0]), np.ones(3)) if any(place) else LAID))
    for node, local in (0, lies), (hips, multiply_matrices(rig.local[hips], inverse(lies))):
        for values, part in zip(parts, decompose(local), strict=True):
            values[node] = part
    ours = replace(rig, translation=parts[0], rotation=parts[1], scale=parts[2])
    times = np.array([0.0, 1.0])
    ways, turns = np.array([[0, 0, 0], [1.0, 0, 2]]), np.array([[0, 0, 0, 1], [0, 0.28, 0, 0.96]])
    tracks = [Track(0, "translation", "LINEAR", times, ways), Track(0, "rotation", "LINEAR", times, turns)]
    if keyed:
        bob = rig.translation[hips] + [[0, 0, 0], [0, 0.1, 0]]
        tracks.append(Track(hips, "translation", "LINEAR", times, bob))
    resting, turned = rig.translation.copy(), rig.rotation.copy()
    resting[0], turned[0] = ways[shown], turns[shown]  # the frame that the DCC has shown
    edited = replace(rig, translation=resting, rotation=turned, clips=(Clip("walk", tuple(tracks), 0),))
    home = take_clips(ours, from_=edited)
    theirs = places(edited, "walk", times)
    for name, found in places(home, "walk", times).items():
        np.testing.assert_allclose(found, theirs[name], atol=1e-5)


def test_a_body_that_only_keys_of_the_rig_place_below_a_moved_node_is_refused() -> None:
    rig = rig_of()
    times, translation = np.array([0.0, 1.0]), rig.translation.copy()
    track = Track(0, "translation", "LINEAR", times, np.array([[0, 0, 0], [1.0, 0, 2]]))
    translation[1] += [0.0, 0.0, 0.5]
    edited = replace(rig, translation=translation, clips=(Clip("walk", (track,), 0),))
    with pytest.raises(
        GeometryError, match="EDITED moves 'biped', but has no location keys of its child 'hips'"
    ):
        take_clips(rig, from_=edited)


@pytest.mark.parametrize("degrees", [0.0, 48.0, 80.0])
def test_edited_may_be_bound_and_rest_in_the_frame_that_was_shown(degrees: float) -> None:
    """Blender's USD has z up and may be bound leaning. Before, keys were taken that nobody had moved."""
    rig = rig_of()
    hips, rotation, translation = rig.find("hips"), rig.rotation.copy(), rig.translation.copy()
    rotation[0] = from_axis_angle([1.0, 0.0, 0.0], np.pi / 2.0)
    rotation[hips] = multiply(rotation[hips], from_axis_angle([1.0, 0.0, 0.0], -np.radians(degrees)))
    leaning = replace(rig, rotation=rotation, rules=replace(rig.rules, up=(0.0, 0.0, 1.0)))
    skins = (replace(skin, inverse_bind=inverse(leaning.world[skin.joints])) for skin in rig.skins)
    # The frame that was shown: a little beside where the topmost joint is bound.
    translation[hips] += 0.01
    edited = replace(leaning, translation=translation, skins=tuple(skins))
    assert take_clips(rig, from_=edited) is rig


def test_bones_that_only_point_elsewhere_are_reported_with_the_largest_angle() -> None:
    """Before, they were said to have other lengths."""
    rig, translation = rig_of(), rig_of().translation.copy()
    for name, degrees in {"shin_L": 2.0, "shin_R": 4.0}.items():
        node = rig.find(name)
        translation[node] = rotate(from_axis_angle([1.0, 0.0, 0.0], np.radians(degrees)), translation[node])
    report = Report()
    take_clips(rig, from_=replace(rig, translation=translation, skins=()), report=report)
    (text,) = (notice.text for notice in report.warnings if notice.code == "other-proportions")
    assert "'shin_L', 'shin_R' point in other directions in EDITED, by up to 3.97° ('shin_R')" in text
    assert "length" not in text


def test_joints_that_stretch_a_little_are_compared_all_the_same() -> None:
    rig = held(rig_of())
    other = body(rig, {})
    names = list(other.names)
    for one, two in (("thigh_L", "upper_arm_L"), ("shin_L", "forearm_L")):
        a, b = names.index(one), names.index(two)
        names[a], names[b] = names[b], names[a]
    clips = tuple(
        replace(
            clip,
            tracks=tuple(
                replace(t, values=t.values * np.linspace(1.0, 1.02, len(t.values))[:, np.newaxis])
                if t.path == "translation"
                else t
                for t in clip.tracks
            ),
        )
        for clip in other.clips
    )
    with pytest.raises(GeometryError, match="point in other directions"):
        take_clips(rig, from_=replace(other, names=tuple(names), clips=clips))
