"""constrain: a node follows drivers; the constraint is stored as metadata of a node of its own.

Source: "Matrix parent constraint" (article): child_world = offset · driver_world. Offset and
joint orient go together, because the joint orient is taken out of the finished local matrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.errors import GeometryError, UsageError
from rigtri.evaluation.constraint_application import constrained_local
from rigtri.evaluation.constraint_solver import rotate_of, to_parts
from rigtri.evaluation.dependency_graph import ControlCycleError, dependencies, find_cycle
from rigtri.evaluation.rig_space import seen_alone
from rigtri.evaluation.sampling import worlds
from rigtri.evaluation.solver import refuse_cycles
from rigtri.evaluation.timelines import timelines
from rigtri.maths.euler import from_angles
from rigtri.maths.quaternions import IDENTITY, angle_between
from rigtri.maths.vectors import length
from rigtri.model.constraints import (
    Constraint,
    constraint_record,
    constraints_of,
)
from rigtri.model.metadata import ConstraintRecord, ControlRecord, PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import driven_joints, ruled_too
from rigtri.operations.bake.unbaked import refuse_followed
from rigtri.operations.constrain.maintain_offset import measured
from rigtri.operations.constrain.switching import Switching, stored_switching, switching, warn_outdated
from rigtri.operations.constrain.vrm_export import export_node_constraint, remove_node_constraint
from rigtri.operations.constrain.warnings import warn_as_it_is, warn_keyed
from rigtri.operations.constrain.weight_keys import WeightKeys, requested_keys
from rigtri.operations.node_removal import without_nodes
from rigtri.operations.operation import operation
from rigtri.operations.options.constrain import ConstrainOptions as ConstrainOptions
from rigtri.operations.options.constrain import check_weight
from rigtri.operations.rigtri_nodes import add, group, renamed, root_controls, with_record
from rigtri.recognition.limbs import given
from rigtri.recognition.one_character import find_within
from rigtri.report import Report
from rigtri.text import counted

_DEGREE = np.pi / 180.0
Vector = tuple[float, float, float]

# The code of the warning about a constraint that VRM cannot hold.
NOT_VRM = "constraint-not-vrm"


def _refuse_alone(rig: Rig, nodes: frozenset[int], name: str, options: ConstrainOptions) -> None:
    """GeometryError where the offset, or a switch without a jump, was measured from stale keys of others."""
    moments = [None, *(timelines(rig) if options.match else ())]
    refuse_followed(rig, nodes, name, moments, child=find_within(rig, nodes, options.child or "", "node"))


@operation(ConstrainOptions, made_alone=_refuse_alone)
def constrain(rig: Rig, *, options: ConstrainOptions, report: Report) -> Rig:
    """Let a node follow others by a rule that is stored; nothing moves.

    A second run for the same child and kind, or one that sets the same channels, replaces the
    rule. The record goes to ``report.added``.

    Raises NameNotFoundError, UsageError, GeometryError (a cycle; a frame that cannot be measured).
    """
    rig, drivers = _drivers(rig, options)
    constraint = _constraint_of(rig, options, drivers)
    keys = None
    if options.switches:
        keys = requested_keys(rig, constraint, [word for word, _, _ in drivers], options)
    warn_keyed(rig, constraint, report)
    keep, vrm = options.maintain_offset, options.vrm_constraints
    return follow(rig, constraint, keep=keep, vrm=vrm, report=report, keys=keys, match=options.match)


def follow(
    rig: Rig,
    rule: Constraint,
    *,
    keep: bool,
    vrm: bool,
    report: Report,
    keys: Sequence[WeightKeys] | None = None,
    match: bool = False,
) -> Rig:
    """Store a rule whose offsets are still to be measured; see `constrain`.

    keep: with the offset that leaves the child where it is. vrm: also as VRMC_node_constraint. keys: of the
    weights, which only then can have keys in clips. match: the child does not jump at them.
    """
    if ruled_too(rule, driven_joints(rig)):
        raise GeometryError(
            f"pose readers drive '{rig.title(rule.child)}', and a constraint would move the same channels; "
            "constrain a node above it, or leave the channels out with --skip"
        )
    place = _replaced_node(rig, rule, report)
    _refuse_cycles(rig, rule, place)
    seen, above = seen_alone(rig)
    # What reaches beyond the rig's own space is evaluated in the world.
    if not all(rig.is_below(node, top) for node in (rule.child, *rule.sources) for top in above):
        seen = rig
    with np.errstate(all="ignore"):
        rule = measured(seen, rule, keep=keep)
    found = None
    if keys is not None:
        with np.errstate(all="ignore"):
            found = switching(seen, rule, place, keys, match=match)
        rule = found.rule
    warn_as_it_is(rig, rule, found is not None, report)
    stored = _stored(rig, rule, found, place, vrm, report)
    _refuse_unsolvable(rig, stored, rule)
    warn_outdated(rig, stored, place, report)
    return stored


def _drivers(rig: Rig, options: ConstrainOptions) -> tuple[Rig, list[tuple[str, int, float]]]:
    """What the user calls each driver or space, the node and its weight; with the node that is the world."""
    if not options.space:
        pairs = [_driver(rig, one) for one in options.driver]
        return rig, [(name, rig.find(name, "node"), weight) for name, weight in pairs]
    found, child = [], rig.find(options.child or "", "node")
    for number, name in enumerate(options.space):
        if name == "world":
            rig, node = group(rig, child)
        elif name == "root":
            node = _root(rig, child)
        else:
            node = rig.find(name, "node")
        found.append((name, node, 0.0 if number else 1.0))
    return rig, found


def _root(rig: Rig, child: int) -> int:
    """The root control that a child goes with. UsageError where there is none, and for one of several."""
    roots = root_controls(rig, child)
    if len(roots) == 1:
        return roots[0]
    if roots:
        names = " or ".join(f"'{rig.title(root)}'" for root in roots)
        raise UsageError(
            f"--space root: '{rig.title(child)}' goes with none of the root controls; name {names}"
        )
    text = "--space root: there is no root control; add one with: rigtri add-controls --root-control"
    raise UsageError(f"{text}, or name a node")


def _child(rig: Rig, options: ConstrainOptions) -> int:
    """The node that follows: of a control that is to be in spaces its offset, so that it keeps its keys."""
    child = rig.find(options.child or "", "node")
    above = int(rig.parents[child])
    control = bool(options.space) and rig.type_of(child) == "control"
    return above if control and above >= 0 and rig.type_of(above) == "offset" else child


def _constraint_of(
    rig: Rig, options: ConstrainOptions, weighted: Sequence[tuple[str, int, float]]
) -> Constraint:
    """The constraint that options describe, with offsets still to be measured."""
    drivers = tuple(node for _, node, _ in weighted)
    chain = _chain(rig, options) if options.type == "polevector" else ()
    child = chain[1] if chain else _child(rig, options)
    if len(set(drivers)) < len(drivers):
        raise UsageError("a driver is named twice; give it once, with the sum of the weights")
    own = to_parts(rig.normalised_local[child]).rotation
    orients: dict[str, Any] = {"rest": own, "none": IDENTITY}
    given = options.joint_orient
    joint_orient = orients[given] if isinstance(given, str) else from_angles(np.array(given) * _DEGREE, "xyz")
    up_vector = options.up_vector or (rig.rules.up if options.world_up == "vector" else options.up_axis)
    return Constraint(
        kind=options.type,
        child=child,
        drivers=drivers,
        weights=np.array([weight for _, _, weight in weighted]),
        offsets=np.zeros((0, 4, 4)),
        skip=options.skipped,
        order=options.rotate_order,
        joint_orient=joint_orient,
        rest=own,
        space="roll" if options.roll_axis else options.driver_space,
        roll=options.roll_axis or "",
        aim=options.aim_axis,
        up=options.up_axis,
        world_up=options.world_up if options.type == "aim" else "none",
        up_vector=up_vector,
        up_object=rig.find(options.up_object, "node") if options.up_object is not None else -1,
        chain=chain,
    )


def _driver(rig: Rig, driver: tuple[str, float] | str) -> tuple[str, float]:
    """A node and its weight; a name may hold = itself."""
    if not isinstance(driver, str):
        return driver
    name, mark, weight = driver.rpartition("=")
    if not mark or rig.has(driver):
        return driver, 1.0
    try:
        found = float(weight)
    except ValueError:
        if rig.has(name):
            words = f"'{weight}' is not a weight; give a number from 0 on"
            raise UsageError(f"--driver {driver}: {words}") from None
        return driver, 1.0
    check_weight(name, found)
    return name, found


def _chain(rig: Rig, options: ConstrainOptions) -> tuple[int, ...]:
    """The limb of a pole vector: named, or the one of an IK control or pole vector that has the child."""
    if options.limb is not None:
        triple = given(rig, *options.limb).triple
        if options.child and rig.find(options.child) not in triple:
            raise UsageError(f"--child {options.child} is not a joint of the limb; leave out --child")
        return triple
    child, chains = rig.find(options.child or "", "node"), set()
    for node, record in (rig.records(ControlRecord) | rig.records(PoleVectorRecord)).items():
        chain = tuple(k for k in map(rig.known, record.chain) if k is not None)
        if len(chain) == 3 and (child == node or child in chain):
            chains.add(chain)
    if len(chains) != 1:
        raise UsageError(
            f"'{rig.title(child)}' is in {counted(len(chains), 'limb') if chains else 'no limb'} with an IK "
            "control or pole vector; name the joints with --limb ROOT MIDDLE END"
        )
    return chains.pop()


def _replaced_node(rig: Rig, rule: Constraint, report: Report) -> int | None:
    """The node of the constraint that this one replaces; None where it is a new one."""
    of_child = {node: old for node, old in constraints_of(rig).items() if old.child == rule.child}
    same = next((node for node, old in of_child.items() if old.kind == rule.kind), None)
    others = [node for node, old in of_child.items() if node != same and old.sets & rule.sets]
    if same is None and len(others) == 1:
        report.warn(
            "constraint-replaced",
            f"'{rig.names[others[0]]}', a {of_child[others[0]].kind} constraint of "
            f"'{rig.title(rule.child)}', set the same channels; the new one takes its place",
        )
        return others[0]
    if others:
        names = ", ".join(f"'{rig.names[node]}'" for node in others)
        raise UsageError(
            f"'{rig.title(rule.child)}' gets the same channels from {names}; leave axes out with --skip, "
            "or strip the file first"
        )
    return same


def _refuse_cycles(rig: Rig, rule: Constraint, place: int | None) -> None:
    """GeometryError where a driver, or the up object, depends on the child."""
    children = rule.chain or (rule.child,)
    before = remove_node_constraint(rig, place) if place is not None else rig
    way = find_cycle(dependencies(before, place), children, rule.sources)
    if way:
        names = " → ".join(f"'{rig.title(node)}'" for node in (way[-1], *way))
        raise GeometryError(
            f"'{rig.title(way[-1])}' cannot follow '{rig.title(way[0])}', which itself depends on it: "
            f"{names} (each depends on the next: as its child, by a constraint, a control or IK)"
        )


def _refuse_unsolvable(before: Rig, after: Rig, rule: Constraint) -> None:
    """GeometryError where a rule leaves no order in which `bake` could work; not for what had none before."""
    try:
        refuse_cycles(after)
    except ControlCycleError as error:
        try:
            refuse_cycles(before)
        except ControlCycleError:
            return
        drivers = ", ".join(f"'{before.title(node)}'" for node in rule.sources)
        raise GeometryError(
            f"'{before.title(rule.child)}' cannot follow {drivers}: controls and constraints would form "
            f"a cycle; {error.path}"
        ) from error


def _stored(
    rig: Rig, rule: Constraint, found: Switching | None, place: int | None, vrm: bool, report: Report
) -> Rig:
    """The rig with the record of the rule, which is reported; found: with weights that can have keys."""
    name = f"con_{rig.names[rule.child] or f'node_{rule.child}'}_{rule.kind}"
    known = rig.node_constraints
    if place is None:
        rig, above = group(rig)
        rig, node = add(rig, name, above, constraint_record(rig, rule))
    else:
        node = place
        if rig.records(ConstraintRecord)[node].kind != rule.kind:
            rig = renamed(rig, node, name)
        rig = remove_node_constraint(rig, node)
    rig, rule, left = stored_switching(rig, node, rule, found)
    record = constraint_record(rig, rule)
    if vrm:
        rig, why, kind = export_node_constraint(rig, rule, known)
        record = replace(record, vrm=kind)
        if kind is None:
            report.warn(
                NOT_VRM,
                f"'{rig.title(rule.child)}': VRMC_node_constraint cannot hold this {rule.kind} constraint "
                f"({why}); it is stored in extras alone",
            )
    rig = with_record(rig, node, record)
    report.added.append(_record(rig, rule, node, record.vrm, found))
    return without_nodes(rig, left, ()) if left else rig


def _record(
    rig: Rig, rule: Constraint, node: int, vrm: str | None, switched: Switching | None
) -> dict[str, Any]:
    base = [not clip for clip in switched.clips] if switched else [True] * len(rule.drivers)
    record: dict[str, Any] = {
        "node": rig.names[node],
        "type": "constraint",
        "kind": rule.kind,
        "child": rig.title(rule.child),
        "drivers": {
            rig.title(k): float(weight)
            for k, weight, own in zip(rule.drivers, rule.weights, base, strict=True)
            if own
        },
        "new": rig.keys[node] is None,
        "vrm": vrm,
    }
    if switched is not None:
        record["weight_nodes"] = [rig.title(node) for node in rule.weight_nodes]
        record["weight_keys"] = {keys.timeline.name: len(keys.times) for keys in switched.keys}
    if rule.kind == "polevector":
        return record | {"chain": [rig.title(joint) for joint in rule.chain]}
    local = rig.normalised_local[np.newaxis]
    own = local[:, rule.child]
    with np.errstate(all="ignore"):
        found = constrained_local(rig, rule, worlds(rig, local), local, own)
        parts, mine = to_parts(found[0]), to_parts(own[0])
        turn = angle_between(mine.rotation, parts.rotation)
        angles = rotate_of(rule, parts.rotation) / _DEGREE
    if np.isfinite(angles).all():
        still = replace(rule, order="xyz", joint_orient=IDENTITY)
        record |= {
            "rotateOrder": rule.order,
            "jointOrient": _numbers(rotate_of(still, rule.joint_orient) / _DEGREE),
            "rotate": _numbers(angles),
            "turned": float(turn) / _DEGREE,
        }
    return record | {"moved": float(length(found[0, 3, :3] - own[0, 3, :3]))}


def _numbers(values: Any) -> list[float]:
    return [float(value) + 0.0 for value in values]
