"""The options of pose."""

from __future__ import annotations

from rigtri.model.dataclass import dataclass
from rigtri.model.options import option


@dataclass(frozen=True)
class PoseOptions:
    """Options of pose."""

    at: str = option(
        "rest", metavar="CLIP@TIME", help="The moment, in seconds (USD: time codes), or rest.", group="what"
    )
    evaluate: bool = option(
        True, help="Evaluate the active controls and constraints, or take the joints' own keys."
    )
