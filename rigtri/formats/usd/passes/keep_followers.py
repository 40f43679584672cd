"""Keep prims as they are that are composed from edited ones, and are not edited themselves."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any

from pxr import Sdf, Usd

from rigtri.formats.usd.composition.layers import listed_items
from rigtri.formats.usd.composition.stage import DEFAULT, refuse
from rigtri.formats.usd.composition.time_samples import Samples, time_samples
from rigtri.formats.usd.composition.value_types import BIND
from rigtri.formats.usd.opinions.edits import Setting, set_value
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.metadata_attributes import PREFIX

# What means something where nothing is said: an empty value says the same.
_UNSAID = ("xformOpOrder", BIND)
_ARCS = ("references", "payload", "inheritPaths", "specializes")
_HAS_ARCS = (
    Usd.Prim.HasAuthoredReferences,
    Usd.Prim.HasAuthoredPayloads,
    Usd.Prim.HasAuthoredInherits,
    Usd.Prim.HasAuthoredSpecializes,
)


def keep_followers(edit: UsdEdit) -> None:
    """Let prims hold what they held that an internal arc (``references = </Hero>``) brings from edited ones.

    They would follow in part: what they have of their own, such as another animation, would not.
    """
    edited = {value.path: value for value in edit.values if isinstance(value, Setting)}
    names: dict[Any, list[str]] = {}
    for value in edited.values():
        names.setdefault(value.prim, []).append(value.name)
    above = {prefix for path in names for prefix in path.GetPrefixes()}
    if not edited or not any(_refers_to(prim, above) for prim in edit.source.stage.Traverse()):
        return
    # Values alone follow, and what goes is not in the layer of a preview.
    after, shown = edit.preview(list(edited.values())), set()
    for prim in Usd.PrimRange.Stage(after, Usd.TraverseInstanceProxies()):
        if prim.IsInstanceProxy():  # what the first of several instances holds, all do
            if prim.GetPrimInPrototype() in shown:
                continue
            shown.add(prim.GetPrimInPrototype())
        sources = {spec.path for spec in prim.GetPrimStack()} & names.keys() - {prim.GetPath()}
        for name in dict.fromkeys(name for path in sorted(sources) for name in names[path]):
            path = prim.GetPath().AppendProperty(name)
            if path not in edited and not name.startswith(PREFIX):
                edit.values += _held(edit, path, after.GetAttributeAtPath(path))


def _refers_to(prim: Any, edited: Collection[Any]) -> bool:
    """Whether an arc of a prim may bring it something of edited ones. edited: they, and all above them."""
    layers = prim.GetStage().GetLayerStack()
    for spec in prim.GetPrimStack() if any(has(prim) for has in _HAS_ARCS) else ():
        for arc in _ARCS if spec.layer in layers else _ARCS[2:]:  # what is inherited, layers above may change
            items = (item for item in listed_items(spec, arc) if not getattr(item, "assetPath", ""))
            targets = [getattr(item, "primPath", item) for item in items]
            if any(spec.layer not in layers or target.isEmpty or target in edited for target in targets):
                return True
    return False


def _held(edit: UsdEdit, path: Any, now: Any) -> Iterator[Setting]:
    """The values that an attribute has, where edits of another prim would change them."""
    was = edit.source.stage.GetAttributeAtPath(path)
    before = _values(was) if was else (None, [])
    value, samples = before
    nothing = value is None and not samples
    if not was or before == _values(now) or (nothing and path.name not in _UNSAID):
        return
    skeleton = edit.source.skeletons.get(str(path.GetPrimPath()))
    refuse(skeleton.locked if skeleton else "")
    uniform = was.GetVariability() == Sdf.VariabilityUniform
    value = type(now.Get(DEFAULT))() if nothing else value
    kind = was.GetTypeName()
    yield set_value(path.GetPrimPath(), path.name, kind, value, samples=dict(samples), uniform=uniform)


def _values(attribute: Any) -> tuple[Any, Samples]:
    return attribute.Get(DEFAULT), time_samples(attribute)
