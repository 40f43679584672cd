"""What operations report of single joints."""

from __future__ import annotations

from typing import Any

from rigtri.model.rig import Rig


def joint_record(rig: Rig, node: int, status: str, **more: Any) -> dict[str, Any]:
    """The record of a node for ``Report.joints``: what it is called, and what became of it."""
    names = {"joint": rig.title(node), "address": rig.address(node), "path": rig.path(node)}
    return {**names, "status": status, **more}
