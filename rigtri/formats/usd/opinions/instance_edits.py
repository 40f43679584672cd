"""Edits of prims inside instances, as opinions of classes that the instances inherit.

USD ignores opinions below an instance, for what is there is shared. A class
that the instance itself inherits is stronger than references, payloads and
variants; instances that inherit the same class still share one prototype. So
there is one class for all instances that shared a prototype and are edited
alike, at the root of the edited layer. An instance inside another gets its
``inherits`` from the class of the outer one.

Source: OpenUSD glossary, LIVRPS and "Instancing"; measured with usd-core 26.11.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pxr import Sdf, Tf, Usd

from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.opinions.edits import Edit, free_path
from rigtri.report import Notice
from rigtri.text import listed

# The custom data of our classes: what a later edit may write into.
MARK = "rigtri"
_CLASS = {MARK: "instances"}

# The opinions of a prim spec, in a form that two instances can be compared by.
Content = list[tuple[Any, ...]]


def instance_of(stage: Any, path: Any) -> Any:
    """The innermost instance above a prim, which need not exist yet; None where there is none."""
    for above in reversed(Sdf.Path(path).GetParentPath().GetPrefixes()):
        prim = stage.GetPrimAtPath(above)
        if prim and prim.IsInstance():
            return prim
    return None


def apply_edits(stage: Any, edits: Sequence[Edit], layer: Any, warnings: list[Notice]) -> None:
    """Make edits of a stage in a layer, those of prims inside instances through classes."""
    inside: list[Edit] = []
    with Sdf.ChangeBlock():
        for edit in edits:
            if instance_of(stage, edit.prim) is None:
                edit(layer)
            else:
                inside.append(edit)
    if inside:
        _apply_inside(stage, inside, layer, warnings)


def _apply_inside(stage: Any, edits: Sequence[Edit], layer: Any, warnings: list[Notice]) -> None:
    """Make edits of prims inside instances in ``layer``, through classes.

    edits: those whose prim lies in an instance of the stage. layer: a copy of the layer that
    will be edited.
    """
    prims = _instances_of(stage, edits)
    scratch, known = layers.empty(), _own_classes(stage, layer)
    for prim in reversed(prims):  # the outer first: what it holds replaces all below
        inherited = [path for path in _inherited(prim) if path in known]
        if inherited:
            _copy(layer, inherited[0], scratch, prim.GetPath())
    for edit in edits:
        edit(scratch)
    groups = _groups(prims, scratch)
    for group in groups:
        _write(group, stage, layer, scratch, known)
    _notice_split_prototypes(stage, groups, warnings)


@dataclass
class _Group:
    """Instances that shared a prototype and are edited alike; path: of their class."""

    prototype: Any
    content: Content
    prims: list[Any]
    path: Any


def _instances_of(stage: Any, edits: Sequence[Edit]) -> list[Any]:
    """All instances that hold an edited prim, the inner before the outer ones."""
    found = {}
    for edit in edits:
        prim = instance_of(stage, edit.prim)
        while prim is not None:
            found[prim.GetPath()] = prim
            prim = instance_of(stage, prim.GetPath())
    order = {path: number for number, path in enumerate(found)}
    return [found[path] for path in sorted(found, key=lambda path: (-path.pathElementCount, order[path]))]


def _groups(prims: Sequence[Any], scratch: Any) -> list[_Group]:
    """Group instances; the opinions of an inner one are taken out of the outer one, which inherits it."""
    groups: list[_Group] = []
    for prim in prims:
        prototype, content = prim.GetPrototype().GetPath(), _content(scratch, prim.GetPath())
        for group in groups:
            if group.prototype == prototype and group.content == content:
                group.prims.append(prim)
                break
        else:
            groups.append(_Group(prototype, content, [prim], Sdf.Path.emptyPath))
    return groups


def _content(scratch: Any, root: Any) -> Content:
    """All opinions of a layer below a prim, with paths as seen from it."""
    found: Content = []

    def visit(path: Any) -> None:
        spec, place = scratch.GetObjectAtPath(path), path.MakeRelativePath(root)
        if isinstance(spec, Sdf.AttributeSpec):
            times = scratch.ListTimeSamplesForPath(path)
            samples = [(time, scratch.QueryTimeSample(path, time)) for time in times]
            samples = [(time, None if isinstance(v, Sdf.ValueBlock) else v) for time, v in samples]
            found.append((place, spec.typeName, spec.default, samples))
        elif isinstance(spec, Sdf.RelationshipSpec):
            targets = spec.targetPathList.explicitItems
            found.append((place, [target.MakeRelativePath(root) for target in targets]))
        elif isinstance(spec, Sdf.PrimSpec) and path != root:
            found.append((place, spec.specifier, spec.typeName, str(spec.GetInfo("apiSchemas"))))

    if scratch.GetPrimAtPath(root) is not None:
        scratch.Traverse(root, visit)
    return sorted(found, key=lambda entry: str(entry[0]))


def _write(group: _Group, stage: Any, layer: Any, scratch: Any, known: dict[Any, set[Any]]) -> None:
    """Write the class of a group, and let its instances inherit it."""
    first = group.prims[0]
    members = {prim.GetPath() for prim in group.prims}
    own = [path for path in _inherited(first) if known.get(path) == members]
    if own:
        group.path = own[0]
    else:
        name, root = Tf.MakeValidIdentifier(f"{MARK}_{first.GetName()}"), Sdf.Path.absoluteRootPath
        group.path = free_path(
            root, name, lambda path: stage.GetPrimAtPath(path) or layer.GetPrimAtPath(path)
        )
    _copy(scratch, first.GetPath(), layer, group.path)
    spec = layer.GetPrimAtPath(group.path)
    spec.specifier, spec.customData = Sdf.SpecifierClass, _CLASS
    for prim in group.prims:
        inner = prim.IsInstanceProxy()
        if inner:
            # The outer instance's class is written later, from what the scratch layer holds then.
            _empty(scratch.GetPrimAtPath(prim.GetPath()))
        _inherit(scratch if inner else layer, prim.GetPath(), group.path)


def _inherit(layer: Any, path: Any, base: Any) -> None:
    """Let a prim inherit ``base`` before all else that it inherits."""
    items = Sdf.CreatePrimInLayer(layer, path).inheritPathList
    if items.isExplicit:
        items.explicitItems = [base, *(item for item in items.explicitItems if item != base)]
    else:
        items.prependedItems = [base, *(item for item in items.prependedItems if item != base)]


def _empty(spec: Any) -> None:
    for child in list(spec.nameChildren):
        del spec.nameChildren[child.name]
    for item in list(spec.properties):
        spec.RemoveProperty(item)


def _copy(source: Any, start: Any, target: Any, end: Any) -> None:
    """Copy a prim and all below it; targets that pointed below it follow."""
    Sdf.CreatePrimInLayer(target, end)
    Sdf.CopySpec(source, start, target, end)
    spec = target.GetPrimAtPath(end)
    spec.specifier = Sdf.SpecifierOver
    if "customData" in spec.ListInfoKeys():
        spec.ClearInfo("customData")


def _inherited(prim: Any) -> list[Any]:
    return list(prim.GetInherits().GetAllDirectInherits())


def _own_classes(stage: Any, layer: Any) -> dict[Any, set[Any]]:
    """The classes of rigtri in a layer, each with the paths of the instances that inherit it."""
    found: dict[Any, set[Any]] = {
        spec.path: set()
        for spec in layer.rootPrims
        if spec.specifier == Sdf.SpecifierClass and spec.customData.get(MARK) == _CLASS[MARK]
    }
    if found:
        for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
            for path in _inherited(prim) if prim.IsInstance() else ():
                if path in found:
                    found[path].add(prim.GetPath())
    return found


def _notice_split_prototypes(stage: Any, groups: Sequence[_Group], warnings: list[Notice]) -> None:
    """A notice for each prototype whose instances are no longer alike."""
    known: dict[Any, list[Any]] = {group.prototype: [] for group in groups}
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        if prim.IsInstance() and prim.GetPrototype().GetPath() in known:
            known[prim.GetPrototype().GetPath()].append(prim.GetPath())
    for prototype, members in known.items():
        mine = [group for group in groups if group.prototype == prototype]
        kinds = len(mine) + (len(members) > sum(len(group.prims) for group in mine))
        if kinds > 1:
            shown = listed([f"<{path}>" for path in members])
            text = (
                f"Instances that were alike are edited in {kinds} ways, and share no prototype now: {shown}"
            )
            warnings.append(Notice("instances-apart", text))
