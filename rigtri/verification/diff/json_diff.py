"""How two JSON texts differ: members by pointer, their order, and how they are spelled."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from dataclasses import fields
from typing import Any

from rigtri.errors import FileError
from rigtri.formats.gltf.json_style import Spelling
from rigtri.verification.diff.change import SHOWN, Change, Kind, furthest, order_of, rows

GROUP = "json"
# Rows of numbers up to this long are shown.
FEW = 4
# Where the JSON names an accessor.
_REFERENCE = re.compile(
    r"/(meshes/\d+/primitives/\d+/(indices|attributes/[^/]+|targets/\d+/[^/]+)"
    r"|skins/\d+/inverseBindMatrices|animations/\d+/samplers/\d+/(input|output))$"
)
# Says whether two accessors hold the same, in words; "" where they do.
Contents = Callable[[int, int], str]


class Token(str):
    """A number as it is spelled."""

    __slots__ = ()

    @property
    def value(self) -> float | int:
        return int(self) if self.lstrip("-").isdigit() else float(self)


def tokens(text: str, where: str) -> Any:
    """A JSON text with its numbers as they are spelled."""
    try:
        return json.loads(text, parse_float=Token, parse_int=Token, parse_constant=Token)
    except (ValueError, RecursionError) as error:
        raise FileError(f"{where}: this is not valid JSON: {error}") from None


def json_changes(before: Any, after: Any, contents: Contents, tolerance: float) -> list[Change]:
    """The members that differ between two values of `tokens`. contents: compares accessors."""
    walk = _Walk(contents, tolerance)
    try:
        walk.compare(before, after, "")
    except RecursionError:
        raise FileError("the JSON is nested too deep to be compared") from None
    return walk.found


class _Walk:
    def __init__(self, contents: Contents, tolerance: float) -> None:
        self.contents, self.tolerance = contents, tolerance
        self.found: list[Change] = []

    def compare(self, before: Any, after: Any, pointer: str) -> None:
        if isinstance(before, dict) and isinstance(after, dict):
            self._objects(before, after, pointer)
        elif isinstance(before, list) and isinstance(after, list):
            self._lists(before, after, pointer)
        elif isinstance(before, Token) and isinstance(after, Token):
            self._numbers(before, after, pointer)
        elif type(before) is not type(after) or before != after:
            self._add("changed", pointer, _arrow(before, after))

    def _add(self, kind: Kind, pointer: str, text: str) -> None:
        self.found.append(Change(GROUP, kind, pointer or "/", text))

    def _objects(self, before: dict[str, Any], after: dict[str, Any], pointer: str) -> None:
        for key, value in before.items():
            below = _pointer_to(pointer, key)
            if key not in after:
                self._add("removed", below, spelled(value))
            else:
                self.compare(value, after[key], below)
        for key, value in after.items():
            if key not in before:
                self._add("added", _pointer_to(pointer, key), spelled(value))
        if text := order_of(list(before), list(after)):
            self._add("moved", pointer, f"order of keys: {text}")

    def _lists(self, before: list[Any], after: list[Any], pointer: str) -> None:
        if len(before) == len(after) and _numeric(before) and _numeric(after):
            self._rows(before, after, pointer)
            return
        if before != after and len(before) == len(after) and _numeric(before) != _numeric(after):
            self._add("changed", pointer, _arrow(before, after))
            return
        if _scalars(before) and _scalars(after) and len(before) != len(after):
            self._add("changed", pointer, _arrow(before, after))
            return
        for number, (one, other) in enumerate(zip(before, after, strict=False)):
            self.compare(one, other, f"{pointer}/{number}")
        for number in range(len(after), len(before)):
            self._add("removed", f"{pointer}/{number}", spelled(before[number]))
        for number in range(len(before), len(after)):
            self._add("added", f"{pointer}/{number}", spelled(after[number]))

    def _rows(self, before: list[Token], after: list[Token], pointer: str) -> None:
        if before == after:
            return
        if all(self._same(one, other) for one, other in zip(before, after, strict=True)):
            if not self.tolerance:
                self._add("changed", pointer, f"spelled {spelled(before)} → {spelled(after)}")
        else:
            one, other = ([_float(x.value) for x in row] for row in (before, after))
            self._add("changed", pointer, rows(one, other) if len(one) <= FEW else furthest(one, other))

    def _same(self, before: Token, after: Token) -> bool:
        if before == after:
            return True
        one, other = before.value, after.value
        if one == other and before.startswith("-") == after.startswith("-"):
            return True
        return bool(self.tolerance and abs(_float(one) - _float(other)) <= self.tolerance)

    def _numbers(self, before: Token, after: Token, pointer: str) -> None:
        if before == after:
            return
        if self._same(before, after):
            if not self.tolerance:
                self._add("changed", pointer, f"spelled {before} → {after}")
        elif _REFERENCE.search(pointer):
            text = self.contents(_index(before), _index(after))
            kind: Kind = "changed" if text else "moved"
            self._add(kind, pointer, f"accessor {before} → {after}, {text or 'equal content'}")
        else:
            self._add("changed", pointer, f"{before} → {after}")


def _pointer_to(pointer: str, key: str) -> str:
    """The JSON pointer of a member. Source: RFC 6901 §3."""
    return f"{pointer}/{key.replace('~', '~0').replace('/', '~1')}"


def _index(token: Token) -> int:
    """The number as an index; −1 for what is none."""
    value = token.value
    return value if isinstance(value, int) else -1


def _numeric(values: list[Any]) -> bool:
    return all(isinstance(x, Token) for x in values)


def _scalars(values: list[Any]) -> bool:
    return not any(isinstance(x, dict | list) for x in values)


def _arrow(before: Any, after: Any) -> str:
    one, other = spelled(before), spelled(after)
    if one == other and isinstance(before, str) and isinstance(after, str):
        at = next((k for k, (a, b) in enumerate(zip(before, after, strict=False)) if a != b), 0)
        return f"{len(before)} → {len(after)} characters, the first other one at {at}"
    return f"{one} → {other}"


def spelled(value: Any) -> str:
    """A JSON value on one line, cut off where it is long."""
    text = _spelled(value)
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 3]}..."


def _spelled(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{{', '.join(f'{_spelled(key)}: {_spelled(item)}' for key, item in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(_spelled, value))}]"
    return str(value) if isinstance(value, Token) else json.dumps(value, ensure_ascii=False)


def spelling_changes(before: str, after: str) -> Iterator[Change]:
    """Habits of the two texts: indentation, blanks, line ends, escapes, byte order mark."""
    if before.startswith("\ufeff") != after.startswith("\ufeff"):
        kind: Kind = "removed" if before.startswith("\ufeff") else "added"
        yield Change("spelling", kind, "byte order mark")
    one, other = (Spelling.of(text.removeprefix("\ufeff")) for text in (before, after))
    for field in fields(Spelling):
        was, now = getattr(one, field.name), getattr(other, field.name)
        if was != now:
            name = {"end": "blanks at the end", "ascii": "ASCII only"}.get(field.name, field.name)
            yield Change("spelling", "changed", name, f"{was!r} → {now!r}")


def _float(number: int | float) -> float:
    """A number of JSON, which may be an integer of any size, as far as floats go."""
    try:
        return float(number)
    except OverflowError:
        return float("inf") if number > 0 else float("-inf")
