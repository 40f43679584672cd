"""What nodes of a rig have to do with each other: limbs with their pole vectors, and what follows what."""

from __future__ import annotations

from collections.abc import Iterator

from rigtri.model.metadata import ConstraintRecord, PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.recognition.limbs import recognise


def limbs(rig: Rig) -> dict[tuple[int, int, int], int]:
    """Root, middle and end of limbs, recognised or with a pole vector; and that, or −1."""
    found = {limb.triple: -1 for limb in recognise(rig)}
    for node, record in sorted(rig.records(PoleVectorRecord).items()):
        known = [joint for joint in map(rig.known, record.chain) if joint is not None]
        if len(known) >= 3 and len(known) == len(record.chain):
            found[known[0], known[1], known[-1]] = node
    return found


def follows(rig: Rig) -> Iterator[tuple[str, int, int]]:
    """Kind of a constraint, what a node follows, and the node: of the file's constraints and of ours."""
    for constraint in rig.node_constraints:
        if constraint.kind != "length" and constraint.source != constraint.node:
            yield constraint.kind, constraint.source, constraint.node
    for record in rig.records(ConstraintRecord).values():
        child = rig.known(record.child)
        for driver in map(rig.known, record.drivers):
            if driver is not None and child is not None and driver != child:
                yield record.kind, driver, child
