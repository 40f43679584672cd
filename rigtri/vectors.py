"""Vectors: directions and positions, shape (..., 3); one and many are the same call."""

from rigtri.maths.vectors import *  # noqa: F403
