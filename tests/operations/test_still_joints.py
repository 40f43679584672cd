"""Joints out of the middle of a chain: what is below them stands and moves as before."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES
from program import cli
from pxr import Sdf, Usd, UsdSkel
from still_joints import with_still_joints

import rigtri
from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.sampling import key_times, locals_at, worlds
from rigtri.maths.quaternions import from_axis_angle
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.report import Report

# Above a joint with splines, in the trunk, above a hand with a staff, and a hip.
ABOVE = {"forearm_L": "helper_a", "chest": "helper_b", "hand_R": "helper_c", "thigh_L": "helper_d"}


def shown(rig: Rig, name: str, clip: Clip, times: Floats) -> Floats:
    return worlds(rig, locals_at(rig, clip, times))[:, rig.find(name)]


def far_apart(one: Rig, other: Rig) -> float:
    """How far nodes of the same names are from where they were, at keys and between them."""
    far = np.abs(one.normalised_world[one.find("head")] - other.normalised_world[other.find("head")]).max()
    for clip, same in zip(one.clips, other.clips, strict=True):
        times = key_times(clip)
        times = np.sort(np.concatenate([times, (times[1:] + times[:-1]) / 2]))
        for name in ("fingers_L", "fingers_R", "head", "toe_L"):
            far = max(far, np.abs(shown(one, name, clip, times) - shown(other, name, same, times)).max())
    return float(far)


@pytest.mark.parametrize("size", [1.0, 2.0])
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_joint_that_is_put_in_and_taken_out_changes_nothing(suffix: str, size: float) -> None:
    rig = rigtri.read(SAMPLES / f"biped{suffix}")
    grown = with_still_joints(rig, ABOVE, size)
    assert far_apart(rig, grown) < 1e-12
    less = rigtri.merge_joints(grown, joints=["helper_*"], keep_children=True)
    assert less.names == rig.names
    assert less.parents.tolist() == rig.parents.tolist()
    for path in ("translation", "rotation", "scale", "matrix"):
        assert np.allclose(getattr(less, path), getattr(rig, path), rtol=0, atol=1e-14)
    for clip, before in zip(less.clips, rig.clips, strict=True):
        for track, was in zip(clip.tracks, before.tracks, strict=True):
            assert np.allclose(track.values, was.values, rtol=0, atol=1e-13)


@pytest.mark.parametrize("suffix", [".glb", pytest.param(".usda", marks=pytest.mark.ci)])
def test_still_joints_of_a_file_go_and_their_children_move_as_before(suffix: str, tmp_path: Path) -> None:
    """Before, a joint that never moves stayed where one that moves was below it."""
    source, out, again = (tmp_path / f"{name}{suffix}" for name in ("in", "out", "again"))
    rig = rigtri.read(SAMPLES / f"biped{suffix}")
    rigtri.write(with_still_joints(rig, ABOVE, 2.0), source, verify=False)
    ran = cli("merge-joints", source, "-o", out, "--still", "--tolerance", "1e-6", code=0)
    assert all(f"{name} into " in ran.output for name in ("helper_a", "helper_b"))
    less = rigtri.read(out)
    assert not {*less.names} & {*ABOVE.values()}
    assert less.names[int(less.parents[less.find("chest")])] == "spine"
    assert far_apart(rig, less) < 2e-6
    cli("merge-joints", out, "-o", again, "--still", code=0)
    assert again.read_bytes() == out.read_bytes()


def test_a_clip_library_loses_the_same_joints_by_their_names(tmp_path: Path) -> None:
    """Its nodes are no joints, and it has no skin."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    bare = replace(with_still_joints(rig, ABOVE), skins=(), attachment=np.full(len(rig) + 4, -1))
    less = rigtri.merge_joints(bare, joints=["helper_*"], keep_children=True)
    assert far_apart(rig, less) < 1e-12


def test_a_usd_animation_without_skeleton_loses_the_same_joints(tmp_path: Path) -> None:
    """Its columns are in another order than its joints; before, nothing could be taken out of it."""
    source, library, out = (tmp_path / f"{name}.usda" for name in ("in", "library", "out"))
    rig = rigtri.read(SAMPLES / "biped.usda")
    rigtri.write(with_still_joints(rig, ABOVE), source, verify=False)
    stage, layer = Usd.Stage.Open(str(source)), Sdf.Layer.CreateNew(str(library))
    (animation,) = (prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Animation))
    Sdf.CopySpec(stage.GetRootLayer(), animation.GetPath(), layer, "/walk")
    layer.Save()
    cli("merge-joints", library, "-o", out, "--joints", "helper_*", "--keep-children", code=0)
    less = rigtri.read(out)
    elbow = less.find("forearm_L")
    track = next(t for t in less.clips[0].tracks if t.node == elbow and t.path == "rotation")
    was = next(t for t in rig.clips[0].tracks if rig.names[t.node] == "forearm_L" and t.path == "rotation")
    assert np.allclose(track.values, was.values, rtol=0, atol=1e-6)


