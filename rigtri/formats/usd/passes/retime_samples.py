"""Retime the samples of animations: keys at other times, or of joints and properties that had none.

An animation has one array for all its joints at each time, so its keys are those of any of them:
each property has samples at all times at which a track of it has a key. First every array gets its
own values at those times; `write_animations` then writes the rig's.

Source: UsdSkel, SkelAnimation (`joints`, and arrays of as many items; it plays with all three or not).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from rigtri.errors import FileError
from rigtri.evaluation.sampling import sample, sorted_unique
from rigtri.evaluation.timelines import PLAYED, without_steps
from rigtri.formats.usd.composition.stage import refuse, why_instanced
from rigtri.formats.usd.composition.variants import SkeletonVariants
from rigtri.formats.usd.opinions.edits import Edit, bind_animation, define, free_path, set_tokens
from rigtri.formats.usd.opinions.skeleton_edits import check_no_spline, set_array
from rigtri.formats.usd.opinions.variant_paths import keys_of_new_joints
from rigtri.formats.usd.passes.usd_edit import UsdEdit, moves_as_before, resting
from rigtri.formats.usd.reading.animation_reader import HELD, NOTHING, PROPERTIES, Animation, Property
from rigtri.formats.usd.reading.node_keys import parts
from rigtri.formats.usd.reading.source import Source
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

# The tracks of an animation, or of its defaults, by node and property.
Tracks = dict[tuple[int, Path], Track]


def retime_samples(edit: UsdEdit) -> None:
    """Read the source again with samples where the rig has keys; each joint gets keys at all of them.

    Clips of no place in the file stay behind the others. FileError where an animation cannot be edited.
    """
    source, rig = edit.source, edit.rig
    same = all(new is old for new, old in zip(rig.clips, source.rig.clips, strict=False))
    if same and len(rig.clips) == len(source.rig.clips):
        return
    plans = [_Plan(source, rig, path) for path in _retimed(source, rig)]
    if not plans:
        return
    edits = [change for plan in plans for change in _within_variants(edit, plan)]
    if edits:
        edit.prepare(edits)
    tracks = {plan.animation.path: plan.tracks for plan in plans}
    clips = (*_aligned(source, edit.source, rig, tracks), *(c for c in rig.clips if c.key == PLAYED))
    edit.rig = replace(rig, clips=clips)


def _within_variants(edit: UsdEdit, plan: _Plan) -> list[Edit]:
    """The edits of a plan, within variants that alone hold what only gets new joints."""
    edits = list(plan.edits())
    edit.retimed += plan.variants
    if moves_as_before(plan.source, plan.rig, plan.users, plan.animation):
        edit.extended.add(plan.animation.path)
        for variants in plan.variants:
            edits, notices = keys_of_new_joints(variants, edits)
            edit.notices += notices
    return edits


def _retimed(source: Source, rig: Rig) -> list[str]:
    """The animations whose tracks have other keys than they had, or a skeleton's path where none plays."""
    found: dict[str, None] = {}
    places = source.joints
    old = {clip.key: clip for clip in source.rig.clips}
    for clip in rig.clips:
        was = old.get(clip.key)
        known: dict[Any, Track] = {} if was is None else {(t.node, t.path, t.key): t for t in was.tracks}
        mine = [t for t in clip.tracks if t.node in places and t.path != "weights"]
        held = any(track.key == HELD for track in mine)
        defaults = _defaults(rig, parts(clip.key)[1]) if held else {}
        for track in mine:
            skeleton = source.skeletons[places[track.node][0]]
            before = known.get((track.node, track.path, track.key))
            if before is None or (track is not before and _other_keys(defaults, before, track)):
                played = [path for path in skeleton.every_animation if path in parts(clip.key)]
                found[(played or skeleton.animations or (skeleton.path,))[0]] = None
        there = {(t.node, t.path, t.key) for t in mine}
        gone = [t for t in known.values() if t.node in places and (t.node, t.path, t.key) not in there]
        # Those of joints that go altogether are taken out at last.
        if any(track.path != "weights" and track.node not in rig.pending.removed for track in gone):
            found[parts(clip.key)[1]] = None
    return list(found)


def _other_keys(defaults: Tracks, was: Track, now: Track) -> bool:
    """Whether a track has other times or steps than it had: arrays that keep theirs need no second write."""
    if now.key == HELD:
        return not _is_default(now, defaults)
    if was.times is not now.times and not np.array_equal(was.times, now.times):
        return True
    return len(now.times) > 1 and was.interpolation != now.interpolation


def _defaults(rig: Rig, path: str) -> Tracks:
    """What the default values of an animation are to be, those of new joints among them."""
    tracks = [t for clip in rig.clips if clip.key == ("default", path) for t in clip.tracks]
    tracks.sort(key=lambda track: track.key is None)
    return {(t.node, t.path): t for t in tracks if len(t.times) == 1}


