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
from rigtri.maths.quaternions import norm
from rigtri.maths.ranking import first_largest
from rigtri.maths.trigonometry import Floats
from rigtri.verification.checks.gltf.plain_animation import HALF_TURN, are_sound, is_plain, uneven
from rigtri.verification.checks.gltf.tolerant_reader import Item, View


class Channel(NamedTuple):
    """One channel: what it drives, and where it stands."""

    node: int
    path: str
    item: Item


class Keys(NamedTuple):
    """The keys of a channel. values: (k, 1, width), or (k, 3, width) with tangents; times: (k,)."""

    channel: Channel
    sampler: Item
    times: Floats
    values: Floats

    @property
    def cubic(self) -> bool:
        return bool(self.values.shape[1] == 3)


def check(view: View) -> None:
    """All animations."""
    checked_times: set[int] = set()
    for animation in view.each("animations"):
        if is_plain(animation, checked_times):
            continue
        samplers, channels = animation.objects("samplers"), animation.objects("channels")
        if not channels:
            animation.add("gltf.animation.empty", "has no channels", "channels")
        seen: dict[tuple[int, str], int] = {}
        keyed: list[Keys] = []
        for k, item in enumerate(channels):
            item.place += f", channel {k}"
            channel = _target(item)
            if channel is None:
                continue
            first = seen.setdefault((channel.node, channel.path), k)
            if first != k:
                item.add_violation(twice_violation(view.title(channel.node), channel.path, first))
            keyed += _check_sampler(view, channel, samplers, checked_times)
        largest = (np.abs(keys.values).max(initial=0.0) for keys in keyed)
        view.largest_key = max(view.largest_key, *map(float, largest), 0.0)
        if not _sound(keyed):
            for keys in keyed:
                _check_keys(view, keys)


def _target(item: Item) -> Channel | None:
    """What a channel drives; None for what is no node of ours, which is noted where it is odd."""
    target, found = item.object("target"), target_of(item.raw)
    if found is None:
        _note_other(target)
        return None
    node, path = found
    if target.add_violation(node_violation(node, len(item.view.nodes))):
        return None
    item.place += f" ({item.view.title(node)} {path})"
    return Channel(node, path, item)


def _note_other(target: Item) -> None:
    path = target.raw.get("path")
    if path == "pointer" and pointer_of(target.raw) is not None:
        return  # a property of something else than a node: nothing of a rig
    if path not in (*WIDTH, "weights"):
        text = f"the path {short_repr(path)} is not defined by glTF"
        target.add("gltf.animation.path-unknown", text, "path")
    elif "node" not in target.raw:
        target.add("gltf.animation.without-node", "names no node")
    else:
        text = f"node should be a whole number, not {short_repr(target.raw['node'])}"
        target.add("gltf.json.value", text, "node")


def _check_sampler(view: View, channel: Channel, samplers: list[Item], checked: set[int]) -> list[Keys]:
    """Judge the sampler of a channel; returns its keys where there are as many as there should be."""
    number: Any = channel.item.raw.get("sampler")
    if channel.item.add_violation(sampler_violation(number, len(samplers)), "sampler"):
        return []
    sampler = Item(view, samplers[number].raw, channel.item.place, samplers[number].pointer)
    mode = sampler.raw.get("interpolation", "LINEAR")
    sampler.add_violation(interpolation_violation(mode), "interpolation")
    times = _times(view, sampler, checked)
    values = sampler.read("output")
    if values is None:
        return []
    width = WIDTH.get(channel.path)
    violation = width and value_width_violation(channel.path, width, values.shape[1])
    if violation:
        sampler.add_violation(violation, "output")
        return []
    _check_component(sampler, channel.path)
    if times is None:
        return []
    count = count_violation(len(times), len(values), mode)
    if channel.path == "weights" and len(values) and values.size % values_needed(len(times), mode) == 0:
        count = None
    if sampler.add_violation(count, "output") or width is None:
        return []
    per_key = 3 if mode == "CUBICSPLINE" else 1
    return [Keys(channel, sampler, times, values.reshape(len(times), per_key, width))]


