"""add-twist: twist joints along bones, their weights, and their baked keys in clips.

How a twist joint follows its driver is evaluated in `rigtri.evaluation.twist_joints`, not here.
"""
