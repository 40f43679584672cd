"""The step mirror"""

from __future__ import annotations

from rigtri.model.rig import Rig
from rigtri.operations.joint_selection import Selection
from rigtri.operations.mirror.mirror import WHAT, MirrorOptions, mirror
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report


def asked(request: Request) -> MirrorOptions:
    """The options of `mirror`, and of what compares both sides."""
    return MirrorOptions(
        mode=request["mode"],
        from_side=request["from_side"],
        plane=request["plane"],
        plane_at=request["plane_at"],
        what=request["what"] or WHAT,
        selection=Selection(joints=request["joints"], below=request["below"], exclude=request["exclude"]),
        pose=request["pose"],
        root=request["root"],
        on_nonuniform_scale=request["on_nonuniform_scale"],
        on_constraint=request["on_constraint"],
        tolerance=request["tolerance"],
    )


def step(request: Request) -> Step:
    """A step that gives one side what the other has."""
    options = asked(request)

    def applied(rig: Rig, report: Report) -> Rig:
        return mirror(rig, options=options, report=report)

    return applied
