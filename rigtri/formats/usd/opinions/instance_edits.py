"""Edits of prims inside instances, as opinions of classes that the instances inherit.

USD ignores opinions below an instance, for what is there is shared. A class
that the instance itself inherits is stronger than references, payloads and
variants; instances that inherit the same class still share one prototype. So
there is one class for all instances of an edited prototype, at the root of the edited layer: whatever
is edited in one of them is edited in all. Prototypes that get the same opinions, as those of other looks of
one character, inherit one class. An instance inside another gets its ``inherits`` from the class of the outer
one.

Source: OpenUSD glossary, LIVRPS and "Instancing"; measured with usd-core 26.11.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from pxr import Sdf, Tf, Usd

from rigtri.errors import FileError
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.shared_instances import CLASS, is_own_class
from rigtri.formats.usd.opinions.edits import Declaration, Edit, Setting, free_path

# Where the opinions of a class stand while they are compared with those of others.
_PLACE = Sdf.Path("/Shared")


def instance_of(stage: Any, path: Any) -> Any:
    """The innermost instance above a prim, which need not exist yet; None where there is none."""
    for above in reversed(Sdf.Path(path).GetParentPath().GetPrefixes()):
        prim = stage.GetPrimAtPath(above)
        if prim and prim.IsInstance():
            return prim
    return None


def apply_edits(stage: Any, edits: Sequence[Edit], layer: Any) -> None:
    """Make edits of a stage in a layer, those of prims inside instances through classes."""
    within = {prim for prim in {edit.prim for edit in edits} if instance_of(stage, prim) is not None}
    inside = [edit for edit in edits if edit.prim in within]
    held = {id(edit) for edit in inside}
    _make(stage, [edit for edit in edits if id(edit) not in held], layer)
    if inside:
        _Classes(stage, _each_once(stage, inside), layer).write()


def _each_once(stage: Any, edits: Sequence[Edit]) -> list[Edit]:
    """The edits without those that say in another instance of a prim what one says of it already.

    A prototype of meshes alone is read at each instance, for each may be bound to a skeleton of its own.
    """
    found, known = list[Edit](), dict[Any, Any]()
    for edit in edits:
        prim = stage.GetPrimAtPath(edit.prim)
        if isinstance(edit, Setting | Declaration) and prim and prim.IsInstanceProxy():
            first = known.setdefault((prim.GetPrimInPrototype().GetPath(), edit.name, type(edit)), edit)
            if first.prim != edit.prim and _says_the_same(first, edit):
                continue
        found.append(edit)
    return found


def _says_the_same(one: Any, other: Any) -> bool:
    """Whether two edits of one kind and name give the same, with the same metadata."""
    if isinstance(one, Declaration):
        return bool(one.fields == other.fields)
    first, second = one.arrays(), other.arrays()
    return (
        one.samples.keys() == other.samples.keys()
        and first.keys() == second.keys()
        and all(np.array_equal(values, second[time]) for time, values in first.items())
    )


def _make(stage: Any, edits: Sequence[Edit], layer: Any) -> None:
    """Make edits in a layer, with the variant sets of each prim in the order that they have on the stage.

    The first opinion within a variant lists its set before all others, which would make it the strongest.
    """
    above = {path for edit in edits for path in Sdf.Path(edit.prim).GetPrefixes()}
    named = {path: prim.GetVariantSets().GetNames() for path in above if (prim := stage.GetPrimAtPath(path))}
    several = {path: names for path, names in named.items() if len(names) > 1}
    before = {path: _listed_sets(layer, path) for path in several}
    with Sdf.ChangeBlock():
        for edit in edits:
            edit(layer)
    for path, names in several.items():
        if (listed := _listed_sets(layer, path)) != before[path]:
            items = layer.GetPrimAtPath(path).variantSetNameList
            order = [*names, *(name for name in listed if name not in names)]
            if items.isExplicit:
                items.explicitItems = order
            else:
                items.prependedItems = order


def _listed_sets(layer: Any, path: Any) -> list[str]:
    """The variant sets that a layer lists for a prim, the strongest first."""
    spec = layer.GetPrimAtPath(path)
    return list(spec.variantSetNameList.GetAddedOrExplicitItems()) if spec else []


class _Classes:
    """The classes of edited prototypes. edits: all inside instances. layer: a copy of the one to edit."""

    def __init__(self, stage: Any, edits: Sequence[Edit], layer: Any) -> None:
        self.stage, self.edits, self.layer = stage, edits, layer
        # Instances by prototype: those of the stage, and those in other prototypes with these.
        self.outer: dict[Any, list[Any]] = {}
        self.nested: dict[Any, list[tuple[Any, Any]]] = {}
        for top in (stage.GetPseudoRoot(), *stage.GetPrototypes()):
            for prim in Usd.PrimRange(top):
                if prim.IsInstance() and top.IsPseudoRoot():
                    self.outer.setdefault(prim.GetPrototype().GetPath(), []).append(prim.GetPath())
                elif prim.IsInstance():
                    within = prim.GetPath().MakeRelativePath(top.GetPath())
                    self.nested.setdefault(prim.GetPrototype().GetPath(), []).append((top.GetPath(), within))
        # The instance of each edited prototype in which it is edited.
        self.shown: dict[Any, Any] = {}
        for edit in edits:
            self._add_instances(edit)
        for prototype in list(self.shown):
            self._add_holders(prototype)

    def write(self) -> None:
        """Write the classes, and let all instances inherit them."""
        scratch, order = layers.empty(), list(self._inner_first())
        own = self._inherited()
        for prototype in reversed(order):  # the outer first: what it holds replaces all below
            if prototype in own:
                _copy_below(self.layer, own[prototype], scratch, self.shown[prototype])
        _make(self.stage, self.edits, scratch)
        # Classes whose opinions those of prototypes that are not edited are, too.
        taken = {path for prototype, path in own.items() if prototype not in self.shown}
        written = dict[bytes, Any]()
        for prototype in order:
            before = own.get(prototype)
            content = _digest(scratch, self.shown[prototype]) if len(order) > 1 else b""
            if content not in written:
                path = self._free_path(self.shown[prototype]) if before is None or before in taken else before
                self._write_class(scratch, self.shown[prototype], path)
                written[content] = path
                taken.add(path)
            self._inherit(prototype, before, written[content], scratch)
        for path in {*own.values()} - taken:
            del self.layer.rootPrims[path.name]

    def _inherited(self) -> dict[Any, Any]:
        """The class of an earlier edit that instances of a prototype inherit, by prototype."""
        known, found = _own_classes(self.layer), dict[Any, Any]()
        for prototype in {**self.outer, **self.nested} if known else ():
            prim = self.stage.GetPrimAtPath(self._instance_path(prototype))
            if inherited := [path for path in prim.GetInherits().GetAllDirectInherits() if path in known]:
                found[prototype] = inherited[0]
        return found

    def _free_path(self, shown: Any) -> Any:
        name, root = Tf.MakeValidIdentifier(f"rigtri_{shown.name}"), Sdf.Path.absoluteRootPath
        return free_path(
            root, name, lambda one: self.stage.GetPrimAtPath(one) or self.layer.GetPrimAtPath(one)
        )

    def _write_class(self, scratch: Any, shown: Any, path: Any) -> None:
        _copy_below(scratch, shown, self.layer, path)
        spec = self.layer.GetPrimAtPath(path)
        spec.specifier, spec.customData = Sdf.SpecifierClass, CLASS

    def _inherit(self, prototype: Any, before: Any, path: Any, scratch: Any) -> None:
        """Let all instances of a prototype inherit a class, in place of the one that they did before."""
        with Sdf.ChangeBlock():
            for instance in self.outer.get(prototype, ()):
                _inherit(self.layer, instance, path, before)
        for holder, within in self.nested.get(prototype, ()):
            # The outer instance's class is written later, from what the scratch layer holds then: where
            # the inner one stands is its own.
            place = self.shown[holder].AppendPath(within)
            if scratch.GetPrimAtPath(place) is not None:
                _remove_children(scratch.GetPrimAtPath(place))
            _inherit(scratch, place, path, before)

    def _add_instances(self, edit: Edit) -> None:
        """Note the instance that holds an edited prim, and all that hold that one."""
        prim = instance_of(self.stage, edit.prim)
        while prim is not None:
            path = self.shown.setdefault(prim.GetPrototype().GetPath(), prim.GetPath())
            if path != prim.GetPath():
                raise FileError(
                    f"<{path}> and <{prim.GetPath()}> are instances of one prototype, and cannot be edited "
                    "in different ways. Make one of them no instance (instanceable = false)."
                )
            prim = instance_of(self.stage, prim.GetPath())

    def _add_holders(self, prototype: Any) -> None:
        """Note an instance of each prototype that holds instances of a prototype."""
        for holder, _ in self.nested.get(prototype, ()):
            if holder not in self.shown:
                self._add_holders(holder)
                self.shown[holder] = self._instance_path(holder)

    def _instance_path(self, prototype: Any) -> Any:
        if self.outer.get(prototype):
            return self.outer[prototype][0]
        holder, within = self.nested[prototype][0]
        return self.shown.get(holder, self._instance_path(holder)).AppendPath(within)

    def _inner_first(self) -> Iterator[Any]:
        """Edited prototypes, each before those that hold instances of it."""
        left = list(self.shown)
        while left:
            holders = {holder for one in left for holder, _ in self.nested.get(one, ())}
            ready = [one for one in left if one not in holders]
            yield from ready
            left = [one for one in left if one not in ready]


def _inherit(layer: Any, path: Any, base: Any, before: Any) -> None:
    """Let a prim inherit ``base`` before all else that it inherits, and no longer ``before``."""
    items = Sdf.CreatePrimInLayer(layer, path).inheritPathList
    if items.isExplicit:
        items.explicitItems = [base, *(item for item in items.explicitItems if item not in (base, before))]
    else:
        kept = (item for item in items.prependedItems if item not in (base, before))
        items.prependedItems = [base, *kept]


def _digest(layer: Any, shown: Any) -> bytes:
    """What a class of the opinions below a prim would be, wherever it stood."""
    import hashlib  # of a file without instances nobody needs it

    made = layers.empty()
    _copy_below(layer, shown, made, _PLACE)
    found = hashlib.sha256()

    def add(path: Any) -> None:
        spec = made.GetObjectAtPath(path)
        found.update(f"{path}\0".encode())
        for key in sorted(spec.ListInfoKeys()) if spec is not None else ():
            if key != "timeSamples":
                found.update(f"{key}\0".encode() + _bytes(spec.GetInfo(key)))
        for time in made.ListTimeSamplesForPath(path):
            found.update(f"{time!r}\0".encode() + _bytes(made.QueryTimeSample(path, time)))

    places = list[Any]()
    made.Traverse(_PLACE, places.append)
    for place in sorted(places):  # in whatever order edits have made them
        add(place)
    return found.digest()


def _bytes(value: Any) -> bytes:
    """A value as bytes: arrays of numbers as they are, all else as USD writes it."""
    if type(value).__module__ == "pxr.Vt" and (numbers := np.array(value)).dtype.kind in "fiu":
        return numbers.tobytes()
    return repr(value).encode()


def _remove_children(spec: Any) -> None:
    for child in list(spec.nameChildren):
        del spec.nameChildren[child.name]


def _copy_below(source: Any, start: Any, target: Any, end: Any) -> None:
    """Copy what lies below a prim; targets that pointed there follow.

    The properties and arcs of the prim itself stay what they are in the target: they are those of one
    instance, and what all share lies below.
    """
    moved = layers.empty()
    Sdf.CreatePrimInLayer(moved, end)
    Sdf.CopySpec(source, start, moved, end)
    spec = moved.GetPrimAtPath(end)
    spec.specifier = Sdf.SpecifierOver
    spec.inheritPathList.ClearEdits()
    if "customData" in spec.ListInfoKeys():
        spec.ClearInfo("customData")
    for item in list(spec.properties):
        spec.RemoveProperty(item)
    held = Sdf.CreatePrimInLayer(target, end)
    for key in held.ListInfoKeys():
        spec.SetInfo(key, held.GetInfo(key))
    for item in held.properties:
        Sdf.CopySpec(target, item.path, moved, item.path)
    Sdf.CopySpec(moved, end, target, end)


def drop_empty_classes(layer: Any) -> None:
    """Take away the classes of rigtri in a layer that hold nothing, and what inherits them."""
    while empty := [path for path in _own_classes(layer) if _is_empty(layer.GetPrimAtPath(path))]:
        for path in empty:
            del layer.rootPrims[path.name]
        paths = list[Any]()
        layer.Traverse(Sdf.Path.absoluteRootPath, paths.append)
        for at in paths:
            _inherit_none(layer, at, empty)


def _is_empty(spec: Any) -> bool:
    """Whether a class holds overs of nothing alone, which are taken away."""
    for child in list(spec.nameChildren):
        if (
            _is_empty(child)
            and child.specifier == Sdf.SpecifierOver
            and child.ListInfoKeys() == ["specifier"]
        ):
            del spec.nameChildren[child.name]
    return not (spec.nameChildren or spec.properties or spec.variantSets)


def _inherit_none(layer: Any, at: Any, gone: Sequence[Any]) -> None:
    spec = layer.GetPrimAtPath(at) if at.IsPrimPath() or at.IsPrimVariantSelectionPath() else None
    if spec is not None and spec.hasInheritPaths:
        for path in gone:
            spec.inheritPathList.RemoveItemEdits(path)
        if not spec.inheritPathList.GetAddedOrExplicitItems():
            spec.inheritPathList.ClearEdits()


def _own_classes(layer: Any) -> set[Any]:
    """The classes of rigtri in a layer."""
    return {spec.path for spec in layer.rootPrims if is_own_class(spec)}
