"""SkelAnimations as clips of a Skeleton, whether it plays them or not, or where there is none."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from itertools import chain
from typing import Any

import numpy as np
from pxr import Sdf, Usd

from rigtri.errors import FileError
from rigtri.formats.usd.composition.animation_binding import SOURCE, named
from rigtri.formats.usd.composition.layers import listed_items
from rigtri.formats.usd.composition.shared_instances import SharedInstances
from rigtri.formats.usd.composition.stage import tokens_of, why_locked
from rigtri.formats.usd.composition.variant_choices import each_choice
from rigtri.formats.usd.composition.variants import VALUES, SkeletonVariants, deciding_sets, in_words
from rigtri.formats.usd.reading.animation_reader import (
    NOTHING,
    Animation,
    Property,
    clips,
    interpolation_of,
    read_animation,
)
from rigtri.formats.usd.reading.mesh_reader import blend_tracks
from rigtri.formats.usd.reading.skeleton_reader import Skeleton, joint_parents, nearest_listed
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.matrices import compose, multiply
from rigtri.maths.quaternions import unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track

_ARCS = ("references", "payload", "inheritPaths", "specializes")


def fitting(animation: str, tokens: Iterable[str], skeletons: Mapping[str, Set[str]]) -> list[str]:
    """The Skeletons whose joints an animation lists that nothing plays: all that are equally near to it.

    skeletons: their joints.
    """
    listed = set(tokens)
    fits = [path for path, known in skeletons.items() if listed <= known or listed >= known]
    return nearest(animation, fits) if listed else []


def nearest(animation: str, skeletons: Iterable[str]) -> list[str]:
    """Those of some Skeletons that share the most of their paths with an animation."""
    near = {path: Sdf.Path(path).GetCommonPrefix(animation).pathElementCount for path in skeletons}
    most = max(near.values(), default=0)
    return [path for path, shared in near.items() if shared == most]


def decided(stage: Any, skeleton: str, animation: str) -> bool:
    """Whether variants give an animation that nothing plays values of their own."""
    return bool(deciding_sets(stage, skeleton, [animation], lambda prim: prim.GetPath() == animation))


class BoundInVariants:
    """Which animations the variants of a stage bind to its Skeletons; each Skeleton is looked at once.

    Variants of an animation that a Skeleton does not play decide nothing about what it is bound to.
    """

    def __init__(self, stage: Any) -> None:
        self._stage = stage
        self._found: dict[str, frozenset[str] | None] = {}

    def has(self, skeleton: str, animation: str) -> bool:
        """Whether a variant binds an animation."""
        if skeleton not in self._found:
            self._found[skeleton] = self._bound_to(skeleton)
        found = self._found[skeleton]
        return found is None or animation in found

    def _bound_to(self, skeleton: str) -> frozenset[str] | None:
        variants = SkeletonVariants(self._stage, skeleton, "", explore=False)
        try:
            if variants.stage is not None:
                variants.find_states()
        except FileError:  # too many to look through: an edit says so
            return None
        bound = Sdf.Path(skeleton).AppendProperty(SOURCE)
        return frozenset(chain.from_iterable(state.shown.get(bound, ()) for state in variants.states))


def of_other_variants(
    stage: Any, instances: SharedInstances, known_paths: Set[str], joints: Mapping[str, Set[str]]
) -> dict[str, tuple[str, list[str]]]:
    """The animations of unselected variants that no Skeleton plays there: in which variants, in words, and
    the Skeletons that are there and have their joints.

    known_paths: those that need no look. joints: those of the Skeletons.
    """
    known: set[Any] = set()
    shown = []
    for prim in (prim for prim in instances.prims() if prim.HasVariantSets()):
        # Many references of one asset have the same variants.
        specs = {(spec.layer, spec.path) for spec in prim.GetPrimStack() if spec.variantSets}
        if not specs <= known and any(_may_animate(variant.primSpec) for variant in _variants(prim)):
            shown.append(str(prim.GetPath()))
        known |= specs
    skeletons = list(chain.from_iterable(instances.skeletons.values()))
    found: dict[str, tuple[str, list[str]]] = {}
    for chosen, trial in each_choice(stage, shown, _may_play) if shown else ():
        below = Usd.PrimRange.Stage(trial, Usd.TraverseInstanceProxies())
        kinds = [(prim.GetTypeName(), prim) for prim in below if chosen]
        players = [prim for kind, prim in kinds if kind == "Skeleton"]
        # Variants of an animation do not decide what skeletons beside it are bound to.
        players += [prim for prim in skeletons if not trial.GetPrimAtPath(prim.GetPath())]
        played = {str(named(prim)[1]) for prim in players}
        paths = [prim.GetPath() for kind, prim in kinds if kind == "SkelAnimation"]
        here = {
            str(path)
            for path in paths
            if _opinions(trial.GetPrimAtPath(path)) != _opinions(stage.GetPrimAtPath(path))
        }
        there = {path: known for path, known in joints.items() if trial.GetPrimAtPath(path)}
        for path in sorted(here - played - known_paths - found.keys()):
            tokens = tokens_of(trial.GetPrimAtPath(path), "joints")
            found[path] = (in_words(chosen), fitting(path, tokens, there))
    return found


def _variants(prim: Any, name: str = "", variant: str = "") -> Iterator[Any]:
    """The opinions of a prim in its variants, or in one."""
    for spec in prim.GetPrimStack():
        for found in spec.variantSets.values():
            if name in ("", found.name):
                yield from (one for one in found.variants.values() if variant in ("", one.name))


def _may_play(prim: Any, name: str, variant: str) -> bool:
    return any(_may_animate(one.primSpec) for one in _variants(prim, name, variant))


def _opinions(prim: Any) -> list[Any]:
    """Where the arrays of an animation come from."""
    return [(spec.layer, spec.path) for spec in (prim.GetPrimStack() if prim else ()) if _has_values(spec)]


def _has_values(spec: Any) -> bool:
    return any(name in spec.properties for name in VALUES)


def _may_animate(spec: Any) -> bool:
    """Whether there may be values of an animation in a prim: its own, or by a composition arc."""
    below = (one.primSpec for found in spec.variantSets.values() for one in found.variants.values())
    return (
        _has_values(spec)
        or any(listed_items(spec, arc) for arc in _ARCS)
        or any(map(_may_animate, (*spec.nameChildren, *below)))
    )


def tracks_of(source: Source, animation: str, skeleton: str) -> tuple[Track, ...]:
    """What a SkelAnimation, by its path, makes of a Skeleton when it plays; nothing where it cannot.

    Times are in time codes.
    """
    prim = source.stage.GetPrimAtPath(animation)
    found = read_animation(prim, []) if prim else None
    if found is None:
        return ()
    interpolation = interpolation_of(source.stage)
    weights: list[Track] = []
    if prim.GetAttribute("blendShapeWeights").HasAuthoredValue():
        weights = blend_tracks(prim, source.bindings.of([skeleton]), source.labelled, interpolation)
    every = clips(found, found.name, [source.joint_nodes.get(skeleton, {})], weights, interpolation)
    return tuple(track for clip in every[:1] for track in clip.tracks)


def stand_in(prim: Any, animation: Animation, world: Floats) -> Skeleton:
    """The joints of an animation, by the hierarchy in their paths, as it poses them first below ``world``."""
    order = _parents_first(animation.tokens)
    tokens = tuple(animation.tokens[k] for k in order)
    parents = joint_parents(animation.path, tokens)
    parts = {name: _first_row(animation.properties.get(name), name, order) for name in NOTHING}
    rest = compose(parts["translations"], unit(parts["rotations"]), parts["scales"])
    bind = rest.copy()
    for joint, parent in enumerate(parents.tolist()):
        bind[joint] = multiply(rest[joint], bind[parent] if parent >= 0 else world)
    locked = why_locked(prim, ("joints", *NOTHING))
    for name in ("translations", "rotations"):
        if name not in animation.properties:
            locked = locked or f"animation <{animation.path}> has no {name}, and no skeleton gives them"
    return Skeleton(animation.path, tokens, parents, bind, rest, False, locked, (animation.path,))


def _parents_first(tokens: Sequence[str]) -> list[int]:
    """The joints in their own order, but none before its parent: animations may list them in any order."""
    above, order = nearest_listed(tokens).tolist(), dict[int, None]()
    for joint in range(len(tokens)):
        line = []
        while joint >= 0 and joint not in order:
            line.append(joint)
            joint = above[joint]
        order.update(dict.fromkeys(reversed(line)))
    return list(order)


def _first_row(item: Property | None, name: str, order: list[int]) -> Floats:
    if item is None:
        return np.broadcast_to(NOTHING[name], (len(order), len(NOTHING[name])))
    row = item.samples[0] if len(item.times) else item.default
    return np.asarray(row, dtype=np.float64)[order]
