"""Keys of joints: at other times than before, or of joints and properties that had none.

An animation has one array for all its joints at each time, so its keys are those of any of them:
each property has samples at all times at which a track of it has a key. It is done as a split is
done: first every array says at those times what it said before, and then the rig is written into it.

Source: UsdSkel, SkelAnimation (`joints`, and arrays of as many items; it plays with all three or not).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from rigtri.errors import FileError
from rigtri.evaluation.sampling import sample, sorted_unique
from rigtri.evaluation.timelines import without_steps
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.composition.animation_binding import bind
from rigtri.formats.usd.composition.stage import why_instanced
from rigtri.formats.usd.composition.variants import Trial
from rigtri.formats.usd.opinions.edits import Edit, apply_schema, define, kind, parts, set_value
from rigtri.formats.usd.opinions.preview_stage import edited
from rigtri.formats.usd.reading.animation_reader import HELD, NOTHING, PROPERTIES, Animation, Property
from rigtri.formats.usd.reading.reader import Source
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Path, Track
from rigtri.model.rig import Rig

_TYPES = Sdf.ValueTypeNames
# The types that the schema gives the arrays of an animation.
_ARRAYS = {
    "translations": (_TYPES.Float3Array, Vt.Vec3fArray, np.float32),
    "rotations": (_TYPES.QuatfArray, Vt.QuatfArray, np.float32),
    "scales": (_TYPES.Half3Array, Vt.Vec3hArray, np.float16),
}
# A track that holds a default and one that is it differ by rounding, as a share of the largest number.
_ROUNDING = 1e-9

# What moves joints during an animation, or stands in its defaults, by node and property.
Said = dict[tuple[int, Path], Track]


def driven(source: Source, rig: Rig, options: ReadOptions) -> tuple[Source, Rig, list[Edit]]:
    """The source with samples where ``rig`` has keys, the rig with as many for each joint, and the edits.

    FileError where an animation cannot be edited.
    """
    same = all(new is old for new, old in zip(rig.clips, source.rig.clips, strict=False))
    if same and len(rig.clips) == len(source.rig.clips):
        return source, rig, []
    places = _places(source)
    plans = [_Plan(source, rig, places, path) for path in _touched(source, rig, places)]
    if not plans:
        return source, rig, []
    edits = [edit for plan in plans for edit in plan.edits()]
    wide = edited(source, edits, options) if edits else source
    said = {plan.animation.path: plan.said for plan in plans}
    return wide, replace(rig, clips=tuple(_aligned(source, wide, rig, said))), edits


def _places(source: Source) -> dict[int, tuple[str, str]]:
    """The skeleton and the token of each joint that an animation can move."""
    return {
        node: (parts(skin.key)[1], token)
        for skin in source.rig.skins
        if kind(skin.key) in ("skeleton", "library")
        for node, token in zip(skin.joints.tolist(), source.skeletons[parts(skin.key)[1]].tokens, strict=True)
    }


def _touched(source: Source, rig: Rig, places: Mapping[int, tuple[str, str]]) -> list[str]:
    """The animations whose tracks have other keys than they had, or a skeleton's path where none plays."""
    found: dict[str, None] = {}
    old = {clip.key: clip for clip in source.rig.clips}
    for clip in rig.clips:
        was = old.get(clip.key)
        known: dict[Any, Track] = {} if was is None else {(t.node, t.path, t.key): t for t in was.tracks}
        mine = [t for t in clip.tracks if t.node in places and t.path != "weights"]
        for track in mine:
            skeleton = source.skeletons[places[track.node][0]]
            before = known.get((track.node, track.path, track.key))
            if before is None or (track is not before and _other_keys(rig, clip.key, before, track)):
                found[skeleton.animation or skeleton.path] = None
        there = {(t.node, t.path, t.key) for t in mine}
        gone = [t for t in known.values() if t.node in places and (t.node, t.path, t.key) not in there]
        # Those of joints that go altogether are taken out at last.
        if any(track.path != "weights" and track.node not in rig.pending.removed for track in gone):
            found[parts(clip.key)[1]] = None
    return list(found)


