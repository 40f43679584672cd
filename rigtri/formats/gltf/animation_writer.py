"""Inverse bind matrices and animations, changed in a draft where a rig differs.

What several users of an accessor or sampler want alike they go on sharing; who
wants something else gets its own.

Source: glTF 2.0 §3.7.3, §3.11; KHR_animation_pointer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.accessors import FLOAT, Accessors
from rigtri.formats.gltf.animation_channels import (
    channels_by_sampler,
    drive_node,
    driven_attachment,
    drop_channels,
    drop_empty_animations,
)
from rigtri.formats.gltf.buffer_writer import Role, Storage
from rigtri.formats.gltf.float32_rounding import Singles, round_tracks, to_singles
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.new_key_times import refuse_ties
from rigtri.maths.arrays import Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Column, Track, Tracks, other_rows
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}


class _NewOutput(NamedTuple):
    """New rows for a place that refers to an accessor, and how to let it refer to another one."""

    accessor: int | None
    rows: Singles
    kind: str
    role: Role
    refer: Callable[[int], None]


class ClipWriter:
    """Carries skins and clips of ``rig`` into a draft. index: file index of every node of the rig."""

    def __init__(
        self,
        draft: CopyOnWrite,
        storage: Storage,
        accessors: Accessors,
        source: Rig,
        rig: Rig,
        index: Sequence[int],
        moved: dict[int, int],
    ) -> None:
        self._draft, self._storage, self._accessors = draft, storage, accessors
        self._source, self._rig, self._index, self._moved = source, rig, index, moved
        self._wishes: list[_NewOutput] = []
        self._inputs: dict[int, int] = {}
        # Channels to be taken out, by animation; last, as until then they are found by their place.
        self._lost: dict[int, set[int]] = {}
        self._gone = False  # whether clips of the source are

    def write(self) -> None:
        """Put all differences into the draft and the storage."""
        count = len(self._source.skins)
        for skin, before in zip(self._rig.skins[:count], self._source.skins, strict=True):
            self._write_skin(skin, before)
        for skin in self._rig.skins[count:]:
            self._add_skin(skin)
        self._write_clips()
        self._grant()
        self._redirect()
        # They refer to this writer and it to them: all new keys would wait for the garbage collector.
        self._wishes.clear()
        for number, lost in self._lost.items():
            drop_channels(self._draft, number, lost)
        if self._gone:
            drop_empty_animations(self._draft)

    # --- skins

    def _write_skin(self, skin: Skin, before: Skin) -> None:
        if skin is before or np.array_equal(skin.inverse_bind, before.inverse_bind):
            return
        number, count = int(str(skin.key)), len(before.joints)
        if len(skin.joints) > count:
            self._grow_skin(number, skin, before)
            return
        if np.array_equal(skin.inverse_bind, before.inverse_bind[: len(skin.joints)]):
            self._cut_matrices(number, skin)
            return
        accessor = self._draft.gltf["skins"][number].get("inverseBindMatrices")
        rows = skin.inverse_bind.reshape(-1, 16)
        if accessor is not None:
            accessor = int(accessor)
            stored = self._accessors.read(accessor)
            # Rows behind the last joint mean nothing, but they were there.
            rows = np.concatenate([rows, stored[len(rows) :]])

        def refer(index: int) -> None:
            self._draft.edit("skins", number)["inverseBindMatrices"] = index

        self._wishes.append(_NewOutput(accessor, to_singles(rows), "MAT4", "inverse bind matrices", refer))

    def _cut_matrices(self, number: int, skin: Skin) -> None:
        """Joints of ours have gone, which came last: the matrices of before them are often there still."""
        accessor = self._draft.gltf["skins"][number].get("inverseBindMatrices")
        rows = to_singles(skin.inverse_bind.reshape(-1, 16))
        if accessor is None or not len(rows):
            return
        for index in range(len(self._accessors)):
            try:
                raw = self._accessors.value(index).object()
                if index == accessor or raw.get("type") != "MAT4" or raw.get("count", 0) < len(rows):
                    continue
                stored = self._accessors.read(index)[: len(rows)]
            except FileError:
                continue
            if np.array_equal(stored, rows):
                self._draft.edit("skins", number)["inverseBindMatrices"] = index
                return
        if self._storage.users[accessor] == 1:  # rows behind the last joint mean nothing
            self._draft.edit("accessors", accessor)["count"] = len(rows)

    def _grow_skin(self, number: int, skin: Skin, before: Skin) -> None:
        """New joints behind the last, so that the indices of meshes keep their meaning."""
        count = len(before.joints)
        self._draft.edit("skins", number, "joints").extend(self._nodes(skin.joints[count:]))
        self._lift_pivot(number, skin.joints[count:].tolist())
        redistributions = self._rig.pending.weight_redistributions
        weighted = any(self._rig.skins[redistribution.skin] is skin for redistribution in redistributions)
        if before.stored or weighted or not np.array_equal(skin.inverse_bind[:count], before.inverse_bind):
            like = self._draft.gltf["skins"][number].get("inverseBindMatrices")
            self._draft.edit("skins", number)["inverseBindMatrices"] = self._matrices(skin, like)

    def _lift_pivot(self, number: int, joints: Sequence[int]) -> None:
        """Let the pivot of a skin, which must be above all joints, be a new joint that is above it."""
        pivot = self._draft.gltf["skins"][number].get("skeleton")
        if pivot in self._index:
            above = self._rig.path_to_root(self._index.index(pivot))[1:]
            if tops := [joint for joint in joints if joint in above]:
                self._draft.edit("skins", number)["skeleton"] = self._index[tops[0]]

    def _add_skin(self, skin: Skin) -> None:
        added: dict[str, Any] = {"name": skin.name} if skin.name else {}
        added |= {"joints": self._nodes(skin.joints), "inverseBindMatrices": self._matrices(skin, None)}
        self._draft.need("skins", empty=[]).append(added)

    def _nodes(self, joints: Integers) -> list[int]:
        return [self._index[joint] for joint in joints.tolist()]

    def _matrices(self, skin: Skin, like: int | None) -> int:
        """A new accessor with a skin's inverse bind matrices; the old bytes stay where they are."""
        rows = to_singles(skin.inverse_bind.reshape(-1, 16))
        return self._storage.add(rows, "MAT4", "inverse bind matrices", like)

    # --- clips

    def _write_clips(self) -> None:
        before = {clip.key: clip for clip in self._source.clips}
        changed: list[tuple[Track, Track]] = []
        for clip in self._rig.clips:
            old = before.pop(clip.key, None) if clip.key is not None else None
            if clip is old:
                continue
            number = int(str(clip.key)) if old is not None else self._add_animation(clip)
            changed += self._compare(number, clip, old)
        self._gone = bool(before)
        for clip in before.values():
            self._lost[int(str(clip.key))] = {_place(track)[1] for track in clip.tracks}
        rows = round_tracks([now for now, _ in changed], [then for _, then in changed])
        outputs = {
            now.key: values.reshape(-1, 1) if now.path == "weights" else values
            for (now, _), values in zip(changed, rows, strict=True)
        }
        self._settle_samplers(outputs)

    def _compare(self, number: int, clip: Clip, old: Clip | None) -> list[tuple[Track, Track]]:
        """Tracks with other values, each with what it was; channels that move, come or go are noted."""
        mine, theirs = clip.columns, old.columns if old is not None else ()
        if old is not None and clip.name != old.name:
            self._draft.edit("animations", number)["name"] = clip.name
        pairs = self._alike(mine, theirs)
        rows = [
            (column.places[row], column.track(row), then.track(row))
            for column, then in pairs
            for row in np.flatnonzero(other_rows(column.stored, then.stored)).tolist()
        ]
        # New accessors come in the order of the channels.
        changed = [(track, before) for _, track, before in sorted(rows, key=itemgetter(0))]
        done = {id(column) for pair in pairs for column in pair}
        known = {track.key: track for track in Tracks(c for c in theirs if id(c) not in done)}
        for track in Tracks(column for column in mine if id(column) not in done):
            then = known.pop(track.key, None) if track.key is not None else None
            if track is then:
                continue
            if then is None:
                self._add_channel(number, track)
                continue
            if self._node_of(track, self._rig) != self._node_of(then, self._source):
                self._retarget(then, self._index[track.node])
            if track.interpolation != then.interpolation or not _same(track.times, then.times):
                self._retime(number, track)
            elif not _same(track.values, then.values):
                changed.append((track, then))
        if known:
            self._lost[number] = {_place(track)[1] for track in known.values()}
        return changed

    def _alike(self, mine: Sequence[Column], theirs: Sequence[Column]) -> list[tuple[Column, Column]]:
        """Columns and what they were, where all tracks are of the same channels, nodes and key times."""
        known = {(column.interpolation, *column.keys): column for column in theirs}
        pairs = [(column, known.get((column.interpolation, *column.keys))) for column in mine]
        return [
            (column, then)
            for column, then in pairs
            if then is not None
            and column.values.shape == then.values.shape
            and _same(column.times, then.times)
            and self._nodes_of(column, self._rig) == self._nodes_of(then, self._source)
        ]

    def _nodes_of(self, column: Column, rig: Rig) -> list[Any]:
        return [rig.keys[node] for node in column.nodes.tolist()]

    def _node_of(self, track: Track, rig: Rig) -> Any:
        return rig.keys[track.node]

    def _retarget(self, track: Track, node: int) -> None:
        number, channel = _place(track)
        target = self._draft.edit("animations", number, "channels", channel, "target")
        drive_node(self._draft, (number, channel), target, node)

    def _settle_samplers(self, outputs: dict[Any, Singles]) -> None:
        """New outputs for samplers; channels that share one and part ways get samplers of their own."""
        by_sampler: dict[tuple[int, int], list[tuple[int, Singles]]] = {}
        for (number, channel), rows in outputs.items():
            sampler = self._draft.gltf["animations"][number]["channels"][channel]["sampler"]
            by_sampler.setdefault((number, sampler), []).append((channel, rows))
        sharing = channels_by_sampler(
            self._draft.gltf.get("animations", []), {number for number, _ in by_sampler}
        )
        for (number, sampler), users in by_sampler.items():
            groups: dict[bytes, list[tuple[int, Singles]]] = {}
            for channel, rows in users:
                groups.setdefault(rows.tobytes() if len(users) > 1 else b"", []).append((channel, rows))
            # The old sampler stays with whoever wants its old values.
            old_values_used = sharing[number, sampler] > len(users)
            for place, group in enumerate(groups.values()):
                mine = sampler
                if old_values_used or place > 0:
                    mine = self._split(number, sampler, [channel for channel, _ in group])
                self._request_output(number, mine, group[0][1], fresh=mine != sampler)

    def _split(self, number: int, sampler: int, channels: list[int]) -> int:
        samplers = self._draft.edit("animations", number, "samplers")
        samplers.append(dict(samplers[sampler]))
        for channel in channels:
            self._draft.edit("animations", number, "channels", channel)["sampler"] = len(samplers) - 1
        return len(samplers) - 1

    def _request_output(self, number: int, sampler: int, rows: Singles, *, fresh: bool) -> None:
        output = self._draft.gltf["animations"][number]["samplers"][sampler]["output"]

        def refer(index: int) -> None:
            self._draft.edit("animations", number, "samplers", sampler)["output"] = index

        kind = KINDS[rows.shape[1]]
        wish = _NewOutput(output, rows, kind, "animation", refer)
        if fresh:
            refer(self._storage.add(rows, kind, "animation", output))
        else:
            self._wishes.append(wish)

    # --- accessors

    def _grant(self) -> None:
        """Write over an accessor that all its users want changed alike; else give new ones."""
        together: dict[int, list[_NewOutput]] = {}
        for wish in self._wishes:
            if wish.accessor is None:
                wish.refer(self._storage.add(wish.rows, wish.kind, wish.role))
            else:
                together.setdefault(wish.accessor, []).append(wish)
        changes: list[tuple[int, Singles]] = []
        for accessor, wishes in together.items():
            first = wishes[0]
            alone = self._storage.users[accessor] == len(wishes) and all(
                np.array_equal(wish.rows.view(np.uint32), first.rows.view(np.uint32)) for wish in wishes[1:]
            )
            if alone and accessor in self._storage.free:
                changes.append((accessor, first.rows))
            else:
                for wish in wishes:
                    wish.refer(self._storage.add(wish.rows, wish.kind, wish.role, accessor))
        self._storage.replace(changes)

    # --- channels that move, come and go

    def _redirect(self) -> None:
        """Channels of morph weights follow a mesh that another node shows now, read or not."""
        if not self._moved:
            return
        for number, animation in enumerate(self._draft.gltf.get("animations", [])):
            for channel, raw in enumerate(animation.get("channels", [])):
                node = driven_attachment(raw)
                if node in self._moved:
                    target = self._draft.edit("animations", number, "channels", channel, "target")
                    drive_node(self._draft, (number, channel), target, self._moved[node])

    def _add_animation(self, clip: Clip) -> int:
        animations = self._draft.need("animations", empty=[])
        animations.append({**({"name": clip.name} if clip.name else {}), "samplers": [], "channels": []})
        return len(animations) - 1

    def _input(self, track: Track) -> int:
        """The accessor with the times of a new track: one that is there, or a new one."""
        if not self._inputs:
            for clip in self._source.clips:
                for known in clip.tracks:
                    animation, channel = _place(known)
                    raw = self._draft.gltf["animations"][animation]
                    sampler = raw["samplers"][raw["channels"][channel]["sampler"]]
                    self._inputs[id(known.times)] = sampler["input"]
        if id(track.times) not in self._inputs:
            rows = to_singles(track.times.reshape(-1, 1))
            refuse_ties(track, rows[:, 0], self._rig.title(track.node))
            self._inputs[id(track.times)] = self._keys(rows, "SCALAR", bounds=True)
        return self._inputs[id(track.times)]

    def _add_channel(self, number: int, track: Track) -> None:
        target = {"node": self._index[track.node], "path": track.path}
        channels = self._draft.need("animations", number, "channels", empty=[])
        channels.append({"sampler": self._add_sampler(number, track), "target": target})

    def _retime(self, number: int, track: Track) -> None:
        """Give a channel other key times or another interpolation, in a sampler of its own."""
        channel = _place(track)[1]
        old = self._draft.gltf["animations"][number]["channels"][channel]["sampler"]
        if (
            channels_by_sampler(self._draft.gltf["animations"], {number})[number, old] == 1
        ):  # nobody else wants it
            before, now = self._draft.gltf["animations"][number]["samplers"][old], self._sampler(track)
            if "interpolation" not in before and (now["interpolation"] == "LINEAR" or len(track.times) == 1):
                now.pop("interpolation")  # one key holds either way
            self._draft.edit("animations", number, "samplers")[old] = {**before, **now}
            return
        sampler = self._add_sampler(number, track)
        self._draft.edit("animations", number, "channels", channel)["sampler"] = sampler

    def _add_sampler(self, number: int, track: Track) -> int:
        samplers = self._draft.need("animations", number, "samplers", empty=[])
        samplers.append(self._sampler(track))
        return len(samplers) - 1

    def _sampler(self, track: Track) -> dict[str, Any]:
        (rows,) = round_tracks([track], [track])
        rows = rows.reshape(-1, 1) if track.path == "weights" else rows
        return {
            "input": self._input(track),
            "output": self._keys(rows, KINDS[rows.shape[1]]),
            "interpolation": track.interpolation,
        }

    def _keys(self, rows: Singles, kind: str, *, bounds: bool = False) -> int:
        """An accessor with times or values; where keys are put back, the one that has them still."""
        for index in range(len(self._accessors)) if self._rig.pending.removed else ():
            try:
                raw = self._accessors.value(index).object()
                shape = raw.get("type"), raw.get("count"), raw.get("componentType")
                if shape != (kind, len(rows), FLOAT) or (bounds and "min" not in raw):
                    continue
                if np.array_equal(self._accessors.read(index).reshape(rows.shape), rows):
                    return index
            except FileError:
                continue
        return self._storage.add(rows, kind, "animation", bounds=bounds)


def _same(now: Floats, then: Floats) -> bool:
    if now is then or now.shape != then.shape or not now.size:
        return now is then or now.shape == then.shape
    # The first number differs in most.
    return now.item(0) == then.item(0) and bool((now == then).all())


def _place(track: Track) -> tuple[int, int]:
    """Animation and channel that a track was read from."""
    if not isinstance(track.key, tuple):
        raise ValueError("only a track that was read has a place in the file")
    number, channel = track.key
    return int(number), int(channel)
