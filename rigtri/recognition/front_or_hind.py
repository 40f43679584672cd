"""Which two of four legs are in front where arms begin above them, as those of a centaur do.

Its skeleton may hang from the hips of either part, so that the hierarchy does not tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rigtri.recognition.body_shape import LEG, SIMILAR, Body
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_triples import TIE

# Arms begin over the legs of one end of a trunk up to this part of it.
_OVER = 0.3


def is_further(body: Body, limbs: Limbs) -> bool:
    """Whether a pair may be the arms of a body that stands on four legs: they begin above the front ones."""
    front, hind = body.arms, body.legs
    if body.form != "quadruped" or not front or not hind or len(limbs.at) < 3 or limbs.kind == "other":
        return False
    high, least = (limbs.starts - front.starts).dot(body.up) > 0.0, SIMILAR * min(front.size, hind.size)
    return high and limbs.quality > LEG and limbs.size > least and limbs.lead > TIE


def turned(ways: Sequence[Body], limbs: Sequence[Limbs]) -> list[Body]:
    """The ways to see a body, the other way round first where arms begin over its hind legs.

    That one is as sure as its own score: the hierarchy denies it.
    """
    if not ways or not any(_over_hind_legs(ways[0], each) for each in limbs):
        return list(ways)
    best, *others = ways
    for other in others:
        if other.form == best.form and other.legs is best.arms and other.arms is best.legs:
            return [replace(other, lead=best.lead), best, *(k for k in others if k is not other)]
    return list(ways)


def _over_hind_legs(body: Body, limbs: Limbs) -> bool:
    """Whether a pair that may be arms begins over what is taken for hind legs."""
    if (
        body.legs is None
        or body.arms is None
        or limbs in (body.legs, body.arms)
        or not is_further(body, limbs)
    ):
        return False
    spine = body.arms.starts - body.legs.starts
    return (limbs.starts - body.legs.starts).dot(spine) < _OVER * spine.dot(spine)
