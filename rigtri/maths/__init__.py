"""Vectors, quaternions, matrices and triangles: arrays in, arrays out.

Shapes are (..., 3), (..., 4) and (..., 4, 4), so one and many are the same call; lengths are in file units,
angles in radians, matrices take row vectors. Everything is elementwise, of + − × ÷ √ and the functions of
`trigonometry`, so that the same input gives the same bits on every machine. Nothing here knows a rig, a
file or an option; this room imports `rigtri.errors` alone.
"""

from __future__ import annotations

from typing import Literal

# Choices of functions, here because options and records name them too, which import no numpy.
# The order of Euler angles (`euler`).
RotateOrder = Literal["xyz", "yzx", "zxy", "xzy", "yxz", "zyx"]
# Of a pole vector (`triangle`): how the mid joint is projected, what its distance is counted from, and whose
# multiple it is.
PoleMethod = Literal["perpendicular", "ratio"]
PoleOrigin = Literal["middle", "root", "foot"]
ReachOf = Literal["limb", "chord"]
