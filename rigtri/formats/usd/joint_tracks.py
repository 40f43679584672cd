"""Tracks for joints that an animation did not drive: columns behind its last.

An animation has one array for all its joints at each time, so a new track has the times of the
others. It is done as a split is done: first every array gets the columns, with what the joints
are at rest, and then the rig is written into them.

Source: UsdSkel, SkelAnimation (`joints`, and arrays of as many items).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from rigtri.errors import FileError
from rigtri.formats import Options
from rigtri.formats.usd import layers
from rigtri.formats.usd.animations import PROPERTIES, Animation, Property
from rigtri.formats.usd.reader import Source, read_source
from rigtri.formats.usd.splits import aligned_clip
from rigtri.formats.usd.stage import why_instanced
from rigtri.formats.usd.values import Edit, kind, parts, set_value
from rigtri.rig import Rig
from rigtri.trigonometry import Floats

_TYPES = Sdf.ValueTypeNames


def driven(source: Source, rig: Rig, options: Options) -> tuple[Source, Rig, list[Edit]]:
    """The source with columns for the joints that ``rig`` has new tracks of, the rig with a track for
    each, and the edits.

    FileError where an animation cannot be edited.
    """
    wanted = _wanted(source, rig)
    if not wanted:
        return source, rig, []
    edits: list[Edit] = []
    for path, nodes in wanted.items():
        why = why_instanced(source.stage.GetPrimAtPath(path))
        if why:
            raise FileError(f"Keys cannot be added: {why}.")
        edits += _grow(source, source.animations[path], rig, nodes)
    opinions = layers.empty()
    layers.copy_clock(source.layer, opinions)
    with Sdf.ChangeBlock():
        for edit in edits:
            edit(opinions)
    wide = read_source(source.path, options, layers.over(opinions, source.layer))
    clips = [aligned_clip(old, new, rig) for old, new in zip(wide.rig.clips, rig.clips, strict=True)]
    return wide, replace(rig, clips=tuple(clips)), edits


def _wanted(source: Source, rig: Rig) -> dict[str, dict[str, int]]:
    """For each animation the tokens of joints that it is to drive from now on, with their nodes."""
    tokens = {
        source.rig.keys[node]: token
        for skin in source.rig.skins
        if kind(skin.key) == "skeleton"
        for node, token in zip(skin.joints.tolist(), source.skeletons[parts(skin.key)[1]].tokens, strict=True)
    }
    found: dict[str, dict[str, int]] = {}
    for clip in rig.clips:
        if kind(clip.key) not in ("samples", "default"):
            continue
        path = parts(clip.key)[1]
        for track in clip.tracks:
            token = tokens.get(rig.keys[track.node])
            if track.key is None and token is not None and token not in source.animations[path].tokens:
                found.setdefault(path, {}).setdefault(token, track.node)
    return found


def _grow(source: Source, animation: Animation, rig: Rig, nodes: Mapping[str, int]) -> Iterator[Edit]:
    """The joints and arrays of an animation with more at their ends."""
    tokens = Vt.TokenArray([*animation.tokens, *nodes])
    yield set_value(animation.path, "joints", _TYPES.TokenArray, tokens, uniform=True)
    rest = {"translations": rig.translation, "rotations": rig.rotation, "scales": rig.scale}
    for name in PROPERTIES:
        item = animation.properties.get(name)
        if item is not None:
            yield _widen(source, animation.path, name, item, rest[name][list(nodes.values())])


def _widen(source: Source, path: str, name: str, item: Property, values: Floats) -> Edit:
    """An array with more items at its end, the same at every time."""

    def wide(rows: np.ndarray) -> Any:
        more = np.concatenate([rows, values.astype(rows.dtype)])
        return item.kind.FromNumpy(np.ascontiguousarray(more))

    samples = {float(time): wide(rows) for time, rows in zip(item.times, item.samples, strict=True)}
    samples.update(dict.fromkeys(item.blocked))
    single = None if item.default is None else wide(item.default)
    type_name = source.stage.GetPrimAtPath(path).GetAttribute(name).GetTypeName()
    return set_value(path, name, type_name, single, samples=dict(sorted(samples.items())))
