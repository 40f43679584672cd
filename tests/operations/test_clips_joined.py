"""Clips that exporters split, merge or name anew are known again: by take-clips, and by bake --rig alike."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from baked_files import keyed_file, rigged_file
from baked_rigs import control, rigged, size
from engines import blender_edit
from places import slow
from program import cli
from rigs import chain
from taken_clips import split

from rigtri.errors import NameNotFoundError
from rigtri.evaluation import sampling
from rigtri.formats import read
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.rejoin_clips import joined
from rigtri.operations.take_clips.take_clips import TakeClipsOptions, take_clips
from rigtri.report import Report

JOINTS = 3


def playing(name: str = "walk", seconds: float = 1.0, far: float = 0.1) -> Clip:
    times = np.linspace(0.0, seconds, 25)
    values = [np.stack([far * (k + 1) * times**2, np.ones(25), 0 * times], axis=1) for k in range(JOINTS)]
    tracks = (Track(k, "translation", "LINEAR", times, values[k]) for k in range(JOINTS))
    return Clip(name, tuple(tracks))


def rig_with(*clips: Clip) -> Rig:
    return replace(chain((0, 0, 0), (0, 1, 0), (0, 2, 0)), clips=clips)


RIG = rig_with(playing(), playing("run", 2.0))


def known(edited: Rig, rig: Rig = RIG, **names: str) -> tuple[dict[str, int], dict[str, str]]:
    """The tracks of each clip after joining, which are those that take-clips finds, and the notices."""
    report = Report()
    done = joined(edited, rig, names=names, report=report)
    notices = {notice.code: notice.text for notice in report.warnings}
    taken = Report()
    take_clips(rig, options=TakeClipsOptions(from_=edited, as_=names), report=taken)
    assert {clip.name for clip in done.clips} == {entry["clip"] for entry in taken.added}
    for code in ("split-clip", "clip-paired"):
        assert notices.get(code) == next((n.text for n in taken.warnings if n.code == code), None)
    return {clip.name: len(clip.tracks) for clip in done.clips}, notices


@pytest.mark.parametrize("pattern", ["walk_{}", "{}|walk", "{}Action", "{}Action.001", "{}.001Action", "{}"])
def test_parts_named_after_objects_are_the_clip_of_the_same_times(pattern: str) -> None:
    assert known(split(rig_with(playing()), "walk", pattern.format)) == ({"walk": JOINTS}, {})


def test_what_was_merged_is_the_one_clip_of_its_times() -> None:
    found, notices = known(rig_with(playing("Animation")))
    assert found == {"walk": JOINTS}
    assert "the only one with its times" in notices["clip-paired"]
    assert known(rig_with(playing("Animation")), Animation="Animation")[0] == {"Animation": JOINTS}


def test_parts_that_fit_no_clip_but_each_other_are_one_and_the_user_may_choose_which() -> None:
    edited = split(rig_with(playing(seconds=10.0)), "walk", "{}".format)
    first = edited.clips[0].name
    found, notices = known(edited)
    assert found == {first: JOINTS}
    assert f"--as '{first}=CLIP'" in notices["split-clip"]
    assert known(edited, **{first: "run"})[0] == {"run": JOINTS}
    assert known(edited, **{"*": "#1"})[0] == {"run": JOINTS}


def test_a_part_of_no_length_goes_with_the_others() -> None:
    walk = playing()
    still = tuple(replace(t, times=t.times[:1], values=t.values[:1]) for t in walk.tracks[2:])
    edited = split(rig_with(replace(walk, tracks=(*walk.tracks[:2], *still))), "walk", "{}Action".format)
    assert known(edited) == ({"walk": JOINTS}, {})


def as_usd(rig: Rig) -> Rig:
    """The rig with the clips of a USD file, which play together."""
    clips = (replace(clip, key=("samples", f"/{clip.name}")) for clip in rig.clips)
    return replace(rig, clips=tuple(clips), rules=replace(rig.rules, raw_quaternions=True))


def in_parts(name: str) -> Rig:
    """What Blender exports as glTF: the joints in one clip, another object in one called after that."""
    whole = playing(name)
    part = f"{rig_with().names[2]}Action"
    return rig_with(replace(whole, tracks=whole.tracks[:2]), Clip(part, whole.tracks[2:]))


@pytest.mark.parametrize(
    ("name", "names"),
    [("walk", {}), ("walk.001", {}), ("stroll", {}), ("stroll", {"*": "walk"})],
    ids=["same", "copy", "other", "as"],
)
def test_parts_of_the_one_clip_of_a_usd_rig_are_joined_as_those_of_a_gltf_rig(
    name: str, names: dict[str, str]
) -> None:
    """Its name means nothing, so the one clip that is not called after what it moves is it, too."""
    rig = as_usd(rig_with(playing()))
    assert known(in_parts(name), rig, **names) == ({"walk": JOINTS}, {})


def test_parts_of_the_one_clip_of_a_usd_rig_that_drive_the_same_are_reported() -> None:
    rig, report = as_usd(rig_with(playing())), Report()
    edited = rig_with(playing(), playing("walk.001", far=0.5))
    assert joined(edited, rig, report=report) is edited
    assert [notice.code for notice in report.warnings] == ["two-parts"]


def test_the_only_clip_beside_a_usd_rig_keeps_its_name_unless_the_user_gives_one() -> None:
    rig, edited = as_usd(rig_with(playing())), rig_with(playing("stroll"))
    assert joined(edited, rig) is edited
    (clip,) = joined(edited, rig, names={"stroll": "walk"}).clips
    assert clip.name == "walk"


def test_clips_that_drive_the_same_are_no_parts_of_one_when_joined() -> None:
    edited, report = rig_with(playing(), playing("walk.001", far=0.5)), Report()
    assert joined(edited, RIG, report=report) is edited
    assert [notice.code for notice in report.warnings] == ["two-parts"]


def test_an_unedited_clip_that_came_back_a_frame_late_has_not_changed() -> None:
    """Blender's Animation Mode "NLA Tracks" begins at frame 1."""
    clip = playing()
    late = tuple(replace(track, times=track.times + 1 / 24) for track in clip.tracks)
    assert take_clips(RIG, from_=rig_with(replace(clip, tracks=late))) is RIG
    moved = replace(late[1], values=late[1].values + np.array([0.0, 0.5, 0.0]))
    home = take_clips(RIG, from_=rig_with(replace(clip, tracks=(late[0], moved, late[2]))))
    now = home.clips[0].tracks[1]
    assert now.times[[0, -1]] == pytest.approx([0.0, 1.0])
    assert now.values[0, 1] == pytest.approx(1.5)


