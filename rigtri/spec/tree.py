"""A spec file as plain values, and where in which file each of them stands."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.plain_files import text_of
from rigtri.spec.faults import Fault, Place, SpecError

Keys = tuple[str | int, ...]

_TOML_LINE = re.compile(r"""\s*((?:[\w-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[\w-]+|"[^"]*"))*)\s*=""")

# A spec is written by hand or by a script; whatever is larger is none.
MOST_BYTES = 1 << 22
# Aliases of YAML let a small file stand for more values than memory holds.
MOST_VALUES = 100_000
MOST_DEEP = 64


@dataclass
class Tree:
    """values: mappings, lists and scalars. places: of each value, by the keys that lead to it."""

    file: str
    values: Any
    places: dict[Keys, Place] = field(default_factory=dict)

    def place(self, keys: Keys) -> Place:
        """Where a value stands; of one that does not, the nearest above it."""
        for length in range(len(keys), -1, -1):
            if keys[:length] in self.places:
                return self.places[keys[:length]]
        return Place(self.file, 1, 1)

    def under(self, keys: Keys) -> Iterator[tuple[Keys, Place]]:
        """The places of a value and all within it, by the keys from there on."""
        for known, place in self.places.items():
            if known[: len(keys)] == keys:
                yield known[len(keys) :], place


def parse(path: Path) -> Tree:
    """The values of a YAML, TOML or JSON file.

    Raises FileError where it cannot be read, SpecError where its text is none of these.
    """
    suffix = path.suffix.lower()
    if suffix not in (".yaml", ".yml", ".json", ".toml"):
        raise FileError(f"{path}: a spec is a .yaml, .yml, .toml or .json file")
    text = text_of(path, most=MOST_BYTES)
    tree = _toml(path, text) if suffix == ".toml" else _json(path, text) if suffix == ".json" else None
    if tree is None:
        tree = _yaml(path, text)
    if not isinstance(tree.values, dict):
        raise SpecError([Fault(tree.place(()), "", "a spec is a mapping: version, steps and so on")])
    return tree


def _yaml(path: Path, text: str) -> Tree:
    """YAML 1.2, in which ``no`` and ``on`` are words: joints may be called so."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    reader = YAML(typ="rt", pure=True)
    try:
        found = reader.load(text)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = Place(str(path), mark.line + 1, mark.column + 1) if mark else Place(str(path), 1, 1)
        raise SpecError([Fault(place, "", f"no YAML: {error.problem or error.context}")]) from error
    except (YAMLError, ValueError, RecursionError) as error:
        raise SpecError([Fault(Place(str(path), 1, 1), "", f"no YAML: {_first_line(error)}")]) from error
    tree = Tree(str(path), None)
    tree.values = _plain(found, (), tree)
    return tree


def _json(path: Path, text: str) -> Tree:
    """JSON is read as YAML, which tells lines; but what is no JSON is refused."""
    try:
        json.loads(text)
    except json.JSONDecodeError as error:
        place = Place(str(path), error.lineno, error.colno)
        raise SpecError([Fault(place, "", f"no JSON: {error.msg}")]) from error
    except (ValueError, RecursionError) as error:
        raise SpecError([Fault(Place(str(path), 1, 1), "", f"no JSON: {error}")]) from error
    return _yaml(path, text.replace("\t", " "))


def _plain(value: Any, keys: Keys, tree: Tree) -> Any:
    """A value of ruamel.yaml as Python's own, its places noted."""
    if len(tree.places) > MOST_VALUES or len(keys) > MOST_DEEP:
        raise SpecError([Fault(Place(tree.file, 1, 1), "", "more values, or deeper, than a spec can have")])
    if keys == ():
        tree.places[()] = Place(tree.file, 1, 1)
    if isinstance(value, Mapping):
        return {str(key): _member(value, key, str(key), keys, tree) for key in value}
    if isinstance(value, list):
        return [_member(value, number, number, keys, tree) for number in range(len(value))]
    for kind in (bool, int, float, str):
        if isinstance(value, kind):
            return kind(value)
    return None if value is None else str(value)


def _member(owner: Any, key: Any, name: str | int, keys: Keys, tree: Tree) -> Any:
    lines = owner.lc.data.get(key) if getattr(owner, "lc", None) is not None and owner.lc.data else None
    below = (*keys, name)
    if lines is not None:
        at = lines[2:4] if isinstance(owner, Mapping) and _scalar(owner[key]) else lines[:2]
        tree.places[below] = Place(tree.file, at[0] + 1, at[1] + 1)
    else:
        tree.places[below] = tree.place(keys)
    return _plain(owner[key], below, tree)


def _scalar(value: Any) -> bool:
    return not isinstance(value, Mapping | list)


def _toml(path: Path, text: str) -> Tree:
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        place = Place(str(path), *map(int, found.groups())) if found else Place(str(path), 1, 1)
        words = re.sub(r" \(at .*\)$", "", str(error))
        raise SpecError([Fault(place, "", f"no TOML: {words}")]) from error
    except RecursionError as error:
        raise SpecError([Fault(Place(str(path), 1, 1), "", "no TOML: nested too deeply")]) from error
    tree = Tree(str(path), None, _toml_places(path, text))
    tree.places[()] = Place(str(path), 1, 1)
    known = dict(tree.places)
    tree.values = _plain(values, (), tree)
    tree.places.update(known)
    return tree


def _toml_places(path: Path, text: str) -> dict[Keys, Place]:
    """Lines of tables and keys; what stands inside a value has the value's line."""
    places: dict[Keys, Place] = {}
    counts: dict[Keys, int] = {}
    table: Keys = ()
    for number, line in enumerate(text.splitlines(), 1):
        column = len(line) - len(line.lstrip()) + 1
        if found := re.match(r"\s*\[\[\s*(.+?)\s*\]\]", line):
            name = _toml_key(found[1])
            counts[name] = counts.get(name, -1) + 1
            table = (*_in_array(name[:-1], counts), name[-1], counts[name])
            places[table] = Place(str(path), number, column)
        elif found := re.match(r"\s*\[\s*(.+?)\s*\]\s*(#.*)?$", line):
            table = _in_array(_toml_key(found[1]), counts)
            places[table] = Place(str(path), number, column)
        elif found := re.match(
            r"""\s*((?:[\w-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[\w-]+|"[^"]*"))*)\s*=""", line
        ):
            places.setdefault((*table, *_toml_key(found[1])), Place(str(path), number, column))
    return places


def _toml_key(text: str) -> Keys:
    parts = re.findall(r"""[\w-]+|"[^"]*"|'[^']*'""", text)
    return tuple(part.strip("\"'") for part in parts)


def _in_array(name: Keys, counts: Mapping[Keys, int]) -> Keys:
    """The keys of a table's name, with the number of the last table in each array on the way."""
    found: Keys = ()
    for length, key in enumerate(name, 1):
        found = (*found, key)
        if name[:length] in counts:
            found = (*found, counts[name[:length]])
    return found


def _first_line(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
