"""Pose readers (pose-space drivers): how near a joint is to each of some poses, from 0 to 1.

``dot`` and ``cone`` ask how much an axis of the driver points at each target; ``rbf`` weighs
several poses by how near they are. All is seen from a frame, which is the driver's parent
unless another is named, and evaluated for many times at once from metadata.

Source: GDC 2018, slide "PSD node": the dot product of the driver's axis and the direction to
the target.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rigtri.maths.matrices import handedness, unsheared_axes
from rigtri.maths.quaternions import angle_between, conjugate, from_axes, rotate
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats, arc_tangent, exponential
from rigtri.maths.vectors import angle, dot, normalise
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import Kernel, PoseReaderRecord, ReaderKind, ReaderMode

# Poses nearer to each other, in radians, are one: no weights can separate them.
SAME_POSE = 1e-4
# A single pose fades out at a right angle; several at the nearest other.
ALONE = np.pi / 2
# A Gaussian is as wide as lets it fall to e^−2 at its radius.
_FALL = 2.0


@dataclass(frozen=True, eq=False)
class Target:
    """What a reader looks for. name: of its weight. Of the others one is there:

    direction: (3,), seen from the frame, the opposite for a mirrored driver; rotation: xyzw of the
    driver seen from the frame; node: what the axis points at, by its address.
    """

    name: str
    direction: Floats | None = None
    rotation: Floats | None = None
    node: str = ""


@dataclass(frozen=True, eq=False)
class PoseReader:
    """A pose reader. axis: of the driver, (3,). rest: the driver's rotation in the frame at rest.

    signed: a dot reader's weights go down to −1. inner, outer: of a cone, in radians: 1 within inner, 0
    from outer on, straight between.
    """

    kind: ReaderKind
    axis: Floats
    targets: tuple[Target, ...]
    inner: float = 0.0
    outer: float = ALONE
    kernel: Kernel = "linear"
    mode: ReaderMode = "swing"
    rest: Floats | None = None
    signed: bool = False

    @staticmethod
    def of_record(record: PoseReaderRecord) -> PoseReader:
        """The reader that a record describes."""

        def numbers(value: Sequence[float] | None) -> Floats | None:
            return None if value is None else np.array(value, dtype=np.float64)

        degree = float(np.pi) / 180.0
        return PoseReader(
            kind=record.reader,
            axis=np.array(record.axis, dtype=np.float64),
            targets=tuple(
                Target(target.name, numbers(target.direction), numbers(target.rotation), target.node)
                for target in record.targets
            ),
            inner=(record.inner or 0.0) * degree,
            outer=(90.0 if record.outer is None else record.outer) * degree,
            kernel=record.kernel or "linear",
            mode=record.mode or "swing",
            rest=numbers(record.rest),
            signed=record.signed,
        )


def weights(reader: PoseReader, driver: Floats, frame: Floats, nodes: Mapping[str, Floats]) -> Floats:
    """The weight of each target, (f, t), from 0 (signed: −1) to 1; 0 where the driver has no axes.

    driver, frame: world matrices, (f, 4, 4). nodes: those that targets name, by address.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        if reader.kind == "rbf":
            found = _blended(reader, relative(driver, frame))
        else:
            columns = [_pointed(reader, target, driver, frame, nodes) for target in reader.targets]
            found = np.stack(columns, axis=-1)
    return np.where(np.isfinite(found), found, 0.0)


def relative(driver: Floats, frame: Floats) -> Floats:
    """The rotation xyzw, (..., 4), of a driver seen from a frame; scale and mirroring do not count."""
    mine, seen_from = unsheared_axes(driver), unsheared_axes(frame)
    # Rows are axes, so the axes of one along those of the other are dot products.
    along = [dot(mine, seen_from[..., k, np.newaxis, :]) for k in range(3)]
    return from_axes(np.stack(along, axis=-1))


def _pointed(
    reader: PoseReader, target: Target, driver: Floats, frame: Floats, nodes: Mapping[str, Floats]
) -> Floats:
    """How much the axis points at one target, (f,)."""
    points = rotate(from_axes(unsheared_axes(driver)), reader.axis)
    if target.node:
        # The axes of a mirrored driver are negated, which makes them a rotation.
        towards = normalise(nodes[target.node][..., 3, :3] - driver[..., 3, :3])
        towards = towards * handedness(driver)[..., np.newaxis]
    else:
        direction = target.direction
        if direction is None:
            raise ValueError(f"target '{target.name}' has no direction for a {reader.kind} reader")
        towards = rotate(from_axes(unsheared_axes(frame)), normalise(direction))
    if reader.kind == "dot":
        return np.clip(dot(normalise(points), towards), -1.0 if reader.signed else 0.0, 1.0)
    off = angle(points, towards)
    return np.clip((reader.outer - off) / (reader.outer - reader.inner), 0.0, 1.0)


