"""Limbs: three joints, root, mid and end, that bend like an arm or a leg.

A limb is given by name, or one of those that `rigtri.recognition` is sure of. And where a character looks.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Literal
from weakref import WeakKeyDictionary

import numpy as np

from rigtri.errors import UsageError
from rigtri.maths.angle_limits import cosine_below
from rigtri.maths.ranking import SAME_SCORE, ranked
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import cross, dot, normalise
from rigtri.model.joint_names import side
from rigtri.model.limb import Limb as Limb
from rigtri.model.limb import LimbKind
from rigtri.model.metadata import LimbRecord
from rigtri.model.rig import Rig
from rigtri.recognition.layout import CONFIDENT, MAP, NAMES, Chain, Character
from rigtri.recognition.naming_schemes import limb_kind_in_name
from rigtri.recognition.recognise import recognise as layout_of
from rigtri.recognition.recognise import sure_limbs
from rigtri.text import and_more

# Who looks less far from up or down than this (a sine) looks nowhere in a picture.
_LEVEL = 0.1
# Who looks within this of an axis (a cosine, 15°) is drawn from there.
_ALONG = cosine_below(15)
# From here on (a cosine) a body stands on another axis than its format does.
_UPRIGHT = cosine_below(45)
# Chains at the end of a limb, whatever that is parented to.
_AT_ENDS = ("hand", "finger", "foot")


# The recognised limbs of each rig by their joints, as a crowd has hundreds to be named.
_known: WeakKeyDictionary[Rig, dict[tuple[int, int, int], Limb]] = WeakKeyDictionary()


def given(rig: Rig, start: str, middle: str, end: str) -> Limb:
    """The limb of three named nodes; its kind and side are read from the names where they say.

    Raises UsageError when they are no line down the hierarchy; only the end of a flat IK rig may have another
    parent.
    """
    triple = (rig.find(start), rig.find(middle), rig.find(end))
    if len(set(triple)) < 3:
        raise UsageError(f"a limb has three different joints, not '{start}', '{middle}', '{end}'")
    if rig.is_below(triple[0], triple[1]) or rig.is_below(triple[1], triple[2]):
        raise UsageError(f"the limb '{start}', '{middle}', '{end}' is upside down; name it from root to end")
    if pair := _no_line(rig, triple):
        above, below = map(rig.title, pair)
        chains = layout_of(rig).chains
        likely = [chain for chain in chains if len(chain.bend) == 3 and _has_one(rig, chain, triple)]
        shown = and_more([limb_title(rig, chain) for chain in likely], 4)
        hint = f"Recognised: {shown}" if shown else "See what is recognised with: rigtri recognise FILE"
        raise UsageError(
            f"'{start}', '{middle}', '{end}' is not a limb: '{below}' does not lie below '{above}'. {hint}"
        )
    if rig not in _known:
        _known[rig] = {limb.triple: limb for limb in recognise(rig)}
    if triple in _known[rig]:
        return replace(_known[rig][triple], evidence="given")
    kinds = {limb_kind_in_name(rig.names[node]) for node in triple} - {""}
    sides = {side(rig.names[node]) for node in triple}
    kind: LimbKind = "arm" if kinds == {"arm"} else "leg" if kinds == {"leg"} else ""
    return Limb(*triple, kind=kind, side=sides.pop() if len(sides) == 1 else "")


def _no_line(rig: Rig, triple: tuple[int, int, int]) -> tuple[int, ...]:
    """The two joints of a limb of which the second ought to lie below the first; () where it is a line.

    The end of a flat IK rig is parented above the limb, to the root or to a control: never to the limb's own
    root, and never in the trunk or another limb.
    """
    start, middle, end = triple
    if not rig.is_below(middle, start):
        return start, middle
    if rig.is_below(end, middle):
        return ()
    chains = list(layout_of(rig).chains)
    if any(chain.bend == triple for chain in chains):
        return ()
    others = {
        node
        for chain in chains
        if chain.kind not in _AT_ENDS and not {start, middle}.intersection(chain.joints)
        for node in chain.joints
    }
    node = end
    while node >= 0 and not rig.is_below(start, node):
        if node in others:
            return middle, end
        node = int(rig.parents[node])
    return (middle, end) if node == start else ()


def _has_one(rig: Rig, chain: Chain, nodes: tuple[int, ...]) -> bool:
    """Whether one of the nodes is in a chain, or is below where that begins to bend."""
    return any(node in chain.joints or rig.is_below(node, chain.bend[0]) for node in nodes)


def named_limbs(rig: Rig, limbs: Iterable[Limb | tuple[str, str, str]]) -> list[Limb]:
    """Limbs of which each may be three names of joints, as `given` takes them."""
    return [limb if isinstance(limb, Limb) else given(rig, *limb) for limb in limbs]


def along(rig: Rig, start: int, end: int) -> list[int]:
    """The nodes from ``start`` down to ``end``, both included.

    Raises UsageError when ``end`` does not lie below ``start``.
    """
    path = [end]
    while path[-1] != start and rig.parents[path[-1]] >= 0:
        path.append(int(rig.parents[path[-1]]))
    if path[-1] != start:
        raise UsageError(
            f"'{rig.title(end)}' does not lie below '{rig.title(start)}': there is no chain between them"
        )
    return path[::-1]


def recognise(rig: Rig, *, flat: bool = False) -> list[Limb]:
    """The arms and legs of a rig that are sure enough to be acted upon, arms first, left before right.

    flat: also those whose joints do not lie one below another, which have axes and nothing else.
    """
    found = [
        Limb(
            *chain.bend,
            kind="arm" if chain.kind == "arm" else "leg",
            side=chain.side,
            evidence=_source(chain),
            front=chain.is_front,
        )
        for chain in sure_limbs(rig)
        if len(chain.bend) == 3
        # Where all joints are below one, there is no chain to build on.
        and (flat or rig.is_below(chain.bend[1], chain.bend[0]))
    ]
    order = {"left": 0, "right": 1, "": 2}
    return sorted(found, key=lambda limb: (limb.kind, order[limb.side]))


def unsure(rig: Rig) -> list[Chain]:
    """The arms and legs of a rig that bend, and are not sure enough to be acted upon."""
    chains = (chain for character in layout_of(rig).characters for chain in character.limbs)
    return [chain for chain in chains if len(chain.bend) == 3 and not chain.is_sure]


def limb_title(rig: Rig, chain: Chain) -> str:
    """A recognised limb in a message: its name, its three joints, and how sure it is."""
    return f"{chain.name} ({rig.chain_title(chain.bend)}; {chain.confidence:.2f})"


def built_limbs(rig: Rig) -> list[Limb]:
    """The limbs that make-limb has built, without chains; of those whose joints are all there."""
    records = [one for one in rig.records(LimbRecord).values() if one.chain and one.middle]
    triples = [(one.chain[0], one.middle, one.chain[-1]) for one in records]
    return [given(rig, *triple) for triple in triples if all(rig.known(name) is not None for name in triple)]


def with_recognised(rig: Rig, mine: tuple[Limb, ...], *, flat: bool = False) -> tuple[Limb, ...]:
    """The user's limbs, then the recognised ones that share no joint with them; flat: as in `recognise`."""
    taken = {node for limb in mine for node in limb.triple}
    return (*mine, *(limb for limb in recognise(rig, flat=flat) if not taken.intersection(limb.triple)))


