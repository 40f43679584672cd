"""Write the weights of blend shapes: columns, by name, of one array of the SkelAnimation.

New names come behind those that are there, and the columns that nothing drives anew keep their values.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from rigtri.errors import FileError
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import SAME_VALUE
from rigtri.formats.usd.composition.stage import DEFAULT, refuse
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.composition.value_types import usable
from rigtri.formats.usd.opinions.edits import Edit, remove_properties, set_tokens, set_value
from rigtri.formats.usd.opinions.skeleton_edits import as_samples
from rigtri.formats.usd.passes.usd_edit import UsdEdit
from rigtri.formats.usd.reading.animation_reader import Animation, interpolation_of
from rigtri.formats.usd.reading.mesh_reader import blend_names, default_weights
from rigtri.formats.usd.reading.source import Source
from rigtri.maths.arrays import Booleans
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig


def write_blend_weights(edit: UsdEdit) -> None:
    """Write the weights of the animations that drive blend shapes: keys that changed or go, and defaults."""
    edit.values += _key_edits(edit.source, edit.changes.weights)
    edit.values += _default_edits(edit.source, edit.rig)


def _key_edits(source: Source, changed: Sequence[tuple[Track | None, Track | None]]) -> list[Edit]:
    """Edits of the animations that drive blend shapes, with the columns that changed or go."""
    driven: dict[str, dict[str, _Column]] = {}
    gone: dict[str, set[str]] = {}
    fewer: dict[str, list[Floats]] = {}
    for was, now in changed:
        path, animation, names = _bound(source, (now or _sure(was)).node)
        columns = driven.setdefault(animation, {})
        resting = default_weights(source.stage.GetPrimAtPath(animation))
        now = None if now is None else as_samples(now, f"A blend shape of <{path}>")
        if was is not None and (now is None or not np.isin(was.times, now.times).all()):
            fewer.setdefault(animation, []).extend([] if now is None else [now.times])
        if now is None:
            rows = _sure(was).values
            moving = [n for k, n in enumerate(names) if (rows[:, k] != resting.get(n, 0.0)).any()]
            gone.setdefault(animation, set()).update(moving)
            continue
        if was is not None:
            gone.setdefault(animation, set()).update(names[k] for k in now.unlisted - was.unlisted)
        times = now.times if was is None else np.union1d(was.times, now.times)
        shown = sample(now, times)
        before = np.array([resting.get(n, 0.0) for n in names]) if was is None else sample(was, times)
        for number, name in enumerate(names):
            if (shown[:, number] == before[..., number]).all() or name in gone.get(animation, ()):
                continue
            column = _Column(path, now.times, now.values[:, number])
            if name in columns and not columns[name].same(column):
                raise FileError(
                    f"Blend shape '{name}' of <{path}> and of <{columns[name].mesh}> is one column of "
                    f"animation <{animation}>, so both can only be driven alike."
                )
            columns[name] = column
    _check_shared(source, driven, [now for _, now in changed if now is not None])
    return [
        edit
        for path, columns in driven.items()
        if columns or gone.get(path) or path in fewer
        for edit in _written(source, source.animations[path], columns, gone.get(path, set()), fewer.get(path))
    ]


def _default_edits(source: Source, rig: Rig) -> list[Edit]:
    """Edits of the default weights of animations, which the rig has at rest for meshes."""
    found: dict[str, dict[str, float]] = {}
    for node, weights in rig.pending.morph_weights.items():
        _, animation, names = _bound(source, node)
        known = found.setdefault(animation, default_weights(source.stage.GetPrimAtPath(animation)))
        known.update(zip(names, weights.tolist(), strict=True))
    edits: list[Edit] = []
    for path, known in found.items():
        row = np.array([known.get(name, 0.0) for name in blend_names(source.stage.GetPrimAtPath(path))])
        edits.append(set_value(path, "blendShapeWeights", Sdf.ValueTypeNames.FloatArray, _floats(row)))
    return edits


def _sure(track: Track | None) -> Track:
    if track is None:
        raise ValueError("a change is from something or to something")
    return track


@dataclass(frozen=True, eq=False)
class _Column:
    """The weight of one blend shape over time, and the mesh that it is for."""

    mesh: str
    times: Floats
    values: Floats

    def same(self, other: _Column) -> bool:
        return np.array_equal(self.times, other.times) and np.array_equal(self.values, other.values)


def _bound(source: Source, node: int) -> tuple[str, str, list[str]]:
    """The prim that a node stands for, the animation that drives it, and its blend shapes in order."""
    label = source.rig.labels[node]
    for skeleton, query in source.bindings.every:
        if str(query.GetPrim().GetPath()) != label or skeleton not in source.skeletons:
            continue
        stand = source.skeletons[skeleton]
        if not stand.animations or stand.animations[0] not in source.animations:
            break
        if len(stand.animations) > 1:
            raise FileError(
                f"<{label}>: its instances play {len(stand.animations)} animations, and weights of its blend "
                "shapes can be driven in one. Edit the file that the instances refer to."
            )
        refuse(stand.locked)
        return label, stand.animations[0], [str(name) for name in query.GetBlendShapeOrder() or ()]
    raise FileError(f"<{label}>: no SkelAnimation plays there that could hold weights of its blend shapes.")


def _check_shared(
    source: Source,
    driven: dict[str, dict[str, _Column]],
    changed: Sequence[Track],
) -> None:
    """FileError where a name that is driven moves a mesh, too, that no track moves."""
    keyed = {source.rig.labels[now.node] for now in changed}
    for skeleton, query in source.bindings.every:
        path = str(query.GetPrim().GetPath())
        stand = source.skeletons.get(skeleton)
        if stand is None or path in keyed or not query.HasBlendShapes():
            continue
        columns = {name: column for path in stand.animations for name, column in driven.get(path, {}).items()}
        for name in map(str, query.GetBlendShapeOrder() or ()):
            if name in columns:
                raise FileError(
                    f"Blend shape '{name}' is also one of <{path}>, and a USD animation drives both by "
                    "that name. Drive it there, too."
                )


def _written(
    source: Source,
    animation: Animation,
    columns: dict[str, _Column],
    gone: Collection[str],
    fewer: Sequence[Floats] | None,
) -> Iterator[Edit]:
    """The arrays of one animation, complete: a stronger sample hides all weaker ones.

    gone: names that nothing drives any more. fewer: leave out times that no column needs, nor any of these.
    """
    prim = source.stage.GetPrimAtPath(animation.path)
    names, weights = blend_names(prim), prim.GetAttribute("blendShapeWeights")
    old = _stored(weights, len(names))
    default = usable(weights, weights.Get(DEFAULT))
    fits = default is not None and len(default) == len(names)
    single = np.array(default, dtype=np.float64) if fits else None
    every = [*names, *(name for name in columns if name not in names)]
    times = np.unique(np.concatenate([old[0], *(column.times for column in columns.values())]))
    way = interpolation_of(source.stage)
    rows = np.zeros((len(times), len(every)))
    if len(old[0]):
        rows[:, : len(names)] = sample(Track(-1, "weights", way, *old), times)
    elif single is not None:
        rows[:, : len(names)] = single
    for name, column in columns.items():
        track = Track(-1, "weights", way, column.times, column.values[:, np.newaxis])
        rows[:, every.index(name)] = sample(track, times)[:, 0]
    stays = np.array([name not in gone for name in every], dtype=bool)
    if fewer is not None:
        needed = [*fewer, *(column.times for column in columns.values())]
        few_times = np.unique(np.concatenate([np.zeros(0), *needed]))
        times, rows = _needed(Track(-1, "weights", way, times, rows), few_times, stays)
    every, rows = [name for name in every if name not in gone], rows[:, stays]
    if single is not None and len(gone):
        single, names_now = single[[name not in gone for name in names]], every
    else:
        names_now = names
    types = Sdf.ValueTypeNames
    if every != names:
        yield set_tokens(animation.path, "blendShapes", every)
        if single is not None:
            single = np.concatenate([single, np.zeros(len(every) - len(names_now))])
    if not every or (not len(times) and single is None):
        yield remove_properties(animation.path, "blendShapeWeights", *(() if every else ("blendShapes",)))
        return
    yield set_value(
        animation.path,
        "blendShapeWeights",
        types.FloatArray,
        None if single is None else _floats(single),
        samples={float(time): _floats(row) for time, row in zip(times, rows, strict=True)},
        alone=True,
    )


def _needed(track: Track, few: Floats, columns: Booleans) -> tuple[Floats, Floats]:
    """Times and rows of a track at ``few`` alone, where its columns need no others."""
    if not len(few):
        same = (np.abs(track.values[:, columns] - track.values[:1, columns]) <= SAME_VALUE).all()
        return (few, track.values[:0]) if same else (track.times, track.values)
    reduced = replace(track, times=few, values=sample(track, few))
    off = np.abs(sample(reduced, track.times) - track.values)[:, columns]
    kept = reduced if off.max(initial=0.0) <= SAME_VALUE else track
    return kept.times, kept.values


def _stored(weights: Any, count: int) -> tuple[Floats, Floats]:
    """Times and rows of the weights that are there, (k,) and (k, count)."""
    found = [(time, usable(weights, value)) for time, value in time_samples(weights)] if weights else []
    if any(value is None or len(value) != count for _, value in found):
        raise FileError(
            f"<{weights.GetPath()}> has samples that are blocked or have not as many weights as there are "
            "blend shapes, so none can be added. Export it again."
        )
    times = np.array([time for time, _ in found], dtype=np.float64)
    return times, np.array([list(value) for _, value in found], dtype=np.float64).reshape(len(found), count)


def _floats(row: Floats) -> Any:
    return Vt.FloatArray.FromNumpy(np.ascontiguousarray(row, dtype=np.float32))
