"""Each way to select variants otherwise than the file: one set at a time, then several at once.

Several at once say more than each alone only where each alone shows characters otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pxr import Usd

from rigtri.formats.usd.composition.variant_choices import VariantSet, each_choice
from rigtri.formats.usd.composition.variants import VALUES, Origins, differing, origin

# What besides transforms and the arrays of joints decides how a character looks.
_SHOWN = (*VALUES, "points", "positions", "blendShapeWeights", "offsets")
_BINDING = ("skel:", "primvars:skel:")

Choice = Mapping[VariantSet, str]


def combinations(stage: Any, left_out: set[Any]) -> Iterator[Choice]:
    """Choices of one variant, with sets that only it shows, then those of two that both matter, of three …

    left_out: the paths of prims whose sets are not tried.
    """
    changing: list[Choice] = []
    before: Origins = {}
    for chosen, trial in each_choice(stage, counts=lambda prim, *_: prim.GetPath() not in left_out):
        if not chosen:
            before = _shown(trial)
            continue
        yield dict(chosen)
        if differing(before, _shown(trial)):
            changing.append(dict(chosen))
    level = [(number, choice) for number, choice in enumerate(changing)]
    while level:
        further = []
        for wider in _wider(level, changing):
            yield wider[1]
            further.append(wider)
        level = further


def _wider(level: Sequence[tuple[int, Choice]], changing: Sequence[Choice]) -> Iterator[tuple[int, Choice]]:
    """Choices, each with one further behind its last, which is told by its number."""
    for last, choice in level:
        for number in range(last + 1, len(changing)):
            if choice.keys().isdisjoint(changing[number]):
                yield number, {**choice, **changing[number]}


def _shown(stage: Any) -> Origins:
    """Where what makes the look of characters comes from, and which prims there are."""
    found: Origins = {}
    for prim in stage.Traverse(Usd.PrimDefaultPredicate):
        found[prim.GetPath()] = str(prim.GetTypeName())
        for attribute in prim.GetAuthoredAttributes():
            name = attribute.GetName()
            if name in _SHOWN or name.startswith(("xformOp", *_BINDING)):
                found[attribute.GetPath()] = origin(attribute)
        for relation in prim.GetAuthoredRelationships():
            if relation.GetName().startswith(_BINDING):
                found[relation.GetPath()] = tuple(map(str, relation.GetTargets()))
    return found