@pytest.mark.parametrize("pattern", ["walk", "{}Action"])
def test_a_clip_that_came_a_frame_late_is_joined_where_it_was(pattern: str) -> None:
    clip, report = playing(), Report()
    late = [replace(track, times=(track.times + 1 / 24).astype(np.float32)) for track in clip.tracks]
    moved = replace(late[1], values=late[1].values + np.array([0.0, 0.5, 0.0]))
    edited = rig_with(replace(clip, tracks=(late[0], moved, late[2])), playing("other"))
    if pattern != "walk":
        edited = split(replace(edited, clips=edited.clips[:1]), "walk", pattern.format)
    (now, *others) = joined(edited, RIG, report=report).clips
    assert now.name == "walk"
    for track, was in zip(now.tracks, clip.tracks, strict=True):
        np.testing.assert_allclose(track.times, was.times, atol=1e-7)
    assert now.tracks[1].values is moved.values
    assert all(other is edited.clips[1] for other in others)
    (entry,) = (entry for entry in report.added if entry["type"] == "moved")
    assert (entry["clip"], entry["by"]) == ("walk", pytest.approx(-1 / 24))


def test_a_clip_that_was_made_anew_stays_where_it_is() -> None:
    clip = playing(far=0.7)
    late = tuple(replace(track, times=track.times + 1 / 24) for track in clip.tracks)
    edited = rig_with(replace(clip, tracks=late))
    assert joined(edited, RIG) is edited


