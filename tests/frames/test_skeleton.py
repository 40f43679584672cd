"""Reference poses: the one in which positions are taken, and the file's other one."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rigs import chain, rig_of

from rigtri.errors import UsageError
from rigtri.frames.skeleton import reference, skeleton
from rigtri.maths.matrices import inverse
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin


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


def waving() -> Rig:
    rig = chain((0, 0, 0), (0, 1, 0), (0, 2, 0))
    moves = Track(1, "translation", "LINEAR", np.array([1.0, 3.0]), np.array([[0.0, 1, 0], [4, 1, 0]]))
    return replace(rig, clips=(Clip("wave", (moves,)), Clip("still", ())))


@pytest.mark.parametrize(("time", "x"), [("1", 0.0), ("2.5", 3.0), ("3", 4.0)])
def test_a_moment_of_a_clip_is_a_pose(time: str, x: float) -> None:
    found = reference(skeleton(waving()), f"wave@{time}")
    assert_allclose(found.world[:, 3, :3], [[0, 0, 0], [x, 1, 0], [x, 2, 0]])


def test_any_moment_of_a_clip_without_keys_is_its_rest_pose() -> None:
    rig = waving()
    assert_allclose(reference(skeleton(rig), "still@7").world, rig.world)


@pytest.mark.parametrize(
    ("pose", "said"),
    [
        ("wave@0.5", "--pose wave@0.5: 'wave' runs from 1 to 3"),
        ("wave@3.5", "--pose wave@3.5: 'wave' runs from 1 to 3"),
        ("wave", "--pose wave: give bind, nodes or CLIP@TIME, e.g. Walk@0.5"),
        ("wave@", "--pose wave@: give bind, nodes or CLIP@TIME"),
        ("wave@inf", "--pose wave@inf: give bind, nodes or CLIP@TIME"),
        ("1.5", "--pose 1.5: give bind, nodes or CLIP@TIME"),
    ],
)
def test_what_is_no_moment_of_a_clip_is_refused(pose: str, said: str) -> None:
    with pytest.raises(UsageError, match=f"^{re.escape(said)}"):
        reference(skeleton(waving()), pose)


def test_joints_carry_what_they_or_joints_below_them_move_or_hold() -> None:
    names = ["root", "arm", "hand", "sword", "helper", "leg"]
    rig = rig_of(names, [-1, 0, 1, 2, 0, 0], np.eye(6)[:, :3], attachment=np.array([-1, -1, -1, 3, -1, -1]))
    weighted = np.array([False, False, False, False, True])
    skin = Skin(
        "skin", np.array([0, 1, 2, 4, 5]), inverse(rig.world[[0, 1, 2, 4, 5]]), weigh=lambda: weighted
    )
    found = skeleton(replace(rig, skins=(skin,))).carries
    assert [name for name, carries in zip(names, found, strict=True) if carries] == [
        "root", "arm", "hand", "sword", "leg",
    ]  # fmt: skip
    nothing = replace(
        rig, skins=(replace(skin, weigh=lambda: np.zeros(5, dtype=bool)),), attachment=np.full(6, -1)
    )
    assert skeleton(nothing).carries.all()
