"""What hypothesis draws: vectors, turns and frames in sizes that files have."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from rigtri.maths.quaternions import to_axes, unit
from rigtri.maths.trigonometry import Floats

numbers = st.floats(-1e3, 1e3).map(lambda x: round(x, 6))
vectors = st.tuples(numbers, numbers, numbers).map(np.array)
directions = vectors.filter(lambda v: np.abs(v).max() > 1e-3)
quaternions = (
    st.tuples(*[st.floats(-1, 1)] * 4).map(np.array).filter(lambda q: np.sqrt((q * q).sum()) > 0.1).map(unit)
)
scales = st.tuples(*[st.floats(0.1, 10.0)] * 3).map(np.array)


@st.composite
def frames(draw: st.DrawFn) -> Floats:
    """A rigid matrix: right-handed unit axes and a position, (4, 4)."""
    m = np.eye(4)
    m[:3, :3], m[3, :3] = to_axes(draw(quaternions)), draw(vectors)
    return m
