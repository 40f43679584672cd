"""A glTF file read tolerantly: what is wrong becomes a finding, and the reading goes on.

The rules about single values, bytes and bounds are the readers' own (`Value`,
`Accessors`, `Buffers`); here their first error is caught and noted with its place.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.buffers import Buffers
from rigtri.formats.gltf.container import Container
from rigtri.formats.gltf.structure import LISTS
from rigtri.formats.json_values import Value, short_repr
from rigtri.formats.rules import Violation
from rigtri.maths.trigonometry import Floats
from rigtri.verification.checks.findings import Findings
from rigtri.verification.checks.gltf.accessor_bounds import fitting, is_far
from rigtri.verification.checks.gltf.buffer_check import broken_buffers, usable, words

# Rows of an accessor decoded at once where they are not kept.
BLOCK = 1 << 16
# Accessors of up to so many rows are read together.
_SMALL = 1 << 12
# Accessors of these types are only for meshes and materials of others; rigtri does not read them.
FOREIGN = ("MAT2", "MAT3")


class Item:
    """An object of the JSON, what to call it in findings, and where it stands.

    What in it is not as it should be becomes a finding, and is read as if it were not there.
    """

    __slots__ = ("place", "pointer", "raw", "view")

    def __init__(self, view: View, raw: dict[str, Any], place: str, pointer: str) -> None:
        self.view, self.raw, self.place, self.pointer = view, raw, place, pointer

    def add(self, rule: str, message: str, key: str = "") -> None:
        """Note what is wrong with it, or with what stands under a key."""
        self.view.add(rule, self.place, f"{self.pointer}/{key}" if key else self.pointer, message)

    def add_violation(self, violation: Violation | None, key: str = "") -> bool:
        """Note what a rule has found; whether it has found anything."""
        if violation is not None:
            self.add(violation.rule, violation.text, key)
        return violation is not None

    def object(self, key: str, place: str = "") -> Item:
        """The object under a key; an empty one where there is none. place: what to call it."""
        return self._object(self.raw.get(key, {}), key, place)

    def objects(self, key: str, place: str = "") -> list[Item]:
        """The objects of a list; an empty one in place of each that is none."""
        return [self._object(raw, f"{key}/{k}", place) for k, raw in enumerate(self.items(key, place))]

    def raws(self, key: str, place: str = "") -> list[dict[str, Any]]:
        """The JSON of `objects`, which are not made where all are objects."""
        items = self.items(key, place)
        if all(isinstance(raw, dict) for raw in items):
            return list(items)
        return [item.raw for item in self.objects(key, place)]

    def _object(self, raw: Any, key: str, place: str) -> Item:
        found = Item(self.view, raw, place or self.place, f"{self.pointer}/{key}")
        if not isinstance(raw, dict):
            found.add("gltf.json.value", f"{found.pointer} should be an object, not {short_repr(raw)}")
            found.raw = {}
        return found

    def items(self, key: str, place: str = "") -> list[Any]:
        """The list under a key; nothing where there is none."""
        found = self.raw.get(key, [])
        if isinstance(found, list):
            return found
        pointer = f"{self.pointer}/{key}"
        text = f"{pointer} should be a list, not {short_repr(found)}"
        self.view.add("gltf.json.value", place or self.place, pointer, text)
        return []

    def index(
        self, key: str, kind: str, rule: str = "gltf.reference", among: int | None = None
    ) -> int | None:
        """The index under a key of one of the file's things of a kind, or of ``among`` things.

        None, with a finding, for anything else.
        """
        count = self.view.count(kind) if among is None else among
        return self.view.index(self.raw.get(key), count, kind, self.place, f"{self.pointer}/{key}", rule)

    def indices(
        self, key: str, kind: str, rule: str = "gltf.reference", among: int | None = None
    ) -> list[int | None]:
        """As `index`, of all items of a list."""
        count, pointer = self.view.count(kind) if among is None else among, f"{self.pointer}/{key}"
        return [
            self.view.index(raw, count, kind, self.place, f"{pointer}/{k}", rule)
            for k, raw in enumerate(self.items(key))
        ]

    def reference(self, key: str, kind: str) -> int | None:
        """As `index`; None, without a finding, where nothing stands there."""
        return self.index(key, kind) if key in self.raw else None

    def numbers(self, key: str, count: int) -> list[float] | None:
        """Exactly ``count`` numbers under a key; None, with a finding, for anything else."""
        return self.view.numbers(self.raw[key], count, self.place, f"{self.pointer}/{key}")

    def read(self, key: str) -> Floats | None:
        """The numbers of the accessor under a key, (count, width); None, with a finding, without."""
        return self.view.read(self.raw.get(key), self.place, f"{self.pointer}/{key}")

    def judged(self, key: str) -> int | None:
        """The accessor under a key, whose numbers can be had part by part; None, with a finding, without."""
        return self.view.judged(self.raw.get(key), self.place, f"{self.pointer}/{key}")

    def accessor(self, key: str) -> dict[str, Any]:
        """The JSON of the accessor under a key, which could be read."""
        return self.view.raw_accessor(self.raw[key])


class View:
    """The JSON of a file as lists of objects, its accessors, and where findings go."""

    def __init__(self, container: Container, findings: Findings, *, allow_external: bool) -> None:
        self.container, self.findings = container, findings
        self.raw = container.gltf
        self.file = Item(self, self.raw, "file", "")
        self.lists = {key: self.file.raws(key, key) for key in (*LISTS, "materials")}
        self.nodes = self.lists["nodes"]
        self.above = [-1] * len(self.nodes)
        self.largest_key = 0.0
        self.joints: dict[int, str] = {}  # node → the skin that lists it first
        self.stretched: dict[int, list[str]] = {}  # joint → the channels that scale it unevenly
        self._broken = broken_buffers(container, self.lists, findings, allow_external=allow_external)
        # Buffers that cannot be had are known by now; the others are read as in an edit.
        whole = {
            **self.raw,
            "buffers": usable(self.lists["buffers"], self._broken),
            "bufferViews": self.lists["bufferViews"],
        }
        whole["accessors"] = self.lists["accessors"]
        gltf = Value(whole, f"{container.path}:")
        buffers = Buffers(gltf, container, allow_external=allow_external)
        self.accessors = Accessors(gltf, buffers)
        self._numbers: dict[int, Floats | None] = {}
        self._check_layouts()
        if not self.lists["skins"]:
            self.add("gltf.no-skin", "file", "", "there is no skin in it")

    # --- values

    def add(self, rule: str, place: str, pointer: str, message: str) -> None:
        self.findings.add(rule, place, pointer, message)

    def item(self, section: str, number: int) -> Item:
        """An object of one of the file's lists."""
        raw = self.lists[section][number]
        return Item(self, raw, titled(one(section), raw, number), f"/{section}/{number}")

    def each(self, section: str) -> Iterator[Item]:
        """The objects of one of the file's lists."""
        return (self.item(section, number) for number in range(len(self.lists[section])))

    def title(self, node: int) -> str:
        """What to call a node."""
        return titled("node", self.nodes[node], node)

    def titles(self, nodes: Iterable[int]) -> Iterator[str]:
        return (self.title(node) for node in nodes)

    def count(self, kind: str) -> int:
        """How many things of a kind the file has."""
        return len(self.lists["meshes" if kind == "mesh" else f"{kind}s"])

    def index(
        self, raw: Any, among: int, kind: str, place: str, pointer: str, rule: str = "gltf.reference"
    ) -> int | None:
        """An index of one of ``among`` things; None, with a finding, for anything else."""
        if type(raw) is int:
            number = raw
        else:
            try:
                number = Value(raw, place).count()
            except FileError as error:
                self.add("gltf.json.value", place, pointer, words(error, place))
                return None
        if not 0 <= number < among:
            self.add(rule, place, pointer, f"there is no {kind} {number}, the file has {among}")
            return None
        return number

    def numbers(self, raw: Any, count: int, place: str, pointer: str) -> list[float] | None:
        """Exactly ``count`` numbers; None, with a finding, for anything else."""
        try:
            return Value(raw, place).numbers(count)
        except FileError as error:
            self.add("gltf.json.value", place, pointer, words(error, place))
            return None

    # --- bytes

    def read(self, raw: Any, place: str, pointer: str) -> Floats | None:
        """The numbers of an accessor, (count, width); None, with a finding, where they are not to be had."""
        index = self.index(raw, len(self.accessors), "accessor", place, pointer)
        if index is None:
            return None
        if index not in self._numbers:
            self._numbers[index] = self._read(index)
        return self._numbers[index]

    def read_together(self, indices: Iterable[int]) -> None:
        """Read small accessors of one size at once, as `read` would, where their stated bounds fit.

        Others wait for `read`, with what is wrong with them.
        """
        groups = dict[tuple[int, int], list[int]]()
        for index in dict.fromkeys(indices):
            if index not in self._numbers and not self._is_lost(index):
                with suppress(FileError):
                    layout = self.accessors.layout(index)
                    if layout.plain and layout.rows <= _SMALL:
                        groups.setdefault((layout.rows, layout.width), []).append(index)
        for (rows, width), group in groups.items():
            with suppress(FileError), np.errstate(invalid="ignore"):
                numbers = self.accessors.read_alike(group).reshape(len(group), rows, width)
                lows, highs = numbers.min(axis=1), numbers.max(axis=1)
                stated = [self.lists["accessors"][index] for index in group]
                fits = fitting([raw.get("min") for raw in stated], lows)
                fits &= fitting([raw.get("max") for raw in stated], highs)
                self._numbers |= {group[k]: numbers[k] for k in np.flatnonzero(fits).tolist()}

    def read_already(self, index: int) -> Floats | None:
        """The numbers of an accessor, (count, width), that was read and judged; None of others."""
        return self._numbers.get(index)

    def judged(self, raw: Any, place: str, pointer: str) -> int | None:
        """An accessor for `part`, judged as by `read`; None, with a finding, where it cannot be had."""
        index = self.index(raw, len(self.accessors), "accessor", place, pointer)
        if index is None:
            return None
        if index not in self._numbers and not self._is_lost(index):
            with suppress(FileError):  # which `read` reports
                if self.accessors.has_rows(index) and self.accessors.layout(index).rows:
                    self.accessors.readable(index)
                    if {"min", "max"} & self.raw_accessor(index).keys():
                        self.judge(index)
                    return index
        return index if self.read(raw, place, pointer) is not None else None

    def part(self, index: int, start: int, stop: int) -> Floats | None:
        """Some rows of an accessor that is `judged`; None, with a finding, where they are not to be had."""
        known = self._numbers.get(index)
        if known is not None:
            return known[start:stop]
        try:
            return self.accessors.rows(index, start, stop)
        except FileError as error:
            self._add_broken(index, error)
            return None

    def judge(self, index: int) -> None:
        """Judge the min and max of an accessor that nothing else reads; its numbers are not kept."""
        if index not in self._numbers:
            ends = [(block.min(axis=0), block.max(axis=0)) for block in self.blocks(index)]
            if ends:
                lows, highs = zip(*ends, strict=True)
                self._check_bounds(index, np.array(lows), np.array(highs))

    def blocks(self, index: int) -> Iterator[Floats]:
        """The numbers of an accessor, some rows at a time, none of which is kept; of packed ones all."""
        if self._is_lost(index):
            return
        known = self._numbers.get(index)
        try:
            if known is not None or not self.accessors.has_rows(index):
                yield self.accessors.read(index) if known is None else known
                return
            for start in range(0, self.accessors.layout(index).rows, BLOCK):
                yield self.accessors.rows(index, start, start + BLOCK)
        except FileError as error:
            self._add_broken(index, error)

    def raw_accessor(self, raw: Any) -> dict[str, Any]:
        """The JSON of an accessor that could be read."""
        return self.lists["accessors"][int(raw)]

    def compressed(self, what: str) -> None:
        self.add("gltf.compressed", "file", "/extensionsUsed", f"{what}, so those data were not looked at")

    def _read(self, index: int) -> Floats | None:
        if self._is_lost(index):
            return None
        try:
            numbers = self.accessors.read(index)
        except FileError as error:
            self._add_broken(index, error)
            return None
        self._check_bounds(index, numbers, numbers)
        return numbers

    def _is_lost(self, index: int) -> bool:
        """Whether the buffer of an accessor is known to be missing: one report is enough."""
        views, view = self.lists["bufferViews"], self.lists["accessors"][index].get("bufferView")
        if type(view) is not int or not 0 <= view < len(views):
            return False
        buffer = views[view].get("buffer")
        return type(buffer) is int and buffer in self._broken

    def _add_broken(self, index: int, error: FileError) -> None:
        name = f"accessor #{index}"
        text = words(error, f"{self.container.path}").removeprefix(f"accessors[{index}]").lstrip(".: ")
        self.add("gltf.accessor.broken", name, f"/accessors/{index}", text)

    def _check_layouts(self) -> None:
        """Every accessor lies within its view, whoever uses it."""
        for index, raw in enumerate(self.lists["accessors"]):
            if raw.get("type") in FOREIGN or self._is_lost(index):
                continue
            try:
                self.accessors.layout(index)
            except FileError as error:
                self._add_broken(index, error)
            else:
                if "sparse" in raw and index not in self._numbers:
                    self._numbers[index] = self._read(index)

    def _check_bounds(self, index: int, lows: Floats, highs: Floats) -> None:
        """Whether the stated bounds are those of some rows and some others, (…, width) each."""
        raw, width = self.lists["accessors"][index], lows.shape[1]
        for key, found in (("min", lows.min(axis=0)), ("max", highs.max(axis=0))):
            stated = raw.get(key)
            if stated is None or raw.get("normalized") is True:
                continue
            place, pointer = f"accessor #{index}", f"/accessors/{index}/{key}"
            given = self.numbers(stated, width, place, pointer)
            if given is not None and (far := is_far(given, found)).any():
                k = int(far.argmax())
                text = f"{key}[{k}] is {given[k]:g}, and the values have {found[k]:g}"
                self.add("gltf.accessor.bounds", place, pointer, text)


def one(section: str) -> str:
    """What to call an item of a list of the file."""
    return {"meshes": "mesh", "bufferViews": "buffer view"}.get(section, section.removesuffix("s"))


def titled(kind: str, raw: Any, number: int) -> str:
    """What to call a thing of the file in a message."""
    name = raw.get("name") if isinstance(raw, dict) else None
    return f"{kind} '{name}' (#{number})" if isinstance(name, str) and name else f"{kind} #{number}"
