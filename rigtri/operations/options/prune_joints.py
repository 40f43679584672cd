"""The options of prune-joints."""

from __future__ import annotations

from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Excluded, Nodes, OneCharacter


@dataclass(frozen=True)
class PruneJointsOptions(OneCharacter):
    """Options of prune-joints."""

    sockets: bool = option(
        False,
        help="Also remove empty sockets, such as weapon slots, and IK bones of an engine.",
        group="what",
    )
    ends: bool = option(
        False,
        help="Also remove nodes that only mark the end of a chain, such as the *_end leaves of exporters.",
        group="what",
    )
    joints: Nodes = option((), help="Only these joints.")
    exclude: Excluded = option(())
