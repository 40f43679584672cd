"""Vectors, quaternions, matrices and triangles: arrays in, arrays out.

Shapes are (..., 3), (..., 4) and (..., 4, 4), so one and many are the same call; lengths are in file units,
angles in radians, matrices take row vectors. Everything is elementwise, of + − × ÷ √ and the functions of
`trigonometry`, so that the same input gives the same bits on every machine. Nothing here knows a rig, a
file or an option; this room imports `rigtri.errors` alone.
"""
