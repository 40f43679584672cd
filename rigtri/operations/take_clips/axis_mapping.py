"""Nodes of two files that correspond, and how the axes of one map to those of the other.

C of a node and G of the two worlds are such that, at all times of the same motion,
``world = C · other world · G`` (row matrices). Of a joint, C comes from the inverse bind matrices of
both files: what is stored as rest is a pose in one file and the bind pose in the other.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from rigtri.evaluation.active_controls import skeleton_size
from rigtri.maths.matrices import (
    SKEW,
    determinant,
    from_frame,
    inverse,
    multiply,
    nearest_rotation,
    transform_directions,
)
from rigtri.maths.matrices import skew as skewed
from rigtri.maths.similarity_fit import (
    AXIS_TURNS,
    ONE_UNIT,
    OTHER_SHAPE,
    SAME_PLACE,
    SAME_SIZE,
    SAME_TURN,
    fit_similarity,
    nearest_axis_turn,
    snapped_turn,
    upright_turn,
)
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.animation import key_values
from rigtri.model.rig import Rig
from rigtri.operations.bake.unbaked import unbaked
from rigtri.operations.take_clips.bind_axes import BoundAxes, median_ratio
from rigtri.operations.take_clips.bind_space import MOST_DEGREES, SHORT, largest_angle, world_turns
from rigtri.operations.take_clips.node_matching import pairs


def _moved(exact: Floats, rounded: Floats) -> float:
    """How far the axes of a matrix have moved, as a share of their size."""
    size = float(length(rounded[:3, :3]).max())
    far = float(np.abs(exact[:3, :3] - rounded[:3, :3]).max())
    return far / size if np.isfinite(far) and size > 0 else 0.0


class Counterparts:
    """The pairs of two rigs with their C and G. moving: nodes of the other that any of its clips moves.
    turned: the rotation of G, (3, 3), where it is known. at_rest: that of the bind poses, (3, 3), where these
    are the rest poses of one standard skeleton.

    The rest of a node that moves and is no joint may be the frame that the DCC has shown while it
    wrote: such a node has the axes that its parent's rotation gives.
    """

    def __init__(
        self, rig: Rig, other: Rig, turned: Floats | None = None, at_rest: Floats | None = None
    ) -> None:
        self.rig, self.other, self.turned, self.at_rest = rig, other, turned, at_rest
        found = pairs(rig, other)
        self.of, self.unclear, self.placed = found.of, found.unclear, found.placed
        self.back = {theirs: ours for ours, theirs in self.of.items()}
        self.moving = {t.node for clip in other.clips for t in clip.tracks if t.path != "weights"}
        binds = BoundAxes(rig, other, self.of, at_rest)
        self._bound, self.proportions, self.bind_turn = binds.turns, binds.apart, binds.turn
        self.at_one_place = binds.at_one_place
        self._lines: dict[int, tuple[list[int], list[int], int]] = {}
        self._between: dict[int, Floats] = {}
        self.turns: dict[int, Floats] = {}
        self._rounded: dict[tuple[int, str], float] = {}
        # Moved nodes outside RIG's skins, whose axes are taken to differ as those above do.
        self.inherited: set[int] = set()
        for node in sorted(self.of):
            turn = self._turn(node)
            self.turns[node] = self.snapped(turn)
            self._rounded[node, "C"] = _moved(turn, self.turns[node])

    def slack(self, node: int) -> float:
        """How much C and D of a node, and C of the node above, were rounded: radians, or shares of a size."""
        self.between(node)
        above = self.line(node)[2]
        own = self._rounded[node, "C"] + self._rounded[node, "D"]
        return own + (self._rounded[above, "C"] if above >= 0 else 0.0)

    @property
    def bound(self) -> frozenset[int]:
        """The joints whose C comes from the bind poses of both files."""
        return frozenset(self._bound)

    @cached_property
    def baked(self) -> bool:
        """Whether the joints of the other have the motion of its controls in keys of their own."""
        return not unbaked(self.other)

    @cached_property
    def unbound(self) -> list[int]:
        """The nodes of the body whose axes bind poses do not show: joints, and nodes outside RIG's skins.

        Of the latter those that EDITED moves, if it binds them or they are below a joint or what moves.
        What carries the whole body is none, nor is what rigtri made: programs keep the axes of such nodes.
        """
        rig, other = self.rig, self.other
        above_joints = rig.with_ancestors(np.flatnonzero(rig.is_joint).tolist())

        def counts(node: int) -> bool:
            if rig.is_joint[node]:
                return node not in self._bound
            if node not in self.inherited or node in rig.own or self._looks(node):
                return False
            if any(rig.is_joint[k] for k in rig.path_to_root(node)):
                return True
            beside_body = bool(above_joints) and self.of.get(self.line(node)[2]) in self.moving
            return node not in above_joints and (beside_body or bool(other.is_joint[self.of[node]]))

        return [node for node in sorted(self.of) if counts(node)]

    @cached_property
    def space(self) -> Floats:
        """G, (4, 4): the world of the other file as this one sees it."""
        still = [n for n, k in self.of.items() if self.rig.is_joint[n] or k not in self.moving]
        ours = self.rig.world[still, 3, :3]
        theirs = self.other.world[[self.of[n] for n in still], 3, :3]
        fit = np.isfinite(ours).all(axis=1) & np.isfinite(theirs).all(axis=1)
        points = theirs[fit], ours[fit]
        return fit_similarity(*points, about_origin=True, ratio=self._ratio, turn=self._turned).matrix

    @cached_property
    def _turned(self) -> Floats | None:
        """The rotation of G, (3, 3), from bind poses, so that either file may rest in any pose; None without.

        EDITED's world as its bind pose sees it, EDITED's bind pose as RIG's, and that as RIG's world. Up goes
        to up, and a body faces where EDITED has it, wherever that may come from what stands above the joints.
        A bind pose may also lean as a whole, as a DCC binds in the pose that it was given.
        """
        if self.turned is not None:
            return self.turned
        if self.bind_turn is None:
            return self._turned_bare
        upright = upright_turn(self.other.rules.up, self.rig.rules.up)
        for turn in world_turns(self.rig, self.other, self.bind_turn):
            if float(np.abs(turn - upright).max()) <= SAME_TURN:
                return upright
        nearest = nearest_axis_turn(turn[np.newaxis])
        if float(np.abs(turn - nearest).max()) > SAME_TURN:
            return upright
        # Spaces of bind poses are free: that the world lies must show in it, too.
        if self.stands(nearest) or largest_angle(*self._directions, nearest) <= MOST_DEGREES:
            return nearest
        return upright

    def stands(self, turn: Floats) -> bool:
        """Whether a rotation, (3, 3), takes EDITED's up to RIG's."""
        up = transform_directions(np.array(self.other.rules.up), from_frame(turn, np.zeros(3)))
        return bool(np.abs(up - np.array(self.rig.rules.up)).max() <= SAME_TURN)

    @cached_property
    def _turned_bare(self) -> Floats:
        """The rotation of G, (3, 3), without bind poses: up goes to up.

        Unless the file as a whole is turned otherwise: its bones at rest, and then it leans, or the axes of
        its joints, too, as converters turn both.
        """
        upright = upright_turn(self.other.rules.up, self.rig.rules.up)
        ours, theirs = self._directions
        if not len(ours) or largest_angle(ours, theirs, upright) <= MOST_DEGREES:
            return upright
        off = [largest_angle(ours, theirs, turn) for turn in AXIS_TURNS]
        turn = AXIS_TURNS[int(np.argmin(off))]
        with_axes = np.abs(turn - self._bare_axes).max() <= SAME_TURN
        return turn if min(off) <= MOST_DEGREES and (with_axes or not self.stands(turn)) else upright

    @cached_property
    def _directions(self) -> tuple[Floats, Floats]:
        """Where bones of joints point at rest in the worlds of RIG and EDITED, (k, 3) each."""
        bones = [(n, above) for n in self.of if (above := self._bone_of(n)) >= 0]
        a, b = np.array(bones, dtype=np.intp).reshape(-1, 2).T
        c, d = (np.array([self.of[int(n)] for n in each], dtype=np.intp) for each in (a, b))
        ours = self.rig.world[a, 3, :3] - self.rig.world[b, 3, :3]
        theirs = self.other.world[c, 3, :3] - self.other.world[d, 3, :3]
        return self._long(ours, theirs)

    @cached_property
    def _bare_axes(self) -> Floats:
        """How all joints of a file without a skin are turned against RIG's, about themselves: one of the 24
        rotations, (3, 3), that takes where EDITED's bones point in these to where RIG's do, in any pose.
        """
        bones = [n for n in self.of if self._bone_of(n) == int(self.rig.parents[n]) >= 0]
        bones = [n for n in bones if self.of[self._bone_of(n)] == int(self.other.parents[self.of[n]])]
        ours, theirs = self._long(
            self.rig.local[bones, 3, :3], self.other.local[[self.of[n] for n in bones], 3, :3]
        )
        off = [largest_angle(ours, theirs, turn) for turn in AXIS_TURNS] if len(ours) else [0.0]
        best = int(np.argmin(off))
        return np.asarray(AXIS_TURNS[best if off[best] <= MOST_DEGREES < off[0] else 0])

    def _bone_of(self, node: int) -> int:
        """The joint that a joint is below in both files, or −1."""
        above = self.line(node)[2] if self.rig.is_joint[node] else -1
        return above if above >= 0 and self.rig.is_joint[above] else -1

    def _long(self, ours: Floats, theirs: Floats) -> tuple[Floats, Floats]:
        """The pairs of vectors, (k, 3), that are not next to nothing beside the longest."""
        fit = [
            np.isfinite(each).all(axis=1) & (length(each) > SHORT * length(each).max(initial=0.0))
            for each in (ours, theirs)
        ]
        return ours[fit[0] & fit[1]], theirs[fit[0] & fit[1]]

    @cached_property
    def _ratio(self) -> float | None:
        """How large the world is here for the other's 1; None without bones.

        C and the joints at rest say it exactly, else the bones do, whose lengths a pose keeps.
        """
        rig, other = self.rig, self.other
        joints = [n for n in self._bound if not self._grown.intersection(other.path_to_root(self.of[n]))]
        # How long an axis is that a scale above shears depends on which one it is.
        joints = [n for n in joints if max(map(skewed, (rig.world[n], other.world[self.of[n]]))) <= SKEW]
        turns = length(np.reshape([self._bound[n] for n in joints], (-1, 4, 4))[:, 0, :3])
        ours, its = (
            length(world[nodes, 0, :3])
            for world, nodes in ((rig.world, joints), (other.world, [self.of[n] for n in joints]))
        )
        exact = median_ratio(ours, turns * its)
        above = {n: int(rig.parents[n]) for n in self.of if rig.is_joint[n]}
        bones = [n for n, k in above.items() if k in self.of and self.of[k] == other.parents[self.of[n]]]
        theirs = [self.of[n] for n in bones]
        ours = length(rig.world[bones, 3, :3] - rig.world[rig.parents[bones], 3, :3])
        its = length(other.world[theirs, 3, :3] - other.world[other.parents[theirs], 3, :3])
        long = ours > SAME_PLACE * self.size
        found = median_ratio(ours[long], its[long])
        if exact is not None:
            return found if found and abs(exact / found - 1.0) <= SAME_SIZE else exact
        return 1.0 if found and 1.0 / ONE_UNIT <= found <= ONE_UNIT else found

    @cached_property
    def size(self) -> float:
        """The diagonal of the box of the joints at rest, or of all nodes, in units of the rig."""
        return skeleton_size(self.rig)

    def _turn(self, node: int) -> Floats:
        if node in self._bound:
            return self._bound[node]
        theirs, between = self.of[node], self.between(node)
        drawn = self._from_rest(node, between)
        if not np.isfinite(drawn).all():
            return self._inherited(node, between)
        if self.rig.is_joint[node]:
            return self._bare(node, between)
        if theirs not in self.moving:
            return drawn
        turned, in_place = self._rests_alike(node)
        if not turned:
            self.inherited.add(node)
            return self._inherited(node, between)
        if not in_place:
            drawn[3, :3] = 0.0
        return drawn

    def _from_rest(self, node: int, between: Floats) -> Floats:
        """C of a node that rests in both files alike."""
        there = self.other.local[self.of[node]]
        return multiply(multiply(self.rig.local[node], inverse(between)), inverse(there))

    def _rests_alike(self, node: int) -> tuple[bool, bool]:
        """Whether the bound joints that a node carries rest alike in both worlds: their axes, and places.

        Then the node itself does, too: the frame that the DCC has shown is that of RIG's rest.
        """
        joints = [
            n
            for n in self._tops
            if node in self.rig.path_to_root(n) and self.of[node] in self.other.path_to_root(self.of[n])
        ]
        if not joints:
            return False, False
        ours, theirs = self.rig.world[joints], self.other.world[[self.of[n] for n in joints]]
        seen = multiply(multiply([self._bound[n] for n in joints], theirs), self.space)
        sizes = length(ours[:, :3, :3])[..., np.newaxis]
        turned = (np.abs(ours - seen)[:, :3, :3] <= SAME_TURN * sizes).all()
        in_place = (length(ours[:, 3, :3] - seen[:, 3, :3]) <= OTHER_SHAPE * self.size).all()
        return bool(turned), bool(turned and in_place)

    @cached_property
    def _tops(self) -> list[int]:
        """The topmost of the joints that a skin of each file holds."""
        under = self.rig.under(self._bound)
        return [n for n in self._bound if not under[n]]

    def _inherited(self, node: int, between: Floats) -> Floats:
        """C of the nearest node above that both files have, of a size that makes scales at rest alike.

        Of a first control that is a bone in EDITED, that of joints: exporters turn objects otherwise.
        """
        above, rig = self.line(node)[2], self.rig
        is_bone = node in rig.own and self.other.is_joint[self.of[node]]
        if is_bone and above not in rig.own and not (above >= 0 and rig.is_joint[above]):
            # Bones of plain nodes alone are the script's own, and nothing moves the offset on top.
            turn = (self._bound[self._tops[0]] if self._tops else self._from_rest(node, between)).copy()
        else:
            turn = (self.turns[above] if above >= 0 else inverse(self.space)).copy()
        turn[3, :3] = 0.0
        if self._looks(node):
            turn[:3, :3] = np.eye(3) * float(length(turn[0, :3]))
        seen = multiply(multiply(turn, self.other.local[self.of[node]]), between)
        sizes = float(length(self.rig.local[node, 0, :3])), float(length(seen[0, :3]))
        if self.of[node] not in self._grown and min(sizes) > 0 and np.isfinite(sizes).all():
            turn[:3, :3] *= sizes[0] / sizes[1]
        return turn

    def _bare(self, node: int, between: Floats) -> Floats:
        """C of a joint without a bind pose in either file: what rests in a frame shows no axes."""
        turn = self._inherited(node, between)
        axes = from_frame(self._bare_axes, np.zeros(3))
        turn[:3, :3] = inverse(axes)[:3, :3] * float(length(turn[0, :3]))
        return turn

    def _looks(self, node: int) -> bool:
        """Whether a node shows a camera or a light: they look along −z in glTF and USD, whatever is up."""
        return (
            int(self.rig.attachment[node]) >= 0 and not {node, int(self.rig.attachment[node])} & self._drawn
        )

    @cached_property
    def _drawn(self) -> set[int]:
        return {mesh.node for mesh in self.rig.meshes}

    @cached_property
    def _grown(self) -> set[int]:
        """The nodes of the other file that a clip scales."""
        tracks = [t for clip in self.other.clips for t in clip.tracks if t.path == "scale"]
        return {t.node for t in tracks if np.ptp(key_values(t), axis=0).max(initial=0.0) > SAME_SIZE}

    def line(self, node: int) -> tuple[list[int], list[int], int]:
        """What is between a node and the nearest above it in both files: theirs, ours, and that one or −1."""
        if node not in self._lines:
            self._lines[node] = self._line(node)
        return self._lines[node]

    def _line(self, node: int) -> tuple[list[int], list[int], int]:
        above = self.other.path_to_root(self.of[node])[1:]
        ours, own = int(self.rig.parents[node]), []
        while ours >= 0 and self.of.get(ours) not in above:
            own.append(ours)
            ours = int(self.rig.parents[ours])
        cut = above.index(self.of[ours]) if ours >= 0 else len(above)
        return above[:cut], own, ours

    def between(self, node: int) -> Floats:
        """D, (4, 4): ``local = C · other local · D``, as what lies between stands at rest."""
        if node not in self._between:
            seen = self._seen_between(node)
            self._between[node] = self.snapped(seen)
            self._rounded[node, "D"] = _moved(seen, self._between[node])
        return self._between[node]

    def _seen_between(self, node: int) -> Floats:
        theirs, ours, above = self.line(node)
        matrix = inverse(self.turns[above]) if above >= 0 else self.space
        for k in reversed(theirs):
            matrix = multiply(self.other.local[k], matrix)
        own = np.eye(4)
        for k in ours:
            own = multiply(own, self.rig.local[k])
        return multiply(matrix, inverse(own))

    def snapped(self, matrix: Floats) -> Floats:
        """A matrix whose turn, size and place are as near to round ones as rounding leaves them, as these."""
        sizes = length(matrix[:3, :3])
        size = float(sizes.max())
        if not np.isfinite(matrix).all() or size == 0:
            return matrix
        alike = sizes.max() - sizes.min() <= SAME_SIZE * size and float(skewed(matrix)) <= SAME_TURN
        result = matrix.copy()
        if alike and float(determinant(matrix)) > 0:
            size = 1.0 if abs(size - 1.0) <= SAME_SIZE else float((sizes[0] + sizes[1] + sizes[2]) / 3.0)
            result[:3, :3] = snapped_turn(nearest_rotation(matrix)) * size
        # A place of the other file's space, before it is scaled, or of ours.
        if np.abs(result[3, :3]).max() <= SAME_PLACE * self.size * min(1.0, size):
            result[3, :3] = 0.0
        return result
