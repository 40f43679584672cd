"""Mirroring constraints: created or updated on the other side; nothing moves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation.active_controls import joints_of
from rigtri.evaluation.constraint_solver import to_parts
from rigtri.evaluation.timelines import timelines
from rigtri.frames.mirroring import mirrored_axes, world_rotation
from rigtri.maths.matrices import identity
from rigtri.maths.quaternions import IDENTITY, angle_between, conjugate, from_axes, multiply, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.metadata import ConstraintRecord, ControlRecord, OffsetRecord, PoleVectorRecord, Triple
from rigtri.model.rig import Rig
from rigtri.operations.constrain.constrain import follow
from rigtri.operations.constrain.weight_keys import WeightKeys
from rigtri.operations.controls_check import apart_in_clips, apart_in_words
from rigtri.operations.mirror.counterparts import (
    SAME_NUMBER,
    NotMirroredError,
    direction,
    farthest_joint,
    mirror_each,
    of_side,
    other,
    same_values,
)
from rigtri.operations.options.mirror import MirrorOptions
from rigtri.report import Report
from rigtri.text import and_more


def mirror_constraints(rig: Rig, options: MirrorOptions, report: Report) -> Rig:
    """Let the twins follow as this side does, by offsets that leave them where they are."""
    start, fresh = rig, list[Constraint]()

    def build(rig: Rig, node: int, report: Report) -> Rig:
        rule = constraints_of(rig).get(node)
        mirrored = None if rule is None else _mirrored(rig, rule, options)
        if rule is None or mirrored is None:
            raise NotMirroredError("the other side lacks a node that it is about")
        keep = bool(np.abs(rule.offsets - identity(len(rule.offsets))).max() > SAME_NUMBER)
        vrm = rig.records(ConstraintRecord)[node].vrm is not None
        keys: list[WeightKeys] | None = [] if rule.weight_nodes else None
        built = follow(rig, mirrored, keep=keep, vrm=vrm, report=report, keys=keys)
        same = len(built) == len(rig) and all(
            same_values(stored, built.metadata[k], farthest_joint(rig)) for k, stored in rig.metadata.items()
        )
        if not same:
            _warn_switched(rig, rule, report)
            fresh.append(mirrored)
        return rig if same else built

    rig = mirror_each(rig, of_side(rig, options, ConstraintRecord), "constraint", build, report)
    if fresh and rig.clips and not rig.rules.unread:
        _warn_moved(start, rig, fresh, report)
    return rig


def _warn_moved(before: Rig, rig: Rig, rules: Sequence[Constraint], report: Report) -> None:
    """Warn of clips that new rules change: they overrule keys, or drivers take along what has none there.

    Measured, for keys may move nothing while a rule does, or what it does itself.
    """
    moved = [_moved(before, rule) for rule in rules]
    reach = [each | _joints_below(before, each) for each in moved]
    # What controls are drawn as moves with their keys, and is no motion of the character.
    shown = before.is_joint | (before.attachment >= 0)
    shown[[*before.drawings]] &= before.is_joint[[*before.drawings]]
    apart = apart_in_clips(before, rig, [node for node in sorted(set[int]().union(*reach)) if shown[node]])
    keyed, led = dict[int, list[str]](), list[Constraint]()
    for rule, mine, each in zip(rules, moved, reach, strict=True):
        changed = [k.clip for k in timelines(before) if any(k.name in apart.get(n, ()) for n in each)]
        for clip in changed:
            for node in mine & clip.nodes:
                keyed.setdefault(node, []).append(clip.name)
        if any(mine.isdisjoint(clip.nodes) for clip in changed):
            led.append(rule)
    said = []
    if keyed:
        names = and_more([rig.title(node) for node in sorted(keyed)], 6)
        clips = and_more(dict.fromkeys(clip for every in keyed.values() for clip in every), 6)
        verbs = ("has", "follows") if len(keyed) == 1 else ("have", "follow")
        said.append(f"{names} {verbs[0]} keys in {clips} and {verbs[1]} a constraint from now on")
    if led:
        pairs = [f"'{rig.title(rule.child)}' follows '{rig.title(rule.drivers[0])}'" for rule in led]
        said.append(f"{and_more(pairs, 4)} from now on, also where it has no keys")
    for text in said:
        report.warn(
            "mirror-moves", f"{text}: the next bake gives other motion there, {apart_in_words(rig, apart)}"
        )


def _joints_below(rig: Rig, moved: set[int]) -> set[int]:
    """What is below nodes that a rule moves, and the joints of the controls there with all below them."""
    below = _carried(rig, moved)
    joints = joints_of(rig, moved | below)
    return below.union(joints, *(rig.below(joint) for joint in joints))


def _moved(rig: Rig, rule: Constraint) -> set[int]:
    """The nodes whose keys count otherwise with a rule: what it moves, and what is below that."""
    limbs = {node: record.chain for node, record in rig.records(PoleVectorRecord).items()}
    limbs |= {node: record.chain for node, record in rig.records(ControlRecord).items() if record.chain}
    moved = {rule.child}
    if rule.child in rig.records(OffsetRecord):  # the space of the control below it
        moved.update(rig.children[rule.child])
    # IK moves a limb where its control or its pole vector has keys, wherever the other one is.
    solved = {tuple(map(rig.address, rule.chain)), *(limbs[node] for node in moved if node in limbs)}
    moved.update(node for node, chain in limbs.items() if chain in solved)
    control = rig.records(ControlRecord).get(rule.child)
    if rule.child in limbs:  # from now on IK moves the limb in all clips, whatever keys its joints have
        moved.update(map(rig.find, limbs[rule.child]))
    elif control is not None and (joint := rig.known(control.joint)) is not None:
        moved.add(joint)  # so it is with an FK control and its joint
    if rule.kind != "polevector":  # which bends a limb, and leaves its end where it is
        moved |= _carried(rig, moved)
    return moved


def _carried(rig: Rig, moved: set[int]) -> set[int]:
    """What is below nodes that a rule moves, with the controls of the joints there."""
    below = set[int]().union(*(rig.below(node) for node in moved))
    for node, record in rig.records(ControlRecord).items():
        joints = {rig.known(name) for name in (record.joint, *record.chain) if name}
        if not below.isdisjoint(joints - {None}):
            below |= {node, *rig.below(node)}
    return below


def _warn_switched(rig: Rig, rule: Constraint, report: Report) -> None:
    """Warn of clips in which the weights of a rule have keys: those of the other side stay as at rest."""
    weights = set(rule.weight_nodes)
    clips = [clip.name for clip in rig.clips if any(track.node in weights for track in clip.tracks)]
    if clips:
        child = rig.title(rule.child)
        text = f"what '{child}' follows switches in {and_more(clips, 6)}; its twin follows there as at rest"
        report.warn("mirror-weights", f"{text}: constrain --switch or --weight-keys give it keys, too")


def _mirrored(rig: Rig, rule: Constraint, options: MirrorOptions) -> Constraint | None:
    """The rule of the other side, with offsets still to be measured; None where a node has no twin.

    What it has for single clips stays there: mirroring is about the rest pose.
    """
    first = [k for k, driver in enumerate(rule.drivers) if driver not in rule.drivers[:k]]
    if rule.weight_nodes:
        own = tuple(rule.drivers[k] for k in first)
        rule = replace(rule, drivers=own, weights=rule.weights[first], weight_nodes=())
    child, chain = other(rig, rule.child), [other(rig, node) for node in rule.chain]
    drivers = [other(rig, node) for node in rule.drivers]
    up_object = other(rig, rule.up_object) if rule.up_object >= 0 else -1
    if child is None or up_object is None or None in drivers or None in chain:
        return None
    mirrored = replace(
        rule,
        child=child,
        drivers=tuple(node for node in drivers if node is not None),
        chain=tuple(node for node in chain if node is not None),
        joint_orient=_joint_orient(rig, rule, child, options),
        rest=to_parts(rig.normalised_local[child]).rotation,
        up_object=up_object,
    )
    if rule.kind != "aim":
        return mirrored
    return replace(
        mirrored,
        aim=direction(rig, rule.child, child, rule.aim, options),
        up=direction(rig, rule.child, child, rule.up, options),
        up_vector=_up_vector(rig, rule, up_object, options),
    )


def _up_vector(rig: Rig, rule: Constraint, up_object: int, options: MirrorOptions) -> Triple:
    if rule.world_up == "objectrotation":
        return direction(rig, rule.up_object, up_object, rule.up_vector, options)
    if rule.world_up == "vector":
        x, y, z = (options.across.directions(np.array(rule.up_vector)) + 0.0).tolist()
        return x, y, z
    return rule.up_vector


def _joint_orient(rig: Rig, rule: Constraint, child: int, options: MirrorOptions) -> Floats:
    """The twin's own rest rotation or none, where the rule's is that, else the mirrored one, (4,)."""
    local, given = rig.normalised_local, rule.joint_orient
    if _same(given, IDENTITY):
        return IDENTITY.copy()
    if _same(given, to_parts(local[rule.child]).rotation):
        return to_parts(local[child]).rotation
    here, there = (world_rotation(rig, int(rig.parents[node])) for node in (rule.child, child))
    seen = mirrored_axes(to_axes(multiply(here, given)), options.mode, options.across)
    return multiply(conjugate(there), from_axes(seen))


def _same(one: Floats, two: Floats) -> bool:
    return bool(angle_between(one, two) <= SAME_NUMBER)
