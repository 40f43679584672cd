"""What USD composes of layers: opening stages, and looking at them as USD sees them.

Layers and their asset paths, what a file may open and how much (before USD reads it), stages and overrides,
variants, value clips, and which value types and bindings UsdSkel accepts. Nothing here knows a `Rig`, and
nothing changes a layer that came from a file, but for copies.
"""
