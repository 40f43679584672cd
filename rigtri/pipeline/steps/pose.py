"""The step pose"""

from __future__ import annotations

from rigtri.model.rig import Rig
from rigtri.operations.pose import PoseOptions, take_pose
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report


def asked(request: Request) -> PoseOptions:
    """The options of `take_pose`, and of what prints a pose."""
    return PoseOptions(at=request["at"], evaluate=request["evaluate"])


def step(request: Request) -> Step:
    """A step that makes the pose of one moment the rest pose."""
    options = asked(request)

    def applied(rig: Rig, report: Report) -> Rig:
        return take_pose(rig, options=options, report=report)

    return applied
