"""A changed layer as its own old text with the changes in it, and every other byte as it was.

What changed, and how it is spelled, is known from USD: it writes the layer before and after as text,
and where the two differ, what is new is put into the source's text. Numbers, words and strings of
a value are changed one by one, so that layout, comments and the spelling of the others stay. USD
then reads the outcome and writes it once more, which must give the text of the edited layer,
so that nothing here needs to know the whole grammar to be safe.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from pathlib import Path
from typing import Any

from pxr import Sdf, Tf

from rigtri.files import temp_dirs
from rigtri.formats.usd.text.statements import COMMENTS, STRINGS, Item, Span, Text, UnknownTextError

# Blocks up to this depth are compared as a whole before they are taken apart.
_SHALLOW = 64
# How far back the start of a line is looked for.
_LINE = 4096
_STEP = 4
_TRAIL = re.compile(rb"[ \t;]*(?:#[^\r\n]*|//[^\r\n]*)?(?=\r|\n|\Z)")
_SEPARATOR, _INDENTED = re.compile(rb"[ \t]*;?"), re.compile(rb"\n([ \t]{1,8})[^\s]")
# A line end and an empty line behind it, at most so long.
_EMPTY, _EMPTY_LINE = re.compile(rb"(\n)[ \t]*\r?\n\Z"), 64
# Strings first, so that what looks like a comment in one is none.
_WORDS = re.compile(STRINGS + rb"|" + COMMENTS)
_REST = re.compile(rb"[ \t;]*\r?\n")


def spliced(content: bytes, before: Any, edited: Any, lost: list[str] | None = None) -> bytes:
    """The text of a layer with what differs between ``before``, which it holds, and ``edited``.

    lost: gets the names of the values that were written anew and had comments in them.
    UnknownTextError, with the reason, where that text would not hold what ``edited`` holds.
    """
    with temp_dirs.folder() as folder:
        names = ("before", "edited", "spliced", "seen")
        was, now, made, seen = (Path(folder, f"{name}.usda") for name in names)
        for layer, path in zip(_without_same(before, edited), (was, now), strict=True):
            layer.Export(str(path))
        splice = _Splice(Text(content), Text(was.read_bytes()), Text(now.read_bytes()))
        text = splice.text()
        made.write_bytes(text)
        try:
            layer = Sdf.Layer.OpenAsAnonymous(str(made))
        except Tf.ErrorException as error:
            raise UnknownTextError("USD does not read the changed text") from error
        for one, path in zip(_without_same(layer, edited), (seen, now), strict=True):
            one.Export(str(path))
        # The first line has the version of the format, which the source keeps.
        if _behind_first_line(seen.read_bytes()) != _behind_first_line(now.read_bytes()):
            raise UnknownTextError("USD reads something else from the changed text")
        if lost is not None:
            lost += splice.lost
        return text


def _without_same(one: Any, other: Any) -> tuple[Any, Any]:
    """Copies of two layers without the default arrays that both hold alike, which most of a text is."""
    same: list[Any] = []

    def compare(path: Any) -> None:
        specs = one.GetAttributeAtPath(path), other.GetAttributeAtPath(path)
        if all(spec and spec.typeName.isArray and spec.HasDefaultValue() for spec in specs):
            mine, theirs = (spec.default for spec in specs)
            if type(mine) is type(theirs) and mine == theirs:
                same.append(path)

    one.Traverse(Sdf.Path.absoluteRootPath, compare)
    copies = Sdf.Layer.CreateAnonymous(".usda"), Sdf.Layer.CreateAnonymous(".usda")
    for copy, layer in zip(copies, (one, other), strict=True):
        copy.TransferContent(layer)
        with Sdf.ChangeBlock():
            for path in same:
                copy.GetAttributeAtPath(path).ClearDefaultValue()
    return copies


def _behind_first_line(text: bytes) -> memoryview:
    return memoryview(text)[text.find(b"\n") + 1 :]


class _Splice:
    """Three texts side by side, and the cuts that make the edited text of the source."""

    def __init__(self, source: Text, before: Text, edited: Text) -> None:
        self.source, self.before, self.edited = source, before, edited
        self.cuts: list[tuple[int, int, bytes]] = []
        self.lost: list[str] = []
        self.blocks: list[tuple[int, str, tuple[Item, Item, Item], tuple[Span, Span, Span]]] = []
        head = source.content[:65536]
        unit = _INDENTED.search(head)
        self.unit = unit[1] if unit else b" " * _STEP
        self.newline = b"\r\n" if b"\r\n" in head[: head.find(b"\n") + 1] else b"\n"

    def text(self) -> bytes:
        """The source with all cuts made."""
        self._item(0, self.source.top(), self.before.top(), self.edited.top())
        while self.blocks:
            self._block(*self.blocks.pop())
        content, at = memoryview(self.source.content), 0
        parts: list[bytes | memoryview] = []
        for start, end, text in sorted(self.cuts, key=lambda cut: cut[:2]):
            if start < at:
                raise UnknownTextError("changes that overlap")
            parts += (content[at:start], text)
            at = end
        return b"".join((*parts, content[at:]))

    def _item(self, depth: int, mine: Item, was: Item, now: Item) -> None:
        """Change one statement; blocks in it wait."""
        if self.before.of((was.start, was.head_end)) != self.edited.of((now.start, now.head_end)):
            self.cuts.append((mine.start, mine.head_end, self.edited.of((now.start, now.head_end))))
        if self.before.of(was.value) != self.edited.of(now.value):
            self._value(mine, was, now)
        if self.before.of(was.meta) != self.edited.of(now.meta):
            self._meta(depth, mine, was, now)
        if mine.body and was.body and now.body:
            self.blocks.append((depth + 1, now.kind, (mine, was, now), (mine.body, was.body, now.body)))

    def _value(self, mine: Item, was: Item, now: Item) -> None:
        if now.value is None or mine.value is None or was.value is None:
            text = b"" if now.value is None else b" = " + self._edited_part(now.value, now, mine)
            self.cuts.append((mine.head_end, mine.value[1] if mine.value else mine.head_end, text))
        elif mine.key.endswith(b".timeSamples") and self.source.of(mine.value)[:1] == b"{":
            if not self._samples(mine, was, now):
                self._record_lost(mine)
                self.cuts.append((*mine.value, self._edited_part(now.value, now, mine)))
        else:
            self.cuts.append((*mine.value, self._respelled(mine, was, now)))

    def _samples(self, mine: Item, was: Item, now: Item) -> bool:
        """Change samples one by one; False where their times are others."""
        sides = []
        for text, item in ((self.source, mine), (self.before, was), (self.edited, now)):
            start, end = item.value or (0, 0)
            sides.append({sample.key: sample for sample in text.items((start + 1, end - 1), "samples")})
        sources, old, new = sides
        if not sources.keys() == old.keys() == new.keys():
            return False
        for key, sample in new.items():
            if self.before.of(old[key].value) != self.edited.of(sample.value):
                self.cuts.append(
                    (*_sure(sources[key].value), self._respelled(sources[key], old[key], sample))
                )
        return True

    def _respelled(self, mine: Item, was: Item, now: Item) -> bytes:
        """The source's value with only those numbers, words and strings changed that are others."""
        value, old, new = _sure(mine.value), _sure(was.value), _sure(now.value)
        canonical, text = self.before.of(old), self.source.of(value)
        if text == canonical and b"\n" not in text:
            return self.edited.of(new)
        sources, olds, news = self.source.atoms(value), self.before.atoms(old), self.edited.atoms(new)
        # USD sorts dictionaries, so positions mean nothing there.
        if not len(sources) == len(olds) == len(news) or text[:1] == b"{":
            self._record_lost(mine)
            return self._edited_part(new, now, mine)
        parts, at = [], value[0]
        for (start, end), before, after in zip(sources, olds, news, strict=True):
            atom = self.edited.of(after)
            if self.before.of(before) != atom:
                parts += [self.source.content[at:start], atom]
                at = end
        return b"".join([*parts, self.source.content[at : value[1]]])

    def _record_lost(self, mine: Item) -> None:
        """Record a value that is written anew as a whole, if comments stand in it."""
        if any(word[0][:1] in b"#/" for word in _WORDS.finditer(self.source.of(mine.value))):
            self.lost.append((mine.name or mine.key).decode(errors="replace"))

    def _meta(self, depth: int, mine: Item, was: Item, now: Item) -> None:
        if mine.meta and was.meta and now.meta:
            self.blocks.append((depth + 1, "meta", (mine, was, now), (mine.meta, was.meta, now.meta)))
            return
        at = mine.value[1] if mine.value else mine.head_end
        if now.meta is None:
            if mine.meta is not None:
                self.cuts.append((at, mine.meta[1] + 1, b""))
            return
        part = self._edited_part((now.meta[0] - 1, now.meta[1] + 1), now, mine)
        if mine.meta is not None:
            self.cuts.append((mine.meta[0] - 1, mine.meta[1] + 1, part))
        elif not mine.key:
            raise UnknownTextError("a layer without metadata")
        else:
            self.cuts.append((at, at, b" " + part))

    def _block(
        self, depth: int, kind: str, items: tuple[Item, Item, Item], spans: tuple[Span, Span, Span]
    ) -> None:
        """Change the statements of a block, take out those that are gone and put in the new ones."""
        before, edited = self.before, self.edited
        if depth <= _SHALLOW and before.of(spans[1]) == edited.of(spans[2]):
            return
        listed = list(self.source.items(spans[0], kind))
        sources = {item.key: item for item in listed}
        olds = {item.key: item for item in before.items(spans[1], kind)}
        news = {item.key: item for item in edited.items(spans[2], kind)}
        added = []
        for key, item in news.items():
            old, mine = olds.get(key), sources.get(key)
            if old is None:
                added.append(item)
            elif mine is not None:
                self._item(depth, mine, old, item)
            elif before.of((old.start, old.end)) != edited.of((item.start, item.end)):
                raise self.source.unknown(spans[0][0], f"no statement '{key.decode(errors='replace')}'")
        gone = olds.keys() - news.keys()
        if self._empties(spans[0], items[0], listed, gone, added):
            self.cuts.append((*spans[0], b""))
            return
        for mine in listed:
            if mine.key in gone:
                self.cuts.append(self._whole(mine))
        if added:
            self._insert(added, [item for item in listed if item.key not in gone], items[0], spans[0])

    def _empties(
        self, span: Span, owner: Item, listed: list[Item], gone: Collection[bytes], added: list[Item]
    ) -> bool:
        """Whether nothing stays of a prim that opens on its own line: where that was empty it was {}."""
        if added or not listed or any(item.key not in gone for item in listed) or owner.body != span:
            return False
        at, left = span[0], b""
        for item in listed:
            left, at = left + self.source.content[at : item.start], item.end
        left += self.source.content[at : span[1]]
        return owner.kind == "body" and not left.strip() and not self._leads(span[0] - 1)

    def _insert(self, added: Iterable[Item], kept: list[Item], owner: Item, span: Span) -> None:
        """Put new statements behind those of their kind."""
        outer = self._indent(owner.start) if owner.key else b""
        own = next((self._indent(item.start) for item in kept if self._leads(item.start)), None)
        indent = own if own is not None else outer + self.unit if owner.key else b""
        if own is None and owner.meta == span and not owner.key:
            indent = self.unit
        places: dict[int, list[bytes]] = {}
        named = {item.name: item.end for item in kept if item.is_property}
        last_property = max(named.values(), default=span[0])
        last = kept[-1].end if kept else span[0]
        for item in added:
            # Behind the same property's other statement, the last property or the last of all.
            at = named.get(item.name, last_property) if item.is_property else last
            gap = self.newline * (2 if not item.is_property and at > span[0] else 1)
            part = self._moved(self.edited, (item.start, item.end), item.start, indent)
            places.setdefault(at, []).append(gap + indent + part)
        for at, texts in places.items():
            trail = _TRAIL.match(self.source.content, at)
            if trail is not None:
                self.cuts.append((trail.end(), trail.end(), b"".join(texts)))
                continue
            separator = _SEPARATOR.match(self.source.content, at)
            end = separator.end() if separator else at
            closes = not self.source.of((end, span[1])).strip()
            texts.append(self.newline + (outer if closes else indent))
            self.cuts.append((end, end, b"".join(texts)))

    def _whole(self, item: Item) -> tuple[int, int, bytes]:
        """The cut that takes a statement out, with its line where nothing else is in it.

        A prim goes with an empty line above it, as one is put in with it.
        """
        content = self.source.content
        rest = _REST.match(content, item.end)
        if rest is None or not self._leads(item.start):
            return item.start, item.end, b""
        start = item.start - len(self._indent(item.start))
        empty = _EMPTY.search(content, max(0, start - _EMPTY_LINE), start)
        if empty is not None and not item.is_property:
            start = empty.end(1)
        return start, rest.end(), b""

    def _edited_part(self, span: Span, item: Item, mine: Item) -> bytes:
        """A part of a statement of the edited text, indented like one of the source."""
        return self._moved(self.edited, span, item.start, self._indent(mine.start))

    def _moved(self, text: Text, span: Span, start: int, indent: bytes) -> bytes:
        found = text.of(span)
        # A string may go over several lines, which must stay.
        if b"\n" not in found or b'"""' in found or b"'''" in found:
            return found
        base = len(_line(text.content, start))
        first, *lines = found.split(b"\n")
        moved = [first]
        for line in lines:
            bare = line.lstrip(b" ")
            deeper = max(0, len(line) - len(bare) - base) // _STEP
            moved.append(indent + self.unit * deeper + bare if bare else b"")
        return self.newline.join(moved)

    def _leads(self, at: int) -> bool:
        """Whether a statement is the first of its line."""
        return not _line(self.source.content, at).strip(b" \t")

    def _indent(self, at: int) -> bytes:
        line = _line(self.source.content, at)
        return line[: len(line) - len(line.lstrip(b" \t"))]


def _line(content: bytes, at: int) -> bytes:
    """What stands before a place in its line."""
    start = max(0, at - _LINE)
    return content[max(start, content.rfind(b"\n", start, at) + 1) : at]


def _sure(span: Span | None) -> Span:
    if span is None:
        raise UnknownTextError("a sample without a value")
    return span
