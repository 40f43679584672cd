"""merge-joints: joints go, and the joints above them take over their weights."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from heapq import heapify, heappop, heappush

import numpy as np

from rigtri.errors import GeometryError
from rigtri.frames.rig_size import size_of
from rigtri.maths.matrices import multiply, transform_points
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import distance
from rigtri.model.bounding_boxes import corners
from rigtri.model.rig import Rig
from rigtri.model.skin import JointMerge
from rigtri.operations.add_rivet.rebind import rebind_rivets_on_new_weights
from rigtri.operations.joint_records import joint_record
from rigtri.operations.moved_points import STILL, Moved, moved_by, moving_nodes, some_poses
from rigtri.operations.node_removal import staying, warn_lost_clips, without_nodes
from rigtri.operations.operation import operation
from rigtri.operations.options.merge_joints import MergeJointsOptions as MergeJointsOptions
from rigtri.operations.orient_joints.frame_sources import no_namesakes
from rigtri.operations.prune_joints import sockets, why_named
from rigtri.operations.reparented import reparented, uniform_parts
from rigtri.report import Report
from rigtri.text import and_more


@operation(MergeJointsOptions)
def merge_joints(rig: Rig, *, options: MergeJointsOptions, report: Report) -> Rig:
    """The rig without some joints; their vertices follow the nearest remaining ancestor.

    A joint that is named goes with all joints below it; one that never moves, or that another level of detail
    lacks, goes alone, and what is below it is parented to what is above. How far vertices move is measured
    when the file is written, and refused above the tolerance. Rivets on meshes that lose joints are baked
    anew. Raises GeometryError where something names a joint that is named.
    """
    if not rig.shown_clips:
        if options.still:
            raise GeometryError("--still: this file has no clips, so nothing says which joints move")
        report.warn("no-clips", "This file has no clips: vertices were compared in the rest pose alone")
    merging = _Merging(rig, options.exclude)
    named = sorted({node for glob in options.joints for node in _meant(rig, glob)})
    if options.keep_children:
        merging.spare_sockets(named)
    for node in reversed(named):  # those below first: what is left below the others stays
        merging.take_alone(node, "leave out --keep-children") if options.keep_children else merging.take(node)
    spared = {node for glob in options.exclude for node in rig.match(glob)}
    if options.still or options.lod is not None or options.max_joints is not None:
        spared |= merging.spare_sockets()
    if options.lod is not None:
        for node in reversed(_lacking(rig, options.lod)):
            if node not in spared:
                merging.take_alone(node, "keep it with --exclude")
    if options.still:
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
    less = without_nodes(reparented(rig, gone), gone, _folds(rig, merging))
    warn_lost_clips(rig, less, report)
    return rebind_rivets_on_new_weights(less, report)


def _meant(rig: Rig, glob: str) -> list[int]:
    """The nodes that match, without the controls among joints: '*hand*' is no name of hand_ctl."""
    found = rig.match(glob)
    return [node for node in found if rig.is_joint[node] or node not in rig.own] or list(found)


def _lacking(rig: Rig, lod: Rig) -> list[int]:
    """The joints that another level of detail does not have, by their names; those without a name stay."""
    named = [node for node in np.flatnonzero(rig.is_joint).tolist() if rig.names[node]]
    there = set(lod.names)
    found = [node for node in named if rig.names[node] not in there]
    if len(found) == len(named):
        raise GeometryError(no_namesakes(rig, lod, "--lod"))
    return found


def _warn_unmerged(rig: Rig, still: Sequence[int], report: Report) -> None:
    if still:
        names = and_more([rig.title(node) for node in still], 6)
        why = (
            "they have a mesh, camera or light, or a scale that is not uniform, or the file or rigtri's "
            "metadata name them or count from them"
        )
        report.warn("still-kept", f"{names} never move against the joints above them, and stay: {why}")


class _Merging:
    """Which nodes go so far, each with all that is below it, or alone."""

    def __init__(self, rig: Rig, exclude: Collection[str]) -> None:
        self.rig, self.gone = rig, set[int]()
        # As they are without the nodes that went alone.
        self._above: list[int] = rig.parents.tolist()
        self._children = list(map(list, rig.children))
        self._next = self._above.copy()
        self._skins = [frozenset(skin.joints.tolist()) for skin in rig.skins]
        # Why nodes stay, for those that do not stay for the sake of others below them.
        self._reasons = why_named(rig)
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
        # What counts from its parent keeps it.
        self._tied = {*rig.rules.fixed, *rig.rules.unread, *self._counting()}
        self._moving = moving_nodes(rig)
        self._moving[list(rig.rules.unread)] = True
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

    def _counting(self) -> set[int]:
        """Nodes for which their place below their parents means something, to constraints or to springs."""
        rig, ends = self.rig, {each.node for each in self.rig.node_constraints if each.kind == "tail"}
        found = {node for each in rig.node_constraints for node in (each.node, each.source)} - {-1}
        for node in rig.nodes_of("constraint", "poseReader", "twist"):
            found |= {node, *rig.named_by(rig.metadata[node])}
        return found | rig.with_ancestors(ends)

    def spare_sockets(self, named: Collection[int] = ()) -> set[int]:
        """Let sockets that are left stay, with what is above them: nobody has named these."""
        spared = sockets(self.rig) - self.gone - set(named)
        self.kept |= self.rig.with_ancestors(spared)
        self._reasons |= dict.fromkeys(spared, "is a socket")
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
        """Let a joint go with all joints below it: the joints that no joint is below any more.

        What else is needed below them is parented anew. GeometryError where something needs one of them.
        """
        below = [] if node in self.gone else [node]
        for each in below:  # it grows as it is walked
            below += [c for c in self._children[each] if c not in self.gone and not self._hangs(c)]
        self._refuse(node, {each: self._reasons[each] for each in below if each in self._reasons})
        hung = {child for each in below for child in self._children[each]} - self.gone.union(below)
        self._refuse(node, dict.fromkeys(hung & self._tied, "counts from its parent"))
        return self._go(node, below) if below else []

    def _hangs(self, node: int) -> bool:
        """Whether a node that is no joint, nor has any below it, stays as a child of something else.

        What nothing shows or names is the end of a joint, but not if it moves.
        """
        stays = node in self.kept or self._moving[node]
        return bool(stays and node not in self._joints and not self._staying[node])

    def _refuse(self, node: int, reasons: Mapping[int, str]) -> None:
        if reasons:
            named = [k for k in sorted(reasons) if k != node]
            whose = ([f"it {reasons[node]}"] if node in reasons else []) + [
                f"'{self.rig.title(k)}' below it {reasons[k]}" for k in named
            ]
            raise GeometryError(
                f"'{self.rig.title(node)}' cannot be merged: {and_more(whose, 3)}. Leave it out"
            )

    def take_alone(self, node: int, otherwise: str) -> None:
        """Let a joint go, and parent what stays below it anew; GeometryError where that is not possible.

        otherwise: what else can be done about a joint that moves.
        """
        if node in self.gone:
            return
        self._refuse(node, self._why_not_alone(node))
        if self._moving[node] and (below := self._below(node)):
            raise GeometryError(
                f"'{self.rig.title(node)}' moves in a clip, and '{self.rig.title(below[0])}' below it stays: "
                f"name the joints below it, too, or {otherwise}"
            )
        self._take_alone(node)

    def _below(self, node: int) -> list[int]:
        """The children that stay where their parent goes alone: not the bare ends of a joint."""
        left = [child for child in self._children[node] if child not in self.gone]
        if node not in self._joints:
            return left
        return [c for c in left if c in self._joints or self._staying[c] or self._hangs(c)]

    def _why_not_alone(self, node: int) -> dict[int, str]:
        """What keeps a joint from going alone, and why."""
        below = self._below(node)
        found = {child: "counts from its parent" for child in below if child in self._tied}
        if below and uniform_parts(self.rig.normalised_local[node]) is None:
            found[node] = "has a scale that is not uniform"
        return found | ({node: self._reasons[node]} if node in self._reasons else {})

    def _take_alone(self, node: int) -> None:
        """Let a joint go; its children become those of its parent."""
        above, below = self._above[node], self._below(node)
        gone = [node]
        for each in gone:  # it grows as it is walked
            gone += [c for c in self._children[each] if c not in self.gone and c not in below]
        self._staying[above] += sum(child in self._joints or self._staying[child] > 0 for child in below)
        self._staying[node] = 0
        self._children[above] += below
        for child in below:
            self._above[child] = above
        self._go(node, gone)

    def _go(self, node: int, nodes: Collection[int]) -> list[int]:
        """Let nodes go, of which one is above the others: the joints that no joint is below any more."""
        above, held = self._above[node], node in self._joints or self._staying[node]
        self.gone.update(nodes)
        while held and above >= 0:
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

    def take_still(self, most: int = 0) -> list[int]:
        """Let joints go alone that never move against their heirs, until so many are left; which stay."""
        size, rest = size_of(self.rig, self.rig.content.outlines), self.rig.world[np.newaxis]
        left, stay = len(self._joints - self.gone), []
        for node in sorted(self._joints - self.gone, reverse=True):  # those below first
            heir, way = self.heir(node), node
            while way != heir and not self._moving[way]:
                way = self._above[way]
            if left <= most or heir < 0 or way != heir or self.cost(node, rest, alone=True) > STILL * size:
                continue
            if self._why_not_alone(node):
                stay.append(node)
                continue
            self._take_alone(node)
            left -= 1
            for moved in self._moved:
                moved.inherit(heir, node)
        return sorted(stay)

    def take_least(self, most: int) -> None:
        if self.rig.shown_clips:
            self.take_still(most)
        poses = some_poses(self.rig)
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
    def _moved(self) -> list[Moved]:
        meshes = self.rig.content.outlines
        return [moved_by(self.rig, mesh) for mesh in meshes if mesh.skin is not None and mesh.joints.shape[1]]

    def cost(self, node: int, poses: Floats, *, alone: bool = False) -> float:
        """How far the points of a joint move at most where they follow its heir; poses: (f, n, 4, 4).

        And those of all that is below it, unless it is to go alone.
        """
        heir, far = self.heir(node), 0.0
        for moved in self._moved:
            rows, skin = moved.rows, moved.skin
            boxes = moved.own if alone else moved.whole
            if not np.isfinite(boxes.share[node]) or heir not in rows:
                continue
            points = transform_points(corners(boxes.low[[node]], boxes.high[[node]])[0], moved.bind)
            one, other = (
                (
                    transform_points(points, multiply(skin.inverse_bind[rows[k]], poses[:, k])[:, np.newaxis])
                    for k in (node, heir)
                )
                if node in rows
                else (points, points)
            )
            far = max(far, float(boxes.share[node]) * float(distance(one, other).max()))
        return far


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
