"""Text in JSON as values and their places."""

from __future__ import annotations

import json
import re
from typing import Any

from rigtri.pipeline.rigspec.errors import Fault, SpecError
from rigtri.pipeline.rigspec.positions import Spot, Spots

_SPACE = re.compile(r"[ \t\n\r]*")
_WORD = re.compile(r"[^\s,:\[\]{}\"]+")
# What is wrong with a text in quotes, by the start of the message of Python's reader.
_QUOTES = {
    "Unterminated": "these quotes are never closed",
    "Invalid control": "a line break or an invisible character within quotes; write \\n or \\t",
}


def read(file: str, text: str) -> tuple[Any, Spot]:
    """The values in a text; SpecError where it is no JSON."""
    reader = _Reader(text, Spots(file, text))
    value, spot, end = reader.value(0, 0)
    reader.end(end)
    return value, spot


class _Reader:
    """Goes through a text, and notes where each value begins."""

    def __init__(self, text: str, spots: Spots) -> None:
        self._text, self._spots = text, spots
        self._plain = json.JSONDecoder()

    def value(self, at: int, depth: int) -> tuple[Any, Spot, int]:
        """The value that begins behind ``at``, its spot, and where it ends."""
        at = self._space(at)
        spot = self._spots.spot(at, depth)
        opening = self._text[at : at + 1]
        if opening not in ("{", "["):
            value, end = self._scalar(at)
            return value, spot, end
        found: dict[str | int, Any] = {}
        close, begun = {"{": "}", "[": "]"}[opening], at
        at = self._space(at + 1)
        while not self._text.startswith(close, at):
            if found:
                at = self._passed(",", at, f"a comma or {close} is missing here")
            if self._text.startswith(close, at):
                raise self._wrong(at, f"no comma stands before {close}")
            if at == len(self._text):
                break
            key: str | int = len(found)
            if close == "}":
                key, at = self._key(at, found)
            found[key], spot.below[key], at = self.value(at, depth + 1)
            at = self._space(at)
            if at == len(self._text):
                break
        if at == len(self._text):
            raise self._wrong(begun, f"this {opening} is never closed")
        return (found if close == "}" else list(found.values())), spot, at + 1

    def end(self, at: int) -> None:
        """SpecError where anything follows."""
        at = self._space(at)
        if at < len(self._text):
            raise self._wrong(at, "nothing may follow here")

    def _key(self, at: int, known: dict[str | int, Any]) -> tuple[str, int]:
        if not self._text.startswith('"', at):
            raise self._wrong(at, "a key is expected here, a text in double quotes")
        key, end = self._scalar(at)
        if key in known:
            raise self._wrong(at, f"duplicate key '{key}'")
        return key, self._passed(":", self._space(end), "a colon is missing here, between key and value")

    def _scalar(self, at: int) -> tuple[Any, int]:
        """A text in quotes, a number, true, false or null, and where it ends."""
        if not self._text.startswith('"', at):
            word = found[0] if (found := _WORD.match(self._text, at)) else self._text[at : at + 1]
            self._spots.check_number(word, at)
            try:
                return json.loads(word, parse_constant=lambda word: self._no_number(word, at)), at + len(word)
            except json.JSONDecodeError:
                raise self._wrong(at, self._instead(word)) from None
        try:
            return self._plain.raw_decode(self._text, at)
        except json.JSONDecodeError as error:
            words = next((text for start, text in _QUOTES.items() if error.msg.startswith(start)), error.msg)
            raise self._wrong(error.pos, words) from None

    def _no_number(self, word: str, at: int) -> Any:
        raise self._wrong(at, f"{word} is not a valid JSON number")

    def _instead(self, word: str) -> str:
        if word.startswith(("//", "/*", "#")):
            return "JSON has no comments"
        if word.startswith("'"):
            return "texts need double quotes"
        return f"a value is expected here, not {word}" if word else "a value is expected here"

    def _passed(self, mark: str, at: int, lacking: str) -> int:
        """Where it goes on behind a mark."""
        if not self._text.startswith(mark, at):
            raise self._wrong(at, lacking)
        return self._space(at + 1)

    def _space(self, at: int) -> int:
        found = _SPACE.match(self._text, at)
        return found.end() if found else at

    def _wrong(self, at: int, text: str) -> SpecError:
        return SpecError([Fault(self._spots.place(at), "", f"not valid JSON: {text}")])
