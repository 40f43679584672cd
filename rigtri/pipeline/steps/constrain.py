"""The step constrain"""

from __future__ import annotations

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.constrain.constrain import ConstrainOptions, constrain
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report

_ROTATION_ONLY = {"--rotate-order": "rotate_order", "--joint-orient": "joint_orient"}
_AIM_ONLY = {
    "--aim-axis": "aim_axis",
    "--up-axis": "up_axis",
    "--world-up": "world_up",
    "--up-vector": "up_vector",
    "--up-object": "up_object",
}


def step(request: Request) -> Step:
    """Raises UsageError for options that this kind of constraint gives no meaning to."""
    _check(request)
    skip = tuple(part.strip() for part in request["skip"].split(",")) if request["skip"] else ()

    def applied(rig: Rig, report: Report) -> Rig:
        options = ConstrainOptions(
            kind=request["kind"],
            child=request["child"] or "",
            drivers=tuple(_driver(rig, text) for text in request["drivers"]),
            skip=skip,
            maintain_offset=request["maintain_offset"],
            order=request["rotate_order"],
            joint_orient=request["joint_orient"],
            space=request["space"],
            roll=request["roll_axis"] or "",
            aim=request["aim_axis"],
            up=request["up_axis"],
            world_up=request["world_up"],
            up_vector=request["up_vector"],
            up_object=request["up_object"],
            limb=request["limb"] or None,
            vrm=request["vrm"],
        )
        return constrain(rig, options=options, report=report)

    return applied


def _check(request: Request) -> None:
    kind = request["kind"]
    if kind != "aim":
        request.refuse(_AIM_ONLY, f"means nothing for --type {kind}")
    if kind not in ("parent", "orient", "aim"):
        request.refuse(_ROTATION_ONLY, f"means nothing for --type {kind}, which does not turn its child")
    if request["world_up"] == "none":
        request.refuse({"--up-axis": "up_axis"}, "means nothing with --world-up none")


def _driver(rig: Rig, text: str) -> tuple[str, float]:
    """A node and its weight; a name may hold = itself."""
    name, mark, weight = text.rpartition("=")
    if not mark or rig.has(text):
        return text, 1.0
    try:
        return name, float(weight)
    except ValueError:
        if rig.has(name):
            raise UsageError(f"--driver {text}: '{weight}' is no weight; give a number from 0 on") from None
        return text, 1.0
