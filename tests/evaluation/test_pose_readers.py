"""How much a driver is in each pose that a reader looks for, by hand: dot, cone and radial basis."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from rigtri.evaluation.pose_readers import PoseReader, Target, poses_of, radii, same_poses, twist, weights
from rigtri.maths.matrices import compose
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.metadata import PoseReaderRecord, TargetRecord

X, Y, Z = np.eye(3)
STILL = compose(np.zeros((1, 3)), np.array([[0.0, 0, 0, 1]]), np.ones((1, 3)))


def turn(axis: Floats, degrees: float) -> Floats:
    return from_axis_angle(axis, np.radians(degrees))


def world(*turns: Floats, at: Any = (0.0, 0.0, 0.0), scale: Any = (1.0, 1.0, 1.0)) -> Floats:
    """World matrices, (f, 4, 4)."""
    rows = np.array(turns)
    return compose(np.tile(at, (len(rows), 1)), rows, np.tile(scale, (len(rows), 1)))


def read(reader: PoseReader, *turns: Floats, frame: Floats = STILL) -> list[list[float]]:
    found: list[list[float]] = weights(reader, world(*turns, at=(5, 6, 7)), frame, {}).tolist()
    return found


@pytest.mark.parametrize(("signed", "behind"), [(False, 0.0), (True, -0.5)])
def test_a_dot_reader_is_the_cosine_between_its_axis_and_the_direction(signed: bool, behind: float) -> None:
    reader = PoseReader("dot", 2.0 * X, (Target("x", 3.0 * X), Target("y", Y)), signed=signed)
    found = read(reader, turn(Z, 0), turn(Z, 60), turn(Z, 120))
    half = np.sqrt(0.75)
    assert_allclose(found, [[1, 0], [0.5, half], [behind, half]], atol=1e-12)
    # Seen from a frame, and without its scale.
    frame = world(turn(Z, 60), scale=(2.0, 3.0, 4.0))
    assert_allclose(read(reader, turn(Z, 60), frame=frame), [[1, 0]], atol=1e-12)


@pytest.mark.parametrize(("degrees", "weight"), [(0, 1), (9, 1), (20, 0.75), (30, 0.5), (45, 0.125), (60, 0)])
def test_a_cone_is_1_within_its_inner_angle_and_0_from_the_outer_one_on(
    degrees: float, weight: float
) -> None:
    reader = PoseReader("cone", X, (Target("x", X),), np.radians(10), np.radians(50))
    assert_allclose(read(reader, turn(Z, degrees), turn(Y, -degrees)), [[weight], [weight]], atol=1e-12)


@pytest.mark.parametrize(("kind", "weight"), [("dot", np.cos(np.radians(40))), ("cone", 0.6)])
def test_a_reader_points_at_a_node_from_where_the_driver_is(kind: Any, weight: float) -> None:
    reader = PoseReader(kind, X, (Target("ball", node="ball"),), 0.0, np.radians(100))
    nodes = {"ball": world(turn(X, 0), at=(2, 4, 1))}
    found = weights(reader, world(turn(Z, 50), at=(2, 1, 1)), STILL, nodes)
    assert_allclose(found, [[weight]], atol=1e-12)


def test_a_mirrored_driver_points_along_its_own_axis() -> None:
    """Its x axis is behind that of its rotation, which has all axes negated."""
    reader = PoseReader("dot", X, (Target("ball", node="ball"),), signed=True)
    nodes = {"ball": world(turn(X, 0), at=(-3, 0, 0))}
    for scale in ((-1, -1, -1), (-2, 1, 1)):
        found = weights(reader, world(turn(X, 0), scale=scale), STILL, nodes)
        assert_allclose(found, [[1.0]], atol=1e-12)


def test_a_target_without_a_direction_is_an_error_and_a_driver_without_axes_is_in_no_pose() -> None:
    with pytest.raises(ValueError, match="target 'a' has no direction for a dot reader"):
        read(PoseReader("dot", X, (Target("a"),)), turn(X, 0))
    flat = world(turn(X, 0), scale=(0.0, 0.0, 0.0))
    assert weights(PoseReader("dot", X, (Target("a", X),)), flat, STILL, {}).tolist() == [[0.0]]


def poses(*turns: Floats, **more: Any) -> PoseReader:
    return PoseReader("rbf", X, tuple(Target(f"p{k}", rotation=q) for k, q in enumerate(turns)), **more)


def test_weights_of_poses_go_from_one_to_the_other() -> None:
    reader = poses(turn(Z, 0), turn(Z, 90))
    found = read(reader, turn(Z, 0), turn(Z, 30), turn(Z, 90), turn(Z, 120), turn(Z, -90))
    assert_allclose(found, [[1, 0], [2 / 3, 1 / 3], [0, 1], [0, 2 / 3], [0, 0]], atol=1e-9)
    # A swing does not see a roll about the axis.
    assert_allclose(read(reader, multiply(turn(Z, 30), turn(X, 70))), [[2 / 3, 1 / 3]], atol=1e-9)
    assert_allclose(read(poses(turn(Z, 0)), turn(Z, 30)), [[2 / 3]], atol=1e-9)


def test_gaussian_weights_are_untangled_and_sum_to_1_at_most() -> None:
    reader = poses(turn(Z, 0), turn(Z, 90), kernel="gaussian")
    assert_allclose(
        read(reader, turn(Z, 0), turn(Z, 90), turn(Z, 45)), [[1, 0], [0, 1], [0.5, 0.5]], atol=1e-9
    )
    # Half a radius and one and a half away: e^-0.5 and e^-4.5, of poses that see e^-2 of each other.
    near, far, other = np.exp([-0.5, -4.5, -2.0])
    assert_allclose(read(reader, turn(Z, -45)), [[(near - other * far) / (1 - other**2), 0]], atol=1e-9)


def test_a_solution_for_three_poses_swaps_rows_where_it_must() -> None:
    reader = poses(turn(Z, 0), turn(Z, 90), turn(Y, 60), kernel="gaussian")
    assert_allclose(read(reader, turn(Z, 0), turn(Z, 90), turn(Y, 60)), np.eye(3), atol=1e-9)


def test_a_twist_counts_alone_the_shorter_way_round_and_from_rest() -> None:
    reader = poses(turn(X, 0), turn(X, 90), mode="twist")
    assert_allclose(read(reader, multiply(turn(Z, 50), turn(X, 30))), [[2 / 3, 1 / 3]], atol=1e-9)
    around = poses(turn(X, 170), turn(X, -170), mode="twist")
    assert_allclose(read(around, turn(X, 175), turn(X, 180)), [[0.75, 0.25], [0.5, 0.5]], atol=1e-9)
    since = poses(turn(X, 120), turn(X, 210), mode="twist", rest=turn(X, 120))
    assert_allclose(np.degrees(twist(since, turn(X, 150))), 30.0)
    assert_allclose(read(since, turn(X, 150)), [[2 / 3, 1 / 3]], atol=1e-9)
    assert_allclose(np.degrees(twist(replace(reader, axis=3.0 * X), turn(X, 150))), 150.0)


def test_swing_and_twist_count_both() -> None:
    reader = poses(turn(X, 0), turn(Z, 90), mode="both")
    assert_allclose(read(reader, turn(Z, 30)), [[2 / 3, 1 / 3]], atol=1e-9)
    assert read(reader, turn(X, 30))[0][0] == pytest.approx(2 / 3)


def test_each_pose_reaches_to_the_nearest_other() -> None:
    apart = np.array([[0.0, 1.0, 3.0], [1.0, 0.0, 2.0], [3.0, 2.0, 0.0]])
    assert radii(apart).tolist() == [1.0, 1.0, 2.0]
    assert radii(np.zeros((1, 1))).tolist() == [np.pi / 2]


def test_poses_that_are_one_to_the_reader_are_named() -> None:
    turns = turn(Z, 10), turn(Z, 90), multiply(turn(Z, 10), turn(X, 5))
    assert same_poses(poses(*turns)) == ("p0", "p2")
    assert same_poses(poses(*turns, mode="both")) is None
    assert same_poses(poses(*turns[:2], mode="twist")) == ("p0", "p1")
    assert_allclose(poses_of(poses(*turns)), turns)


def record(**more: Any) -> PoseReaderRecord:
    target = TargetRecord(name="up", direction=(0.0, 1.0, 0.0))
    given = {
        "name": "r",
        "driver": "a",
        "frame": "b",
        "axis": (1.0, 0.0, 0.0),
        "reader": "cone",
        "within": 1e-3,
    }
    return PoseReaderRecord(**(given | {"targets": (target,), "outputs": ()} | more))


def test_a_reader_is_what_its_record_says_angles_in_degrees() -> None:
    reader = PoseReader.of_record(record(inner=10.0, outer=50.0, signed=True, rest=(0.0, 0.0, 0.6, 0.8)))
    assert (reader.kind, reader.kernel, reader.mode, reader.signed) == ("cone", "linear", "swing", True)
    assert_allclose(np.degrees([reader.inner, reader.outer]), [10, 50])
    assert reader.rest is not None
    assert reader.rest.tolist() == [0.0, 0.0, 0.6, 0.8]
    (target,) = reader.targets
    assert (target.name, target.rotation, target.node) == ("up", None, "")
    assert target.direction is not None
    assert target.direction.tolist() == [0.0, 1.0, 0.0]
    plain = PoseReader.of_record(record(reader="rbf", kernel="gaussian", mode="both"))
    assert_allclose(np.degrees([plain.inner, plain.outer]), [0, 90])
    assert (plain.kernel, plain.mode, plain.rest, plain.signed) == ("gaussian", "both", None, False)
    assert PoseReader.of_record(record(outer=0.0)).outer == 0.0
