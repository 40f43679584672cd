"""rigtri add-polevector

It lies in the plane of the limb, on the side to which the limb bends. For straight limbs the direction
comes from the clips, the other side or the joint names; without any of these it is an error. A second run
finds its locator and moves it.

\b
Examples:
    rigtri add-polevector hero.glb -o out.glb --limb upper_arm_L forearm_L hand_L
    rigtri add-polevector hero.vrm -o out.vrm --limbs auto
    rigtri add-polevector hero.glb -o out.glb --limb thigh shin foot --bend shin=0,0,1
"""

from __future__ import annotations

from rigtri.operations.options.add_polevector import AddPolevectorOptions
from rigtri.report import Report

from .edit_command import edit_command


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    lines = []
    for entry in report.limbs:
        x, y, z = entry["position"]
        lines.append(
            f"{entry['polevector']} at {x:.6g} {y:.6g} {z:.6g}: {' - '.join(entry['limb'])} bends "
            f"{entry['bend_degrees']:.4f}° (from: {entry['source']})"
        )
        for clip in entry.get("clips", []):
            times = ", ".join(f"{at['time']:g} {at['what']}" for at in clip["at"][:8])
            more = f" … {len(clip['at'])} in all" if len(clip["at"]) > 8 else ""
            lines.append(f"  {clip['clip']}: {times}{more}")
    return "\n".join(lines)


command = edit_command("add-polevector", AddPolevectorOptions, summary, __doc__)
