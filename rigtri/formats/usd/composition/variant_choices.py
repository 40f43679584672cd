"""A stage with variants selected otherwise, one after another; the file keeps its own selections."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from pxr import Sdf, Usd

# A variant set: the path of its prim, and its name.
VariantSet = tuple[Any, str]
# Whether a variant matters, by its prim, set and name.
Counts = Callable[[Any, str, str], bool]


def each_choice(
    stage: Any, shown: Sequence[str] = (), counts: Counts | None = None
) -> Iterator[tuple[Mapping[VariantSet, str], Any]]:
    """The stage as it is, then with one variant selected otherwise, each with what is chosen.

    Sets that only a variant shows are tried with that one selected. shown: these prims alone, with those
    above and below them. counts: which variants are tried, by their prim, set and name.
    """
    if not shown and not any(sets_of(prim) for prim in stage.Traverse()):
        return
    trial = bare_stage(stage, [*shown] or ["/"])
    trial.SetEditTarget(trial.GetSessionLayer())
    yield {}, trial
    yield from _each_of(trial, partial(_choices, trial, counts), set(), {})


def _each_of(
    trial: Any, find: Callable[[], Iterator[Any]], known: set[VariantSet], above: Mapping[VariantSet, str]
) -> Iterator[tuple[Mapping[VariantSet, str], Any]]:
    others = [each for each in find() if each[:2] not in known]
    known = known | {(path, name) for path, name, _, _ in others}
    for path, name, variant, selected in others:
        chosen = trial.GetPrimAtPath(path).GetVariantSets().GetVariantSet(name)
        chosen.SetVariantSelection(variant)
        here = {**above, (path, name): variant}
        yield here, trial
        yield from _each_of(trial, find, known, here)
        chosen.SetVariantSelection(selected)


def selecting(stage: Any, chosen: Mapping[VariantSet, str]) -> Any:
    """A second stage of the same layers with some variants selected otherwise."""
    trial = bare_stage(stage, ["/"])
    for (path, name), variant in chosen.items():
        Sdf.CreatePrimInLayer(trial.GetSessionLayer(), path).variantSelections[name] = variant
    return trial


def alike(stage: Any) -> set[Any]:
    """The paths of instances that have a prototype in common with one before them."""
    first: dict[Any, Any] = {}
    every = [prim for prim in stage.Traverse() if prim.IsInstance()]
    return {p.GetPath() for p in every if first.setdefault(p.GetPrototype().GetPath(), p) != p}


def lacking(stage: Any, chosen: Mapping[VariantSet, str]) -> str:
    """What of a choice a stage lacks: a ``set``, a ``variant`` of a set that it has, or "" for nothing."""
    trial = selecting(stage, chosen)
    for (path, name), variant in chosen.items():
        prim = trial.GetPrimAtPath(path)
        if not prim or name not in sets_of(prim):
            return "set"
        if variant not in prim.GetVariantSet(name).GetVariantNames():
            return "variant"
    return ""


def _choices(stage: Any, counts: Counts | None) -> Iterator[tuple[Any, str, str, str]]:
    """The unselected variants of a stage: prim path, set, variant, the selected one."""
    for prim in stage.Traverse():
        for name in sets_of(prim):
            selected = prim.GetVariantSet(name).GetVariantSelection()
            for variant in prim.GetVariantSet(name).GetVariantNames():
                if variant != selected and (counts is None or counts(prim, name, variant)):
                    yield prim.GetPath(), name, variant, selected


def bare_stage(stage: Any, shown_prims: list[str]) -> Any:
    """A second stage of some prims and what is above them, with instances as plain prims."""
    session = Sdf.Layer.CreateAnonymous(".usda")
    session.TransferContent(stage.GetSessionLayer())
    for path in prefixes(shown_prims):
        if (prim := stage.GetPrimAtPath(path)) and prim.IsInstance():
            Sdf.CreatePrimInLayer(session, path).instanceable = False
    return Usd.Stage.OpenMasked(stage.GetRootLayer(), session, Usd.StagePopulationMask(shown_prims))


def prefixes(paths: list[str]) -> list[Any]:
    """The prims at and above some paths, the upper ones first."""
    return sorted({above for one in paths for above in Sdf.Path(one).GetPrefixes()})


def sets_of(prim: Any) -> list[str]:
    """The names of the variant sets of a prim."""
    return list(prim.GetVariantSets().GetNames())
