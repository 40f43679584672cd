"""Edits of Skeleton and SkelAnimation prims: lists and arrays with an item for each joint, at once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from pxr import Sdf, UsdGeom

from rigtri.errors import FileError
from rigtri.evaluation.timelines import without_steps
from rigtri.formats.usd.composition.animation_binding import SOURCE
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.composition.variants import SkeletonVariants, variants_of
from rigtri.formats.usd.opinions.edits import Edit, Setting, define, set_matrices, set_tokens, set_value
from rigtri.formats.usd.reading.animation_reader import Property, array_paths
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path, Track

_LISTS = ("joints", "bindTransforms", "restTransforms", "jointNames")
# In customData of restTransforms: rigtri added them, together with a joint.
REST_ADDED = "rigtri:added"


def set_joints(
    path: Any, tokens: Sequence[str], bind: Floats, rest: Floats | None, names: Sequence[str] | None = None
) -> Iterator[Edit]:
    """Set the joints of a skeleton. bind, rest: (n, 4, 4); without ``rest`` or ``names`` these stay."""
    yield set_tokens(path, "joints", tokens)
    yield set_matrices(path, "bindTransforms", bind)
    if rest is not None:
        yield set_matrices(path, "restTransforms", rest)
    if names is not None:
        yield set_tokens(path, "jointNames", names)


def joint_names(stage: Any, skeleton: Skeleton) -> list[str] | None:
    """The ``jointNames`` of a skeleton; None where it has not one for each joint."""
    prim = stage.GetPrimAtPath(skeleton.path)
    names = prim.GetAttribute("jointNames").Get() if prim.HasAttribute("jointNames") else None
    return [str(name) for name in names] if names and len(names) == len(skeleton.tokens) else None


def joint_primvars(stage: Any, skeleton: Skeleton, rows: Sequence[int]) -> Iterator[Edit]:
    """Primvars that have a value for each joint, for other joints: from which row each gets its value.

    Such are the bone lengths of Blender's exporter: its importer drops bones for which there are too few.
    """
    for primvar in UsdGeom.PrimvarsAPI(stage.GetPrimAtPath(skeleton.path)).GetPrimvarsWithAuthoredValues():
        attribute = primvar.GetAttr()
        value = None if primvar.GetInterpolation() == UsdGeom.Tokens.constant else attribute.Get()
        if value is None or primvar.IsIndexed() or len(value) != len(skeleton.tokens):
            continue
        uniform = attribute.GetVariability() == Sdf.VariabilityUniform
        picked = type(value)([value[row] for row in rows])
        yield set_value(skeleton.path, attribute.GetName(), attribute.GetTypeName(), picked, uniform=uniform)


def check_joints_editable(stage: Any, skeleton: Skeleton, change: str) -> None:
    """FileError where the joints of a skeleton cannot be edited; change: ``added`` or ``removed``."""
    own = [Sdf.Path(skeleton.path).AppendProperty(name) for name in _LISTS]
    for variants in variants_of(stage, skeleton.path, skeleton.varied):
        variants.refuse_dependent(own, f"A joint cannot be {change}")


def check_motion_editable(stage: Any, skeleton: Skeleton, change: str) -> None:
    """FileError where variants decide what moves the joints of a skeleton; change: what cannot be done."""
    for variants in variants_of(stage, skeleton.path, skeleton.animations):
        source = Sdf.Path(skeleton.path).AppendProperty(SOURCE)
        variants.refuse_dependent([source, *array_paths(variants.animation)], change)


def bound_in(variants: SkeletonVariants) -> set[str]:
    """The animations that variants bind to their Skeleton, where they are on the stage as it is."""
    bound = Sdf.Path(variants.skeleton).AppendProperty(SOURCE)
    targets = {target for state in variants.states for target in state.shown.get(bound, ())}
    return {target for target in targets if variants.source.GetPrimAtPath(target)}


def is_decided(stage: Any, skeletons: Iterable[str], animation: str) -> bool:
    """Whether variants decide what an animation of some Skeletons lists or holds."""
    arrays = {*array_paths(animation)}
    return any(
        arrays & variants.depends.keys()
        for path in skeletons
        for variants in variants_of(stage, path, [animation])
    )


def copy_animation(stage: Any, animation: str, number: int) -> tuple[str, list[Edit]]:
    """A copy of an animation beside it, with all that is composed on it: its path, and what makes it."""
    prim = stage.GetPrimAtPath(animation)
    parent, name = prim.GetPath().GetParentPath(), f"{prim.GetName()}_{number}"
    while stage.GetPrimAtPath(parent.AppendChild(name)):
        name += "_"
    path = parent.AppendChild(name)
    copies = [
        set_value(
            path,
            attribute.GetName(),
            attribute.GetTypeName(),
            attribute.Get(),
            samples=dict(time_samples(attribute)),
            uniform=attribute.GetVariability() == Sdf.VariabilityUniform,
            custom=attribute.IsCustom(),
        )
        for attribute in prim.GetAuthoredAttributes()
    ]
    return str(path), [define(path, prim.GetTypeName()), *copies]


def set_array(path: Any, name: str, item: Property, *, only: bool = False) -> Setting:
    """Set an array of an animation, complete: samples, blocked samples and default.

    A stronger sample hides all weaker ones, so none may be left out. only: erase other samples of the layer.
    """
    each = np.ascontiguousarray(item.samples)  # at once: a clip has ten thousands
    samples = {time: item.kind.FromNumpy(rows) for time, rows in zip(item.times.tolist(), each, strict=True)}
    samples.update(dict.fromkeys(item.blocked))
    default = None if item.default is None else item.kind.FromNumpy(np.ascontiguousarray(item.default))
    return set_value(path, name, item.type_name, default, samples=dict(sorted(samples.items())), alone=only)


def check_no_spline(track: Track, title: str) -> None:
    """FileError for a track that samples cannot hold; title: what it moves."""
    if track.interpolation == "CUBICSPLINE" and len(track.times) > 1:
        raise FileError(f"{title} moves by splines, which USD has none of. Give it linear keys.")


def as_samples(track: Track, title: str) -> Track:
    """A track as samples hold it, without steps; FileError for splines."""
    check_no_spline(track, title)
    return without_steps(track)


def as_one(tracks: Iterable[Track], title: str) -> dict[Path, Track]:
    """What moves a prim, as samples hold it, by path: a stage has one time, whatever instances play.

    FileError where the animations of instances of one character would each move it otherwise.
    """
    found: dict[Path, Track] = {}
    for track in (as_samples(each, title) for each in tracks):
        known = found.setdefault(track.path, track)
        if not (np.array_equal(known.times, track.times) and np.array_equal(known.values, track.values)):
            raise FileError(
                f"{title} follows a character whose instances play several animations: it would move "
                "otherwise with each, and a prim has one motion. Give the instance that it is to follow "
                "joints of its own (instanceable = false)."
            )
    return found
