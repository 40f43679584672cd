"""New joints of ours in skins: they move no point until somebody gives them weight."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.matrices import inverse, multiply
from rigtri.ops.added import add, stand
from rigtri.pose import world_of
from rigtri.records import Booleans, Skin
from rigtri.rig import Rig
from rigtri.trigonometry import Floats

# Inverse binds that differ by less, as a share of the largest number, differ by float32 rounding.
_SAME_BIND = 1e-6


def add_joint(
    rig: Rig, name: str, parent: int, note: Mapping[str, Any], position: Floats, axes: Floats
) -> tuple[Rig, int]:
    """A new joint below ``parent`` in every skin that holds it, behind their last joints; and its index.

    position (3,), axes (3, 3): where it stands in the world, as rows. In a bind pose it stands
    to its parent as it does at rest. Below a node of no skin it is a plain node: see `new_skin`.
    """
    rig, node = add(rig, name, parent, note)
    rig = stand(rig, node, position, axes)
    skins = tuple(_grown(rig, skin, node, parent) for skin in rig.skins)
    return replace(rig, skins=skins), node


def new_skin(rig: Rig, name: str, joints: Sequence[int]) -> Rig:
    """The rig with a skin of its own for new joints (parents first), bound where they stand at rest."""
    binds = np.stack([inverse(world_of(rig, joint)) for joint in joints])
    skin = Skin(name, np.asarray(joints, dtype=np.int64), binds)
    return replace(rig, skins=(*rig.skins, skin))


def move_joint(rig: Rig, node: int, position: Floats, axes: Floats) -> Rig:
    """Put a joint of ours elsewhere, at rest and in the bind poses of its skins, as `add_joint` would.

    What hangs on it goes along. Bits that only rounding would change stay.
    """
    rig = stand(rig, node, position, axes)
    skins = []
    for skin in rig.skins:
        row = _row(skin, node)
        if row is not None:
            skin = _set_row(skin, row, _bind(rig, skin, node))
        skins.append(skin)
    return replace(rig, skins=tuple(skins))


def _grown(rig: Rig, skin: Skin, node: int, parent: int) -> Skin:
    if _row(skin, parent) is None:
        return skin
    return replace(
        skin,
        joints=np.append(skin.joints, node),
        inverse_bind=np.concatenate([skin.inverse_bind, _bind(rig, skin, node)[np.newaxis]]),
        weigh=None if skin.weigh is None else _without_weight(skin.weigh),
    )


def _without_weight(weigh: Callable[[], Booleans]) -> Callable[[], Booleans]:
    return lambda: np.append(weigh(), False)


def _bind(rig: Rig, skin: Skin, node: int) -> Floats:
    """The inverse bind matrix of a joint of ours, (4, 4): to its parent's as it stands to it at rest."""
    above = _row(skin, int(rig.parents[node]))
    if above is None:
        return inverse(world_of(rig, node))
    return multiply(skin.inverse_bind[above], inverse(rig.local[node]))


def _set_row(skin: Skin, row: int, inverse_bind: Floats) -> Skin:
    size = float(np.abs(inverse_bind).max())
    if np.abs(skin.inverse_bind[row] - inverse_bind).max() <= _SAME_BIND * size:
        return skin
    binds = skin.inverse_bind.copy()
    binds[row] = inverse_bind
    return replace(skin, inverse_bind=binds)


def _row(skin: Skin, node: int) -> int | None:
    found = np.flatnonzero(skin.joints == node)
    return int(found[0]) if len(found) else None
