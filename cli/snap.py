"""rigtri snap

A limb is solved by IK in a clip where its IK end or pole has keys. So --to fk removes those keys, and
--to ik removes the keys that the limb's FK controls had without IK. At the times of --at the joints stay
as they are.

\b
Examples:
    rigtri snap rigged.glb -o out.glb --limb upper_arm_L forearm_L hand_L --to fk --at walk@0.5
    rigtri snap rigged.glb -o out.glb --limbs auto --to ik --at walk@0 --at walk@0.5
"""

from __future__ import annotations

from rigtri.operations.options.snap import SnapOptions
from rigtri.operations.snap import NEAR
from rigtri.report import Report

from .edit_command import edit_command
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    matched = [entry for entry in report.added if entry["type"] == "snap"]
    far = max((entry["deviation"] for entry in matched), default=0.0)
    limbs = len({tuple(entry["limb"]) for entry in matched})
    if not report.reposed:
        return f"{counted(limbs, 'limb')} matched already; nothing was changed"
    text = f"{limbs} limbs to {matched[0]['to']}; their joints stay within {far:.2g} of the size"
    elsewhere = max(entry["elsewhere"] for entry in matched)
    if elsewhere > max(far, NEAR):
        text += f"; at other times of the clip these joints move by up to {elsewhere:.2g}"
    return text


command = edit_command("snap", SnapOptions, summary, __doc__)