@pytest.mark.ci
def test_clips_of_the_whole_skeleton_come_to_the_one_without_still_joints(tmp_path: Path) -> None:
    rig = with_still_joints(rigtri.read(SAMPLES / "biped.glb"), ABOVE)
    walk = rig.clip("walk")
    elbow = rig.find("forearm_L")
    bent = from_axis_angle(np.array([1.0, 0.0, 0.0]), 0.5)
    tracks = [t for t in walk.tracks if t.node != elbow]
    turn = Track(elbow, "rotation", "LINEAR", np.array([0.0, 1.0]), np.stack([rig.rotation[elbow], bent]))
    edited = replace(rig, clips=(replace(walk, tracks=(*tracks, turn)), *rig.clips[1:]))
    less = rigtri.merge_joints(rig, joints=["helper_*"], keep_children=True)
    source, library = tmp_path / "in.glb", tmp_path / "library.glb"
    rigtri.write(less, source, verify=False)
    rigtri.write(edited, library, verify=False)
    taken = rigtri.take_clips(rigtri.read(source), from_=rigtri.read(library))
    assert far_apart(edited, taken) < 1e-5


def test_splines_of_the_whole_skeleton_come_to_the_one_without_still_joints_as_they_are() -> None:
    """Before, they were sampled at their keys, and refused: between these they moved otherwise."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    walk = rig.clip("walk")
    elbow = rig.find("forearm_L")
    keys = np.zeros((2, 3, 4))
    keys[:, 1] = [rig.rotation[elbow], from_axis_angle(np.array([1.0, 0.0, 0.0]), 0.5)]
    keys[:, 0], keys[:, 2] = [0.3, -0.2, 0.5, 0.1], [-0.4, 0.6, 0.2, 0.3]
    spline = Track(elbow, "rotation", "CUBICSPLINE", np.array([0.0, 1.0]), keys)
    run = replace(walk, name="run", tracks=(*(t for t in walk.tracks if t.node != elbow), spline))
    library = with_still_joints(replace(rig, clips=(run,)), ABOVE)
    report = Report()
    taken = rigtri.take_clips(rig, from_=library, report=report)
    assert far_apart(library, replace(taken, clips=(taken.clip("run"),))) < 1e-6
    assert not {"sampled", "other-parents"} & {notice.code for notice in report.warnings}


def test_what_is_below_a_joint_but_no_joint_is_parented_anew() -> None:
    """The staff; before, its hand could not be merged."""
    rig = rigtri.read(SAMPLES / "biped.glb")
    less = rigtri.merge_joints(rig, joints=["hand_R"])
    staff = less.find("staff")
    assert less.names[int(less.parents[staff])] == "forearm_R"
    there = rig.normalised_world[rig.find("staff")]
    assert np.allclose(less.normalised_world[staff], there, rtol=0, atol=1e-9)
    assert not less.has("fingers_R")


def test_an_empty_below_a_joint_that_goes_alone_stays() -> None:
    """Before, it went, with its keys, though what is below the joint was to stay."""
    rig = with_still_joints(rigtri.read(SAMPLES / "biped.glb"), ABOVE)
    parents = rig.parents.copy()
    parents[rig.find("staff")] = rig.find("helper_c")
    attachment = rig.attachment.copy()
    attachment[rig.find("staff")] = -1
    rig = replace(rig.with_parents(parents), attachment=attachment)
    less = rigtri.merge_joints(rig, joints=["helper_c"], keep_children=True)
    assert less.names[int(less.parents[less.find("staff")])] == "forearm_R"


def test_an_empty_that_moves_stays_where_the_joints_above_it_go() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    attachment, staff = rig.attachment.copy(), rig.find("staff")
    attachment[staff] = -1
    places = rig.translation[[staff]] + [[0.0], [0.25]]
    moved = Track(staff, "translation", "LINEAR", np.array([0.0, 1.0]), places)
    rig = replace(rig, attachment=attachment)
    still = rigtri.merge_joints(rig, joints=["hand_R"])
    assert not still.has("staff")
    walk = rig.clip("walk")
    moving = replace(rig, clips=(replace(walk, tracks=(*walk.tracks, moved)),))
    less = rigtri.merge_joints(moving, joints=["hand_R"])
    assert less.names[int(less.parents[less.find("staff")])] == "forearm_R"
    at_rest = rig.normalised_world[staff]
    assert np.allclose(less.normalised_world[less.find("staff")], at_rest, rtol=0, atol=1e-9)
    kept = [track for track in less.clips[0].tracks if track.node == less.find("staff")]
    assert [len(track.times) for track in kept] == [2]


def test_the_end_of_a_joint_that_goes_alone_stays_only_if_it_moves() -> None:
    rig = with_still_joints(rigtri.read(SAMPLES / "biped.glb"), ABOVE)
    end = rig.find("staff")
    parents, attachment = rig.parents.copy(), rig.attachment.copy()
    parents[end], attachment[end] = rig.find("helper_c"), -1
    names = tuple("helper_c_end" if node == end else name for node, name in enumerate(rig.names))
    rig = replace(rig.with_parents(parents), attachment=attachment, names=names)
    assert not rigtri.merge_joints(rig, joints=["helper_c"], keep_children=True).has("helper_c_end")
    places = rig.translation[[end]] + [[0.0], [0.25]]
    moved = Track(end, "translation", "LINEAR", np.array([0.0, 1.0]), places)
    walk = rig.clip("walk")
    moving = replace(rig, clips=(replace(walk, tracks=(*walk.tracks, moved)),))
    less = rigtri.merge_joints(moving, joints=["helper_c"], keep_children=True)
    times = np.array([0.0, 0.5, 1.0])
    there = shown(moving, "helper_c_end", moving.clips[0], times)
    assert np.allclose(shown(less, "helper_c_end", less.clips[0], times), there, rtol=0, atol=1e-9)


def test_joints_that_never_move_go_before_those_that_do() -> None:
    rig = with_still_joints(rigtri.read(SAMPLES / "biped.glb"), ABOVE)
    count = int(rig.is_joint.sum())
    less = rigtri.merge_joints(rig, max_joints=count - 4)
    assert not {*less.names} & {*ABOVE.values()}
    assert int(less.is_joint.sum()) == count - 4
    assert int(rigtri.merge_joints(rig, max_joints=count - 2).is_joint.sum()) == count - 2
    assert int(rigtri.merge_joints(rig, max_joints=count - 6).is_joint.sum()) == count - 6


def test_what_keeps_a_joint_in_the_middle_is_said() -> None:
    rig = with_still_joints(rigtri.read(SAMPLES / "biped.glb"), {"forearm_L": "helper", "chest": "other"})

    def refused(rig: Rig, joint: str, why: str) -> None:
        with pytest.raises(GeometryError, match=why):
            rigtri.merge_joints(rig, joints=[joint], keep_children=True)

    refused(
        rig, "spine", "'spine' moves in a clip, and 'other' below it stays: name the joints below it, too"
    )
    scale = rig.scale.copy()
    scale[rig.find("helper")] = (1.0, 2.0, 1.0)
    uneven = replace(rig, scale=scale)
    refused(uneven, "helper", "'helper' cannot be merged: it has a scale that is not uniform")
    report = Report()
    less = rigtri.merge_joints(uneven, still=True, report=report)
    assert less.has("helper")
    assert not less.has("other")
    assert report.warnings[0].text.startswith("helper never move")
    driven = rigtri.constrain(rig, type="orient", child="forearm_L", driver="forearm_R")
    refused(driven, "helper", "'forearm_L' below it counts from its parent")
    assert rigtri.merge_joints(driven, still=True).has("helper")
    with pytest.raises(UsageError, match="about joints that"):
        rigtri.merge_joints(rig, still=True, keep_children=True)


@pytest.mark.ci
@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_controls_that_were_built_before_move_joints_as_before(suffix: str, tmp_path: Path) -> None:
    above = {"upper_arm_R": "helper_a", "thigh_L": "helper_b", "fingers_L": "helper_c", "chest": "helper_d"}
    source, built = tmp_path / f"in{suffix}", tmp_path / f"built{suffix}"
    rigtri.write(with_still_joints(rigtri.read(SAMPLES / f"biped{suffix}"), above), source, verify=False)
    rig = rigtri.add_controls(rigtri.read(source), limbs="auto")
    rigtri.write(rigtri.bake(rig, to="controls"), built, verify=False)
    rig = rigtri.read(built)
    less = rigtri.merge_joints(rig, still=True)
    assert not {*less.names} & {*above.values()}
    one, other = (rigtri.bake(each, to="joints", fps=24) for each in (rig, less))
    assert far_apart(one, other) < 2e-5


def test_a_level_of_detail_names_the_joints_that_go(tmp_path: Path) -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    far = rigtri.merge_joints(rig, joints=["fingers_*", "toe_*"])
    report = Report()
    less = rigtri.merge_joints(with_still_joints(rig, ABOVE, 1.0), lod=far, exclude=["toe_L"], report=report)
    assert set(less.names) - set(far.names) == {"toe_L", "toe_L_end"}
    assert {each["joint"] for each in report.joints} >= {*ABOVE.values(), "fingers_L", "fingers_R", "toe_R"}
    rigtri.write(far, tmp_path / "far.glb", tolerance=1)
    words = ["--lod", tmp_path / "far.glb", "--tolerance", "1"]
    cli("merge-joints", SAMPLES / "biped.glb", "-o", tmp_path / "out.glb", *words, code=0)
    assert rigtri.read(tmp_path / "out.glb").names == rigtri.read(tmp_path / "far.glb").names


def test_a_level_of_detail_has_to_be_one_of_the_character() -> None:
    rig = rigtri.read(SAMPLES / "biped.glb")
    other = rigtri.rename_joints(rig, name={name: f"other_{name}" for name in rig.names})
    with pytest.raises(GeometryError, match="lod=: no joint of the two files has the same name"):
        rigtri.merge_joints(rig, lod=other)
    no_elbow = rigtri.rename_joints(rig, name={"forearm_L": "elsewhere"})
    with pytest.raises(
        GeometryError, match=r"'forearm_L' moves in a clip, and 'hand_L' below it stays.*exclude="
    ):
        rigtri.merge_joints(rig, lod=no_elbow)
