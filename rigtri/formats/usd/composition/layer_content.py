"""Whether the bytes of a layer are sound, before USD reads them: tables of crates, brackets of texts.

USD's parser of texts calls itself for each bracket in another: some ten thousand take gigabytes, or the
end of the stack.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from pxr import Ar, Sdf, Tf

from rigtri.errors import FileError
from rigtri.files.mapped_file import load
from rigtri.formats.usd import usdz
from rigtri.formats.usd.crate import tables
from rigtri.formats.usd.text.statements import COMMENTS, STRINGS

# How deep packages may be nested.
NESTED = 4
# Tuples, arrays and metadata are some ten deep at most; prims and dictionaries stand in braces.
MOST_BRACKETS, MOST_BRACES = 1000, 5000

# Bytes that are counted at a time.
_CHUNK = 1 << 20
_MARKS = (b'"', b"'", b"@", b"#", b"/")
_SKIPPED = re.compile(STRINGS + rb"|" + COMMENTS)
_KINDS = (("brackets", b"([", b")]", MOST_BRACKETS), ("braces", b"{", b"}", MOST_BRACES))


def check(identifier: str) -> None:
    """FileError for a damaged crate, and a text with too deep brackets; of a package, for all its entries."""
    file = outer_file(Sdf.Layer.SplitIdentifier(identifier)[0])
    if not file.is_file() or not file.stat().st_size:
        return
    if file.suffix.lower() == ".usdz":
        _check_entries(usdz.read(file), str(file), NESTED)
        return
    content = load(file)
    if not _is_crate(content):
        _check_brackets(content, str(file))
    elif why := why_unread(identifier) if tables.is_cut_off(content) else "":
        raise FileError(f"{file}: USD cannot read it: {why}. Export it again with the program that wrote it")
    else:
        tables.check(content, str(file))


def why_unread(identifier: str) -> str:
    """Why USD cannot open a layer, in its own words; "" where it can, or says nothing.

    Not for any damaged crate: reading one may end the process.
    """
    try:
        Sdf.Layer.FindOrOpen(identifier)
    except Tf.ErrorException as error:
        return next((str(one.commentary) for one in error.args if hasattr(one, "commentary")), "")
    return ""


def is_cut_off(identifier: str) -> bool:
    """Whether a layer is a crate that is not whole, which USD reports and leaves out unharmed."""
    file = Path(Sdf.Layer.SplitIdentifier(identifier)[0])
    content = load(file) if file.is_file() else memoryview(b"")
    return _is_crate(content) and tables.is_cut_off(content)


def outer_file(name: str) -> Path:
    """A file, or the package it is in: ``[`` may also stand in the name of a folder."""
    return Path(Ar.SplitPackageRelativePathOuter(name)[0])


def _is_crate(content: memoryview) -> bool:
    return content[: len(tables.MAGIC)] == tables.MAGIC


def _check_entries(whole: usdz.Package, name: str, deeper: int) -> None:
    """The same for the entries of a package, and of packages in it."""
    for entry in whole.entries:
        content = memoryview(whole.content)[entry.start : entry.start + entry.size]
        title = f"{name}[{entry.name}]"
        if _is_crate(content):
            tables.check(content, title)
        elif entry.name.lower().endswith((".usd", ".usda")):
            _check_brackets(content, title)
        elif entry.name.lower().endswith(".usdz") and not entry.method:
            if not deeper:
                raise FileError(f"{title}: packages are nested more than {NESTED} deep. Unpack them")
            try:
                inner = usdz.parse(bytes(content), title)
            except FileError:
                continue  # USD cannot open it either, which is reported where it is needed
            _check_entries(inner, title, deeper - 1)


def _check_brackets(text: memoryview, name: str) -> None:
    """FileError, with the line, for a text whose brackets USD's parser may not survive."""
    content, plain = bytes(text), b""
    for what, opening, closing, most in _KINDS:
        # No more can be nested than there are; many files end here.
        if sum(map(content.count, opening)) <= most:
            continue
        plain = plain or _without_words(content)
        if (place := _too_deep(plain, opening, closing, most)) >= 0:
            line = plain.count(b"\n", 0, place) + 1
            raise FileError(
                f"{name}: more than {most} {what} are nested in line {line}, which USD cannot read. "
                "The file is damaged; export it again"
            )


def _too_deep(plain: bytes, opening: bytes, closing: bytes, most: int) -> int:
    """Where more than ``most`` brackets of a kind are open; −1 where they never are."""
    step, depth = np.zeros(256, np.int8), 0
    step[list(opening)], step[list(closing)] = 1, -1
    others = bytes(np.flatnonzero(step == 0).tolist())
    for start in range(0, len(plain), _CHUNK):
        chunk = plain[start : start + _CHUNK]
        brackets = np.frombuffer(chunk.translate(None, others), np.uint8)
        open_there = depth + np.cumsum(step[brackets], dtype=np.int64)
        deep = np.flatnonzero(open_there > most)
        if len(deep):
            places = np.flatnonzero(step[np.frombuffer(chunk, np.uint8)])
            return start + int(places[deep[0]])
        depth = int(open_there[-1]) if len(open_there) else depth
    return -1


def _without_words(content: bytes) -> bytes:
    """The text with strings, asset paths and comments blank, but for their line ends."""
    parts: list[bytes] = []
    at, start = 0, 0
    ahead = dict.fromkeys(_MARKS, -1)  # a find for each is far faster than a search for any
    while True:
        for mark, place in ahead.items():
            if 0 <= place < at or (not at and place < 0):
                ahead[mark] = content.find(mark, at)
        found = [place for place in ahead.values() if place >= 0]
        if not found:
            return b"".join([*parts, content[start:]])
        here = min(found)
        word = _SKIPPED.match(content, here)
        at = word.end() if word else here + 1
        if word:
            parts += [content[start:here], b"\n" * word[0].count(b"\n")]
            start = at
