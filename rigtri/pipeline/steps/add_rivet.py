"""The step add-rivet"""

from __future__ import annotations

from rigtri.model.rig import Rig
from rigtri.operations.add_rivet.rivet import AddRivetOptions, add_rivet
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report


def step(request: Request) -> Step:
    """A step that ties the rivets that ``request`` describes."""
    options = AddRivetOptions(
        mesh=request["mesh"],
        triangles=request["triangles"],
        barycentric=request["barycentric"],
        at=request["at"],
        vertices=request["vertices"],
        names=request["names"],
        within=request["within"],
        fps=request["fps"],
    )

    def applied(rig: Rig, report: Report) -> Rig:
        return add_rivet(rig, options=options, report=report)

    return applied
