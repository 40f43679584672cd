"""What names the joints of a skeleton elsewhere: the influences of meshes, and attributes of others."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from pxr import Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.shared_instances import SharedInstances
from rigtri.formats.usd.composition.stage import DEFAULT, refuse, tokens_of, why_locked
from rigtri.formats.usd.composition.value_types import usable
from rigtri.formats.usd.composition.variant_choices import each_choice
from rigtri.formats.usd.composition.variants import SkeletonVariants, VariantState, in_words
from rigtri.formats.usd.opinions.edits import (
    BINDING,
    Edit,
    Setting,
    apply_schema,
    binding_schema,
    set_tokens,
)
from rigtri.formats.usd.opinions.variant_paths import inside_variants
from rigtri.formats.usd.reading.mesh_reader import Bindings, weighted
from rigtri.formats.usd.reading.source import Source
from rigtri.model.dataclass import dataclass
from rigtri.report import Notice
from rigtri.text import and_more

ORDER, INDICES = "skel:joints", "primvars:skel:jointIndices"
WEIGHTS = "primvars:skel:jointWeights"

# What becomes of a joint's token, for each skeleton.
Renaming = Mapping[str, Callable[[str], str]]


@dataclass(frozen=True, eq=False)
class _Order:
    """The joint order of meshes: the prim that gives it or gets it, by the new tokens.

    place: where it comes from, "" for the skeleton. changed: whether it must be written. unbound: whether the
    prim lacks the schema without which UsdSkel would not see it. locked: why it cannot be written outside of
    variants.
    """

    prim: Any
    tokens: Sequence[str]
    place: str
    changed: bool
    unbound: bool
    locked: str

    def edits(self, at: Any) -> list[Edit]:
        """What writes it, at a path that may lie within variants."""
        schema = [apply_schema(at, BINDING)] if self.unbound else []
        return [replace(edit, prim=self.prim) for edit in (*schema, set_tokens(at, ORDER, self.tokens))]


# What each prim that gives or gets an order has when variants are chosen; () for those of the file.
_Orders = dict[Any, dict[tuple[Any, ...], _Order]]


def influence_edits(source: Source, renaming: Renaming, *, grown: bool = True) -> list[Edit]:
    """The joint order of every mesh that is bound to a skeleton of renamed joints, by the new tokens.

    Indices stay as they are: where the skeleton has grown, a mesh without an order of its own gets the one
    that they were counted in. What variants decide is written in each. FileError where it cannot be edited.
    """
    found: _Orders = {}
    _add_orders(found, (), source.bindings, source, renaming, grown=grown)
    for chosen, trial in each_choice(source.stage):
        if not chosen:
            continue
        here = tuple(chosen.items())
        _add_orders(found, here, Bindings(SharedInstances(trial)), source, renaming, grown=grown)
        if not any(here in orders and _differs(orders, here) for orders in found.values()):
            continue
        # What another set holds may be hidden by the one that decides in the file.
        for more, below in each_choice(trial, counts=partial(_is_other, chosen)):
            if more:
                bindings = Bindings(SharedInstances(below))
                _add_orders(found, (*here, *more.items()), bindings, source, renaming, grown=grown)
    return [edit for orders in found.values() for edit in _order_edits(source.stage, orders)]


def _add_orders(
    found: _Orders, chosen: Any, bindings: Bindings, source: Source, renaming: Renaming, *, grown: bool
) -> None:
    for path, query in bindings.every:
        if path not in renaming or not query.HasJointInfluences():
            continue
        author = _author(query.GetPrim())
        prim = author or query.GetPrim()
        old = source.skeletons[path].tokens if author is None else tokens_of(author, ORDER)
        new = list(map(renaming[path], old))
        changed = grown if author is None else new != list(old)
        place = "" if author is None else _places(author, ORDER)
        unbound, locked = bool(binding_schema(prim)), why_locked(prim, (ORDER,))
        order = _Order(prim.GetPath(), new, place, changed, unbound, locked)
        known = found.setdefault(order.prim, {}).setdefault(chosen, order)
        if known.tokens != new and changed:
            raise FileError(
                f"<{order.prim}>.{ORDER} is for two skeletons whose joints are renamed differently."
            )


def _is_other(chosen: Collection[Any], prim: Any, name: str, _: str) -> bool:
    return (prim.GetPath(), name) not in chosen


def _differs(orders: Mapping[tuple[Any, ...], _Order], chosen: tuple[Any, ...]) -> bool:
    """Whether an order comes from elsewhere in a state than in the file's own."""
    return () not in orders or orders[chosen].place != orders[()].place


