"""Animations with which nothing is wrong, as nearly all: found by one look at all of their keys.

What findings call a channel, and where it stands in the JSON, is put together for others alone.

Source: glTF 2.0 §3.11.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rigtri.formats.gltf.accessors import FLOAT
from rigtri.formats.gltf.rules import NON_UNIT, WIDTH, time_violations
from rigtri.frames.nonuniform_scale import SAME_SCALE
from rigtri.maths.arrays import Booleans
from rigtri.maths.quaternions import norm
from rigtri.maths.trigonometry import Floats
from rigtri.verification.checks.gltf.tolerant_reader import Item, View

# |dot| of two unit quaternions below this: closer to half a turn than float32 can resolve.
HALF_TURN = 1e-4


def is_plain(animation: Item, checked: set[int]) -> bool:
    """Whether an animation has channels of nodes alone, linear or in steps, and nothing is wrong with any.

    checked: the accessors of times that have been judged; those of a plain animation are added.
    """
    samplers, channels = (_objects(animation.raw.get(key)) for key in ("samplers", "channels"))
    if not samplers or not channels:
        return False
    view, accessors = animation.view, animation.view.lists["accessors"]
    places = [raw.get(key) for raw in samplers for key in ("input", "output")]
    view.read_together(place for place in places if type(place) is int and 0 <= place < len(accessors))
    keys: dict[str, list[Floats]] = {path: [] for path in WIDTH}
    driven, inputs = set[tuple[int, str]](), set[int]()
    for channel in channels:
        target, number = channel.get("target"), channel.get("sampler")
        if type(target) is not dict or type(number) is not int or not 0 <= number < len(samplers):
            return False
        node, path = target.get("node"), target.get("path")
        if type(node) is not int or not 0 <= node < len(view.nodes):
            return False
        if type(path) is not str or path not in keys:
            return False
        values = _values(view, samplers[number], WIDTH[path])
        if values is None:
            return False
        keys[path].append(values)
        driven.add((node, path))
        inputs.add(samplers[number]["input"])
    if len(driven) < len(channels) or not all(_rises(view, place) for place in inputs):
        return False
    if not are_sound(keys):
        return False
    largest = (float(np.abs(each).max()) for each in map(_together, keys.values()) if each.size)
    view.largest_key = max(view.largest_key, *largest, 0.0)
    checked |= inputs
    return True


def _objects(found: Any) -> list[dict[str, Any]]:
    """A list of objects; none where anything else stands."""
    return found if isinstance(found, list) and all(type(raw) is dict for raw in found) else []


def _values(view: View, sampler: Mapping[str, Any], width: int) -> Floats | None:
    """The keys of a sampler, (k, width), where they are floats, one for each time; None for others."""
    source, output = sampler.get("input"), sampler.get("output")
    if type(source) is not int or type(output) is not int:
        return None
    if sampler.get("interpolation", "LINEAR") not in ("LINEAR", "STEP"):
        return None
    times, values = view.read_already(source), view.read_already(output)
    if times is None or values is None or values.shape != (len(times), width):
        return None
    return values if view.raw_accessor(output).get("componentType") == FLOAT else None


def _rises(view: View, place: int) -> bool:
    """Whether nothing is wrong with an accessor of times."""
    times, raw = view.read_already(place), view.raw_accessor(place)
    if times is None or times.shape[1] != 1 or raw.get("componentType") != FLOAT:
        return False
    stated = "min" in raw and "max" in raw
    return stated and bool(times[0, 0] >= 0) and next(time_violations(times[:, 0]), None) is None


def are_sound(keys: Mapping[str, Sequence[Floats]]) -> bool:
    """Whether nothing at all is wrong with keys, (k, width) each, of some channels of each path."""
    together = {path: _together(each) for path, each in keys.items()}
    if not all(np.isfinite(each).all() for each in together.values()):
        return False
    if uneven(together["scale"]).any():
        return False
    turns = together["rotation"]
    if (np.abs(norm(turns) - 1.0) > NON_UNIT).any():
        return False
    cosine = (turns[1:] * turns[:-1]).sum(axis=1)
    # Neighbours of different channels are no neighbours.
    cosine[np.cumsum([len(each) for each in keys["rotation"]], dtype=np.intp)[:-1] - 1] = 1.0
    return not (np.abs(cosine) < 2 * HALF_TURN).any()


def _together(keys: Sequence[Floats]) -> Floats:
    return np.concatenate(keys) if keys else np.zeros((0, 4))


def uneven(scales: Floats) -> Booleans:
    """Which scales, (k, 3), are not the same along all axes."""
    size = np.abs(scales)
    return np.asarray(size.max(axis=1) - size.min(axis=1) > SAME_SCALE * size.max(axis=1))
