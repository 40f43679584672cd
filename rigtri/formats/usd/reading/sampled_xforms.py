"""Tracks of prims with ops that no track has: Euler angles, matrices, pivots, several of a kind.

They have keys as near to each other as it takes to go USD's way between the samples.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from pxr import Gf, Usd, UsdGeom

from rigtri.evaluation.sampling import sample
from rigtri.formats.usd.composition.time_samples import ops_times
from rigtri.maths.arrays import Booleans
from rigtri.maths.euler import from_angles
from rigtri.maths.matrices import SKEW, compose, decompose, multiply, nearest_rotation, skew
from rigtri.maths.quaternions import angle_between, conjugate, from_axes, from_axis_angle, slerp
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import PATHS, Interpolation, Path, Track
from rigtri.report import Notice

# Between keys a track may be off its prim by so much, in radians and as a share of where it goes: an interval
# is halved until it is nearer, and at most so often.
_ON_WAY, _HALVINGS = 1e-6, 10
# Axes that are further off their rotation, as a share of their length, show in what follows a prim: it is
# the limit of a result.
_SHEARED = 1e-5
# So often is looked between two samples at most: elements go straight there, so shear is smooth.
_LOOKS = 1000
# Where a prim is looked at first between two samples, as a share of the way: no whole number of turns is one.
_ASIDE = 0.381966
# The largest angle from key to key at which tracks are compared halfway: whole turns look like none there.
_QUARTER = 90.0
# What an orient op holds; a blocked sample is None, and a damaged file may hold anything.
_QUATERNIONS = (Gf.Quatd, Gf.Quatf, Gf.Quath)


def sampled_tracks(
    prim: Any, node: int, interpolation: Interpolation, *, scaled: bool = False
) -> list[Track] | None:
    """The tracks of a prim with any ops, by its matrices; None where these are flat, or sheared at samples.

    scaled: a track of scale in any case, not only where an op can scale.

    Between them elements of matrices go straight, which shears and shrinks what turns: tracks move the same
    way, turn as the nearest rotation does, which is the same in other axes, and scale from sample to sample,
    where an op scales at all.
    Euler angles that begin anew at ±180° from one frame to the next go the short way, as they did in the
    program whose exporter has sampled them.
    """
    xformable = UsdGeom.Xformable(prim)

    def parts_at(times: list[float]) -> tuple[tuple[Floats, ...], Booleans] | None:
        """What the matrices are made of, and which are sheared."""
        local = matrices_at(xformable, times)
        if not np.isfinite(local).all():
            return None
        place, turn, size = decompose(local)
        sheared = skew(local) > SKEW
        turn[sheared] = from_axes(nearest_rotation(local[sheared]))
        return ((place, turn, size), sheared) if np.isfinite(turn).all() else None

    samples = times = [float(time) for time in ops_times(xformable)]
    wraps = _wraps(xformable, times)
    if interpolation != "STEP":
        times = _with_quarters(xformable, times, wraps)
    start = parts_at(times)
    if start is None or start[1][np.isin(times, samples)].any():
        return None
    found = start[0]
    for _ in range(_HALVINGS if interpolation != "STEP" and len(times) > 1 else 0):
        between = [(a + b) / 2.0 for a, b in pairwise(times)]
        there = parts_at(between)
        if there is None:
            return None
        (place, turn, size), sheared = there
        tracks = _tracks(node, interpolation, times, found)
        size = np.where(sheared[:, np.newaxis], sample(tracks[-1], between), size)
        now = (place, turn, size)
        off = np.max([_off(t.path, sample(t, between), part) for t, part in zip(tracks, now, strict=True)], 0)
        new = np.flatnonzero((off > _ON_WAY) & ~np.isin(times[:-1], wraps))
        if not len(new):
            break
        order = np.argsort([*times, *(between[k] for k in new)], kind="stable")
        times = np.array([*times, *(between[k] for k in new)])[order].tolist()
        found = tuple(np.concatenate([a, b[new]])[order] for a, b in zip(found, now, strict=True))
    tracks = _thinned(_tracks(node, interpolation, times, found), samples)
    return tracks if scaled or can_scale(xformable) else tracks[:2]


def astray(prims: Sequence[Any], keys: Sequence[Floats], parts: tuple[Floats, ...]) -> list[int]:
    """Which prims leave the way of their tracks between samples farther apart than a frame.

    keys: the samples of each prim; parts: translation, rotation and scale at all of these, (k, c) each.
    """
    looked: list[Floats] = []
    starts, of, first = [], [], 0
    for row, (prim, times) in enumerate(zip(prims, keys, strict=True)):
        way = np.diff(times)
        long = np.flatnonzero(way > _frame(prim.GetStage()) * (1.0 + 1e-6))
        if len(long):
            looked.append(matrices_at(UsdGeom.Xformable(prim), times[long] + _ASIDE * way[long]))
            starts.append(first + long)
            of += [row] * len(long)
        first += len(times)
    if not looked:
        return []
    here = np.concatenate(starts)
    one, other = ([part[rows] for part in parts] for rows in (here, here + 1))
    local = np.concatenate(looked)
    straight = (
        one[0] + (other[0] - one[0]) * _ASIDE,
        slerp(one[1], other[1], np.full(len(here), _ASIDE)),
        one[2] + (other[2] - one[2]) * _ASIDE,
    )
    size = np.abs(local).max(axis=(1, 2), initial=1.0)
    off = np.abs(compose(*straight) - local).max(axis=(1, 2)) / size
    return sorted({of[k] for k in np.flatnonzero(off > _ON_WAY).tolist()})


def matrices_at(xformable: Any, times: Iterable[float]) -> Floats:
    """The matrices of a prim, (f, 4, 4), at time codes. What its orient ops turn goes along arcs.

    UsdGeomXformable bends slow arcs, takes small angles from a cosine, and rounds what lies between samples
    of half floats to half floats (docs/usd.md).
    """
    if not turning_ops(xformable):
        return np.array([xformable.GetLocalTransformation(time) for time in times], dtype=np.float64)
    found = []
    for time in times:
        matrix = Gf.Matrix4d(1.0)
        for op in xformable.GetOrderedXformOps():
            matrix = along_arcs(op, time) * matrix
        found.append(matrix)
    return np.array(found, dtype=np.float64)


def unrounded_matrices(xformable: Any, times: Floats) -> Floats:
    """As `matrices_at`, where USD does not round Euler angles between samples to the type of their op."""
    found = np.broadcast_to(np.eye(4), (len(times), 4, 4))
    for op in xformable.GetOrderedXformOps():
        mine = _turned(op, times)
        if mine is None:
            some = times if op.MightBeTimeVarying() else times[:1]
            mine = np.array([along_arcs(op, time) for time in some.tolist()], dtype=np.float64)
        found = multiply(mine, found)
    return found


def _turned(op: Any, times: Floats) -> Floats | None:
    """The matrices of an op of Euler angles, (f, 4, 4), from its samples; None for others, and where USD has
    no line between these."""
    attribute = op.GetAttr()
    known = np.array(op.GetTimeSamples())
    held = attribute.GetStage().GetInterpolationType() == Usd.InterpolationTypeHeld
    values = [op.Get(time) for time in known.tolist()] if _is_euler(op) and not held else []
    if len(values) < 2 or any(value is None for value in values):
        return None
    rows = np.array([np.ravel(value) for value in values], dtype=np.float64)
    right = np.clip(np.searchsorted(known, times), 1, len(known) - 1)
    share = np.clip((times - known[right - 1]) / (known[right] - known[right - 1]), 0.0, 1.0)[:, np.newaxis]
    rows = np.radians(rows[right - 1] + (rows[right] - rows[right - 1]) * share)
    axes = op.GetAttr().GetName().split(":")[1].removeprefix("rotate")
    if len(axes) == 1:
        turn = from_axis_angle(np.eye(3)["XYZ".index(axes)], rows[:, 0])
    else:
        turn = from_angles(rows, axes.lower())
    turn = conjugate(turn) if op.IsInverseOp() else turn
    return compose(np.zeros((len(times), 3)), turn, np.ones((len(times), 3)))


def turning_ops(xformable: Any) -> list[Any]:
    """The orient ops of a prim that have several samples."""
    kind = UsdGeom.XformOp.TypeOrient
    ops = xformable.GetOrderedXformOps()
    return [op for op in ops if op.GetOpType() == kind and op.GetNumTimeSamples() > 1]


def along_arcs(op: Any, time: float) -> Any:
    """The matrix of an op at a time code; quaternions between two samples lie on their arc."""
    turn = op.Get(time) if op.GetOpType() == UsdGeom.XformOp.TypeOrient else None
    if not isinstance(turn, _QUATERNIONS):
        return op.GetOpTransform(time)
    matrix = Gf.Matrix4d().SetRotate(_arc_of_halves(op, time) or Gf.Quatd(turn).GetNormalized())
    return matrix.GetInverse() if op.IsInverseOp() else matrix


def _arc_of_halves(op: Any, time: float) -> Any:
    """Where the arc between two samples of half floats is at a time code, as a Quatd; None elsewhere."""
    attribute = op.GetAttr()
    held = attribute.GetStage().GetInterpolationType() == Usd.InterpolationTypeHeld
    if held or op.GetPrecision() != UsdGeom.XformOp.PrecisionHalf:
        return None
    start, end = attribute.GetBracketingTimeSamples(time) or (time, time)
    if not start < time < end:
        return None
    one, other = attribute.Get(start), attribute.Get(end)
    if not (isinstance(one, _QUATERNIONS) and isinstance(other, _QUATERNIONS)):
        return None
    sides = (Gf.Quatd(side).GetNormalized() for side in (one, other))
    return Gf.Slerp((time - start) / (end - start), *sides).GetNormalized()


def notice_shear(
    prim: Any, tracks: list[Track], interpolation: Interpolation, warnings: list[Notice]
) -> None:
    """A notice of a prim that is sheared at frames between its samples, as its sampled tracks are not."""
    xformable = UsdGeom.Xformable(prim)
    keys, frame = ops_times(xformable), _frame(prim.GetStage())
    long = [(a, b) for a, b in pairwise(keys) if b - a > frame * (1.0 + 1e-6)]
    frames = [np.arange(a, b, max(frame, (b - a) / _LOOKS))[1:] for a, b in long]
    times = np.concatenate([*frames, np.zeros(0)])
    if interpolation == "STEP" or not len(times):
        return
    local = matrices_at(xformable, times.tolist())
    size = sample(tracks[2], times) if len(tracks) > 2 else np.ones((len(times), 3))
    rigid = compose(sample(tracks[0], times), sample(tracks[1], times), size)
    off, axes = (np.abs(each[:, :3, :3]).max(axis=(1, 2)) for each in (rigid - local, local))
    off /= axes
    if off.max() > _SHEARED:
        text = (
            f"<{prim.GetPath()}> is sheared between its samples, where USD interpolates the elements of its "
            f"matrix, by up to {off.max():.2g} of its axes (at {times[off.argmax()]:g}). What rigtri "
            "evaluates from it, such as what a constraint moves, goes by the nearest rotation there. Give it "
            "a sample at each frame, or xformOp:orient, to have both alike."
        )
        warnings.append(Notice("xform-sheared", text))


def _frame(stage: Any) -> float:
    """Time codes of a frame; 1 where the stage says nothing that could be one."""
    frames = stage.GetFramesPerSecond()
    return float(stage.GetTimeCodesPerSecond() / frames) if frames else 1.0


def can_scale(xformable: Any) -> bool:
    """Whether one of its ops can scale."""
    kinds = (op.GetOpName().split(":")[1] for op in xformable.GetOrderedXformOps())
    return any(kind.startswith(("scale", "transform")) for kind in kinds)


def euler_ops(xformable: Any) -> list[Any]:
    """The ops of a prim that hold Euler angles, one or three."""
    return [op for op in xformable.GetOrderedXformOps() if _is_euler(op) and not op.IsInverseOp()]


def _is_euler(op: Any) -> bool:
    return str(op.GetOpName()).removeprefix("!invert!").startswith("xformOp:rotate")


def _wraps(xformable: Any, times: list[float]) -> Floats:
    """The samples after which Euler angles jump within a frame though what they turn does not, as times (k,).

    One goes more than half a turn, or all of them more than twice as far as to other angles of the same
    rotation. Programs that export angles of each frame by itself write such jumps.
    """
    frame = _frame(xformable.GetPrim().GetStage())
    starts: Floats = np.array(times[:-1])
    found = np.zeros(len(starts), dtype=bool)
    for op in euler_ops(xformable):
        values = [op.Get(time) for time in times]
        if all(value is not None for value in values):
            angles = np.array([np.ravel(value) for value in values], dtype=np.float64)
            way = np.diff(angles, axis=0)
            found |= (np.abs(way) > 180.0).any(axis=1) | _flips(way, angles[1:], op.GetOpName())
    return np.asarray(starts[found & (np.diff(times) <= frame * (1.0 + 1e-6))])


def _with_quarters(xformable: Any, times: list[float], wraps: Floats) -> list[float]:
    """The samples, and times between them from one to the next of which no angle goes more than a quarter."""
    pieces = np.ones(max(len(times) - 1, 0))
    for op in euler_ops(xformable):
        values: list[Any] = [op.Get(time) for time in times]
        if all(value is not None for value in values):
            way = np.abs(np.diff([np.ravel(value) for value in values], axis=0)).max(axis=1)
            pieces = np.maximum(pieces, np.ceil(way / _QUARTER))
    pieces[np.isin(times[:-1], wraps) | ~np.isfinite(pieces)] = 1.0
    count = np.minimum(pieces, _LOOKS).astype(int)
    between = [np.linspace(a, b, n + 1)[1:-1] for (a, b), n in zip(pairwise(times), count, strict=True)]
    return [float(time) for time in np.unique(np.concatenate([times, *between]))]


def _flips(way: Floats, ends: Floats, name: str) -> Booleans:
    """Whether other angles of the same rotation are less than half as far, (k,).

    way: (k, 3), from the sample before to ``ends``, in degrees; of one angle (k, 1), which has none. The
    others have the middle angle from the other side: 180° - b with half a turn more of a and c.
    """
    if way.shape[1] != 3:
        return np.zeros(len(way), dtype=bool)
    middle = "XYZ".index(name.split(":")[1].removeprefix("rotate")[1])
    other = way + 180.0
    other[:, middle] = way[:, middle] + 180.0 - 2.0 * ends[:, middle]
    other -= 360.0 * np.round(other / 360.0)
    short, long = (np.abs(each[:, 0]) + np.abs(each[:, 1]) + np.abs(each[:, 2]) for each in (other, way))
    return np.asarray(short < long / 2.0)


def _tracks(node: int, way: Interpolation, times: list[float], values: tuple[Floats, ...]) -> list[Track]:
    at = np.array(times)
    return [Track(node, path, way, at, each) for path, each in zip(PATHS, values, strict=True)]


def _thinned(tracks: list[Track], samples: Collection[float]) -> list[Track]:
    """The tracks without keys that they do not need: halves that another track was looked at for.

    samples: the times of the prim's own, at which all that moves keeps its keys. What stands still has one
    key, unless everything does.
    """
    moving = [t for t in tracks if _off(t.path, t.values, t.values[:1]).any()]
    own = np.isin(tracks[0].times, [float(time) for time in samples])
    gaps = np.cumsum(own)  # in which gap between samples a key is
    found = []
    for track in tracks:
        line = replace(track, times=track.times[own], values=track.values[own])
        off = _off(track.path, sample(line, track.times), track.values) > _ON_WAY
        kept = own | np.isin(gaps, gaps[off])
        if moving and track not in moving:
            kept = np.arange(len(kept)) == 0
        found.append(replace(track, times=track.times[kept], values=track.values[kept]))
    return found


def _off(path: Path, one: Floats, other: Floats) -> Floats:
    """By how much values, (k, c), differ, (k,): rotations in radians, others as shares of the largest."""
    if path == "rotation":
        return np.asarray(angle_between(one, other))
    return np.asarray(np.abs(one - other).max(axis=1) / max(1.0, float(np.abs(other).max())))
