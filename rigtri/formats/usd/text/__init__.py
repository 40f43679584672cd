"""Layers as text (.usda): their statements, and how a changed layer keeps the bytes of what did not change.

Nothing here knows a stage or a rig.
"""
