"""The step strip"""

from __future__ import annotations

from rigtri.ops.strip import Options, strip
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.steps.request import Request, Step


def step(request: Request) -> Step:
    """A step that takes out what rigtri has put in."""
    options = Options(splits=request["splits"])

    def applied(rig: Rig, report: Report) -> Rig:
        return strip(rig, options=options, report=report)

    return applied
