"""Maintain offset: the offsets of constraints with which a child stays where it is at rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.constraint_solver import aim_rotation, lengths_for, nearest_rotation_of, to_parts
from rigtri.maths.matrices import from_frame, identity, inverse, multiply, transform_points
from rigtri.maths.quaternions import IDENTITY, conjugate, to_axes
from rigtri.maths.quaternions import multiply as product
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length, normalise, perpendicular, project
from rigtri.model.constraints import Constraint
from rigtri.model.rig import Rig

# Sine of a limb's bend below which its plane is the rounding of its positions.
_STRAIGHT = 1e-6


def measured(rig: Rig, rule: Constraint, *, keep: bool) -> Constraint:
    """The rule with its offsets, by rule (`rigtri.model.constraints`); without ``keep`` they change nothing.

    Raises GeometryError where the child, its parent or a driver has no frame (a scale of zero).
    """
    local, world = rig.normalised_local, rig.normalised_world
    count = 1 if rule.kind == "aim" else len(rule.drivers)
    offsets = identity(count)
    if keep:
        above = int(rig.parents[rule.child])
        parent = world[above] if above >= 0 else np.eye(4)
        offsets = _offsets(rule, world, local, parent)
    if rule.kind == "aim":
        _check_aim(rig, rule, world)
    lost = ~np.isfinite(offsets).all(axis=(1, 2))
    fine = rule.kind in ("point", "polevector") or np.isfinite(to_parts(local[rule.child]).rotation).all()
    if lost.any() or not fine:
        # Where the child itself has no frame, the first driver is as good as any.
        driver = rule.drivers[int(np.argmax(lost)) if count > 1 else 0]
        raise GeometryError(
            f"'{rig.title(rule.child)}' cannot follow '{rig.title(driver)}': one of "
            "the two, or a node above, has a scale of zero, or numbers that are not finite"
        )
    return replace(rule, offsets=offsets)


def resting_offsets(rig: Rig, rule: Constraint) -> Floats | None:
    """The offsets, (d, 4, 4), with which the child of a rule stays at rest; None where it has none."""
    try:
        return measured(rig, rule, keep=True).offsets
    except GeometryError:
        return None


def offsets_apart(rig: Rig, one: Floats, other: Floats) -> Floats:
    """By how much offsets, (d, 4, 4), differ, (d,): in parts of axes, and of how far the rig goes."""
    off, size = np.abs(one - other), float(np.abs(rig.world[:, 3, :3]).max(initial=0.0))
    return np.asarray(np.maximum(off[:, :3].max(axis=(1, 2)), off[:, 3].max(axis=1) / max(size, 1e-30)))


def _check_aim(rig: Rig, rule: Constraint, world: Floats) -> None:
    """GeometryError where a child stands where it is to aim at."""
    places = world[[rule.child, *rule.drivers], 3, :3]
    size = max(float(np.abs(places).max()), float(np.abs(world[:, 3, :3]).max()))
    if (length(places[1:] - places[0]) <= _STRAIGHT * size).all():
        raise GeometryError(
            f"'{rig.title(rule.child)}' has the position of '{rig.title(rule.drivers[0])}', so it has no "
            "direction to aim in; name another driver"
        )


def offsets_in(rule: Constraint, drivers: Floats, world: Floats, local: Floats, parent: Floats) -> Floats:
    """The offsets, (d, 4, 4), of a rule that compares world matrices, and does not aim, in some pose.

    drivers: (d, 4, 4), in the world; world and local: of the child, parent: of what is above it, (4, 4).
    """
    mine = to_parts(local)
    if rule.kind == "parent":
        return multiply(world, inverse(drivers))
    if rule.kind == "point":
        return _moves(world[3, :3] - drivers[:, 3, :3])
    if rule.kind == "orient":
        own = product(nearest_rotation_of(parent), mine.rotation)
        return _turns(product(conjugate(nearest_rotation_of(drivers)), own))
    sizes = lengths_for(parent, mine) * mine.scale / length(drivers[:, :3, :3])
    return from_frame(np.eye(3) * sizes[:, np.newaxis, :], np.zeros(3))


def _offsets(rule: Constraint, world: Floats, local: Floats, parent: Floats) -> Floats:
    drivers = world[list(rule.drivers)]
    mine = to_parts(local[rule.child])
    if rule.space != "world":
        turns, own = nearest_rotation_of(local[list(rule.drivers)]), mine.rotation
        if rule.space == "local":
            return _turns(product(own, conjugate(turns)))
        return _turns(product(conjugate(turns), own))
    if rule.kind == "aim":
        # Without any weight the offset is that of the drivers' middle.
        weights = rule.weights if rule.weights.any() else np.ones(len(rule.drivers))
        plain = replace(rule, offsets=identity(1), weights=weights)
        up = world[rule.up_object][np.newaxis] if rule.up_object >= 0 else None
        found = aim_rotation(plain, drivers[np.newaxis], parent[np.newaxis], mine, up)
        return _turns(product(conjugate(found), mine.rotation))
    if rule.kind == "polevector":
        return _pole_offsets(rule, world, drivers)
    return offsets_in(rule, drivers, world[rule.child], local[rule.child], parent)


def _pole_offsets(rule: Constraint, world: Floats, drivers: Floats) -> Floats:
    """From each driver to where, about the line from root to end, it lies in the plane of the bend."""
    root, middle, end = (world[joint, 3, :3] for joint in rule.chain)
    bend = perpendicular(middle - root, end - root)
    if not length(bend) > _STRAIGHT * length(end - root):
        return identity(len(drivers))  # a straight limb: the pole stays the only one who knows
    places = drivers[:, 3, :3]
    feet = project(places, root, end)
    poles = feet + normalise(bend) * length(places - feet)[:, np.newaxis]
    return _moves(transform_points(poles, inverse(drivers)))


def _moves(places: Floats) -> Floats:
    return from_frame(to_axes(IDENTITY), places)


def _turns(turns: Floats) -> Floats:
    return from_frame(to_axes(np.atleast_2d(turns)), np.zeros(3))
