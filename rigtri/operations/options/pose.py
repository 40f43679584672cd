"""The options of pose."""

from __future__ import annotations

from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Moment


@dataclass(frozen=True)
class PoseOptions:
    """Options of pose."""

    at: Moment = option("rest")
    evaluate: bool = option(
        True, help="Evaluate the active controls and constraints, or take the joints' own keys."
    )