def _is_default(held: Track, defaults: Tracks) -> bool:
    """Whether a track holds nothing but the default of its property."""
    default = defaults.get((held.node, held.path))
    if default is None or len(held.times) > 1:
        return False
    size = max(1.0, float(np.abs(default.values).max(initial=0.0)))
    values, still = held.values, default.values
    if held.path == "scale":  # no array holds what float16 does not
        values, still = values.astype(np.float16), still.astype(np.float16)
    return bool(np.abs(values - still).max(initial=0.0) <= _ROUNDING * size)


class _Plan:
    """What one animation is to hold."""

    def __init__(self, source: Source, rig: Rig, path: str) -> None:
        places = source.joints
        self.source, self.rig = source, rig
        self.skeleton = path if path in source.skeletons and path not in source.animations else ""
        if not self.skeleton and path not in source.animations:
            raise FileError(f"Animation <{path}> cannot be read, so it can get no keys. Export it again.")
        self.animation = _blank(source, path) if self.skeleton else source.animations[path]
        users = [s.path for s in source.skeletons.values() if path in (*s.every_animation, s.path)]
        self.users = [source.skeletons[user] for user in users]
        self.defaults = _defaults(rig, path)
        self.tracks = self._tracks({node for node, (s, _) in places.items() if s in users})
        # The joints of the animation by their tokens: the nodes that each moves, one for each skeleton.
        self.rows: dict[str, list[int]] = {token: [] for token in self.animation.tokens}
        keyed = {node for node, _ in (*self.tracks, *self.defaults)}
        for node, (skeleton, token) in places.items():
            if skeleton in users and (token in self.rows or node in keyed):
                self.rows.setdefault(token, []).append(node)
        # A control that is a joint is at work where it has keys: without any it has no column.
        ends = set(rig.nodes_of("control", "poleVector"))
        for token in [t for t, nodes in self.rows.items() if nodes and ends.issuperset(nodes)]:
            if keyed.isdisjoint(self.rows[token]):
                del self.rows[token]
        self.kept = [k for k, token in enumerate(self.animation.tokens) if token in self.rows]
        self.variants: list[SkeletonVariants] = []

    def _tracks(self, nodes: set[int]) -> Tracks:
        """What moves the joints from now on: what has no place yet goes over what has."""
        home = ("samples", self.animation.path)
        stored = [t for c in self.rig.clips if c.key == home for t in c.tracks if t.key is not None]
        # Another animation that the same skeleton has in other instances keeps its own.
        others = {path for user in self.users for path in user.every_animation} - {self.animation.path}
        unbound = all(self.animation.path in user.unbound for user in self.users)
        clips = [
            c
            for c in self.rig.clips
            # What nothing plays has no part in what other characters move by.
            if (c.key == home if unbound else not others.intersection(parts(c.key)))
        ]
        self._check_played(
            [t for c in clips if not c.idle for t in c.tracks if t.key is None and t.node in nodes]
        )
        fresh = [t for c in clips for t in c.tracks if t.key is None]
        resting = {id(t) for t in self.defaults.values() if self._has_default(t.path)}
        fresh = [t for t in fresh if id(t) not in resting]
        # A key in a default that the file does not have counts where nothing else moves.
        fresh.sort(key=lambda track: self.defaults.get((track.node, track.path)) is not track)
        found = {}
        for track in (t for t in (*stored, *fresh) if t.node in nodes and t.path != "weights"):
            check_no_spline(track, f"'{self.rig.title(track.node)}'")
            found[track.node, track.path] = track
        return found

    def _check_played(self, fresh: Sequence[Track]) -> None:
        """FileError where new motion would go into an animation that UsdSkel does not play."""
        moved = next((track.node for track in fresh if track.path != "weights"), None)
        if moved is None or not self.animation.idle:
            return
        path, lacks = self.animation.path, self.animation.lacks
        why = f"has no {' and no '.join(lacks)}" if lacks else "is not active"
        what = "Give it values there first" if lacks else "Activate it"
        raise FileError(
            f"UsdSkel does not play <{path}>, which {why}, so '{self.rig.title(moved)}' cannot get keys "
            f"in it. {what}, or bind the skeleton to an animation of its own (skel:animationSource)."
        )

    def _has_default(self, path: Path) -> bool:
        items = (item for name, item in self.animation.properties.items() if PROPERTIES[name] == path)
        return any(item.default is not None for item in items)

    def edits(self) -> Iterator[Edit]:
        """The arrays with samples at the new times, columns for new joints, none for those that go."""
        path, tokens = self.animation.path, list(self.rows)
        times = {name: self._times(name) for name in PROPERTIES}
        others = tokens != list(self.animation.tokens)
        new = [n for n in PROPERTIES if n not in self.animation.properties and len(times[n])]
        rewritten = [n for n in PROPERTIES if others or new or self._differs(n, times[n])]
        # Where a property comes that was not there, all three must be, or nothing of it is played.
        rewritten = [n for n in rewritten if new or n in self.animation.properties]
        if not rewritten:
            return
        self._check([name for name in rewritten if self._differs(name, times[name])])
        if self.skeleton:
            yield define(path, "SkelAnimation")
        if others:
            yield set_tokens(path, "joints", tokens)
        for name in rewritten:
            yield self._array(name, times[name])
        if self.skeleton:
            yield from bind_animation(self.skeleton, path)

    def _times(self, name: str) -> Floats:
        """All times at which a track of a property has a key, (k,); none where none moves."""
        item = self.animation.properties.get(name)
        distinct: dict[int, Floats] = {}
        defaults = item is not None and item.default is not None and not len(item.times)

        def by_default(track: Track) -> bool:
            """Whether a default can say what a track holds: no sample hides it."""
            return track.key == HELD or (track.key is None and defaults)

        for nodes in self.rows.values():
            for node in nodes:
                track = self.tracks.get((node, PROPERTIES[name]))
                if track is not None and not (by_default(track) and _is_default(track, self.defaults)):
                    times = without_steps(track).times
                    distinct[id(track) if track.interpolation == "STEP" else id(times)] = times
            if not nodes and item is not None:  # nobody moves by it now, and it stays
                distinct[id(item.times)] = item.times
        if not distinct:
            return item.times if item is not None else np.zeros(0)
        times = sorted_unique(np.concatenate([*distinct.values()]))
        if item is None or not len(item.times) or item.samples.dtype != np.float16 or name != "scales":
            return times
        return self._times_of_halves(item, times)

    def _times_of_halves(self, item: Property, times: Floats) -> Floats:
        """The times of an array of half floats, (k,), as it had them where it plays as before.

        Between two samples OpenUSD rounds to half floats twice, so that even what stays is off by one in
        eleven bits: a sample that goes would be, and so would all before the first that another comes before.
        """
        old, same = item.times, np.ones(len(item.times), dtype=bool)
        tracks: list[Track] = []
        for column, nodes in enumerate(self.rows.values()):
            mine = [t for node in nodes if (t := self.tracks.get((node, "scale"))) is not None]
            if column < len(self.kept):
                stored = item.samples[:, self.kept[column]]
                for track in mine:
                    same &= (_halves(track, old) == stored).all(axis=1)
            tracks += mine
        same &= (old >= times[0]) & (old <= times[-1])
        if not same.any():
            return times
        times = sorted_unique(np.concatenate([times, old[same]]))
        for end, outside in ((old[0], times[times < old[0]]), (old[-1], times[times > old[-1]])):
            every = (_halves(track, np.append(outside, end)) for track in tracks)
            if all((rows == rows[-1]).all() for rows in every):
                times = times[~np.isin(times, outside)]
        return times

    def _differs(self, name: str, times: Floats) -> bool:
        item = self.animation.properties.get(name)
        return not np.array_equal(times, np.zeros(0) if item is None else item.times)

    def _check(self, names: Sequence[str]) -> None:
        """FileError where the animation cannot be edited; names: the properties that get other times."""
        path = self.animation.path
        prim = self.source.stage.GetPrimAtPath(self.skeleton or path)
        if self.skeleton:
            refuse(why_instanced(prim), "An animation cannot be added")
        if not prim.IsActive():
            raise FileError(f"Animation <{path}> is not active, so nobody would see new keys in it.")
        for name in names:
            item = self.animation.properties.get(name)
            if item is not None and item.blocked:
                raise FileError(
                    f"<{path}.{name}> has blocked samples, so its keys cannot be changed. Export it again."
                )
        users = self.users if not self.skeleton else ()
        self.variants = [SkeletonVariants(self.source.stage, user.path, path) for user in users]

    def _array(self, name: str, times: Floats) -> Edit:
        """An array at new times, as it was; new columns have what their joints are at rest."""
        item = self.animation.properties.get(name)
        rest = self._rest(name).astype(_ARRAYS[name][2] if item is None else _number(item))
        rows = np.repeat(rest[np.newaxis], len(times), axis=0)
        if item is None:
            type_name, kind_of, _ = _ARRAYS[name]
            undefined = len(times) and any(p.default is None for p in self.animation.properties.values())
            new = Property(times, rows, (), None if undefined else rest, kind_of, type_name)
        else:
            width = len(self.kept)
            rows[:, :width] = _resampled(item, times)[:, self.kept]
            own = None if item.default is None else item.default[self.kept]
            default = None if own is None else np.concatenate([own, rest[width:]])
            new = replace(item, times=times, samples=rows, default=default)
        return set_array(self.animation.path, name, new, only=True)

    def _rest(self, name: str) -> Floats:
        """What the joints are at rest, (j, c); tokens that no skeleton has do nothing."""
        every: Floats = getattr(self.source.rig, PROPERTIES[name])
        nothing = np.array(NOTHING[name], dtype=np.float64)
        return np.array([every[nodes[0]] if nodes else nothing for nodes in self.rows.values()])


