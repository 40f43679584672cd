"""Take rows and columns of joints that go out of arrays, last of all: each pass before saw all of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from pxr import Sdf

from rigtri.formats.usd.opinions.edits import Edit, Setting, remove_properties, set_tokens
from rigtri.formats.usd.opinions.skeleton_edits import (
    REST_ADDED,
    joint_names,
    joint_primvars,
    set_array,
    set_joints,
)
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.animation_reader import PROPERTIES, Animation
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.arrays import Booleans

REST = "restTransforms"
JOINT_ARRAYS = ("bindTransforms", REST)


def drop_joints(edit: UsdEdit) -> None:
    """Take rows and columns of joints that go out of what other passes have set, or of what was there."""
    settings = {value.path: value for value in edit.opinions if isinstance(value, Setting)}
    for path, keep in edit.staying.items():
        rows, source = np.flatnonzero(keep).tolist(), edit.source
        names = (*JOINT_ARRAYS, *PROPERTIES)
        own = [settings[at] for name in names if (at := Sdf.Path(path).AppendProperty(name)) in settings]
        if (animation := source.animations.get(path)) is not None:
            edit.removals += _kept_columns(animation, keep)
        if (skeleton := source.skeletons.get(path)) is not None and animation is None:
            edit.removals += _without_rows(source, skeleton, keep, rests=any(s.name == REST for s in own))
        edit.removals += [setting.picked(rows) for setting in own]


def _without_rows(source: Source, skeleton: Skeleton, keep: Booleans, *, rests: bool) -> Iterator[Edit]:
    """rests: whether joints that stay get another rest pose."""
    path, rows = skeleton.path, np.flatnonzero(keep).tolist()
    added = source.stage.GetPrimAtPath(path).GetAttribute(REST).GetCustomDataByKey(REST_ADDED) and not rests
    rest = skeleton.rest[rows] if skeleton.has_rest and not added else None
    names = joint_names(source.stage, skeleton)
    names = None if names is None else [names[k] for k in rows]
    yield from set_joints(path, [skeleton.tokens[k] for k in rows], skeleton.bind[rows], rest, names)
    yield from joint_primvars(source.stage, skeleton, rows)
    if skeleton.has_rest and added:
        yield remove_properties(path, REST)


def _kept_columns(animation: Animation, keep: Booleans) -> Iterator[Edit]:
    """The joints and arrays of an animation with those columns alone that are kept."""
    tokens = [token for token, stays in zip(animation.tokens, keep, strict=True) if stays]
    yield set_tokens(animation.path, "joints", tokens)
    for name in PROPERTIES:
        if (item := animation.properties.get(name)) is not None:
            default = None if item.default is None else item.default[keep]
            kept = replace(item, samples=item.samples[:, keep], default=default)
            yield set_array(animation.path, name, kept)