def test_keys_between_frames_that_an_exporter_lost_are_restored_or_reported_by_what_joints_miss() -> None:
    """A chest that nods by 0.2 rad within a frame: the chord of that, for the farthest that it carries."""
    rig = rigged()
    head, chest = control(rig, "head", "fk"), control(rig, "chest", "fk")

    def turning(frames: bool, far: float) -> Rig:
        times = np.arange(25) / 24 if frames else np.unique([*(np.arange(25) / 24), 0.5 / 24])
        turns = np.zeros((len(times), 4))
        turns[:, 3] = 1.0
        if not frames:
            turns[1] = [np.sin(0.1), 0.0, 0.0, np.cos(0.1)]
        other = np.tile([np.sin(far), 0.0, 0.0, np.cos(far)], (len(times), 1))
        tracks = (
            Track(chest, "rotation", "LINEAR", times, turns),
            Track(head, "rotation", "LINEAR", times, other),
        )
        return replace(rig, clips=(Clip("walk", tracks),))

    # In the axes and the unit that controls had, RIG's keys are there again; what was edited is EDITED's.
    report, home = Report(), turning(False, 0.1).clips[0]
    (clip,) = joined(turning(True, 0.3), turning(False, 0.1), report=report).clips
    assert not report.warnings
    for now, was in zip(clip.tracks, (home.tracks[0], turning(True, 0.3).clips[0].tracks[1]), strict=True):
        assert np.array_equal(now.times, was.times)
        assert np.array_equal(now.values, was.values)

    # Where something that RIG lacks moves above the control, no key of the one is a key of the other.
    report = Report()
    joined(carried(turning(True, 0.3), chest), turning(False, 0.1), report=report)
    (notice,) = report.warnings
    assert notice.code == "keys-lost"
    assert f"'{rig.title(chest)}', which nobody has edited" in notice.text
    assert "take-clips RIG --from IN" in notice.text
    said = float(re.search(r"off by ([\d.e-]+)", notice.text)[1])  # type: ignore[index]
    below = [n for n in np.flatnonzero(rig.is_joint) if rig.is_below(int(n), rig.find("chest"))]
    places = rig.world[below, 3, :3] - rig.world[rig.find("chest"), 3, :3]
    far = 2 * np.sin(0.1) * np.linalg.norm(np.cross(places, rig.world[chest, 0, :3]), axis=1).max()
    assert said == pytest.approx(far / size(rig), rel=0.05)
    # Less than what bake leaves between samples is not told, nor what nobody has lost.
    for most, edited in ((1.0, turning(True, 0.1)), (0.0, turning(False, 0.1))):
        report = Report()
        joined(carried(edited, chest), turning(False, 0.1), between=most, report=report)
        assert not report.warnings


def carried(rig: Rig, node: int) -> Rig:
    """The rig with another name for the node above one, and keys that hold that node where it is."""
    above = int(rig.parents[node])
    times = rig.clips[0].tracks[0].times
    held = Track(above, "rotation", "LINEAR", times, np.tile(rig.rotation[above], (len(times), 1)))
    names = (*rig.names[:above], "carrier", *rig.names[above + 1 :])
    return replace(rig, names=names, clips=(replace(rig.clips[0], tracks=(*rig.clips[0].tracks, held)),))


def test_keys_between_frames_come_back_in_another_unit_and_of_joints_and_morphs_too() -> None:
    """A frame rate of 24 where the artist had 30: what nobody has edited plays as it did."""
    start = rigged()
    thirty, frames = np.arange(31) / 30, np.arange(25) / 24
    hips, chest = start.find("hips"), control(start, "chest", "fk")
    assert hips >= 0
    swing = np.stack([0.3 * np.sin(20 * thirty), 1.0 + 0 * thirty, 0.1 * thirty], axis=1)
    turns = np.stack([np.sin(thirty), 0 * thirty, 0 * thirty, np.cos(thirty)], axis=1)
    tracks = (
        Track(hips, "translation", "LINEAR", thirty, swing),
        Track(chest, "rotation", "LINEAR", thirty, turns),
        Track(hips, "weights", "LINEAR", thirty, 0.5 + swing[:, :2]),
    )
    home = replace(start, clips=(Clip("walk", tracks),))
    seen = tuple(replace(t, times=frames, values=sampling.sample(t, frames)) for t in tracks)
    larger = replace(seen[0], values=100.0 * seen[0].values)
    there = replace(start, clips=(Clip("walk", (larger, *seen[1:])),))
    (clip,) = joined(in_centimetres(there), home, report=(report := Report())).clips
    assert not report.warnings
    for now, was, unit in zip(clip.tracks, tracks, (100.0, 1.0, 1.0), strict=True):
        assert np.array_equal(now.times, was.times)
        np.testing.assert_allclose(now.values, unit * was.values, rtol=1e-12)


def in_centimetres(rig: Rig) -> Rig:
    """The same rig as a DCC exports it that counts in another unit, without its clips' keys."""
    skins = []
    for skin in rig.skins:
        binds = skin.inverse_bind.copy()
        binds[:, 3, :3] *= 100.0
        skins.append(replace(skin, inverse_bind=binds))
    matrix = rig.matrix.copy()
    matrix[:, 3, :3] *= 100.0
    return replace(rig, translation=rig.translation * 100.0, matrix=matrix, skins=tuple(skins))


