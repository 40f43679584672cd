"""Text in JSON as values and their places."""

from __future__ import annotations

import json
import re
from typing import Any, NoReturn

from rigtri.spec.faults import Fault, Place, SpecError
from rigtri.spec.tree import Spot, Spots

_SPACE = re.compile(r"[ \t\n\r]*")


def read(file: str, text: str) -> tuple[Any, Spot]:
    """The values in a text; SpecError where it is no JSON."""
    try:
        json.loads(text, parse_constant=_no_constant)
    except json.JSONDecodeError as error:
        raise SpecError(
            [Fault(Place(file, error.lineno, error.colno), "", f"no JSON: {error.msg}")]
        ) from error
    except (ValueError, RecursionError) as error:
        raise SpecError([Fault(Place(file, 1, 1), "", f"no JSON: {error}")]) from error
    value, spot, _ = _Reader(text, Spots(file, text)).value(0, 0)
    return value, spot


def _no_constant(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number of JSON")


class _Reader:
    """Goes through a text that is known to be JSON, and notes where each value begins."""

    def __init__(self, text: str, spots: Spots) -> None:
        self._text, self._spots = text, spots
        self._plain = json.JSONDecoder()

    def value(self, at: int, depth: int) -> tuple[Any, Spot, int]:
        """The value that begins behind ``at``, its spot, and where it ends."""
        at = self._space(at)
        spot = self._spots.spot(at, depth)
        if self._text[at] not in "{[":
            value, end = self._plain.raw_decode(self._text, at)
            return value, spot, end
        close = "}" if self._text[at] == "{" else "]"
        found: dict[str | int, Any] = {}
        at = self._space(at + 1)
        while self._text[at] != close:
            key: str | int = len(found)
            if close == "}":
                key, at = self._key(at, found)
            found[key], spot.below[key], at = self.value(at, depth + 1)
            at = self._space(at)
            if self._text[at] == ",":
                at = self._space(at + 1)
        return (found if close == "}" else list(found.values())), spot, at + 1

    def _key(self, at: int, known: dict[str | int, Any]) -> tuple[str, int]:
        key, end = self._plain.raw_decode(self._text, at)
        if key in known:
            raise SpecError([Fault(self._spots.place(at), "", f"no JSON: '{key}' is said twice")])
        return key, self._space(end) + 1

    def _space(self, at: int) -> int:
        found = _SPACE.match(self._text, at)
        return found.end() if found else at
