"""take-clips: each clip plays as in EDITED, whatever rests or moves above the body, or is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from gltf_files import standing_along_z
from places import SAMPLES, first
from taken_clips import apart, notices, rig_of, turned_key, with_tracks

from rigtri.errors import GeometryError
from rigtri.evaluation.constraint_solver import to_parts
from rigtri.evaluation.sampling import locals_at, worlds
from rigtri.formats import read
from rigtri.maths.matrices import compose, inverse, multiply
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.quaternions import multiply as multiply_rotations
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips import take_clips as module
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.messages import warn_facing
from rigtri.operations.take_clips.standing import _carriers
from rigtri.operations.take_clips.take_clips import take_clips
from rigtri.pipeline.edit import edit
from rigtri.report import Report

CLOSE = 1e-5
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def turn(axis: tuple[float, float, float], degrees: float) -> Floats:
    return from_axis_angle(axis, np.radians(degrees))


def below(rig: Rig, above: Floats) -> Rig:
    """The rig without clips, its joints where they are, below a topmost node that rests as ``above``."""
    parts = {path: getattr(rig, path).copy() for path in ("translation", "rotation", "scale")}
    matrix, hips = rig.matrix.copy(), rig.find("hips")
    for node, local in ((0, above), (hips, multiply(rig.world[hips], inverse(above)))):
        matrix[node] = local
        parts["translation"][node], parts["rotation"][node], parts["scale"][node] = to_parts(local)
    return replace(rig, clips=(), matrix=matrix, **parts)


def one_of_two_clips_moves_what_carries_the_body() -> Rig:
    """As a DCC writes it: the frame that was shown is the rest."""
    rig = rig_of()
    walk, hips = rig.clip("walk"), rig.find("hips")
    assert rig.parents[hips] == 0
    times = walk.tracks[0].times[[0, -1]]
    gone = Track(0, "translation", "LINEAR", times, np.array([[1.0, 0.0, 0.5], [2.0, 0.0, 2.5]]))
    turned = Track(0, "rotation", "LINEAR", times, np.array([turn(Y, 30.0), turn(Y, 120.0)]))
    rotation, translation = rig.rotation.copy(), rig.translation.copy()
    rotation[0], translation[0] = turned.values[0], gone.values[0]
    clips = (replace(walk, tracks=(*walk.tracks, gone, turned)), replace(walk, name="idle", key=1))
    return replace(rig, rotation=rotation, translation=translation, clips=clips)


def lying_in_centimetres() -> Rig:
    """As FBX files are: the node above the body lies on its back, in centimetres."""
    return below(rig_of(), compose([0.0, 0.0, 0.0], turn(X, -90.0), [0.01] * 3))


@pytest.mark.ci
def test_the_body_is_where_edited_has_it_in_a_clip_that_does_not_move_what_carries_it() -> None:
    """Before, it lay on its back 2 m beside, with exit code 0."""
    edited = one_of_two_clips_moves_what_carries_the_body()
    home = take_clips(lying_in_centimetres(), from_=edited)
    for clip in ("walk", "idle"):
        assert apart(home, edited, clip) < CLOSE


@pytest.mark.ci
def test_a_clip_that_would_play_otherwise_is_refused_whatever_rule_is_wrong(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module._Taking, "_rest_of_joints", lambda self: None)
    with pytest.raises(GeometryError, match=r"'idle' would not play as in EDITED: 'hips' is off by \d+"):
        take_clips(lying_in_centimetres(), from_=one_of_two_clips_moves_what_carries_the_body())


@pytest.mark.ci
def test_joints_that_edited_poses_without_keys_are_reported() -> None:
    """Before, RIG's pose was kept in silence."""
    rig, report = rig_of(), Report()
    rotation, shin = rig.rotation.copy(), rig.find("shin_L")
    rotation[shin] = turn(X, 60.0)
    edited = turned_key(rig, "forearm_L", "wave", key=0)
    take_clips(rig, from_=replace(edited, rotation=rotation), report=report)
    assert notices(report) == ["held-without-keys"]
    assert "no keys of 'shin_L' in 'wave'" in report.warnings[0].text


def bare(rig: Rig) -> Rig:
    return replace(rig, skins=())


def joints_of(rig: Rig) -> Rig:
    """The rig with its skin back, by which `apart` finds its joints."""
    return replace(rig, skins=rig.skins or rig_of().skins)


