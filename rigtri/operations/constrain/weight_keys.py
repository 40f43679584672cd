"""Keys of the weights of drivers in clips: those that options ask for, and those that a rig has."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from rigtri.errors import RigtriError, UsageError
from rigtri.evaluation.sampling import sample
from rigtri.evaluation.timelines import (
    Timeline,
    as_float32,
    chosen_timelines,
    timeline_and_time,
    timelines,
    times_within,
)
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Interpolation
from rigtri.model.constraints import Constraint
from rigtri.model.dataclass import dataclass
from rigtri.model.rig import Rig
from rigtri.operations.options.constrain import ConstrainOptions, check_weight

# By so much a time may be rounded, in seconds.
_MISSED = 1e-4
_LETTERS = {"t": "translation", "s": "scale"}


@dataclass(frozen=True, eq=False)
class WeightKeys:
    """The weights of all drivers in a clip. times: (k,), increasing. weights: (k, d)."""

    timeline: Timeline
    times: Floats
    weights: Floats
    interpolation: Interpolation

    def starts(self, row: int, rest: Floats) -> list[int]:
        """The drivers that begin to count at a key; rest: (d,), the weights at rest, before the first key.

        Where weights move between keys that is the last one at which a driver's weight is 0.
        """
        steps = np.vstack([rest, self.weights])
        pairs = [steps[row : row + 2]] if row == 0 or self.interpolation == "STEP" else []
        if self.interpolation != "STEP" and row < len(self.times) - 1:
            pairs.append(steps[row + 1 : row + 3])
        found = {k for before, after in pairs for k in np.flatnonzero((before <= 0) & (after > 0)).tolist()}
        return sorted(found)


def requested_keys(
    rig: Rig, rule: Constraint, words: Sequence[str], options: ConstrainOptions
) -> list[WeightKeys]:
    """The keys that options ask for. words: what the user calls the drivers.

    Raises UsageError, NameNotFoundError (a clip).
    """
    found: list[WeightKeys] = []
    found += _from_file(rig, words, options.weight_keys) if options.weight_keys is not None else []
    found += _from_switches(rig, rule, words, options.switch)
    found += _from_channels(rig, rule, words, options.weight_from)
    homes = [keys.timeline.members for keys in found]
    for keys in found:
        _check_range(keys)
        if homes.count(keys.timeline.members) > 1:
            raise UsageError(f"clip '{keys.timeline.name}' gets weights from more than one option; give one")
    return found


def _check_range(keys: WeightKeys) -> None:
    """UsageError for keys outside of their clip, which would make it longer."""
    first, last = times_within(keys.timeline, None)[[0, -1]].tolist()
    outside = [time for time in keys.times.tolist() if not first - _MISSED <= time <= last + _MISSED]
    if outside:
        raise UsageError(
            f"clip '{keys.timeline.name}' runs from {first:.6g} to {last:.6g}: it has no time "
            f"{outside[0]:.6g} at which a weight could change"
        )


def _from_file(rig: Rig, words: Sequence[str], content: Any) -> Iterator[WeightKeys]:
    """The clips of a file: ``{CLIP: {"times": […], DRIVER: […], …, "interpolation": "STEP"}}``, or rows."""
    content = _of_rows(content) if isinstance(content, list) else content
    if not isinstance(content, Mapping) or not content:
        raise UsageError('--weight-keys: give {"CLIP": {"times": [0, 1], "DRIVER": [1, 0], …}}')
    for clip, curves in content.items():
        (timeline,) = chosen_timelines(rig, [clip])[:1]
        yield _curves(timeline, words, curves)


def _of_rows(rows: Sequence[Any]) -> dict[str, dict[str, Any]]:
    """The clips of a table: a row for each key, with its clip, its time and the weight of each driver."""
    clips: dict[str, dict[str, Any]] = {}
    for number, row in enumerate(rows, 1):
        where = f"--weight-keys, row {number}"
        if not isinstance(row, Mapping) or not (row.get("clip") and row.get("time")):
            raise UsageError(f"{where}: give clip and time; the columns are clip, time, a driver each …")
        own = clips.setdefault(str(row["clip"]), {"times": []})
        for column, text in row.items():
            if column in ("clip", "interpolation") or not column:
                continue
            try:
                own.setdefault("times" if column == "time" else column, []).append(float(text))
            except (TypeError, ValueError):
                raise UsageError(f"{where}: {column} '{text or ''}' is not a number") from None
        own |= {"interpolation": row["interpolation"]} if row.get("interpolation") else {}
    return clips


def _curves(timeline: Timeline, words: Sequence[str], curves: Any) -> WeightKeys:
    where = f"--weight-keys, clip '{timeline.name}'"
    if not isinstance(curves, Mapping) or "times" not in curves:
        raise UsageError(f'{where}: give "times" and a list of weights for each driver')
    own = dict(curves)
    times, way = _numbers(f"{where}: times", own.pop("times")), own.pop("interpolation", "STEP")
    if way not in ("STEP", "LINEAR"):
        raise UsageError(f"{where}: interpolation '{way}' is not valid: use STEP or LINEAR")
    if not len(times) or (np.diff(as_float32(times)) <= 0).any():
        raise UsageError(f"{where}: times rise from key to key; these do not")
    weights = np.zeros((len(times), len(words)))
    for word, values in own.items():
        column = _number_of(words, word, f"{where}: '{word}'")
        weights[:, column] = _numbers(f"{where}: '{word}'", values, len(times))
        check_weight(word, float(weights[:, column].min()))
    if not weights.any():
        raise UsageError(f"{where}: every weight is 0, so that no driver ever counts; give one more than 0")
    return WeightKeys(timeline, as_float32(times), weights, way)


def _numbers(where: str, values: Any, count: int | None = None) -> Floats:
    fine = isinstance(values, list) and all(
        isinstance(v, int | float) and not isinstance(v, bool) for v in values
    )
    if not fine or (count is not None and len(values) != count) or not np.isfinite(values).all():
        raise UsageError(f"{where}: give a list of {'' if count is None else f'{count} '}numbers")
    return np.array(values, dtype=np.float64)


def _number_of(words: Sequence[str], word: str, where: str) -> int:
    place = _index(words, word)
    if place is None:
        raise UsageError(f"{where} is not one of the drivers: {', '.join(words)}")
    return place


def _index(words: Sequence[str], name: str) -> int | None:
    """The number of the driver or space called so, None for none; world and root have any case."""
    if name not in words and name.lower() in ("world", "root"):
        name = name.lower()
    return words.index(name) if name in words else None


def _from_switches(
    rig: Rig, rule: Constraint, words: Sequence[str], texts: Collection[str]
) -> Iterator[WeightKeys]:
    """Weights that are held: at the start those at rest, from each switch on one driver alone."""
    found: dict[tuple[int, ...], tuple[Timeline, dict[float, int]]] = {}
    for text in texts:
        # Names may hold = themselves.
        ends = [k for k, letter in enumerate(text) if letter == "="]
        cuts = [(k, place) for k in ends if (place := _index(words, text[k + 1 :])) is not None]
        if not cuts:
            raise UsageError(f"--switch {text}: give CLIP@TIME=NODE, NODE one of {', '.join(words)}")
        try:
            timeline, time = timeline_and_time(rig, text[: cuts[0][0]])
        except RigtriError as error:
            raise type(error)(f"--switch: {error}") if isinstance(error, UsageError) else error from None
        if timeline is None:
            raise UsageError(f"--switch {text}: at rest the first driver counts, or --driver NODE=WEIGHT")
        _, own = found.setdefault(timeline.members, (timeline, {}))
        own[float(as_float32(np.array([time]))[0])] = cuts[0][1]
    for timeline, switches in found.values():
        start = float(times_within(timeline, None)[0])
        times = sorted({min(start, *switches), *switches})
        weights = np.array(
            [np.eye(len(words))[switches[t]] if t in switches else rule.weights for t in times]
        )
        yield WeightKeys(timeline, np.array(times), weights, "STEP")


def _from_channels(
    rig: Rig, rule: Constraint, words: Sequence[str], texts: Collection[str]
) -> Iterator[WeightKeys]:
    """Weights as channels of nodes have them; the first driver without such gets what they leave of 1."""
    if not texts:
        return
    sources: dict[int, tuple[int, str, int]] = {}
    for text in texts:
        place, node, path, k = _channel(rig, words, text)
        sources[place] = (node, path, k)
    for timeline in timelines(rig):
        tracks = {
            column: (track, k)
            for column, (node, path, k) in sources.items()
            for track in timeline.clip.tracks
            if (track.node, track.path) == (node, path)
        }
        if not tracks:
            continue
        every = [track for track, _ in tracks.values()]
        times = np.unique(np.concatenate([track.times for track in every]))
        weights = np.broadcast_to(rule.weights, (len(times), len(words))).copy()
        for column, (node, path, k) in sources.items():
            still = getattr(rig, path)[node][k]
            values = sample(tracks[column][0], times)[:, k] if column in tracks else still
            weights[:, column] = np.maximum(values, 0.0)
        rest = next((column for column in range(len(words)) if column not in sources), None)
        if rest is not None:
            weights[:, rest] = np.maximum(1.0 - sum(weights[:, column] for column in sources), 0.0)
        held = all(track.interpolation == "STEP" for track in every)
        yield WeightKeys(timeline, times, weights, "STEP" if held else "LINEAR")


def _channel(rig: Rig, words: Sequence[str], text: str) -> tuple[int, int, str, int]:
    """What ``DRIVER=NODE.tx`` names: the number of the driver, the node, the path, the component."""
    ends = [k for k, letter in enumerate(text) if letter == "="]
    end, place = next(((k, place) for k in ends if (place := _index(words, text[:k])) is not None), (0, None))
    name, dot, channel = text.rpartition(".")
    channel = channel.lower()
    if place is None or not dot or len(channel) != 2 or channel[0] not in "ts" or channel[1] not in "xyz":
        raise UsageError(
            f"--weight-from {text}: give DRIVER=NODE.CHANNEL, DRIVER one of {', '.join(words)} and CHANNEL "
            "one of tx, ty, tz, sx, sy, sz"
        )
    node = rig.find(name[end + 1 :], "node")
    return place, node, _LETTERS[channel[0]], "xyz".index(channel[1])


def stored_keys(rig: Rig, rule: Constraint, drivers: Sequence[int]) -> list[WeightKeys]:
    """The keys that the weight nodes of a constraint have, of each of its drivers together."""
    found = []
    for timeline in timelines(rig):
        tracks = {
            track.node: track
            for track in timeline.clip.tracks
            if track.path == "translation" and track.node in rule.weight_nodes
        }
        if not tracks:
            continue
        times = np.unique(np.concatenate([track.times for track in tracks.values()]))
        weights = np.zeros((len(times), len(drivers)))
        for driver, node in zip(rule.drivers, rule.weight_nodes, strict=True):
            own = sample(tracks[node], times)[:, 0] if node in tracks else rig.translation[node, 0]
            if driver in drivers:
                weights[:, drivers.index(driver)] += np.maximum(own, 0.0)
        held = all(track.interpolation == "STEP" for track in tracks.values())
        found.append(WeightKeys(timeline, times, weights, "STEP" if held else "LINEAR"))
    return found
