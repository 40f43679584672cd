"""Drop the columns of removed joints from animations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from rigtri.formats.usd.composition.stage import refuse, why_instanced
from rigtri.formats.usd.opinions.animation_edits import set_array
from rigtri.formats.usd.opinions.edits import Edit, set_tokens
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.animation_reader import PROPERTIES, Animation
from rigtri.formats.usd.reading.node_keys import kind
from rigtri.maths.arrays import Booleans
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig


def drop_columns(edit: UsdEdit) -> None:
    """Give the rig the tracks of removed joints again; the last edits take their columns out.

    The columns of joints that stay, of any skeleton, stay. FileError where an animation cannot be edited.
    """
    source, rig = edit.source, edit.rig
    if not rig.pending.removed:
        return
    stay: set[str] = set()
    gone: set[str] = set()
    for node, (skeleton, token) in source.joints.items():
        if skeleton not in source.animations:
            (gone if node in rig.pending.removed else stay).add(token)
    for path, animation in source.animations.items():
        keep = np.array([token in stay or token not in gone for token in animation.tokens], dtype=bool)
        if keep.all():
            continue
        refuse(why_instanced(source.stage.GetPrimAtPath(path)), "Keys cannot be removed")
        edit.removals += _kept_columns(animation, keep)
    clips = [
        new
        if all(track.node not in rig.pending.removed for track in old.tracks)
        else replace(new, tracks=tuple(_all_tracks(old, new, rig)))
        for old, new in zip(source.rig.clips, rig.clips, strict=True)
    ]
    edit.rig = replace(rig, clips=tuple(clips))


def _all_tracks(old: Clip, new: Clip, rig: Rig) -> Iterator[Track]:
    """The tracks of a clip with those of removed joints in their old places."""
    left = iter(new.tracks)
    for was in old.tracks:
        if was.node in rig.pending.removed and kind(rig.keys[was.node]) == "joint":
            yield was
        elif was.node not in rig.pending.removed:
            yield from islice(left, 1)
    yield from left


def _kept_columns(animation: Animation, keep: Booleans) -> Iterator[Edit]:
    """The joints and arrays of an animation with those columns alone that are kept."""
    tokens = [token for token, stays in zip(animation.tokens, keep, strict=True) if stays]
    yield set_tokens(animation.path, "joints", tokens)
    for name in PROPERTIES:
        if (item := animation.properties.get(name)) is not None:
            default = None if item.default is None else item.default[keep]
            kept = replace(item, samples=item.samples[:, keep], default=default)
            yield set_array(animation.path, name, kept)
