"""Rigs as an animator gives them back: a key changed, clips split."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from places import SAMPLES

from rigtri.evaluation import sampling
from rigtri.formats import read
from rigtri.maths.matrices import compose
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.report import Report

BIPED = SAMPLES / "biped.glb"


def rig_of(path: Path = BIPED) -> Rig:
    return read(path).rig


def notices(report: Report) -> list[str]:
    return [notice.code for notice in report.warnings]


def with_tracks(rig: Rig, clip: str, changed: Callable[[Track], Track | None]) -> Rig:
    """The rig with the tracks of a clip changed, or left out."""

    def kept(found: Clip) -> Clip:
        tracks = tuple(now for track in found.tracks if (now := changed(track)) is not None)
        return replace(found, tracks=tracks) if found.name == clip else found

    return replace(rig, clips=tuple(map(kept, rig.clips)))


def turned_key(rig: Rig, joint: str, clip: str = "walk", key: int = 3, angle: float = 0.4) -> Rig:
    """The rig with one rotation key of a joint turned about an axis of its own."""
    node, turn = rig.find(joint), from_axis_angle([1.0, 2.0, 3.0], angle)

    def changed(track: Track) -> Track:
        if (track.node, track.path) != (node, "rotation"):
            return track
        values = track.values.copy()
        if track.interpolation == "CUBICSPLINE":
            values[key, 1] = multiply(values[key, 1], turn)
        else:
            values[key] = multiply(values[key], turn)
        return replace(track, values=values)

    return with_tracks(rig, clip, changed)


def without_skin(rig: Rig) -> Rig:
    return replace(rig, skins=())


def shown_at(rig: Rig, time: float) -> Rig:
    """The rig as a DCC writes it that stores the current frame as rest."""
    parts = {path: getattr(rig, path).copy() for path in ("translation", "rotation", "scale")}
    for track in (t for t in rig.clip("walk").tracks if t.path != "weights"):
        parts[track.path][track.node] = sampling.sample(track, [time * rig.rules.per_second])[0]
    return resting(rig, **parts)


def resting(rig: Rig, **parts: Floats) -> Rig:
    """The rig with its nodes elsewhere at rest, whether these hold parts or a matrix."""
    rig = replace(rig, **parts)
    return replace(rig, matrix=compose(rig.translation, rig.rotation, rig.scale))


def places(rig: Rig, clip: str, times: Floats) -> dict[str, Floats]:
    world = sampling.worlds(rig, sampling.locals_at(rig, rig.clip(clip), times))
    return {rig.names[node]: world[:, node, 3, :3] for node in np.flatnonzero(rig.is_joint)}


def apart(a: Rig, b: Rig, clip: str, scale: float = 1.0) -> float:
    """How far joints of one name are apart, at all keys and between."""
    keys = sampling.key_times(a.clip(clip))
    times = np.unique(np.concatenate([keys, (keys[1:] + keys[:-1]) / 2.0]))
    mine, its = places(a, clip, times), places(b, clip, times)
    return max(float(np.abs(mine[name] - its[name] * scale).max()) for name in mine if name in its)


def split(rig: Rig, clip: str, named: Callable[[str], str]) -> Rig:
    """The rig with a clip for each node of one, named after the node."""
    found = rig.clip(clip)
    nodes = dict.fromkeys(track.node for track in found.tracks)
    parts = tuple(
        Clip(named(rig.names[node]), tuple(t for t in found.tracks if t.node == node)) for node in nodes
    )
    return replace(rig, clips=(*(c for c in rig.clips if c is not found), *parts))
