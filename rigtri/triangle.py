"""Three points make a triangle; a triangle makes a frame, a bend plane, a pole vector."""

from rigtri.maths.triangle import *  # noqa: F403
