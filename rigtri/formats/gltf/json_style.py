"""How a JSON text is spelled: parsing it strictly, and writing a changed one the same way."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from contextlib import suppress
from math import isfinite
from types import MappingProxyType
from typing import Any, NoReturn

from rigtri.model.dataclass import dataclass

_SURROGATE = re.compile("[\ud800-\udfff]")
_NUMBER = r"-?\d[\d.eE+-]*"
_INLINE = re.compile(rf"\[([ \t]*){_NUMBER}(,[ \t]*){_NUMBER}(?:,[ \t]*{_NUMBER})*[ \t]*\]")
# A raw newline cannot stand in a JSON string, so this never reaches into one.
_SPREAD = re.compile(rf"\[\n\s*({_NUMBER}(?:,\n\s*{_NUMBER})*)\n\s*\]")
_BLANK = re.compile(r"[ \t\n\r]*")
BLANKS = " \t\n\r"
# Where to look for habits; a file has them from the start.
_SAMPLE = 100_000


def parse(text: str, *, lenient: bool = False) -> Any:
    """The value of a JSON text. ValueError, with the place, for what JSON does not allow.

    NaN and Infinity are refused, and an object with one key twice, of which only
    one could be kept; ``lenient`` takes the last one. RecursionError when nested too deep.
    """
    hook = None if lenient else _once
    return json.loads(text, object_pairs_hook=hook, parse_constant=_no_constant)


def parse_placed(
    text: str, *, lenient: bool = False, known: Mapping[str, tuple[str, Any]] = MappingProxyType({})
) -> tuple[Any, dict[int, int]]:
    """As `parse`; also where the values of the outermost object end, by where they start.

    known: by key, the text of an object or a list and what it is. What is spelled so is not parsed again.
    """
    if not lenient:
        with suppress(ValueError, StopIteration, IndexError):  # which parsing the whole text explains
            return _members(text, known)
    return parse(text, lenient=lenient), {}


def _members(text: str, known: Mapping[str, tuple[str, Any]]) -> tuple[dict[str, Any], dict[int, int]]:
    pairs: list[tuple[str, Any]] = []
    ends: dict[int, int] = {}
    at, follows = skip(text, 0), "{"
    while text[at] == follows:
        key, at = _scan(text, skip(text, at + 1))
        colon = skip(text, at)
        if type(key) is not str or text[colon] != ":":
            raise ValueError("a key should stand here, and a colon behind it")
        start = skip(text, colon + 1)
        spelled, value = known.get(key, ("", None))
        if spelled and text.startswith(spelled, start):
            end = start + len(spelled)
        else:
            value, end = _scan(text, start)
        pairs.append((key, value))
        ends[start] = end
        at, follows = skip(text, end), ","
    if not pairs or text[at] != "}" or text[at + 1 :].strip(BLANKS):
        raise ValueError("this is not a single object")
    return _once(pairs), ends


def skip(text: str, at: int) -> int:
    """The first place from ``at`` on where no blank stands."""
    if text[at] > " ":  # as nearly always in a text on one line
        return at
    found = _BLANK.match(text, at)
    return found.end() if found else at


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f"an object has the key '{twice}' twice")
    return found


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a JSON number")


# Of C, without a call around it. One for each object costs less than to count keys and members afterwards.
_scan = json.JSONDecoder(object_pairs_hook=_once, parse_constant=_no_constant).scan_once  # type: ignore[attr-defined]


def encode(text: str) -> bytes:
    """A JSON text as UTF-8. Half of a surrogate pair has none; as an escape it stays what it was."""
    try:
        return text.encode()
    except UnicodeEncodeError:
        return _SURROGATE.sub(lambda half: f"\\u{ord(half[0]):04x}", text).encode()


@dataclass(frozen=True)
class Spelling:
    """Habits of a JSON text.

    indent: None for a text on one line. colon, comma: with the spaces around them.
    inline: what follows ``[`` and each comma in a list of numbers that stands on
    one line of an indented text, None where each number has its own.
    """

    indent: str | None = None
    colon: str = ":"
    comma: str = ","
    newline: str = "\n"
    end: str = ""
    ascii: bool = True
    inline: tuple[str, str] | None = None

    @staticmethod
    def of(text: str) -> Spelling:
        """The habits of ``text``, which is valid JSON."""
        sample = text[:_SAMPLE]
        opening = re.match(r"\s*\{(\s*)\"", sample)
        space = opening[1] if opening else ""
        indent = space.rpartition("\n")[2] if "\n" in space else None
        colon = re.search(r'"([ \t]*:[ \t]*)', sample)
        comma = re.search(r'["\d\]}](,[ \t]*)["\[{\d-]', sample)
        numbers = _INLINE.search(sample) if indent is not None else None
        return Spelling(
            indent=indent,
            colon=colon[1] if colon else ":",
            comma=comma[1] if comma and indent is None else ",",
            newline="\r\n" if "\r\n" in space else "\n",
            end=text[len(text.rstrip()) :],
            ascii=text.isascii(),
            inline=(numbers[1], numbers[2]) if numbers else None,
        )

    def fragment(self, value: Any, depth: int = 0) -> str:
        """``value`` as a part of a text, ``depth`` levels deep. ValueError for what JSON cannot hold."""
        if (type(value) is float and isfinite(value)) or type(value) is int:
            return repr(value)
        text = json.dumps(
            value,
            indent=self.indent,
            separators=(self.comma, self.colon),
            ensure_ascii=self.ascii,
            allow_nan=False,
        )
        if self.inline is not None:
            text = _SPREAD.sub(self._on_one_line, text)
        if self.indent and depth:
            text = text.replace("\n", "\n" + self.indent * depth)
        return text.replace("\n", self.newline) if self.newline != "\n" else text

    def _on_one_line(self, spread: re.Match[str]) -> str:
        padding, comma = self.inline or ("", ",")
        numbers = [number.strip() for number in spread[1].split(",")]
        return f"[{padding}{comma.join(numbers)}{padding}]"
