"""A rig evaluated over time: controls, limbs and rules move joints, and joints tell their controls."""
