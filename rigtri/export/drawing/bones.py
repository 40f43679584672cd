"""The bones of a skeleton as it stands: how long those of each joint are, and whether its axes fit them.

Pictures and pages take them from here, so that both show the same. All joints are worked out at once.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property

import numpy as np

from rigtri.frames.skeleton import ZERO_LENGTH, Skeleton
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length, normalise
from rigtri.model.dataclass import dataclass

_DEGREES = 180.0 / np.pi
# An axis farther than this from its bone, in degrees, is one that somebody sees to be off.
AIMED = 1.0
# Bones of no length are as long as this share of the figure.
_SHORT = 0.02


@dataclass(frozen=True)
class Miss:
    """How far the nearest axis of a joint is from a bone, in degrees, which axis, and to which joint."""

    degrees: float
    axis: str
    child: int


@dataclass(frozen=True, eq=False)
class Bones:
    """world: (n, 4, 4). size: of the figure, in file units, beside which a bone is one. seen: joints."""

    tree: Skeleton
    world: Floats
    size: float
    seen: Collection[int]

    @cached_property
    def misses(self) -> dict[int, Miss]:
        """Of each joint at which a bone begins, and whose axes have a direction, the least miss."""
        below = self.tree.below
        pairs = [(joint, child) for joint in self.tree.joints for child in below[joint]]
        starts, ends = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
        with np.errstate(all="ignore"):
            along = self.world[ends, 3, :3] - self.world[starts, 3, :3]
            axes = normalise(self.world[starts, :3, :3])
            # Rounded, so that equal angles stay equal: the file's order decides, not the last bit.
            turned = angle(np.concatenate([axes, -axes], axis=1), along[:, np.newaxis]) * _DEGREES
            off = np.round(turned, 3)
            clear = (length(along) > ZERO_LENGTH * self.size) & np.isfinite(off).all(axis=1)
        nearest = off.argmin(axis=1) if len(off) else np.zeros(0, dtype=np.int64)
        found: dict[int, Miss] = {}
        for row in np.flatnonzero(clear).tolist():
            joint, k = pairs[row][0], int(nearest[row])
            degrees = float(off[row, k])
            if joint not in found or degrees < found[joint].degrees:
                found[joint] = Miss(degrees, f"{'-' if k > 2 else '+'}{'xyz'[k % 3]}", pairs[row][1])
        return found

    def aimed(self, joint: int) -> Miss | None:
        """The miss of a joint whose axes are there for a bone: a root's show how the whole stands."""
        aims = self.tree.above[joint] >= 0 and self.tree.rig.is_joint[joint]
        return self.misses.get(joint) if aims else None

    def crooked(self, joint: int) -> bool:
        """Whether no axis of a joint points along a bone of its own."""
        miss = self.aimed(joint)
        return miss is not None and miss.degrees > AIMED

    @cached_property
    def _lengths(self) -> dict[int, float]:
        """How far each joint is from the one above it; for a root joint nan."""
        joints = np.array(self.tree.joints, dtype=np.int64)
        above = np.array([self.tree.above[joint] for joint in self.tree.joints], dtype=np.int64)
        with np.errstate(all="ignore"):
            far = length(self.world[above, 3, :3] - self.world[joints, 3, :3])
        far = np.where(above >= 0, far, np.nan)
        return dict(zip(self.tree.joints, far.tolist(), strict=True))

    @cached_property
    def _ours_unseen(self) -> frozenset[int]:
        return self.tree.rig.own - frozenset(self.seen)

    def reach(self, joint: int) -> float:
        """How long the bone of a joint counts: to the nearest joint below it, else from the one above."""
        least = ZERO_LENGTH * self.size
        around = [self._lengths[k] for k in self.tree.below[joint] if k not in self._ours_unseen]
        found = min((far for far in around if far > least), default=0.0)
        if not found and self.tree.above[joint] >= 0:
            found = self._lengths[joint]
        return found if np.isfinite(found) and found > least else _SHORT * self.size
