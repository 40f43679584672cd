"""``rigtri take-clips``: the animation of an edited copy transferred back to the rig, and metadata restored.

Which nodes and clips of the two files are the same, how axes map, which keys differ. Only what this
command needs, and the ``--rig`` option of others, which restores metadata that a DCC has dropped.
"""