def bound_in_the_world(rig: Rig) -> Rig:
    skins = (replace(skin, inverse_bind=inverse(rig.world[skin.joints])) for skin in rig.skins)
    return replace(rig, skins=tuple(skins))


def with_rotation(rig: Rig, node: int, rotation: Floats) -> Rig:
    turns = rig.rotation.copy()
    turns[node] = rotation
    return replace(rig, rotation=turns)


@pytest.mark.parametrize("degrees", first([37.0, 60.0, 90.0, 180.0]))
@pytest.mark.parametrize("bound", [bare, bound_in_the_world, lambda rig: rig], ids=["bare", "world", "below"])
def test_a_body_faces_where_edited_has_it_whose_armature_was_turned(degrees: float, bound: Any) -> None:
    """Before, from 45° on, by 90° elsewhere; without a skin the turn was lost, or the file refused."""
    rig, report = rig_of(), Report()
    edited = bound(with_rotation(rig, 0, turn(Y, degrees)))
    assert apart(take_clips(rig, from_=edited, report=report), joints_of(edited), "walk") < CLOSE
    assert "other-facing" not in notices(report)


@pytest.mark.ci
@pytest.mark.parametrize(("axis", "degrees"), [(Y, 90.0), (Y, 180.0), (X, -90.0)])
def test_a_file_without_a_skin_may_rest_in_a_frame_with_turned_hips(
    axis: tuple[float, float, float], degrees: float
) -> None:
    """Before, it was refused as another skeleton."""
    rig = replace(rig_of(), clips=())
    walk, hips = rig_of().clip("walk"), rig.find("hips")
    first = {t.node: t.values[0] for t in walk.tracks if t.path == "rotation" and t.node != hips}
    about = multiply_rotations(turn(axis, degrees), rig.rotation[hips])
    key = Track(hips, "rotation", "STEP", walk.tracks[0].times[:1], about[np.newaxis])
    tracks = (*(t for t in walk.tracks if (t.node, t.path) != (hips, "rotation")), key)
    edited = with_rotation(bare(replace(rig, clips=(replace(walk, tracks=tracks),))), hips, about)
    for node, rotation in first.items():
        edited = with_rotation(edited, node, rotation)
    assert apart(take_clips(rig, from_=edited), joints_of(edited), "walk") < CLOSE


@pytest.mark.ci
def test_joints_posed_without_keys_in_a_file_without_a_skin_are_held_in_a_new_clip() -> None:
    """Before, a pose of two of them was another skeleton."""
    rig = rig_of()
    posed = [rig.find("forearm_L"), rig.find("spine")]
    walk = rig.clip("walk")
    clip = replace(walk, tracks=tuple(t for t in walk.tracks if t.node not in posed))
    edited = bare(replace(rig, clips=(clip,)))
    for node in posed:
        edited = with_rotation(edited, node, multiply_rotations(edited.rotation[node], turn(X, 35.0)))
    home = take_clips(replace(rig, clips=()), from_=edited)
    assert apart(home, joints_of(edited), "walk") < CLOSE


@pytest.mark.ci
def test_a_file_that_lies_at_rest_as_its_format_has_no_up_is_set_upright_with_a_warning() -> None:
    rig, report = rig_of(), Report()
    matrix = compose([0.0, 0.0, 0.0], turn(X, 90.0), [1.0] * 3)
    hips, lying = rig.find("hips"), replace(rig, parents=np.where(rig.parents == 0, -1, rig.parents))
    local = multiply(rig.world[hips], matrix)
    parts = {path: getattr(rig, path).copy() for path in ("translation", "rotation", "scale")}
    for path, values in zip(parts, to_parts(local), strict=True):
        parts[path][hips] = values
    edited = bare(replace(lying, **parts, clips=(without(rig.clip("walk"), hips),)))
    home = take_clips(replace(rig, clips=()), from_=edited, report=report)
    assert apart(home, replace(rig, clips=edited.clips), "walk") < CLOSE
    assert any("EDITED has another up axis than its format" in notice.text for notice in report.warnings)


def without(clip: Clip, node: int) -> Clip:
    return replace(clip, tracks=tuple(track for track in clip.tracks if track.node != node))


