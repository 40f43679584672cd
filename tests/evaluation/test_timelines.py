"""New tracks in a timeline: each takes the place of the one that drove the same."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from builders.rigs import chain, random_rig

from rigtri.errors import GeometryError, NameNotFoundError, UsageError
from rigtri.evaluation.timelines import (
    MOST_KEYS,
    Timeline,
    chosen_timelines,
    jumps,
    just_before,
    keys_and_between,
    matching_clips,
    merged_weights,
    put_tracks,
    steps_only,
    timeline_and_time,
    timelines,
    times_and_jumps,
    times_within,
    without_steps,
)
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


def keyed(*times: float, way: Any = "LINEAR", values: Any = None) -> Track:
    rows = np.zeros((len(times), 3)) if values is None else np.array(values, dtype=np.float64)
    return Track(0, "translation", way, np.array(times), rows)


def timeline(*tracks: Track) -> Timeline:
    return Timeline(Clip("walk", tracks), (0,))


BEFORE_1 = float(np.nextafter(np.float32(1.0), np.float32(-1.0)))
BEFORE_2 = float(np.nextafter(np.float32(2.0), np.float32(-1.0)))


@pytest.mark.parametrize(
    ("tracks", "fps", "per_second", "times"),
    [
        ([keyed(0.0, 1.0), keyed(0.5, 1.0)], None, 1.0, [0.0, 0.5, 1.0]),
        ([keyed(0.0, 1.0), keyed(7.0)], None, 1.0, [0.0, 1.0]),  # one key is held at all times
        ([keyed(0.0, 1.0), keyed(0.25), keyed(0.0)], None, 1.0, [0.0, 0.25, 1.0]),  # and is a key
        ([keyed(7.0), keyed(3.0)], None, 1.0, [3.0]),
        ([], None, 1.0, [0.0]),
        ([keyed(0.0, np.inf, 2.0)], None, 1.0, [0.0, 2.0]),
        ([keyed(0.0, 1.0)], 4.0, 1.0, [0.0, 0.25, 0.5, 0.75, 1.0]),
        ([keyed(1.0, 1.3)], 4.0, 1.0, [1.0, 1.25, 1.3]),
        ([keyed(0.0, 24.0)], 2.0, 24.0, [0.0, 12.0, 24.0]),
    ],
)
def test_times_to_start_from_are_all_keys_and_so_many_a_second(
    tracks: list[Track], fps: float | None, per_second: float, times: list[float]
) -> None:
    assert times_within(timeline(*tracks), fps, per_second).tolist() == times


def test_more_times_than_anybody_wants_are_refused() -> None:
    with pytest.raises(
        UsageError, match=f"that would be 2e\\+06 keys in clip 'walk', and {MOST_KEYS} are the most"
    ):
        times_within(timeline(keyed(0.0, 200.0)), 10_000.0)
    assert len(times_within(timeline(keyed(0.0, 200.0)), 10.0)) == 2001


def test_frames_of_a_clip_without_length_in_seconds_are_refused() -> None:
    """As of a stage with 0 time codes per second. Before, a traceback."""
    clip = timeline(keyed(0.0, 5.0))
    with pytest.raises(UsageError, match="--fps 10: the file has 0 time codes per second, so clip 'walk'"):
        times_within(clip, 10.0, 0.0)
    assert times_within(clip, None, 0.0).tolist() == [0.0, 5.0]


@pytest.mark.parametrize(
    ("tracks", "times"),
    [
        ([keyed(0.0, 2.0), keyed(0.0, 1.0, 2.0, way="STEP")], [0.0, BEFORE_1, 1.0, BEFORE_2, 2.0]),
        ([keyed(0.0, 1.0, way="STEP")], [0.0, 1.0]),  # nothing moves between
        ([keyed(0.0, 2.0)], [0.0, 2.0]),
        ([keyed(1.0, 3.0), keyed(0.5, 1.0, way="STEP")], [0.5, BEFORE_1, 1.0, 3.0]),
    ],
)
def test_the_last_times_before_jumps_are_looked_at_where_something_moves_between(
    tracks: list[Track], times: list[float]
) -> None:
    assert times_and_jumps(timeline(*tracks), None).tolist() == times


def test_jumps_are_those_of_tracks_that_hold_their_values() -> None:
    held = timeline(keyed(0.0, 2.0), keyed(0.0, 1.0, 3.0, way="STEP"), keyed(0.5, 1.0, way="STEP"))
    assert jumps(held).tolist() == [1.0, 3.0]
    assert not steps_only(held)
    assert steps_only(timeline(keyed(0.0, 1.0, way="STEP"), keyed(4.0)))
    assert just_before(np.array([1.0, 2.0])).tolist() == [BEFORE_1, BEFORE_2]


def test_two_places_between_keys_are_looked_at_but_for_jumps() -> None:
    found = keys_and_between(np.array([0.0, 1.0]))
    assert found.tolist() == [0.0, float(np.float32(0.29)), 0.5, 1.0]
    assert keys_and_between(np.array([BEFORE_1, 1.0])).tolist() == [BEFORE_1, 1.0]


def test_held_values_become_keys_right_before_their_jumps() -> None:
    held = keyed(0.0, 1.0, 2.0, way="STEP", values=[[1, 0, 0], [1, 0, 0], [5, 0, 0]])
    line = without_steps(held)
    assert line.interpolation == "LINEAR"
    assert line.times.tolist() == [0.0, 1.0, BEFORE_2, 2.0]
    assert line.values[:, 0].tolist() == [1, 1, 1, 5]
    assert without_steps(keyed(0.0, 1.0)).times.tolist() == [0.0, 1.0]
    one = keyed(0.0, way="STEP")
    assert without_steps(one) is one


def test_some_columns_of_weights_are_replaced_and_the_others_stay() -> None:
    was = Track(0, "weights", "LINEAR", np.array([0.0, 2.0]), np.array([[0.0, 5.0], [2.0, 9.0]]))
    found = merged_weights(was, np.array([1.0, 2.0]), [1], np.array([[1.0], [3.0]]))
    assert found.times.tolist() == [0.0, 1.0, 2.0]
    assert found.values.tolist() == [[0.0, 1.0], [1.0, 1.0], [2.0, 3.0]]
    single = Track(0, "weights", "STEP", np.array([7.0]), np.array([[4.0, 5.0]]))
    found = merged_weights(single, np.array([1.0]), [0], np.array([[2.0]]))
    assert (found.times.tolist(), found.values.tolist(), found.interpolation) == ([1.0], [[2.0, 5.0]], "STEP")
    spline = Track(0, "weights", "CUBICSPLINE", np.array([0.0, 1.0]), np.zeros((2, 3, 2)))
    with pytest.raises(ValueError, match="splines"):
        merged_weights(spline, np.array([0.0]), [0], np.zeros((1, 1)))


def clips(*names: str) -> Rig:
    tracks = (moved(1, 1.0),)
    made = tuple(Clip(name, () if name == "empty" else tracks, key=k) for k, name in enumerate(names))
    return replace(chain((0, 0, 0), (1, 0, 0)), clips=made)


@pytest.mark.parametrize(
    ("pattern", "found"),
    [
        ("walk", {0}),
        ("walk*", {0, 1, 3}),
        ("#1", {1}),
        ("w[a]lk", {4}),  # a clip's own name is no glob
        ("[w]alk", {0}),
        ("Walk", set()),
        ("#9", set()),
    ],
)
def test_a_glob_matches_clips_by_name_or_number(pattern: str, found: set[int]) -> None:
    assert matching_clips(clips("walk", "walk2", "run", "walker", "w[a]lk"), pattern) == found


def test_timelines_are_chosen_in_the_order_of_their_globs_and_once_each() -> None:
    rig = clips("walk", "run", "walker", "empty")
    names = [each.name for each in chosen_timelines(rig, ["run", "walk*", "#0"])]
    assert names == ["run", "walk", "walker"]
    assert [each.name for each in chosen_timelines(rig, [])] == ["walk", "run", "walker"]
    with pytest.raises(NameNotFoundError, match="ru"):
        chosen_timelines(rig, ["run", "ru"])


def test_a_time_that_is_printed_as_that_of_a_key_names_the_key() -> None:
    third, end = float(np.float32(13 / 24)), float(np.float32(25 / 24))
    rig = replace(random_rig(1), clips=(Clip("walk", (keyed(0.0, third), keyed(end)), key=0),))
    times = {
        text: timeline_and_time(rig, f"walk@{text}")[1] for text in ("0.541667", "1.04167", "0.5417", "9")
    }
    assert times == {"0.541667": third, "1.04167": end, "0.5417": 0.5417, "9": 9.0}


def test_a_clip_and_a_time_are_split_at_the_last_mark() -> None:
    rig = clips("walk", "me@home", "empty")
    found, at = timeline_and_time(rig, "me@home@0.5")
    assert found is not None
    assert (found.name, at) == ("me@home", 0.5)
    assert timeline_and_time(rig, "Rest") == (None, 0.0)
    for text in ("walk", "walk@", "walk@nan", "walk@x"):
        with pytest.raises(UsageError, match=f"'{text}' is not a valid pose: use CLIP@TIME in seconds"):
            timeline_and_time(rig, text)
    codes = replace(rig, rules=replace(rig.rules, per_second=24.0))
    with pytest.raises(UsageError, match="in time codes, 24 a second, "):
        timeline_and_time(codes, "walk")
    with pytest.raises(GeometryError, match="Clip 'empty' has no keys"):
        timeline_and_time(rig, "empty@0")


def test_animations_of_instances_play_one_at_a_time_each_with_all_else() -> None:
    """In a stage two clips move one node where instances of a character play one each."""
    rig = random_rig(1)
    keys = (("samples", "/Walk"), ("samples", "/Run"), ("default", "/Walk"), ("samples", "/Other"))
    nodes = (0, 0, 0, 1)
    made = tuple(
        Clip(key[1], (moved(node, 1.0 + k),), key)
        for k, (key, node) in enumerate(zip(keys, nodes, strict=True))
    )
    walk, run = timelines(replace(rig, clips=made))
    assert (walk.name, walk.members, run.name, run.members) == ("/Walk", (0, 2, 3), "/Run", (1, 3))
    for each, along in ((walk, 1.0), (run, 2.0)):
        found = each.track(0, "translation")
        assert found is not None
        assert found.values[1, 0] == along
