"""What a file shows that no pose tells: scenes, lenses, lights, materials, faces, normals, units.

Formats state it as plain facts, a name and a value each; two files show the same
where their facts are equal. Facts of two formats are not compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rigtri.matching import Matching
from rigtri.rig import Mesh, Rig, Surface

# Facts that nobody sees: they are told, and pass.
UNSEEN = ("morph target names", "start time code", "end time code", "frames per second")
# Numbers that another program stored again as float32 differ by less, of their size.
SAME_NUMBER = 1e-6
# Normals that another program stored as 8-bit integers differ by less.
SAME_NORMAL = 1e-2


@dataclass(frozen=True)
class Scenery:
    """Facts of a file: ``whole`` by name, ``nodes`` by node and name.

    A fact that is not there is None. Nodes are those that show something; what a node
    shows keeps its facts when it is moved to another.
    """

    format: str = ""
    whole: Mapping[str, Any] = field(default_factory=dict)
    nodes: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)


def flat(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """A nested JSON value as facts; what is none to look at, names and extras, is left out.

    >>> list(flat({"type": "spot", "spot": {"outerConeAngle": 0.5}, "name": "key"}, "light"))
    [('light type', 'spot'), ('light spot outerConeAngle', 0.5)]
    """
    if isinstance(value, dict):
        for key, item in value.items():
            if key not in ("name", "extras"):
                yield from flat(item, f"{name} {key}")
    else:
        yield name, value


def compare_scenery(before: Rig, mine: Scenery, theirs: Scenery, m: Matching) -> tuple[list[str], list[str]]:
    """What looks different in the second file, and what is different and does not show."""
    if mine.format != theirs.format:
        return [], []
    found = list(_facts("", mine.whole, theirs.whole))
    for node, facts in mine.nodes.items():
        partner = int(m.shown[node])
        if partner >= 0:
            found += _facts(f" of {before.title(node)}", facts, theirs.nodes.get(partner, {}))
    seen = [text for name, text in found if name not in UNSEEN]
    return seen, [text for name, text in found if name in UNSEEN]


def _facts(of: str, mine: Mapping[str, Any], theirs: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    if mine == theirs:
        return
    for name in dict.fromkeys((*mine, *theirs)):
        was, now = mine.get(name), theirs.get(name)
        if not _alike(was, now):
            yield name, f"{name}{of} is {_told(now)}, was {_told(was)}"


def _alike(was: Any, now: Any) -> bool:
    if isinstance(was, float | int) and isinstance(now, float | int):
        return was == now or abs(was - now) <= SAME_NUMBER * max(abs(was), abs(now))
    if isinstance(was, list | tuple) and isinstance(now, list | tuple):
        return len(was) == len(now) and all(map(_alike, was, now))
    return bool(was == now)


def _told(value: Any) -> str:
    if value is None:
        return "none"
    text = f"{value:.9g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def compare_surfaces(pairs: Sequence[tuple[Mesh, Mesh]], title: Callable[[Mesh], str]) -> list[str]:
    """What looks different between the points of meshes: faces and normals."""
    found = []
    for mine, theirs in pairs:
        one, other = mine.surface_now, theirs.surface_now
        if one is not None and other is not None:
            found += [f"{what} of mesh {title(mine)}" for what in _surface_differences(one, other)]
    return found


def _surface_differences(one: Surface, other: Surface) -> Iterator[str]:
    if one.kind != other.kind:
        yield f"{other.kind} instead of {one.kind}: the faces"
    elif len(one.sizes) != len(other.sizes) or len(one.corners) != len(other.corners):
        yield f"{_faces(other)} instead of {_faces(one)}: the faces"
    elif not (np.array_equal(one.sizes, other.sizes) and np.array_equal(one.corners, other.corners)):
        count = int((one.corners != other.corners).sum())
        yield f"{count} of {len(one.corners)} corners of the faces"
    if one.normals.shape != other.normals.shape:
        yield f"{len(other.normals)} normals instead of {len(one.normals)}: the normals"
    elif one.normals.size:
        with np.errstate(invalid="ignore"):
            off = np.abs(one.normals - other.normals).max()
        if not off <= SAME_NORMAL and not np.array_equal(one.normals, other.normals, equal_nan=True):
            yield f"the normals, by up to {off:.2g},"


def _faces(surface: Surface) -> str:
    count = len(surface.sizes)
    return f"{count} faces" if count else f"{len(surface.corners)} corners"
