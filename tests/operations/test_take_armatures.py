"""What moves an armature and which tracks are one, by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.errors import UsageError
from rigtri.maths.matrices import compose
from rigtri.maths.quaternions import from_axis_angle
from rigtri.model.animation import Track
from rigtri.operations.options.draw import DrawOptions
from rigtri.operations.take_clips.armature_motion import _bound, _placed
from rigtri.operations.take_clips.crowds import _alike


def somewhere() -> Any:
    turn = from_axis_angle(np.array([1.0, 2.0, 3.0]), 0.7)
    return compose(np.array([4.0, 5.0, 6.0]), turn, np.array([2.0, 2.0, 2.0]))


@pytest.mark.parametrize("node", [0, 1, 2])
def test_a_node_is_placed_in_the_world_whatever_is_above_it(node: int) -> None:
    rig = chain((1, 0, 0), (2, 1, 0), (3, 0, 1))
    found = _placed(rig, node, somewhere())
    assert_allclose(found.world[node], somewhere(), atol=1e-12)
    others = [k for k in range(3) if k != node]
    assert_allclose(found.local[others], rig.local[others])


def test_bind_poses_below_a_moved_node_move_along() -> None:
    rig = chain((1, 0, 0), (2, 1, 0), (3, 0, 1))
    back = somewhere()
    found = _bound(rig, {1: back})
    binds = [np.linalg.inv(skin.inverse_bind) for skin in (rig.skins[0], found.skins[0])]
    assert_allclose(binds[1][0], binds[0][0])
    for row in (1, 2):
        assert_allclose(binds[1][row], binds[0][row] @ back, atol=1e-9)


def track(values: Any, node: int = 1, path: Any = "translation") -> Track:
    rows = np.array(values, dtype=np.float64)
    return Track(node, path, "LINEAR", np.arange(float(len(rows))), rows)


MOVES = track([[0.0, 0, 0], [1, 0, 0]])


@pytest.mark.parametrize(
    ("theirs", "same"),
    [
        ({(7, "translation"): track([[0.0, 0, 0], [1, 0, 0]], 7)}, True),
        ({(7, "translation"): track([[0.0, 0, 0], [1.5, 0, 0]], 7)}, False),
        ({(8, "translation"): track([[0.0, 0, 0], [1, 0, 0]], 8)}, False),  # of another node
        ({(7, "scale"): track([[0.0, 0, 0], [1, 0, 0]], 7, "scale")}, False),
        ({(7, "translation"): track([[0.0, 0], [1, 0]], 7)}, False),
        (
            {(7, "translation"): track([[0.0, 0, 0], [1, 0, 0]], 7), (9, "scale"): MOVES},
            False,
        ),  # more of them
        ({}, False),
    ],
)
def test_animations_are_alike_track_by_track(theirs: Any, same: bool) -> None:
    assert _alike({(1, "translation"): MOVES}, theirs, {1: 7}) is same


def test_a_picture_has_a_size_within_bounds() -> None:
    with pytest.raises(UsageError, match=r"a picture has \d+ to \d+ pixels a side, not 900x1$"):
        DrawOptions(size=(900, 1)).check(())
    with pytest.raises(UsageError, match=r"not 1000000x900$"):
        DrawOptions(size=(1_000_000, 900)).check(())
    DrawOptions(size=(900, 800)).check(())
