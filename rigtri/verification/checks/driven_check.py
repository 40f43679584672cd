"""Joints that a pose reader and a constraint both move, which commands refuse and edits by hand may make."""

from __future__ import annotations

from rigtri.model.constraints import constraints_of
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import driven_joints, ruled_too
from rigtri.verification.checks.cycle_check import title_and_pointer
from rigtri.verification.checks.findings import Findings


def check_driven(rig: Rig, rule: str, findings: Findings) -> None:
    """Note constraints that move what pose readers drive; broken metadata has findings of other rules."""
    driven = driven_joints(rig)
    for node, constraint in constraints_of(rig).items():
        if ruled_too(constraint, driven):
            text = f"'{rig.title(constraint.child)}' is driven by a pose reader too"
            findings.add(rule, *title_and_pointer(rig, node), text)
