"""The keys of controls as plain lists, for Blender's USD import: it makes caches of the samples of prims.

Source: docs/blender.md.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.evaluation.active_controls import controls_and_poles
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import timelines
from rigtri.export.blender.plan import Plan
from rigtri.maths.quaternions import angle_between, make_continuous
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.constraints import constraints_of

# Blender's curves go straight from one quaternion to the next. A turn between two keys that is this small,
# in radians, is less than 1e-5 beside the arc.
_SMALL_TURN = 0.15
# Frames that two keys are apart at least: Blender merges those that are within 0.01, of jumps in USD, say.
_APART = 0.02


def control_keys(plan: Plan) -> dict[str, Any]:
    """The clip in which controls, poles and weights have keys, by name, and their curves, a dictionary each.

    Prims of a stage share its time, so there is one clip. times: in time codes, which are Blender's frames;
    rate: so many are a second.
    """
    rig = plan.rig
    rate = rig.rules.per_second if rig.rules.per_second > 0 else 24.0
    animated = controls_and_poles(rig) | {
        node for rule in constraints_of(rig).values() for node in rule.weight_nodes
    }
    for timeline in timelines(rig):
        tracks = [
            track for track in timeline.clip.tracks if track.node in animated and not rig.is_joint[track.node]
        ]
        if tracks:
            return {"name": timeline.name, "rate": rate, "curves": [_curve(plan, track) for track in tracks]}
    return {"name": "", "rate": rate, "curves": []}


def _curve(plan: Plan, track: Track) -> dict[str, Any]:
    track = _with_frames(track)
    values = make_continuous(track.values) if track.path == "rotation" else track.values
    return {
        "node": plan.node(track.node),
        "path": track.path,
        "steps": track.interpolation == "STEP",
        "times": _short(_set_apart(track.times)),
        "values": [_short(row) for row in values],
    }


def _with_frames(track: Track) -> Track:
    """A track whose large turns have a key on each frame."""
    if track.path != "rotation" or track.interpolation == "STEP" or len(track.times) < 2:
        return track
    large = angle_between(track.values[1:], track.values[:-1]) > _SMALL_TURN
    within = [
        np.arange(np.floor(start) + 1.0, end)
        for start, end in zip(track.times[:-1][large], track.times[1:][large], strict=True)
    ]
    times = np.union1d(track.times, np.concatenate([np.zeros(0), *within]))
    return replace(track, times=times, values=sample(track, times))


def _set_apart(times: Floats) -> Floats:
    """Times of keys, of which those right before another are moved away from it."""
    times = times.copy()
    for k in range(len(times) - 2, -1, -1):
        times[k] = min(times[k], times[k + 1] - _APART)
    return times


def _short(numbers: Any) -> list[float]:
    """With as many digits as float32 holds."""
    return [float(f"{number:.9g}") + 0.0 for number in numbers]
