"""A changed JSON as text in which all that has not changed is the very text that was read.

Numbers keep their spelling (``1.0``, ``1e-8``, ``-0``), texts their escapes, lists their
line breaks. What has changed is known by identity: `Draft` copies only what it touches.
"""

from __future__ import annotations

import json
import re
from typing import Any, NamedTuple

from rigtri.formats.gltf.spelling import Spelling

_scan = json.JSONDecoder().raw_decode
_BLANK = re.compile(r"[ \t\n\r]*")


class _Part(NamedTuple):
    """A member or an item: the blanks before it, its key and colon, its value, blanks before a comma."""

    lead: str
    head: str
    start: int
    end: int
    tail: str = ""


def splice(text: str, old: dict[str, Any], new: dict[str, Any], spelling: Spelling) -> str:
    """``text``, which says ``old``, with what of ``new`` is another object spelled anew.

    ValueError for a new number that JSON cannot hold.
    """
    start = _skip(text, 0)
    pieces = [text[:start]]
    end = _Splicer(text, spelling, pieces).value(start, old, new, 0)
    return "".join([*pieces, text[end:]])


class _Splicer:
    def __init__(self, text: str, spelling: Spelling, pieces: list[str]) -> None:
        self.text, self.spelling, self.pieces = text, spelling, pieces

    def value(self, at: int, old: Any, new: Any, depth: int) -> int:
        """Add the text of ``new``, where that of ``old`` starts at ``at``; returns where that ends."""
        if new is not old and isinstance(new, dict) and isinstance(old, dict) and old:
            return self._object(at, old, new, depth)
        if new is not old and isinstance(new, list) and isinstance(old, list) and old:
            return self._list(at, old, new, depth)
        _, end = _scan(self.text, at)
        self.pieces.append(self.text[at:end] if new is old else self.spelling.fragment(new, depth))
        return int(end)

    def _object(self, at: int, old: dict[str, Any], new: dict[str, Any], depth: int) -> int:
        # Of a key that stands twice only the last was read, and only that is kept.
        members: dict[str, _Part] = {}
        at, more = at + 1, True
        while more:
            start = _skip(self.text, at)
            key, colon = _scan(self.text, start)
            value = _skip(self.text, _skip(self.text, colon) + 1)
            part, at, more = self._part(at, start, value)
            members[key] = part
        ending = self.text[part.end : at - 1]
        self.pieces.append("{")
        tail = ""
        for number, (key, item) in enumerate(new.items()):
            self.pieces.append(f"{tail}," if number else "")
            tail = ""
            if key in members:
                part = members[key]
                self.pieces += [part.lead, part.head]
                self.value(part.start, old[key], item, depth + 1)
                tail = part.tail
            else:
                lead = next(iter(members.values())).lead if not number else self._lead(members)
                colon_text = self.spelling.fragment(key, depth) + self.spelling.colon
                self.pieces += [lead, colon_text, self.spelling.fragment(item, depth + 1)]
        self.pieces += [ending, "}"]
        return at

    def _list(self, at: int, old: list[Any], new: list[Any], depth: int) -> int:
        parts: list[_Part] = []
        at, more = at + 1, True
        while more:
            start = _skip(self.text, at)
            part, at, more = self._part(at, start, start)
            parts.append(part)
        ending = self.text[parts[-1].end : at - 1]
        places = {id(item): k for k, item in enumerate(old) if isinstance(item, dict | list | float)}
        self.pieces.append("[")
        tail = ""
        for number, item in enumerate(new):
            place = number if number < len(old) and old[number] is item else places.get(id(item), number)
            part = parts[min(number, len(parts) - 1)]
            self.pieces += [f"{tail}," if number else "", part.lead]
            tail = part.tail if number < len(parts) else ""
            if place < len(old):
                self.value(parts[place].start, old[place], item, depth + 1)
            else:
                self.pieces.append(self.spelling.fragment(item, depth + 1))
        self.pieces += [ending, "]"]
        return at

    def _part(self, before: int, start: int, value: int) -> tuple[_Part, int, bool]:
        """The part that starts there; where the next one starts, or the whole ends, and which of both."""
        text = self.text
        _, end = _scan(text, value)
        at = _skip(text, end)
        more = text[at] == ","
        tail = text[end:at] if more else ""
        return _Part(text[before:start], text[start:value], value, end, tail), at + 1, more

    @staticmethod
    def _lead(members: dict[str, _Part]) -> str:
        return list(members.values())[-1].lead


def _skip(text: str, at: int) -> int:
    found = _BLANK.match(text, at)
    return found.end() if found else at
