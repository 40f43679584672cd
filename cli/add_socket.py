"""rigtri add-socket

\b
Examples:
    rigtri add-socket hero.glb -o out.glb --name weapon --on hand_r --at 0,0.1,0
    rigtri add-socket hero.usdz -o out.usdz --name hat --on head --aim +y --up +z
"""

from __future__ import annotations

from rigtri.operations.options.add_socket import AddSocketOptions
from rigtri.report import Report

from .edit_command import edit_command


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.joints:
        return "the socket is there already; nothing was changed"
    (entry,) = report.joints
    return f"'{entry['joint']}' {'was added' if entry['status'] == 'added' else 'was moved'}"


command = edit_command("add-socket", AddSocketOptions, summary, __doc__)
