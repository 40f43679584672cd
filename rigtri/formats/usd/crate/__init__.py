"""Layers as crates (.usdc): whether the tables and values of one are sound, before USD reads it.

Nothing here imports USD.
"""
