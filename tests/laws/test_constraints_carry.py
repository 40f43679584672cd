"""A constraint does in other axes, another size and another scene what it did before."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from places import first
from rigs import rig_of

import rigtri
from rigtri.frames.reframe import reframe
from rigtri.frames.rescale import convert, rescale
from rigtri.maths.matrices import from_frame, multiply
from rigtri.maths.quaternions import from_axis_angle, to_axes, unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.constraints import constraints_of
from rigtri.model.pending_edits import Conversion
from rigtri.model.rig import Rig
from rigtri.operations.pose import PoseOptions, pose_of

NAMES = ["root", "first", "second", "up", "frame", "child", "tip"]
PARENTS = [-1, 0, 0, 0, 0, 4, 5]
TWO = {"child": "child", "driver": (("first", 1.0), ("second", 3.0))}
ONE = {"child": "child", "driver": ("first",)}
FREE: dict[str, Any] = {**ONE, "type": "aim", "aim_axis": (0.0, 0.0, -1.0)}
AIM = FREE | {"up_axis": (1.0, 0.0, 0.0)}

KINDS: dict[str, dict[str, Any]] = {
    "parent": {"type": "parent", **TWO},
    "parent without offsets": {"type": "parent", **TWO, "maintain_offset": False},
    "point": {"type": "point", **TWO},
    "orient": {"type": "orient", **TWO},
    "orient from rest": {"type": "orient", **TWO, "driver_space": "local"},
    "aim at a direction": {**AIM, "up_vector": (0.2, 1.0, 0.3)},
    "aim up at a node": {**AIM, "world_up": "object", "up_object": "up"},
    "aim up as a node turns": {
        **AIM,
        "world_up": "objectrotation",
        "up_object": "up",
        "up_vector": (0.2, 1.0, 0.3),
    },
    "aim without an up": {**FREE, "world_up": "none"},
}


def made(**constraint: Any) -> Rig:
    """A child in a frame beside its drivers, all of which a clip turns and moves."""
    made = np.random.default_rng(11)
    count = len(NAMES)
    rig = rig_of(NAMES, PARENTS, made.normal(size=(count, 3)), unit(made.normal(size=(count, 4))))
    times = np.array([0.0, 1.0])
    tracks = [
        track
        for node in range(count)
        if NAMES[node] not in ("child", "tip")
        for track in (
            Track(
                node, "rotation", "LINEAR", times, unit(rig.rotation[node] + 0.4 * made.normal(size=(2, 4)))
            ),
            Track(node, "translation", "LINEAR", times, rig.translation[node] + made.normal(size=(2, 3))),
        )
    ]
    rig = replace(rig, clips=(Clip("move", tuple(tracks)),))
    return rigtri.constrain(rig, **constraint)


def worlds(rig: Rig) -> Floats:
    """World matrices of the nodes above at three moments of the clip, (3, n, 4, 4)."""
    posed = [pose_of(rig, PoseOptions(f"move@{time}")) for time in (0.0, 0.4, 1.0)]
    return np.stack([[each.world(rig.find(name))[0] for name in NAMES] for each in posed])


def turns_of(rig: Rig, kind: str) -> Floats:
    """Other axes for each node; the same for all where the constraint compares how nodes have turned."""
    turns = unit(np.random.default_rng(3).normal(size=(len(rig), 4)))
    return np.tile(turns[0], (len(rig), 1)) if kind == "orient from rest" else turns


def moves(rig: Rig) -> bool:
    """Whether the constraint does anything: the child is elsewhere than its own keys have it."""
    free = replace(rig, metadata={})
    return bool(np.abs(worlds(rig) - worlds(free)).max() > 0.1)


@pytest.mark.parametrize("kind", KINDS)
def test_in_other_axes_of_all_nodes_each_stands_as_before(kind: str) -> None:
    rig = made(**KINDS[kind])
    assert moves(rig)
    turns = turns_of(rig, kind)
    out = reframe(rig, turns)
    axes = from_frame(to_axes(turns), np.zeros((len(rig), 3)))[: len(NAMES)]
    assert_allclose(worlds(out), multiply(axes, worlds(rig)), atol=1e-9)


@pytest.mark.parametrize("axis", first(["z", "x", "y"]))
def test_in_other_axes_a_roll_is_about_the_axis_that_this_one_is_now(axis: str) -> None:
    rig = made(type="orient", **ONE, roll_axis=axis)
    assert moves(rig)
    for number in range(3):
        turn = from_axis_angle(np.eye(3)[number], np.pi / 2)
        out = reframe(rig, np.tile(turn, (len(rig), 1)))
        assert_allclose(worlds(out), multiply(from_frame(to_axes(turn), np.zeros(3)), worlds(rig)), atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_in_frames_of_other_sizes_each_is_where_it_was(kind: str) -> None:
    rig = made(**KINDS[kind])
    sizes = np.random.default_rng(5).uniform(0.5, 2.0, len(rig))
    sizes[[*rig.nodes_of("group"), *constraints_of(rig)]] = 1.0
    out = rescale(rig, sizes)
    expected = worlds(rig)
    expected[..., :3, :3] *= sizes[: len(NAMES), np.newaxis, np.newaxis]
    assert_allclose(worlds(out), expected, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_in_another_scene_all_is_turned_and_of_its_unit(kind: str) -> None:
    """From metres with y up to centimetres with z up: what was at (x, y, z) is at 100·(x, −z, y)."""
    rig = made(**KINDS[kind])
    quarter = from_axis_angle(np.array([1.0, 0.0, 0.0]), np.pi / 2)
    out = convert(rig, Conversion("z", 0.01, quarter, 100.0))
    assert_allclose(worlds(out)[..., :3], 100.0 * worlds(rig)[..., [0, 2, 1]] * [1, -1, 1], atol=1e-7)


def test_a_child_of_another_size_takes_the_scale_of_its_driver_all_the_same() -> None:
    rig = made(type="scale", **ONE)
    grown = rig.scale.copy()
    grown[rig.find("first")] = 3.0
    rig = replace(rig, scale=grown)
    assert_allclose(np.linalg.norm(worlds(rig)[:, 5, 0, :3], axis=-1), 3.0)
    sizes = np.ones(len(rig))
    sizes[[1, 5]] = 2.0, 0.5
    expected = worlds(rig)
    expected[..., :3, :3] *= sizes[: len(NAMES), np.newaxis, np.newaxis]
    assert_allclose(worlds(rescale(rig, sizes)), expected, atol=1e-9)
