"""Keys that move a node too far for float32, or make it too large, are told with their numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from rigs import chain

from rigtri.model.animation import Clip, Track
from rigtri.verification.checks import clip_check

FAR = 2.0**24


class Noted:
    """What is added to findings."""

    def __init__(self) -> None:
        self.added: list[tuple[str, ...]] = []

    def add(self, *words: str) -> None:
        self.added.append(words)


def found(path: Any, values: Any, way: Any = "LINEAR") -> list[tuple[str, ...]]:
    rig = chain((0, 0, 0), (3, 0, 0), (3, 4, 0))  # of a size of 5
    track = Track(1, path, way, np.arange(float(len(values))), np.array(values, dtype=np.float64))
    noted: Any = Noted()
    check = next(one for name, one in vars(clip_check).items() if name.startswith("check"))
    check(replace(rig, clips=(Clip("walk", (track,)),)), noted)
    return noted.added


@pytest.mark.parametrize(
    ("path", "most", "beside"),
    [("translation", 5 * FAR, ", and the skeleton is 5 large"), ("scale", FAR, "")],
)
def test_the_first_key_beyond_is_told(path: Any, most: float, beside: str) -> None:
    assert found(path, [[0, most, 0], [-most, 0, 0]]) == []
    more = 1.5 * most
    text = f"key 1 of 'walk' has a {path} of {more:g}{beside}"
    assert found(path, [[0, 0, 0], [0, -more, 1], [2 * more, 0, 0]]) == [
        ("clips.far", "node 'b'", "/nodes/1", text)
    ]


def test_of_splines_the_values_count_and_not_the_tangents() -> None:
    values = np.zeros((2, 3, 3))
    values[0, [0, 2]] = 100 * FAR
    assert found("scale", values, "CUBICSPLINE") == []
    values[1, 1, 2] = 3 * FAR
    assert found("scale", values, "CUBICSPLINE")[0][3] == f"key 1 of 'walk' has a scale of {3 * FAR:g}"


def test_rotations_and_weights_are_never_far() -> None:
    assert found("rotation", [[1e30, 0, 0, 1]]) == found("weights", [[1e30, 0]]) == []
