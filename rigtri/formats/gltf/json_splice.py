"""A changed JSON as text in which all that has not changed is the very text that was read.

Numbers keep their spelling (``1.0``, ``1e-8``, ``-0``), texts their escapes, lists their
line breaks. What has changed is known by identity: `Draft` copies only what it touches.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from rigtri.formats.gltf.json_style import BLANKS, Spelling, skip

_scan = json.JSONDecoder().scan_once  # type: ignore[attr-defined]  # of C, without a call around it
_NUMBERS = frozenset([float, int])
_NUMBER = re.compile(r"[^][,\s]+")


class _Part(NamedTuple):
    """A member or an item: the blanks before it, its key and colon, its value, blanks before a comma."""

    lead: str
    head: str
    start: int
    end: int
    tail: str = ""


def splice(
    text: str,
    old: dict[str, Any],
    new: dict[str, Any],
    spelling: Spelling,
    ends: Mapping[int, int] = MappingProxyType({}),
) -> str:
    """``text``, which spells ``old``, with what of ``new`` is another object spelled anew.

    ends: where values end, by where they start, as far as known; these are not read again.
    ValueError for a new number that JSON cannot hold.
    """
    start = skip(text, 0)
    spliced, end = _Splicer(text, spelling, ends).spliced(start, old, new, 0)
    return text[:start] + spliced + text[end:]


class _Splicer:
    """Finds what to replace: (start, end, text) in the order of the text, each read once."""

    def __init__(self, text: str, spelling: Spelling, ends: Mapping[int, int]) -> None:
        self.text, self.spelling, self.ends = text, spelling, ends
        self.edits: list[tuple[int, int, str]] = []

    def spliced(self, at: int, old: Any, new: Any, depth: int) -> tuple[str, int]:
        """The text of ``new``, where that of ``old`` starts at ``at``, and where the latter ends."""
        inner = _Splicer(self.text, self.spelling, self.ends)
        whole = inner.value(at, old, new, depth)
        pieces = []
        for start, end, changed in inner.edits:
            pieces += [self.text[at:start], changed]
            at = end
        return "".join([*pieces, self.text[at:whole]]), whole

    def value(self, at: int, old: Any, new: Any, depth: int) -> int:
        """Note what of the text of ``old``, which starts at ``at``, ``new`` changes; gives its end."""
        if new is not old and old:
            if isinstance(new, dict) and isinstance(old, dict):
                return self._object(at, old, new, depth)
            if isinstance(new, list) and isinstance(old, list):
                return self._list(at, old, new, depth)
        end = self.ends.get(at) or _scan(self.text, at)[1]
        if new is not old:
            self.edits.append((at, end, self.spelling.fragment(new, depth)))
        return end

    def _object(self, at: int, old: dict[str, Any], new: dict[str, Any], depth: int) -> int:
        known = len(self.edits)
        end = self._members(at, old, new, depth)
        if end < 0:
            del self.edits[known:]
            spliced, end = self._object_anew(at, old, new, depth)
            self.edits.append((at, end, spliced))
        return end

    def _members(self, at: int, old: dict[str, Any], new: dict[str, Any], depth: int) -> int:
        """As `value` where all that was there stays in its order; −1 where it does not."""
        text, keys, more = self.text, iter(new), True
        while more:
            before = at + 1
            start = before if text[before] > " " else skip(text, before)
            key, colon = _scan(text, start)
            if next(keys, None) != key:
                return -1
            at = (colon if text[colon] > " " else skip(text, colon)) + 1
            at = at if text[at] > " " else skip(text, at)
            was, now = old[key], new[key]
            end = self.value(at, was, now, depth + 1)
            at = end if text[end] > " " else skip(text, end)
            more = text[at] == ","
        added = [
            f",{text[before:start]}{self.spelling.fragment(key, depth)}{self.spelling.colon}"
            f"{self.spelling.fragment(new[key], depth + 1)}"
            for key in keys
        ]
        if added:
            self.edits.append((end, end, "".join(added)))
        return at + 1

    def _object_anew(self, at: int, old: dict[str, Any], new: dict[str, Any], depth: int) -> tuple[str, int]:
        # Of a key that stands twice only the last was read, and only that is kept.
        members: dict[str, _Part] = {}
        at, more = at + 1, True
        while more:
            start = skip(self.text, at)
            key, colon = _scan(self.text, start)
            value = skip(self.text, skip(self.text, colon) + 1)
            part, at, more = self._part(at, start, value)
            members[key] = part
        ending = self.text[part.end : at - 1]
        pieces, tail = ["{"], ""
        for number, (key, item) in enumerate(new.items()):
            pieces.append(f"{tail}," if number else "")
            tail = ""
            if key in members:
                part = members[key]
                pieces += [part.lead, part.head, self.spliced(part.start, old[key], item, depth + 1)[0]]
                tail = part.tail
            else:
                lead = next(iter(members.values())).lead if not number else self._lead(members)
                colon_text = self.spelling.fragment(key, depth) + self.spelling.colon
                pieces += [lead, colon_text, self.spelling.fragment(item, depth + 1)]
        return "".join([*pieces, ending, "}"]), at

    def _list(self, at: int, old: list[Any], new: list[Any], depth: int) -> int:
        if _NUMBERS.issuperset(map(type, old)):
            spliced, end = self._numbers(at, old, new, depth)
        elif self._by_key(at, end := self.ends.get(at, -1), old, new, depth):
            return end
        elif _in_order(old, new):
            return self._items(at, old, new, depth)
        else:
            spliced, end = self._list_anew(at, old, new, depth)
        self.edits.append((at, end, spliced))
        return end

    def _by_key(self, at: int, end: int, old: list[Any], new: list[Any], depth: int) -> bool:
        """As `value` for objects that keep their keys, found by those that change; False where not sure.

        Without escapes a quoted key cannot stand inside a text, and where there are only as many as the
        objects have themselves, none stands below them or is a value.
        """
        text = self.text
        if end < 0 or len(old) != len(new) or text.find("\\", at, end) >= 0:
            return False
        changed = [(was, now) for was, now in zip(old, new, strict=True) if now is not was]
        if not set(map(id, old)).isdisjoint(id(now) for _, now in changed):
            return False
        keys: set[str] = set()
        for was, now in changed:
            if type(was) is not dict or type(now) is not dict or list(was) != list(now):
                return False
            keys.update([key for key in was if was[key] is not now[key]])
        for key in keys:
            expected = sum([type(was) is dict and key in was for was in old])
            if not key.isalpha() or text.count(f'"{key}"', at, end) != expected:
                return False
        for was, now in zip(old, new, strict=True):
            for key in [key for key in was if key in keys] if type(was) is dict else ():
                at = text.index(f'"{key}"', at) + len(key) + 2
                if was[key] is not now[key]:
                    colon = skip(text, at)
                    at = self.value(skip(text, colon + 1), was[key], now[key], depth + 2)
        return True

    def _items(self, at: int, old: list[Any], new: list[Any], depth: int) -> int:
        """As `value` where all that was there stays in its order."""
        text = self.text
        for was, item in zip(old, new, strict=False):
            before = at + 1
            start = skip(text, before)
            end = _scan(text, start)[1] if item is was else self.value(start, was, item, depth + 1)
            at = skip(text, end)
        added = [
            f",{text[before:start]}{self.spelling.fragment(item, depth + 1)}" for item in new[len(old) :]
        ]
        if added:
            self.edits.append((end, end, "".join(added)))
        return at + 1

    def _numbers(self, at: int, old: list[Any], new: list[Any], depth: int) -> tuple[str, int]:
        """The text of a list that held numbers alone, and where the old one ends."""
        end = self.text.index("]", at)
        anew = set(map(id, old)).isdisjoint(map(id, new))
        if anew and len(self.text[at:end].split()) == 1:
            if _NUMBERS.issuperset(map(type, new)) and "n" not in (spliced := repr(new)):
                return spliced.replace(" ", ""), end + 1
            spliced = ",".join([self.spelling.fragment(item, depth + 1) for item in new])
            return f"[{spliced}]", end + 1
        if anew and len(new) == len(old):  # each stands where the old one stood
            fresh = iter([self.spelling.fragment(item, depth + 1) for item in new])
            return _NUMBER.sub(lambda _: next(fresh), self.text[at : end + 1]), end + 1
        parts, places = self.text[at + 1 : end].split(","), _places(old)
        items, last = [], len(parts) - 1
        for number, item in enumerate(new):
            place = number if number < len(old) and old[number] is item else places.get(id(item), number)
            kept = place < len(old) and old[place] is item
            value = parts[place].strip(BLANKS) if kept else self.spelling.fragment(item, depth + 1)
            around = parts[min(number, last)]
            lead = around[: len(around) - len(around.lstrip(BLANKS))]
            tail = around[len(around.rstrip(BLANKS)) :] if number < last else ""
            items.append(f"{lead}{value}{tail if number < len(new) - 1 else ''}")
        ending = parts[last][len(parts[last].rstrip(BLANKS)) :]
        return f"[{','.join(items)}{ending}]", end + 1

    def _list_anew(self, at: int, old: list[Any], new: list[Any], depth: int) -> tuple[str, int]:
        parts: list[_Part] = []
        at, more = at + 1, True
        while more:
            start = skip(self.text, at)
            part, at, more = self._part(at, start, start)
            parts.append(part)
        ending = self.text[parts[-1].end : at - 1]
        places = _places(old)
        pieces, tail = ["["], ""
        for number, item in enumerate(new):
            place = number if number < len(old) and old[number] is item else places.get(id(item), number)
            part = parts[min(number, len(parts) - 1)]
            pieces += [f"{tail}," if number else "", part.lead]
            tail = part.tail if number < len(parts) else ""
            if place < len(old):
                pieces.append(self.spliced(parts[place].start, old[place], item, depth + 1)[0])
            else:
                pieces.append(self.spelling.fragment(item, depth + 1))
        return "".join([*pieces, ending, "]"]), at

    def _part(self, before: int, start: int, value: int) -> tuple[_Part, int, bool]:
        """The part that starts there; where the next one starts, or the whole ends, and which of both."""
        text = self.text
        _, end = _scan(text, value)
        at = skip(text, end)
        more = text[at] == ","
        tail = text[end:at] if more else ""
        return _Part(text[before:start], text[start:value], value, end, tail), at + 1, more

    @staticmethod
    def _lead(members: dict[str, _Part]) -> str:
        return list(members.values())[-1].lead


def _places(old: list[Any]) -> dict[int, int]:
    """Where each item stands that is an object of its own."""
    return {id(item): k for k, item in enumerate(old) if isinstance(item, dict | list | float)}


def _in_order(old: list[Any], new: list[Any]) -> bool:
    """Whether a list still has all of its items, changed or not, where they were."""
    places = _places(old)
    return len(new) >= len(old) and all(
        places.get(id(item), number) == number for number, item in enumerate(new)
    )
