from __future__ import annotations

import numpy as np

from rigtri.model.animation import Clip, Track

TIMES = np.array([0.0, 1.0])
TURN = Track(0, "rotation", "LINEAR", TIMES, np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)))
BULGE = Track(1, "weights", "LINEAR", TIMES, np.zeros((2, 1)))


def test_an_idle_clip_plays_its_weights_alone() -> None:
    clip = Clip("walk", (TURN, BULGE))
    assert clip.without_idle is clip
    played = Clip("walk", (TURN, BULGE), idle=True).without_idle
    assert played.tracks == (BULGE,)
    assert not played.idle
