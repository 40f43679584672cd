"""Rotations between their keys, of many tracks at once: arcs, and what OpenUSD plays where that is none.

Source: glTF 2.0 appendix C; OpenUSD, `GfSlerp`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigtri.maths.arrays import Integers
from rigtri.maths.quaternions import gf_slerp, norm, slerp_rows
from rigtri.maths.trigonometry import Floats

# A quaternion that is unit as float32 is off by no more.
_ROUNDED = 2e-7


def turned(segments: Sequence[tuple[Floats, Integers, Floats]], *, raw: bool) -> list[Floats]:
    """Turns, (f, t, 4), of each of some tracks: at a share, (f,), of the way from keys ``left``, (f,), of
    values, (k, t, 4), to the next ones.

    slerp takes unit values; their stored length is interpolated beside it, as in a renderer's mixer.
    raw: as in `Track`.
    """
    if not segments:
        return []
    values, left, inside = segments[0] if len(segments) == 1 else _in_a_row(segments)
    size, share = norm(values)[..., np.newaxis], inside[:, np.newaxis, np.newaxis]
    with np.errstate(divide="ignore", invalid="ignore"):
        turns = values / size
        blended = slerp_rows(turns[:-1], turns[1:], left, inside)
        blended = blended * ((1.0 - share) * size[left] + share * size[left + 1])
    if raw:
        _put_off_arcs(blended, values, size[..., 0], left, inside)
    if len(segments) == 1:
        return [blended]
    ends = np.cumsum([len(some) * each.shape[1] for each, some, _ in segments])[:-1]
    parts = np.split(blended.transpose(), ends, axis=2)
    return [
        part.reshape(4, each.shape[1], len(some)).transpose()
        for part, (each, some, _) in zip(parts, segments, strict=True)
    ]


def _put_off_arcs(into: Floats, values: Floats, size: Floats, left: Integers, inside: Floats) -> None:
    """Put what OpenUSD plays where that is no arc: between keys that are not unit.

    into: (f, t, 4). size: the lengths of the values, (k, t). Others are in `turned`.
    """
    long = np.abs(size - 1.0) > _ROUNDED
    off = long[:-1] | long[1:]
    if not off.any():
        return
    between = np.flatnonzero((inside > 0.0) & (inside < 1.0))
    # Tracks before times, as they lie in memory.
    track, row = np.nonzero(np.take(off.T, left[between], axis=1))
    row = between[row]
    keys, key = values.transpose(), left[row]
    played = gf_slerp(keys[:, track, key].T, keys[:, track, key + 1].T, inside[row])
    into.transpose()[:, track, row] = played.T


def _in_a_row(segments: Sequence[tuple[Floats, Integers, Floats]]) -> tuple[Floats, Integers, Floats]:
    """The keys of all tracks as those of one, (k, 1, 4), with the keys on the left and the shares, (f,).

    Between the last key of a track and the first of the next one nothing is asked for.
    """
    keys = [values.transpose().reshape(4, -1) for values, _, _ in segments]
    starts = np.cumsum([0, *(part.shape[1] for part in keys)]).tolist()
    left = [
        (np.arange(start, end, len(values))[:, np.newaxis] + some).ravel()
        for start, end, (values, some, _) in zip(starts, starts[1:], segments, strict=False)
    ]
    inside = [np.tile(share, values.shape[1]) for values, _, share in segments]
    return (
        np.concatenate(keys, axis=1).transpose()[:, np.newaxis],
        np.concatenate(left),
        np.concatenate(inside),
    )
