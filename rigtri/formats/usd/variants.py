"""Variants that are not selected: whether they show a skeleton by values that an edit does not reach."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pxr import Sdf, Usd

from rigtri.formats.usd.skeletons import Skeleton
from rigtri.formats.usd.stage import DEFAULT

_VALUES = ("joints", "bindTransforms", "restTransforms", "translations", "rotations", "scales")
_SOURCE = "skel:animationSource"


def why_split(stage: Any, skeleton: Skeleton) -> str:
    """Which unselected variant drives a skeleton by another animation or by other values; "" if none.

    Each variant of the prims at and above the skeleton and its animation is tried, one at a
    time, on a stage of those prims alone; what it refers to is composed as USD would.
    """
    watched = [path for path in (skeleton.path, skeleton.animation) if path]
    if not any(choices(stage, watched)):
        return ""
    session = Sdf.Layer.CreateAnonymous(".usda")
    session.TransferContent(stage.GetSessionLayer())
    trial = Usd.Stage.OpenMasked(stage.GetRootLayer(), session, Usd.StagePopulationMask(watched))
    trial.SetEditTarget(session)
    before = _seen(trial, skeleton)
    for path, name, variant, selected in list(choices(stage, watched)):
        chosen = trial.GetPrimAtPath(path).GetVariantSets().GetVariantSet(name)
        chosen.SetVariantSelection(variant)
        after = _seen(trial, skeleton)
        chosen.SetVariantSelection(selected)
        for what in after:
            if (value := after[what]) != before.get(what, ""):
                other = f" ({value})" if what.endswith(_SOURCE) and value else ""
                return (
                    f"Variant '{variant}' of the variant set '{name}' on <{path}> has another "
                    f"<{what}>{other}, which would stay in the old axes. Give each variant "
                    "a file of its own, or remove it"
                )
    return ""


def choices(stage: Any, paths: list[str]) -> Iterator[tuple[Any, str, str, str]]:
    """The unselected variants at and above some prims: prim path, set, variant, the selected one."""
    for path in sorted({above for one in paths for above in Sdf.Path(one).GetPrefixes()}):
        sets = stage.GetPrimAtPath(path).GetVariantSets()
        for name in sets.GetNames():
            selected = sets.GetVariantSelection(name)
            for variant in sets.GetVariantSet(name).GetVariantNames():
                if variant != selected:
                    yield path, name, variant, selected


def _seen(stage: Any, skeleton: Skeleton) -> dict[str, str]:
    """Where the skeleton's values come from: a place in a layer for each; what it is bound to."""
    prim = stage.GetPrimAtPath(skeleton.path)
    if not prim or prim.GetTypeName() != "Skeleton":
        return {}  # a variant without the skeleton shows nothing by it
    found = {f"{skeleton.path}.{_SOURCE}": _source(prim)}
    for path in filter(None, (skeleton.path, skeleton.animation)):
        shown = stage.GetPrimAtPath(path)
        for name in _VALUES if shown else ():
            attribute = shown.GetAttribute(name)
            for spec in attribute.GetPropertyStack(DEFAULT)[:1] if attribute else ():
                found[f"{path}.{name}"] = f"{spec.layer.identifier} {spec.path}"
    return found


def _source(prim: Any) -> str:
    """The targets of the animation binding at or above a prim, as text."""
    while prim:
        relation = prim.GetRelationship(_SOURCE)
        if relation and relation.HasAuthoredTargets():
            return ", ".join(f"<{target}>" for target in relation.GetTargets())
        prim = prim.GetParent()
    return ""
