"""What no format can write of an edited rig: numbers that are none, and nodes that come and go at once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigtri.errors import GeometryError, UsageError
from rigtri.frames.half_scales import is_half
from rigtri.maths.arrays import Booleans
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig

# Files hold positions and keys as float32, some as half.
_LARGEST, _LARGEST_HALF = float(np.finfo(np.float32).max), float(np.finfo(np.float16).max)


def check_numbers(before: Rig, after: Rig) -> None:
    """GeometryError for a node or clip whose numbers an edit made too large, infinite or NaN.

    What was so may stay so.
    """
    if after is before:
        return
    least = _LARGEST_HALF if after.rules.raw_quaternions else _LARGEST
    doubtful = [clip for clip in after.clips if any(_exceed(c.stored, least) for c in clip.columns)]
    known_tracks = {id(track) for clip in before.clips if doubtful for track in clip.tracks}
    for clip in doubtful:
        for track in clip.tracks:
            largest = _LARGEST_HALF if is_half(after, track) else _LARGEST
            if id(track) not in known_tracks and _unfit(track.values, largest).any():
                raise GeometryError(
                    f"The {track.path} of '{after.title(track.node)}' in clip '{clip.name}' gets values that "
                    f"are not numbers, or larger than {largest:.3g}, the most that the file can hold: a bone "
                    "or a scale there is zero, or numbers are too large. Leave the joint or the clip out"
                )
    lost = np.zeros(len(after), dtype=bool)
    for name in ("translation", "rotation", "scale", "matrix"):
        wrong, known = _unfit(getattr(after, name)), _unfit(getattr(before, name))
        wrong[: len(before)] &= ~known
        lost |= wrong.any(axis=tuple(range(1, wrong.ndim)))
    for number, new in enumerate(after.skins):
        worse = _unfit(new.inverse_bind)
        if number < len(before.skins):
            old = before.skins[number].inverse_bind[: len(worse)]
            worse[: len(old)] &= ~_unfit(old)
        lost[new.joints[worse.any(axis=(1, 2))]] = True
    if lost.any():
        node = int(lost.argmax())
        raise GeometryError(
            f"'{after.names[node] or after.labels[node]}' gets no finite position: a scale at or "
            "above it is zero, or numbers there are too large. Leave it out with --exclude"
        )


def _exceed(numbers: NDArray[np.floating[Any]], largest: float) -> bool:
    """Whether any number is none, or larger than ``largest``."""
    # NaN is both the least and the largest, and no more than anything.
    low, high = float(numbers.min(initial=0.0)), float(numbers.max(initial=0.0))
    return not (-largest <= low and high <= largest)


def _unfit(numbers: Floats, largest: float = _LARGEST) -> Booleans:
    """Which numbers are none, or larger than ``largest``."""
    return np.asarray(~(np.abs(numbers) <= largest))


def check_order(rig: Rig) -> None:
    """UsageError where nodes were taken out of the file and others added: no writer does both at once."""
    if rig.pending.removed and any(
        key is None and node not in rig.pending.removed for node, key in enumerate(rig.keys)
    ):
        raise UsageError(
            "Nodes were taken out of the file, and others added in the same edit: write the file after each "
            "of the two"
        )
