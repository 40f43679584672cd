"""rigtri add-controls

Each control stands at its joint, aimed along the bone, with zero channels. Its parent is an
offset group below the control of the parent joint. A second run finds its controls again:
unedited ones get the requested shape, size, colour and name; edited ones stay and are listed.

\b
Examples:
    rigtri add-controls hero.glb -o out.glb --chain index_1 index_3
    rigtri add-controls hero.glb -o out.glb --whole-character
    rigtri add-controls hero.usdz -o out.usdz --below spine --shape cube --size 1.5
"""

from __future__ import annotations

from rigtri.operations.options.add_controls import AddControlsOptions
from rigtri.report import Report

from .edit_command import edit_command
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    new = [entry for entry in report.added if entry["new"]]
    kinds = [entry["kind"] for entry in report.added]
    counts = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))
    poles = f"; {counted(len(report.limbs), 'pole vector')}" if report.limbs else ""
    return f"{counted(len(report.added), 'control')} ({counts}), {len(new)} of them new{poles}"


command = edit_command("add-controls", AddControlsOptions, summary, __doc__)
