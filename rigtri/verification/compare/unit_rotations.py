"""How far rotations of a file are from unit: it shows where nobody normalises, as UsdSkel does not."""

from __future__ import annotations

from itertools import chain

import numpy as np

from rigtri.maths.arrays import Booleans
from rigtri.maths.quaternions import STRAIGHT, off_unit
from rigtri.model.rig import Rig
from rigtri.verification.compare.verdict import UNIT

# Where quaternions are shown as they are: a rotation doubles their error, and a chain of joints adds it up.
UNIT_AS_SHOWN = 2e-7
# A key that an edit adds between two that OpenUSD goes straight between stands on their chord, where these
# are not unit: halfway, shorter by a quarter of what the cosine lacks.
_CHORD = STRAIGHT / 4.0


def denormalisation(rig: Rig, nodes: Booleans | None = None) -> float:
    """The largest | |q|−1 | of a rig's rotations, at rest and at keys; tangents do not count. nodes: (n,)."""
    some = np.ones(len(rig), dtype=bool) if nodes is None else nodes
    turns = [c for clip in rig.clips for c in clip.columns if c.path == "rotation"]
    tracks = ((values, some[c.nodes[rows]]) for c in turns for rows, values in c.parts())
    keyed = (values if mine.all() else values[mine] for values, mine in tracks)
    return max(map(off_unit, chain([rig.rotation[~rig.has_matrix & some]], keyed)))


def lost_unit_rotations(was: float, now: float, *, as_shown: bool) -> tuple[str, ...]:
    """What to say where rotations are farther from unit than they were.

    Normalising hides it, but a renderer that does not normalise would show it. as_shown: as in USD, where a
    key may stand on the chord between two others, and is measured there.
    """
    off = f"unit rotations: |q| is off 1 by {now:.2g}, was {was:.2g}"
    return (off,) if now > 2.0 * was + UNIT + (_CHORD if as_shown else 0.0) else ()
