"""The policy for joints that node constraints compare: re-orient them alike, or not at all.

Joints whose frames a constraint compares are re-oriented alike or not at all: they take the delta of
the one that leads, a source before what it drives. A constraint that rotates or aims about an axis
holds its joint where the new frame has no such axis. All others are free.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.nonuniform_scale import ScaleTable
from rigtri.frames.reoriented_constraints import axes_compared, axis_fits, axis_straightened, coupled_nodes
from rigtri.maths.disjoint_sets import DisjointSets
from rigtri.maths.quaternions import IDENTITY, angle_between, rotates, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.model.bindings import NodeConstraint
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.joint_selection import STEADFAST
from rigtri.operations.option_kinds import ConstraintPolicy
from rigtri.operations.orient_joints.joint_frames import UNCHANGED, DeadBand
from rigtri.operations.orient_joints.joints_to_orient import Targets
from rigtri.report import Report
from rigtri.text import and_more


@dataclass
class Bond:
    """Nodes that can only take one delta (−1 is the world), or one that an axis holds.

    tops: those that nothing leads; they come first, and are none where constraints form a cycle.
    """

    nodes: list[int] = field(default_factory=list)
    tops: list[int] = field(default_factory=list)
    constraints: list[NodeConstraint] = field(default_factory=list)


def bonds(rig: Rig, ties: Sequence[NodeConstraint] = ()) -> list[Bond]:
    """Which nodes constraints tie together, and by which constraints; none for what is free.

    ties: more of them than the file has.
    """
    constraints = (*axes_compared(rig), *ties)
    tied, led = DisjointSets(), set[int]()
    for constraint in constraints:
        pair = coupled_nodes(rig, constraint)
        if pair is not None:
            tied.join(*pair)
            led.add(pair[1])
        if constraint.axis.any():
            tied.leader(constraint.node)
    found: dict[int, Bond] = {}
    for node in sorted(tied, key=lambda node: (node in led, node)):
        bond = found.setdefault(tied.leader(node), Bond())
        bond.nodes.append(node)
        if node not in led:
            bond.tops.append(node)
    for constraint in constraints:
        pair = coupled_nodes(rig, constraint)
        tops = {tied.leader(pair[1])} if pair is not None else set()
        tops |= {tied.leader(constraint.node)} if constraint.axis.any() else set()
        for one in tops:
            found[one].constraints.append(constraint)
    return list(found.values())


@dataclass(frozen=True, eq=False)
class Constrained:
    """Deltas of nodes, (n, 4), under which every constraint keeps its meaning.

    skipped: why joints keep their axes. follows: the joints that take the delta of another one.
    """

    delta: Floats
    skipped: dict[int, str]
    follows: dict[int, int]


def apply_constraint_policy(
    delta: Floats,
    joints: Iterable[int],
    targets: Targets,
    scales: ScaleTable,
    band: DeadBand,
    ties: Sequence[NodeConstraint],
    *,
    policy: ConstraintPolicy,
    report: Report,
) -> Constrained:
    """What nodes can take of their deltas, (n, 4), for the sake of constraints; what gave way is reported.

    joints: those that have a delta of their own. ties: constraints beside those of the file.
    Raises GeometryError with the policy ``error`` where a joint would have to give way.
    """
    rig, tree = targets.tree.rig, targets.tree
    result = Constrained(delta.copy(), dict(targets.skipped), {})
    own = {rig.frame_of.get(joint, joint) for joint in joints}
    joint_of = {rig.frame_of.get(joint, joint): joint for joint in tree.joints}
    skipped = {node: targets.skipped.get(joint, "") for node, joint in joint_of.items()}
    held = {node: why for node, why in skipped.items() if why in STEADFAST} | dict(rig.rules.fixed)
    # Joints, and what engines attach, count from the axes of controls, offsets, poles and sockets.
    held |= dict.fromkeys(rig.own.difference(joint_of), "rigtri has added it")
    # What leads and has no delta of its own does not get one for the sake of what follows it.
    kept = {node: why or "unchanged" for node, why in skipped.items() if node not in own}
    for bond in bonds(rig, ties):
        if own.isdisjoint(bond.nodes):
            continue
        leader = next(node for node in bond.nodes if node in own)
        leads = {node: kept.get(node, "no joint") for node in bond.tops if node not in own}
        common, why = _common(rig, scales, band, bond, leader, delta[leader], ChainMap(leads, held))
        gave_way = [k for k in bond.nodes if k in own and angle_between(delta[k], common) > UNCHANGED]
        if gave_way:
            _report(rig, bond, leader, gave_way, why, policy, report)
        for node in (node for node in bond.nodes if node >= 0):
            result.delta[node] = common
            if node in joint_of and why and node in gave_way:
                result.skipped[joint_of[node]] = f"{why} ({_names_of_constraints(rig, bond)})"
            elif node in joint_of and node != leader and rotates(common):
                result.skipped.pop(joint_of[node], None)
                result.follows[joint_of[node]] = joint_of[leader]
    return result


def _report(
    rig: Rig, bond: Bond, leader: int, gave_way: list[int], why: str, policy: ConstraintPolicy, report: Report
) -> None:
    names, because = [f"'{rig.title(node)}'" for node in gave_way], _names_of_constraints(rig, bond)
    lead = f"can only be re-oriented as '{rig.title(leader)}' is ({because})"
    text = f"{and_more(names, 4)} {f'cannot be re-oriented: {why} ({because})' if why else lead}"
    if policy == "error":
        raise GeometryError(f"{text}. Leave it out with --exclude, or take --on-constraint freeze.")
    code = "constraint" if any(c.kind != "length" for c in bond.constraints) else "rotation-not-unit"
    report.warn(code, f"{text}.", joint=rig.title(gave_way[0]))


def _names_of_constraints(rig: Rig, bond: Bond) -> str:
    texts = {
        "tail": "'{}' is the end of a swinging chain",
        "length": "rotations of '{}' are not unit, which this format shows",
        "channels": "a constraint is by single channels of '{}'",
        "grown": "a pose reader scales '{}' along its axes",
    }
    names = [
        texts.get(c.kind, f"{c.kind} constraint of '{{}}'").format(rig.title(c.node))
        for c in bond.constraints
    ]
    return "; ".join(names[:3]) + (" …" if len(names) > 3 else "")


def _common(
    rig: Rig,
    scales: ScaleTable,
    band: DeadBand,
    bond: Bond,
    leader: int,
    requested: Floats,
    held: Mapping[int, str],
) -> tuple[Floats, str]:
    """The delta, (4,), that all of a bond can take; else identity, and why."""
    stays = next((node for node in bond.nodes if node < 0 or held.get(node)), None)
    if stays is not None:
        return IDENTITY, f"'{rig.title(stays)}' stays ({held[stays]})" if stays >= 0 else "the world stays"
    delta = requested
    about = [c for c in bond.constraints if c.axis.any() and c.node in bond.nodes]
    for constraint in about:
        delta = axis_straightened(constraint, delta, UNCHANGED)
    if delta is not requested:
        delta = band.apply(delta[np.newaxis], [leader])[0]
    for constraint in about:
        if not axis_fits(constraint, delta):
            return IDENTITY, f"the {constraint.kind} axis would not be an axis of its new frame"
    for node in bond.nodes:
        if node >= 0 and scales.uneven[node] and not scales.keeps(node, to_axes(delta)):
            return IDENTITY, f"the scale of '{rig.title(node)}' is not uniform"
    for node in (c.node for c in bond.constraints if c.kind == "length" and rotates(delta)):
        if np.ptp(scales.sign[node]):  # its half turn would go into rotations that are not unit
            return IDENTITY, f"the scale of '{rig.title(node)}' mirrors it"
    return delta, ""
