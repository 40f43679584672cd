"""What half floats hold of scales: a SkelAnimation of USD has its scales as half3[].

A size of joint frames multiplies scales at keys by a share (`rigtri.frames.rescale`), and eleven bits hold
few products. Those of one number are another matter, as a share can be chosen that gives a half float.

Source: UsdSkelAnimation, `scales`; IEEE 754 binary16.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track, key_values
from rigtri.model.rig import Rig

# A share of a number: products that half floats round by less are theirs. It is what float32 leaves of a rest
# matrix from which a share comes, and moves nothing by a tenth of what a comparison allows.
HELD = 1e-6
# How far a half float may be from the number that it stands for, as a share of that.
STEP = 2.0**-11


def is_half(rig: Rig, track: Track) -> bool:
    """Whether the file holds the values of a track as half floats."""
    return track.path == "scale" and rig.rules.raw_quaternions and bool(rig.is_joint[track.node])


def rounding(values: Floats) -> float:
    """How far half floats are from values, (...), as the largest share of one of them; 0 for none."""
    apart = np.abs(values - _half(values))
    return float((apart / np.maximum(np.abs(values), np.finfo(np.float64).tiny)).max(initial=0.0))


def held_sizes(rig: Rig, size: Floats, nodes: Collection[int]) -> tuple[Floats, list[int]]:
    """The sizes of frames, (n,), whose products with scales half floats can hold, and the joints without one.

    A joint whose keys have one scale gets the size nearest to that which gives a half float; the scale of one
    of which they have several stays. What is below it, of nodes, stands in a frame of that size.
    """
    keys: dict[int, list[Floats]] = {}
    for track in (track for clip in rig.clips for track in clip.tracks if is_half(rig, track)):
        keys.setdefault(track.node, []).append(key_values(track).reshape(-1))
    above = np.where(rig.parents >= 0, size[rig.parents], 1.0)
    share, found, others = size / above, size.copy(), np.zeros(len(rig), dtype=bool)
    kept = list[int]()
    for node, parent in enumerate(rig.parents.tolist()):
        if node not in nodes:
            continue
        held: float | None = float(share[node])
        if node in keys and held != 1.0:
            held = _held_share(np.concatenate(keys[node]), share[node])
            others[node] = held != share[node]
            if held is None:
                kept.append(node)
        others[node] |= parent >= 0 and others[parent]
        if others[node]:
            made = (found[parent] if parent >= 0 else 1.0) * (1.0 if held is None else held)
            found[node] = 1.0 if abs(made - 1.0) <= HELD else made
    return found, kept


def _held_share(values: Floats, share: float) -> float | None:
    """The share nearest to the given one whose products with values, (k,), are half floats; None for none."""
    if rounding(values * share) <= HELD:
        return share
    one = float(values[0])
    if one == 0.0 or (values != one).any():
        return None
    product = one * share
    nearest = float(_half(np.array(product)))
    # A scale that rests as it is keyed gets 1 at its keys, though half floats have rounded these.
    return (np.sign(product) if abs(abs(product) - 1.0) <= STEP else nearest) / one or None


def _half(values: Floats) -> Floats:
    with np.errstate(over="ignore"):  # what is too large is infinite, and held by none
        return values.astype(np.float16).astype(np.float64)
