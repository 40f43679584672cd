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


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.added:
        return "no vertex has more joints, or other weights; nothing was changed"
    vertices, over = (sum(entry[word] for entry in report.added) for word in ("points", "over"))
    meshes = "1 mesh" if len(report.added) == 1 else f"{len(report.added)} meshes"
    many = f"1 vertex of {meshes} has" if vertices == 1 else f"{vertices} vertices of {meshes} have"
    return f"{many} other weights; {over} had too many joints"


command = edit_command("limit-weights", LimitWeightsOptions, summary, __doc__)
