"""rigtri add-root

\b
Examples:
    rigtri add-root hero.glb -o out.glb
    rigtri add-root hero.glb -o out.glb --name Root --above mixamorig:Hips
"""

from __future__ import annotations

from rigtri.operations.options.add_root import AddRootOptions
from rigtri.report import Report

from .edit_command import edit_command
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    bones = [each for each in report.joints if "follows" in each]
    root = next((each for each in report.joints if "follows" not in each), None)
    if root is None:
        text = "there is a root of this name already"
        text += "" if bones else "; nothing was changed"
    elif root["status"] == "kept":
        text = f"'{root['joint']}' is the root already; its name stays"
    else:
        text = f"'{root['joint']}' added on the ground, above the joints of the character"
    new = sum(bone["status"] == "added" for bone in bones)
    done = [f"{counted(new, 'IK bone')} added"] if new else []
    done += [f"{counted(len(bones) - new, 'IK bone')} made to follow again"] if len(bones) > new else []
    return "; ".join([text, *done])


command = edit_command("add-root", AddRootOptions, summary, __doc__)
