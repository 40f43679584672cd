"""Tracks for joints that an animation did not drive: columns behind its last.

An animation has one array for all its joints at each time, so a new track has the times of the
others. It is done as a split is done: first every array gets the columns, with what the joints
are at rest, and then the rig is written into them.

Source: UsdSkel, SkelAnimation (`joints`, and arrays of as many items).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import islice
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
from rigtri.records import Booleans, Clip, Track
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


def undriven(source: Source, rig: Rig) -> tuple[Rig, list[Edit]]:
    """The rig with the tracks of joints that go, and the edits that take those out of animations at last.

    What a joint that stays, of any skeleton, is driven by stays. FileError where an animation cannot
    be edited.
    """
    if not rig.removed:
        return rig, []
    stay: set[str] = set()
    gone: set[str] = set()
    for skin in source.rig.skins:
        if kind(skin.key) == "skeleton":
            tokens = source.skeletons[parts(skin.key)[1]].tokens
            for node, token in zip(skin.joints.tolist(), tokens, strict=True):
                (gone if node in rig.removed else stay).add(token)
    edits: list[Edit] = []
    for path, animation in source.animations.items():
        keep = np.array([token in stay or token not in gone for token in animation.tokens], dtype=bool)
        if keep.all():
            continue
        why = why_instanced(source.stage.GetPrimAtPath(path))
        if why:
            raise FileError(f"Keys cannot be taken out: {why}.")
        edits += _narrow(source, animation, keep)
    clips = [
        new
        if all(track.node not in rig.removed for track in old.tracks)
        else replace(new, tracks=tuple(_restored(old, new, rig)))
        for old, new in zip(source.rig.clips, rig.clips, strict=True)
    ]
    return replace(rig, clips=tuple(clips)), edits


def _restored(old: Clip, new: Clip, rig: Rig) -> Iterator[Track]:
    """The tracks of a clip with those of joints that go in their old places."""
    left = iter(new.tracks)
    for was in old.tracks:
        if was.node in rig.removed and kind(rig.keys[was.node]) == "joint":
            yield was
        elif was.node not in rig.removed:
            yield from islice(left, 1)
    yield from left


def _narrow(source: Source, animation: Animation, keep: Booleans) -> Iterator[Edit]:
    """The joints and arrays of an animation with those columns alone that are kept."""
    tokens = [token for token, stays in zip(animation.tokens, keep, strict=True) if stays]
    yield set_value(animation.path, "joints", _TYPES.TokenArray, Vt.TokenArray(tokens), uniform=True)
    for name in PROPERTIES:
        item = animation.properties.get(name)
        if item is None:
            continue

        def narrow(rows: np.ndarray, item: Property = item) -> Any:
            return item.kind.FromNumpy(np.ascontiguousarray(rows[keep]))

        samples = {float(time): narrow(rows) for time, rows in zip(item.times, item.samples, strict=True)}
        samples.update(dict.fromkeys(item.blocked))
        single = None if item.default is None else narrow(item.default)
        type_name = source.stage.GetPrimAtPath(animation.path).GetAttribute(name).GetTypeName()
        yield set_value(animation.path, name, type_name, single, samples=dict(sorted(samples.items())))


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
