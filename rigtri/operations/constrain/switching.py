"""Drivers between which a child is switched: a node for each weight, keys of it, offsets without a jump.

Where a driver takes over in a clip and the child is to stay where it is then (``--match``), the driver counts
with an offset measured at that time: it stands in the constraint once more, with a weight of its own. So
the child and its keys stay as they are, and what converts offsets converts these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigtri.evaluation.active_controls import controls_at_work, skeleton_size
from rigtri.evaluation.constraint_solver import evaluate_constraint
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.sampling import sorted_unique
from rigtri.evaluation.solver import Solver
from rigtri.evaluation.timelines import put_tracks, timelines
from rigtri.maths.matrices import multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.constraints import Constraint, constraint_of, constraints_of
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import ConstraintRecord, ConstraintWeightRecord
from rigtri.model.rig import Rig
from rigtri.operations.constrain.maintain_offset import offsets_in
from rigtri.operations.constrain.weight_keys import WeightKeys, stored_keys
from rigtri.operations.rigtri_nodes import add, renamed, with_record
from rigtri.report import Report
from rigtri.text import list_names

# Offsets that differ by less, as a share of their numbers, are one: the float32 keys of what is followed.
_SAME_OFFSET = 1e-6
# How far a matched driver may be from where it was, as a share of the size.
_JUMPS = 1e-5


@dataclass(frozen=True, eq=False)
class Switching:
    """A constraint whose weights can have keys. clips: for each driver of the rule, the clip for which it was
    added, or "". keys: with the weights of all of them."""

    rule: Constraint
    clips: tuple[str, ...]
    keys: tuple[WeightKeys, ...]


def switching(
    rig: Rig, rule: Constraint, place: int | None, keys: Sequence[WeightKeys], *, match: bool
) -> Switching:
    """The constraint with keys of weights; with ``match`` without jumps where drivers take over.

    place: the node of the constraint that it replaces. What that one has in other clips stays.
    """
    old = _old(rig, place)
    kept: list[WeightKeys] = []
    if old is not None and (match or len(set(old.drivers)) < len(old.drivers)):
        named = {one.timeline.members for one in keys}
        kept = [one for one in stored_keys(rig, old, rule.drivers) if one.timeline.members not in named]
    plain = Switching(rule, ("",) * len(rule.drivers), (*kept, *keys))
    if not match:
        return plain
    free = (
        rig if place is None else replace(rig, metadata={n: r for n, r in rig.metadata.items() if n != place})
    )
    found = plain
    for number in range(len(plain.keys)):
        found = _matched(free, found, number)
    return found


def _old(rig: Rig, place: int | None) -> Constraint | None:
    old = None if place is None else constraint_of(rig, rig.records(ConstraintRecord)[place])
    return old if old is not None and old.weight_nodes else None


def _matched(rig: Rig, found: Switching, number: int) -> Switching:
    """With offsets by which the child stays where it is when a driver takes over in one of the clips."""
    keys = found.keys[number]
    timeline, count = keys.timeline, keys.weights.shape[1]
    posed = Solver(rig, controls_at_work(rig, timeline)).run(sample_parts(rig, timeline.clip, keys.times))
    rule, clips = found.rule, list(found.clips)
    columns = [keys.weights[:, k].copy() for k in range(count)]
    now = list(range(count))  # which of the rule's drivers each column goes to
    for row in range(len(keys.times)):
        for driver in keys.starts(row, found.rule.weights[:count]):
            before = row - 1 if keys.interpolation == "STEP" else row
            weights = np.array([column[before] for column in columns])
            if row == 0 and keys.weights[0, driver] > 0:  # from the first key on: until then the rest counts
                weights = rule.weights
            offset = _offset(rig, posed, row, replace(rule, weights=weights), rule.drivers[driver])
            same = [
                k
                for k in range(len(clips))
                if rule.drivers[k] == rule.drivers[driver]
                and clips[k] in ("", timeline.name)
                and np.abs(rule.offsets[k] - offset).max()
                <= _SAME_OFFSET * max(1.0, float(np.abs(offset).max()))
            ]
            rest = columns[now[driver]][row:].copy()
            columns[now[driver]][row:] = 0.0
            if not same:
                rule = replace(
                    rule,
                    drivers=(*rule.drivers, rule.drivers[driver]),
                    weights=np.append(rule.weights, 0.0),
                    offsets=np.concatenate([rule.offsets, offset[np.newaxis]]),
                )
                clips.append(timeline.name)
                columns.append(np.zeros(len(keys.times)))
                same = [len(clips) - 1]
            now[driver] = same[0]
            columns[now[driver]][row:] = rest
    own = replace(keys, weights=np.stack(columns, axis=1))
    every = (*found.keys[:number], own, *found.keys[number + 1 :])
    return Switching(rule, tuple(clips), tuple(_wide(each, rule) for each in every))


def _wide(keys: WeightKeys, rule: Constraint) -> WeightKeys:
    """Keys for all drivers of a rule; those added for other clips do not count here."""
    more = len(rule.drivers) - keys.weights.shape[1]
    return replace(keys, weights=np.pad(keys.weights, ((0, 0), (0, more))))


def _offset(rig: Rig, posed: PoseCache, row: int, rule: Constraint, driver: int) -> Floats:
    """From a driver to where the child is at a time by the weights before, (4, 4)."""

    def at(matrices: Floats) -> Floats:
        found: Floats = matrices[min(row, len(matrices) - 1)]
        return found

    above = int(rig.parents[rule.child])
    parent, own = at(posed.world(above)), at(posed.local(rule.child))
    drivers = np.stack([at(posed.world(node)) for node in rule.drivers])
    local = evaluate_constraint(rule, drivers[np.newaxis], parent[np.newaxis], own[np.newaxis])[0]
    one = replace(rule, drivers=(driver,), weights=np.ones(1))
    found: Floats = offsets_in(
        one, at(posed.world(driver))[np.newaxis], multiply(local, parent), local, parent
    )[0]
    return found


def stored_switching(
    rig: Rig, node: int, rule: Constraint, found: Switching | None
) -> tuple[Rig, Constraint, list[int]]:
    """The rig with the weight nodes below the constraint's own, and their keys; the rule that names them; and
    the weight nodes that it had before and needs no more: all where weights can have no keys.

    Nodes of drivers that are gone become those of new ones, which hold their weight: so none is taken out
    of a file as others come.
    """
    known, nodes = _known(rig, node), list[int]()
    if found is None:
        return rig, rule, [each for own in known.values() for each in own]
    records = [
        ConstraintWeightRecord(driver=rig.address(driver), clip=clip)
        for driver, clip in zip(rule.drivers, found.clips, strict=True)
    ]
    kept = [own.pop(0) if (own := known.get((each.driver, each.clip))) else None for each in records]
    left = [each for own in known.values() for each in own]
    for k, (record, at) in enumerate(zip(records, kept, strict=True)):
        driver, child = rule.drivers[k], rig.names[rule.child] or f"node_{rule.child}"
        about = "world" if rig.type_of(driver) == "group" else rig.names[driver]
        if at is None and left:
            at = left.pop(0)
            rig = renamed(_held(rig, at, float(rule.weights[k])), at, f"{child}_weight_{about}")
        elif at is None:
            rig, at = add(rig, f"{child}_weight_{about}", node, record)
        rig = _standing(with_record(rig, at, record), at, float(rule.weights[k]))
        nodes.append(at)
    for keys in found.keys:
        rig = put_tracks(rig, keys.timeline, _tracks(keys, nodes, rule.weights))
    return rig, replace(rule, weight_nodes=tuple(nodes)), left


def warn_outdated(before: Rig, after: Rig, place: int | None, report: Report) -> None:
    """Warn of constraints, but that at a node, whose drivers are elsewhere now where a matched one counts."""
    weights = before.records(ConstraintWeightRecord)
    if not weights:
        return
    size, every = skeleton_size(before), {one.name: one for one in timelines(before)}
    for node, rule in constraints_of(before).items():
        clips = {weights[each].clip for each in rule.weight_nodes if each in weights and node != place}
        names = []
        for timeline in (every[name] for name in sorted(clips) if name in every):
            keys = [track.times for track in timeline.clip.tracks if track.node in rule.weight_nodes]
            times = sorted_unique(np.concatenate([np.zeros(0), *keys]))
            was, now = (
                Solver(rig, controls_at_work(rig, timeline)).run(sample_parts(rig, timeline.clip, times))
                for rig in (before, after)
            )
            apart = np.stack([np.abs(was.world(k) - now.world(k)).max(axis=0) for k in rule.drivers])
            apart[:, 3] /= size
            if apart.max() > _JUMPS:
                names.append(timeline.name)
        if names:
            child = before.title(rule.child)
            text = f"'{child}' may jump in {list_names(names)}: what it was matched with moves otherwise now"
            again = "run its constrain with --match again"
            report.warn("match-outdated", f"{text}; {again}", joint=child)


def _known(rig: Rig, node: int) -> dict[tuple[str, str], list[int]]:
    """The weight nodes below a constraint's node, by driver and clip."""
    known: dict[tuple[str, str], list[int]] = {}
    for each, record in rig.records(ConstraintWeightRecord).items():
        if int(rig.parents[each]) == node:
            known.setdefault((record.driver, record.clip), []).append(each)
    return known


def _held(rig: Rig, node: int, weight: float) -> Rig:
    """The rig whose clips hold a weight where they had keys of another driver's."""
    clips = []
    for clip in rig.clips:
        tracks = tuple(
            replace(each, values=np.tile((weight, 0.0, 0.0), (len(each.times), 1)), interpolation="STEP")
            if each.node == node
            else each
            for each in clip.tracks
        )
        clips.append(replace(clip, tracks=tracks) if node in clip.nodes else clip)
    return replace(rig, clips=tuple(clips))


def _standing(rig: Rig, node: int, weight: float) -> Rig:
    """The rig with a weight node at its weight at rest."""
    if rig.translation[node].tolist() == [np.float32(weight), 0.0, 0.0]:
        return rig
    translation = rig.translation.copy()
    translation[node] = (weight, 0.0, 0.0)
    return replace(rig, translation=translation)


def _tracks(keys: WeightKeys, nodes: Sequence[int], rest: Floats) -> list[Track]:
    found = []
    for k, node in enumerate(nodes):
        values = np.zeros((len(keys.times), 3))
        values[:, 0] = keys.weights[:, k]
        if keys.weights[:, k].any() or rest[k]:
            found.append(Track(node, "translation", keys.interpolation, keys.times, values))
    return found
