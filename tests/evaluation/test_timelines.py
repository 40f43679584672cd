"""New tracks in a timeline: each takes the place of the one that drove the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from builders.rigs import random_rig

from rigtri.errors import UsageError
from rigtri.evaluation.timelines import put_tracks, timeline_and_time, timelines
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig

TIMES = np.array([0.0, 1.0])


def moved(node: int, along: float) -> Track:
    return Track(node, "translation", "LINEAR", TIMES, np.array([[0.0, 0.0, 0.0], [along, 0.0, 0.0]]))


def played(rig: Rig) -> list[tuple[int, float]]:
    return [(track.node, float(track.values[1, 0])) for track in rig.clips[0].tracks]


def test_tracks_put_at_once_are_as_if_put_one_by_one() -> None:
    was = replace(moved(1, 1.0), key=(0, 7))
    rig = replace(random_rig(1), clips=(Clip("walk", (was, moved(2, 2.0)), key=0),))
    tracks = [moved(3, 3.0), moved(1, 4.0), moved(3, 5.0), moved(2, 2.0)]
    (timeline,) = timelines(rig)
    together = put_tracks(rig, timeline, tracks)
    one_by_one = rig
    for track in tracks:
        one_by_one = put_tracks(one_by_one, timelines(one_by_one)[0], [track])
    assert played(together) == played(one_by_one) == [(1, 4.0), (2, 2.0), (3, 5.0)]
    assert together.clips[0].tracks[0].key == (0, 7)
    assert together.clips[0].tracks[1] is rig.clips[0].tracks[1]


def test_tracks_that_are_there_already_leave_the_rig_itself() -> None:
    rig = replace(random_rig(1), clips=(Clip("walk", (moved(1, 1.0),), key=0),))
    (timeline,) = timelines(rig)
    assert put_tracks(rig, timeline, [moved(1, 1.0)]) is rig
    assert timeline.track(1, "translation") is rig.clips[0].tracks[0]
    assert timeline.track(1, "rotation") is None


@pytest.mark.parametrize(
    ("text", "example"), [("walk@default", "walk@default@0, or rest"), ("walk", "walk@0.5, or rest")]
)
def test_a_clip_without_a_time_is_told_how_to_name_one(text: str, example: str) -> None:
    """Values of a USD animation without time are a clip with an @ in its name."""
    rig = replace(random_rig(1), clips=(Clip("walk@default", (moved(1, 1.0),), key=0),))
    with pytest.raises(UsageError, match=example):
        timeline_and_time(rig, text)
    assert timeline_and_time(rig, "walk@default@0.25")[1] == 0.25
