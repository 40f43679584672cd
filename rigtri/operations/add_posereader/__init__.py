"""``rigtri add-posereader``: morph targets and values driven by a joint's pose, and the keys they replace.

How a pose becomes weights is in `rigtri.evaluation.pose_readers`.
"""
