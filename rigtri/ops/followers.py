"""What follows joints and is told by keys: rivets and pose readers, baked anew from their notes."""

from __future__ import annotations

from rigtri.errors import FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.ops import posereader, rivet
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.rules import rules_of


def followers(rig: Rig) -> list[int]:
    """The nodes of pose readers and then of rivets: morph weights move the points that hold rivets."""
    return [
        node
        for kind in ("poseReader", "rivet")
        for node, note in sorted(rig.notes.items())
        if note.get("type") == kind
    ]


def holding(rig: Rig) -> frozenset[int]:
    """The rivets that a constraint looks at, or that hold what it looks at."""
    found = set[int]()
    for rule in rules_of(rig).values():
        for node in rule.sources:
            while node >= 0:
                if rig.notes.get(node, {}).get("type") == "rivet":
                    found.add(node)
                node = int(rig.parents[node])
    return frozenset(found)


def followed(rig: Rig, clips: frozenset[int], report: Report) -> Rig:
    """The rig with rivets and pose readers where joints have them now: at rest, and in ``clips``.

    One that cannot be baked (its mesh is gone, or cannot be read) stays as it is, and is told.
    """
    for node in followers(rig):
        module = posereader if rig.notes[node]["type"] == "poseReader" else rivet
        try:
            rig = module.rebaked(rig, node, clips=clips, report=report)
        except (FileError, GeometryError, NameNotFoundError, UsageError) as error:
            report.warn("follower-kept", f"'{rig.title(node)}' keeps its keys: {error}")
    return rig
