"""The step add-polevector"""

from __future__ import annotations

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.orient_joints.up_direction import vector
from rigtri.pipeline.steps.pole_options import placing
from rigtri.pipeline.steps.request import Request, Step
from rigtri.recognition.limbs import given
from rigtri.report import Report


def step(request: Request) -> Step:
    """Raises UsageError for a place said in two ways, and bends that are no directions."""
    place = placing(request)
    if request["bend_joint"] is not None and len(request["chains"]) != 1:
        raise UsageError("--bend-joint goes with exactly one --chain")
    bends = dict(_bend(text) for text in request["bends"])

    def applied(rig: Rig, report: Report) -> Rig:
        options = AddPolevectorOptions(
            **place,
            limbs=tuple(given(rig, *names) for names in request["limbs"]),
            chains=tuple((start, end, request["bend_joint"]) for start, end in request["chains"]),
            auto=request["auto"] == "auto",
            bends=bends,
            facing=request["facing"],
            name=request["name"],
            pose=request["pose"],
            check_clips=request["check_clips"],
            kind=request["kind"],
        )
        return add_polevector(rig, options=options, report=report)

    return applied


def _bend(text: str) -> tuple[str, tuple[float, float, float]]:
    joint, mark, towards = text.rpartition("=")
    if not mark or not joint:
        raise UsageError(f"--bend {text}: give JOINT=X,Y,Z")
    try:
        x, y, z = (float(n) for n in vector(towards))
    except ValueError as error:
        raise UsageError(f"--bend {text}: {error}") from error
    return joint, (x, y, z)
