"""rigtri limit-weights

Each vertex keeps the joints with the largest weights, which share the weight of the others. The movement
of vertices is measured, and refused above --tolerance. With --normalise the weights of each vertex sum to
1, which looks the same in engines that normalise them.

\b
Examples:
    rigtri limit-weights hero.glb -o out.glb --tolerance 0.001
    rigtri limit-weights hero.glb -o out.glb --max-influences 8 --normalise
"""

from __future__ import annotations

from rigtri.operations.options.limit_weights import LimitWeightsOptions
from rigtri.report import Report

from .edit_command import edit_command
from .printing import rebaked
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.added:
        of = " of meshes that could be read" if report.warned("mesh-unread") else ""
        return f"no vertex{of} has more joints, or other weights; nothing was changed"
    changed = [entry for entry in report.added if entry["type"] == "weights"]
    vertices, over = (sum(entry[word] for entry in changed) for word in ("points", "over"))
    meshes, verb = counted(len(changed), "mesh", "meshes"), "has" if vertices == 1 else "have"
    many = counted(vertices, "vertex", "vertices")
    return f"{many} of {meshes} {verb} other weights; {over} had too many joints{rebaked(report)}"


command = edit_command("limit-weights", LimitWeightsOptions, summary, __doc__)
