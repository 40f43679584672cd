"""Rotations as files hold them: they go from key to key the way they went before they were rounded."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose

from rigtri.evaluation.sampling import sample
from rigtri.formats.gltf.float32_rounding import round_tracks
from rigtri.model.animation import Track


def test_rotations_half_a_turn_apart_to_the_bit_keep_the_way_round_that_players_see() -> None:
    """Their products sum up to nothing; whether those of the unit turns do so, too, hangs on their length."""
    random = np.random.default_rng(5)
    below = set()
    for a, b in random.uniform(0.3, 0.6, (50, 2)).astype(np.float32).astype(np.float64):
        values = np.array([[a, b, b, a], [-a, -b, b, a]])
        track = Track(0, "rotation", "LINEAR", np.array([0.0, 1.0]), values)
        (stored,) = round_tracks([track], [track])
        read = Track(0, "rotation", "LINEAR", track.times, stored.astype(np.float64))
        between = sample(track, [0.5])[0]
        assert_allclose(
            sample(read, [0.5])[0] / np.linalg.norm(between), between / np.linalg.norm(between), atol=1e-3
        )
        below.add(bool(between[0] * a > 0))
    assert below == {True, False}
