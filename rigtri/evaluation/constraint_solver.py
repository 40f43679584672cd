"""Constraints evaluated over all frames at once: matrices first, translation, rotation and scale last.

``f`` is the number of frames, ``d`` of drivers. A driver without a valid frame at some time
(a scale of zero) does not count there; where none is left, or the result is not finite, the child
keeps its own matrix. Nodes hold no shear: of a matrix with shear (a driver whose axes are
stretched unlike) position, nearest rotation and the lengths of the axes are taken.

Source: "Matrix parent constraint" (article); its fault with offset and joint orient does not
arise where the joint orient is taken out of the finished local matrix.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigtri.maths.euler import from_angles, to_angles
from rigtri.maths.matrices import (
    compose,
    handedness,
    inverse,
    multiply,
    nearest_rotation,
    transform_directions,
    transform_points,
)
from rigtri.maths.quaternions import average, between, conjugate, from_axes, half_turn, rotate, to_axes, unit
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, length, normalise
from rigtri.model.constraints import Constraint
from rigtri.model.metadata import ROTATION, SCALE, TRANSLATION

# Sine of the angle between aim and up below which up gives no direction (rounding of float32 positions).
PARALLEL = 1e-6
# Of the numbers' size: a target nearer than this to its child has no direction.
_HERE = 1e-12


class Parts(NamedTuple):
    """Translation (..., 3), rotation xyzw (..., 4) and scale (..., 3) of matrices without shear."""

    translation: Floats
    rotation: Floats
    scale: Floats


def to_parts(m: Floats) -> Parts:
    """The parts of matrices, (..., 4, 4); a mirrored one has three negative scales, NaN for a flat one."""
    sign = handedness(m)[..., np.newaxis]
    # A copy: a part of matrices would keep all of their memory.
    return Parts(m[..., 3, :3].copy("K"), nearest_rotation_of(m), length(m[..., :3, :3]) * sign)


def mirrored_as(parts: Parts, scale: Floats) -> Parts:
    """The same parts with the signs of a scale, (3,), wherever a half turn gives them these."""
    signs = np.sign(parts.scale * scale)
    half = (signs.prod(axis=-1) > 0) & (signs.min(axis=-1) < 0)
    if not half.any():
        return parts
    signs = np.where(half[..., np.newaxis], signs, 1.0)
    return parts._replace(rotation=product(parts.rotation, half_turn(signs)), scale=parts.scale * signs)


def nearest_rotation_of(m: Floats) -> Floats:
    """The rotations nearest to matrices, (..., 4, 4) → xyzw (..., 4); NaN for a flat one."""
    return from_axes(nearest_rotation(m))


def evaluate_constraint(
    rule: Constraint, drivers: Floats, parent: Floats, own: Floats, up: Floats | None = None
) -> Floats:
    """The child's local matrices, (f, 4, 4), of any kind but ``polevector`` (see `constraint_pole`).

    drivers: (f, d, 4, 4), world matrices; in the spaces ``local`` and ``roll`` local ones. parent: the
    world of the child's parent, (f, 4, 4). own: the child's local without the rule, (f, 4, 4).
    up: (f, 4, 4), the world of ``up_object``, where there is one.
    """
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        if rule.kind == "point":
            moved = own.copy()
            moved[..., 3, :3] = _kept(rule, TRANSLATION, own[..., 3, :3], _point(rule, drivers, parent))
            return _finite_or(moved, own)
        mine = to_parts(own)
        found = mine
        if rule.kind == "parent":
            found = _parent(rule, drivers, parent)
        elif rule.kind == "orient":
            found = mine._replace(rotation=_orient(rule, drivers, parent))
        elif rule.kind == "aim":
            found = mine._replace(rotation=aim_rotation(rule, drivers, parent, mine, up))
        elif rule.kind == "scale":
            found = mine._replace(scale=_scale(rule, drivers, parent, mine))
        return _finite_or(compose(*_skipped(rule, mine, found)), own)


def constraint_pole(rule: Constraint, drivers: Floats) -> Floats:
    """The pole of a ``polevector`` rule in the world, (f, 3); NaN where no driver weighs."""
    places = multiply(rule.offsets, drivers)[..., 3, :3]
    return _mean(places, _weights(rule, places))


def rotate_of(rule: Constraint, rotation: Floats) -> Floats:
    """The angles ``rotate`` about x, y, z in radians, (..., 3), of local rotations (..., 4).

    ``rotate · joint_orient`` is the local rotation again.
    """
    return to_angles(product(conjugate(rule.joint_orient), rotation), rule.order)


def _finite_or(found: Floats, own: Floats) -> Floats:
    """What was found where it is numbers, else the child's own."""
    return np.where(np.isfinite(found).all(axis=(-1, -2), keepdims=True), found, own)


def _weights(rule: Constraint, *values: Floats) -> Floats:
    """The drivers' weights, (f, d), 0 where one of the values, (f, d, c), is no number."""
    weights = np.broadcast_to(rule.weights, values[0].shape[:-1])
    for value in values:
        weights = np.where(np.isfinite(value).all(axis=-1), weights, 0.0)
    return weights


def _mean(values: Floats, weights: Floats) -> Floats:
    """Weighted means, (f, d, c) → (f, c); NaN where nothing weighs."""
    total, sum_of = np.zeros(weights.shape[:-1]), np.zeros((*weights.shape[:-1], values.shape[-1]))
    for k in range(weights.shape[-1]):
        share = weights[..., k]
        total = total + share
        live = (share > 0)[..., np.newaxis]
        sum_of = sum_of + np.where(live, share[..., np.newaxis] * values[..., k, :], 0.0)
    return np.asarray(sum_of / np.where(total > 0, total, np.nan)[..., np.newaxis])


