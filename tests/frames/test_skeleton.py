"""Reference poses: the one in which positions are taken, and the file's other one."""

from __future__ import annotations

from dataclasses import replace

import pytest
from numpy.testing import assert_allclose
from rigs import chain

from rigtri.frames.skeleton import reference, skeleton


@pytest.mark.parametrize("pose", [None, "bind", "nodes"])
def test_the_other_pose_is_known_where_it_differs(pose: str | None) -> None:
    rig = chain((0, 0, 0), (0, 1, 0), (0, 2, 0))
    assert reference(skeleton(rig), pose).other is None
    places = rig.translation.copy()
    places[1] += (0.5, 0.0, 0.0)
    moved = replace(rig, translation=places)
    found = reference(skeleton(moved), pose)
    wanted = (moved.world, rig.world) if pose == "nodes" else (rig.world, moved.world)
    assert found.other is not None
    for one, other in zip((found.world, found.other), wanted, strict=True):
        assert_allclose(one[:, 3], other[:, 3], atol=1e-12)
