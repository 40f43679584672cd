"""The step add-posereader"""

from __future__ import annotations

import re

from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.posereader import AddPosereaderOptions, Goal, add_posereader
from rigtri.pipeline.steps.request import Request, Step
from rigtri.report import Report

_NAMED = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)=(.*)", re.S)
# Options that only one kind of reader has.
_OF_KIND = {"cone": ("inner", "outer"), "rbf": ("kernel", "mode")}


def step(request: Request) -> Step:
    """Raises UsageError for options of another kind of reader."""
    for kind, names in _OF_KIND.items():
        if request["reader"] != kind:
            for name in names:
                request.refuse({f"--{name}": name}, f"is for --reader {kind}")

    def applied(rig: Rig, report: Report) -> Rig:
        options = AddPosereaderOptions(
            driver=request["driver"],
            axis=request["axis"],
            frame=request["frame"],
            reader=request["reader"],
            targets=tuple(_goal(rig, text) for text in request["targets"]),
            morphs=request["morphs"],
            attributes=request["attributes"],
            inner=request["inner"],
            outer=request["outer"],
            kernel=request["kernel"],
            mode=request["mode"],
            name=request["name"],
            within=request["within"],
            fps=request["fps"],
        )
        return add_posereader(rig, options=options, report=report)

    return applied


def _goal(rig: Rig, text: str) -> Goal:
    """A target from its words; the name of a node that is there wins over all else."""
    name, said = "", text
    if not rig.has(text) and (found := _NAMED.fullmatch(text)):
        name, said = found[1], found[2]
    if rig.has(said):
        return Goal(name, node=said)
    parts = said.split(",")
    if len(parts) == 3:
        try:
            x, y, z = map(float, parts)
            return Goal(name, direction=(x, y, z))
        except ValueError:
            pass
    if said == "rest" or "@" in said:
        return Goal(name, pose=said)
    return Goal(name, node=said)
