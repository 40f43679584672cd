"""A spec file as a tree: YAML or JSON by its suffix, each value with its place."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigtri.errors import FileError
from rigtri.files.text_files import text_of
from rigtri.pipeline.rigspec.errors import Fault, Place, SpecError
from rigtri.pipeline.rigspec.positions import MOST_DEEP, TOO_MUCH, Spot, Spots, Tree

if TYPE_CHECKING:
    from ruamel.yaml import YAML
    from ruamel.yaml.composer import Composer

# A spec is written by hand or by a script; whatever is larger is none.
MOST_BYTES = 1 << 20
_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[^\s\[\]{},:"]+|[\[\]{},:]')
# What is wrong with JSON, by the start of the message of Python's reader.
_JSON_FAULTS = {
    "Expecting ',' delimiter": "a comma or a closing bracket is missing here",
    "Expecting ':' delimiter": "a colon is missing here, between key and value",
    "Expecting property name": "a key is expected here, a text in double quotes",
    "Expecting value": "a value is expected here; texts need double quotes, and there are no comments",
    "Illegal trailing comma": "no comma stands before a closing bracket",
    "Extra data": "nothing may follow here",
    "Unterminated": "these quotes are never closed",
    "Invalid control": "a line break or an invisible character within quotes; write \\n or \\t",
}
_OWN = "tag:yaml.org,2002:"
_NUMBERS = tuple(_OWN + kind for kind in ("bool", "int", "float"))


def parse(path: Path) -> Tree:
    """The values of a YAML or JSON file.

    Raises FileError where it cannot be read, SpecError where its text is neither.
    """
    suffix = path.suffix.lower()
    if suffix not in (".yaml", ".yml", ".json"):
        raise FileError(f"{path}: a spec is a .yaml, .yml or .json file")
    read = json_values if suffix == ".json" else yaml_values
    values, spot = read(str(path), text_of(path, most=MOST_BYTES))
    if not isinstance(values, dict):
        raise SpecError([Fault(spot.place, "", "a spec is a mapping: version, steps and so on")])
    return Tree(str(path), values, spot)


def json_values(file: str, text: str) -> tuple[Any, Spot]:
    """The values of a text in JSON; SpecError where it is none, or has a key twice."""
    spots = Spots(file, text)
    try:
        # Numbers as mere words: some have more digits than Python reads.
        json.loads(text, parse_int=len, parse_float=len, parse_constant=len)
    except json.JSONDecodeError as error:
        words = (known for start, known in _JSON_FAULTS.items() if error.msg.startswith(start))
        # Since Python 3.13 the place of a comma too many is the comma, before that what follows it.
        at = error.pos + error.msg.startswith("Illegal")
        raise _not_json(spots, at, next(words, error.msg)) from None
    except RecursionError:
        raise SpecError([Fault(spots.place(0), "", TOO_MUCH)]) from None
    tokens = _TOKEN.finditer(text)
    return _json_value(next(tokens), tokens, spots, 0)


def _json_value(
    token: re.Match[str], tokens: Iterator[re.Match[str]], spots: Spots, depth: int
) -> tuple[Any, Spot]:
    """The value that begins with a token, and its spot."""
    word, at = token[0], token.start()
    spot = spots.spot(at, depth)
    if word not in ("{", "["):
        spots.check_number(word, at)
        if word.lstrip("-") in ("NaN", "Infinity"):
            raise _not_json(spots, at, f"{word} is not a valid JSON number")
        value = json.loads(word)
        if isinstance(value, str):
            spots.check_text(value, at)
        return value, spot
    found: dict[str | int, Any] = {}
    for one in tokens:
        if one[0] in ("}", "]"):
            break
        if one[0] == ",":
            continue
        key: str | int = len(found)
        if word == "{":
            key = str(json.loads(one[0]))
            spots.check_text(key, one.start())
            if key in found:
                raise _not_json(spots, one.start(), f"duplicate key '{key}'")
            next(tokens)  # the colon
            one = next(tokens)
        found[key], spot.below[key] = _json_value(one, tokens, spots, depth + 1)
    return (found if word == "{" else list(found.values())), spot


def _not_json(spots: Spots, at: int, text: str) -> SpecError:
    return SpecError([Fault(spots.place(at), "", f"not valid JSON: {text}")])


def yaml_values(file: str, text: str) -> tuple[Any, Spot]:
    """The values of a text in YAML 1.2, in which ``no`` and ``on`` are words; SpecError where it is none."""
    from ruamel.yaml import YAML
    from ruamel.yaml.error import MarkedYAMLError, YAMLError
    from ruamel.yaml.reader import ReaderError

    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = _bounded(file, text)
    try:
        root = yaml.compose(text)
        if root is None:
            return None, Spot(Place(file, 1, 1))
        value, spot = _Yaml(file, text, yaml).value(root, ())
        return value, Spot(Place(file, 1, 1), spot.below)
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = Place(file, mark.line + 1, mark.column + 1) if mark else Place(file, 1, 1)
        raise SpecError([Fault(place, "", f"not valid YAML: {error.problem or error.context}")]) from error
    except ReaderError as error:
        place = Spots(file, text).place(int(error.position))
        words = f"not valid YAML: a character that cannot be seen (U+{error.character:04X})"
        raise SpecError([Fault(place, "", words)]) from error
    except (YAMLError, ValueError) as error:
        raise SpecError([Fault(Place(file, 1, 1), "", f"not valid YAML: {_first_line(error)}")]) from error


def _bounded(file: str, text: str) -> type[Composer]:
    """Puts a document together, and refuses one that is too large or too deep while it is read."""
    from ruamel.yaml.composer import Composer
    from ruamel.yaml.events import CollectionStartEvent

    class Bounded(Composer):
        spots, around = Spots(file, text), 0

        def compose_node(self, parent: Any, index: Any) -> Any:
            is_key, event = index is None and parent is not None, self.parser.peek_event()
            depth = self.around + isinstance(event, CollectionStartEvent)
            if not is_key or depth > MOST_DEEP:
                mark = event.start_mark
                self.spots.spot(Place(file, mark.line + 1, mark.column + 1), depth)
            self.around += 1
            try:
                return super().compose_node(parent, index)
            finally:
                self.around -= 1

    return Bounded


class _Yaml:
    """Takes the nodes of a document apart."""

    def __init__(self, file: str, text: str, yaml: YAML) -> None:
        self._file, self._yaml, self._spots = file, yaml, Spots(file, text)

    def value(self, node: Any, around: tuple[int, ...]) -> tuple[Any, Spot]:
        """A node's value and spot. around: what it stands in, for an alias may lead back there."""
        spot = self._spots.spot(self._position(node), len(around))
        if node.tag and not node.tag.startswith(_OWN):
            raise self._wrong(node, f"the tag {node.tag} means nothing in a spec")
        if id(node) in around:
            raise self._wrong(node, "an alias refers to a value that contains it")
        inner = (*around, id(node))
        if node.id == "scalar":
            return self._scalar(node), spot
        found: dict[str | int, Any] = {}
        if node.id == "sequence":
            for number, item in enumerate(node.value):
                found[number], spot.below[number] = self.value(item, inner)
            return list(found.values()), spot
        for key, at, item in self._members(node, {}):
            found[key], below = self.value(item, inner)
            # A mapping or list is reported at the word before it.
            spot.below[key] = below if item.id == "scalar" else Spot(at, below.below)
        return found, spot

    def _members(self, node: Any, merging: dict[int, Any]) -> list[tuple[str, Place, Any]]:
        """Keys with their places and values; of mappings that are merged in (<<) those that it lacks."""
        own: dict[str, tuple[str, Place, Any]] = {}
        merged: list[Any] = []
        for key, item in node.value:
            if key.id != "scalar":
                raise self._wrong(key, "a key is a word")
            self._spots.check_text(key.value, self._position(key))
            if key.tag == f"{_OWN}merge":
                merged += item.value if item.id == "sequence" else [item]
            elif key.value in own:
                raise self._wrong(key, f"found duplicate key '{key.value}'")
            else:
                own[key.value] = (key.value, self._position(key), item)
        for other in merged:
            if other.id != "mapping" or id(other) in merging:
                raise self._wrong(other, "<< takes other mappings in")
            self._spots.spot(self._position(other), len(merging))  # merged ones merge others, manifold
            for name, at, item in self._members(other, {**merging, id(node): node}):
                own.setdefault(name, (name, at, item))
        return list(own.values())

    def _scalar(self, node: Any) -> Any:
        """A number or truth value as such, dates and all else as the text that they are."""
        if node.tag in _NUMBERS:
            self._spots.check_number(node.value, self._position(node))
            return self._yaml.constructor.construct_object(node)
        if node.tag == f"{_OWN}null":
            return None
        self._spots.check_text(str(node.value), self._position(node))
        return str(node.value)

    def _position(self, node: Any) -> Place:
        mark = node.start_mark
        return Place(self._file, mark.line + 1, mark.column + 1)

    def _wrong(self, node: Any, text: str) -> SpecError:
        return SpecError([Fault(self._position(node), "", f"not valid YAML: {text}")])


def _first_line(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
