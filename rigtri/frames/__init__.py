"""Frames of joints: the reference pose, the skeleton, and `reframe`, the only place where frames change.

Beside them lives what decides whether a change is exact: scale tables and tolerances, error bounds, what
constraints require; and mirror modes and the mirror plane. Nothing here chooses which joints change or to
which axes (that is for `rigtri.operations`), and nothing knows a file.
"""

from __future__ import annotations

from typing import Literal

# Mirror modes and planes (`mirroring`), here because options name them too, which import no numpy.
Mirror = Literal["behavior", "orientation", "blender"]
Plane = Literal["yz", "xz", "xy"]
