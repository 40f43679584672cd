"""Edits of the arrays of SkelAnimation prims, which hold all joints at once."""

from __future__ import annotations

from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.evaluation.timelines import without_steps
from rigtri.formats.usd.opinions.edits import Setting, set_value
from rigtri.formats.usd.reading.animation_reader import Property
from rigtri.model.animation import Track


def set_array(path: Any, name: str, item: Property, *, only: bool = False) -> Setting:
    """Set an array of an animation, complete: samples, blocked samples and default.

    A stronger sample hides all weaker ones, so none may be left out. only: erase other samples of the layer.
    """
    samples = {float(time): _value(item, rows) for time, rows in zip(item.times, item.samples, strict=True)}
    samples.update(dict.fromkeys(item.blocked))
    default = None if item.default is None else _value(item, item.default)
    return set_value(path, name, item.type_name, default, samples=dict(sorted(samples.items())), alone=only)


def _value(item: Property, rows: np.ndarray) -> Any:
    return item.kind.FromNumpy(np.ascontiguousarray(rows))


def check_no_spline(track: Track, title: str) -> None:
    """FileError for a track that samples cannot hold; title: what it moves."""
    if track.interpolation == "CUBICSPLINE" and len(track.times) > 1:
        raise FileError(f"{title} moves by splines, which USD has none of. Give it linear keys.")


def as_samples(track: Track, title: str) -> Track:
    """A track as samples hold it, without steps; FileError for splines."""
    check_no_spline(track, title)
    return without_steps(track)
