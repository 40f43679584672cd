"""Take out again what rigtri has put into IN: controls, locators, shapes and notes.

The axes of joints stay as orient-joints has set them. All that stays is proven to look as before.

\b
Example:
    rigtri strip rigged.glb -o plain.glb
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigtri.operations.options.strip import StripOptions

from .edit_command import edit_command

if TYPE_CHECKING:
    from rigtri.report import Report


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    nodes = sum(not entry["kept"] for entry in report.removed)
    notes = len(report.removed) - nodes
    if not report.removed:
        return "Nothing here is rigtri's"
    return f"Taken out: {nodes} nodes, and notes on {notes} others"


command = edit_command("strip", StripOptions, summary, __doc__)
