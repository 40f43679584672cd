"""Where keys must stand so that what lies between them stays within a bound.

Between two keys that are too far apart for what happens there, the middle gets one, and so
on. A jump gets a key just before it, so that no line is drawn across it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rigtri.maths.trigonometry import Floats

# Places of a gap that are looked at: quarters, and one where nothing meets by chance.
LOOKED_AT = (0.25, 0.5, 0.75, 0.29)
# A gap is halved so often at most: float32 has no times in between any more.
_DEEPEST = 24
# More keys than this are a bound below the rounding of what is sampled.
MOST_KEYS = 100_000

Sampled = Callable[[Floats], Floats]
Error = Callable[[Floats, Floats, Floats, Floats, Floats], Floats]


def adaptive_key_times(
    sample: Sampled,
    error: Error,
    times: Floats,
    *,
    within: float,
    keep: Callable[[Floats], Floats],
) -> Floats:
    """Times of keys, (k,): those given and as many between them as the bound asks for.

    sample: times (f,) → values (f, c). error: how far values (f, c) are from what keys say there,
    from (values, left values, right values, share (f,), times) → (f,). keep: rounds times to what
    the file can hold; a gap that has no such time inside stays.
    OverflowError where more than `MOST_KEYS` would be needed.
    """
    gaps = np.stack([times[:-1], times[1:]], axis=1)
    found = [times]
    for _ in range(_DEEPEST):
        if not len(gaps):
            break
        wide = _errors(sample, error, gaps) > within
        gaps = gaps[wide]
        middle = keep(0.5 * (gaps[:, 0] + gaps[:, 1]))
        inside = (middle > gaps[:, 0]) & (middle < gaps[:, 1])
        gaps, middle = gaps[inside], middle[inside]
        found.append(middle)
        if len(middle) > MOST_KEYS:
            raise OverflowError(f"more than {MOST_KEYS} keys would be needed")
        gaps = np.concatenate(
            [np.stack([gaps[:, 0], middle], axis=1), np.stack([middle, gaps[:, 1]], axis=1)]
        )
    return np.unique(np.concatenate(found))


def _errors(sample: Sampled, error: Error, gaps: Floats) -> Floats:
    """The largest error in each gap, (g,)."""
    ends = np.unique(gaps)
    at_ends = sample(ends)
    left, right = (at_ends[np.searchsorted(ends, gaps[:, side])] for side in (0, 1))
    worst = np.zeros(len(gaps))
    for share in LOOKED_AT:
        inside = gaps[:, 0] + share * (gaps[:, 1] - gaps[:, 0])
        shares = np.full(len(gaps), share)
        worst = np.maximum(worst, error(sample(inside), left, right, shares, inside))
    return worst
