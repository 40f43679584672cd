"""The step strip"""

from __future__ import annotations

from rigtri.model.rig import Rig
from rigtri.operations.strip import StripOptions, strip
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report


def step(request: Request) -> Step:
    """A step that takes out what rigtri has put in."""
    options = StripOptions(splits=request["splits"])

    def applied(rig: Rig, report: Report) -> Rig:
        return strip(rig, options=options, report=report)

    return applied
