"""Where joints stand: at rest, in the bind pose, and at some moments of the clips."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from rigtri.matrices import compose
from rigtri.pose import bind_worlds, worlds
from rigtri.records import Clip, key_values
from rigtri.rig import Rig
from rigtri.trigonometry import Floats

# Moments that are looked at: so many clips, the longest first, at these parts of their keys.
CLIPS = 4
PARTS = (0.0, 0.25, 0.5, 0.75)


@dataclass(eq=False)
class Poses:
    """The poses of a rig, each where its nodes stand, (n, 3), made when asked for."""

    rig: Rig

    @cached_property
    def rest(self) -> Floats:
        return _finite(self.rig.world[:, 3, :3])

    @cached_property
    def bind(self) -> Floats | None:
        """The bind pose of the skin with most joints; None where there is none or it is no pose."""
        skins = [skin for skin in self.rig.skins if skin.stored and len(skin.joints) > 1]
        if not skins:
            return None
        places = bind_worlds(self.rig, max(skins, key=lambda skin: len(skin.joints)))[:, 3, :3]
        return places if bool(np.isfinite(places).all()) else None

    @cached_property
    def moving(self) -> Floats:
        """Moments of the longest clips, (f, n, 3); f is 0 without clips.

        Rotations alone are taken, at keys: bones keep their lengths.
        """
        clips = sorted(self.rig.shown_clips, key=_rotations, reverse=True)[:CLIPS]
        local = [_posed(self.rig, clip, part) for clip in clips for part in PARTS if _rotations(clip)]
        if not local:
            return np.zeros((0, len(self.rig), 3))
        return _finite(worlds(self.rig, np.stack(local))[..., 3, :3])

    @cached_property
    def _movers(self) -> frozenset[int]:
        return frozenset(k for skin in self.rig.skins for k in skin.joints[skin.weighted].tolist())

    def moves_points(self, node: int) -> bool:
        """Whether a joint has weight of any point. It reads the weights of all meshes when first asked."""
        return node in self._movers

    def named(self, pose: Literal["rest", "bind"]) -> Floats:
        return self.bind if pose == "bind" and self.bind is not None else self.rest


def _rotations(clip: Clip) -> int:
    return len([track for track in clip.tracks if track.path == "rotation" and len(track.times) > 1])


def _posed(rig: Rig, clip: Clip, part: float) -> Floats:
    """Local matrices, (n, 4, 4), with the rotation of each track at the key so far into it."""
    rotation = rig.rotation.copy()
    for track in clip.tracks:
        if track.path == "rotation" and len(track.times):
            rotation[track.node] = key_values(track)[int(part * len(track.times))]
    local = compose(rig.translation, rotation, rig.scale)
    return np.where(rig.has_matrix[:, np.newaxis, np.newaxis], rig.matrix, local)


def _finite(places: Floats) -> Floats:
    return np.where(np.isfinite(places), places, 0.0)
