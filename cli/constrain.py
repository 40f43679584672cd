"""rigtri constrain

The constraint is stored in the file; nothing moves now. A second run for the same child and type replaces
it. With --space, --switch, --weight-keys or --weight-from the weights are nodes, and an animator can edit
their keys (translation x).

\b
Examples:
    rigtri constrain hero.glb -o out.glb --type parent --child sword --driver hand_L --driver hand_R=0
    rigtri constrain hero.usda -o out.usda --type point --child pole --driver hips --skip ty
    rigtri constrain hero.vrm -o out.vrm --type orient --child sleeve --driver arm \\
        --driver-space local --vrm-constraints
    rigtri constrain hero.glb -o out.glb --child sword --space hand_L --space hand_R \\
        --switch throw@1.2=hand_R --match
    rigtri constrain hero.glb -o out.glb --child hand_L_ik_ctl --space root --space chest --space world
"""

from __future__ import annotations

from rigtri.operations.options.constrain import ConstrainOptions
from rigtri.report import Report

from .edit_command import edit_command


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    words = []
    for entry in report.added:
        drivers = ", ".join(f"{name} ({weight:g})" for name, weight in entry["drivers"].items())
        vrm = f", also as a {entry['vrm']} node constraint" if entry["vrm"] else ""
        state = "new" if entry["new"] else "replaced"
        keys = [f"{count} keys in {clip}" for clip, count in entry.get("weight_keys", {}).items()]
        keyed = f", weights with {', '.join(keys)}" if keys else ""
        words.append(f"{entry['child']}: {entry['kind']} constraint by {drivers}{keyed}{vrm} ({state})")
    return "; ".join(words)


command = edit_command("constrain", ConstrainOptions, summary, __doc__)
