"""Children of constraints that an edit leaves where what they follow has been: the next bake moves them."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from rigtri.model.constraints import constraints_of
from rigtri.model.rig import Rig
from rigtri.report import Report
from rigtri.text import list_names


def keyed_anew(before: Rig, rig: Rig) -> set[int]:
    """The nodes with keys that ``before`` does not have."""
    known = {id(track) for clip in before.clips for track in clip.tracks}
    return {track.node for clip in rig.clips for track in clip.tracks if id(track) not in known}


def constrained_to(rig: Rig, moved: Collection[int]) -> list[int]:
    """The children of constraints that nodes which move elsewhere than before do not take along."""
    nodes, found = frozenset(moved), set[int]()
    for rule in constraints_of(rig).values():
        own = rig.with_ancestors([rule.child])
        if rule.child not in nodes and any(
            nodes & (rig.with_ancestors([source]) ^ own) - {rule.child} for source in rule.sources
        ):
            found.add(rule.child)
    return sorted(found)


def keys_behind(rig: Rig, moved: Collection[int]) -> list[int]:
    """Those of the same that have keys, which are of another motion than nodes have now."""
    keyed = {track.node for clip in rig.clips for track in clip.tracks}
    return [node for node in constrained_to(rig, moved) if node in keyed]


def warn_keys_behind(before: Rig, rig: Rig, report: Report) -> None:
    """Warn of children of constraints whose keys are of another motion than what they follow has now."""
    warn_behind(rig, keys_behind(rig, keyed_anew(before, rig)), report)


def warn_rest_behind(before: Rig, rig: Rig, report: Report) -> None:
    """Warn of children of constraints that rest where they did, while what they follow rests elsewhere."""
    here, there = (each.local.astype(np.float32) for each in (before, rig))  # as files keep them
    if behind := constrained_to(rig, np.flatnonzero((here != there).any(axis=(1, 2))).tolist()):
        names = [rig.title(node) for node in behind]
        text = f"{list_names(names)}, which follow by constraints, rest where they did: put them there with"
        report.warn("followers-behind", f"{text} rigtri bake", names=names)


def warn_behind(rig: Rig, nodes: Sequence[int], report: Report) -> None:
    """Warn of nodes whose keys were made of a motion that is another one now."""
    if nodes:
        names = [rig.title(node) for node in nodes]
        text = f"The keys of {list_names(names)} still follow the old motion: update them with rigtri bake"
        report.warn("followers-behind", text, names=names)
