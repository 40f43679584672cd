"""What a file shows or states besides poses: scenes, lenses, lights, materials, units, avatars.

Formats state it as plain facts, a name and a value each; two files show the same
where their facts are equal. Facts of two formats are not compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rigtri.frames.reoriented_constraints import constraints_from_metadata
from rigtri.maths.trigonometry import Floats
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh, Surface
from rigtri.model.rig import Rig
from rigtri.model.scene_facts import IN_CLIP
from rigtri.model.scene_facts import Reference as Reference
from rigtri.model.scene_facts import SceneFacts as SceneFacts
from rigtri.model.scene_facts import flat as flat
from rigtri.verification.compare.correspondence import Correspondence

# Facts that nobody sees: they are reported, and pass.
UNSEEN = ("morph target names", "start time code", "end time code", "frames per second")
# Facts that a node has which draws or lights anything.
_SHOWS = frozenset({"light type", "number of primitives", "gprim type"})
# Numbers that another program stored again as float32 differ by less, of their size.
SAME_NUMBER = 1e-6
# Normals that another program stored as 8-bit integers differ by less, and colours;
# texture coordinates that it stored as 16-bit integers.
SAME_NORMAL, SAME_COLOUR, SAME_VALUE = 1e-2, 4e-3, 2e-5
# Offsets of morph targets, as a share of the size of the mesh: the tolerance that its points have.
SAME_OFFSET = 1e-5


@dataclass(frozen=True, eq=False)
class _Sides:
    """Both rigs, what of one is what of the other, and how far apart numbers are the same."""

    rigs: tuple[Rig, Rig]
    m: Correspondence
    share: float
    apart: float

    def facts(self, of: str, mine: Mapping[str, Any], theirs: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
        """Name and words of each fact that is not the same."""
        for name in dict.fromkeys((*mine, *theirs)):
            was, now = mine.get(name), theirs.get(name)
            if not self.equal(was, now) and not (was is None and IN_CLIP in name):
                texts = (
                    _short_text(value, rig) for value, rig in zip((now, was), self.rigs[::-1], strict=True)
                )
                yield name, f"{name}{of} is {', was '.join(texts)}"

    def equal(self, was: Any, now: Any) -> bool:
        if isinstance(was, Reference) and isinstance(now, Reference):
            return now.node == (self.m.showing(was.node) if was.shows else int(self.m.node[was.node]))
        if isinstance(was, float | int) and isinstance(now, float | int):
            near = was == now or abs(was - now) <= max(self.share * max(abs(was), abs(now)), self.apart)
            return near or (was != was and now != now)
        if isinstance(was, list | tuple) and isinstance(now, list | tuple):
            return len(was) == len(now) and all(map(self.equal, was, now))
        return bool(was == now)


def compare_scene_facts(
    rigs: tuple[Rig, Rig],
    mine: SceneFacts,
    theirs: SceneFacts,
    m: Correspondence,
    *,
    share: float = SAME_NUMBER,
    apart: float = 0.0,
) -> tuple[list[str], list[str]]:
    """What looks different in the second file, and what is different and does not show.

    share, apart: numbers are the same that differ by no more of their size, or no more at all.
    """
    if mine.format != theirs.format:
        return [], []
    sides = _Sides(rigs, m, share, apart)
    found = list(sides.facts("", mine.whole, theirs.whole))
    mine, theirs = _without_rules(rigs[0], mine), _without_rules(rigs[1], theirs)
    for partners, here, there in ((m.shown, mine.nodes, theirs.nodes), (m.node, mine.own, theirs.own)):
        known = set()
        for node, facts in here.items():
            partner = int(partners[node])
            known.add(partner)
            if partner >= 0:
                found += sides.facts(f" of {rigs[0].title(node)}", facts, there.get(partner, {}))
        back = {int(now): k for k, now in enumerate(m.node.tolist()) if now >= 0}
        for node in back.keys() & (there.keys() - known):
            found += sides.facts(f" of {rigs[0].title(back[node])}", {}, there[node])
    seen = [text for name, text in found if name not in UNSEEN]
    return seen, [text for name, text in found if name in UNSEEN]


def newly_shown(after: Rig, theirs: SceneFacts, m: Correspondence) -> list[str]:
    """Meshes and lights of nodes that only the second file has, but for what rigtri has added."""
    known = {*m.node.tolist(), *m.shown.tolist(), *after.own}
    return [
        f"{after.title(node)}, which was not there, shows a {'light' if 'light type' in facts else 'mesh'}"
        for node, facts in theirs.nodes.items()
        if node not in known and _SHOWS.intersection(facts) and facts.get("visibility") != "invisible"
    ]


def _without_rules(rig: Rig, scene_facts: SceneFacts) -> SceneFacts:
    """Without node constraints that stand for constraints of rigtri's: those change on purpose."""
    ours = constraints_from_metadata(rig)
    return replace(scene_facts, own={k: facts for k, facts in scene_facts.own.items() if k not in ours})


