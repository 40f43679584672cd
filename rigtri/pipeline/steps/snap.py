"""The step snap"""

from __future__ import annotations

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.snap import SnapOptions, snap
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report


def step(request: Request) -> Step:
    """Raises UsageError where limbs are said twice or not at all."""
    if bool(request["limbs"]) == request["all_limbs"]:
        raise UsageError("give --limb ROOT MIDDLE END, or --all-limbs")
    options = SnapOptions(to=request["to"], at=request["at"], limbs=request["limbs"])

    def applied(rig: Rig, report: Report) -> Rig:
        return snap(rig, options=options, report=report)

    return applied
