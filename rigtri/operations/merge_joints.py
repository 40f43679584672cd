"""merge-joints: joints go, and the joints above them take over their weights."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import cached_property
from heapq import heapify, heappop, heappush
from typing import NamedTuple

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import key_times, locals_at, thinned, worlds
from rigtri.frames.rig_size import size_of
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import multiply, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import distance
from rigtri.model.animation import key_values
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import JointMerge, Skin
from rigtri.operations.joint_records import joint_record
from rigtri.operations.operation import operation
from rigtri.operations.options.merge_joints import MergeJointsOptions as MergeJointsOptions
from rigtri.operations.prune_joints import named_nodes, sockets
from rigtri.operations.without_nodes import staying, warn_lost_clips, without_nodes
from rigtri.report import Report
from rigtri.text import and_more

# A joint that moves its points by no more against the one above, as a share of the size, is still.
STILL = 1e-6
# Key times of each clip at which it is looked how far a merge moves points.
_SAMPLES = 8


@operation(MergeJointsOptions)
def merge_joints(rig: Rig, *, options: MergeJointsOptions, report: Report) -> Rig:
    """The rig without some joints; their vertices follow the nearest remaining ancestor.

    A joint goes with all below it. How far vertices move is measured when the file is written, and refused
    above the tolerance. Raises GeometryError where a joint that is named has a mesh below it, or something
    names it.
    """
    if not rig.shown_clips:
        if options.still:
            raise GeometryError("--still: this file has no clips, so nothing says which joints move")
        report.warn("no-clips", "This file has no clips: vertices were compared in the rest pose alone")
    merging = _Merging(rig, options.exclude)
    for glob in options.joints:
        for node in rig.match(glob):
            merging.take(node)
    spared = merging.spare_sockets() if options.still or options.max_joints is not None else set[int]()
    if options.still:
        excluded = rig.with_ancestors([node for glob in options.exclude for node in rig.match(glob)])
        spared |= excluded
        _warn_unmerged(rig, [node for node in merging.take_still() if node not in spared], report)
    if options.max_joints is not None:
        merging.take_least(options.max_joints)
    gone = merging.gone
    for node in sorted(gone):
        heir = merging.heir(node)
        more = {} if heir < 0 else {"heir": rig.title(heir)}
        report.joints.append(joint_record(rig, node, "removed", **more))
    if not gone:
        return rig
    less = without_nodes(rig, gone, _folds(rig, merging))
    warn_lost_clips(rig, less, report)
    return less


def _warn_unmerged(rig: Rig, still: Sequence[int], report: Report) -> None:
    if still:
        names = and_more([rig.title(node) for node in still], 6)
        why = "have a mesh, camera or light, are sockets, or the file or rigtri's metadata name them"
        stay = "never move against the joints above them, and stay: they or joints below"
        report.warn("still-kept", f"{names} {stay} {why}")


class _Merging:
    """Which joints go so far. While a joint stays, so does its heir: nodes go with all that is below them."""

    def __init__(self, rig: Rig, exclude: Collection[str]) -> None:
        self.rig, self.gone = rig, set[int]()
        self._above: list[int] = rig.parents.tolist()
        self._next = self._above.copy()
        self._skins = [frozenset(skin.joints.tolist()) for skin in rig.skins]
        # Why nodes stay, for those that do not stay for the sake of others below them.
        self._reasons = dict.fromkeys(named_nodes(rig), "is named by the file or rigtri's metadata")
        drawn = np.flatnonzero(rig.attachment >= 0).tolist()
        self._reasons |= dict.fromkeys(drawn, "has a mesh, camera or light")
        excluded = {node for glob in exclude for node in rig.match(glob)}
        self._reasons |= dict.fromkeys(excluded, "is kept by --exclude")
        self.kept = set[int]()
        for node in self._reasons:
            while node >= 0 and node not in self.kept:
                self.kept.add(node)
                node = self._above[node]
        # What nothing above could take over stays: joints, and the top nodes of a plain hierarchy.
        alone = [node for node in self._joints if self.heir(node) < 0]
        self._reasons |= dict.fromkeys(alone, "has no joint above it that is in all its skins")
        tops = np.flatnonzero(rig.parents < 0).tolist()
        self._reasons |= dict.fromkeys(tops, "has no parent")
        self.kept.update(alone, tops)
        # How many children each node has at or below which a joint stays.
        self._staying = [0] * len(rig)
        holds = [node in self._joints for node in range(len(rig))]
        for node in range(len(rig) - 1, 0, -1):
            if holds[node] and self._above[node] >= 0:
                holds[self._above[node]] = True
                self._staying[self._above[node]] += 1

    def spare_sockets(self) -> set[int]:
        """Let sockets that are left stay, with what is above them: nobody has named these."""
        spared = sockets(self.rig) - self.gone
        self.kept |= self.rig.with_ancestors(spared)
        return spared

    def heir(self, node: int) -> int:
        """The nearest joint above that stays, of every skin that has the node; −1 for none."""
        skins = [joints for joints in self._skins if node in joints]
        above = self._standing(self._above[node]) if skins else -1
        while above >= 0 and not all(above in joints for joints in skins):
            above = self._standing(self._above[above])
        return above

    def _standing(self, node: int) -> int:
        """The nearest node at or above that stays; what was passed on the way is skipped from then on."""
        line = []
        while node in self.gone:
            line.append(node)
            node = self._next[node]
        for gone in line:
            self._next[gone] = node
        return node

    def take(self, node: int) -> list[int]:
        """Let a joint go with all below it: the joints that no joint is below any more.

        GeometryError where something needs one of them.
        """
        below = [] if node in self.gone else [node]
        for each in below:  # it grows as it is walked
            below += [child for child in self.rig.children[each] if child not in self.gone]
        if needed := sorted(self._reasons.keys() & set(below)):
            reasons = [f"'{self.rig.title(each)}' {self._reasons[each]}" for each in needed]
            raise GeometryError(
                f"'{self.rig.title(node)}' cannot be merged: {and_more(reasons, 3)}. Leave it out"
            )
        self.gone.update(below)
        held = node in self._joints or self._staying[node]
        above = self._above[node] if below and held else -1
        while above >= 0:
            self._staying[above] -= 1
            if self._staying[above] or above in self._joints:
                return [above] if self._may_go(above) else []
            above = self._above[above]
        return []

    def _may_go(self, node: int) -> bool:
        """Whether a joint may go and has no joint below that stays."""
        return not self._staying[node] and node not in self.gone and node not in self.kept

    def leaves(self) -> list[int]:
        """Joints that may go and have no joint below that stays."""
        return [node for node in sorted(self._joints) if self._may_go(node)]

    def take_still(self) -> list[int]:
        """Let joints go that never move against their heirs; those that do not either, but are needed."""
        rig = self.rig
        moving = moving_nodes(rig)
        size = size_of(rig, rig.content.read_outlines())

        def is_still(node: int) -> bool:
            heir, way = self.heir(node), node
            while way != heir and not moving[way]:
                way = self._above[way]
            return way == heir and self.cost(node, rig.world[np.newaxis]) <= STILL * size

        left = self.leaves()
        while left:
            if is_still(node := left.pop()):
                left += self.take(node)
        still = set[int]()  # with all that is below them
        for node in range(len(rig) - 1, -1, -1):
            if all(child in still for child in rig.children[node]):
                needed = self.heir(node) >= 0 and is_still(node) if node in self._joints - self.gone else True
                still |= {node} if needed else set[int]()
        return sorted(still & self._joints - self.gone)

    def take_least(self, most: int) -> None:
        poses = _poses(self.rig)
        heap = [(self.cost(node, poses), node) for node in self.leaves()]
        heapify(heap)
        while len(self._joints - self.gone) > most:
            if not heap:
                left = len(self._joints - self.gone)
                raise GeometryError(f"--max-joints {most}: no fewer than {left} joints are possible")
            for leaf in self.take(heappop(heap)[1]):
                heappush(heap, (self.cost(leaf, poses), leaf))

    @cached_property
    def _joints(self) -> set[int]:
        return set(np.flatnonzero(self.rig.is_joint).tolist())

    @cached_property
    def _moved(self) -> list[_Moved]:
        meshes = self.rig.content.read_outlines()
        return [_moved(self.rig, mesh) for mesh in meshes if mesh.skin is not None and mesh.joints.shape[1]]

    def cost(self, node: int, poses: Floats) -> float:
        """How far the points of a joint move at most where they follow its heir; poses: (f, n, 4, 4)."""
        heir, far = self.heir(node), 0.0
        for moved in self._moved:
            rows, skin = moved.rows, moved.skin
            if not np.isfinite(moved.share[node]) or heir not in rows:
                continue
            points = transform_points(_corners(moved.low[node], moved.high[node]), moved.bind)
            one, other = (
                (
                    transform_points(points, multiply(skin.inverse_bind[rows[k]], poses[:, k])[:, np.newaxis])
                    for k in (node, heir)
                )
                if node in rows
                else (points, points)
            )
            far = max(far, float(moved.share[node]) * float(distance(one, other).max()))
        return far


class _Moved(NamedTuple):
    """What each node and those below it move of a mesh: the box of the points, and the largest weight.

    low, high: (n, 3). share: (n,), −inf for nothing. rows: of joints in the skin.
    """

    skin: Skin
    rows: dict[int, int]
    bind: Floats
    share: Floats
    low: Floats
    high: Floats


def _moved(rig: Rig, mesh: Mesh) -> _Moved:
    skin = rig.skins[mesh.skin or 0]
    share = np.full(len(rig), -np.inf)
    low, high = np.full((len(rig), 3), np.inf), np.full((len(rig), 3), -np.inf)
    point, slot = np.nonzero((mesh.weights != 0) & (mesh.joints < len(skin.joints)))
    nodes = skin.joints[mesh.joints[point, slot]]
    np.maximum.at(share, nodes, np.maximum(mesh.weights[point, slot], 0.0))
    np.minimum.at(low, nodes, mesh.points[point])
    np.maximum.at(high, nodes, mesh.points[point])
    for level in reversed(rig.levels[1:]):
        parents = rig.parents[level]
        np.maximum.at(share, parents, share[level])
        np.minimum.at(low, parents, low[level])
        np.maximum.at(high, parents, high[level])
    rows = {joint: row for row, joint in enumerate(skin.joints.tolist())}
    return _Moved(skin, rows, mesh.bind, share, low, high)


def _corners(low: Floats, high: Floats) -> Floats:
    """The corners of a box, (8, 3)."""
    return np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])


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
                off = min(off, float(np.abs(values + rest).max(initial=0.0)))
            found[track.node] |= bool(off > STILL * max(1.0, float(np.abs(rest).max())))
    return found


def _poses(rig: Rig) -> Floats:
    """Where nodes are in the world at rest and at some keys of every clip, (f, n, 4, 4)."""
    found = [worlds(rig, rig.normalised_local[np.newaxis])]
    for clip in rig.shown_clips:
        times = key_times(clip)
        if len(times):
            found.append(worlds(rig, locals_at(rig, clip, thinned(times, _SAMPLES))))
    return np.concatenate(found)


def _folds(rig: Rig, merging: _Merging) -> list[JointMerge]:
    """Who inherits the weights of each skin's joints that go."""
    folds = []
    for number, skin in enumerate(rig.skins):
        joints = skin.joints.tolist()
        stays = staying(skin, merging.gone)
        if skin.key is None or stays.all():
            continue
        place, rows = np.cumsum(stays) - 1, np.zeros(len(joints), dtype=np.int64)
        row_of = {joint: row for row, joint in enumerate(joints)}
        for row, joint in enumerate(joints):
            heir = joint if stays[row] else merging.heir(joint)
            rows[row] = place[row_of[heir]]
        folds.append(JointMerge(number, rows, np.zeros(len(joints)), {}, idle=False))
    return folds
