"""Edits: opinions for a layer, and how they reach it.

An `Edit` holds all values that it will write, so that none is read back from a layer that another edit has
changed. Here are the ones that several passes make (attributes, skeletons, animations, transforms), their
way into instances, and the check that no stronger opinion hides them. What to write is decided in `passes`.
"""