def _blended(reader: PoseReader, rotation: Floats) -> Floats:
    """The weights of poses by radial basis functions, (f, t): 1 at a pose, and then 0 for the others.

    They sum to 1 at most; far from all poses to 0.
    """
    poses = poses_of(reader)
    far = _distances(reader, rotation[..., np.newaxis, :], poses)
    apart = _distances(reader, poses[:, np.newaxis], poses)
    radius = radii(apart)
    found = _kernel(reader, far / radius)
    if reader.kernel == "gaussian":
        # Linear ones end at the nearest pose, so there nothing is left to be untangled.
        found = _solve_rows(_kernel(reader, apart / radius), found)
    found = np.maximum(found, 0.0)
    total = np.zeros(found.shape[:-1])
    for k in range(found.shape[-1]):
        total = total + found[..., k]
    return np.asarray(found / np.maximum(total, 1.0)[..., np.newaxis])


def basis(reader: PoseReader) -> tuple[Floats, Floats | None]:
    """How far each pose of an rbf reader reaches, (t,), in radians; for Gaussian ones also what the values
    at all poses are multiplied by, (t, t), so that each is 1 alone at its own."""
    poses = poses_of(reader)
    apart = _distances(reader, poses[:, np.newaxis], poses)
    radius = radii(apart)
    if reader.kernel == "linear":
        return radius, None
    return radius, _solve_rows(_kernel(reader, apart / radius), np.eye(len(poses)))


def poses_of(reader: PoseReader) -> Floats:
    """The rotations of a reader's targets, (t, 4)."""
    return np.array([target.rotation for target in reader.targets], dtype=np.float64)


def same_poses(reader: PoseReader) -> tuple[str, str] | None:
    """The names of two poses that the reader cannot distinguish; None where there are none."""
    poses = poses_of(reader)
    apart = _distances(reader, poses[:, np.newaxis], poses)
    for row, column in np.argwhere(apart < SAME_POSE).tolist():
        if row < column:
            return reader.targets[row].name, reader.targets[column].name
    return None


def radii(apart: Floats) -> Floats:
    """How far each pose reaches, (t,): to the nearest other. apart: distances, (t, t)."""
    if len(apart) == 1:
        return np.array([ALONE])
    others = np.where(np.eye(len(apart), dtype=bool), np.inf, apart)
    return np.asarray(others.min(axis=1))


def _distances(reader: PoseReader, a: Floats, b: Floats) -> Floats:
    """How far rotations are apart as the reader sees them, in radians."""
    if reader.mode == "swing":
        return angle(rotate(a, reader.axis), rotate(b, reader.axis))
    if reader.mode == "both":
        return angle_between(a, b)
    turn = twist(reader, a) - twist(reader, b)
    return np.abs(turn - 2.0 * np.pi * np.rint(turn / (2.0 * np.pi)))


def twist(reader: PoseReader, rotation: Floats) -> Floats:
    """How far rotations turn about the axis since rest, (...), in radians; 0 at a swing of half a turn."""
    rest = reader.rest if reader.rest is not None else np.array([0.0, 0.0, 0.0, 1.0])
    since = product(conjugate(rest), rotation)
    return 2.0 * arc_tangent(dot(since[..., :3], normalise(reader.axis)), since[..., 3])


def _kernel(reader: PoseReader, share: Floats) -> Floats:
    """The basis function at a distance, as a share of the radius."""
    if reader.kernel == "linear":
        return np.maximum(1.0 - share, 0.0)
    return exponential(-_FALL * share * share)


def _solve_rows(matrix: Floats, rows: Floats) -> Floats:
    """``rows · matrix⁻¹``, (..., t), by elimination with pivots: elementwise, the same bits everywhere."""
    left, right = matrix.T.copy(), np.moveaxis(rows, -1, 0).copy()
    count = len(left)
    for k in range(count):
        pivot = k + int(np.argmax(np.abs(left[k:, k])))
        left[[k, pivot]], right[[k, pivot]] = left[[pivot, k]], right[[pivot, k]]
        for row in range(k + 1, count):
            factor = left[row, k] / left[k, k]
            left[row] = left[row] - factor * left[k]
            right[row] = right[row] - factor * right[k]
    for k in reversed(range(count)):
        for column in range(k + 1, count):
            right[k] = right[k] - left[k, column] * right[column]
        right[k] = right[k] / left[k, k]
    return np.moveaxis(right, 0, -1)
