"""The options of strip."""

from __future__ import annotations

from dataclasses import dataclass

from rigtri.operations.declaration import option


@dataclass(frozen=True)
class StripOptions:
    """Remove what rigtri has added."""

    splits: bool = option(
        False,
        help="Also remove the metadata of nodes that hold the axes of split joints; the nodes stay.",
    )
