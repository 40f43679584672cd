"""Skins, and what is to be done to their weights when a rig is written."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from dataclasses import replace
from functools import cached_property

import numpy as np

from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import inverse
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass


@dataclass(frozen=True, eq=False)
class Skin:
    """Joints and the matrices that take bind-pose points into each joint's space.

    joints: node indices, (m,). inverse_bind: (m, 4, 4). ``stored`` is False when
    the file has no matrices and these are the identity its format prescribes.
    ``weigh`` says which joints move any point, (m,) bool; it reads the meshes,
    so it is called only when needed. drawn: whether something is drawn with it, its
    points readable or not; None where nobody has looked (USD, new skins). key: None for a skin
    that is new. lost: the joints that an edit has taken out of it, whose frames still change with those
    above them.
    """

    name: str
    joints: Integers
    inverse_bind: Floats
    stored: bool = True
    weigh: Callable[[], Booleans] | None = None
    key: Hashable = None
    drawn: bool | None = None
    lost: Skin | None = None

    def __repr__(self) -> str:
        return f"<Skin {self.name!r}: {len(self.joints)} joints>"

    @cached_property
    def bind(self) -> Floats:
        """Bind matrices of the joints, seen from the skin, (m, 4, 4); NaN where a matrix has no inverse."""
        return inverse(self.inverse_bind)

    @cached_property
    def weighted(self) -> Booleans:
        """Which joints move any point, (m,); all of them when nobody can tell."""
        return np.ones(len(self.joints), dtype=bool) if self.weigh is None else self.weigh()

    @property
    def ever(self) -> Skin:
        """The skin with the joints that it has lost behind those that it has; nobody asks for its weights."""
        if self.lost is None:
            return self
        joints, binds = zip(*((each.joints, each.inverse_bind) for each in (self, self.lost)), strict=True)
        return replace(
            self, joints=np.concatenate(joints), inverse_bind=np.concatenate(binds), weigh=None, lost=None
        )

    def rebound(self, change: Callable[[Skin], Floats]) -> Skin:
        """The skin with other inverse binds, (m, 4, 4), which ``change`` gives; so too of joints it lost."""
        lost = None if self.lost is None else self.lost.rebound(change)
        return replace(self, inverse_bind=change(self), lost=lost)

    def renumbered(self, place: Integers) -> Skin:
        """The skin with node k called ``place[k]``."""
        lost = None if self.lost is None else self.lost.renumbered(place)
        return replace(self, joints=place[self.joints], lost=lost)


def moving_points(skins: Iterable[Skin], count: int) -> Booleans:
    """Which of so many nodes move points of any of the skins, (count,): `Skin.weighted` of all."""
    found = np.zeros(count, dtype=bool)
    for skin in skins:
        found[skin.joints[skin.weighted]] = True
    return found


@dataclass(frozen=True, eq=False)
class WeightRedistribution:
    """The weight of a bone's points, to be shared among joints that stand along it.

    skin: its number. joints: rows of the skin, (k,), the bone's own among them; at: where each
    stands along the bone, (k,), rising. start, end: of the bone, in the space of the skin's
    points as ``Mesh.bind`` leaves them, (3,) each. most: joints that a point may have, 0 for any number.
    """

    skin: int
    joints: Integers
    at: Floats
    start: Floats
    end: Floats
    most: int = 0


@dataclass(frozen=True, eq=False)
class JointMerge:
    """Joints of a skin that go, and which ones take what their points have of them.

    skin: its number. rows: (m,), for each row that the file has, the row from now on: a joint that goes
    has that of its heir. at: where each stands along the bone that it shares, (m,). widths: how many
    joints each point of a mesh had room for before, by the node that shows it. idle: no point of a mesh has
    weight of those that go, and no other changes its row.
    """

    skin: int
    rows: Integers
    at: Floats
    widths: Mapping[int, int]
    idle: bool

    def then(self, later: JointMerge) -> JointMerge:
        """This and a later one of the same skin, whose rows are those that this leaves, as one."""
        return replace(
            self,
            rows=later.rows[self.rows],
            at=np.where(self.at == 0.0, later.at[self.rows], self.at),
            widths={**later.widths, **self.widths},
            idle=self.idle and later.idle,
        )


@dataclass(frozen=True)
class WeightLimit:
    """Of each point the ``most`` joints that weigh most stay. normalise: weights are to sum to 1.

    skins: the numbers of those whose points are meant; None for all points.
    """

    most: int
    normalise: bool = False
    skins: frozenset[int] | None = None