def _halves(track: Track, times: Floats) -> Any:
    """The values of a track at some times, (k, c), as half floats."""
    return _exactly(without_steps(track), times).astype(np.float16)


def _blank(source: Source, skeleton: str) -> Animation:
    """An animation to be made for a skeleton that has none."""
    path = free_path(Sdf.Path(skeleton), "Animation", source.stage.GetPrimAtPath)
    return Animation(str(path), path.name, (), {})


def _number(item: Property) -> Any:
    """The type of the numbers of an array."""
    return (item.default if item.default is not None and not len(item.times) else item.samples).dtype.type


def _resampled(item: Property, times: Floats) -> Floats:
    """The values of an array at other times, (k, j, c): its own samples to the bit."""
    if not len(item.times):
        assert item.default is not None  # a property has samples, a default or both
        return np.repeat(item.default[np.newaxis].astype(np.float64), len(times), axis=0)
    found = np.empty((len(times), *item.samples.shape[1:]))
    old = item.samples.astype(np.float64)
    path: Path = "rotation" if old.shape[2] == 4 else "translation"
    for column in range(old.shape[1]):
        track = Track(-1, path, "LINEAR", item.times, old[:, column], raw=True)
        found[:, column] = _exactly(track, times)
    return found


def _exactly(track: Track, times: Floats) -> Floats:
    """The values of a track, (k, c), its keys' own to the bit and the sign of a quaternion."""
    values = sample(track, times)
    at = np.clip(np.searchsorted(track.times, times), 0, len(track.times) - 1)
    own = track.times[at] == times
    values[own] = track.values[at[own]]
    return values


