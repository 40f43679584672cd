"""Let no point of IN follow more joints than an engine shows.

Of each point the joints that weigh most stay, and share the weight of those that go. How far vertices move is
measured, and refused above --tolerance. With --normalise the weights of every point sum to 1, which engines
that normalise them show as before.

\b
Examples:
    rigtri limit-weights hero.glb -o out.glb --tolerance 0.001
    rigtri limit-weights hero.glb -o out.glb --max-influences 8 --normalise
"""

from __future__ import annotations

from rigtri.operations.options.limit_weights import LimitWeightsOptions
from rigtri.report import Report

from .edit_command import edit_command
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.added:
        return "no point has more joints, or other weights; nothing was changed"
    points, over = (sum(entry[word] for entry in report.added) for word in ("points", "over"))
    meshes = f"{len(report.added)} meshes"
    return f"{counted(points, 'point')} of {meshes} have other weights; {over} had too many joints"


command = edit_command("limit-weights", LimitWeightsOptions, summary, __doc__)
