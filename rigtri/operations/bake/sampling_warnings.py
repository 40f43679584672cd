"""Warnings about what lies between the samples of clips."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from rigtri.evaluation.curve_refinement import MOST_A_SECOND
from rigtri.maths.quaternions import dot
from rigtri.model.animation import Track, key_values
from rigtri.model.metadata import ControlRecord
from rigtri.model.rig import Rig
from rigtri.operations.take_clips.messages import list_names
from rigtri.report import Report

# Two keys of a spline are on opposite sides where the cosine between their quaternions is below this:
# less than 120° apart, and by way of components more than 240°.
_OPPOSITE = -0.5


def _clips(report: Report) -> list[Mapping[str, Any]]:
    return [entry for entry in report.added if entry.get("type") == "clip"]


def warn_undersampled(rig: Rig, report: Report, most: float) -> None:
    """One warning for all clips that are off by more than ``most`` of the size between samples."""
    far = [entry for entry in _clips(report) if entry.get("limited") and entry["between_samples"] > most]
    if not far:
        return
    worst = max(far, key=lambda entry: float(entry["between_samples"]))
    more = f" ({len(far) - 1} more clips alike)" if len(far) > 1 else ""
    end = _end_of(rig, worst["between_node"])
    limb = f", of the limb of '{end}'," if end else ""
    soft = ", and --soft 0.02 lets the limb slow down before it is straight" if end else ""
    report.warn(
        "samples-limited",
        f"Clip '{worst['clip']}': with {worst['frames']} samples '{worst['between_node']}'{limb} is still "
        f"off between them by up to {worst['between_samples']:.2g} of the size, after "
        f"{worst['between_after']:g}{more}. "
        f"It jumps there, or more than {MOST_A_SECOND:g} a second would be needed. A --between above that "
        f"accepts it{soft}; --fps N sets the samples yourself",
    )


def _end_of(rig: Rig, name: str | None) -> str | None:
    """The IK end of the limb that a joint is of."""
    node = rig.known(name) if name else None
    if node is None:
        return None
    limbs = rig.records(ControlRecord).items()
    return next((rig.title(control) for control, limb in limbs if node in map(rig.known, limb.chain)), None)


def warn_spline_swings(rig: Rig, report: Report) -> None:
    """A warning for each clip of the report whose splines go from a turn to one of opposite sign.

    rig: with the clips as they were. glTF's splines are of components: between q and −q they pass near
    nothing, and turn by nearly 360° in an instant.
    """
    baked = {entry["clip"] for entry in _clips(report)}
    for clip in (clip for clip in rig.clips if clip.name in baked):
        swings = {track.node: list(_swings(track)) for track in clip.played.tracks}
        nodes = [node for node, times in swings.items() if times]
        if nodes:
            first = min(time for node in nodes for time in swings[node])
            names = list_names(rig.title(node) for node in nodes)
            report.warn(
                "splines-swing",
                f"Clip '{clip.name}': the file's own splines of {names} swing round by nearly 360°, from a "
                f"key to one of opposite sign, first after {first:g}; players show that, and it was baked "
                "as it is. Give both keys one sign where the file was made",
            )


def _swings(track: Track) -> Iterator[float]:
    """The times of the keys from which a spline swings round."""
    if track.path == "rotation" and track.interpolation == "CUBICSPLINE":
        values = key_values(track)
        yield from track.times[np.flatnonzero(dot(values[:-1], values[1:]) < _OPPOSITE)].tolist()