def _source(chain: Chain) -> Literal["vrm", "names", "shape"]:
    first = chain.evidence[0]
    return "vrm" if first == MAP else "names" if first.startswith(NAMES) else "shape"


def surest(rig: Rig) -> Character | None:
    """The character of a rig of which it is surest where it looks; None where it is of none."""
    known = [character for character in layout_of(rig).characters if any(character.facing)]
    return ranked(known, lambda k: k.confidence, SAME_SCORE)[0] if known else None


def facing(rig: Rig) -> Floats | None:
    """Where a character looks, unit, (3,): as the surest of a rig was recognised, else as its format says."""
    known = surest(rig)
    if known is not None:
        return np.array(known.facing)
    return None if rig.rules.facing is None else np.asarray(rig.rules.facing, dtype=np.float64)


def upright(rig: Rig) -> Floats:
    """Up of a character as it stands, unit, (3,): an axis of the world, as a rule the one of its format.

    The surest of a rig tells; a tool with z up may write bodies into files with y up as they are.
    """
    up = np.asarray(rig.rules.up, dtype=np.float64)
    known = [k for k in layout_of(rig).characters if any(k.up) and k.confidence >= CONFIDENT]
    stands = np.array(ranked(known, lambda k: k.confidence, SAME_SCORE)[0].up) if known else up
    if float(dot(stands, up)) >= _UPRIGHT:
        return up
    axis = int(np.argmax(np.abs(stands)))
    return np.where(np.arange(3) == axis, np.sign(stands[axis]), 0.0)


def forward(rig: Rig) -> Floats:
    """Where a character looks, level, unit, (3,): an axis of the world where it is near one; else +x is left.

    Source: glTF 2.0 and UsdSkel, where a character of which nobody knows more has its left at +x.
    """
    up = upright(rig)
    usual = cross([1.0, 0.0, 0.0], up) if not up[0] else np.array([0.0, 0.0, 1.0])
    ahead = facing(rig)
    level = usual if ahead is None else ahead - up * float(dot(ahead, up))
    if not np.abs(level).max() > _LEVEL:  # it looks up or down
        level = usual
    level = normalise(level)
    axis = int(np.argmax(np.abs(level)))
    along = np.where(np.arange(3) == axis, np.sign(level[axis]), 0.0)
    return along if float(dot(level, along)) > _ALONG else level
