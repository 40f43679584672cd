"""Confine keys to the variants that decide what they come from.

Keys of joints may follow controls, and keys of controls joints. Where variants of a shot hold takes of
either, keys of one take above them all would be seen in every take. So keys of joints go into the selected
variants that decide the controls. Controls are refused where variants decide what they would hold: their
rest lies above the variants, and hides what is within.

Source: OpenUSD glossary, LIVRPS (local opinions are stronger than those within variants).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from pxr import Sdf

from rigtri.errors import FileError
from rigtri.formats.usd.composition.variant_choices import VariantSet
from rigtri.formats.usd.composition.variants import (
    VALUES,
    deciding_sets,
    variants_of,
    why_decided,
)
from rigtri.formats.usd.opinions.edits import Edit, Setting
from rigtri.formats.usd.opinions.variant_paths import inside, own_place, refuse_shared, selected_names
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.animation_reader import array_paths
from rigtri.formats.usd.reading.node_keys import kind
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.report import Notice

# Names of what controls hold themselves.
_OWN = ("xformOp", "rigtri:")
# The sets that decide an attribute, by its path.
Decided = Mapping[Any, set[VariantSet]]


def confine_keys(edit: UsdEdit) -> None:
    """Route new keys into variants. FileError where these decide what keys or controls would replace."""
    rig, stage = edit.source.rig, edit.source.stage
    own = {Sdf.Path(rig.labels[node]) for node in rig.own if kind(rig.keys[node]) == "prim"}
    # What other variants have is not there either, but gets values alone.
    new = (value.prim for value in edit.opinions if not isinstance(value, Setting))
    made = {path for path in new if not stage.GetPrimAtPath(path)}
    held = own | made
    tops = [path for path in held if held.isdisjoint(path.GetPrefixes()[:-1])]
    confined: set[str] = set()
    for skeleton in edit.source.skeletons.values() if edit.opinions else ():
        mine = [top for top in tops if Sdf.Path(skeleton.path).HasPrefix(top.GetParentPath())]
        known = [str(top) for top in mine if top in own]
        decided = deciding_sets(stage, skeleton.path, [*skeleton.animations, *known]) if mine else {}
        if decided and _confine(edit, skeleton, decided, mine, made):
            confined.add(skeleton.path)
    for variants in edit.retimed:
        if variants.skeleton not in confined and variants.animation not in edit.extended:
            variants.refuse_dependent(array_paths(variants.animation), "Keys cannot be changed")
    _confine_props(edit)


def _confine(
    edit: UsdEdit, skeleton: Skeleton, decided: Decided, tops: Sequence[Any], made: Collection[Any]
) -> bool:
    """Route the keys of one skeleton; whether they are within variants now. tops: its topmost controls."""
    path, animations = Sdf.Path(skeleton.path), {Sdf.Path(each) for each in skeleton.animations}
    reshaped = any(value.prim == path for value in edit.opinions)
    about = [value for value in edit.opinions if any(value.prim.HasPrefix(top) for top in tops)]
    _refuse_controls(edit.source.stage, about, path, decided, made, reshaped=reshaped)
    followed = {at: sets for at, sets in decided.items() if any(at.HasPrefix(top) for top in tops)}
    if not followed or reshaped or not any(value.prim in animations for value in edit.opinions):
        return False
    sets = set[VariantSet]().union(*followed.values())
    read = {(each.skeleton, each.animation): each for each in edit.retimed}
    for now in variants_of(edit.source.stage, skeleton.path, skeleton.animations):
        variants = read.get((now.skeleton, now.animation), now)
        animation = Sdf.Path(variants.animation)
        if any(not animation.HasPrefix(prim) for prim, _ in sets):
            raise FileError(f"Keys cannot be set in <{animation}>: {_why(edit.source.stage, followed)}")
        edit.prepared = [inside(each, animation, sets, variants) for each in edit.prepared]
        edit.opinions = [inside(each, animation, sets, variants) for each in edit.opinions]
    text = (
        f"Keys of <{skeleton.path}> are written in the variant {selected_names(variants, sets)} "
        "alone, for it decides what controls do. To bake another variant, select it and run again"
    )
    edit.notices.append(Notice("variant-keys", text))
    return True


def _why(stage: Any, decided: Decided) -> str:
    first = min(decided)
    return why_decided(first, decided[first], stage)


def _refuse_controls(
    stage: Any,
    about: Iterable[Edit],
    skeleton: Any,
    decided: Decided,
    made: Collection[Any],
    *,
    reshaped: bool,
) -> None:
    """FileError where edits of controls would replace, or come from, what variants decide."""
    rests = {at: s for at, s in decided.items() if at.GetPrimPath() == skeleton and at.name in VALUES}
    motion = {at: s for at, s in decided.items() if at not in rests and not at.name.startswith(_OWN)}
    for value in about:
        if isinstance(value, Setting) and value.path in decided:
            why = why_decided(value.path, decided[value.path], stage)
            raise FileError(f"<{value.prim}> cannot be changed: {why}")
        placed = value.prim in made or (isinstance(value, Setting) and value.name.startswith("xformOp"))
        if rests and placed:
            new = "The new prim " if value.prim in made else ""
            raise FileError(f"{new}<{value.prim}> cannot be placed: {_why(stage, rests)}")
        if motion and not reshaped and isinstance(value, Setting) and value.samples:
            raise FileError(f"<{value.prim}> cannot get keys: {_why(stage, motion)}")


def _confine_props(edit: UsdEdit) -> None:
    """Route the keys of prims that are not rigtri's into the variants that alone have these."""
    stage = edit.source.stage
    keyed = {Sdf.Path(edit.rig.labels[track.node]) for track in edit.changes.prim_tracks}
    prims = {path: stage.GetPrimAtPath(path) for path in keyed}
    places = {path: own_place(prim) for path, prim in prims.items()}
    places = {path: place for path, place in places.items() if place != path}

    def moved(value: Edit) -> Edit:
        if value.prim not in places or not isinstance(value, Setting):
            return value
        refuse_shared(stage, value)
        return replace(value.at(places[value.prim]), prim=value.prim)

    edit.opinions = [moved(value) for value in edit.opinions] if places else edit.opinions
    for path in sorted(places):
        text = (
            f"Keys of <{path}> are written in the variant <{places[path]}> alone, which has it. To bake "
            "another variant, select it and run again"
        )
        edit.notices.append(Notice("variant-keys", text))
