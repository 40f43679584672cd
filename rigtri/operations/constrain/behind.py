"""Children of constraints that an edit leaves where what they follow has been: the next bake moves them."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from rigtri.model.constraints import constraints_of
from rigtri.model.rig import Rig
from rigtri.report import Report
from rigtri.text import list_names


def constrained_to(rig: Rig, moved: Collection[int]) -> list[int]:
    """The children of constraints that nodes which move elsewhere than before do not take along."""
    nodes, found = frozenset(moved), list[int]()
    for rule in constraints_of(rig).values():
        own = rig.with_ancestors([rule.child])
        if rule.child not in nodes and any(
            nodes & (rig.with_ancestors([source]) ^ own) - {rule.child} for source in rule.sources
        ):
            found.append(rule.child)
    return sorted({*found})


def warn_keys_behind(rig: Rig, moved: Collection[int], report: Report) -> None:
    """Warn of children of constraints whose keys are of another motion than nodes have now."""
    keyed = {track.node for clip in rig.clips for track in clip.tracks}
    warn_behind(rig, [node for node in constrained_to(rig, moved) if node in keyed], report)


def warn_rest_behind(rig: Rig, moved: Collection[int], report: Report) -> None:
    """Warn of children of constraints that stand where they did, while nodes rest elsewhere now."""
    if behind := constrained_to(rig, moved):
        names = [rig.title(node) for node in behind]
        text = f"{list_names(names)}, which follow by constraints, rest where they did: put them there with"
        report.warn("followers-behind", f"{text} rigtri bake", names=names)


def warn_behind(rig: Rig, nodes: Sequence[int], report: Report) -> None:
    """Warn of nodes whose keys were made of a motion that is another one now."""
    if nodes:
        names = [rig.title(node) for node in nodes]
        text = f"The keys of {list_names(names)} still follow the old motion: update them with rigtri bake"
        report.warn("followers-behind", text, names=names)
