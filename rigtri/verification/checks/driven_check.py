"""Controls that count from nothing, and joints that two things move, which edits by hand may make."""

from __future__ import annotations

from rigtri.errors import GeometryError
from rigtri.evaluation.zero_pose import COUNTS_FROM_NOTHING, adrift
from rigtri.model.constraints import constraints_of
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import (
    controlled,
    driven_joints,
    in_words,
    ruled_too,
)
from rigtri.verification.checks.cycle_check import title_and_pointer
from rigtri.verification.checks.findings import Findings


def check_driven(rig: Rig, rule: str, findings: Findings) -> None:
    """Note what moves joints as pose readers drive them; broken metadata has findings of other rules."""
    driven = driven_joints(rig)
    for node, constraint in constraints_of(rig).items():
        if ruled_too(constraint, driven):
            text = f"'{rig.title(constraint.child)}' is driven by a pose reader too"
            findings.add(rule, *title_and_pointer(rig, node), text)
    try:
        for joint, control, clip in controlled(rig, driven):
            findings.add(rule, *title_and_pointer(rig, control), in_words(rig, joint, control, clip))
    except GeometryError:
        return  # controls that cannot be evaluated


def check_adrift(rig: Rig, rule: str, findings: Findings) -> None:
    """Note controls without a node above them, which move nothing."""
    for node in adrift(rig):
        findings.add(rule, *title_and_pointer(rig, node), COUNTS_FROM_NOTHING)
