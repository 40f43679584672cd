"""What becomes of turns where node constraints compare the axes of joints.

Joints whose frames a constraint compares turn alike or not at all: they take the turn of
the one that leads, a source before what it drives. A constraint that turns or aims
about an axis holds its joint where the new frame has no such axis. All else turns freely.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.node_constraints import alike, axis_fits, axis_straightened
from rigtri.maths.quaternions import IDENTITY, conjugate, multiply, rotates, rotation_angle, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.model.bindings import NodeConstraint
from rigtri.model.rig import Rig
from rigtri.operations.joint_selection import STEADFAST
from rigtri.operations.orient_joints.plan import UNCHANGED, Plan

Policy = Literal["freeze", "error"]


@dataclass
class Bond:
    """Nodes that can only turn alike (−1 is the world), or one that an axis holds.

    tops: those that nothing leads; they come first, and are none where constraints go in a circle.
    """

    nodes: list[int] = field(default_factory=list)
    tops: list[int] = field(default_factory=list)
    constraints: list[NodeConstraint] = field(default_factory=list)


def bonds(rig: Rig, ties: Sequence[NodeConstraint] = ()) -> list[Bond]:
    """Which nodes constraints tie together, and by which constraints; none for what is free.

    ties: more of them than the file has.
    """
    constraints = (*rig.node_constraints, *ties)
    top: dict[int, int] = {}

    def find(node: int) -> int:
        while top.setdefault(node, node) != node:
            top[node] = top[top[node]]
            node = top[node]
        return node

    led = set()
    for constraint in constraints:
        pair = alike(rig, constraint)
        if pair is not None:
            top[find(pair[1])] = find(pair[0])
            led.add(pair[1])
        if constraint.axis.any():
            find(constraint.node)
    found: dict[int, Bond] = {}
    for node in sorted(top, key=lambda node: (node in led, node)):
        bond = found.setdefault(find(node), Bond())
        bond.nodes.append(node)
        if node not in led:
            bond.tops.append(node)
    for constraint in constraints:
        pair = alike(rig, constraint)
        tops = {find(pair[1])} if pair is not None else set()
        tops |= {find(constraint.node)} if constraint.axis.any() else set()
        for one in tops:
            found[one].constraints.append(constraint)
    return list(found.values())


def settle(plan: Plan, turns: Floats, wanted: Iterable[int], policy: Policy) -> Floats:
    """Turns, (n, 4), under which every constraint keeps its meaning; what gave way is reported.

    turns: what each node is to take. wanted: the joints that have a turn of their own.
    Raises GeometryError with the policy ``error`` where a joint would have to give way.
    """
    rig, result = plan.tree.rig, turns.copy()
    own = {rig.frame_of.get(joint, joint) for joint in wanted}
    joints = {rig.frame_of.get(joint, joint): joint for joint in plan.tree.joints}
    held = {node: _held(plan, joint) for node, joint in joints.items()} | dict(rig.rules.fixed)
    # What leads and has no turn of its own does not get one for the sake of what follows it.
    kept = {node: plan.kept.get(joint, "unchanged") for node, joint in joints.items() if node not in own}
    for bond in bonds(rig, plan.ties):
        if own.isdisjoint(bond.nodes):
            continue
        leader = next(node for node in bond.nodes if node in own)
        leads = {node: kept.get(node, "no joint") for node in bond.tops if node not in own}
        turn, why = _common(plan, bond, leader, turns[leader], ChainMap(leads, held))
        gave_way = [k for k in bond.nodes if k in own and _apart(turns[k], turn) > UNCHANGED]
        if gave_way:
            names, because = _names(rig, gave_way), _told(rig, bond)
            lead = f"can only turn as '{rig.title(leader)}' does ({because})"
            text = f"{names} {f'cannot turn: {why} ({because})' if why else lead}"
            if policy == "error":
                raise GeometryError(f"{text}. Leave it out with --exclude, or take --on-constraint freeze.")
            code = "constraint" if any(c.kind != "length" for c in bond.constraints) else "rotation-not-unit"
            plan.report.warn(code, f"{text}.", joint=rig.title(gave_way[0]))
        for node in (node for node in bond.nodes if node >= 0):
            result[node] = turn
            if node in joints and why and node in gave_way:
                plan.kept[joints[node]] = f"{why} ({_told(rig, bond)})"
            elif node in joints and node != leader and rotates(turn):
                plan.kept.pop(joints[node], None)
                plan.follows[joints[node]] = joints[leader]
    return result


def _apart(a: Floats, b: Floats) -> float:
    return float(rotation_angle(multiply(conjugate(a), b)))


def _names(rig: Rig, nodes: Sequence[int]) -> str:
    more = f" and {len(nodes) - 4} more" if len(nodes) > 4 else ""
    return ", ".join(f"'{rig.title(node)}'" for node in nodes[:4]) + more


def _told(rig: Rig, bond: Bond) -> str:
    said = {
        "tail": "'{}' is the end of a swinging chain",
        "length": "rotations of '{}' are not unit, which this format shows",
    }
    words = [
        said.get(c.kind, f"{c.kind} constraint of '{{}}'").format(rig.title(c.node)) for c in bond.constraints
    ]
    return "; ".join(words[:3]) + (" …" if len(words) > 3 else "")


def _held(plan: Plan, joint: int) -> str:
    reason = plan.kept.get(joint, "")
    return reason if reason in STEADFAST else ""


def _common(
    plan: Plan, bond: Bond, leader: int, wanted: Floats, held: Mapping[int, str]
) -> tuple[Floats, str]:
    """The turn, (4,), that all of a bond can take; else identity, and why."""
    rig, scales = plan.tree.rig, plan.scales
    stays = next((node for node in bond.nodes if node < 0 or held.get(node)), None)
    if stays is not None:
        return IDENTITY, f"'{rig.title(stays)}' stays ({held[stays]})" if stays >= 0 else "the world stays"
    turn = wanted
    about = [c for c in bond.constraints if c.axis.any() and c.node in bond.nodes]
    for constraint in about:
        turn = axis_straightened(constraint, turn, UNCHANGED)
    if turn is not wanted:
        turn = plan.quiet(leader, turn)
    for constraint in about:
        if not axis_fits(constraint, turn):
            return IDENTITY, f"the {constraint.kind} axis would be no axis of its new frame"
    for node in bond.nodes:
        if node >= 0 and scales.uneven[node] and not scales.keeps(node, to_axes(turn)):
            return IDENTITY, f"the scale of '{rig.title(node)}' is not uniform"
    for node in (c.node for c in bond.constraints if c.kind == "length" and rotates(turn)):
        if np.ptp(scales.sign[node]):  # its half turn would go into rotations that are not unit
            return IDENTITY, f"the scale of '{rig.title(node)}' mirrors it"
    return turn, ""
