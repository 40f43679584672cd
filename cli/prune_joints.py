"""rigtri prune-joints

A joint is removed when no vertex has weight on it or on a joint below it, and no mesh, camera or light is
a child of it. Joints stay where the format, a constraint or rigtri's metadata refers to them, and so do
bones of a VRM humanoid and springs. Sockets stay unless --sockets is given.

\b
Examples:
    rigtri prune-joints hero.glb -o out.glb
    rigtri prune-joints hero.glb -o out.glb --ends --exclude '*_ik'
"""

from __future__ import annotations

from rigtri.operations.options.prune_joints import PruneJointsOptions
from rigtri.report import Report

from .edit_command import edit_command
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.joints:
        unread = ", as meshes that could not be read may need it" * report.warned("mesh-unread")
        return f"every joint moves something or is needed{unread}; nothing was changed"
    names = ", ".join(entry["joint"] for entry in report.joints[:6])
    return f"{counted(len(report.joints), 'node')} removed: {names}{' …' * (len(report.joints) > 6)}"


command = edit_command("prune-joints", PruneJointsOptions, summary, __doc__)
