"""Keys of controls as Blender's curves take them: frames, steps, large turns and jumps."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.export.blender.control_keys import control_keys
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls

Z = np.array([0.0, 0.0, 1.0])


class Names:
    """A plan, as far as it is looked at: what nodes are called in Blender."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig

    def node(self, node: int) -> str:
        return f"in Blender: {self.rig.names[node]}"


def keys_of(*tracks: Track, rate: float = 30.0, more: tuple[Clip, ...] = ()) -> dict[str, Any]:
    rig = add_controls(chain((0, 0, 0), (1, 0, 0), (2, 0.3, 0)), options=AddControlsOptions(joints=("b",)))
    control = rig.find("b_ctl")
    clips = (*more, Clip("wave", tuple(replace(t, node=control if t.node < 0 else t.node) for t in tracks)))
    plan: Any = Names(replace(rig, clips=clips, rules=replace(rig.rules, per_second=rate)))
    return control_keys(plan)


def track(
    times: list[float], values: Any, way: Any = "LINEAR", path: Any = "translation", node: int = -1
) -> Track:
    return Track(node, path, way, np.array(times), np.array(values, dtype=np.float64))


def test_the_first_clip_with_keys_of_controls_counts_and_joints_have_none() -> None:
    joint = track([0.0, 1.0], np.zeros((2, 3)), node=1)
    found = keys_of(joint, track([0.0, 12.0], [[0, 0, 0], [1, 2, 1 / 3]]), more=(Clip("joints", (joint,)),))
    assert found == {
        "name": "wave",
        "rate": 30.0,
        "curves": [
            {
                "node": "in Blender: b_ctl",
                "path": "translation",
                "steps": False,
                "times": [0.0, 12.0],
                "values": [[0.0, 0.0, 0.0], [1.0, 2.0, 0.333333333]],
            }
        ],
    }
    assert keys_of(joint) == {"name": "", "rate": 30.0, "curves": []}
    assert keys_of(joint, rate=0.0)["rate"] == 24.0


def test_steps_are_told_and_minus_zero_is_zero() -> None:
    (curve,) = keys_of(track([0.0, 5.0], [[-0.0, 0, 0], [1, 0, 0]], "STEP"))["curves"]
    assert curve["steps"]
    assert str(curve["values"][0]) == "[0.0, 0.0, 0.0]"


def test_a_key_right_before_another_is_moved_away_from_it() -> None:
    (curve,) = keys_of(track([0.0, 4.999999, 5.0, 5.01, 9.0], np.zeros((5, 3))))["curves"]
    assert_allclose(curve["times"], [0.0, 4.97, 4.99, 5.01, 9.0], atol=1e-9)


@pytest.mark.parametrize(
    ("degrees", "way", "times"),
    [
        ([0.0, 8.0], "LINEAR", [0.5, 3.5]),  # so small that a straight line is the arc
        ([0.0, 40.0], "LINEAR", [0.5, 1.0, 2.0, 3.0, 3.5]),
        ([0.0, 40.0], "STEP", [0.5, 3.5]),
        ([40.0], "LINEAR", [0.5]),
    ],
)
def test_large_turns_have_a_key_on_each_frame(degrees: list[float], way: Any, times: list[float]) -> None:
    turns = from_axis_angle(Z, np.radians(degrees))
    keys = [0.5, 3.5][: len(degrees)]
    (curve,) = keys_of(track(keys, turns, way, "rotation"))["curves"]
    assert curve["times"] == times
    if len(times) == 5:
        expected = from_axis_angle(Z, np.radians(40.0) * (np.array(times) - 0.5) / 3.0)
        assert_allclose(curve["values"], expected, atol=1e-8)


def test_only_the_large_turn_of_several_gets_more_keys_and_signs_are_continuous() -> None:
    turns = from_axis_angle(Z, np.radians([0.0, 5.0, 50.0]))
    turns[1] = -turns[1]
    (curve,) = keys_of(track([0.0, 3.0, 6.0], turns, path="rotation"))["curves"]
    assert curve["times"] == [0.0, 3.0, 4.0, 5.0, 6.0]
    values = np.array(curve["values"])
    assert (np.einsum("ij,ij->i", values[1:], values[:-1]) > 0).all()
