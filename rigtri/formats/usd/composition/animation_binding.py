"""Which SkelAnimation drives a skeleton, and why one that a file names does not.

UsdSkel goes to the nearest prim with SkelBindingAPI that has targets and takes the first of
them; one that is no SkelAnimation, or that is not active, drives nothing. Whether the prim is a
class or only an ``over`` with that type makes no difference to it.

Source: UsdSkelBindingAPI; measured with UsdSkelCache (tests/formats/usd/test_usd_bindings.py).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from pxr import UsdSkel

from rigtri.errors import FileError
from rigtri.report import Notice

SOURCE = "skel:animationSource"


def bound_animation(prim: Any, warnings: list[Notice], *, demanded: bool = True) -> Any:
    """The SkelAnimation prim that is bound to a Skeleton prim, active or not; None, with a notice, for none.

    FileError where the file names one that is not there, as where its layer is missing; not demanded: only
    where a prim of its path needs such a layer.
    """
    found = UsdSkel.BindingAPI(prim).GetInheritedAnimationSource()
    if found and found.GetTypeName() == "SkelAnimation":
        return found
    holder, target = named(prim)
    if holder is None:
        return None
    why = why_unplayed(holder, target)
    if not why and not demanded and not holder.GetStage().GetPrimAtPath(target):
        return None
    if not why:
        raise FileError(
            f"Skeleton <{prim.GetPath()}> is bound to the animation <{target}>, which is not there. "
            "Add the layer that has it to the stage (subLayers, references), or remove the binding."
        )
    text = f"<{holder.GetPath()}> is bound to the animation <{target}>, which UsdSkel passes over: {why}. "
    text += "It is left as it is."
    if all(notice.text != text for notice in warnings):
        warnings.append(Notice("binding-ignored", text))
    return None


def named(prim: Any) -> tuple[Any, Any]:
    """The prim at or above a skeleton that names an animation, and the path it names; None twice for none."""
    while prim:
        relation = prim.GetRelationship(SOURCE)
        if relation and relation.HasAuthoredTargets():
            targets = relation.GetForwardedTargets()
            return (prim, targets[0]) if targets else (None, None)
        prim = prim.GetParent()
    return None, None


def within_scene(scene: Iterable[Any], prims: Sequence[Any]) -> list[Any]:
    """Skeletons and animations without the animations of Skeletons that are no prims of the scene.

    UsdSkel skins a mesh of the scene (all its prims) also by a Skeleton below a class, or an ``over`` that no
    layer defines. Edits leave such a Skeleton as it is, and so must they leave what it plays.
    """
    played = {named(prim)[1] for prim in prims if prim.GetTypeName() == "Skeleton"}
    loose = {prim.GetPath() for prim in prims if prim.GetTypeName() == "SkelAnimation"} - played
    bound = (prim.GetRelationship("skel:skeleton") for prim in (scene if loose else ()))
    targets = {path: one.GetStage() for one in bound if one for path in one.GetForwardedTargets()}
    skeletons = (found for path, stage in targets.items() if (found := stage.GetPrimAtPath(path)))
    loose &= {named(prim)[1] for prim in skeletons if prim.IsAbstract() or not prim.IsDefined()}
    return [prim for prim in prims if prim.GetPath() not in loose]


def why_unplayed(holder: Any, target: Any) -> str:
    """Why UsdSkel passes over a binding whose target is there; "" where none is there."""
    stage = holder.GetStage()
    found = stage.GetPrimAtPath(target)
    if not found:
        idle = idle_above(stage, target)
        return f"<{idle.GetPath()}> above it is not active" if idle else ""
    kind = found.GetTypeName()
    if kind != "SkelAnimation":
        if not kind and (found.HasAuthoredReferences() or found.HasAuthoredPayloads()):
            return ""  # what it refers to is missing, and would have given it its type
        return f"it is {f'of type {kind}' if kind else 'a prim without a type'} and no SkelAnimation"
    return "" if holder.HasAPI(UsdSkel.BindingAPI) else f"<{holder.GetPath()}> has no SkelBindingAPI"


def idle_above(stage: Any, path: Any) -> Any:
    """The uppermost prim at or above a path that is not active; None where all are."""
    above = (stage.GetPrimAtPath(prefix) for prefix in path.GetPrefixes())
    return next((prim for prim in above if prim and not prim.IsActive()), None)