def _other_keys(rig: Rig, clip: Hashable, was: Track, now: Track) -> bool:
    if now.key == HELD:
        return not _is_default(now, _defaults(rig, parts(clip)[1]))
    if was.times is not now.times and not np.array_equal(was.times, now.times):
        return True
    return len(now.times) > 1 and was.interpolation != now.interpolation


def _defaults(rig: Rig, path: str) -> Said:
    """What the default values of an animation are to be, those of new joints among them."""
    tracks = [t for clip in rig.clips if clip.key == ("default", path) for t in clip.tracks]
    tracks.sort(key=lambda track: track.key is None)
    return {(t.node, t.path): t for t in tracks if len(t.times) == 1}


def _is_default(held: Track, defaults: Said) -> bool:
    """Whether a track says nothing but the default of its property."""
    default = defaults.get((held.node, held.path))
    if default is None or len(held.times) > 1:
        return False
    size = max(1.0, float(np.abs(default.values).max(initial=0.0)))
    return bool(np.abs(held.values - default.values).max(initial=0.0) <= _ROUNDING * size)


@dataclass(frozen=True, eq=False)
class _Row:
    """A joint in an animation: its token, and the nodes that it moves, one for each skeleton."""

    token: str
    nodes: list[int]


class _Plan:
    """What one animation is to say."""

    def __init__(self, source: Source, rig: Rig, places: Mapping[int, tuple[str, str]], path: str) -> None:
        self.source, self.rig = source, rig
        self.skeleton = path if path in source.skeletons and path not in source.animations else ""
        if not self.skeleton and path not in source.animations:
            raise FileError(f"Animation <{path}> cannot be read, so it can get no keys. Export it again.")
        self.animation = _blank(source, path) if self.skeleton else source.animations[path]
        users = [s.path for s in source.skeletons.values() if path in (s.animation, s.path)]
        self.users = [source.skeletons[user] for user in users]
        self.defaults = _defaults(rig, path)
        self.said = self._tracks({node for node, (s, _) in places.items() if s in users})
        rows = {token: _Row(token, []) for token in self.animation.tokens}
        asked = {node for node, _ in (*self.said, *self.defaults)}
        for node, (skeleton, token) in places.items():
            if skeleton in users and (token in rows or node in asked):
                rows.setdefault(token, _Row(token, [])).nodes.append(node)
        self.rows = list(rows.values())

    def _tracks(self, nodes: set[int]) -> Said:
        """What moves the joints from now on: what has no place yet goes over what has."""
        home = ("samples", self.animation.path)
        stored = [t for c in self.rig.clips if c.key == home for t in c.tracks if t.key is not None]
        fresh = [t for c in self.rig.clips for t in c.tracks if t.key is None]
        resting = {id(t) for t in self.defaults.values() if self._has_default(t.path)}
        fresh = [t for t in fresh if id(t) not in resting]
        # A key in a default that the file does not have counts where nothing else moves.
        fresh.sort(key=lambda track: self.defaults.get((track.node, track.path)) is not track)
        found = {}
        for track in (t for t in (*stored, *fresh) if t.node in nodes and t.path != "weights"):
            if track.interpolation == "CUBICSPLINE" and len(track.times) > 1:
                where = self.rig.title(track.node)
                raise FileError(f"'{where}' moves by splines, which USD has none of. Give it linear keys.")
            found[track.node, track.path] = track
        return found

    def _has_default(self, path: Path) -> bool:
        items = (item for name, item in self.animation.properties.items() if PROPERTIES[name] == path)
        return any(item.default is not None for item in items)

    def edits(self) -> Iterator[Edit]:
        """The arrays with samples at the new times, and with a column for each new joint."""
        path, tokens = self.animation.path, [row.token for row in self.rows]
        times = {name: self._times(name) for name in PROPERTIES}
        more = len(tokens) > len(self.animation.tokens)
        new = [n for n in PROPERTIES if n not in self.animation.properties and len(times[n])]
        wanted = [n for n in PROPERTIES if more or new or self._differs(n, times[n])]
        # Where a property comes that was not there, all three must be, or nothing of it is played.
        wanted = [n for n in wanted if new or n in self.animation.properties]
        if not wanted:
            return
        self._check([name for name in wanted if self._differs(name, times[name])])
        if self.skeleton:
            yield define(path, "SkelAnimation")
        if more:
            yield set_value(path, "joints", _TYPES.TokenArray, Vt.TokenArray(tokens), uniform=True)
        for name in wanted:
            yield self._array(name, times[name])
        if self.skeleton:
            yield bind(self.skeleton, path)
            yield apply_schema(self.skeleton, "SkelBindingAPI")

    def _times(self, name: str) -> Floats:
        """All times at which a track of a property has a key, (k,); none where none moves."""
        item = self.animation.properties.get(name)
        distinct: dict[int, Floats] = {}
        for row in self.rows:
            for node in row.nodes:
                track = self.said.get((node, PROPERTIES[name]))
                if track is not None and not (track.key == HELD and _is_default(track, self.defaults)):
                    times = without_steps(track).times
                    distinct[id(track) if track.interpolation == "STEP" else id(times)] = times
            if not row.nodes and item is not None:  # nobody moves by it now, and it stays
                distinct[id(item.times)] = item.times
        if not distinct:
            return item.times if item is not None else np.zeros(0)
        return sorted_unique(np.concatenate([*distinct.values()]))

    def _differs(self, name: str, times: Floats) -> bool:
        item = self.animation.properties.get(name)
        return not np.array_equal(times, np.zeros(0) if item is None else item.times)

    def _check(self, names: Sequence[str]) -> None:
        """FileError where the animation cannot be edited; names: the properties that get other times."""
        path = self.animation.path
        prim = self.source.stage.GetPrimAtPath(self.skeleton or path)
        if why := why_instanced(prim):
            raise FileError(f"Keys cannot be added: {why}.")
        if not prim.IsActive():
            raise FileError(f"Animation <{path}> is not active, so nobody would see new keys in it.")
        for name in names:
            item = self.animation.properties.get(name)
            if item is not None and item.blocked:
                raise FileError(
                    f"<{path}.{name}> has blocked samples, so its keys cannot be changed. Export it again."
                )
        own = {Sdf.Path(path).AppendProperty(name) for name in ("joints", *PROPERTIES)}
        for skeleton in self.users if not self.skeleton else ():
            depends = Trial(self.source.stage, skeleton).depends
            for found in sorted(own.intersection(depends)):
                above, variants = min(depends[found])
                raise FileError(
                    f"Keys cannot be changed: <{found}> is another one in each variant of '{variants}' on "
                    f"<{above}>. Give each variant a file of its own."
                )

    def _array(self, name: str, times: Floats) -> Edit:
        """An array at new times, as it was; new columns have what their joints are at rest."""
        item, path = self.animation.properties.get(name), self.animation.path
        if item is None:
            type_name, array, number = _ARRAYS[name]
        else:
            prim = self.source.stage.GetPrimAtPath(path)
            type_name, array = prim.GetAttribute(name).GetTypeName(), item.kind
            number = item.samples.dtype.type if len(item.times) else _number(item)
        rest = self._rest(name).astype(number)
        rows = np.repeat(rest[np.newaxis], len(times), axis=0)
        single: np.ndarray | None = rest
        if item is None and len(times) and any(p.default is None for p in self.animation.properties.values()):
            single = None
        if item is not None:
            width = len(self.animation.tokens)
            rows[:, :width] = _resampled(item, times)
            single = None if item.default is None else np.concatenate([item.default, rest[width:]])
        samples = {float(time): _value(array, row) for time, row in zip(times, rows, strict=True)}
        samples.update(dict.fromkeys(() if item is None else item.blocked))
        default = None if single is None else _value(array, single)
        return set_value(path, name, type_name, default, samples=dict(sorted(samples.items())), alone=True)

    def _rest(self, name: str) -> Floats:
        """What the joints are at rest, (j, c); tokens that no skeleton has do nothing."""
        rig = self.source.rig
        every = {"translations": rig.translation, "rotations": rig.rotation, "scales": rig.scale}[name]
        nothing = np.array(NOTHING[name], dtype=np.float64)
        return np.array([every[row.nodes[0]] if row.nodes else nothing for row in self.rows])


