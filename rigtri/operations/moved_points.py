"""What joints move of the meshes, as boxes: how far a merge may move it."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rigtri.evaluation.sampling import key_times, locals_at, thinned, worlds
from rigtri.maths.arrays import Booleans
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import key_values
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# A joint that moves its points by no more against the one above, as a share of the size, is still.
STILL = 1e-6
# Key times of each clip at which it is looked how far a merge moves points.
_SAMPLES = 8


class _Boxes(NamedTuple):
    """Of what nodes move of a mesh: the largest weight, (n,), −inf for none, and the points' box, (n, 3)."""

    share: Floats
    low: Floats
    high: Floats

    def gather(self, node: Any, others: Any) -> None:
        """Let nodes move what others move, too; numbers, or arrays of them."""
        np.maximum.at(self.share, node, self.share[others])
        np.minimum.at(self.low, node, self.low[others])
        np.maximum.at(self.high, node, self.high[others])


class Moved(NamedTuple):
    """What each node moves of a mesh: by itself, and with all below it. rows: of joints in the skin."""

    skin: Skin
    rows: dict[int, int]
    bind: Floats
    own: _Boxes
    whole: _Boxes

    def inherit(self, heir: int, node: int) -> None:
        """Let a joint move what another one moved that goes."""
        self.own.gather([heir], [node])


def moved_by(rig: Rig, mesh: Mesh) -> Moved:
    """What the joints of a skinned mesh move of it, in its bind pose."""
    skin = rig.skins[mesh.skin or 0]
    share = np.full(len(rig), -np.inf)
    low, high = np.full((len(rig), 3), np.inf), np.full((len(rig), 3), -np.inf)
    point, slot = np.nonzero((mesh.weights != 0) & (mesh.joints < len(skin.joints)))
    nodes = skin.joints[mesh.joints[point, slot]]
    np.maximum.at(share, nodes, np.maximum(mesh.weights[point, slot], 0.0))
    np.minimum.at(low, nodes, mesh.points[point])
    np.maximum.at(high, nodes, mesh.points[point])
    whole = _Boxes(share.copy(), low.copy(), high.copy())
    for level in reversed(rig.levels[1:]):
        whole.gather(rig.parents[level], level)
    rows = {joint: row for row, joint in enumerate(skin.joints.tolist())}
    return Moved(skin, rows, mesh.bind, _Boxes(share, low, high), whole)


def moving_nodes(rig: Rig) -> Booleans:
    """The nodes that a clip moves away from their rest pose, (n,)."""
    found = np.zeros(len(rig), dtype=bool)
    for clip in rig.clips:
        for track in clip.tracks:
            if track.path == "weights":
                continue
            rest = getattr(rig, track.path)[track.node]
            values = key_values(track)
            off = np.abs(values - rest).max(initial=0.0)
            if track.path == "rotation":
                off = 2.0 * min(off, float(np.abs(values + rest).max(initial=0.0)))  # half of the angle
            found[track.node] |= bool(off > STILL * max(1.0, float(np.abs(rest).max())))
    return found


def some_poses(rig: Rig) -> Floats:
    """Where nodes are in the world at rest and at some keys of every clip, (f, n, 4, 4)."""
    found = [worlds(rig, rig.normalised_local[np.newaxis])]
    for clip in rig.shown_clips:
        times = key_times(clip)
        if len(times):
            found.append(worlds(rig, locals_at(rig, clip, thinned(times, _SAMPLES))))
    return np.concatenate(found)