def _order_edits(stage: Any, orders: Mapping[tuple[Any, ...], _Order]) -> Iterator[Edit]:
    """What writes the orders of one prim, where one variant set decides them in each of its variants."""
    if not any(order.changed for order in orders.values()):
        return
    base = orders.get(())
    own = _deciding(orders)
    if not own:
        if base and base.changed:
            refuse(base.locked)
            yield from base.edits(base.prim)
        return
    sets = {chosen[0][0] for chosen in own}
    inner = [chosen for chosen in own if chosen[1:]]
    if len(sets) > 1 or inner:
        title = in_words(dict((inner or own)[0]), begin=True)
        raise FileError(
            f"{title} and other variant sets bind <{orders[own[0]].prim}> each by other joints, which "
            "get other paths. Give each variant a file of its own."
        )
    ((above, name),) = sets
    selected = stage.GetPrimAtPath(above).GetVariantSet(name).GetVariantSelection()
    for chosen, order in orders.items():
        variant = dict(chosen).get((above, name), selected if not chosen else None)
        if order.changed and len(chosen) < 2 and variant is not None:
            variants = SkeletonVariants(stage, str(order.prim), "", explore=False)
            state = VariantState(dict(chosen), {(above, name): variant}, {})
            yield from order.edits(inside_variants(order.prim, {(above, name)}, state, variants))


def _deciding(orders: Mapping[tuple[Any, ...], _Order]) -> list[tuple[Any, ...]]:
    """The choices of variants that bring an order of their own: what is chosen beside them changes none."""
    base = orders.get(())
    place = base.place if base else None
    own = {chosen: order.place for chosen, order in orders.items() if order.place != place}
    return [c for c in own if not any(set(less) < set(c) and own[less] == own[c] for less in own)]


def _author(prim: Any) -> Any:
    """The prim at or above another that gives it its joint order; None where the skeleton does."""
    while prim:
        attribute = prim.GetAttribute(ORDER)
        if attribute and attribute.HasAuthoredValue() and usable(attribute, attribute.Get(DEFAULT)):
            return prim
        prim = prim.GetParent()
    return None


def check_moves_nothing(stage: Any, skeleton: str, tokens: Sequence[str], gone: Collection[str]) -> None:
    """FileError where an unselected variant has points that the joints ``gone`` move, or counts past them."""
    before: dict[str, str] = {}
    for chosen, trial in each_choice(stage):
        queries = Bindings(SharedInstances(trial)).of({skeleton})
        after = {str(q.GetPrim().GetPath()): _places(q.GetPrim(), ORDER, INDICES, WEIGHTS) for q in queries}
        if not chosen:
            before = after
            continue
        for query in queries:
            mesh, own = str(query.GetPrim().GetPath()), query.GetJointOrder()
            if before.get(mesh) == after[mesh] or not query.HasJointInfluences():
                continue
            order = list(map(str, own)) if own else list(tokens)
            moving = [token for token, moves in zip(order, weighted([query], order), strict=True) if moves]
            first = len(order) if own else min(map(order.index, gone))
            lost = [token for token in moving if token in gone]
            behind = [token for token in moving if order.index(token) > first]
            if lost or behind:
                names = and_more([f"'{token.rpartition('/')[2]}'" for token in lost or behind], 3)
                moved = f"{names} {'moves' if len(lost or behind) == 1 else 'move'}"
                why = f"which {moved}. Leave out the joints that it needs (--exclude)"
                if not lost:
                    why = f"which {moved}, by a number that would be another joint's. Give that mesh a list "
                    why += "of its own joints (skel:joints)"
                raise FileError(
                    f"A joint of <{skeleton}> cannot be removed: {in_words(chosen)} has <{mesh}>, {why}, or "
                    "give each variant a file of its own."
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
    if isinstance(value, str):
        yield value
    elif isinstance(value, Vt.TokenArray | Vt.StringArray):  # a damaged layer may hold anything
        yield from value
