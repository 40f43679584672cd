"""rigtri add-posereader

Driven morph targets change on purpose: verification compares everything else, and reports how far they
move. A target that drives no morph target gets a node whose x translation is its weight.

\b
Examples:
    rigtri add-posereader hero.glb -o out.glb --driver upperarm_L --target up=0,1,0 --morph up Body bulge
    rigtri add-posereader hero.glb -o out.glb --driver knee --reader cone --outer 60 --target walk@0.4
    rigtri add-posereader hero.glb -o out.glb --driver forearm_L --target bent=walk@0.4 \\
        --joint bent elbow_L tx=.02,rz=15
    rigtri add-posereader hero.usdz -o out.usdz --driver head --reader rbf --target rest --target nod@12
"""

from __future__ import annotations

from rigtri.operations.options.add_posereader import AddPosereaderOptions
from rigtri.report import Report

from .edit_command import edit_command
from .printing import rebaked
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    (entry,) = (entry for entry in report.added if entry["type"] == "poseReader")
    rest = ", ".join(f"{name} {value:.3g}" for name, value in entry["rest"].items())
    keys = sum(entry["keys"].values())
    return (
        f"{entry['reader']} reader of {entry['driver']}: at rest {rest}; {keys} keys in "
        f"{counted(len(entry['keys']), 'clip')}, {counted(entry['morphs'], 'morph target')} driven"
        + (f", {counted(entry['joints'], 'joint')} driven" if entry["joints"] else "")
        + rebaked(report, ["rivet"])
    )


command = edit_command("add-posereader", AddPosereaderOptions, summary, __doc__)
