"""The step add-twist"""

from __future__ import annotations

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.add_twist.twist import AddTwistOptions, add_twist
from rigtri.pipeline.steps.request import Request, Step
from rigtri.recognition.limbs import given
from rigtri.report import Report


def step(request: Request) -> Step:
    """Raises UsageError for bones that are half said, and weights that are no numbers."""
    joints, children = request["joints"], request["children"]
    if len(joints) != len(children):
        raise UsageError(f"{len(joints)} --joint and {len(children)} --to: each bone has one of both")
    if request["most"] and not request["split_weights"]:
        raise UsageError("--max-influences says how --split-weights shares; give both")
    weights = _weights(request["weights"])

    def applied(rig: Rig, report: Report) -> Rig:
        options = AddTwistOptions(
            limbs=tuple(given(rig, *names) for names in request["limbs"]),
            auto=request["auto"] == "auto",
            bones=tuple(zip(joints, children, strict=True)),
            count=request["count"],
            weights=weights,
            upper=request["upper"],
            lower=request["lower"],
            axis=request["axis"],
            split_weights=request["split_weights"],
            most=request["most"],
            keys=request["keys"],
            name=request["name"],
        )
        return add_twist(rig, options=options, report=report)

    return applied


def _weights(text: str | None) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(",")) if text else ()
    except ValueError as error:
        raise UsageError(f"--weights {text}: give numbers with commas between them") from error
