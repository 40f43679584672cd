"""The options of limit-weights."""

from __future__ import annotations

from typing import Annotated

from rigtri.model.dataclass import dataclass
from rigtri.model.options import Kind, option
from rigtri.operations.option_kinds import OneCharacter

Influences = Annotated[int, Kind("number", "N", low=1, high=64)]


@dataclass(frozen=True)
class LimitWeightsOptions(OneCharacter):
    """Options of limit-weights."""

    max_influences: Influences = option(
        4, help="Most joints for one vertex; those with the largest weights stay.", group="what"
    )
    normalise: bool = option(False, help="Also make the weights of every vertex sum to 1.", group="what")