def _aligned(source: Source, prepared: Source, rig: Rig, planned: Mapping[str, Tracks]) -> Iterator[Clip]:
    """The clips of a rig with the tracks of the prepared source."""
    known = {clip.key: clip for clip in rig.clips}
    before = {clip.key: clip for clip in source.rig.clips}
    # A track that is as it was read is the one that is read now, so that no pass writes it again.
    read = {(c.key, t.node, t.path, t.key): t for c in prepared.rig.clips for t in c.tracks}
    again = {id(t): read.get((c.key, t.node, t.path, t.key), t) for c in source.rig.clips for t in c.tracks}
    # Also in clips of other animations, which play at the same time: a joint has one place for its keys.
    fresh = {key for one in planned.values() for key, t in one.items() if t.key is None}
    fresh |= {key for one in planned for key, t in _defaults(rig, one).items() if t.key is None}
    for shown in prepared.rig.clips:
        clip = known.get(shown.key, replace(shown, tracks=()))
        path = parts(shown.key)[1]
        if clip is before.get(shown.key) and path not in planned:
            yield shown
            continue
        stay = (t for t in clip.tracks if t.key is not None or (t.node, t.path) not in fresh)
        kept = tuple(again.get(id(t), t) for t in stay)
        if path not in planned:
            yield replace(clip, tracks=kept)
            continue
        joints = {(t.node, t.path) for t in shown.tracks if t.path != "weights"}
        others = tuple(t for t in kept if (t.node, t.path) not in joints)
        old = before.get(shown.key)
        was = {} if old is None else {(t.node, t.path): t for t in old.tracks}
        mine = _defaults(rig, path)
        if parts(shown.key)[0] == "samples":
            mine = {**{key: track for key, track in mine.items() if key not in was}, **planned[path]}
        joined = (t for t in shown.tracks if t.path != "weights" and t.node not in rig.pending.removed)
        tracks = [_retimed_track(t, mine, was, rig) for t in joined]
        yield replace(clip, tracks=(*tracks, *others), idle=shown.idle)


def _retimed_track(shown: Track, tracks: Tracks, was: Tracks, rig: Rig) -> Track:
    """A track of the prepared source with the values of the rig at its times."""
    own, old = tracks.get((shown.node, shown.path)), was.get((shown.node, shown.path))
    if own is None:
        return resting(shown, rig)
    if own is old:
        return shown
    if shown.key == HELD or len(shown.times) == len(own.times) == 1:
        return replace(own, key=shown.key, times=shown.times)
    return replace(shown, values=_exactly(without_steps(own), shown.times))
