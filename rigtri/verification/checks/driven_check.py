"""What edits by hand may make: controls and twist joints that count from nothing, joints moved by two."""

from __future__ import annotations

from rigtri.errors import GeometryError
from rigtri.evaluation.twist_joints import twist_of
from rigtri.evaluation.zero_pose import COUNTS_FROM_NOTHING, adrift
from rigtri.model.constraints import constraints_of
from rigtri.model.metadata import TwistRecord
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


def check_twist(rig: Rig, rule: str, findings: Findings) -> None:
    """Note twist joints that cannot be evaluated, as where one was parented elsewhere or metadata was copied.

    Names in their metadata that lead nowhere have findings already.
    """
    for node, record in rig.records(TwistRecord).items():
        if not rig.lost_by(record):
            try:
                twist_of(rig, node, record)
            except GeometryError as error:
                findings.add(rule, *title_and_pointer(rig, node), str(error))
