"""The data: a rig with its hierarchy, skins, clips, constraints, bindings, meshes, and rigtri's metadata.

Immutable dataclasses and arrays, with what can be read off them alone: world matrices at rest, names,
children. `rig` has the rig itself, each other module one part of it, `metadata` what rigtri stores beside
nodes. Nothing here samples a clip or solves IK (that is for `rigtri.evaluation`), changes axes
(`rigtri.frames`), decides geometry, or knows a file or a format.
"""
