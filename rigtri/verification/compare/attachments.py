"""What a format stores in the axes of nodes, compared in the world: offsets, directions, constraints.

New axes give all of it new numbers; it means the same where its numbers, seen from the
world at rest, are the same. Verification only.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from rigtri.frames.reoriented_constraints import POINTS, changed_meaning, constraints_from_metadata
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.bindings import Bound
from rigtri.model.rig import Rig
from rigtri.verification.compare.correspondence import Correspondence

# Of their length: what float32 leaves of a vector that was turned.
SAME_VECTOR = 1e-5


def compare_attached(before: Rig, after: Rig, m: Correspondence) -> list[str]:
    """What no longer means the same, in words."""
    if not (before.bound or after.bound or before.node_constraints or after.node_constraints):
        return []
    with np.errstate(all="ignore"):
        # Rotations as the format means them: unit, whatever was stored.
        worlds = before.normalised_world, after.normalised_world
        return [
            *_vectors(before, after, m, worlds),
            *_constraints(before, after, m, worlds),
        ]


def _vectors(before: Rig, after: Rig, m: Correspondence, worlds: tuple[Floats, Floats]) -> Iterator[str]:
    """Vectors by their place in the file; one that is not there is zero."""
    there = {bound.key: bound for bound in after.bound}
    for bound in before.bound:
        now = there.pop(bound.key, None)
        place = f"{_location(bound.key)} of {before.title(bound.node)}"
        if now is not None and int(m.node[bound.node]) != now.node:
            yield f"{place} belongs to {after.title(now.node)} now"
            continue
        was, seen = _seen(bound, worlds[0]), np.zeros(3) if now is None else _seen(now, worlds[1])
        if not _same(was, seen):
            yield f"{place} is {_row(seen)} in the world, was {_row(was)}"
    for now in there.values():
        seen = _seen(now, worlds[1])
        if not _same(np.zeros(3), seen):
            yield f"{_location(now.key)} of {after.title(now.node)} is {_row(seen)} in the world, was none"


def _seen(bound: Bound, world: Floats) -> Floats:
    """The vector in the world; a direction keeps the length that it has in the file."""
    seen = np.asarray(bound.vector @ world[bound.node, :3, :3])
    return seen * (length(bound.vector) / length(seen)) if bound.is_direction else seen


def _same(was: Floats, now: Floats) -> bool:
    size = max(float(length(was)), float(length(now)))
    return bool(length(was - now) <= SAME_VECTOR * size) or bool(np.isnan([was, now]).any(axis=1).all())


def _location(key: Any) -> str:
    """A place in a file in words: its last names and numbers."""
    return " ".join(str(part) for part in key if part != "extensions") if isinstance(key, tuple) else str(key)


def _row(vector: Floats) -> str:
    """Numbers without the noise of a millionth of the largest."""
    least = 1e-6 * float(np.abs(vector).max(initial=0.0))
    return ", ".join(f"{x if abs(x) > least else 0.0:.4g}" for x in vector.tolist())


def _constraints(before: Rig, after: Rig, m: Correspondence, worlds: tuple[Floats, Floats]) -> Iterator[str]:
    """Constraints whose axis points elsewhere or whose nodes turned apart (`frames.node_constraints`)."""
    ours, new = constraints_from_metadata(before), constraints_from_metadata(after)
    axes = nearest_rotation(worlds[0]), nearest_rotation(worlds[1])
    there = {(c.kind, c.node, c.source): c for c in after.node_constraints}
    for c in before.node_constraints:
        if c.kind == "tail":
            continue  # no rule of the file: what is attached there is where points and origins are
        now = there.get((c.kind, int(m.node[c.node]), int(m.node[c.source])))
        title = f"the {c.kind} constraint of {before.title(c.node)}"
        if now is None and ours.get(c.node) == c.kind:
            continue  # exported from a constraint of ours before, and no longer
        if now is None:
            yield f"{title} by {before.title(c.source)} is gone"
        elif change := changed_meaning(before, c, now, m.node, axes):
            yield f"{'the axis of ' if change == POINTS else ''}{title} {change}"

    was = {(c.kind, int(m.node[c.node]), int(m.node[c.source])) for c in before.node_constraints}
    for c in after.node_constraints:
        if c.kind != "tail" and (c.kind, c.node, c.source) not in was and new.get(c.node) != c.kind:
            yield f"the {c.kind} constraint of {after.title(c.node)} by {after.title(c.source)} is new"
