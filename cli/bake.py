"""rigtri bake

A control that has keys in a clip moves its joints there; joints whose controls have no keys keep their
own. Redundant keys are removed, within --tolerance.

\b
Examples:
    rigtri bake rigged.glb -o game.glb --to joints
    rigtri bake rigged.glb -o animate.glb --to controls --clip 'walk*'
    rigtri bake edited.glb -o home.glb --to joints --rig rigged.glb
    rigtri bake edited.glb -o home.glb --to joints --rig rigged.glb --as '*_ctlAction=walk'
"""

from __future__ import annotations

from typing import Any

from rigtri.operations.options.bake import BakeOptions
from rigtri.report import Report

from .edit_command import edit_command
from .terminal_text import counted, grown

_HINT = " (the clips of the joints go onto the controls with --to controls)"


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    clips = [entry for entry in report.added if entry["type"] == "clip"]
    beside = _beside(report)
    if not clips:
        bare = any(notice.code == "no-clips" for notice in report.warnings)
        nothing = "the file has no clips" if bare else f"no clip has keys of controls or constraints{_HINT}"
        return "; ".join([nothing, *(beside or ["nothing was baked"])])
    keys, frames = sum(entry["keys"] for entry in clips), sum(entry["frames"] for entry in clips)
    if not keys and not any(entry["keys_before"] for entry in clips):
        looked = f"{counted(len(clips), 'clip')}, {counted(frames, 'frame')}"
        nothing = f"{looked}: controls and constraints move nothing there"
        return "; ".join([nothing, *(beside or ["nothing was baked"])])
    line = ", ".join([counted(len(clips), "clip"), counted(frames, "frame"), counted(keys, "key")])
    line += f" for {counted(max(e['nodes'] for e in clips), 'node')}"
    line += grown(clips)
    curved = max(entry["between_samples"] for entry in clips)
    line += f"; between samples within {curved:.2g} of the size" if curved else ""
    line = "; ".join([line, *beside])
    if clips[0]["to"] == "controls":
        far = max(entry["deviation"] for entry in clips)
        turn = max(entry["residual_degrees"] for entry in clips)
        line += f"; the controls give the joints back within {far:.2g} of the size"
        line += f", with up to {turn:.2g}° below IK" if any(entry["limbs"] for entry in clips) else ""
    return line


def _beside(report: Report) -> list[str]:
    """What was done beside keys."""
    of: dict[str, list[dict[str, Any]]] = {}
    for entry in report.added:
        of.setdefault(entry["type"], []).append(entry)
    lines = []
    if resting := {name for entry in of.get("rest", []) for name in entry["nodes"]}:
        lines.append(f"{counted(len(resting), 'node')} at rest")
    for kind, noun in (("twist", "twist joint"), ("poseReader", "pose reader"), ("rivet", "rivet")):
        if kind in of:
            lines.append(f"{counted(len(of[kind]), noun)} baked from the joints' motion")
    if placed := sum(len(entry["nodes"]) for entry in of.get("described", [])):
        lines.append(f"{counted(placed, 'node')} put where the file of --rig has them")
    if parts := of.get("joined"):
        whole = ", ".join(f"'{entry['clip']}'" for entry in parts)
        lines.append(
            f"{counted(sum(len(entry['from']) for entry in parts), 'clip')} of IN matched with {whole}"
        )
    for entry in of.get("moved", []):
        by = f"{abs(entry['by']):.4g} {'earlier' if entry['by'] < 0 else 'later'} than in IN"
        lines.append(f"'{entry['clip']}' begins where the file of --rig has it, {by}")
    return lines


command = edit_command("bake", BakeOptions, summary, __doc__)
