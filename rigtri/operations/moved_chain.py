"""Joints of ours that are built again: what counts from their axes and places is carried along.

New axes are a change of frames (`rigtri.frames.reframe`), by which nothing else moves. New places come after
it: what is below the joints and their controls go along, and what follows them by an offset that was
measured at rest keeps its rest place, as its offset is measured anew.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reframe import reframe
from rigtri.frames.reoriented_constraints import broken
from rigtri.maths.matrices import inverse, nearest_rotation
from rigtri.maths.matrices import multiply as product
from rigtri.maths.quaternions import IDENTITY, angle_between, between, conjugate, from_axes, multiply, rotate
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import normalise
from rigtri.model.constraints import constraint_record, constraints_of
from rigtri.model.metadata import ConstraintRecord, OffsetRecord
from rigtri.model.rig import Rig
from rigtri.operations.constrain.maintain_offset import offsets_apart, resting_offsets
from rigtri.operations.controls_check import apart_in_clips, apart_in_words
from rigtri.operations.rigtri_nodes import stand, with_record
from rigtri.operations.skin_joints import move_joint
from rigtri.report import Report
from rigtri.text import and_more

# Axes and, as a share of the distances here, places that differ by less are what float32 leaves of the same.
_SAME = 4e-6
# Bones that differ by less, as parts of unit vectors, point along the same axis of their joints.
_SAME_BONE = 1e-4


def move_chain(
    rig: Rig,
    joints: Sequence[int],
    places: Floats,
    axes: Floats,
    report: Report,
    rebuilt: Collection[int] = (),
) -> Rig:
    """Put joints of ours, parents first, elsewhere: `move_joint` for each, with all that counts from them.

    places (k, 3) and axes (k, 3, 3): where they stand then, as rows. rebuilt: nodes with constraints that
    are built again after this. Raises GeometryError where a constraint compares own axes that change.
    """
    there = rig
    for joint, place, rows in zip(joints, places, axes, strict=True):
        there = stand(there, joint, place, rows)
    # Where what is above them shears, joints stand a little off the axes that they are given.
    before = _in_axes(rig, joints, there.world[list(joints)], rebuilt)
    rig = before
    for joint, place, rows in zip(joints, places, axes, strict=True):
        rig = move_joint(rig, joint, place, rows)
    return followed_again(before, _controls_along(before, rig), report, rebuilt)


def followed_again(before: Rig, rig: Rig, report: Report, rebuilt: Collection[int] = ()) -> Rig:
    """The rig, nodes of which stand elsewhere than before, with what follows them where it rests.

    Offsets that left a child at rest are measured anew. rebuilt: see `move_chain`.
    """
    rig, changed = _offsets_again(rig, before, rebuilt)
    _tell_followers(before, rig, changed, rebuilt, report)
    return rig


def _in_axes(rig: Rig, joints: Sequence[int], there: Floats, rebuilt: Collection[int]) -> Rig:
    """The rig with the new axes where the joints stand: as the bones' turn to the new places leaves them.

    there: the world matrices, (k, 4, 4), that they get.
    """
    delta = np.tile(IDENTITY, (len(rig), 1))
    for joint, turn in zip(joints, _turns(rig.world[list(joints)], there), strict=True):
        delta[joint] = turn
    if not (delta != IDENTITY).any():
        return rig
    rules = constraints_of(rig)
    children = {rules[node].child for node in rebuilt if node in rules}
    kept = replace(
        rig,
        metadata={node: stored for node, stored in rig.metadata.items() if node not in rebuilt},
        node_constraints=tuple(c for c in rig.node_constraints if c.node not in children),
    )
    names = and_more([rig.title(joint) for joint in joints], 4)
    if lost := broken(kept, delta):
        child = rig.title(lost[0].node)
        raise GeometryError(
            f"What is constrained at '{child}' compares own axes, and {names} would get other ones. "
            "Take that out (rigtri strip), or give the joints the axes that they have"
        )
    if refused := np.flatnonzero(~ScaleTable.of(kept).allows(delta)).tolist():
        raise GeometryError(f"'{rig.title(refused[0])}' would get other axes, and its scale is not uniform")
    turned = reframe(kept, delta)
    if not rebuilt:
        return turned
    stored = {node: rig.metadata[node] for node in rebuilt if node in rig.metadata}
    again = {c.node: c for c in turned.node_constraints}
    tied = tuple(again.get(c.node, c) for c in rig.node_constraints)
    return replace(turned, metadata={**turned.metadata, **stored}, node_constraints=tied)


def _turns(worlds: Floats, there: Floats) -> Floats:
    """The new axes of the joints seen in their old ones, (k, 4), without the turn of their bones."""
    own, new = (from_axes(nearest_rotation(m)) for m in (worlds, there))
    old, places = worlds[:, 3, :3], there[:, 3, :3]
    size = max(float(np.abs(old).max()), float(np.abs(places).max()), 1e-30)
    if np.abs(old - places).max() > _SAME * size:
        was, now = (normalise(points[1:] - points[:-1]) for points in (old, places))
        seen = rotate(conjugate(own[:-1]), was) - rotate(conjugate(new[:-1]), now)
        if np.abs(seen).max() <= _SAME_BONE:
            return np.tile(IDENTITY, (len(there), 1))
        turns = between(was, now)
        own = multiply(np.concatenate([turns, turns[-1:]]), own)
    same = angle_between(own, new) <= _SAME
    return np.where(same[:, np.newaxis], IDENTITY, multiply(conjugate(own), new))


def _controls_along(before: Rig, rig: Rig) -> Rig:
    """The controls of joints that were put elsewhere stand to them as before."""
    for node, record in before.records(OffsetRecord).items():
        joint = before.known(record.joint)
        if joint is None or record.kind == "root" or node in before.below(joint):
            continue
        if np.abs(before.world[joint] - rig.world[joint]).max() <= _SAME * _size(rig):
            continue
        there = product(before.world[node], product(inverse(before.world[joint]), rig.world[joint]))
        put = move_joint if rig.is_joint[node] else stand
        rig = put(rig, node, there[3, :3], nearest_rotation(there))
    return rig


def _offsets_again(rig: Rig, before: Rig, rebuilt: Collection[int]) -> tuple[Rig, list[int]]:
    """The rig with those offsets measured anew that left their children at rest, and no longer do; these."""
    moved, changed = rig, list[int]()
    records, there = moved.records(ConstraintRecord), constraints_of(moved)
    for node, rule in constraints_of(before).items():
        if node in rebuilt or node not in there:
            continue
        rests, now = resting_offsets(before, rule), resting_offsets(moved, there[node])
        if rests is None or now is None:
            continue
        held = offsets_apart(moved, rule.offsets, rests) <= _SAME
        late = held & (offsets_apart(moved, rule.offsets, now) > _SAME)
        new = replace(rule, offsets=np.where(late[:, np.newaxis, np.newaxis], now, rule.offsets))
        local, old = moved.rotation[rule.child], before.rotation[rule.child]
        if (local != old).any():  # what its rotation counts from is how it rests
            new = replace(
                new,
                **{key: local for key in ("rest", "joint_orient") if np.allclose(getattr(rule, key), old)},
            )
        made = constraint_record(moved, new)
        carried = replace(records[node], offsets=made.offsets, rest=made.rest, joint_orient=made.joint_orient)
        rig = with_record(rig, node, carried)
        if late.any():
            changed.append(rule.child)
    return rig, changed


def _tell_followers(
    before: Rig, rig: Rig, changed: Sequence[int], rebuilt: Collection[int], report: Report
) -> None:
    """Warn of what follows joints that were put elsewhere, and say how far it moves otherwise in clips."""
    rules = constraints_of(before)
    held = {rule.child for node, rule in rules.items() if node not in rebuilt}
    apart = np.abs(before.world - rig.world).max(axis=(1, 2)) > _SAME * _size(rig)
    drivers = {driver for node, rule in rules.items() if node not in rebuilt for driver in rule.drivers}
    off = apart_in_clips(before, rig, sorted(held)) if changed or apart[sorted(drivers)].any() else {}
    groups = (
        (
            "offsets-measured-anew",
            list(dict.fromkeys(changed)),
            ("keeps its rest place", "keep their rest places"),
            "offsets to what was put elsewhere are measured anew.",
        ),
        (
            "followers-go-along",
            [child for child in off if child not in changed],
            ("goes along", "go along"),
            "what it is constrained to was put elsewhere, and its offset stays.",
        ),
    )
    for code, nodes, verbs, why in groups:
        if nodes:
            names = and_more([rig.title(node) for node in nodes], 6)
            text = f"{names} {verbs[len(nodes) > 1]}: {why}"
            apart = {node: off[node] for node in nodes if node in off}
            report.warn(code, text + (f" It changes clips: {apart_in_words(rig, apart)}." if apart else ""))


def _size(rig: Rig) -> float:
    """How far what is here stands from the origin."""
    return max(float(np.abs(rig.world[:, 3, :3]).max(initial=0.0)), 1e-30)
