"""Keys of an edited track are taken where it was edited; everywhere else the rig's own stay, to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

from rigtri.model.animation import Interpolation, Path, Track
from rigtri.operations.take_clips.key_merging import merged, thinned


def track(times: list[float], x: list[float], interpolation: Interpolation = "LINEAR") -> Track:
    """A translation along x; of a spline with tangents of 1."""
    values = np.outer(x, [1.0, 0.0, 0.0])
    if interpolation == "CUBICSPLINE":
        values = np.stack([np.ones_like(values), values, np.ones_like(values)], axis=1)
    return Track(0, "translation", interpolation, np.array(times), values)


OWN = track([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 0.0, 1.0, 0.0])


def keys(found: Track) -> list[tuple[float, float]]:
    x = found.values[..., 0] if found.interpolation != "CUBICSPLINE" else found.values[:, 1, 0]
    return list(zip(found.times.tolist(), x.tolist(), strict=True))


def changed(count: int, *at: int) -> np.ndarray:
    return np.isin(np.arange(count), at)


def test_at_the_same_times_only_changed_values_are_taken() -> None:
    now = track([0.0, 1.0001, 2.0, 3.0, 4.0], [0.001, 1.001, 5.0, 1.001, 0.001])
    found = merged(OWN, now, changed(5, 2), missed=0.001, bound=1e-6)
    assert keys(found) == [(0.0, 0.0), (1.0, 1.0), (2.0, 5.0), (3.0, 1.0), (4.0, 0.0)]
    assert now.values[2, 0] == 5.0
    assert OWN.values[2, 0] == 0.0


def test_a_changed_stretch_is_taken_between_two_keys_on_the_old_curve() -> None:
    """It agrees again at 1.5 and 2.5: there keys stand on the old curve, and 2.0 is replaced."""
    now = track([0.0, 0.5, 1.0, 1.5, 1.9, 2.5, 3.0, 4.0], [0.0, 0.5, 1.0, 0.501, 7.0, 0.499, 1.0, 0.0])
    found = merged(OWN, now, changed(8, 4), missed=0.001, bound=1e-6)
    assert keys(found) == [(0, 0), (1, 1), (1.5, 0.5), (1.9, 7.0), (2.5, 0.5), (3, 1), (4, 0)]


def test_changes_at_the_ends_reach_beyond_them() -> None:
    now = track([0.0, 0.5, 1.0, 3.0, 3.5, 4.0, 5.0], [9.0, 0.5, 1.0, 1.0, 0.5, 0.0, 8.0])
    found = merged(OWN, now, changed(7, 0, 6), missed=0.001, bound=1e-6)
    assert keys(found) == [(0, 9), (0.5, 0.5), (1, 1), (2, 0), (3, 1), (4, 0), (5, 8)]


def test_runs_with_one_key_between_them_are_one() -> None:
    now = track([0.0, 1.0, 1.2, 1.5, 1.8, 2.0, 3.0, 4.0], [0.0, 1.0, 6.0, 0.5, 7.0, 0.0, 1.0, 0.0])
    found = merged(OWN, now, changed(8, 2, 4), missed=0.001, bound=1e-6)
    assert keys(found) == keys(now)


@pytest.mark.parametrize("interpolation", ["STEP", "CUBICSPLINE"])
def test_other_kinds_of_keys_are_taken_whole(interpolation: Interpolation) -> None:
    now = track([0.0, 0.4, 4.0], [0.0, 3.0, 0.0], interpolation)
    assert merged(OWN, now, changed(3, 1), missed=0.001, bound=1e-6) is now


def test_splines_of_other_times_are_taken_whole_and_of_the_same_times_by_key() -> None:
    was = track([0.0, 1.0, 2.0], [0.0, 1.0, 0.0], "CUBICSPLINE")
    other = track([0.0, 2.0], [0.0, 5.0], "CUBICSPLINE")
    assert merged(was, other, changed(2, 1), missed=0.001, bound=1e-6) is other
    same = track([0.0, 1.0, 2.0], [3.0, 4.0, 5.0], "CUBICSPLINE")
    assert keys(merged(was, same, changed(3, 1), missed=0.001, bound=1e-6)) == [(0, 0), (1, 4), (2, 0)]


@pytest.mark.parametrize(
    ("path", "values", "left"),
    [
        ("translation", [[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], [0, 3]),
        ("translation", [[0.0, 0, 0], [1, 0, 0], [2.0015, 0, 0], [3, 0, 0]], [0, 2, 3]),
        # Four weights are no rotation: their lengths count.
        ("weights", [[1.0, 0, 0, 0], [2, 0, 0, 0], [3, 0, 0, 0], [9, 0, 0, 0]], [0, 2, 3]),
        ("rotation", [[0.0, 0, 0, 1], [0, 0, 0, 2], [0, 0, 0, 3], [0, 0, 0, 9]], [0, 3]),
    ],
)
def test_keys_that_others_interpolate_go(path: Path, values: list[list[float]], left: list[int]) -> None:
    given = Track(0, path, "LINEAR", np.arange(4.0), np.array(values))
    assert thinned(given, 1e-3).times.tolist() == left
    assert thinned(given, 1e-3).values.tolist() == np.array(values)[left].tolist()


def test_two_keys_stay() -> None:
    still = track([0.0, 1.0], [0.0, 0.0])
    assert thinned(still, 1.0) is still
    assert thinned(track([0.0, 1.0, 2.0], [0.0, 0.0, 0.0], "STEP"), 1.0).times.tolist() == [0, 1, 2]


def test_frames_stay_where_openusd_would_show_a_slow_rotation_otherwise() -> None:
    """Before, a control that passes its rest slowly was 3.1e-3 off at the frame in between, without a key."""
    times = np.array([0.0, 1.0, 1.9375, 2.0, 2.0625, 3.0, 4.0])
    angles = np.clip(0.06 * (times - 2.0), -0.00375, 0.00375)
    x = np.full(len(times), 1e-8)  # as the rounding of Euler angles is
    turns = np.stack([x, 0 * x, np.sin(angles / 2), np.cos(angles / 2)], axis=1)
    swing = Track(0, "rotation", "LINEAR", times, turns)
    thin, found = thinned(swing, 1e-6), thinned(swing, 1e-6, frames=True)
    assert thin.times.tolist() == [0.0, 1.9375, 2.0625, 4.0]
    assert found.times.tolist() == [0.0, 1.9375, 2.0, 2.0625, 4.0]
    assert np.abs(np.array(shown(thin, 2.0)) - np.eye(3)).max() > 3e-3
    assert np.abs(np.array(shown(found, 2.0)) - np.eye(3)).max() < 1e-7


def shown(keys: Track, time: float) -> Gf.Matrix3d:
    """The rotation of an orient op with these samples, as OpenUSD evaluates it."""
    prim = UsdGeom.Xform.Define(stage := Usd.Stage.CreateInMemory(), "/a")
    op = prim.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    for at, (x, y, z, w) in zip(keys.times.tolist(), keys.values.tolist(), strict=True):
        op.Set(Gf.Quatd(w, x, y, z), at)
    assert stage
    return prim.GetLocalTransformation(time).ExtractRotationMatrix()
