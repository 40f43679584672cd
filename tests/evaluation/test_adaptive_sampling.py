"""Keys where a motion bends: no more than a file should hold."""

from __future__ import annotations

import numpy as np
import pytest

from rigtri.errors import GeometryError
from rigtri.evaluation.adaptive_sampling import MOST_KEYS, adaptive_key_times


def test_a_motion_that_no_keys_follow_is_an_error_of_the_geometry() -> None:
    """Numbers at the end of float32 are rounded by more than keys may be off."""
    with pytest.raises(GeometryError, match=f"more than {MOST_KEYS} keys of a clip would be needed"):
        adaptive_key_times(
            lambda times: times[:, np.newaxis],
            lambda values, left, right, share, times: np.ones(len(times)),
            np.arange(40.0),
            within=0.1,
        )
