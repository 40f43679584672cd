"""What strip can be asked for."""

from __future__ import annotations

from dataclasses import dataclass

from rigtri.operations.declaration.option import option


@dataclass(frozen=True)
class StripOptions:
    """Take out again what rigtri has added."""

    splits: bool = option(
        False,
        help="Also forget which nodes hold the axes of split joints; they stay, as nodes like others.",
    )
