"""Nodes that another file calls otherwise: what names alone would call lost and added."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigtri.model.rig import Rig
from rigtri.verification.compare.correspondence import Correspondence


def renamed(before: Rig, after: Rig, m: Correspondence) -> Correspondence:
    """The matching with partners for nodes that kept their place but not their name.

    A node without partner gets the one of the same key, or the one at its place among
    the children of its parent's partner, where both have as many children and a rest of
    the same kind. Only nodes that nobody else claims are taken.
    """
    node, taken = m.node.copy(), {int(k) for k in (*m.node, *m.shown) if k >= 0}
    keys = {key: k for k, key in enumerate(after.keys) if k not in taken and key is not None}
    roots: list[int] = np.flatnonzero(after.parents < 0).tolist()
    for k in np.flatnonzero(node < 0).tolist():
        parent = int(before.parents[k])
        above = int(node[parent]) if parent >= 0 else -1
        if parent >= 0 and above < 0:
            continue
        siblings = [c for c in (after.children[above] if above >= 0 else roots) if c not in taken]
        mine = [c for c in _siblings(before, parent) if node[c] < 0]
        keyed = keys.get(before.keys[k], -1)
        if keyed in siblings:
            found = keyed
        elif len(mine) == len(siblings):
            found = siblings[mine.index(k)]
        else:
            continue
        if before.is_joint[k] == after.is_joint[found] and len(before.children[k]) == len(
            after.children[found]
        ):
            node[k] = found
            taken.add(found)
    shown = m.shown.copy()
    fresh = (node >= 0) & (m.node < 0) & (before.attachment >= 0)
    for k in np.flatnonzero(fresh).tolist():
        if after.attachment[node[k]] >= 0:
            shown[k] = node[k]
    return replace(m, node=node, shown=shown)


def _siblings(rig: Rig, parent: int) -> list[int]:
    return list(rig.children[parent]) if parent >= 0 else np.flatnonzero(rig.parents < 0).tolist()
