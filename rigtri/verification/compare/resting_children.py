"""Constraints of ours at rest: what rested where its constraint holds it still does after an edit.

Viewers do not evaluate them, so no vertex of the file shows it; the next bake would. A child without offsets
is to be where its drivers are, and may leave its rest for that.
"""

from __future__ import annotations

from collections.abc import Iterator, Set

import numpy as np

from rigtri.maths.matrices import identity
from rigtri.model.constraints import Constraint, constraints_of
from rigtri.model.rig import Rig
from rigtri.operations.constrain.maintain_offset import offsets_apart, resting_offsets
from rigtri.verification.compare.correspondence import Correspondence

# What float64 and float32 leave of an offset, and what no rounding makes: of axes, and of the size.
_AT_REST, _ELSEWHERE = 4e-6, 1e-4


def left_their_rest(before: Rig, after: Rig, m: Correspondence, behind: Set[str] = frozenset()) -> list[str]:
    """The children that a constraint would take from where they rest, and did not before, in words.

    behind: those, by their titles, of which the user is told, as their driver was moved on purpose.
    """
    with np.errstate(all="ignore"):
        left = [(now, after.title(now.child)) for now in _left(before, after, m)]
    return [
        f"the {now.kind} constraint of {child} no longer holds it where it rests"
        for now, child in left
        if child not in behind
    ]


def _left(before: Rig, after: Rig, m: Correspondence) -> Iterator[Constraint]:
    there = constraints_of(after)
    for node, rule in constraints_of(before).items():
        now = there.get(int(m.node[node]))
        if now is None or _is_other(rule, now, m) or not (now.offsets - identity(len(now.offsets))).any():
            continue
        if _off(before, rule) <= _AT_REST and _off(after, now) > _ELSEWHERE:
            yield now


def _is_other(rule: Constraint, now: Constraint, m: Correspondence) -> bool:
    """Whether the edit has made another constraint of it."""
    drivers = tuple(int(m.node[driver]) for driver in rule.drivers)
    return (rule.kind, int(m.node[rule.child]), drivers) != (now.kind, now.child, now.drivers)


def _off(rig: Rig, rule: Constraint) -> float:
    """How far an offset is from the one that leaves the child at rest, in parts of axes or of the size."""
    rests = resting_offsets(rig, rule)
    return 0.0 if rests is None else float(offsets_apart(rig, rests, rule.offsets).max())