def _short_text(value: Any, rig: Rig) -> str:
    text = _words(value, rig)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _words(value: Any, rig: Rig) -> str:
    """A value in words: no brackets around a list, none for what is not there."""
    if value is None or value == [] or value == ():
        return "none"
    if isinstance(value, Reference):
        return rig.title(value.node)
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, list | tuple):
        nested = (f"({_words(x, rig)})" if isinstance(x, list | tuple) else _words(x, rig) for x in value)
        return ", ".join(nested)
    return f"{value:.9g}" if isinstance(value, float) else str(value)


def compare_surfaces(pairs: Sequence[tuple[Mesh, Mesh]], title: Callable[[Mesh], str]) -> list[str]:
    """What looks different about meshes: morph targets, faces, normals, colours, texture coordinates."""
    found = []
    for mine, theirs in pairs:
        differ = list(_offset_differences(mine, theirs))
        one, other = mine.surface_now, theirs.surface_now
        if one is not None and other is not None:
            differ += _surface_differences(one, other)
        found += [f"{what} of mesh {title(mine)}" for what in differ]
    return found


def _offset_differences(mine: Mesh, theirs: Mesh) -> Iterator[str]:
    """Morph targets, whatever weight they have now: an expression or a program may give them another."""
    if len(mine.morphs) != len(theirs.morphs):
        yield f"{len(theirs.morphs)} morph targets instead of {len(mine.morphs)}: the morph targets"
        return
    points = mine.points[np.isfinite(mine.points).all(axis=1)]
    size = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    for number, (was, now) in enumerate(zip(mine.morphs, theirs.morphs, strict=True)):
        if not np.array_equal(was, now, equal_nan=True):
            with np.errstate(invalid="ignore", over="ignore"):
                off = float(
                    np.nan_to_num(np.abs(was - now), nan=np.inf)[~(np.isnan(was) & np.isnan(now))].max()
                )
            if not off <= SAME_OFFSET * max(size, float(np.abs(was[np.isfinite(was)]).max(initial=0.0))):
                yield f"the offsets of morph target {number}, by up to {off:.2g},"


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
    yield from _value_differences(one.values, other.values)


def _value_differences(mine: Mapping[str, Any], theirs: Mapping[str, Any]) -> Iterator[str]:
    """Colours, texture coordinates and what else points or corners have."""
    for name in dict.fromkeys((*mine, *theirs)):
        was, now = mine.get(name), theirs.get(name)
        if was is None or now is None:
            yield f"{name}, {'which was not there' if was is None else 'which is gone'},"
        elif was.shape != now.shape:
            yield f"{name}, {now.size} numbers instead of {was.size},"
        elif not np.array_equal(was, now, equal_nan=was.dtype.kind == "f"):
            if was.dtype.kind != "f" or now.dtype.kind != "f":
                yield name
                continue
            with np.errstate(invalid="ignore"):
                off = np.abs(was - now)[~(np.isnan(was) & np.isnan(now))].max(initial=0.0)
            if not off <= _same_value(name, was):
                yield f"{name}, by up to {off:.2g},"


def _same_value(name: str, values: Floats) -> float:
    """How far apart values are the same, as programs store them."""
    lower = name.lower()
    if "color" in lower:
        return SAME_COLOUR
    if "normal" in lower or "tangent" in lower:
        return SAME_NORMAL
    return SAME_VALUE * max(1.0, float(np.abs(values[np.isfinite(values)]).max(initial=0.0)))


def _faces(surface: Surface) -> str:
    count = len(surface.sizes)
    return f"{count} faces" if count else f"{len(surface.corners)} corners"
