"""Keys of a pose reader's weights: as many as they need, one where nothing moves, steps where all is held."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.evaluation.timelines import Timeline, just_before
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.operations.add_posereader.reader_keys import reader_keys, value_tracks


def keys_of(
    weights: Callable[[Floats], Any], way: Any = "LINEAR", *, key: Any = 0, within: float = 0.01
) -> Any:
    """Times and weights of two targets in a clip with keys at 0, 1 and 4; weights: of the first target."""
    track = Track(1, "translation", way, np.array([0.0, 1.0, 4.0]), np.zeros((3, 3)))
    rig = replace(chain((0, 0, 0), (1, 0, 0)), clips=(Clip("walk", (track,), key),))
    timeline = Timeline(rig.clips[0], (0,))

    def read(reader: object, line: object, times: Floats) -> Floats:
        first = np.asarray(weights(times), dtype=np.float64)
        return np.stack([first, np.full(len(times), 0.25)], axis=1)

    motion: Any = SimpleNamespace(rig=rig, affecting=lambda line: line, weights=read)
    reader: Any = None
    return reader_keys(motion, reader, timeline, "reader", within=within, fps=None)


def test_weights_that_stand_still_have_one_key() -> None:
    times, found = keys_of(lambda times: 0.5 + 0.0 * times)
    assert times.tolist() == [0.0]
    assert found.tolist() == [[0.5, 0.25]]


@pytest.mark.parametrize("away", [0, 1, 2])
def test_weights_of_which_one_key_is_another_have_all_of_them(away: int) -> None:
    """Held values, in a format whose clips share their time: each key is a key."""
    at = [0.0, 1.0, 4.0][away]
    times, found = keys_of(lambda times: np.where(times == at, 0.75, 0.5), "STEP", key=("samples", "/a"))
    assert times.tolist() == [0.0, 1.0, 4.0]
    assert found[:, 0].tolist() == [0.75 if k == away else 0.5 for k in range(3)]


def test_held_weights_get_a_key_right_before_each_next_one() -> None:
    times, found = keys_of(lambda times: np.floor(times) / 4.0, "STEP")
    before = just_before(np.array([1.0, 4.0]))
    assert times.tolist() == [0.0, before[0], 1.0, before[1], 4.0]
    assert found[:, 0].tolist() == [0.0, 0.0, 0.25, 0.25, 1.0]
    assert (found[:, 1] == 0.25).all()


def test_weights_on_a_curve_get_as_many_keys_as_keep_them() -> None:
    def curve(times: Floats) -> Floats:
        return np.asarray(np.sin(times))

    times, found = keys_of(curve, within=0.01)
    assert {0.0, 1.0, 4.0} <= set(times.tolist())
    assert 3 < len(times) < 60
    inside = np.linspace(0, 4, 200)
    assert_allclose(np.interp(inside, times, found[:, 0]), np.sin(inside), atol=0.011)
    assert keys_of(lambda times: times / 4.0)[0].tolist() == [0.0, 1.0, 4.0]


def test_weights_are_moves_along_x_of_their_nodes() -> None:
    times = np.array([0.0, 2.0])
    found = np.array([[0.0, 0.5], [1.0, 0.5]])
    moves, still = value_tracks({0: 7, 1: 9}, times, found)
    assert (moves.node, moves.path, moves.interpolation) == (7, "translation", "LINEAR")
    assert moves.values.tolist() == [[0, 0, 0], [1, 0, 0]]
    assert (still.node, still.interpolation, still.times.tolist()) == (9, "STEP", [0.0])
    assert still.values.tolist() == [[0.5, 0, 0]]
    (one,) = value_tracks({0: 7}, times[:1], found[:1])
    assert one.interpolation == "STEP"
