"""Text in TOML as values and their places, which tomllib does not tell."""

from __future__ import annotations

import re
import tomllib
from contextlib import suppress
from typing import Any

from rigtri.pipeline.rigspec.errors import Fault, Place, SpecError
from rigtri.pipeline.rigspec.positions import MOST_DEEP, Spot, Spots

_BLANK = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_BASIC, _LITERAL = r'"(?:[^"\\\n]|\\.)*"', r"'[^'\n]*'"
_KEY = re.compile(rf"[ \t]*([A-Za-z0-9_-]+|{_BASIC}|{_LITERAL})[ \t]*")
_VALUE = re.compile(
    rf'"""(?:[^\\]|\\.)*?"{{3,5}}(?!")|\'\'\'.*?\'{{3,5}}(?!\')|{_BASIC}|{_LITERAL}|[^,\]}}#\n]+', re.DOTALL
)
# tomllib takes time with the square of the parts of such a key.
_ENDLESS_KEY = re.compile(rf"(?<![\w-])(?:[\"']?[\w-]+[\"']?[ \t]*\.[ \t]*){{{MOST_DEEP},}}")


def read(file: str, text: str) -> tuple[Any, Spot]:
    """The values in a text; SpecError where it is no TOML."""
    if found := _ENDLESS_KEY.search(text):
        Spots(file, text).spot(found.start(), MOST_DEEP + 1)
    try:
        values = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        words = re.sub(r" \(at .*\)$", "", str(error))
        raise SpecError([Fault(_place(file, text, str(error)), "", f"no TOML: {words}")]) from error
    except (
        ValueError,
        RecursionError,
    ):  # too long a number, or too deep: told at its place by our own reader
        values = None
    spot = _Reader(file, text).document()
    return _plain(values), spot


def _place(file: str, text: str, said: str) -> Place:
    """Where an error of tomllib is. SpecError for a bracket that is never closed, at that."""
    if found := re.search(r"\(at line (\d+), column (\d+)\)", said):
        return Place(file, *map(int, found.groups()))
    with suppress(IndexError):
        _Reader(file, text).document()
    return Spots(file, text).place(len(text.rstrip()))


def _plain(value: Any) -> Any:
    """Dates as texts."""
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_plain(part) for part in value]
    return value if isinstance(value, bool | int | float | str) else str(value)


class _Reader:
    """Goes through a text that is known to be TOML, and notes where each value begins."""

    def __init__(self, file: str, text: str) -> None:
        self._text, self._spots = text, Spots(file, text)
        self._root = Spot(Place(file, 1, 1))

    def document(self) -> Spot:
        """The spot of the whole, with those of all values."""
        table, at = self._root, self._blank(0)
        while at < len(self._text):
            if self._text.startswith("[[", at):
                keys, end = self._keys(at + 2)
                array = self._down(self._root, keys, at)
                table = array.below[len(array.below)] = self._spots.spot(at, len(keys))
                end += 2
            elif self._text[at] == "[":
                keys, end = self._keys(at + 1)
                table, end = _last(self._down(self._root, keys, at)), end + 1
            else:
                end = self._pair(table, at, 0)
            at = self._blank(end)
        return self._root

    def _pair(self, table: Spot, at: int, depth: int) -> int:
        """A key with its value, as part of a table; where it ends."""
        keys, end = self._keys(at)
        spot, end = self._value(self._blank(end + 1), depth + len(keys))
        above = self._down(table, keys[:-1], at)
        # A table or list is told at the word before it.
        above.below[keys[-1]] = Spot(self._spots.place(at), spot.below) if spot.below else spot
        return end

    def _value(self, at: int, depth: int) -> tuple[Spot, int]:
        spot, opening = self._spots.spot(at, depth), self._text[at]
        if opening not in "[{":
            found = _VALUE.match(self._text, at)
            self._spots.check_number(found[0].strip() if found else "", spot.place)
            return spot, found.end() if found else at + 1
        close = "]" if opening == "[" else "}"
        at = self._blank(at + 1)
        while self._text[at : at + 1] != close:
            if at == len(self._text):
                raise SpecError([Fault(spot.place, "", f"no TOML: this {opening} is never closed")])
            if opening == "[":
                spot.below[len(spot.below)], at = self._value(at, depth + 1)
            else:
                at = self._pair(spot, at, depth)
            at = self._blank(at)
            if self._text.startswith(",", at):
                at = self._blank(at + 1)
        return spot, at + 1

    def _keys(self, at: int) -> tuple[list[str], int]:
        """The parts of a dotted key, and where it ends."""
        keys: list[str] = []
        while found := _KEY.match(self._text, at):
            word, at = found[1], found.end()
            keys.append(next(iter(tomllib.loads(f"{word} = 1"))) if word[0] in "\"'" else word)
            if not self._text.startswith(".", at):
                break
            at += 1
        if len(keys) > MOST_DEEP:
            self._spots.spot(at, len(keys))
        return keys, at

    def _down(self, spot: Spot, keys: list[str], at: int) -> Spot:
        """The spot that keys lead to, of an array of tables by its last one."""
        for key in keys:
            spot = _last(spot)
            if key not in spot.below:
                spot.below[key] = self._spots.spot(at, 0)
            spot = spot.below[key]
        return spot

    def _blank(self, at: int) -> int:
        found = _BLANK.match(self._text, at)
        return found.end() if found else at


def _last(spot: Spot) -> Spot:
    """Of an array of tables the last, of a table itself."""
    return spot.below[len(spot.below) - 1] if 0 in spot.below else spot
