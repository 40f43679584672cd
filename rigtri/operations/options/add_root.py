"""The options of add-root."""

from __future__ import annotations

from typing import Literal

from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Name, Node, OneCharacter


@dataclass(frozen=True)
class AddRootOptions(OneCharacter):
    """Options of add-root."""

    name: Name = option("root", help="Name of the root joint.", group="what")
    above: Node | None = option(None, help="Insert the root above this joint. [the body's top joint]")
    profile: Literal["unreal"] | None = option(
        None,
        help="Also add the joints with which an engine animates hands and feet.",
        values={"unreal": "ik_foot_root, ik_foot_l … ik_hand_gun, ik_hand_r, with keys that follow"},
    )
