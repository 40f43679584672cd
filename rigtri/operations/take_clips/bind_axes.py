"""The axes of joints of two files beside each other, from the bind poses of both.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rigtri.maths.matrices import inverse, multiply, nearest_rotation
from rigtri.maths.similarity_fit import OTHER_SHAPE, SAME_PLACE, fit_similarity
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin


def median_ratio(ours: Floats, theirs: Floats) -> float | None:
    """The median of ratios of what has a size, (k,); None where nothing has."""
    fit = np.isfinite(ours) & np.isfinite(theirs) & (ours > 0) & (theirs > 0)
    return float(np.median(ours[fit] / theirs[fit])) if fit.any() else None


def _at_one_place(skin: Skin) -> bool:
    """Whether all joints of a skin are bound at one place, as by matrices that are all alike."""
    places = skin.bind[:, 3, :3]
    places = places[np.isfinite(places).all(axis=1)]
    return len(places) > 1 and bool(np.ptp(places, axis=0).max() <= SAME_PLACE * np.abs(places).max())


class BoundAxes:
    """C of joints that a skin of each file holds. of: the nodes of ``other`` by those of ``rig``.

    turns: C by joint, (4, 4). apart: how far bind poses differ beside turn, size and place. turn: of those of
    ``other`` to those of ``rig``, (3, 3), which may be known before; None without any. at_one_place: the
    joints that both files bind at one place, each in its own, so that bind poses show no bones.
    """

    def __init__(self, rig: Rig, other: Rig, of: Mapping[int, int], turn: Floats | None = None) -> None:
        self.rig, self.apart = rig, 0.0
        self._known_turn, self.turn = turn, turn
        self.turns: dict[int, Floats] = {}
        self.at_one_place: set[int] = set()
        for skin in rig.skins:
            for theirs in other.skins:
                rows = {int(j): row for row, j in enumerate(theirs.joints)}
                both = [
                    (row, int(j), rows[of[int(j)]])
                    for row, j in enumerate(skin.joints)
                    if of.get(int(j)) in rows and int(j) not in self.turns
                ]
                if not (both and skin.stored and theirs.stored):
                    continue
                # Where only one file binds all joints at one place, that is no pose of the other's body.
                if (alike := _at_one_place(skin)) == _at_one_place(theirs):
                    found = self._of_skins(skin, theirs, both)
                    self.turns |= found
                    self.at_one_place.update(found if alike else ())

    def _of_skins(self, skin: Skin, theirs: Skin, both: list[tuple[int, int, int]]) -> dict[int, Floats]:
        mine, its = [row for row, _, _ in both], [row for _, _, row in both]
        ours, bind = inverse(skin.inverse_bind[mine]), inverse(theirs.inverse_bind[its])
        usable = np.isfinite(ours).all(axis=(1, 2)) & np.isfinite(bind).all(axis=(1, 2))
        if not usable.any():
            return {}
        points = bind[usable, 3, :3], ours[usable, 3, :3]
        fit = fit_similarity(*points, about_origin=False, turn=self._known_turn)
        if fit.residual > OTHER_SHAPE:
            # No size fits all of them; that of most bones keeps most lengths.
            ratio = self._ratio(both, ours, bind)
            fit = fit_similarity(*points, about_origin=False, ratio=ratio, turn=self._known_turn)
        self.apart = max(self.apart, fit.residual)
        if self.turn is None:
            self.turn = nearest_rotation(fit.matrix)
        turns = multiply(multiply(ours, inverse(fit.matrix)), theirs.inverse_bind[its])
        # A joint that lies elsewhere turns about its own place: what other lengths do to translations
        # is said in `rigtri.operations.take_clips.proportions`.
        turns[:, 3, :3] = 0.0
        return {both[k][1]: turns[k] for k in np.flatnonzero(usable).tolist()}

    def _ratio(self, both: list[tuple[int, int, int]], ours: Floats, bind: Floats) -> float | None:
        """How long a bone is here for one there, in bind poses, (k, 4, 4); None without bones."""
        rows = {joint: k for k, (_, joint, _) in enumerate(both)}
        bones = [(k, rows[above]) for j, k in rows.items() if (above := int(self.rig.parents[j])) in rows]
        a, b = np.array(bones, dtype=np.intp).reshape(-1, 2).T
        return median_ratio(length(ours[a, 3, :3] - ours[b, 3, :3]), length(bind[a, 3, :3] - bind[b, 3, :3]))
