from __future__ import annotations

import numpy as np
import pytest

from rigtri.model.animation import Clip, Interpolation, Track, Tracks, columns, off_rest

TIMES = np.array([0.0, 1.0])
TURN = Track(0, "rotation", "LINEAR", TIMES, np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)))
BULGE = Track(1, "weights", "LINEAR", TIMES, np.zeros((2, 1)))


def test_an_idle_clip_plays_its_weights_alone() -> None:
    clip = Clip("walk", (TURN, BULGE))
    assert clip.without_idle is clip
    played = Clip("walk", (TURN, BULGE), idle=True).without_idle
    assert played.tracks == (BULGE,)
    assert not played.idle


def test_columns_give_back_the_tracks_they_were_made_of() -> None:
    later = Track(2, "rotation", "LINEAR", TIMES.copy(), TURN.values * 2, key=7)
    tracks = (TURN, BULGE, later)
    turns, weights = columns(tracks)
    assert (turns.nodes.tolist(), weights.nodes.tolist()) == ([0, 2], [1])
    assert turns.values.tolist() == [TURN.values.tolist(), later.values.tolist()]
    assert tuple(Tracks((weights, turns))) == tracks


def test_a_column_on_other_nodes_leaves_out_those_without_a_place() -> None:
    (column,) = columns((TURN, Track(2, "rotation", "LINEAR", TIMES, TURN.values * 2, key=7)))
    (track,) = Tracks(filter(None, (column.moved(np.array([-1, -1, 5])), column.moved(np.full(3, -1)))))
    assert (track.node, track.key, track.values.tolist()) == (5, 7, (TURN.values * 2).tolist())


def test_a_changed_column_keeps_the_tracks_that_did_not_change() -> None:
    other = Track(2, "rotation", "LINEAR", TIMES, TURN.values * 2)
    (column,) = columns((TURN, other))
    kept, new = Tracks([column.having(-column.values, np.array([False, True]))])
    assert kept is TURN
    assert new.values.tolist() == (-other.values).tolist()


@pytest.mark.parametrize(
    ("interpolation", "values", "off"),
    [
        ("LINEAR", [[1.0, 2.0, 3.0], [1.0, 2.5, 3.0]], 0.5),
        ("STEP", [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]], 0.0),
        # Both keys rest: the tangent of 27 leads away over 2 seconds, and those outside nowhere.
        ("CUBICSPLINE", [[[0, 0, 3], [1, 2, 3], [0, 27, 0]], [[0, 0, 0], [1, 2, 3], [0, 0, 9]]], 8.0),
    ],
)
def test_how_far_a_track_comes_from_rest(
    interpolation: Interpolation, values: list[object], off: float
) -> None:
    track = Track(0, "translation", interpolation, 2 * TIMES, np.array(values, dtype=float))
    assert off_rest(track, np.array([1.0, 2.0, 3.0])) == pytest.approx(off)


def test_a_rotation_of_the_other_sign_rests() -> None:
    assert off_rest(Track(0, "rotation", "LINEAR", TIMES, TURN.values * [[1], [-1]]), TURN.values[0]) == 0.0


def test_the_weights_of_a_clip_are_by_node_and_the_first_of_each() -> None:
    """A crowd has as many as characters: looked through for each mesh, they would take its square."""
    one = np.zeros((1, 1))
    tracks = [
        Track(3, "translation", "LINEAR", np.zeros(1), np.zeros((1, 3))),
        *(Track(node, "weights", "LINEAR", np.zeros(1), one) for node in (3, 1, 3)),
    ]
    clip = Clip("walk", tuple(tracks))
    assert clip.weights == {3: tracks[1], 1: tracks[2]}
    assert clip.weights is clip.weights
