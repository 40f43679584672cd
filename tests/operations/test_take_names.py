"""Which clip of RIG a clip of EDITED is that has another name, or none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from places import SAMPLES
from program import cli
from rigs import chain

from rigtri.errors import GeometryError, UsageError
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.take_clips import TakeClipsOptions, take_clips
from rigtri.report import Report

LONG = 2.0


def playing(**clips: tuple[float, float]) -> Rig:
    """A rig with clips of some lengths, in which a joint goes so far; ``unnamed`` has no name."""
    made = []
    for name, (seconds, far) in clips.items():
        times = np.linspace(0.0, seconds, 49)
        values = np.stack([far * times**2 / seconds**2, np.ones(49), np.zeros(49)], axis=1)
        track = Track(1, "translation", "LINEAR", times, values)
        made.append(Clip("" if name == "unnamed" else name, (track,)))
    return replace(chain((0, 0, 0), (0, 1, 0)), clips=tuple(made))


def taken(rig: Rig, edited: Rig, **names: str) -> tuple[dict[str, float], dict[str, str]]:
    """How far the joint goes in each clip of the result, and the notices."""
    report = Report()
    done = take_clips(rig, options=TakeClipsOptions(from_=edited, as_=names), report=report)
    far = {clip.name: float(clip.tracks[0].values[-1, 0]) for clip in done.clips}
    return far, {notice.code: notice.text for notice in report.warnings}


def test_the_one_clip_that_is_left_on_both_sides_is_the_same_where_lengths_agree() -> None:
    rig = playing(walk=(LONG, 0.1), unnamed=(LONG, 0.2))
    far, notices = taken(rig, playing(walk=(LONG, 0.1), Anim_0=(LONG, 0.7)))
    assert far == {"walk": 0.1, "": 0.7}
    assert "'Anim_0' was taken as '#1'" in notices["clip-paired"]


@pytest.mark.parametrize(
    "edited",
    [playing(walk=(LONG, 0.1), Anim_0=(1.5, 0.7)), playing(Anim_0=(LONG, 0.7))],
    ids=["another length", "two are left"],
)
def test_else_it_is_a_new_one_with_a_warning_that_names_the_way(edited: Rig) -> None:
    far, notices = taken(playing(walk=(LONG, 0.1), unnamed=(LONG, 0.2)), edited)
    assert far == {"walk": 0.1, "": 0.2, "Anim_0": 0.7}
    assert "--as 'Anim_0=CLIP'" in notices["new-clip"]
    assert "'#1'" in notices["new-clip"]


@pytest.mark.parametrize("said", ["#1", ""])
def test_a_clip_can_be_called_by_its_number_or_by_having_no_name(said: str) -> None:
    rig = playing(walk=(LONG, 0.1), unnamed=(LONG, 0.2))
    far, notices = taken(rig, playing(walk=(LONG, 0.1), Anim_0=(1.5, 0.7)), Anim_0=said)
    assert far == {"walk": 0.1, "": 0.7}
    assert list(notices) == ["other-range"]  # it is shorter


def test_a_clip_with_a_name_of_its_own_is_new_whatever_its_length() -> None:
    far, notices = taken(
        playing(walk=(LONG, 0.1), idle=(LONG, 0.2)), playing(walk=(LONG, 0.1), run=(LONG, 0.7))
    )
    assert far == {"walk": 0.1, "idle": 0.2, "run": 0.7}
    assert "EDITED has none for 'idle'." in notices["new-clip"]  # which is not like "run"


def test_a_number_is_also_of_a_clip_with_a_name() -> None:
    far, _ = taken(playing(walk=(LONG, 0.1), run=(LONG, 0.2)), playing(x=(LONG, 0.7)), x="#1")
    assert far == {"walk": 0.1, "run": 0.7}


def test_the_one_clip_of_a_usd_file_is_the_only_one_of_rig_whatever_both_are_called() -> None:
    edited = playing(Anim=(1.5, 0.7))
    edited = replace(edited, clips=(replace(edited.clips[0], key=("samples", "/Anim")),))
    far, notices = taken(playing(walk=(LONG, 0.1)), edited)
    assert far == {"walk": 0.7}
    assert list(notices) == ["other-range"]  # it is shorter


def test_no_name_means_exactly_one_clip() -> None:
    with pytest.raises(UsageError, match="all of RIG's have names"):
        taken(playing(walk=(LONG, 0.1)), playing(x=(LONG, 0.7)), x="")


def test_a_name_that_rig_has_not_is_reported_as_new_with_suggestions() -> None:
    rig = playing(walk=(LONG, 0.1), run=(LONG, 0.2))
    far, notices = taken(rig, playing(walk=(LONG, 0.7)), walk="walkk")
    assert far == {"walk": 0.1, "run": 0.2, "walkk": 0.7}
    assert "RIG has no clip 'walkk'" in notices["new-clip"]
    assert "Did you mean 'walk'?" in notices["new-clip"]


def test_a_new_clip_that_moves_nothing_is_none_and_is_not_called_one() -> None:
    report, rig = Report(), playing()
    still = Track(1, "translation", "LINEAR", np.array([0.0, LONG]), rig.translation[[1, 1]])
    edited = replace(rig, clips=(Clip("walk", (still,)),))
    done = take_clips(rig, options=TakeClipsOptions(from_=edited, as_={"walk": "run"}), report=report)
    assert done is rig
    (notice,) = (notice.text for notice in report.warnings if notice.code == "new-clip")
    assert "RIG has no clip 'run', and it moves nothing in EDITED, so none is written." in notice
    assert [record["new"] for record in report.added] == [False]


def test_a_clip_that_was_declared_new_is_no_warning() -> None:
    far, notices = taken(playing(walk=(LONG, 0.1)), playing(walk=(LONG, 0.1), run=(LONG, 0.7)), run="run")
    assert far == {"walk": 0.1, "run": 0.7}
    assert not notices


@pytest.mark.ci
def test_the_command_takes_both_spellings(tmp_path: Path) -> None:
    biped, out = str(SAMPLES / "biped.glb"), str(tmp_path / "out.glb")
    words = ["take-clips", biped, "--from", biped, "-o", out, "--overwrite"]
    cli(*words, "--as", "walk=#0", code=0)
    done = cli(*words, "--as", "walk=nope")
    assert "RIG has no clip 'nope'" in done.output
    cli(*words, "--as", "walk=", code=2)
    assert "#0" in cli("take-clips", "--help").output


def test_accents_may_be_composed_in_one_file_and_not_in_the_other() -> None:
    rig, edited = (playing(**{name: (LONG, far)}) for name, far in (("gehe\u0301", 0.1), ("geh\u00e9", 0.7)))
    edited = replace(edited, names=("ra\u0301", *edited.names[1:]))
    far, notices = taken(replace(rig, names=("r\u00e1", *rig.names[1:])), edited)
    assert far == {"gehe\u0301": 0.7}
    assert not notices


def test_a_clip_of_no_channels_gets_those_of_edited() -> None:
    rig, edited = playing(walk=(LONG, 0.1)), playing(idle=(LONG, 0.7))
    far, notices = taken(replace(rig, clips=(Clip("idle", ()), *rig.clips)), edited)
    assert far == {"idle": 0.7, "walk": 0.1}
    assert not notices


def test_two_clips_of_one_name_in_edited_are_chosen_or_refused() -> None:
    rig = playing(walk=(LONG, 0.1))
    edited = replace(rig, clips=(*rig.clips, *playing(walk=(LONG, 0.7)).clips))
    with pytest.raises(GeometryError, match="each part of 'walk' \\('walk' \\(#0\\), 'walk' \\(#1\\)"):
        take_clips(rig, from_=edited)
    home = take_clips(rig, from_=edited, clip=["#1"])
    assert home.clips[0].tracks[0].values[-1, 0] == 0.7
    same = replace(rig, clips=(*rig.clips, *playing(walk=(LONG, 0.1)).clips))
    assert take_clips(rig, from_=same) is rig
