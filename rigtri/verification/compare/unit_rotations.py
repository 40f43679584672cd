"""How far rotations of a file are from unit, at keys and between them: it shows where nobody normalises.

Source: OpenUSD, `GfSlerp` and UsdSkel, which makes matrices of quaternions as they are.
"""

from __future__ import annotations

from itertools import chain

import numpy as np

from rigtri.maths.arrays import Booleans
from rigtri.maths.quaternions import dot, off_unit
from rigtri.model.animation import Column
from rigtri.model.rig import Rig
from rigtri.verification.compare.verdict import UNIT

# Where quaternions are shown as they are: a rotation doubles their error, and a chain of joints adds it up.
UNIT_AS_SHOWN = 2e-7
# Between keys of a larger cosine OpenUSD plays the chord: halfway, shorter by a quarter of what it lacks.
_NEAR = 0.99999
_CHORD = (1.0 - _NEAR) / 4.0


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


def short_elsewhere(before: Rig, after: Rig) -> bool:
    """Whether rotations are shorter between keys than at them, and of two rigs with the same clips the keys
    stand at other times: what a chain of joints adds up shows then.
    """
    for clips in zip(before.clips, after.clips, strict=True):
        sides = [[c for c in clip.columns if c.raw and len(c.times) > 1] for clip in clips]
        mine, theirs = ({c.times.tobytes() for c in side} for side in sides)
        if mine and theirs and mine != theirs and any(map(_short_between, chain(*sides))):
            return True
    return False


def _short_between(column: Column) -> bool:
    """Whether OpenUSD plays visibly shorter rotations between some keys of it than at them."""
    for _, values in column.parts():
        cosine = np.abs(dot(values[:, :-1], values[:, 1:]))
        if ((cosine > _NEAR) & (1.0 - cosine > 4.0 * UNIT_AS_SHOWN)).any():
            return True
    return False
