"""The options that say axes: which aims, which goes up, and where up comes from."""

from __future__ import annotations

from typing import Any

from rigtri.operations.axis_presets import PRESETS
from rigtri.operations.declaration import option


def preset() -> Any:
    return option(None, choices=PRESETS, help="The axes of another program: aim, up and where up comes from.")


def aim() -> Any:
    return option(None, help="Axis that aims at the child. [x]")


def up() -> Any:
    return option(None, help="Axis that goes up. [y]")


def up_from() -> Any:
    return option(
        None,
        metavar="SOURCE",
        help="plane (the hinge, +n), pole (towards the bend), world:+y, vector:x,y,z, node:NAME, "
        "noderot:axis:NAME, parent, child, keep. [plane]",
    )
