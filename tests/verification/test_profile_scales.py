"""Scales of joints that a profile does not allow: the worst is named, and how many there are."""

from __future__ import annotations

from rigs import chain

from rigtri.model.rig import Rig
from rigtri.verification.checks.profile_check import _scale, _uneven


def scaled(*sizes: tuple[float, float, float]) -> Rig:
    rig = chain(*((float(k), 0.0, 0.0) for k in range(len(sizes))))
    rig.scale[:] = sizes
    return rig


def test_sizes_in_the_world_are_those_of_all_joints_above() -> None:
    rig = scaled((1, 1, 1), (2, 2, 2), (1, 1, 0.25), (1, 1, 1))
    ((_, joint, text),) = _scale(rig, [0, 1, 2, 3])
    assert joint == 1
    assert text == "its scale is 2 2 2 in the world, and 3 of 4 joints have another than 1"
    assert not list(_scale(scaled((1, 1, 1), (1, 1, 1)), [0, 1]))
    assert not list(_scale(rig, [0]))
    ((_, joint, _),) = _scale(scaled((1, 1, 1), (0.1, 1, 1), (1, 1, 1)), [0, 1])
    assert joint == 1


def test_scales_of_vrm_are_positive_and_uniform() -> None:
    rig = scaled((1, 1, 1), (3, 3, 3), (1, 1, 1.5), (-2, -2, -2), (1, 2, 1))
    ((_, joint, text),) = _uneven(rig, [0, 1, 2, 3, 4])
    assert joint == 2
    assert text == (
        "its scale is 1 1 1.5, VRM allows positive uniform ones, and 3 of 5 joints have one that is not"
    )
    ((_, joint, text),) = _uneven(rig, [0, 3])
    assert (joint, text.split(",")[0]) == (3, "its scale is -2 -2 -2")
    assert not list(_uneven(rig, [0, 1]))
