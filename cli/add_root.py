"""Put a root joint on the ground of IN, above all joints of a character; nothing moves.

\b
Examples:
    rigtri add-root hero.glb -o out.glb
    rigtri add-root hero.glb -o out.glb --name Root --above mixamorig:Hips
"""

from __future__ import annotations

from rigtri.operations.options.add_root import AddRootOptions
from rigtri.report import Report

from .edit_command import edit_command


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.joints:
        return "there is a root of this name already; nothing was changed"
    if report.joints[0]["status"] == "kept":
        return f"'{report.joints[0]['joint']}' is the root already; its name stays"
    return f"'{report.joints[0]['joint']}' stands on the ground, above the joints of the character"


command = edit_command("add-root", AddRootOptions, summary, __doc__)
