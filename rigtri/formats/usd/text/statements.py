"""Where the statements of a text layer stand, as far as it takes to change one and leave the others.

This is no parser of USD's grammar: it knows strings, comments, brackets, and the heads of prims,
properties and metadata, and raises where it meets something else. Blocks are taken apart when
they are read, and their ends are known from one pass, so that depth costs nothing.

Source: OpenUSD, USDA file format specification; measured with usd-core 26.11.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

Span = tuple[int, int]

# Strings and asset paths, and comments, wherever one starts.
STRINGS = (
    rb'(?s:"""[^"\\]*(?:(?:\\.|"(?!""))[^"\\]*)*"""|"[^"\\]*(?:\\.[^"\\]*)*"'
    rb"|\'\'\'[^'\\]*(?:(?:\\.|'(?!''))[^'\\]*)*\'\'\'|'[^'\\]*(?:\\.[^'\\]*)*'"
    rb"|@@@(?:\\@@@|(?!@@@).)*@@@@{0,2}|@[^@\r\n]*@)"
)
COMMENTS = rb"\#[^\r\n]*|//[^\r\n]*|(?s:/\*.*?\*/)"
_STRING = re.compile(STRINGS)
_COMMENT = re.compile(COMMENTS)


# Where brackets of a kind may stand, or strings and comments, in which they count for nothing.
_BRACES, _BRACKETS = re.compile(rb"[{}\"'@#/]"), re.compile(rb"[\[\]\"'@#/]")
_PARENTHESES = re.compile(rb"[()\"'@#/]")
# An array without strings, comments and arrays in it.
_FLAT = re.compile(rb"\[[^\[\]\"'@#/]*\]")
_SPACE, _INLINE = re.compile(rb"[\s;]*"), re.compile(rb"[ \t]*")
_WORD = re.compile(rb"[^\s=(){};,\"'@#<>\[\]/]+(?:\[\])?")
_PATH = re.compile(rb"<[^<>\r\n]*>")
_TIME = re.compile(rb"([^\s:,]+)\s*:\s*")
_COMMAS = re.compile(rb"[\s,]*")
# What a value consists of beside brackets and separators; comments have no group.
_ATOM = re.compile(rb"(" + STRINGS + rb"|<[^<>\r\n]*>|[^\s,;:=()\[\]{}\"'@#<>/]+)|" + COMMENTS)

# Statements of one block; more would take too much memory.
MOST = 500_000
_PRIMS = (b"def", b"over", b"class")
_LISTS = (b"add", b"prepend", b"append", b"delete", b"reorder")


class UnknownTextError(Exception):
    """The text of a layer has something that is not known here; nothing was changed."""


@dataclass(frozen=True, slots=True)
class Item:
    """A statement: its head, its value, its metadata and what is in its braces, each as a span.

    meta, body: inside the brackets. kind: of what is in the body. end: where all of it ends.
    """

    key: bytes
    start: int
    head_end: int
    value: Span | None
    meta: Span | None
    body: Span | None
    end: int
    kind: str = "body"

    @property
    def is_property(self) -> bool:
        return self.body is None

    @property
    def name(self) -> bytes:
        """The name of a property without what follows its dot."""
        return self.key.rpartition(b" ")[2].partition(b".")[0]


class Text:
    """The text of a layer. UnknownTextError where brackets or strings do not end."""

    def __init__(self, content: bytes) -> None:
        self.content = content
        self._closing = self._braces()

    def of(self, span: Span | None) -> bytes:
        return b"" if span is None else self.content[span[0] : span[1]]

    def top(self) -> Item:
        """The layer as a statement: its metadata, and its prims as a body without braces."""
        at, meta = self._blank(0, len(self.content)), None
        if self._starts(at, b"("):
            end = self._bracket(at, _PARENTHESES)
            meta, at = (at + 1, end - 1), end
        return Item(b"", 0, 0, None, meta, (at, len(self.content)), len(self.content))

    def items(self, span: Span, kind: str) -> Iterator[Item]:
        """The statements in a block: of a ``body``, ``meta``, a ``set`` of variants, or ``samples``."""
        at, end = span
        blank = self._commas if kind == "samples" else self._blank
        at, count = blank(at, end), 0
        while at < end:
            count += 1
            if count > MOST:
                raise self.unknown(at, f"more than {MOST} statements in one block")
            item = self._sample(at) if kind == "samples" else self._item(at, end, kind)
            if item.end > end:
                raise self.unknown(at, "a statement that does not end in its block")
            yield item
            at = blank(item.end, end)

    def atoms(self, span: Span) -> list[Span]:
        """The numbers, words, strings and paths of a value."""
        return [m.span() for m in _ATOM.finditer(self.content, *span) if m[1] is not None]

    def unknown(self, at: int, what: str) -> UnknownTextError:
        line = self.content.count(b"\n", 0, at) + 1
        return UnknownTextError(f"{what} in line {line}")

    def _braces(self) -> dict[int, int]:
        """For each brace that opens, where the one that closes it stands."""
        found: dict[int, int] = {}
        opened: list[int] = []
        for at, mark in self._marks(0, _BRACES):
            if mark == b"{":
                opened.append(at)
                continue
            if not opened:
                raise self.unknown(at, "a brace that nothing opens")
            found[opened.pop()] = at
        if opened:
            raise self.unknown(opened[-1], "a brace that nothing closes")
        return found

    def _marks(self, at: int, pattern: re.Pattern[bytes]) -> Iterator[tuple[int, bytes]]:
        """Where the brackets of a pattern stand, outside of strings and comments."""
        content = self.content
        while mark := pattern.search(content, at):
            start, text = mark.start(), mark[0]
            if text in b"{}[]()":
                at = start + 1
                yield start, text
            elif text == b"/" and content[start + 1 : start + 2] not in (b"/", b"*"):
                at = start + 1
            else:
                within = (_COMMENT if text in b"#/" else _STRING).match(content, start)
                if within is None:
                    raise self.unknown(start, "a string or comment that does not end")
                at = within.end()

    def _starts(self, at: int, what: bytes) -> bool:
        return self.content.startswith(what, at)

    def _blank(self, at: int, end: int) -> int:
        """Where the next statement starts, behind blanks, semicolons and comments."""
        while True:
            at = _span(_SPACE, self.content, at)
            comment = _COMMENT.match(self.content, at)
            if comment is None or at >= end:
                return min(at, end)
            at = comment.end()

    def _commas(self, at: int, end: int) -> int:
        while True:
            at = _span(_COMMAS, self.content, self._blank(at, end))
            if at >= end or not (self._starts(at, b"#") or self._starts(at, b"/")):
                return min(at, end)

    def _item(self, at: int, end: int, kind: str) -> Item:
        words, head_end = self._words(at)
        name, after = b"", _span(_INLINE, self.content, head_end)
        string = _STRING.match(self.content, after)
        if string is not None:
            if kind == "meta" and not words:
                return Item(b"comment", at, at, string.span(), None, None, string.end())
            name, head_end = string[0].strip(b"\"'"), string.end()
        if kind == "set" and string is not None and not words:
            return self._braced(b"variant " + name, at, head_end, end, "body")
        if kind == "body" and words[:1] == [b"variantSet"]:
            return self._braced(b"variantSet " + name, at, head_end, end, "set")
        if kind == "body" and words and words[0] in _PRIMS and string is not None:
            return self._braced(b"prim " + name, at, head_end, end, "body")
        if string is not None or kind == "set" or not words or (kind == "body" and len(words) < 2):
            raise self.unknown(at, "a statement of an unknown kind")
        key = b" ".join(words)
        if kind == "body":
            key = (words[0] + b" " if words[0] in _LISTS else b"") + words[-1]
        return self._valued(key, at, head_end, end, kind)

    def _words(self, at: int) -> tuple[list[bytes], int]:
        words, after = [], at
        while word := _WORD.match(self.content, at):
            words.append(word[0])
            after, at = word.end(), _span(_INLINE, self.content, word.end())
        return words, after

    def _braced(self, key: bytes, start: int, head_end: int, end: int, kind: str) -> Item:
        """A prim, variant or set of variants."""
        at, meta = self._blank(head_end, end), None
        if self._starts(at, b"="):
            at = self._blank(at + 1, end)
        if self._starts(at, b"("):
            close = self._bracket(at, _PARENTHESES)
            meta, at = (at + 1, close - 1), self._blank(close, end)
        if at not in self._closing:
            raise self.unknown(at, "a prim or variant without braces")
        close = self._closing[at]
        return Item(key, start, head_end, None, meta, (at + 1, close), close + 1, kind)

    def _valued(self, key: bytes, start: int, head_end: int, end: int, kind: str) -> Item:
        """A property or an entry of metadata."""
        last, value, meta = head_end, None, None
        at = _span(_INLINE, self.content, head_end)
        if self._starts(at, b"="):
            at = self._blank(at + 1, end)
            last = self._value(at)
            if kind == "meta":
                last = self._longer(last)
            value = (at, last)
        if kind == "body":
            at = self._blank(last, end)
            if self._starts(at, b"("):
                last = self._bracket(at, _PARENTHESES)
                meta = (at + 1, last - 1)
        return Item(key, start, head_end, value, meta, None, last)

    def _sample(self, at: int) -> Item:
        time = _TIME.match(self.content, at)
        if time is None:
            raise self.unknown(at, "a time sample of an unknown form")
        try:
            key = repr(float(time[1])).encode()
        except ValueError:
            raise self.unknown(at, "a time that is not a number") from None
        end = self._value(time.end())
        return Item(key, at, time.end(1), (time.end(), end), None, None, end)

    def _value(self, at: int) -> int:
        """Where a value ends."""
        if self._starts(at, b"["):
            flat = _FLAT.match(self.content, at)
            return flat.end() if flat else self._bracket(at, _BRACKETS)
        if self._starts(at, b"("):
            return self._bracket(at, _PARENTHESES)
        if self._starts(at, b"{"):
            return self._closing[at] + 1
        for pattern in (_STRING, _PATH, _WORD):
            if found := pattern.match(self.content, at):
                return found.end()
        raise self.unknown(at, "a value of an unknown form")

    def _longer(self, at: int) -> int:
        """Where the value of metadata ends: a path and an offset may follow an asset."""
        while True:
            after = _span(_INLINE, self.content, at)
            if not (self._starts(after, b"<") or self._starts(after, b"(")):
                return at
            at = self._value(after)

    def _bracket(self, at: int, marks: re.Pattern[bytes]) -> int:
        """Where the bracket that opens at ``at`` is closed, one behind it."""
        depth, opening = 0, self.content[at : at + 1]
        for place, mark in self._marks(at, marks):
            depth += 1 if mark == opening else -1
            if depth == 0:
                return place + 1
        raise self.unknown(at, "a bracket that nothing closes")


def _span(pattern: re.Pattern[bytes], content: bytes, at: int) -> int:
    """Where what a pattern that always fits finds ends."""
    found = pattern.match(content, at)
    return at if found is None else found.end()
