"""A file that goes with an output."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Companion:
    """A file that must lie beside the output: new bytes, or a copy of a file of the source.

    name: where, relative to the output's folder, with forward slashes.
    """

    name: str
    content: bytes | Path