def _blank(source: Source, skeleton: str) -> Animation:
    """An animation to be made for a skeleton that has none."""
    path, name, count = Sdf.Path(skeleton), "Animation", 2
    while source.stage.GetPrimAtPath(path.AppendChild(name)):
        name, count = f"Animation_{count}", count + 1
    return Animation(str(path.AppendChild(name)), name, (), {})


def _number(item: Property) -> Any:
    return item.samples.dtype.type if item.default is None else item.default.dtype.type


def _value(array: Any, rows: np.ndarray) -> Any:
    return array.FromNumpy(np.ascontiguousarray(rows))


def _resampled(item: Property, times: Floats) -> Floats:
    """What an array says at other times, (k, j, c): its own samples to the bit."""
    if not len(item.times):
        assert item.default is not None  # a property has samples, a default or both
        return np.repeat(item.default[np.newaxis].astype(np.float64), len(times), axis=0)
    found = np.empty((len(times), *item.samples.shape[1:]))
    old = item.samples.astype(np.float64)
    path: Path = "rotation" if old.shape[2] == 4 else "translation"
    for column in range(old.shape[1]):
        track = Track(-1, path, "LINEAR", item.times, old[:, column])
        found[:, column] = _exactly(track, times)
    return found


def _exactly(track: Track, times: Floats) -> Floats:
    """The values of a track, (k, c), its keys' own to the bit and the sign of a quaternion."""
    values = sample(track, times)
    at = np.clip(np.searchsorted(track.times, times), 0, len(track.times) - 1)
    own = track.times[at] == times
    values[own] = track.values[at[own]]
    return values