@pytest.mark.ci
def test_bind_poses_in_a_space_of_their_own_lay_nobody_down() -> None:
    """Before, a body came out on its side, as the bind poses were."""
    rig = rig_of()
    turned = np.eye(4)
    turned[:3, :3] = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]]
    skins = (replace(skin, inverse_bind=turned @ skin.inverse_bind) for skin in rig.skins)
    edited = replace(rig, skins=tuple(skins))
    assert apart(take_clips(replace(rig, clips=()), from_=edited), edited, "walk") < CLOSE


def test_a_body_beside_a_turned_armature_goes_round_with_it() -> None:
    """Before, it faced right and stood where RIG's does."""
    rig = rig_of()
    hips, translation = rig.find("hips"), rig.translation.copy()
    translation[hips] += [0.3, 0.0, 0.2]
    walk = rig.clip("walk")
    moved = tuple(t for t in walk.tracks if (t.node, t.path) != (hips, "translation"))
    beside = replace(rig, translation=translation, clips=(replace(walk, tracks=moved),))
    ours = bound_in_the_world(beside)
    edited = bound_in_the_world(with_rotation(beside, 0, turn(Y, 90.0)))
    assert apart(take_clips(ours, from_=edited), edited, "walk") < CLOSE


def laid_down(rig: Rig) -> Rig:
    """The rig in a world with another up, as its bind pose is; nothing stands above the joints."""
    hips, walk = rig.find("hips"), rig.clip("walk")
    lies = compose([0.0, 0.0, 0.0], turn(X, 90.0), [1.0] * 3)
    tracks = []
    for track in (t for t in walk.tracks if t.node == hips):
        values = np.stack([rig.translation[hips]] * len(track.times))
        matrices = compose(
            track.values if track.path == "translation" else values,
            track.values if track.path == "rotation" else np.tile(rig.rotation[hips], (len(values), 1)),
            np.ones_like(values),
        )
        parts = to_parts(multiply(matrices, lies))
        tracks.append(replace(track, values=getattr(parts, track.path)))
    others = tuple(t for t in walk.tracks if t.node != hips)
    skins = (replace(skin, inverse_bind=multiply(inverse(lies), skin.inverse_bind)) for skin in rig.skins)
    clips = (replace(walk, tracks=(*tracks, *others)),)
    # It rests in a frame of the clip, with turned hips.
    rotation, translation = rig.rotation.copy(), rig.translation.copy()
    by = {t.path: t.values[3] for t in tracks}
    rotation[hips] = by.get("rotation", rotation[hips])
    rotation[rig.find("spine")] = multiply_rotations(rotation[rig.find("spine")], turn(X, 40.0))
    translation[hips] = by.get("translation", translation[hips])
    return replace(rig, skins=tuple(skins), clips=clips, rotation=rotation, translation=translation)


@pytest.mark.parametrize("skin", [True, False])
def test_a_file_that_lies_and_rests_in_a_frame_is_set_upright_as_its_clips_show(skin: bool) -> None:
    """Before, the body lay in the result, without a word."""
    rig = replace(rig_of(), clips=(rig_of().clip("walk"),))
    rig = replace(rig, parents=np.where(rig.parents == 0, -1, rig.parents))
    edited, report = laid_down(turned_key(rig, "forearm_L")), Report()
    home = take_clips(rig, from_=edited if skin else bare(edited), report=report)
    assert any("EDITED has another up axis than its format" in notice.text for notice in report.warnings)
    assert apart(home, turned_key(rig, "forearm_L"), "walk") < CLOSE


@pytest.mark.parametrize(
    ("axis", "said"),
    [
        (X, "has another up axis than its format"),
        ((0.0, 0.0, 1.0), "faces another direction than RIG, by 90°"),
    ],
)
def test_bodies_that_lie_in_both_files_and_are_turned_about_their_own_up_face_elsewhere(
    axis: tuple[float, float, float], said: str, tmp_path: Path
) -> None:
    """Before, that was called another up axis."""
    path, report = tmp_path / "lies.glb", Report()
    path.write_bytes(standing_along_z(SAMPLES / "biped.glb"))
    rig = read(path).rig
    both: Any = SimpleNamespace(rig=rig, other=rig, space=compose([0.0] * 3, turn(axis, 90.0), [1.0] * 3))
    warn_facing(both, report)
    (notice,) = report.warnings
    assert said in notice.text


