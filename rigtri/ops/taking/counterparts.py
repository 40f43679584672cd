"""Nodes of two files that are one node, and how the axes of the one turn into those of the other.

C of a node and G of the two worlds are such that, at all times of the same motion,
``world = C · other world · G`` (row matrices). Of a joint, C comes from the inverse bind matrices of
both files: what is stored as rest is a pose in one file and the bind pose in the other.

Source: docs/take-clips.md.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations, product

import numpy as np

from rigtri.matrices import determinant, from_frame, inverse, multiply, nearest_rotation, transform_points
from rigtri.matrices import skew as skewed
from rigtri.records import Skin, key_values
from rigtri.rig import Rig
from rigtri.trigonometry import Floats
from rigtri.vectors import cross, length, normalise

# What float32 matrices that a DCC has inverted and multiplied leave: radians, and a share of a size.
SAME_TURN = 1e-4
SAME_SIZE = 1e-4
SAME_PLACE = 1e-5
# Skeletons whose joints lie farther apart, as a share of their size, have other proportions.
_OTHER_SHAPE = 1e-3
# Worlds whose sizes differ by less have one unit: a pose makes that much of a difference.
_ONE_UNIT = 1.25


def _axis_turns() -> Floats:
    """The 24 rotations that take axes onto axes, the identity first, (24, 3, 3)."""
    found = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            axes = np.zeros((3, 3))
            axes[[0, 1, 2], order] = signs
            if determinant(from_frame(axes, np.zeros(3))) > 0:
                found.append(axes)
    return np.array(found)


AXIS_TURNS = _axis_turns()


@dataclass(frozen=True, eq=False)
class Pairs:
    """What is called alike. of: by node of the rig the node of the other. unclear: names of several."""

    of: dict[int, int]
    unclear: tuple[str, ...]


def pairs(rig: Rig, other: Rig) -> Pairs:
    """Nodes of two rigs that have one name: exactly, else as USD spells it; joints go before other nodes."""
    found: dict[int, int] = {}
    unclear: dict[str, None] = {}
    for spell in (str, as_usd):
        ours, theirs = _spelled(rig, spell), _spelled(other, spell)
        taken = set(found.values())
        for name, nodes in ours.items():
            left = [node for node in nodes if node not in found]
            free = [node for node in theirs.get(name, ()) if node not in taken]
            if not left or not free:
                continue
            made = _paired(rig, other, left, free)
            found |= made
            if len(made) < min(len(left), len(free)):
                unclear[rig.names[left[0]]] = None
    return Pairs(found, tuple(unclear))


def as_usd(name: str) -> str:
    """A name as exporters to USD change it: other signs than letters and digits are underscores."""
    return re.sub(r"[^A-Za-z0-9]+", "_", name)


def _spelled(rig: Rig, spell: Callable[[str], str]) -> dict[str, list[int]]:
    named: dict[str, list[int]] = {}
    for node, name in enumerate(rig.names):
        if name:
            named.setdefault(spell(name), []).append(node)
    return named


def _paired(rig: Rig, other: Rig, ours: Sequence[int], theirs: Sequence[int]) -> dict[int, int]:
    """One of each; of several those that are joints, or what stands at the same path."""
    if len(ours) == len(theirs) == 1:
        return {ours[0]: theirs[0]}
    found = {}
    for joints in (True, False):
        a = [node for node in ours if bool(rig.is_joint[node]) == joints]
        b = [node for node in theirs if bool(other.is_joint[node]) == joints]
        if len(a) == len(b) == 1:
            found[a[0]] = b[0]
            continue
        for node in a:
            same = [k for k in b if other.path(k) == rig.path(node)]
            if len(same) == 1:
                found[node] = same[0]
    return found


@dataclass(frozen=True, eq=False)
class Similar:
    """A turn about axes with one size and a move, as of whole worlds; residual: a share of the size."""

    matrix: Floats
    residual: float


def fitted(theirs: Floats, ours: Floats, *, about_origin: bool) -> Similar:
    """What takes points (k, 3) onto others: the identity where it does, else one of 24 turns and a size.

    about_origin: the origin stays where it is, and near sizes are one.
    """
    middle = np.zeros((2, 3)) if about_origin else np.array([_mean(theirs), _mean(ours)])
    a, b = theirs - middle[0], ours - middle[1]
    sizes = [_spread(a), _spread(b)]
    ratio = sizes[1] / sizes[0] if sizes[0] > 0 and sizes[1] > 0 else 1.0
    near = _ONE_UNIT if about_origin else 1.0 + SAME_SIZE
    if 1.0 / near <= ratio <= near:
        ratio = 1.0
    size = sizes[1] or 1.0
    best, least = AXIS_TURNS[0], np.inf
    for axes in AXIS_TURNS:
        turned = transform_points(a * ratio, from_frame(axes, np.zeros(3)))
        off = _spread(turned - b) / size
        # Of equals the first, which is the identity: points on a line tell no turn about it.
        if off < 0.99 * least - SAME_PLACE:
            best, least = axes, off
    if least > _OTHER_SHAPE and not about_origin:
        axes = _three_point_turn(a, b)
        off = _spread(transform_points(a * ratio, from_frame(axes, np.zeros(3))) - b) / size
        if off < 0.1 * least:
            best, least = axes, off
    matrix = from_frame(best * ratio, np.zeros(3))
    matrix[3, :3] = middle[1] - transform_points(middle[0], matrix)
    if np.abs(matrix[3, :3]).max() <= SAME_PLACE * size:
        matrix[3, :3] = 0.0
    return Similar(matrix, float(least))


def _three_point_turn(theirs: Floats, ours: Floats) -> Floats:
    """The rotation, (3, 3), that lays the farthest of points and the one most aside onto others."""
    far = int(np.argmax(length(ours)))
    aside = int(np.argmax(length(cross(ours[far], ours))))
    frames = []
    for points in (theirs, ours):
        x = normalise(points[far])
        z = normalise(cross(x, points[aside]))
        frames.append(from_frame(np.stack([x, cross(z, x), z]), np.zeros(3)))
    return np.asarray(multiply(inverse(frames[0]), frames[1])[:3, :3])


def _mean(points: Floats) -> Floats:
    return np.asarray(_total(points) / max(len(points), 1))


def _spread(points: Floats) -> float:
    """The root of the mean square of lengths, (k, 3)."""
    return float(np.sqrt(_total(np.ravel(points * points)) / max(len(points), 1)))


def _total(values: Floats) -> Floats:
    """The sum over the first axis, added one by one: the same bits everywhere; 0 where there are none."""
    return np.asarray(values.cumsum(axis=0)[-1] if len(values) else np.zeros(values.shape[1:]))


class Counterparts:
    """The pairs of two rigs with their C and G. moving: nodes of the other that any of its clips moves.

    The rest of a node that moves and is no joint may be the frame that the DCC has shown while it
    wrote: such a node has the axes that its parent's turn tells.
    """

    def __init__(self, rig: Rig, other: Rig) -> None:
        self.rig, self.other = rig, other
        found = pairs(rig, other)
        self.of, self.unclear = found.of, found.unclear
        self.back = {theirs: ours for ours, theirs in self.of.items()}
        self.moving = {t.node for clip in other.clips for t in clip.tracks if t.path != "weights"}
        self.proportions = 0.0  # how far bind poses are apart beside turn, size and place
        self._bound = self._from_binds()
        self._lines: dict[int, tuple[list[int], list[int], int]] = {}
        self._between: dict[int, Floats] = {}
        self.turns: dict[int, Floats] = {}
        for node in sorted(self.of):
            self.turns[node] = self._turn(node)

    @property
    def other_proportions(self) -> bool:
        """Whether the two skeletons are not one."""
        return self.proportions > _OTHER_SHAPE

    @cached_property
    def space(self) -> Floats:
        """G, (4, 4): the world of the other file as this one sees it."""
        still = [n for n, k in self.of.items() if self.rig.is_joint[n] or k not in self.moving]
        ours = self.rig.world[still, 3, :3]
        theirs = self.other.world[[self.of[n] for n in still], 3, :3]
        fit = np.isfinite(ours).all(axis=1) & np.isfinite(theirs).all(axis=1)
        return fitted(theirs[fit], ours[fit], about_origin=True).matrix

    @cached_property
    def size(self) -> float:
        """The diagonal of the box of the joints at rest, or of all nodes, in units of the rig."""
        rig = self.rig
        points = rig.world[rig.is_joint if rig.is_joint.any() else slice(None), 3, :3]
        points = points[np.isfinite(points).all(axis=1)]
        size = float(length(points.max(axis=0) - points.min(axis=0))) if len(points) else 0.0
        return size or 1.0

    def _from_binds(self) -> dict[int, Floats]:
        """C of joints that a skin of each file holds."""
        found: dict[int, Floats] = {}
        for skin in self.rig.skins:
            for theirs in self.other.skins:
                rows = {int(j): row for row, j in enumerate(theirs.joints)}
                both = [
                    (row, int(j), rows[self.of[int(j)]])
                    for row, j in enumerate(skin.joints)
                    if self.of.get(int(j)) in rows and int(j) not in found
                ]
                if both and skin.stored and theirs.stored:
                    found |= self._of_skins(skin, theirs, both)
        return found

    def _of_skins(self, skin: Skin, theirs: Skin, both: list[tuple[int, int, int]]) -> dict[int, Floats]:
        mine, its = [row for row, _, _ in both], [row for _, _, row in both]
        ours, bind = inverse(skin.inverse_bind[mine]), inverse(theirs.inverse_bind[its])
        usable = np.isfinite(ours).all(axis=(1, 2)) & np.isfinite(bind).all(axis=(1, 2))
        if not usable.any():
            return {}
        fit = fitted(bind[usable, 3, :3], ours[usable, 3, :3], about_origin=False)
        self.proportions = max(self.proportions, fit.residual)
        turns = multiply(multiply(ours, inverse(fit.matrix)), theirs.inverse_bind[its])
        return {both[k][1]: self.snapped(turns[k]) for k in np.flatnonzero(usable).tolist()}

    def _turn(self, node: int) -> Floats:
        if node in self._bound:
            return self._bound[node]
        theirs, between = self.of[node], self.between(node)
        told = multiply(multiply(self.rig.local[node], inverse(between)), inverse(self.other.local[theirs]))
        posed = theirs in self.moving and not self.other.is_joint[theirs]
        if posed or not np.isfinite(told).all():
            return self.snapped(self._inherited(node, between))
        return self.snapped(told)

    def _inherited(self, node: int, between: Floats) -> Floats:
        """C of the nearest node above that both files have, of a size that makes scales at rest alike."""
        above = self.line(node)[2]
        turn = (self.turns[above] if above >= 0 else inverse(self.space)).copy()
        turn[3, :3] = 0.0
        seen = multiply(multiply(turn, self.other.local[self.of[node]]), between)
        sizes = float(length(self.rig.local[node, 0, :3])), float(length(seen[0, :3]))
        if self.of[node] not in self._grown and min(sizes) > 0 and np.isfinite(sizes).all():
            turn[:3, :3] *= sizes[0] / sizes[1]
        return turn

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
        above = []
        theirs = int(self.other.parents[self.of[node]])
        while theirs >= 0:
            above.append(theirs)
            theirs = int(self.other.parents[theirs])
        ours, own = int(self.rig.parents[node]), []
        while ours >= 0 and self.of.get(ours) not in above:
            own.append(ours)
            ours = int(self.rig.parents[ours])
        cut = above.index(self.of[ours]) if ours >= 0 else len(above)
        return above[:cut], own, ours

    def between(self, node: int) -> Floats:
        """D, (4, 4): ``local = C · other local · D``, as what lies between stands at rest."""
        if node not in self._between:
            self._between[node] = self._seen_between(node)
        return self._between[node]

    def _seen_between(self, node: int) -> Floats:
        theirs, ours, above = self.line(node)
        matrix = inverse(self.turns[above]) if above >= 0 else self.space
        for k in reversed(theirs):
            matrix = multiply(self.other.local[k], matrix)
        own = np.eye(4)
        for k in ours:
            own = multiply(own, self.rig.local[k])
        return self.snapped(multiply(matrix, inverse(own)))

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
            axes = nearest_rotation(matrix)
            apart = np.abs(AXIS_TURNS - axes).max(axis=(1, 2))
            nearest = int(apart.argmin())
            axes = AXIS_TURNS[nearest] if apart[nearest] <= SAME_TURN else axes
            result[:3, :3] = axes * size
        # A place of the other file's space, before it is scaled, or of ours.
        if np.abs(result[3, :3]).max() <= SAME_PLACE * self.size * min(1.0, size):
            result[3, :3] = 0.0
        return result
