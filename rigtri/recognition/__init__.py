"""Recognising characters: which joints make spine, arms, legs and fingers, and the evidence for it.

By names, humanoid maps and shape. What is here looks at a rig and returns a layout, limbs, sides, roles or
a bend plane, and never changes the rig. Naming schemes are data (TOML files), not code.
"""
