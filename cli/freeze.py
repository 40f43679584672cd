"""rigtri freeze

The scale of joints and of everything above them becomes 1, and the rotation above joints is removed.
Positions, inverse bind matrices and keys change to match. Vertices, cameras and lights keep their values;
only with --unit are clipping ranges, focus distances and orthographic apertures of USD cameras converted.
Without options both are frozen.

\b
Examples:
    rigtri freeze soldier.glb -o out.glb
    rigtri freeze soldier.glb -o out.glb --scale --only above
    rigtri freeze hero.usdz -o out.usdz --up-axis y
"""

from __future__ import annotations

from rigtri.operations.options.freeze import FreezeOptions
from rigtri.report import Report

from .edit_command import edit_command
from .terminal_text import counted


def summary(report: Report) -> str:
    """What was done, in a line or a few."""
    scaled = sum("world_scale" in entry for entry in report.joints)
    turned = sum("rotation" in entry for entry in report.joints)
    done = [f"up is now {one['up']}, and the unit {one['metres']:g} m" for one in report.added]
    if scaled or turned:
        done.append(f"frozen: the scale of {counted(scaled, 'node')}, the rotation of {turned} above joints")
    return "\n".join(done) or "there is no scale or rotation to freeze; nothing was changed"


command = edit_command("freeze", FreezeOptions, summary, __doc__)
