"""SkelAnimations as clips of a Skeleton, whether it plays them or not."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Set
from typing import Any

from pxr import Sdf

from rigtri.errors import FileError
from rigtri.formats.usd.composition.animation_binding import SOURCE
from rigtri.formats.usd.composition.variants import SkeletonVariants, deciding_sets
from rigtri.formats.usd.reading.animation_reader import clips, interpolation_of, read_animation
from rigtri.formats.usd.reading.mesh_reader import blend_tracks
from rigtri.formats.usd.reading.source import Source
from rigtri.model.animation import Track


def owners(stage: Any, animation: str, tokens: Iterable[str], skeletons: Mapping[str, Set[str]]) -> list[str]:
    """The Skeletons whose joints an animation lists that nothing plays: all that are equally near to it.

    skeletons: their joints. None where variants have a say in it: it is edited with the Skeleton of those.
    """
    listed = set(tokens)
    fits = [path for path, known in skeletons.items() if listed <= known or listed >= known]
    found = nearest(animation, fits) if listed else []
    return [] if any(_decided(stage, path, animation) for path in found) else found


def nearest(animation: str, skeletons: Iterable[str]) -> list[str]:
    """Those of some Skeletons that share the most of their paths with an animation."""
    near = {path: Sdf.Path(path).GetCommonPrefix(animation).pathElementCount for path in skeletons}
    most = max(near.values(), default=0)
    return [path for path, shared in near.items() if shared == most]


def _decided(stage: Any, skeleton: str, animation: str) -> bool:
    """Whether another variant binds an animation, or gives it other values."""
    if any(path.GetPrimPath() == animation for path in deciding_sets(stage, skeleton, [animation])):
        return True
    try:
        states = SkeletonVariants(stage, skeleton, animation).states
    except FileError:  # too many to look through: an edit says so
        return True
    bound = Sdf.Path(skeleton).AppendProperty(SOURCE)
    return any(animation in state.shown.get(bound, ()) for state in states)


def tracks_of(source: Source, animation: str, skeleton: str) -> tuple[Track, ...]:
    """What a SkelAnimation, by its path, makes of a Skeleton when it plays; nothing where it cannot.

    Times are in time codes.
    """
    prim = source.stage.GetPrimAtPath(animation)
    found = read_animation(prim, []) if prim else None
    if found is None:
        return ()
    nodes = {token: node for node, (path, token) in source.joints.items() if path == skeleton}
    interpolation = interpolation_of(source.stage)
    weights: list[Track] = []
    if prim.GetAttribute("blendShapeWeights").HasAuthoredValue():
        places = {label: node for node, label in enumerate(source.rig.labels)}
        weights = blend_tracks(prim, source.bindings.of({skeleton}), places, interpolation)
    every = clips(found, found.name, [nodes], weights, interpolation)
    return tuple(track for clip in every[:1] for track in clip.tracks)
