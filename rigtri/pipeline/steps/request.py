"""What a user asks of an operation: its options as the command line and specs have them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rigtri.errors import UsageError
from rigtri.formats import ReadOptions
from rigtri.model.rig import Rig
from rigtri.report import Report

Step = Callable[[Rig, Report], Rig]


@dataclass(frozen=True)
class Request:
    """Values of an operation's options by the names of its parameters, and which the user gave.

    reading: how other files that the options name are read.
    """

    values: Mapping[str, Any]
    given: frozenset[str]
    reading: ReadOptions

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    def refuse(self, options: Mapping[str, str], why: str) -> None:
        """UsageError for the first of these options (flag → parameter) that the user gave."""
        for flag, name in options.items():
            if name in self.given:
                raise UsageError(f"{flag} {why}")


def clip_names(given: tuple[str, ...]) -> dict[str, str]:
    """What ``NAME=CLIP`` says of clips, by NAME. UsageError for what names no clip."""
    names = {}
    for text in given:
        name, mark, clip = text.rpartition("=")
        if not mark or not name:
            raise UsageError(f"--as {text}: give NAME=CLIP, a clip and what it is called in the rig")
        names[name] = clip
    return names
