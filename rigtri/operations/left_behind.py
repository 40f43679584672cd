"""What an edit leaves where what it follows has been, measured: a bake moves it there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.options.bake import BETWEEN
from rigtri.report import Report
from rigtri.text import list_names

if TYPE_CHECKING:
    from rigtri.evaluation.timelines import Timeline
    from rigtri.operations.follower_places import Follower, Look

# Shares of the size, or radians: a hundredth of what bakes leave between keys.
_ON_PLACE = 1e-5
# Edits that write keys in other axes move by so much what thinned keys leave between them.
_AGAIN = 2.0
# What thinned keys leave is beside a key, too: so many keys to either side.
_BESIDE = 2
# The warning that names them.
BEHIND = "followers-behind"
_KINDS = ("constraint", "poseReader", "rivet", "twist")
_inside: ContextVar[bool] = ContextVar("inside another operation", default=False)


def naming_left_behind(run: Callable[..., Rig]) -> Callable[..., Rig]:
    """An operation that warns of followers which were on their places before it, and are not after it.

    Of operations within another one the outer one alone warns, and of those of one edit its end.
    """

    def named(rig: Rig, *others: Rig, report: Report, **words: object) -> Rig:
        if _inside.get() or not rig.nodes_of(*_KINDS):
            return run(rig, *others, report=report, **words)
        token = _inside.set(True)
        try:
            made = run(rig, *others, report=report, **words)
        finally:
            _inside.reset(token)
        if made is not rig:
            found, whole = list(_left(rig, made)), _whole.get()
            if whole is None:
                _warn(_named(made, found), report)
            else:
                whole.after(rig, made, found)
        return made

    return named


@dataclass(frozen=True)
class _Behind:
    """A follower that an edit has left behind. keeper, node: as it has. clip: None at rest.

    allowed: how far it may be off, of which what was off before makes much. time: of the worst key of the
    clip. keyed: it has keys of its own there.
    """

    keeper: int
    node: int
    clip: str | None
    far: float
    allowed: float
    time: float = 0.0
    keyed: bool = False


def _left(before: Rig, rig: Rig) -> Iterator[_Behind]:
    """The followers that are further off their places than before, at rest and in each clip."""
    # With the solvers of all that follows, which most files have not.
    from rigtri.evaluation.timelines import timelines
    from rigtri.operations.follower_places import (
        Look,
        changed_times,
        changed_tracks,
        followers,
        keys_of,
        off_at_rest,
    )

    if not (known := {(each.keeper, each.node): each for each in followers(before)}):
        return
    of, kept, keeps = _counterparts(before, rig), _Kept(before), _Kept(rig)
    pairs = list[_Pair]()
    for each in followers(rig):
        old = known.get((of.get(each.keeper, -1), of.get(each.node, -1)))
        if old is not None:
            pairs.append(_Pair(old, each, _is_other(kept, old, keeps, each, of)))
    changed = [pair for pair in pairs if pair.other]
    here = off_at_rest(rig, [pair.now for pair in changed])
    there = off_at_rest(before, [pair.was for pair in changed])
    for pair, now, was in zip(changed, here.tolist(), there.tolist(), strict=True):
        if now > (allowed := max(_ON_PLACE, _AGAIN * was)):
            yield _Behind(pair.now.keeper, pair.now.node, None, now, allowed)
    clips, earlier = _same_clips(before, rig), timelines(before) if pairs else []
    shown = list[_Shown]()
    for timeline in timelines(rig) if pairs else ():
        mine = {clips[k] for k in timeline.members if k in clips}
        old_one = next((each for each in earlier if not mine.isdisjoint(each.members)), None)
        moved = changed_tracks(old_one, timeline, of)
        some = [p for p in pairs if p.other or moved is None or not p.now.needs.isdisjoint(moved)]
        keyed = [(pair, keys) for pair in some if len(keys := keys_of(timeline, pair.now))]
        if keyed:
            changed_keys = partial(changed_times, moved or {})
            look = Look(timeline, [p.now for p, _ in keyed], [keys for _, keys in keyed], also=changed_keys)
            shown.append(_Shown(look, [pair.was for pair, _ in keyed], old_one))
    yield from _left_in_clips(before, rig, shown)


@dataclass(frozen=True, eq=False)
class _Shown:
    """Where to look at followers, as they were, (k,), and the same clip before; None where it is new."""

    look: Look
    were: Sequence[Follower]
    earlier: Timeline | None


def _left_in_clips(before: Rig, rig: Rig, shown: Sequence[_Shown]) -> Iterator[_Behind]:
    """Those that are behind at keys of clips."""
    from rigtri.operations.follower_places import Look, keys_of, off_in_clips

    looks, places = list[Look](), list[list[tuple[int, int]]]()
    found = [*off_in_clips(rig, [one.look for one in shown])]
    # Where nothing moved before nothing was there that could be better.
    allowed = {
        (number, k): np.full(len(times), BETWEEN)
        for number, (times, here) in enumerate(found)
        for k in np.flatnonzero((here > _ON_PLACE).any(axis=1)).tolist()
    }
    groups: dict[tuple[int, bool], list[tuple[int, Floats]]] = {}
    for number, k in allowed:
        one = shown[number]
        keys = keys_of(one.earlier, one.were[k]) if one.earlier is not None else np.zeros(0)
        if len(keys):
            groups.setdefault((number, np.array_equal(keys, one.look.keys[k])), []).append((k, keys))
    for (number, same), some in groups.items():
        one, (times, _) = shown[number], found[number]
        if one.earlier is not None:
            were, keyed = [one.were[k] for k, _ in some], [keys for _, keys in some]
            looks.append(Look(one.earlier, were, keyed, times if same else None))
            places.append([(number, k) for k, _ in some])
    for both, look, (_, rows) in zip(places, looks, off_in_clips(before, looks), strict=True):
        for each, was, keys in zip(both, rows, look.keys, strict=True):
            # Where no key was before is what a bake leaves between keys.
            worst, old = _AGAIN * was.max(initial=0.0), np.isin(found[each[0]][0], keys)
            among = np.where(old, worst, max(worst, BETWEEN))
            allowed[each] = among if look.times is None else _allowed(was)
    for (number, k), most in allowed.items():
        look, bound = shown[number].look, np.maximum(_ON_PLACE, most)
        over = np.where(found[number][1][k] > bound, found[number][1][k], 0.0)
        at = int(np.argmax(over))
        if over[at] > 0:
            left = look.known[k]
            clip, time = look.timeline.name, float(found[number][0][at])
            has_keys = not left.own or not look.timeline.clip.nodes.isdisjoint(left.own)
            yield _Behind(left.keeper, left.node, clip, float(over[at]), float(bound[at]), time, has_keys)


def _allowed(was: Floats) -> Floats:
    """How far off a follower may be at keys where it was off by so much, (f,).

    In a clip that was baked what was left at one key may come to another; else each key has what was off
    there and beside it.
    """
    most = float(was.max(initial=0.0))
    if most <= BETWEEN:
        return np.full(len(was), _AGAIN * most)
    around = np.pad(np.maximum(was, BETWEEN), _BESIDE)
    beside = [around[k : k + len(was)] for k in range(2 * _BESIDE + 1)]
    return np.asarray(_AGAIN * np.max(np.stack(beside), axis=0))


def _named(rig: Rig, found: Iterable[_Behind]) -> dict[tuple[str, str], list[_Behind]]:
    """What was left behind, by the titles of keeper and follower."""
    named: dict[tuple[str, str], list[_Behind]] = {}
    for one in sorted(found, key=lambda one: one.node):
        named.setdefault((rig.title(one.keeper), rig.title(one.node)), []).append(one)
    return named


def _warn(found: Mapping[tuple[str, str], Sequence[_Behind]], report: Report) -> None:
    names = dict.fromkeys(name for _, name in found)
    keyed = {name for (_, name), where in found.items() if any(one.keyed for one in where)}
    moving = {name for (_, name), where in found.items() if any(one.clip is not None for one in where)}
    _warn_of(
        [n for n in names if n in keyed], report, "The keys of {} still follow the old motion: update them"
    )
    for when, some in {"In clips": moving - keyed, "At rest": names.keys() - moving}.items():
        stay = (
            "stays behind what it follows: put it"
            if len(some) == 1
            else "stay behind what they follow: put them"
        )
        _warn_of([n for n in names if n in some], report, f"{when}, {{}} {stay} there")


def _warn_of(names: Sequence[str], report: Report, text: str) -> None:
    if names:
        report.warn(BEHIND, f"{text.format(list_names(names))} with rigtri bake", names=names)


class LeftBehind:
    """What the operations of one edit have left behind so far: `warn` says at its end what still is.

    Each may bring back what one before it has left, as `bake` does, and a file may be written between two.
    """

    def __init__(self) -> None:
        self._found: dict[tuple[str, str], list[_Behind]] = {}
        self._edits = 0

    @contextmanager
    def noting(self) -> Iterator[None]:
        """Note what operations leave behind, instead of warning of each."""
        token = _whole.set(self)
        try:
            yield
        finally:
            _whole.reset(token)

    def after(self, before: Rig, rig: Rig, found: Iterable[_Behind]) -> None:
        """Note what an operation has left."""
        now = _counterparts(before, rig) if self._found else {}
        titles = {before.title(was): rig.title(node) for node, was in now.items()}
        kept = {
            (titles[keeper], titles[node]): where
            for (keeper, node), where in self._found.items()
            if keeper in titles and node in titles
        }
        for both, where in _named(rig, found).items():
            kept[both] = [*kept.get(both, ()), *where]
        self._found, self._edits = kept, self._edits + 1

    def warn(self, rig: Rig, report: Report) -> None:
        """Warn of what is still behind in the rig that all have made."""
        _warn(self._still(rig) if self._found and self._edits > 1 else self._found, report)

    def _still(self, rig: Rig) -> dict[tuple[str, str], list[_Behind]]:
        from rigtri.evaluation.timelines import timelines
        from rigtri.operations.follower_places import Look, followers, keys_of, off_at_rest, off_in_clips

        every = {(rig.title(each.keeper), rig.title(each.node)): each for each in followers(rig)}
        known = {both: every[both] for both in self._found if both in every}
        resting = off_at_rest(rig, [*known.values()]).tolist()
        far: dict[tuple[object, str | None], float] = dict(
            zip([(both, None) for both in known], resting, strict=True)
        )
        looks, titles = list[Look](), list[list[tuple[str, str]]]()
        for timeline in timelines(rig):
            keyed = {both: keys for both, each in known.items() if len(keys := keys_of(timeline, each))}
            if keyed:
                worst = [b.time for both in keyed for b in self._found[both] if b.clip == timeline.name]
                shown, also = [known[both] for both in keyed], partial(np.unique, worst)
                looks.append(Look(timeline, shown, [*keyed.values()], also=also))
                titles.append([*keyed])
        for some, look, (_, rows) in zip(titles, looks, off_in_clips(rig, looks), strict=True):
            for both, row in zip(some, rows, strict=True):
                at = both, look.timeline.name
                far[at] = max(far.get(at, 0.0), float(row.max(initial=0.0)))
        still: dict[tuple[str, str], list[_Behind]] = {}
        for both, where in self._found.items():
            # What a bake leaves is no more than it may leave.
            left = [
                one
                for one in where
                if far.get((both, one.clip), 0.0) > max(one.allowed, min(BETWEEN, one.far / 2))
            ]
            if left:
                still[both] = left
        return still


def warning_once(step: Callable[[Rig, Report], Rig]) -> Callable[[Rig, Report], Rig]:
    """A step that warns at its end of what its operations have left behind, where nothing around it does."""

    def run(rig: Rig, report: Report) -> Rig:
        if _whole.get() is not None:
            return step(rig, report)
        whole = LeftBehind()
        with whole.noting():
            made = step(rig, report)
        whole.warn(made, report)
        return made

    return run


_whole: ContextVar[LeftBehind | None] = ContextVar("what one edit leaves behind", default=None)


def _counterparts(before: Rig, rig: Rig) -> dict[int, int]:
    """The nodes of a rig that were there before, each with what it was."""
    keys = {key: node for node, key in enumerate(before.keys) if key is not None}
    # What is of no file yet keeps its name, or its place.
    names = {name: node for node, name in enumerate(before.names) if before.keys[node] is None}
    found = {}
    for node, key in enumerate(rig.keys):
        was = keys.get(key) if key is not None else names.get(rig.names[node])
        if was is None and key is None and node < len(before) and before.keys[node] is None:
            was = node
        if was is not None:
            found[node] = was
    return found


def _same_clips(before: Rig, rig: Rig) -> dict[int, int]:
    """The clips of a rig that were there before, each with what it was: by their keys, new ones by name."""
    keys = {clip.key: number for number, clip in enumerate(before.clips) if clip.key is not None}
    names = {clip.name: number for number, clip in reversed([*enumerate(before.clips)])}
    found = {}
    for number, clip in enumerate(rig.clips):
        was = keys.get(clip.key) if clip.key is not None else names.get(clip.name)
        if was is not None:
            found[number] = was
    return found


@dataclass(frozen=True, eq=False)
class _Pair:
    """A follower before and after an edit. other: something that its place is made of, but for keys, is."""

    was: Follower
    now: Follower
    other: bool


def _is_other(before: _Kept, was: Follower, now: _Kept, after: Follower, of: Mapping[int, int]) -> bool:
    """Whether anything that a follower's place is made of, but for keys, is not what it was."""
    if now.rig.pending.changes_weights or {of.get(node, -1) for node in after.needs} != was.needs:
        return True
    stored = before.rig.metadata.get(was.keeper), now.rig.metadata.get(after.keeper)
    if not _are_same(before.rig, stored[0], now.rig, stored[1], of):
        return True
    return any(before.rest[of[node]] != now.rest[node] for node in after.needs)


def _are_same(before: Rig, was: Any, rig: Rig, now: Any, of: Mapping[int, int]) -> bool:
    """Whether metadata say the same, also where nodes that they name have other names."""
    if type(was) is not type(now) or was == now:
        return type(was) is type(now)
    if isinstance(was, str):
        old, new = before.known(was), rig.known(now)
        return old is not None and new is not None and of.get(new) == old
    if isinstance(was, dict):
        return was.keys() == now.keys() and all(_are_same(before, was[k], rig, now[k], of) for k in was)
    if isinstance(was, list | tuple) and len(was) == len(now):
        return all(_are_same(before, a, rig, b, of) for a, b in zip(was, now, strict=True))
    return False


@dataclass(frozen=True, eq=False)
class _Kept:
    """A rig, and what decides where its nodes are."""

    rig: Rig

    @cached_property
    def rest(self) -> list[bytes]:
        """How each node rests, as files keep it."""
        return [row.tobytes() for row in self.rig.local.astype(np.float32)]
