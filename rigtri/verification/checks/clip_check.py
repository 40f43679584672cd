"""Keys that are finite and absurd: one such number, mostly a slip of an exporter, hides a character."""

from __future__ import annotations

import numpy as np

from rigtri.maths.vectors import length
from rigtri.model.animation import Track
from rigtri.model.rig import Rig
from rigtri.verification.checks.cycle_check import title_and_pointer
from rigtri.verification.checks.findings import Findings

# So many times the size of the model away, or as large, float32 has one number left for all of its points.
FAR = 2.0**24
# With no number of a key above this, only what is smaller than 0.0006 units can have a key that is far.
MAYBE_FAR = 1e4


def check_clips(rig: Rig, findings: Findings) -> None:
    """Note the first key of each track that moves its node too far for float32, or makes it too large."""
    places = rig.world[:, 3, :3]
    places = places[np.isfinite(places).all(axis=1)]
    with np.errstate(over="ignore"):  # places of damaged files; nothing is far from these
        size = float(length(np.ptp(places, axis=0))) if len(places) else 0.0
    units = {"translation": size, "scale": 1.0}
    for clip in rig.clips:
        limits = ((column, FAR * units.get(column.path, 0.0)) for column in clip.columns)
        if not any(limit > 0 and np.abs(c.key_values).max(initial=0.0) > limit for c, limit in limits):
            continue
        for track in clip.tracks:
            unit = units.get(track.path, 0.0)
            if unit > 0 and (key := _first_far(track, FAR * unit)) is not None:
                words = f"key {key} of '{clip.name}' has a {track.path} of {_largest(track)[key]:g}"
                beside = f", and the skeleton is {size:g} large" if track.path == "translation" else ""
                findings.add("clips.far", *title_and_pointer(rig, track.node), words + beside)


def _largest(track: Track) -> np.ndarray:
    """The largest number of each key, (k,), tangents aside."""
    values = track.values[:, 1] if track.interpolation == "CUBICSPLINE" else track.values
    return np.asarray(np.abs(values).max(axis=1, initial=0.0))


def _first_far(track: Track, limit: float) -> int | None:
    far = np.flatnonzero(_largest(track) > limit)
    return int(far[0]) if len(far) else None
