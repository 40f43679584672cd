"""Animations: channels, samplers, times and keys.

Source: glTF 2.0 §3.11; KHR_animation_pointer.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from rigtri.formats.gltf.accessors import FLOAT, FULL
from rigtri.formats.gltf.animation_reader import pointer_of, target_of
from rigtri.formats.gltf.rules import (
    NON_UNIT,
    WIDTH,
    count_violation,
    interpolation_violation,
    node_violation,
    sampler_violation,
    time_violations,
    time_width_violation,
    twice_violation,
    value_width_violation,
    values_needed,
)
from rigtri.formats.json_values import short_repr
from rigtri.frames.nonuniform_scale import SAME_SCALE
from rigtri.maths.quaternions import norm
from rigtri.maths.trigonometry import Floats
from rigtri.verification.checks.gltf.tolerant_reader import View

# |dot| of two unit quaternions below this: closer to half a turn than float32 can resolve.
HALF_TURN = 1e-4


class Channel(NamedTuple):
    """One channel: what it drives, and where it stands."""

    node: int
    path: str
    place: str
    pointer: str


class Keys(NamedTuple):
    """The keys of a channel. values: (k, 1, width), or (k, 3, width) with tangents; times: (k,)."""

    channel: Channel
    where: str
    times: Floats
    values: Floats

    @property
    def cubic(self) -> bool:
        return bool(self.values.shape[1] == 3)


def check(view: View) -> None:
    """All animations."""
    checked_times: set[int] = set()
    for number, animation in enumerate(view.lists["animations"]):
        name, pointer = animation.get("name"), f"/animations/{number}"
        place = (
            f"animation '{name}' (#{number})" if isinstance(name, str) and name else f"animation #{number}"
        )
        samplers = view.objects(animation, "samplers", place, pointer)
        channels = view.objects(animation, "channels", place, pointer)
        if not channels:
            view.add("gltf.animation.empty", place, f"{pointer}/channels", "has no channels")
        seen: dict[tuple[int, str], int] = {}
        keyed: list[Keys] = []
        for k, raw in enumerate(channels):
            channel = _target(view, raw, f"{place}, channel {k}", f"{pointer}/channels/{k}")
            if channel is None:
                continue
            if (channel.node, channel.path) in seen:
                first = seen[channel.node, channel.path]
                violation = twice_violation(view.title(channel.node), channel.path, first)
                view.add_violation(violation, channel.place, channel.pointer)
            seen.setdefault((channel.node, channel.path), k)
            keyed += _check_sampler(view, raw, samplers, channel, checked_times)
        if not _sound(keyed):
            for keys in keyed:
                _check_keys(view, keys)


def _target(view: View, raw: dict[str, Any], place: str, pointer: str) -> Channel | None:
    """What a channel drives; None for what is no node of ours, which is noted where it is odd."""
    target = view.object(raw, "target", place, pointer)
    found = target_of(raw)
    if found is None:
        _note_other(view, target, place, pointer)
        return None
    if view.add_violation(node_violation(found[0], len(view.nodes)), place, f"{pointer}/target"):
        return None
    return Channel(found[0], found[1], f"{place} ({view.title(found[0])} {found[1]})", pointer)


def _note_other(view: View, target: dict[str, Any], place: str, pointer: str) -> None:
    path = target.get("path")
    if path == "pointer" and pointer_of(target) is not None:
        return  # a property of something else than a node: nothing of a rig
    if path not in (*WIDTH, "weights"):
        text = f"the path {short_repr(path)} is none that glTF knows"
        view.add("gltf.animation.path-unknown", place, f"{pointer}/target/path", text)
    elif "node" not in target:
        view.add("gltf.animation.without-node", place, f"{pointer}/target", "names no node")
    else:
        text = f"node should be a whole number, not {short_repr(target['node'])}"
        view.add("gltf.json.value", place, f"{pointer}/target/node", text)


def _check_sampler(
    view: View, raw: dict[str, Any], samplers: list[dict[str, Any]], channel: Channel, checked: set[int]
) -> list[Keys]:
    """Judge the sampler of a channel; returns its keys where there are as many as there should be."""
    place: str = channel.place
    number: Any = raw.get("sampler")
    if view.add_violation(sampler_violation(number, len(samplers)), place, f"{channel.pointer}/sampler"):
        return []
    where = f"{channel.pointer.rpartition('/channels/')[0]}/samplers/{number}"
    sampler = samplers[number]
    mode = sampler.get("interpolation", "LINEAR")
    view.add_violation(interpolation_violation(mode), place, f"{where}/interpolation")
    times = _times(view, sampler, place, where, checked)
    values = view.read(sampler.get("output"), place, f"{where}/output")
    if values is None:
        return []
    width = WIDTH.get(channel.path)
    violation = width and value_width_violation(channel.path, width, values.shape[1])
    if violation:
        view.add_violation(violation, place, f"{where}/output")
        return []
    _check_component(view, sampler["output"], channel, f"{where}/output")
    if times is None or not _count_fits(view, times, values, mode, channel, where) or width is None:
        return []
    per_key = 3 if mode == "CUBICSPLINE" else 1
    return [Keys(channel, f"{where}/output", times, values.reshape(len(times), per_key, width))]


def _check_component(view: View, raw: Any, channel: Channel, where: str) -> None:
    """Places and scales are floats; rotations and weights floats or normalised integers of 8 or 16 bits."""
    accessor = view.raw_accessor(raw)
    kind, normalized = accessor.get("componentType"), accessor.get("normalized") is True
    if kind == FLOAT or (channel.path in ("rotation", "weights") and kind in FULL and normalized):
        return
    expected = "floats" if channel.path in ("translation", "scale") else "floats or normalised integers"
    text = f"{channel.path} should be {expected}, its output has the component type {kind}"
    text += " (normalised)" if normalized else ""
    view.add("gltf.animation.output-type", channel.place, where, text)


def _times(view: View, sampler: dict[str, Any], place: str, where: str, checked: set[int]) -> Floats | None:
    """Key times, (k,); each accessor is judged once, however many samplers share it."""
    raw = sampler.get("input")
    numbers = view.read(raw, place, f"{where}/input")
    if numbers is None:
        return None
    if view.add_violation(time_width_violation(numbers.shape[1]), place, f"{where}/input"):
        return None
    kind = view.raw_accessor(raw).get("componentType")
    if kind != FLOAT:
        text = f"its times should be floats, and have the component type {kind}"
        view.add("gltf.animation.output-type", place, f"{where}/input", text)
    times = numbers[:, 0]
    if int(raw or 0) not in checked:
        checked.add(int(raw or 0))
        _check_times(view, times, place, f"{where}/input")
        accessor = view.raw_accessor(raw)
        if "min" not in accessor or "max" not in accessor:
            text = f"the times, accessor #{raw}, have no min and max"
            view.add("gltf.animation.times-without-bounds", place, f"/accessors/{raw}", text)
    return times


def _check_times(view: View, times: Floats, place: str, where: str) -> None:
    if np.isfinite(times).all() and times[0] < 0:
        view.add("gltf.animation.times-negative", place, where, f"the first key is at {times[0]:g} s")
    for violation in time_violations(times):
        view.add_violation(violation, place, where)


def _count_fits(view: View, times: Floats, values: Floats, mode: Any, channel: Channel, where: str) -> bool:
    violation = count_violation(len(times), len(values), mode)
    if channel.path == "weights" and len(values) and values.size % values_needed(len(times), mode) == 0:
        violation = None
    return not view.add_violation(violation, channel.place, f"{where}/output")


def _sound(keyed: list[Keys]) -> bool:
    """Whether nothing at all is wrong with some channels: one look at all keys together."""
    if not keyed:
        return True
    if not np.isfinite(np.concatenate([keys.values.ravel() for keys in keyed])).all():
        return False
    scales = [keys.values.reshape(-1, 3) for keys in keyed if keys.channel.path == "scale"]
    if scales and _uneven(np.concatenate(scales)).any():
        return False
    turns = [keys for keys in keyed if keys.channel.path == "rotation"]
    if not turns:
        return True
    if any(keys.cubic for keys in turns):
        return False
    values = np.concatenate([keys.values[:, 0] for keys in turns])
    if (np.abs(norm(values) - 1.0) > NON_UNIT).any():
        return False
    cosine = (values[1:] * values[:-1]).sum(axis=1)
    # Neighbours of different channels are no neighbours.
    cosine[np.cumsum([len(keys.times) for keys in turns])[:-1] - 1] = 1.0
    return not (np.abs(cosine) < 2 * HALF_TURN).any()


def _uneven(scales: Floats) -> Any:
    size = np.abs(scales)
    return size.max(axis=1) - size.min(axis=1) > SAME_SCALE * size.max(axis=1)


def _check_keys(view: View, keys: Keys) -> None:
    """Everything that is wrong with one channel's keys."""
    channel, times = keys.channel, keys.times

    def note(rule: str, wrong: Any, message: Callable[[int], str]) -> bool:
        found = np.flatnonzero(wrong)
        if len(found):
            more = f" ({len(found)} keys)" if len(found) > 1 else ""
            view.add(rule, channel.place, keys.where, message(int(found[0])) + more)
        return bool(len(found))

    def at(k: int) -> str:
        return f"key {k} at {times[k]:g} s"

    lost = ~np.isfinite(keys.values).all(axis=(1, 2))
    if note("gltf.animation.value-nan", lost, lambda k: f"{at(k)} is not a number"):
        return
    values = keys.values[:, 1 if keys.cubic else 0]
    if channel.path == "scale" and channel.node in view.joints:
        uneven = _uneven(values)
        if uneven.any():
            k = int(uneven.argmax())
            text = f"{channel.place}: {at(k)} scales by {' '.join(f'{x:g}' for x in values[k])}"
            view.stretched.setdefault(channel.node, []).append(text)
    if channel.path != "rotation":
        return
    size = norm(values)
    if note("gltf.animation.rotation-zero", size == 0, lambda k: f"{at(k)} is 0 0 0 0"):
        return
    off = np.abs(size - 1.0)
    worst = int(off.argmax())
    if off[worst] > NON_UNIT:
        count = int((off > NON_UNIT).sum())
        text = f"{count} keys are not unit; the worst, {at(worst)}, has the length {size[worst]:.6g}"
        view.add("gltf.animation.rotation-not-unit", channel.place, keys.where, text)
    unit = values / size[:, np.newaxis]
    cosine = (unit[1:] * unit[:-1]).sum(axis=1)
    if keys.cubic:
        opposite = cosine < 0
        note(
            "gltf.animation.rotation-flips",
            opposite,
            lambda k: f"key {k} and {at(k + 1)} have opposite signs",
        )
    half = np.abs(cosine) < HALF_TURN
    note(
        "gltf.animation.rotation-half-turn", half, lambda k: f"key {k} and {at(k + 1)} are half a turn apart"
    )
