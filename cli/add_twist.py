"""rigtri add-twist

Each of n joints at i/(n+1) of a bone takes i/(n+1) of the twist and none of the swing. On the lower bone
of a limb the twist comes from the end joint (the wrist); on the upper bone the joint's own twist is
removed towards the root. Skin weights change only with --split-weights; then the rest pose looks as
before, and twisted poses look better.

\b
Examples:
    rigtri add-twist hero.glb -o out.glb --limbs auto
    rigtri add-twist hero.glb -o out.glb --limb upper_arm forearm hand --count 3 --split-weights
    rigtri add-twist hero.usdz -o out.usdz --joint forearm --to hand --weights 0.25,0.8
"""

from __future__ import annotations

from rigtri.operations.options.add_twist import AddTwistOptions
from rigtri.report import Report

from .edit_command import edit_command
from .printing import rebaked
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    made = [entry for entry in report.added if entry["type"] == "twist"]
    new = [entry for entry in made if entry["new"]]
    bones = {(entry["joint"], entry["to"]) for entry in made}
    clips = {clip["clip"] for entry in made for clip in entry["clips"]}
    keys = f", with keys in {counted(len(clips), 'clip')}" if clips else ""
    along = f"{counted(len(made), 'twist joint')} along {counted(len(bones), 'bone')}"
    return f"{along}, {len(new)} of them new{keys}{rebaked(report)}"


command = edit_command("add-twist", AddTwistOptions, summary, __doc__)
