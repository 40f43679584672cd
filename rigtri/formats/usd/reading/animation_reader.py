"""UsdSkel animations as tracks: every joint's column of every array, samples and default.

A SkelAnimation keeps one array per property for all its joints. Its samples
become a clip of tracks, its default values a clip ``NAME@default`` with one
key; each track knows the column it came from.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf, Usd

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import DEFAULT, numbers, tokens_of
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.composition.value_types import WrongTypeError, demand
from rigtri.maths.quaternions import norm, off_unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Column, Interpolation, Path, Track, Tracks, columns
from rigtri.model.dataclass import dataclass
from rigtri.report import Notice

# The key of tracks that only show a default during a clip; the default's own clip writes it.
HELD = "held"

# Rotations further from unit are worth a word: engines differ in what they make of them.
NON_UNIT = 1e-4

# What a column holds that neither moves, rotates nor scales its joint.
NOTHING: Mapping[str, tuple[float, ...]] = {
    "translations": (0.0, 0.0, 0.0),
    "rotations": (0.0, 0.0, 0.0, 1.0),
    "scales": (1.0, 1.0, 1.0),
}
PROPERTIES: Mapping[str, Path] = {
    "translations": "translation",
    "rotations": "rotation",
    "scales": "scale",
}


@dataclass(frozen=True, eq=False)
class Property:
    """One array of an animation, in its stored precision; quaternions are xyzw.

    times: (k,) without the blocked ones. samples: (k, j, c). default: (j, c) or None.
    kind: the Vt array class. type_name: of the attribute.
    """

    times: Floats
    samples: np.ndarray
    blocked: tuple[float, ...]
    default: np.ndarray | None
    kind: Any
    type_name: Any


@dataclass(frozen=True, eq=False)
class Animation:
    """One SkelAnimation prim.

    tokens: its own joints, in its own order. idle: UsdSkel does not play them. lacks: the arrays that it
    misses for that.
    """

    path: str
    name: str
    tokens: tuple[str, ...]
    properties: Mapping[str, Property]
    idle: bool = False
    lacks: tuple[str, ...] = ()


def array_paths(animation: Any) -> list[Any]:
    """The paths of the arrays of an animation: its joints, and what it has of each."""
    return [Sdf.Path(animation).AppendProperty(name) for name in ("joints", *PROPERTIES)]


def interpolation_of(stage: Any) -> Interpolation:
    """How a stage goes from one sample to the next."""
    return "STEP" if stage.GetInterpolationType() == Usd.InterpolationTypeHeld else "LINEAR"


def read_animation(prim: Any, warnings: list[Notice]) -> Animation | None:
    """The animation of a SkelAnimation prim; None, with a notice, where nothing of it plays.

    FileError where only some of its samples are usable, or hold what is no number.
    """
    try:
        return _read(prim, warnings)
    except WrongTypeError as error:
        path, why = str(prim.GetPath()), str(error).partition(";")[0]
        warnings.append(_ignored(path, why.removeprefix(f"<{path}>.")))
        return _without_joints(prim)


def _without_joints(prim: Any) -> Animation | None:
    """What is left of an animation that moves no joints: UsdSkel plays its blend shapes all the same."""
    if prim.IsActive() and prim.GetAttribute("blendShapeWeights").HasAuthoredValue():
        return Animation(str(prim.GetPath()), prim.GetName(), (), {})
    return None


def _read(prim: Any, warnings: list[Notice]) -> Animation | None:
    """The same; WrongTypeError where UsdSkel ignores it for the type of an attribute."""
    path = str(prim.GetPath())
    tokens = tokens_of(prim, "joints")
    if not tokens:
        if (shapes := _without_joints(prim)) is not None:
            return shapes
        if any(prim.GetAttribute(name).HasAuthoredValue() for name in PROPERTIES):
            warnings.append(_ignored(path, "it names no joints"))
        return None
    _check_tokens(path, tokens)
    found = {name: _property(prim, name, tokens) for name in PROPERTIES}
    present = {name: value for name, value in found.items() if value is not None}
    for name, value in present.items():
        if value.default is None and not len(value.times):
            warnings.append(_ignored(path, f"no value of {name} has as many items as it has joints"))
            return _without_joints(prim)
    # Samples that are all blocked hide the default, too.
    hidden = {name for name, item in present.items() if item.blocked and not len(item.times)}
    missing = [name for name in PROPERTIES if name not in present or name in hidden]
    if missing:
        warnings.append(
            Notice(
                "animation-ignored",
                f"UsdSkel moves no joints by animation <{path}>: it has no {' and no '.join(missing)}. "
                "Edits re-orient what it has all the same.",
            )
        )
    if not prim.IsActive():
        text = f"Animation <{path}> is not active, so it is not a clip. It is re-oriented anyway."
        warnings.append(Notice("animation-inactive", text))
    warnings += _off_unit(path, tokens, present)
    idle = bool(missing) or not prim.IsActive()
    return Animation(path, prim.GetName(), tokens, present, idle, tuple(missing))


def _check_tokens(path: str, tokens: Sequence[str]) -> None:
    if len(set(tokens)) < len(tokens):
        twice = next(token for k, token in enumerate(tokens) if token in tokens[:k])
        raise FileError(
            f"Animation <{path}> lists joint '{twice}' twice, so which values move it is undefined. "
            "Export it again."
        )


def _off_unit(path: str, tokens: Sequence[str], properties: Mapping[str, Property]) -> list[Notice]:
    """A notice where rotations are not unit, with the worst of them."""
    item = properties.get("rotations")
    if item is None:
        return []
    single = item.samples[:0] if item.default is None else item.default[np.newaxis]
    if max(off_unit(item.samples), off_unit(single)) <= NON_UNIT:
        return []
    off = np.concatenate([np.abs(norm(rows) - 1.0) for rows in (item.samples, single)])
    row, column = map(int, np.unravel_index(off.argmax(), off.shape))
    at = f"at time {item.times[row]:g}" if row < len(item.times) else "by default"
    text = (
        f"Rotations of animation <{path}> are not unit, the worst is of '{tokens[column]}' {at}, "
        f"off by {off.max():.2g}"
    )
    return [Notice("rotation-not-unit", text, joint=tokens[column])]


def _ignored(path: str, why: str) -> Notice:
    return Notice(
        "animation-ignored", f"UsdSkel moves no joints by animation <{path}>: {why}. It is left as it is."
    )


def _property(prim: Any, name: str, tokens: Sequence[str]) -> Property | None:
    count, attribute = len(tokens), prim.GetAttribute(name)
    if not attribute or not attribute.HasAuthoredValue():
        return None
    width = 4 if name == "rotations" else 3
    default = attribute.Get(DEFAULT)
    # An empty default is no default: it drives nothing.
    single = None if default is None else numbers(attribute, default)
    single = single if single is not None and len(single) else None
    values = time_samples(attribute)
    blocked = tuple(time for time, value in values if value is None)
    times = [time for time, value in values if value is not None]
    given = [value for _, value in values if value is not None]
    for first in {type(value): value for value in given}.values():
        demand(attribute, first)
    if not given and single is None:
        return None
    kind = type(default) if single is not None else type(given[0])
    type_name = attribute.GetTypeName()
    lengths = [*map(len, given), *(() if single is None else (len(single),))]
    if count not in lengths:
        return Property(np.zeros(0), np.zeros((0, count, width)), blocked, None, kind, type_name)
    if lengths.count(count) < len(lengths):
        time, length = next(
            pair for pair in zip((*times, "default"), lengths, strict=False) if pair[1] != count
        )
        raise FileError(
            f"<{attribute.GetPath()}> has {length} items at time {time}, but the animation "
            f"has {count} joints."
        )
    samples = _joined(given) if given else np.zeros((0, count, width))
    _check_values(attribute, times, samples, tokens)
    if single is not None:
        _check_values(attribute, ["default"], single[np.newaxis], tokens)
    return Property(np.array(times, dtype=np.float64), samples, blocked, single, kind, type_name)


def _joined(values: Sequence[Any]) -> np.ndarray:
    """Vt arrays of one type and length as one array, (k, j, c)."""
    first = np.asarray(values[0])
    return np.frombuffer(b"".join(values), first.dtype).reshape(len(values), *first.shape)


def _check_values(attribute: Any, times: Sequence[Any], values: np.ndarray, tokens: Sequence[str]) -> None:
    """FileError for what is no number, or no rotation, naming joint and time; values: (k, j, c)."""
    if not np.isfinite(values).all():
        wrong, what = ~np.isfinite(values).all(axis=2), "values that are not numbers (NaN or infinite)"
    elif values.shape[2] == 4 and not values[:, :, 3].all():
        wrong, what = ~values.any(axis=2), "the quaternion 0 0 0 0, which is not a rotation,"
    else:
        return
    if wrong.any():
        row, column = map(int, np.unravel_index(wrong.argmax(), wrong.shape))
        raise FileError(
            f"<{attribute.GetPath()}> holds {what} for joint '{tokens[column]}' at time "
            f"{times[row]}. Export it again."
        )


def clips(
    animation: Animation,
    name: str,
    nodes: Iterable[Mapping[str, int]],
    weights: Sequence[Track],
    interpolation: Interpolation,
) -> list[Clip]:
    """The clips of an animation: its samples, and its defaults as ``NAME@default``.

    nodes: for each skeleton it drives, the node of each joint token. Tokens that
    no skeleton has stay in the file. A property without samples holds its
    default during the clip.
    """
    joints = [
        (column, known[token])
        for known in nodes
        for column, token in enumerate(animation.tokens)
        if token in known
    ]
    timed = [p.times for p in animation.properties.values() if len(p.times)]
    result = []
    if timed or weights:
        start = np.array([min([t[0] for t in timed] + [track.times[0] for track in weights])])
        found: list[Column] = []
        for property_name, item in animation.properties.items():
            found += _columns(property_name, item, joints, start, interpolation, sum(map(len, found)))
        count = sum(map(len, found))
        found += [replace(c, places=[count + place for place in c.places]) for c in columns(weights)]
        result.append(Clip(name, Tracks(found), ("samples", animation.path), animation.idle, True))
    held = [
        Track(node, PROPERTIES[property_name], "STEP", _ZERO, values[:, column], (property_name, column))
        for property_name, item in animation.properties.items()
        if (values := _as_key(item.default)) is not None
        for column, node in joints
    ]
    if held:
        result.append(Clip(f"{name}@default", tuple(held), ("default", animation.path), animation.idle, True))
    return result


_ZERO: Floats = np.zeros(1)


def _as_key(default: np.ndarray | None) -> Floats | None:
    return None if default is None else default[np.newaxis].astype(np.float64)


def _columns(
    name: str,
    item: Property,
    joints: Sequence[tuple[int, int]],
    start: Floats,
    interpolation: Interpolation,
    place: int,
) -> list[Column]:
    """The tracks of one property, of its samples or else its default; place: the first among the clip's."""
    held = _as_key(item.default)
    if not joints or (not len(item.times) and held is None):
        return []
    rows = [column for column, _ in joints]
    times, values = item.times, item.samples
    keys: list[Hashable] = [(name, column) for column in rows]
    if held is not None and not len(times):
        interpolation, times, values, keys = "STEP", start, held, [HELD] * len(rows)
    by_joint = values.transpose(1, 0, 2)
    if rows != list(range(len(by_joint))):
        by_joint = by_joint[rows]
    nodes = np.array([node for _, node in joints], dtype=np.int64)
    places = range(place, place + len(rows))
    own_times = [times] * len(rows)
    path, raw = PROPERTIES[name], name == "rotations"
    return [Column(path, interpolation, times, nodes, by_joint, keys, own_times, places, raw=raw)]
