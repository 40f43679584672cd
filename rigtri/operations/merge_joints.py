"""merge-joints: joints go, and the joints above them take over their weights."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import key_times, locals_at, thinned, worlds
from rigtri.frames.rig_size import size_of
from rigtri.maths.arrays import Booleans
from rigtri.maths.matrices import multiply, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import distance
from rigtri.model.animation import key_values
from rigtri.model.rig import Rig
from rigtri.model.skin import JointMerge
from rigtri.operations.joint_records import joint_record
from rigtri.operations.operation import operation
from rigtri.operations.options.merge_joints import MergeJointsOptions as MergeJointsOptions
from rigtri.operations.prune_joints import named_nodes
from rigtri.operations.without_nodes import staying, without_nodes
from rigtri.report import Report
from rigtri.text import listed

# A joint that moves its points by no more against the one above, as a share of the size, is still.
STILL = 1e-6
# Key times of each clip at which it is looked how far a merge moves points.
_SAMPLES = 8


@operation(MergeJointsOptions)
def merge_joints(rig: Rig, *, options: MergeJointsOptions, report: Report) -> Rig:
    """The rig without some joints; points follow the nearest joint above that stays in their place.

    A joint goes with all below it. How far vertices move is measured when the file is written, and refused
    above the tolerance. Raises GeometryError where a mesh hangs below a joint that is named, or something
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
    if options.still:
        merging.take_still()
    if options.max_joints is not None:
        merging.take_least(options.max_joints)
    gone = merging.gone
    for node in sorted(gone):
        heir = merging.heir(node)
        more = {} if heir < 0 else {"heir": rig.title(heir)}
        report.joints.append(joint_record(rig, node, "removed", **more))
    return without_nodes(rig, gone, _folds(rig, merging)) if gone else rig


class _Merging:
    """Which joints go so far; boxes: of the points that each joint of a skin moves, (m, 8, 3)."""

    def __init__(self, rig: Rig, exclude: Collection[str]) -> None:
        self.rig, self.gone = rig, set[int]()
        kept = named_nodes(rig) | set(np.flatnonzero(rig.attachment >= 0).tolist())
        kept |= {node for glob in exclude for node in rig.match(glob)}
        self.kept = {above for node in kept for above in rig.path_to_root(node)}
        self.kept |= {node for node in np.flatnonzero(rig.is_joint).tolist() if self.heir(node) < 0}

    def heir(self, node: int) -> int:
        """The nearest joint above that stays, of every skin that has the node; −1 for none."""
        skins = [skin for skin in self.rig.skins if node in skin.joints]
        for above in self.rig.path_to_root(node)[1:]:
            if above not in self.gone and skins and all(above in skin.joints for skin in skins):
                return above
        return -1

    def take(self, node: int) -> None:
        """Let a joint go with all below it. GeometryError where something needs one of them."""
        below = set(self.rig.below(node))
        if needed := sorted(below & self.kept):
            names = listed([self.rig.title(each) for each in needed], 4)
            raise GeometryError(
                f"'{self.rig.title(node)}' cannot be merged: a mesh hangs at {names} or below, or the file "
                "or rigtri's metadata name it, or no joint above is in its skin. Leave it out"
            )
        self.gone |= below

    def leaves(self) -> list[int]:
        """Joints that may go and have no joint below that stays."""
        joints = [node for node in np.flatnonzero(self.rig.is_joint).tolist() if node not in self.gone]
        above = {over for node in joints for over in self.rig.path_to_root(node)[1:]}
        return [node for node in joints if node not in above and node not in self.kept]

    def take_still(self) -> None:
        rig = self.rig
        moving = _moving(rig)
        size = size_of(rig, rig.content.read_outlines())
        found = True
        while found:
            found = False
            for node in self.leaves():
                heir = self.heir(node)
                way = [k for k in rig.path_to_root(node) if k != heir and rig.is_below(k, heir)]
                if not moving[way].any() and self.cost(node, rig.world[np.newaxis]) <= STILL * size:
                    self.take(node)
                    found = True

    def take_least(self, most: int) -> None:
        poses = _poses(self.rig)
        costs: dict[tuple[int, int], float] = {}
        while len(self._joints - self.gone) > most:
            leaves = [(node, self.heir(node)) for node in self.leaves()]
            if not leaves:
                left = len(self._joints - self.gone)
                raise GeometryError(f"--max-joints {most}: no fewer than {left} joints are possible")
            for pair in leaves:
                if pair not in costs:
                    costs[pair] = self.cost(pair[0], poses)
            self.take(min(leaves, key=lambda pair: (costs[pair], pair))[0])

    @cached_property
    def _joints(self) -> set[int]:
        return set(np.flatnonzero(self.rig.is_joint).tolist())

    def cost(self, node: int, poses: Floats) -> float:
        """How far the points of a joint move at most where they follow its heir; poses: (f, n, 4, 4)."""
        heir, far = self.heir(node), 0.0
        for mesh in self.rig.content.read_outlines():
            if mesh.skin is None or not mesh.joints.shape[1]:
                continue
            skin = self.rig.skins[mesh.skin]
            rows = {joint: row for row, joint in enumerate(skin.joints.tolist())}
            mine = [rows[k] for k in self.rig.below(node) if k in rows]
            inside = np.isin(mesh.joints, mine) & (mesh.weights != 0)
            touched = inside.any(axis=1)
            if not touched.any() or heir not in rows:
                continue
            share = float(np.where(inside, mesh.weights, 0.0)[touched].max())
            points = transform_points(_corners(mesh.points[touched]), mesh.bind)
            one, other = (
                (
                    transform_points(points, multiply(skin.inverse_bind[rows[k]], poses[:, k])[:, np.newaxis])
                    for k in (node, heir)
                )
                if node in rows
                else (points, points)
            )
            far = max(far, share * float(distance(one, other).max()))
        return far


def _corners(points: Floats) -> Floats:
    """The corners of the box of points, (8, 3)."""
    low, high = points.min(axis=0), points.max(axis=0)
    return np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])


def _moving(rig: Rig) -> Booleans:
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
        for row, joint in enumerate(joints):
            heir = joint if stays[row] else merging.heir(joint)
            rows[row] = place[joints.index(heir)]
        folds.append(JointMerge(number, rows, np.zeros(len(joints)), {}, idle=False))
    return folds
