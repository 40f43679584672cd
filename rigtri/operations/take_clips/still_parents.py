"""Nodes between those of both files that only EDITED has, and that never move: it moves without them, too."""

from __future__ import annotations

from collections.abc import Mapping

from rigtri.model.rig import Rig
from rigtri.operations.moved_points import moving_nodes
from rigtri.operations.reparented import reparented, uniform_parts


def without_still_parents(edited: Rig, rig: Rig, of: Mapping[int, int]) -> Rig:
    """EDITED with joints below the parents that they have in RIG, where what is between never moves.

    merge-joints takes such joints out of a character, and clips of others still have them: without them its
    keys are those of RIG, splines and steps as well. of: by node of RIG the one of EDITED.
    """
    tied = {*edited.rules.fixed, *edited.rules.unread, *edited.metadata}
    tied |= {node for each in edited.node_constraints for node in (each.node, each.source)}
    theirs, moving, gone = set(of.values()), None, set[int]()
    for node, other in of.items():
        above = of.get(int(rig.parents[node]), -1)
        if not rig.is_joint[node] or above < 0 or int(edited.parents[other]) == above or other in tied:
            continue
        moving = moving_nodes(edited) if moving is None else moving
        between, at = set[int](), int(edited.parents[other])
        while at >= 0 and at not in theirs and not moving[at] and at not in tied:
            if not tied.isdisjoint(edited.children[at]) or uniform_parts(edited.normalised_local[at]) is None:
                break
            between.add(at)
            at = int(edited.parents[at])
        if at == above:
            gone |= between
    return reparented(edited, gone) if gone else edited