@pytest.mark.parametrize("said", ["#2", "#9"])
def test_a_number_that_no_clip_has_is_an_error(said: str) -> None:
    with pytest.raises(NameNotFoundError, match=f"'{said}'.*'#0', 'walk', '#1', 'run'"):
        take_clips(RIG, options=TakeClipsOptions(from_=RIG, as_={"walk": said}))
    with pytest.raises(NameNotFoundError, match=f"'{said}'"):
        take_clips(RIG, options=TakeClipsOptions(from_=RIG, clip=(said,)))
    with pytest.raises(NameNotFoundError):
        take_clips(RIG, options=TakeClipsOptions(from_=RIG, as_={said: "walk"}))


def test_numbers_choose_clips_of_edited() -> None:
    edited = rig_with(playing(far=0.5), playing("run", 2.0, 0.5))
    assert take_clips(RIG, options=TakeClipsOptions(from_=edited, clip=("#1",))).clips[0] is RIG.clips[0]
    home = take_clips(RIG, options=TakeClipsOptions(from_=edited, as_={"#0": "new"}))
    assert [clip.name for clip in home.clips] == ["walk", "run", "new"]


@pytest.mark.parametrize(
    "words",
    [
        ["bake", "IN", "--clip", "#9"],
        slow(["pose", "IN", "--at", "#9@0"]),
        slow(["snap", "IN", "--limbs", "auto", "--to", "fk", "--at", "#9@0"]),
        slow(["take-clips", "IN", "--from", "IN", "--clip", "#9"]),
        ["take-clips", "IN", "--from", "IN", "--as", "walk=#9"],
        slow(["bake", "IN", "--rig", "IN", "--as", "walk=#9"]),
    ],
    ids=lambda words: f"{words[0]} {words[-2]}",
)
def test_every_command_refuses_it(words: list[str], up: Path, tmp_path: Path) -> None:
    given = [str(up) if word == "IN" else word for word in words]
    done = cli(*given, "-o", tmp_path / "out.glb")
    assert (done.exit_code, "'#9'" in done.output) == (4, True), done.output


def test_as_without_a_rig_reports_what_is_missing(up: Path, tmp_path: Path) -> None:
    done = cli("bake", up, "-o", tmp_path / "o.glb", "--as", "walk=run", code=2)
    assert "--rig" in done.output


@pytest.fixture(scope="module")
def up(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The biped with its motion on its controls."""
    folder = tmp_path_factory.mktemp("joined")
    rig, up = folder / "rig.glb", folder / "up.glb"
    rigged_file("biped.glb", rig)
    keyed_file("biped.glb", up)
    return up


@pytest.mark.slow
def test_modes_of_blenders_exporter_bake_to_the_same_motion(up: Path, tmp_path: Path) -> None:
    """Whatever the exporter calls it and into however many clips it splits it."""
    modes = ["ACTIONS", "split", "ACTIVE_ACTIONS", "NLA_TRACKS", "SCENE"]
    files = {mode: tmp_path / f"{mode}.glb" for mode in modes}
    job = {"source": str(up), "clip": "walk", "moves": {}, "keys": []}
    jobs = [job | {"mode": mode, "target": str(file)} for mode, file in files.items()]
    blender_edit(*jobs, folder=tmp_path)
    rig, places = read(up).rig, {}
    for mode, file in files.items():
        said = ["--as", "biped=walk"] if mode == "SCENE" else []
        out = tmp_path / f"baked-{mode}.glb"
        done = cli("bake", file, "-o", out, "--to", "joints", "--rig", up, "--clip", "walk", *said, code=0)
        assert ("matched with 'walk'" in done.output) == (mode in ("split", "ACTIVE_ACTIONS", "SCENE"))
        names = {"biped": "walk"} if said else {}
        if mode != "SCENE":  # it has the scene's frames, from the second on
            assert take_clips(rig, from_=read(file).rig, as_=names) is rig
        baked = read(out).rig
        # RIG's keys, which come home; between them baked IK is elsewhere than the key that SCENE begins with.
        times = sampling.key_times(rig.clip("walk"))
        times = times[times > 1 / 24]
        moved = sampling.worlds(baked, sampling.locals_at(baked, baked.clip("walk"), times))
        places[mode] = moved[:, [baked.find(rig.names[n]) for n in np.flatnonzero(rig.is_joint)], 3, :3]
    size = np.linalg.norm(np.ptp(rig.world[rig.is_joint, 3, :3], axis=0))
    for mode in modes[1:]:
        apart = np.linalg.norm(places[mode] - places["ACTIONS"], axis=-1).max() / size
        assert apart < 1e-5, (mode, apart)
