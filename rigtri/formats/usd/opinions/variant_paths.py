"""The paths of prims within variants, where opinions are seen in these alone."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from pxr import Sdf

from rigtri.errors import FileError
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.stage import DEFAULT, tokens_of, why_locked
from rigtri.formats.usd.composition.variant_choices import VariantSet
from rigtri.formats.usd.composition.variants import SkeletonVariants, VariantState, why_unselected
from rigtri.formats.usd.opinions.edits import Edit, Setting
from rigtri.formats.usd.opinions.instance_edits import instance_of
from rigtri.formats.usd.reading.animation_reader import array_paths
from rigtri.formats.usd.reading.xform_hierarchy import OPS
from rigtri.report import Notice


def place_in_variants(attribute: Any, state: VariantState, variants: SkeletonVariants) -> Any:
    """The path of a prim within variants, where an opinion on an attribute (its path) is seen in a state.

    That of the opinion which is seen now, where the stage's own layers hold it in variants: of several sets
    that do, one hides the other.
    """
    prim, shown = attribute.GetPrimPath(), variants.stage.GetAttributeAtPath(attribute)
    for spec in shown.GetPropertyStack(DEFAULT)[:1] if shown else ():
        own, place = spec.layer in variants.source.GetLayerStack(), spec.path.GetPrimPath()
        if own and _is_within(place, prim) and instance_of(variants.source, prim) is None:
            return place
    return inside_variants(prim, variants.depends.get(attribute, set()), state, variants)


def inside_variants(prim: Any, sets: set[Any], state: VariantState, variants: SkeletonVariants) -> Any:
    """The path of a prim within the variants that its values depend on: ``/Hero{clip=walk}Anim``."""
    path, held = Sdf.Path.absoluteRootPath, instance_of(variants.source, prim)
    for above in prim.GetPrefixes():
        path = path.AppendChild(above.name)
        shown = variants.stage.GetPrimAtPath(above)
        for name in shown.GetVariantSets().GetNames() if shown else ():
            if (above, name) in sets:
                path = _brought_within(path, shown, name)
                if (above, name) in _selections(path):
                    continue
                variant = state.selected[above, name]
                if not variant:
                    raise FileError(
                        f"{why_unselected(prim, above, name)}. Select one in a layer above, or remove "
                        "the variant set."
                    )
                path = path.AppendVariantSelection(name, variant)
                if held is not None and not above.HasPrefix(held.GetPath()):
                    raise FileError(
                        f"<{prim}> lies in the instance <{held.GetPath()}>, which is another one in each "
                        f"variant of '{name}' on <{above}> ({variants.place_of(state, prim)}). Give each "
                        "variant a file of its own."
                    )
    return path


def _brought_within(path: Any, prim: Any, name: str) -> Any:
    """A path of a prim, within those variants of the stage's own layers that bring its variant set ``name``.

    They hold the set, or the arc to where it is. Beside them the set would be weaker than what they bring.
    """
    root = prim.GetPrimIndex().rootNode
    if root.path != prim.GetPath():  # of an instance: the variants are those of its class
        return path
    node = next((node for node in _strongest_first(root) if name in _sets_at(node)), root)
    while node.layerStack != root.layerStack or node.path.StripAllVariantSelections() != root.path:
        node = node.parent
    return node.path if _selections(path) <= _selections(node.path) else path


def _strongest_first(node: Any) -> Iterator[Any]:
    yield node
    for child in node.children:
        yield from _strongest_first(child)


def _sets_at(node: Any) -> set[str]:
    """The variant sets that the layers of a node list there."""
    specs = (layer.GetPrimAtPath(node.path) for layer in node.layerStack.layers)
    return {found.name for spec in specs if spec for found in spec.variantSets.values()}


def _selections(path: Any) -> set[VariantSet]:
    """The variant sets of which a path selects a variant."""
    steps = (each for each in path.GetPrefixes() if each.IsPrimVariantSelectionPath())
    return {(each.StripAllVariantSelections(), each.GetVariantSelection()[0]) for each in steps}


def keys_of_new_joints(variants: SkeletonVariants, edits: Sequence[Edit]) -> tuple[list[Edit], list[Notice]]:
    """The edits of an animation that gets new joints, in the variants that decide its arrays; notices."""
    animation = Sdf.Path(variants.animation)
    sets = set[VariantSet]().union(*(variants.depends.get(path, ()) for path in array_paths(animation)))
    if not sets:
        return list(edits), []
    selected = selected_names(variants, sets)
    text = (
        f"Keys of new joints of <{variants.skeleton}> are written in the variant {selected} "
        f"alone, for it decides what <{animation}> holds. In others these joints stay at rest"
    )
    return [inside(each, animation, sets, variants) for each in edits], [Notice("variant-keys", text)]


def inside(value: Edit, animation: Any, sets: set[VariantSet], variants: SkeletonVariants) -> Edit:
    """An edit of an animation within variants, and any other as it is."""
    if value.prim != animation:
        return value
    if not isinstance(value, Setting):
        raise FileError(
            f"<{animation}> would be new in every variant. Bind an animation to <{variants.skeleton}> first "
            "(skel:animationSource), or give each variant a file of its own."
        )
    refuse_shared(variants.source, value)
    every = sets | variants.depends.get(value.path, set())
    return replace(value.at(inside_variants(animation, every, variants.states[0], variants)), prim=animation)


def refuse_shared(stage: Any, value: Setting) -> None:
    """FileError where an opinion that all variants share would hide that of one."""
    for spec in shared_opinions(stage, value.path):
        raise FileError(
            f"<{value.path}> of {layers.title(spec.layer)} lies outside of the variants, and hides keys in "
            "one. Give each variant a file of its own, or put a shot above the file and the variants there."
        )


def selected_names(variants: SkeletonVariants, sets: Iterable[VariantSet]) -> str:
    """The variants that are selected in some sets, in words."""
    selected = variants.states[0].selected
    return " and ".join(f"'{selected[s]}' of the variant set '{s[1]}' on <{s[0]}>" for s in sorted(sets))


def own_place(prim: Any) -> Any:
    """The path of a prim within the variants of the stage's own layers that alone hold it, or its ops.

    Its own path where no such variant does.
    """
    path, own = prim.GetPath(), prim.GetStage().GetLayerStack()
    if instance_of(prim.GetStage(), path) is not None:
        return path
    for name in _op_names(prim):
        attribute = prim.GetAttribute(name)
        for spec in attribute.GetPropertyStack(DEFAULT)[:1] if attribute else ():
            if spec.layer in own and _is_within(spec.path.GetPrimPath(), path):
                return spec.path.GetPrimPath()
    places = [spec.path for spec in prim.GetPrimStack() if spec.layer in own]
    return next((place for place in places if _is_within(place, path)), path) if path not in places else path


def why_unkeyable(prim: Any) -> str:
    """Why a prim cannot get keys: a variant of another file holds its ops; "" where it can."""
    return why_locked(prim, _op_names(prim)) if own_place(prim) == prim.GetPath() else ""


def _op_names(prim: Any) -> tuple[str, ...]:
    """The attributes by which a prim moves, or would."""
    ops = (name for name in tokens_of(prim, "xformOpOrder") if name.startswith("xformOp:"))
    return ("xformOpOrder", *ops, *OPS.values())


def _is_within(place: Any, path: Any) -> bool:
    return bool(place.ContainsPrimVariantSelection() and place.StripAllVariantSelections() == path)


def shared_opinions(stage: Any, path: Any) -> Iterator[Any]:
    """The opinions of the files of the stage itself on an attribute that no variant holds."""
    layers = [layer for layer in stage.GetLayerStack(includeSessionLayers=False) if layer.realPath]
    attribute = stage.GetAttributeAtPath(path)
    for spec in attribute.GetPropertyStack(DEFAULT) if attribute else ():
        if spec.layer in layers and spec.path == path:
            yield spec
