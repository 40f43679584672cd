"""From float64 to the float32 of a file, so that poses move as little as can be.

Everything is elementwise: the bytes must not depend on the machine.

Source: glTF 2.0 appendix C (interpolation); docs/exactness.md.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rigtri.formats.half_turn_keys import half_turns, keep_way_round
from rigtri.maths.quaternions import dot, norm, normalise_for_storage
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track

Singles = NDArray[np.float32]


def to_singles(numbers: Floats) -> Singles:
    """Numbers as float32. OverflowError where one does not fit."""
    with np.errstate(over="ignore"):
        singles = np.ascontiguousarray(numbers, dtype="<f4")
    if not np.isfinite(singles).all():
        raise OverflowError("a result is too large for 32-bit numbers")
    return singles


def round_tracks(tracks: Sequence[Track], before: Sequence[Track]) -> list[Singles]:
    """The values of tracks as they will be stored, rows as in the file.

    before: the same tracks as read; rotations half a turn apart keep the way round
    that these have.
    """
    rounded: list[Singles | None] = [None] * len(tracks)
    flat = [k for k, track in enumerate(tracks) if track.interpolation != "CUBICSPLINE"]
    for turns in (True, False):
        mine = [k for k in flat if (tracks[k].path == "rotation") is turns]
        if not mine:
            continue
        # One array for all: thousands of tracks of a few keys are common.
        width = [tracks[k].values.shape[1] for k in mine]
        rows = np.concatenate([tracks[k].values.ravel() for k in mine])
        rows = to_singles(normalise_for_storage(rows.reshape(-1, 4)).ravel() if turns else rows)
        start = 0
        for k, columns in zip(mine, width, strict=True):
            count = len(tracks[k].values) * columns
            rounded[k] = rows[start : start + count].reshape(-1, columns)
            start += count
        if turns:
            _keep_ways_round([before[k] for k in mine], rows.reshape(-1, 4))
    for k, track in enumerate(tracks):
        if track.interpolation == "CUBICSPLINE":
            rounded[k] = round_spline(track)
    return [rows for rows in rounded if rows is not None]


def round_spline(track: Track) -> Singles:
    """A cubic track, (3k, c): tangents take up what rounding its keys would do at mid-segment.

    Halfway between two keys the curve is ½(v₀ + v₁) + dt/8·(out₀ − in₁), so an
    error e of a key is undone there by −4e/dt in the out-tangent after it and
    by +4e/dt in the in-tangent before it.
    """
    exact = track.values
    values = normalise_for_storage(exact[:, 1]) if track.path == "rotation" else exact[:, 1]
    stored = exact.copy()
    stored[:, 1] = to_singles(values)
    error = stored[:, 1] - exact[:, 1]
    span = np.diff(track.times)[:, np.newaxis]
    with np.errstate(divide="ignore", invalid="ignore"):
        pull = np.where(span > 0, 4.0 / span, 0.0)
        stored[:-1, 2] -= error[:-1] * pull
        stored[1:, 0] += error[1:] * pull
    return to_singles(stored.reshape(-1, exact.shape[2]))


def _keep_ways_round(before: Sequence[Track], rows: Singles) -> None:
    """Let rounding not turn the way from one key to the next around, where it is half a turn.

    rows: the rotations of all tracks, one after the other; changed in place.
    """
    near = np.flatnonzero(half_turns(rows.astype(np.float64)))
    if not len(near):
        return
    ends = np.cumsum([len(track.values) for track in before])
    for which in np.unique(np.searchsorted(ends, near, side="right")).tolist():
        track, end = before[which], int(ends[which])
        if track.interpolation == "LINEAR":
            _nudge(rows[end - len(track.values) : end], track.values)


def _nudge(rows: Singles, before: Floats) -> None:
    """Move keys by a rounding step or two until every dot product has its sign, with some room."""
    # Of unit turns, as players see them: of turns that are half a turn apart to the bit, their length
    # decides.
    size = norm(before)[:, np.newaxis]
    turns = before / np.where(size > 0, size, 1.0)
    negative = dot(turns[:-1], turns[1:]) < 0
    for k, below in enumerate(negative.tolist()):
        # Elsewhere an edit may have taken −q for q, which is the same rotation.
        if half_turns(rows[k : k + 2].astype(np.float64)).any():
            keep_way_round(rows, k, negative=below, limit=1.0)
