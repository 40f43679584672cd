"""Columns of joints that go, taken out of animations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import why_instanced
from rigtri.formats.usd.opinions.edits import Edit, kind, parts, set_value
from rigtri.formats.usd.reading.animation_reader import PROPERTIES, Animation, Property
from rigtri.formats.usd.reading.reader import Source
from rigtri.maths.arrays import Booleans
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig

_TYPES = Sdf.ValueTypeNames


def undriven(source: Source, rig: Rig) -> tuple[Rig, list[Edit]]:
    """The rig with the tracks of joints that go, and the edits that take those out of animations at last.

    What a joint that stays, of any skeleton, is driven by stays. FileError where an animation cannot
    be edited.
    """
    if not rig.pending.removed:
        return rig, []
    stay: set[str] = set()
    gone: set[str] = set()
    for skin in source.rig.skins:
        if kind(skin.key) == "skeleton":
            tokens = source.skeletons[parts(skin.key)[1]].tokens
            for node, token in zip(skin.joints.tolist(), tokens, strict=True):
                (gone if node in rig.pending.removed else stay).add(token)
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
        if all(track.node not in rig.pending.removed for track in old.tracks)
        else replace(new, tracks=tuple(_restored(old, new, rig)))
        for old, new in zip(source.rig.clips, rig.clips, strict=True)
    ]
    return replace(rig, clips=tuple(clips)), edits


def _restored(old: Clip, new: Clip, rig: Rig) -> Iterator[Track]:
    """The tracks of a clip with those of joints that go in their old places."""
    left = iter(new.tracks)
    for was in old.tracks:
        if was.node in rig.pending.removed and kind(rig.keys[was.node]) == "joint":
            yield was
        elif was.node not in rig.pending.removed:
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
