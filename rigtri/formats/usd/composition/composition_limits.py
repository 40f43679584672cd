"""How much USD would compose of some layers, counted before it does: a small file can make it any amount.

Prims that come from the same places have the same prims below them, so each kind is counted
once. Which opinion is the stronger is not looked at: arcs that another layer deletes count, prims that
are not active, and those of every variant that any layer selects.

Source: OpenUSD, composition arcs and value clips; measured with Usd.Stage (26.11).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pxr import Sdf

from rigtri.errors import FileError
from rigtri.formats.usd.composition.layers import listed_items
from rigtri.formats.usd.composition.variable_expressions import Variables, evaluated, is_one, variables_of

# Prims of a stage, those in instances for each of them: rigtri reads them one by one.
MOST_PRIMS = 5_000_000
# Places that make one prim; USD's own limit.
MOST_PLACES = 32_767
# Places that are looked at in all, each kind of prim once.
MOST_OPINIONS = 5_000_000
# Files that a template of value clips may name; USD looks for each.
MOST_CLIPS = 100_000

# A layer stack by its number, and a path in it.
Site = tuple[int, Any]
# The sites that make a prim, and how many times each does.
Kind = frozenset[tuple[Site, int]]

_RANGE = ("templateStartTime", "templateEndTime", "templateStride")


def check(path: Path, layers: Sequence[Any]) -> bool:
    """FileError where a file would have more prims or clips than anyone can read; whether it has any clips.

    layers: all that are composed of it, open; the first is its own.
    """
    if not layers:
        return False
    has_clips = _check_clips(path, layers)
    _Count(path, layers[0]).check()
    return has_clips


def _check_clips(path: Path, layers: Sequence[Any]) -> bool:
    """The same for value clips; a template that one layer has in part may be completed by any other."""
    ranges: list[dict[str, float]] = []

    def visit(layer: Any, at: Any) -> None:
        prims = at.IsPrimPath() or at.IsPrimVariantSelectionPath()
        spec = layer.GetPrimAtPath(at) if prims else None
        if spec is not None and spec.HasInfo("clips"):
            for clips in spec.GetInfo("clips").values():
                span = {name: clips.get(name) for name in _RANGE} if isinstance(clips, dict) else {}
                ranges.append({name: float(v) for name, v in span.items() if isinstance(v, int | float)})

    for layer in layers:
        layer.Traverse(Sdf.Path.absoluteRootPath, lambda at, layer=layer: visit(layer, at))
    every = {name: [span[name] for span in ranges if name in span] for name in _RANGE}
    start, end = min(every[_RANGE[0]], default=0.0), max(every[_RANGE[1]], default=0.0)
    stride = min((value for value in every[_RANGE[2]] if value > 0), default=0.0)
    for span in ranges:
        first, last = span.get(_RANGE[0], start), span.get(_RANGE[1], end)
        step = span.get(_RANGE[2], stride)
        if span and step > 0 and not (last - first) / step <= MOST_CLIPS:
            raise FileError(
                f"{path}: the template of its value clips names files from {first:g} to {last:g} in steps of "
                f"{step:g}, more than {MOST_CLIPS}. Correct {', '.join(_RANGE)}"
            )
    return bool(ranges)


@dataclass
class _SiteContent:
    """The opinions of a layer stack at a path. sets: variants of each set; selected: those of each name."""

    children: dict[str, None] = field(default_factory=dict)
    arcs: list[Site] = field(default_factory=list)
    sets: dict[str, list[str]] = field(default_factory=dict)
    selected: dict[str, set[str]] = field(default_factory=dict)
    there: bool = False


class _Count:
    """The prims that composing a layer makes."""

    def __init__(self, path: Path, root: Any) -> None:
        self._path = path
        self._stacks: list[tuple[list[Any], Variables]] = []
        self._numbers: dict[tuple[str, str], int] = {}
        self._contents: dict[Site, _SiteContent] = {}
        self._visited = 0
        self._stack(root, variables_of(root))

    def check(self) -> None:
        """FileError where there are too many."""
        top: Kind = frozenset([((0, Sdf.Path.absoluteRootPath), 1)])
        known: dict[Kind, int] = {}
        # The prims from the root to one, each with those below it that are still to be counted.
        chain = [(top, self._below(top))]
        known[top] = 0
        while chain:
            kind, below = chain[-1]
            found = next(below, None)
            if found is None:
                chain.pop()
                if chain:
                    known[chain[-1][0]] += known[kind]
            elif found in known:
                # A prim inside of itself is a cycle, which USD breaks: it counts as far as it came.
                known[kind] += known[found]
            else:
                known[found] = 1
                chain.append((found, self._below(found)))
            if known[kind] > MOST_PRIMS:
                raise self._too_many(f"{MOST_PRIMS} prims")

    def _too_many(self, what: str) -> FileError:
        return FileError(
            f"{self._path}: its references, payloads and inherits make more than {what}, for what they name "
            "is repeated in itself many times over. Give a file of the character alone"
        )

    def _below(self, kind: Kind) -> Iterator[Kind]:
        """The kinds of the children of a prim."""
        sites = self._sites(kind)
        self._visited += sites.total()
        if self._visited > MOST_OPINIONS:
            raise self._too_many(f"{MOST_OPINIONS} opinions on prims")
        by_name: dict[str, Counter[Site]] = {}
        for (stack, path), times in sites.items():
            for name in self._content((stack, path)).children:
                by_name.setdefault(name, Counter())[stack, path.AppendChild(name)] += times
        for found in by_name.values():
            yield frozenset(found.items())

    def _sites(self, kind: Kind) -> Counter[Site]:
        """All sites that make a prim: those that are known, and what their arcs and variants lead to."""
        found: Counter[Site] = Counter()
        for site, times in kind:
            self._follow(site, times, found)
        chosen: set[tuple[Site, str, str]] = set()
        while True:
            selected: dict[str, set[str]] = {}
            for site in found:
                for name, variants in self._content(site).selected.items():
                    selected.setdefault(name, set()).update(variants)
            new = {
                (site, name, variant)
                for site in found
                for name, variants in self._content(site).sets.items()
                for variant in variants
                if variant in selected.get(name, ()) or any(map(is_one, selected.get(name, ())))
            } - chosen
            if not new:
                return found
            chosen |= new
            for site, name, variant in new:
                inside = (site[0], site[1].AppendVariantSelection(name, variant))
                self._follow(inside, found[site], found)

    def _follow(self, site: Site, times: int, found: Counter[Site]) -> None:
        """Count a site and what its arcs lead to; an arc back to where it comes from is broken by USD."""
        above = {site: None}
        waiting = [iter(self._content(site).arcs)]
        found[site] += times
        total = found.total()
        while waiting:
            target = next(waiting[-1], None)
            if target is None:
                waiting.pop()
                above.popitem()
            elif target not in above and self._content(target).there:
                found[target] += times
                total += times
                if total > MOST_PLACES:
                    raise self._too_many(f"{MOST_PLACES} arcs on one prim, <{site[1]}>")
                above[target] = None
                waiting.append(iter(self._content(target).arcs))

    def _content(self, site: Site) -> _SiteContent:
        if site not in self._contents:
            self._contents[site] = self._read(site)
        return self._contents[site]

    def _read(self, site: Site) -> _SiteContent:
        number, path = site
        content = _SiteContent()
        for layer in self._stacks[number][0]:
            spec = layer.GetPrimAtPath(path)
            if spec is None:
                continue
            content.there = True
            content.children |= dict.fromkeys(spec.nameChildren.keys())
            if path.IsAbsoluteRootPath():
                continue
            content.arcs += self._arcs(spec, layer, number)
            for name, variants in spec.variantSets.items():
                content.sets.setdefault(name, []).extend(variants.variants.keys())
            for name, variant in spec.variantSelections.items():
                content.selected.setdefault(name, set()).add(variant)
        return content

    def _arcs(self, spec: Any, layer: Any, number: int) -> Iterator[Site]:
        """Where the arcs of a spec lead to."""
        for path in (*listed_items(spec, "inheritPaths"), *listed_items(spec, "specializes")):
            yield number, path
            if number:
                # Opinions on a class of the same name in the root layer count, too.
                yield 0, path
        variables = self._stacks[number][1]
        for arc in (*listed_items(spec, "references"), *listed_items(spec, "payload")):
            stack = number
            root = self._stacks[number][0][0]
            if arc.assetPath:
                root = _opened(layer, arc.assetPath, variables)
                if root is None:
                    continue
                stack = self._stack(root, {**variables_of(root), **variables})
            path = arc.primPath or _default_prim(root)
            if path:
                yield stack, path

    def _stack(self, root: Any, variables: Variables) -> int:
        """The number of the layer stack of a layer."""
        key = (root.identifier, repr(sorted(variables.items(), key=str)))
        if key not in self._numbers:
            self._numbers[key] = len(self._stacks)
            layers = [root]
            for layer in layers:
                below = (_opened(layer, asset, variables) for asset in layer.subLayerPaths)
                layers += [found for found in below if found is not None and found not in layers]
            self._stacks.append((layers, variables))
        return self._numbers[key]


def _opened(anchor: Any, asset: str, variables: Variables) -> Any:
    """A layer that another one refers to, if it is open."""
    name = evaluated(asset, variables)
    return Sdf.Layer.FindRelativeToLayer(anchor, name) if name else None


def _default_prim(layer: Any) -> Any:
    name = f"/{str(layer.defaultPrim).strip('/')}"
    return Sdf.Path(name) if name != "/" and Sdf.Path.IsValidPathString(name) else None
