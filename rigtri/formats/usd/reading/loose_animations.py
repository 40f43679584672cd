"""SkelAnimations as clips of a Skeleton, whether it plays them or not."""

from __future__ import annotations

from rigtri.formats.usd.reading.animation_reader import clips, interpolation_of, read_animation
from rigtri.formats.usd.reading.mesh_reader import blend_tracks
from rigtri.formats.usd.reading.source import Source
from rigtri.model.animation import Track


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
