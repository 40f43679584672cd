"""A rig with all its controls, its joints and controls in a clip, and how far apart two such rigs are."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from places import SAMPLES

from rigtri.evaluation import sampling
from rigtri.formats import read
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake

WHOLE = AddControlsOptions(whole_character=True)


# The bound: of the character's size, at every frame.
BOUND = 1e-5


def stored(rig: Rig) -> Rig:
    """The rig as a file keeps it."""

    def single(values: Floats) -> Floats:
        return values.astype(np.float32).astype(np.float64)

    return replace(
        rig, translation=single(rig.translation), rotation=single(rig.rotation), scale=single(rig.scale)
    )


@cache
def rigged(name: str = "biped.glb") -> Rig:
    """A sample with all controls of a whole character, as a file keeps it."""
    return stored(add_controls(read(SAMPLES / name).rig, options=WHOLE))


@cache
def with_keyed_controls(name: str = "biped.glb") -> Rig:
    """The same, whose controls have the motion of the joints."""
    return bake(rigged(name), options=BakeOptions(to="controls"))


def size(rig: Rig) -> float:
    points = rig.world[rig.is_joint, 3, :3]
    return float(np.linalg.norm(points.max(axis=0) - points.min(axis=0))) or 1.0


def apart(a: Rig, b: Rig, clip: str, times: Floats) -> float:
    """How far joints are apart in a clip, as a share of the size."""
    joints = np.flatnonzero(a.is_joint)
    worlds = [
        sampling.worlds(rig, sampling.locals_at(rig, rig.clip(clip), times))[:, joints, 3, :3]
        for rig in (a, b)
    ]
    return float(np.linalg.norm(worlds[0] - worlds[1], axis=-1).max()) / size(a)


def moved(rig: Rig, node: int, by: Floats) -> Rig:
    translation = rig.translation.copy()
    translation[node] += by
    return replace(rig, translation=translation)


def control(rig: Rig, joint: str, kind: str) -> int:
    return next(
        node
        for node, note in rig.metadata.items()
        if note.get("type") == "control" and note["kind"] == kind and note["joint"] == joint
    )


def animated(rig: Rig, node: int, path: Any, values: Any, times: Any = (0.0, 1.0)) -> Rig:
    track = Track(node, path, "LINEAR", np.array(times), np.array(values, dtype=np.float64))
    return replace(rig, clips=(*rig.clips, Clip("new", (track,))))