def _aligned(source: Source, wide: Source, rig: Rig, said: Mapping[str, Said]) -> Iterator[Clip]:
    """The clips of a rig with the tracks that the source has that is to be written."""
    known = {clip.key: clip for clip in rig.clips}
    before = {clip.key: clip for clip in source.rig.clips}
    # What is as it was read is what is read now, too, so that nobody writes it again.
    read = {(c.key, t.node, t.path, t.key): t for c in wide.rig.clips for t in c.tracks}
    again = {id(t): read.get((c.key, t.node, t.path, t.key), t) for c in source.rig.clips for t in c.tracks}
    for shown in wide.rig.clips:
        clip = known.get(shown.key, replace(shown, tracks=()))
        path = parts(shown.key)[1]
        fresh = {id(t) for one in said.values() for t in one.values() if t.key is None}
        fresh |= {id(t) for one in said for t in _defaults(rig, one).values() if t.key is None}
        if clip is before.get(shown.key) and path not in said:
            yield shown
            continue
        kept = tuple(again.get(id(t), t) for t in clip.tracks if id(t) not in fresh)
        if path not in said:
            yield replace(clip, tracks=kept)
            continue
        joints = {(t.node, t.path) for t in shown.tracks if t.path != "weights"}
        others = tuple(t for t in kept if (t.node, t.path) not in joints)
        old = before.get(shown.key)
        was = {} if old is None else {(t.node, t.path): t for t in old.tracks}
        mine = _defaults(rig, path)
        if parts(shown.key)[0] == "samples":
            mine = {**{key: track for key, track in mine.items() if key not in was}, **said[path]}
        joined = (t for t in shown.tracks if t.path != "weights" and t.node not in rig.pending.removed)
        tracks = [_on(t, mine, was, rig) for t in joined]
        yield replace(clip, tracks=(*tracks, *others), idle=shown.idle)


def _on(shown: Track, said: Said, was: Said, rig: Rig) -> Track:
    """A track of the source with what the rig says there at its times."""
    own, old = said.get((shown.node, shown.path)), was.get((shown.node, shown.path))
    if own is None:
        rest = {"translation": rig.translation, "rotation": rig.rotation, "scale": rig.scale}[shown.path]
        return replace(shown, values=np.broadcast_to(rest[shown.node], shown.values.shape))
    if own is old:
        return shown
    if shown.key == HELD or len(shown.times) == len(own.times) == 1:
        return replace(own, key=shown.key, times=shown.times)
    return replace(shown, values=_exactly(without_steps(own), shown.times))
