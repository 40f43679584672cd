"""What add-polevector and make-limb share: where a pole vector stands."""

from __future__ import annotations

from typing import Any

from rigtri.errors import UsageError
from rigtri.pipeline.steps.request import Request

REACH = 0.5
# float32 ends at 3e38; squares of distances must still fit.
_FAR = 1e18


def placing(request: Request) -> dict[str, Any]:
    """Options of a pole vector that say its place. UsageError for a place said in two ways."""
    if request["reach"] is not None and request["distance"] is not None:
        raise UsageError("give --reach or --distance, not both")
    if request["distance"] is not None:
        request.refuse({"--reach-of": "reach_of"}, "goes with --reach, not with --distance")
    for name in ("reach", "distance"):
        if request[name] is not None and not request[name] < _FAR:
            raise UsageError(f"--{name} {request[name]:g} is beyond what files can hold")
    return {
        "method": request["method"],
        "from_": request["from_"],
        "reach": REACH if request["reach"] is None else request["reach"],
        "distance": request["distance"],
        "reach_of": request["reach_of"],
        "orientation": request["orientation"],
    }
