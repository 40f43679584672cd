"""Which prims are rigtri's own: those whose metadata have a type."""

from __future__ import annotations

from rigtri.model.metadata import ADDED
from rigtri.model.rig import Rig


def is_rigtri_prim(rig: Rig, node: int) -> bool:
    """Whether a prim was made by rigtri, so that its transform is rigtri's to set."""
    return "type" in rig.metadata.get(node, {})


def sets_transform(before: Rig, rig: Rig, node: int) -> bool:
    """Whether rigtri may set the transform of a prim: its own, or one that gets back what it had lost."""
    added = rig.type_of(node) in ADDED
    return is_rigtri_prim(before, node) or (added and bool((before.local[node] != rig.local[node]).any()))
