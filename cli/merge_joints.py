"""rigtri merge-joints

The parent gets the weights of a merged joint; all joints below it are merged, too. Joints that never move
(--still, or --joints with --keep-children) are merged without moving a vertex, and what is below them is
parented to what is above. For others the movement of vertices is measured, and refused above --tolerance.
Clips in other files need the same: merge the joints there by name, or transfer their motion with
rigtri take-clips.

\b
Examples:
    rigtri merge-joints hero.glb -o out.glb --still
    rigtri merge-joints hero.glb -o far.glb --max-joints 30 --tolerance 0.02
    rigtri merge-joints hat.glb -o hat1.glb --lod hero_lod1.glb --tolerance 0.02
    rigtri merge-joints hero.glb -o out.glb --joints '*Toe*' --tolerance 0.01
    rigtri merge-joints walk.glb -o out.glb --joints Spine2 --keep-children
"""

from __future__ import annotations

from rigtri.operations.options.merge_joints import MergeJointsOptions
from rigtri.report import Report
from rigtri.text import and_more

from .edit_command import edit_command
from .printing import rebaked
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    if not report.joints:
        return "there is nothing to merge; nothing was changed"
    pairs = [f"{each['joint']} into {each['heir']}" for each in report.joints if "heir" in each]
    names = pairs or [each["joint"] for each in report.joints]
    return f"{counted(len(report.joints), 'node')} merged: {and_more(names, 4)}{rebaked(report)}"


command = edit_command("merge-joints", MergeJointsOptions, summary, __doc__)
