"""Transformation matrices, shape (..., 4, 4), **row vectors**: ``v_world = v_local @ M``."""

from rigtri.maths.matrices import *  # noqa: F403
