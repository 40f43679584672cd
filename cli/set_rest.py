"""rigtri set-rest

Where a clip has no keys for a joint it showed the old rest pose, so the joint gets a key there. Bind
poses do not change: meshes show the new rest pose where no clip plays. T-pose and A-pose rotate the arms,
hands and legs of recognised bodies from their bind pose: palms down, feet ahead.

\b
Examples:
    rigtri set-rest hero.glb -o out.glb --pose tpose
    rigtri set-rest hero.glb -o out.glb --pose bind
    rigtri set-rest hero.glb -o out.glb --pose idle@0
    rigtri set-rest hero.glb -o out.glb --like other.glb
"""

from __future__ import annotations

from rigtri.operations.options.set_rest import SetRestOptions
from rigtri.report import Report

from .edit_command import edit_command
from .printing import rebaked
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.joints:
        return "the joints rest so already; nothing was changed"
    clips = "" if report.warned("pose-shown") else "; clips play as before"
    return f"{counted(len(report.joints), 'joint')} rest in another pose{clips}{rebaked(report)}"


command = edit_command("set-rest", SetRestOptions, summary, __doc__)
