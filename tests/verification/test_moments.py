"""The times at which two clips are compared: all keys and two places between, of very many the widest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.evaluation import rotations_between_keys, sampling
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.verification.compare import deviation


def moments(*tracks: Track) -> Any:
    return np.sort(np.concatenate(deviation._moments(Clip("c", tracks))))


def line(times: Any, values: Any, path: Any = "translation", way: Any = "LINEAR") -> Track:
    return Track(0, path, way, np.array(times, dtype=np.float64), np.array(values, dtype=np.float64))


def along(x: Any) -> Any:
    return np.stack([np.array(x, dtype=np.float64), np.zeros(len(x)), np.zeros(len(x))], axis=1)


@pytest.fixture(autouse=True)
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(deviation, "_MANY_KEYS", 5)
    monkeypatch.setattr(deviation, "_GAPS", 2)


TIMES = np.arange(8.0)


def test_of_a_few_keys_all_gaps_are_looked_at() -> None:
    found = moments(line(TIMES[:3], along([0, 1, 2])))
    assert {0.29, 0.5, 1.29, 1.5} <= set(np.round(found, 6).tolist())


def test_of_many_keys_the_widest_gaps_tell() -> None:
    found = moments(line(TIMES, along([0, 1, 2, 9, 10, 11, 31, 32])))
    inside = [time for time in found.tolist() if 0 < time < 7 and time % 1]
    assert_allclose(inside, [2.29, 2.5, 5.29, 5.5])
    assert set(TIMES.tolist()) <= set(found.tolist())
    assert found[0] < 0
    assert found[-1] > 7


def test_at_keys_that_all_tracks_have_nothing_is_interpolated(monkeypatch: pytest.MonkeyPatch) -> None:
    turns = from_axis_angle(np.array([0.0, 0, 1]), 0.1 * TIMES**2)
    one = Track(0, "scale", "LINEAR", np.zeros(1), np.full((1, 3), 2.0))
    clip = Clip("c", (line(TIMES, along(TIMES)), line(TIMES, turns, "rotation"), one))
    rig = chain((0, 0, 0))
    keys, others = deviation._moments(clip)
    assert_allclose(keys, TIMES)
    assert not set(keys.tolist()) & set(others.tolist())
    before = sampling.locals_at(rig, clip, keys)
    monkeypatch.setattr(rotations_between_keys, "slerp_rows", None)
    assert_allclose(sampling.locals_at(rig, deviation._stepped(clip), keys), before, atol=1e-15)


def test_all_right_angles_of_rotations_are_looked_at() -> None:
    degrees = np.array([0.0, 100, 200, 205, 210, 310, 320, 420])
    turns = from_axis_angle(np.array([0.0, 0, 1]), np.radians(degrees))
    found = moments(line(TIMES, turns, "rotation"))
    inside = [time for time in found.tolist() if 0 < time < 7 and time % 1]
    assert_allclose(inside, [0.29, 0.5, 1.29, 1.5, 4.29, 4.5, 6.29, 6.5])


@pytest.mark.parametrize(
    "other",
    [line(TIMES[:6], along(range(6))), line(TIMES, along(range(8)), way="STEP")],
    ids=["other times", "steps"],
)
def test_where_curves_have_other_keys_or_ways_all_gaps_are_looked_at(other: Track) -> None:
    found = moments(line(TIMES, along([0, 1, 2, 9, 10, 11, 31, 32])), other)
    assert {0.29, 0.5, 3.29, 3.5, 6.29} <= set(np.round(found, 6).tolist())
