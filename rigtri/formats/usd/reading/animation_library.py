"""Clip libraries: animations in a file without any skeleton, read as if their joints stood there.

A SkelAnimation names its joints by their paths, which hold the hierarchy; where
they stand is taken from its first sample. Only the animation is ever written.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rigtri.formats.usd.composition.stage import why_locked
from rigtri.formats.usd.reading.animation_reader import NOTHING, Animation, Property
from rigtri.formats.usd.reading.skeleton_reader import Skeleton, joint_parents
from rigtri.maths.matrices import compose, multiply
from rigtri.maths.quaternions import unit
from rigtri.maths.trigonometry import Floats
from rigtri.report import Notice
from rigtri.text import listed


def stand_in(prim: Any, animation: Animation, world: Floats) -> Skeleton:
    """A skeleton of an animation's joints as it poses them first, below a prim at ``world``."""
    # Animations may list their joints in any order; a rig needs parents first.
    order = sorted(range(len(animation.tokens)), key=lambda k: animation.tokens[k].count("/"))
    tokens = tuple(animation.tokens[k] for k in order)
    parents = joint_parents(animation.path, tokens)
    parts = {name: _first(animation.properties.get(name), name, order) for name in NOTHING}
    rest = compose(parts["translations"], unit(parts["rotations"]), parts["scales"])
    bind = rest.copy()
    for joint, parent in enumerate(parents.tolist()):
        bind[joint] = multiply(rest[joint], bind[parent] if parent >= 0 else world)
    locked = why_locked(prim, ("joints", *NOTHING))
    for name in ("translations", "rotations"):
        if name not in animation.properties:
            locked = locked or f"animation <{animation.path}> has no {name}, and no skeleton gives them"
    return Skeleton(animation.path, tokens, parents, bind, rest, False, locked, animation.path)


def notice(paths: list[str]) -> Notice:
    """What to know about a file that has animations alone."""
    shown = listed([f"<{path}>" for path in paths])
    return Notice(
        "no-skeleton",
        f"There is no skeleton; joints stand as {shown} poses them first. To give them the axes "
        "of the skeleton they are for, save its new axes with --save-frames and apply them with --frames.",
    )


def _first(item: Property | None, name: str, order: list[int]) -> Floats:
    if item is None:
        return np.broadcast_to(NOTHING[name], (len(order), len(NOTHING[name])))
    row = item.samples[0] if len(item.times) else item.default
    return np.asarray(row, dtype=np.float64)[order]
