"""Rotations as unit quaternions xyzw, shape (..., 4); one and many are the same call."""

from rigtri.maths.quaternions import *  # noqa: F403
