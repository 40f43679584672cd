"""The paths of prims within variants, where opinions are seen in these alone."""

from __future__ import annotations

from typing import Any

from pxr import Sdf

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.composition.variants import SkeletonVariants, VariantState, why_unselected
from rigtri.formats.usd.opinions.instance_edits import instance_of


def place_in_variants(attribute: Any, state: VariantState, variants: SkeletonVariants) -> Any:
    """The path of a prim within variants, where an opinion on an attribute (its path) is seen in a state.

    That of the opinion which is seen now, where the stage's own layers hold it in variants: of several sets
    that do, one hides the other.
    """
    prim, shown = attribute.GetPrimPath(), variants.stage.GetAttributeAtPath(attribute)
    for spec in shown.GetPropertyStack(DEFAULT)[:1] if shown else ():
        own, place = spec.layer in variants.source.GetLayerStack(), spec.path.GetPrimPath()
        within = place.StripAllVariantSelections() == prim and place.ContainsPrimVariantSelection()
        if own and within and instance_of(variants.source, prim) is None:
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
