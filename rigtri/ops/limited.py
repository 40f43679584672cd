"""What is told of clips whose samples could not be near enough to each other."""

from __future__ import annotations

import numpy as np

from rigtri.ops.taking.notices import some
from rigtri.quaternions import norm
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.solve.between import MOST_A_SECOND


def tell_limited(rig: Rig, report: Report, most: float) -> None:
    """One warning for all clips of the report that are off by more than ``most`` of the size between samples.

    rig: with the clips as they were.
    """
    entries = [e for e in report.added if e.get("type") == "clip" and e.get("limited")]
    far = [e for e in entries if e["between_samples"] > most]
    if not far:
        return
    worst = max(far, key=lambda entry: float(entry["between_samples"]))
    more = f" ({len(far) - 1} more clips alike)" if len(far) > 1 else ""
    names = _swinging(rig, worst["clip"], worst["between_after"])
    why = f"; there the file's own splines of {some(names)} swing round, from a key to one of opposite sign"
    report.warn(
        "samples-limited",
        f"Clip '{worst['clip']}': with {MOST_A_SECOND:g} samples a second, the most, what lies between two "
        f"of them is off by up to {worst['between_samples']:.2g} of the size, after "
        f"{worst['between_after']:g}{more}{why if names else ''}. --between or --fps ask for fewer",
    )


def _swinging(rig: Rig, clip: str, time: float) -> list[str]:
    """The nodes whose spline goes at a time from one turn to the next by way of the opposite half."""
    names = []
    for track in (t for c in rig.clips if c.name == clip for t in c.played.tracks):
        if track.path == "rotation" and track.interpolation == "CUBICSPLINE":
            row = int(np.searchsorted(track.times, time, side="right"))
            pair = track.values[max(row - 1, 0) : row + 1, 1]
            names += [rig.title(track.node)] if norm(pair[0] - pair[-1]) > norm(pair[0] + pair[-1]) else []
    return names