def test_a_body_that_was_laid_down_stays_so_and_is_reported() -> None:
    """RIG's bind pose and EDITED's are one, so its axes are, too."""
    rig, report = rig_of(), Report()
    walk, hips = rig.clip("walk"), rig.find("hips")
    about = multiply_rotations(turn(X, 90.0), rig.rotation[hips])
    key = Track(hips, "rotation", "LINEAR", walk.tracks[0].times[[0, -1]], np.stack([about, about]))
    tracks = (*(t for t in walk.tracks if (t.node, t.path) != (hips, "rotation")), key)
    lies = replace(rig, clips=(replace(walk, tracks=tracks),))
    assert apart(take_clips(rig, from_=lies, report=report), lies, "walk") < CLOSE
    assert "lies" in notices(report)


def test_a_body_is_carried_by_its_topmost_joint_and_what_is_above_that(samples: Path) -> None:
    rig = read(samples / "biped.glb").rig
    joints = np.flatnonzero(rig.is_joint).tolist()
    (top,) = (n for n in joints if not rig.is_joint[rig.path_to_root(n)[1:]].any())
    assert _carriers(Counterparts(rig, rig)) == {*rig.path_to_root(top)}


@pytest.mark.parametrize("names", [("biped.usda", "biped.glb"), ("biped.glb", "biped.usda")])
def test_rotations_of_another_length_become_unit_where_formats_show_them_otherwise(
    names: tuple[str, str],
) -> None:
    """UsdSkel shows them as a scale, glTF does not."""
    rig, edited = (read(SAMPLES / name).rig for name in names)
    clip = edited.clips[0].name

    def longer(track: Track) -> Track:
        linear = track.path == "rotation" and track.interpolation == "LINEAR"
        return replace(track, values=1.1 * track.values) if linear else track

    edited = with_tracks(turned_key(edited, "forearm_L", clip), clip, longer)
    home = take_clips(rig, from_=edited, clip=(clip,), as_=(f"{clip}={rig.clips[0].name}",))
    turns = [track for track in home.clips[0].tracks if track.path == "rotation"]
    assert home.clips != rig.clips
    assert all(np.abs(np.linalg.norm(track.values, axis=-1) - 1.0).max() < 1e-6 for track in turns)


def test_splines_become_straight_keys_where_the_format_has_none(tmp_path: Path) -> None:
    edited = read(SAMPLES / "biped.glb").rig
    clip = edited.clips[0].name

    def bent(track: Track) -> Track:
        if track.interpolation != "LINEAR" or track.path == "weights":
            return track
        slope = np.zeros_like(track.values)
        slope[1:-1] = 2.0 * (track.values[2:] - track.values[:-2])
        values = np.stack([slope, track.values, slope], axis=1)
        return replace(track, interpolation="CUBICSPLINE", values=values)

    edited = with_tracks(edited, clip, bent)
    out = tmp_path / "out.usda"

    def taken(rig: Rig, report: Report) -> Rig:
        return take_clips(rig, from_=edited, clip=(clip,), as_=f"{clip}={rig.clips[0].name}", report=report)

    edit(SAMPLES / "biped.usda", out, taken)
    home = read(out).rig
    made = home.clips[0]
    theirs = next(one for one in edited.clips if one.name == clip)
    seconds = np.linspace(0.0, 1.0, 41)
    there = worlds(edited, locals_at(edited, theirs, seconds))
    here = worlds(home, locals_at(home, made, seconds * home.rules.per_second))
    for name in ("hand_L", "foot_R", "head"):
        apart = np.abs(there[:, edited.find(name), 3, :3] - here[:, home.find(name), 3, :3]).max()
        assert apart < 2e-5
    assert {track.interpolation for track in made.tracks} <= {"LINEAR", "STEP"}


@pytest.mark.parametrize("scale", [(-1.0, 1.0, 1.0), (1.0, 1.0, -1.0)])
def test_a_file_that_is_mirrored_against_the_other_is_named(scale: tuple[float, float, float]) -> None:
    rig = rig_of()
    mirrored = rig.scale.copy()
    mirrored[0] = scale
    for one, other, name, free in (
        (rig, replace(rig, scale=mirrored), "EDITED", "RIG"),
        (replace(rig, scale=mirrored), rig, "RIG", "EDITED"),
    ):
        words = f"^{name} is mirrored by a negative scale from 'biped' on, and {free} is not"
        with pytest.raises(GeometryError, match=words):
            take_clips(one, from_=other)
