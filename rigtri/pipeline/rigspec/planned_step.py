"""One step of a spec that was read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rigtri.pipeline.rigspec.errors import Place
from rigtri.pipeline.rigspec.positions import Label


@dataclass(frozen=True)
class PlannedStep:
    """One step: its operation, that one's options, and its position in the spec.

    index: among all, from 0. given: the options that the spec gives, as it gives them.
    """

    index: int
    label: Label
    do: str
    options: Any
    optional: bool
    place: Place
    given: dict[str, Any]

    @property
    def number(self) -> int:
        """Its number in the file, from 1; steps of the same braces have the same."""
        return self.label.number