def _check_component(sampler: Item, path: str) -> None:
    """Places and scales are floats; rotations and weights floats or normalised integers of 8 or 16 bits."""
    accessor = sampler.accessor("output")
    kind, normalized = accessor.get("componentType"), accessor.get("normalized") is True
    if kind == FLOAT or (path in ("rotation", "weights") and kind in FULL and normalized):
        return
    expected = "floats" if path in ("translation", "scale") else "floats or normalised integers"
    text = f"{path} should be {expected}, its output has the component type {kind}"
    text += " (normalised)" if normalized else ""
    sampler.add("gltf.animation.output-type", text, "output")


def _times(view: View, sampler: Item, checked: set[int]) -> Floats | None:
    """Key times, (k,); each accessor is judged once, however many samplers share it."""
    numbers = sampler.read("input")
    if numbers is None or sampler.add_violation(time_width_violation(numbers.shape[1]), "input"):
        return None
    raw, accessor = sampler.raw["input"], sampler.accessor("input")
    kind = accessor.get("componentType")
    if kind != FLOAT:
        text = f"its times should be floats, and have the component type {kind}"
        sampler.add("gltf.animation.output-type", text, "input")
    times = numbers[:, 0]
    if int(raw) not in checked:
        checked.add(int(raw))
        if np.isfinite(times).all() and times[0] < 0:
            text = f"the first key is at {times[0]:g} s"
            sampler.add("gltf.animation.times-negative", text, "input")
        for violation in time_violations(times):
            sampler.add_violation(violation, "input")
        if "min" not in accessor or "max" not in accessor:
            text = f"the times, accessor #{raw}, have no min and max"
            view.add("gltf.animation.times-without-bounds", sampler.place, f"/accessors/{raw}", text)
    return times


def _sound(keyed: list[Keys]) -> bool:
    """Whether nothing at all is wrong with some channels: one look at all keys together."""
    paths: dict[str, list[Floats]] = {path: [] for path in WIDTH}
    for keys in keyed:
        if keys.cubic and keys.channel.path == "rotation":
            return False
        paths[keys.channel.path].append(keys.values.reshape(-1, WIDTH[keys.channel.path]))
    return are_sound(paths)


def _check_keys(view: View, keys: Keys) -> None:
    """Everything that is wrong with one channel's keys."""
    channel, times = keys.channel, keys.times

    def note(rule: str, wrong: Any, message: Callable[[int], str]) -> bool:
        found = np.flatnonzero(wrong)
        if len(found):
            more = f" ({len(found)} keys)" if len(found) > 1 else ""
            keys.sampler.add(rule, message(int(found[0])) + more, "output")
        return bool(len(found))

    def at(k: int) -> str:
        return f"key {k} at {times[k]:g} s"

    lost = ~np.isfinite(keys.values).all(axis=(1, 2))
    if note("gltf.animation.value-nan", lost, lambda k: f"{at(k)} is not a number"):
        return
    values = keys.values[:, 1 if keys.cubic else 0]
    if channel.path == "scale" and channel.node in view.joints:
        stretched = uneven(values)
        if stretched.any():
            k = int(stretched.argmax())
            text = f"{channel.item.place}: {at(k)} scales by {' '.join(f'{x:g}' for x in values[k])}"
            view.stretched.setdefault(channel.node, []).append(text)
    if channel.path != "rotation":
        return
    size = norm(values)
    if note("gltf.animation.rotation-zero", size == 0, lambda k: f"{at(k)} is 0 0 0 0"):
        return
    off = np.abs(size - 1.0)
    worst = first_largest(off)
    if off[worst] > NON_UNIT:
        count = int((off > NON_UNIT).sum())
        text = f"{count} keys are not unit; the worst, {at(worst)}, has the length {size[worst]:.6g}"
        keys.sampler.add("gltf.animation.rotation-not-unit", text, "output")
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
