"""The step snap"""

from __future__ import annotations

from rigtri.errors import UsageError
from rigtri.ops.snap import Options, snap
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.steps.request import Request, Step


def step(request: Request) -> Step:
    """Raises UsageError where limbs are said twice or not at all."""
    if bool(request["limbs"]) == request["all_limbs"]:
        raise UsageError("give --limb ROOT MIDDLE END, or --all-limbs")
    options = Options(to=request["to"], at=request["at"], limbs=request["limbs"])

    def applied(rig: Rig, report: Report) -> Rig:
        return snap(rig, options=options, report=report)

    return applied
