"""A rig at given times: clips sampled, FK, IK, constraints, twist, pose readers, skinning, and the inverse.

What is here takes a rig of `rigtri.model` and times, and returns matrices, points, weights or keys; it may
make tracks, and reduce their keys. It reads and writes no files, chooses no options, and warns nobody:
that is for `rigtri.operations`, which decide what is kept.
"""
