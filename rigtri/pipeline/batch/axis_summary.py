"""What a skeleton is, and which axes its joints have, small enough for a million files."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from rigtri.evaluation import bind_pose
from rigtri.maths.quaternions import angle_between, from_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, length
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig

# A component of a quaternion in 16 bits: 0.004° at most.
_UNIT, _STORED = 32767, np.dtype("<i2")


@dataclass(frozen=True)
class Axes:
    """The joints of a rig, parents and names as JSON, and their frames as quaternions of 16-bit numbers."""

    joints: str
    turns: bytes

    @property
    def skeleton(self) -> str:
        """The same for all files whose joints have the same names and parents."""
        return hashlib.sha256(self.joints.encode()).hexdigest()[:16]


def axes_of(rig: Rig, *, at_rest: bool = False) -> Axes | None:
    """The axes of all joints of a rig in its bind pose, or at rest; None where it has none."""
    joints = [node for node in np.flatnonzero(rig.is_joint).tolist() if node not in rig.pending.removed]
    if not joints:
        return None
    place = {node: k for k, node in enumerate(joints)}
    hierarchy = [[_above(rig, node, place), rig.names[node] or rig.labels[node]] for node in joints]
    frames = np.full((len(rig), 4, 4), np.nan)
    for skin in () if at_rest else rig.skins:
        posed = bind_pose.bind_frames(rig, skin)
        known = np.isfinite(posed).all(axis=(1, 2))
        frames[skin.joints[known]] = posed[known]
    if np.isnan(frames[joints]).any():  # some joints have no bind pose: as they stand at rest
        frames = np.where(np.isnan(frames), rig.world, frames)
    turns = _turns(frames[joints])
    return Axes(json.dumps(hierarchy), np.rint(turns * _UNIT).astype(_STORED).tobytes())


def _above(rig: Rig, node: int, place: dict[int, int]) -> int:
    """The nearest joint above, -1 for none."""
    above = int(rig.parents[node])
    while above >= 0 and above not in place:
        above = int(rig.parents[above])
    return place.get(above, -1)


def _turns(frames: Floats) -> Floats:
    """Unit quaternions of matrices that may be scaled or mirrored; of flat ones the one of no turn."""
    rows = frames[:, :3, :3]
    size = length(rows)
    flat = np.asarray(~((size > 0) & np.isfinite(size)).all(axis=1))
    rows = np.where(flat[:, None, None], np.eye(3), rows / np.where(size > 0, size, 1.0)[..., None])
    mirrored = np.asarray(dot(cross(rows[:, 0], rows[:, 1]), rows[:, 2]) < 0)
    return from_axes(np.where(mirrored[:, None, None], -rows, rows))


def angles(one: bytes, other: bytes) -> Floats:
    """How far the frames of each joint are apart, in degrees."""
    a, b = (np.frombuffer(turns, dtype=_STORED).reshape(-1, 4).astype(np.float64) for turns in (one, other))
    found: Floats = angle_between(a, b) * (180.0 / np.pi)
    return found


def fit(joints: str, turns: bytes) -> bool:
    """Whether these are what `Axes` of one skeleton has, which somebody may have damaged since."""
    return len(turns) == _turns_of(joints)


@lru_cache(256)  # most files of a batch have one of a few skeletons
def _turns_of(joints: str) -> int:
    """How many bytes the turns of joints have; -1 for no joints."""
    try:
        found = names(joints)
    except (ValueError, TypeError, RecursionError):
        return -1
    return len(found) * 4 * _STORED.itemsize if all(isinstance(name, str) for name in found) else -1


def names(joints: str) -> Sequence[str]:
    """The names of the joints of `Axes.joints`."""
    return [name for _, name in json.loads(joints)]
