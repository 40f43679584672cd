"""rigtri add-rivet

The x axis of a rivet lies along the first edge of its triangle, y is the normal. A second
run finds a rivet by its name and moves it.

\b
Examples:
    rigtri add-rivet hero.glb -o out.glb --mesh Body --at 0,1.4,0.2 --name button
    rigtri add-rivet hero.glb -o out.glb --mesh Body --triangle 120 --barycentric 0.2,0.3,0.5
    rigtri add-rivet hero.usdz -o out.usdz --mesh Body --vertex 17 --vertex 40 --fps 24
"""

from __future__ import annotations

from rigtri.operations.options.add_rivet import AddRivetOptions
from rigtri.report import Report

from .edit_command import edit_command
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    new = sum(entry["new"] for entry in report.added)
    keys = sum(count for entry in report.added for count in entry["keys"].values())
    off = max((entry["deviation"] for entry in report.added), default=0.0)
    away = max((entry["distance"] for entry in report.added), default=0.0)
    at = f"; the nearest points of the mesh are up to {away:.4g} from those given" if away else ""
    return (
        f"{counted(len(report.added), 'rivet')}, {new} of them new, {counted(keys, 'key')}, "
        f"at most {off:.2g} of the mesh's size off the surface{at}"
    )


command = edit_command("add-rivet", AddRivetOptions, summary, __doc__)
