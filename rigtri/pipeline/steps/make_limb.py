"""The step make-limb"""

from __future__ import annotations

from typing import Any

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import AddPolevectorOptions
from rigtri.operations.axis_presets import PRESETS, AxisStyle
from rigtri.operations.make_limb import MakeLimbOptions, make_limb
from rigtri.pipeline.steps.pole_options import placing
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report

_POLE_ONLY = {
    "--method": "method",
    "--from": "from_",
    "--reach": "reach",
    "--distance": "distance",
    "--reach-of": "reach_of",
    "--orientation": "orientation",
    "--pole-name": "pole_name",
    "--as": "kind",
}


def step(request: Request) -> Step:
    """Raises UsageError for another count than three, and options that contradict each other."""
    options = _options(request)

    def applied(rig: Rig, report: Report) -> Rig:
        return make_limb(rig, options=options, report=report)

    return applied


def _options(request: Request) -> MakeLimbOptions:
    poles = AddPolevectorOptions(**placing(request), name=request["pole_name"], as_=request["kind"])
    if not request["pole"]:
        request.refuse(_POLE_ONLY, "is for the pole vector, and --no-pole leaves it out")
    return MakeLimbOptions(
        locators=request["locators"],
        points=request["points"],
        planar=request["planar"],
        style=_style(request),
        end_aim=_place(request["end_aim"]),
        bend=request["bend"],
        name=request["name"],
        side=request["side"] or "",
        names=request["names"],
        parent=request["parent"],
        skin=request["skin"],
        pole=request["pole"],
        poles=poles,
        pose=request["pose"],
    ).checked()


def _style(request: Request) -> AxisStyle:
    style = PRESETS[request["preset"]] if request["preset"] else AxisStyle()
    axes = {name: request[name] for name in ("aim", "up", "up_from") if request[name] is not None}
    if style.world and axes:
        raise UsageError(
            "--preset vrm: its frames are parallel to the world; leave out --aim, --up, --up-from"
        )
    return AxisStyle(
        **{"aim": style.aim, "up": style.up, "up_from": style.up_from, **axes}, world=style.world
    )


def _place(text: str | None) -> Any:
    """Coordinates as three numbers, anything else as the name of a node."""
    try:
        x, y, z = (float(part) for part in (text or "").split(","))
    except ValueError:
        return text
    return x, y, z
