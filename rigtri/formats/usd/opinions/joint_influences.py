"""What names the joints of a skeleton elsewhere: the influences of meshes, and attributes of others."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.usd.composition.shared_instances import SharedInstances
from rigtri.formats.usd.composition.stage import DEFAULT, refuse, why_locked
from rigtri.formats.usd.composition.value_types import usable
from rigtri.formats.usd.composition.variants import each_choice
from rigtri.formats.usd.opinions.edits import Edit, Setting, binding_schema, set_tokens
from rigtri.formats.usd.reading.mesh_reader import Bindings, weighted
from rigtri.formats.usd.reading.source import Source
from rigtri.report import Notice
from rigtri.text import and_more

ORDER, INDICES = "skel:joints", "primvars:skel:jointIndices"
WEIGHTS = "primvars:skel:jointWeights"

# What becomes of a joint's token, for each skeleton.
Renaming = Mapping[str, Callable[[str], str]]


def influence_edits(source: Source, renaming: Renaming, *, grown: bool = True) -> list[Edit]:
    """The joint order of every mesh that is bound to a skeleton of renamed joints, by the new tokens.

    Indices stay as they are: where the skeleton has grown, a mesh without an order of its own gets the one
    that they were counted in. FileError where the order cannot be edited.
    """
    orders: dict[str, list[str]] = {}
    schemas: list[Edit] = []
    for path, query in source.bindings.every:
        if path not in renaming or not query.HasJointInfluences():
            continue
        prim, old = _author(query.GetPrim()), source.skeletons[path].tokens
        if prim is not None:
            old = tuple(map(str, prim.GetAttribute(ORDER).Get(DEFAULT)))
        new = list(map(renaming[path], old))
        if new == list(old) if prim is not None else not grown:
            continue
        edited = prim or query.GetPrim()
        refuse(why_locked(edited, (ORDER,)))
        at = str(edited.GetPath())
        schemas += binding_schema(edited) if at not in orders else []
        if orders.setdefault(at, new) != new:
            raise FileError(f"<{at}>.{ORDER} is for two skeletons whose joints are renamed differently.")
    return [*schemas, *(set_tokens(at, ORDER, order) for at, order in orders.items())]


def _author(prim: Any) -> Any:
    """The prim at or above another that gives it its joint order; None where the skeleton does."""
    while prim:
        attribute = prim.GetAttribute(ORDER)
        if attribute and attribute.HasAuthoredValue() and usable(attribute, attribute.Get(DEFAULT)):
            return prim
        prim = prim.GetParent()
    return None


def why_bound_otherwise(stage: Any, skeleton: str, *, grown: bool = True) -> str:
    """Which unselected variant has a mesh that `influence_edits` cannot bind to a skeleton; "" if none.

    Such a mesh has an order of joints of its own, which no edit of the selected variants reaches, or needs
    one where the skeleton has grown.
    """
    before: dict[str, str] = {}
    for title, trial in each_choice(stage):
        queries = Bindings(SharedInstances(trial)).of({skeleton})
        after = {
            str(q.GetPrim().GetPath()): _places(q.GetPrim(), ORDER) for q in queries if q.HasJointInfluences()
        }
        if not title:
            before = after
            continue
        for mesh, order in after.items():
            missed = order not in before.values() if order else grown
            if before[mesh] != order if mesh in before else missed:
                return (
                    f"{title} binds <{mesh}> to <{skeleton}> otherwise, by joints that get other paths. Give "
                    "each variant a file of its own"
                )
    return ""


def check_moves_nothing(stage: Any, skeleton: str, tokens: Sequence[str], gone: Collection[str]) -> None:
    """FileError where an unselected variant has points that the joints ``gone`` move, or counts past them."""
    before: dict[str, str] = {}
    for title, trial in each_choice(stage):
        queries = Bindings(SharedInstances(trial)).of({skeleton})
        after = {str(q.GetPrim().GetPath()): _places(q.GetPrim(), ORDER, INDICES, WEIGHTS) for q in queries}
        if not title:
            before = after
            continue
        for query in queries:
            mesh, own = str(query.GetPrim().GetPath()), query.GetJointOrder()
            if before.get(mesh) == after[mesh] or not query.HasJointInfluences():
                continue
            order = list(map(str, own)) if own else list(tokens)
            moving = [token for token, moves in zip(order, weighted([query], order), strict=True) if moves]
            first = len(order) if own else min(map(order.index, gone))
            if lost := [token for token in moving if token in gone or order.index(token) > first]:
                names = and_more([f"'{token.rpartition('/')[2]}'" for token in lost], 3)
                raise FileError(
                    f"A joint of <{skeleton}> cannot be removed: {title[0].lower()}{title[1:]} has <{mesh}>, "
                    f"which {names} {'moves' if len(lost) == 1 else 'move'}. Leave out the joints that it "
                    "needs (--exclude), or give each variant a file of its own."
                )


def _places(prim: Any, *names: str) -> str:
    """The places in layers that attributes of a prim come from, by it or by what is above it; "" for none."""
    words = []
    for name in names:
        above = prim
        while above and not above.GetAttribute(name).HasAuthoredValue():
            above = above.GetParent()
        stack = above.GetAttribute(name).GetPropertyStack(DEFAULT) if above else ()
        words += [f"{spec.layer.identifier} {spec.path}" for spec in stack[:1]]
    return " ".join(words)


def stale_names(source: Source, renaming: Renaming, edits: Sequence[Edit]) -> list[Notice]:
    """Notices of attributes that name renamed joints by the tokens they had, and that no edit changes."""
    old = {
        token
        for path, renamed in renaming.items()
        for token in source.skeletons[path].tokens
        if renamed(token) != token
    }
    # Other skeletons and what they play have joints of their own, whatever these are called.
    strange = (each for path, each in source.skeletons.items() if path not in renaming)
    others = (path for each in strange for path in each.every_animation)
    known = {*source.skeletons, *others}
    edited = {(path, name) for path in known for name in ("joints", "jointNames")}
    edited |= {(str(edit.prim), edit.name) for edit in edits if isinstance(edit, Setting)}
    found = [
        str(attribute.GetPath())
        for prim in source.instances.prims()
        for attribute in prim.GetAuthoredAttributes()
        if (str(prim.GetPath()), attribute.GetName()) not in edited and _names(attribute, old)
    ]
    if not found:
        return []
    shown = and_more([f"<{path}>" for path in found], 3)
    text = f"{len(found)} attributes name joints by their old paths and are left as they were: {shown}."
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
