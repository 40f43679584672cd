"""What names the joints of a skeleton elsewhere: the influences of meshes, and attributes of others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pxr import Sdf, Usd

from rigtri.errors import FileError
from rigtri.formats.usd.composition.shared_instances import SharedInstances
from rigtri.formats.usd.composition.stage import DEFAULT, refuse, why_instanced, why_locked
from rigtri.formats.usd.composition.value_types import usable
from rigtri.formats.usd.composition.variants import choices
from rigtri.formats.usd.opinions.edits import Edit, set_tokens
from rigtri.formats.usd.reading.joint_tokens import split_token
from rigtri.formats.usd.reading.mesh_reader import ALL_PRIMS, Bindings
from rigtri.formats.usd.reading.source import Source
from rigtri.report import Notice
from rigtri.text import listed

ORDER, INDICES = "skel:joints", "primvars:skel:jointIndices"

# The name of each split joint's holder by the joint's token, for each skeleton.
Holders = Mapping[str, Mapping[str, str]]


def influence_edits(source: Source, splits: Holders) -> list[Edit]:
    """The joint order of every mesh that is bound to a split skeleton, by the new tokens.

    Indices stay as they are: a mesh without an order of its own gets the one that they
    were counted in. FileError where the order cannot be edited.
    """
    orders: dict[str, list[str]] = {}
    for path, query in source.bindings.every:
        if path not in splits or not query.HasJointInfluences():
            continue
        prim, old = _author(query.GetPrim()), source.skeletons[path].tokens
        if prim is not None:
            old = tuple(map(str, prim.GetAttribute(ORDER).Get(DEFAULT)))
        new = [split_token(token, splits[path]) for token in old]
        if prim is not None and new == list(old):
            continue
        edited = prim or query.GetPrim()
        refuse(why_instanced(edited) or why_locked(edited, (ORDER, INDICES)))
        at = str(edited.GetPath())
        if orders.setdefault(at, new) != new:
            raise FileError(f"<{at}>.{ORDER} is for two skeletons that are split differently.")
    return [set_tokens(at, ORDER, order) for at, order in orders.items()]


def _author(prim: Any) -> Any:
    """The prim at or above another that gives it its joint order; None where the skeleton does."""
    while prim:
        attribute = prim.GetAttribute(ORDER)
        if attribute and attribute.HasAuthoredValue() and usable(attribute, attribute.Get(DEFAULT)):
            return prim
        prim = prim.GetParent()
    return None


def why_bound_otherwise(stage: Any, skeleton: str) -> str:
    """Which unselected variant binds meshes to a skeleton by other influences than are seen; "" if none."""
    others = list(choices(stage, [str(prim.GetPath()) for prim in stage.Traverse()]))
    if not others:
        return ""
    session = Sdf.Layer.CreateAnonymous(".usda")
    session.TransferContent(stage.GetSessionLayer())
    trial = Usd.Stage.Open(stage.GetRootLayer(), session)
    trial.SetEditTarget(session)
    before = _bound(trial, skeleton)
    for path, name, variant, selected in others:
        chosen = trial.GetPrimAtPath(path).GetVariantSets().GetVariantSet(name)
        chosen.SetVariantSelection(variant)
        after = _bound(trial, skeleton)
        chosen.SetVariantSelection(selected)
        for mesh, places in after.items():
            if before.get(mesh) != places:
                return (
                    f"Variant '{variant}' of the variant set '{name}' on <{path}> binds <{mesh}> to "
                    f"<{skeleton}> otherwise, by joints that a split renames. Give each variant a file "
                    "of its own, or choose snap or skip"
                )
    return ""


def _bound(stage: Any, skeleton: str) -> dict[str, str]:
    """The places in layers that the influences of each mesh of a skeleton come from, by prim path."""
    prims = [query.GetPrim() for query in Bindings(SharedInstances(stage)).of({skeleton})]
    return {str(prim.GetPath()): _places(prim) for prim in prims}


def _places(prim: Any) -> str:
    words = []
    for name in (ORDER, INDICES):
        above = prim
        while above and not above.GetAttribute(name).HasAuthoredValue():
            above = above.GetParent()
        stack = above.GetAttribute(name).GetPropertyStack(DEFAULT) if above else ()
        words += [f"{spec.layer.identifier} {spec.path}" for spec in stack[:1]]
    return " ".join(words)


def stale_names(source: Source, splits: Holders) -> list[Notice]:
    """Notices of attributes that name renamed joints by the tokens they had, and are not changed."""
    old = {
        token
        for path, holders in splits.items()
        for token in source.skeletons[path].tokens
        if split_token(token, holders) != token
    }
    edited = {(path, name) for path in splits for name in ("joints", "jointNames")}
    edited |= {(played, "joints") for path in splits for played in source.skeletons[path].animations}
    found = [
        str(attribute.GetPath())
        for prim in Usd.PrimRange(source.stage.GetPseudoRoot(), ALL_PRIMS)
        for attribute in prim.GetAuthoredAttributes()
        if (str(prim.GetPath()), attribute.GetName()) not in edited and _names(attribute, old)
    ]
    if not found:
        return []
    shown = listed([f"<{path}>" for path in found])
    text = f"{len(found)} attributes name split joints by their old paths and are left as they were: {shown}."
    return [Notice("renamed-elsewhere", text)]


def _names(attribute: Any, tokens: set[str]) -> bool:
    kind, name = str(attribute.GetTypeName()), attribute.GetName()
    if kind not in ("token", "token[]", "string", "string[]") or name == ORDER or "rigtri" in name:
        return False
    # A root joint has a plain name, which may mean anything in attributes that are not about joints.
    plain = "joint" in name.lower()
    return any(word in tokens and (plain or "/" in word) for word in _words(attribute))


def _words(attribute: Any) -> Iterator[str]:
    value = attribute.Get(DEFAULT)
    yield from [value] if isinstance(value, str) else map(str, value or ())
