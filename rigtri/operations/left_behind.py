"""What an edit leaves where what it follows has been, measured: a bake moves it there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextvars import ContextVar
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.report import Report
from rigtri.text import list_names

if TYPE_CHECKING:
    from rigtri.operations.follower_places import Follower

# Shares of the size, or radians: a tenth of what bakes leave between keys.
_ON_PLACE = 1e-5
# Edits that write keys in other axes move by so much what thinned keys leave between them.
_AGAIN = 2.0
_KINDS = ("constraint", "poseReader", "rivet", "twist")
_inside: ContextVar[bool] = ContextVar("inside another operation", default=False)


def naming_left_behind(run: Callable[..., Rig]) -> Callable[..., Rig]:
    """An operation that warns of followers which were on their places before it, and are not after it.

    Of operations within another one the outer one alone tells.
    """

    def named(rig: Rig, *others: Rig, report: Report, **words: object) -> Rig:
        if _inside.get() or not rig.nodes_of(*_KINDS):
            return run(rig, *others, report=report, **words)
        token = _inside.set(True)
        try:
            made = run(rig, *others, report=report, **words)
        finally:
            _inside.reset(token)
        _warn(rig, made, report)
        return made

    return named


def _warn(before: Rig, rig: Rig, report: Report) -> None:
    # With the solvers of all that follows, which most files have not.
    from rigtri.operations.follower_places import followers, worst

    if before is rig or not (known := {each.keeper: each for each in followers(before)}):
        return
    of, kept, keeps = _counterparts(before, rig), _Kept(before), _Kept(rig)
    was, now = list["Follower"](), list["Follower"]()
    for each in followers(rig):
        old = known.get(of.get(each.keeper, -1))
        if old is not None and _changed(kept, old, keeps, each, of):
            was.append(old)
            now.append(each)
    here = worst(rig, now)
    far = np.flatnonzero((here > _ON_PLACE).any(axis=0))
    # What had not been baked is no worse off.
    there = worst(before, [was[k] for k in far])
    left = here[:, far] > np.maximum(_ON_PLACE, _AGAIN * there)
    resting, moving = ([now[k].node for k in far[row]] for row in left)
    if moving:
        _tell(rig, moving, report, "The keys of {} still follow the old motion: update them with rigtri bake")
    if rest := [node for node in resting if node not in moving]:
        text = "At rest, {} stay behind what they follow: put them there with rigtri bake"
        _tell(rig, rest, report, text)


def _tell(rig: Rig, nodes: Iterable[int], report: Report, text: str) -> None:
    names = list(dict.fromkeys(rig.title(node) for node in sorted(nodes)))
    report.warn("followers-behind", text.format(list_names(names)), names=names)


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


def _changed(before: _Kept, was: Follower, now: _Kept, after: Follower, of: Mapping[int, int]) -> bool:
    """Whether anything that a follower's place is made of is not what it was."""
    if now.rig.pending.changes_weights or {of.get(node, -1) for node in after.needs} != was.needs:
        return True
    stored = before.rig.metadata.get(was.keeper), now.rig.metadata.get(after.keeper)
    if not _are_same(before.rig, stored[0], now.rig, stored[1], of):
        return True
    return any(before.states[of[node]] != now.states[node] for node in after.needs)


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
    def states(self) -> list[tuple[object, ...]]:
        """How each node rests, as files keep it, and the keys that it has."""
        found: list[tuple[object, ...]] = [(row.tobytes(),) for row in self.rig.local.astype(np.float32)]
        for number, clip in enumerate(self.rig.clips):
            for track in clip.tracks:
                keys = number, track.path, id(track.times), id(track.values)
                found[track.node] = (*found[track.node], keys)
        return found
