"""Keys of joints that a bake leaves as they are, because the new ones would give the same."""

from __future__ import annotations

import numpy as np

from rigtri.evaluation.key_reduction import is_reduction_of
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import SAME_VALUE
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track


def is_still_valid(
    old: Track | None, new: Track, times: Floats, values: Floats, *, bound: float, room: Floats
) -> bool:
    """Whether a track is what thinning the values, (f, c) at ``times``, may have left, as ``new`` is.

    What differs by rounding can turn the choice of keys, and a second run must change nothing. But no key
    stays where a reader finds none with the new ones: ``room``, the times at which one does. bound: how
    far thinned keys may be off, in the values' unit or radians.
    """
    if old is None or not old.interpolation == new.interpolation == "LINEAR":
        return False
    if not (np.isin(old.times, room).all() and np.isin(old.times, times).all()):
        return False
    # Radians: of turns by the unit quaternions that differ so.
    size = 2.0 if new.path == "rotation" else float(np.abs(values).max(initial=0.0))
    return is_reduction_of(times, values, sample(old, times), bound, SAME_VALUE * size)
