"""Euler angles in one of six orders from quaternions, and back."""

from rigtri.maths.euler import *  # noqa: F403