def _mean_turn(turns: Floats, weights: Floats) -> Floats:
    """Weighted means of turns, (f, d, 4) → (f, 4); NaN where nothing weighs."""
    live = (weights > 0)[..., np.newaxis]
    mean = average(np.where(live, turns, np.array([0.0, 0.0, 0.0, 1.0])), weights)
    return np.where(live.any(axis=-2), mean, np.nan)


def _parent(rule: Constraint, drivers: Floats, parent: Floats) -> Parts:
    places = multiply(multiply(rule.offsets, drivers), inverse(parent)[..., np.newaxis, :, :])
    each = to_parts(places)
    weights = _weights(rule, *each)
    return Parts(
        _mean(each.translation, weights), _mean_turn(each.rotation, weights), _mean(each.scale, weights)
    )


def _point(rule: Constraint, drivers: Floats, parent: Floats) -> Floats:
    places = drivers[..., 3, :3] + rule.offsets[:, 3, :3]
    return transform_points(_mean(places, _weights(rule, places)), inverse(parent))


def _orient(rule: Constraint, drivers: Floats, parent: Floats) -> Floats:
    offsets, turns = nearest_rotation_of(rule.offsets), nearest_rotation_of(drivers)
    turns = product(offsets, turns) if rule.space == "local" else product(turns, offsets)
    if rule.space == "roll":
        turns = product(rule.rest, twist_about_axis(product(conjugate(rule.rest), turns), rule.roll))
    mean = _mean_turn(turns, _weights(rule, turns))
    return mean if rule.space != "world" else product(conjugate(nearest_rotation_of(parent)), mean)


def twist_about_axis(turns: Floats, axis: str) -> Floats:
    """Of turns, (..., 4), the part about an axis; none where the rest is a half turn."""
    k = "xyz".index(axis)
    part = np.where(np.isin(np.arange(4), (k, 3)), turns, 0.0)
    part = unit(part)
    return np.where(np.isnan(part) & ~np.isnan(turns), np.array([0.0, 0.0, 0.0, 1.0]), part)


def _scale(rule: Constraint, drivers: Floats, parent: Floats, mine: Parts) -> Floats:
    """Axes as long in the world as the drivers', times the offsets' diagonal."""
    ratio = np.stack([rule.offsets[:, k, k] for k in range(3)], axis=-1)
    sizes = length(drivers[..., :3, :3]) * ratio
    target_sizes = _mean(sizes, _weights(rule, sizes))
    return target_sizes / lengths_for(parent, mine)


def lengths_for(parent: Floats, mine: Parts) -> Floats:
    """How long in the world the axes of a node would be with a scale of one, its own signs kept, (..., 3)."""
    rows = transform_directions(to_axes(mine.rotation), parent[..., np.newaxis, :, :])
    return np.where(mine.scale < 0, -1.0, 1.0) * length(rows)


def aim_rotation(rule: Constraint, drivers: Floats, parent: Floats, mine: Parts, up: Floats | None) -> Floats:
    """The child's local rotation, (f, 4), its aim axis at the drivers; its own where they stand in it.

    All in the space of the parent, which also keeps the aim where the parent's axes are stretched.
    """
    back = inverse(parent)
    places = drivers[..., 3, :3]
    target = transform_points(_mean(places, _weights(rule, places)), back)
    way = target - mine.translation
    size = np.maximum(length(target), length(mine.translation))
    aim, top = normalise(rule.aim * mine.scale), normalise(rule.up * mine.scale)
    there = normalise(way)
    found = product(between(rotate(rule.rest, aim), there), rule.rest)
    if rule.world_up != "none":
        above = normalise(_above(rule, back, mine, up))
        framed = product(_frame(there, above), conjugate(_frame(aim, top)))
        sure = length(cross(there, above)) > PARALLEL
        found = np.where(sure[..., np.newaxis], framed, found)
    found = product(found, nearest_rotation_of(rule.offsets[0]))
    return np.where((length(way) <= _HERE * size)[..., np.newaxis], mine.rotation, found)


def _above(rule: Constraint, back: Floats, mine: Parts, up: Floats | None) -> Floats:
    """The direction that up should lean to, (f, 3), seen from the parent."""
    vector = np.asarray(rule.up_vector, dtype=np.float64)
    if rule.world_up == "vector" or up is None:
        return transform_directions(vector, back)
    if rule.world_up == "objectrotation":
        return transform_directions(transform_directions(vector, up), back)
    return transform_points(up[..., 3, :3], back) - mine.translation


def _frame(aim: Floats, up: Floats) -> Floats:
    """The turn, (..., 4), that takes x to ``aim`` and y as near as it can to ``up``."""
    x, z = aim, normalise(cross(aim, up))
    return from_axes(np.stack([x, cross(z, x), z], axis=-2))


def _kept(rule: Constraint, channels: tuple[str, ...], own: Floats, found: Floats) -> Floats:
    return np.where([channel in rule.skip for channel in channels], own, found)


def _skipped(rule: Constraint, mine: Parts, found: Parts) -> Parts:
    """What was found, with the channels that are skipped as the child has them."""
    rotation = found.rotation
    if rule.skip & set(ROTATION):
        angles = _kept(rule, ROTATION, rotate_of(rule, mine.rotation), rotate_of(rule, rotation))
        rotation = product(rule.joint_orient, from_angles(angles, rule.order))
    return Parts(
        _kept(rule, TRANSLATION, mine.translation, found.translation),
        rotation,
        _kept(rule, SCALE, mine.scale, found.scale),
    )
