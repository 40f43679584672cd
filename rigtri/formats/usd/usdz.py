"""The .usdz package: an uncompressed zip whose entries start at multiples of 64 bytes.

Packages are rewritten entry by entry: names, order, dates, comments and extra
fields stay; only the padding that the alignment needs is made anew.

Source: USDZ specification (openusd.org/release/spec_usdz.html); PKWARE APPNOTE
6.3, sections 4.3.7, 4.3.12, 4.3.16.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from pathlib import Path, PurePosixPath

from rigtri.errors import FileError
from rigtri.files.mapped_file import load
from rigtri.model.dataclass import dataclass
from rigtri.text import display_name

ALIGNMENT = 64
# The id under which USD keeps its padding in an extra field.
PADDING = 0x1986

_LOCAL = struct.Struct("<4s5H3I2H")
_CENTRAL = struct.Struct("<4s6H3I5H2I")
_END = struct.Struct("<4s4H2IH")
_BLOCK = struct.Struct("<2H")
# Who made an entry, where its external attributes hold the mode of a Unix file.
_UNIX = 3
_ENCRYPTED, _DESCRIPTOR, _UTF8 = 0x0001, 0x0008, 0x0800


@dataclass(frozen=True)
class Entry:
    """One file of a package; ``start`` and ``size`` are where its bytes lie."""

    name: str
    raw_name: bytes
    start: int
    size: int
    crc: int
    made_by: int
    needed: int
    flags: int
    time: int
    date: int
    extra: bytes
    central_extra: bytes
    comment: bytes
    internal: int
    external: int
    # 0 where the bytes are the file's; what is packed otherwise is kept, and USD cannot read it.
    method: int = 0
    unpacked: int = 0


@dataclass(frozen=True)
class Package:
    """The entries of a package in the order of its directory; the first is the root layer."""

    content: bytes
    entries: tuple[Entry, ...]
    # With what follows the end of the package, ``junk`` bytes (below 0 where the comment is cut off).
    comment: bytes
    junk: int = 0

    @property
    def root(self) -> Entry:
        return self.entries[0]

    def bytes_of(self, entry: Entry) -> bytes:
        return self.content[entry.start : entry.start + entry.size]

    def is_whole(self, entry: Entry) -> bool:
        """Whether an entry's bytes have the directory's checksum; compressed ones are not checked."""
        return entry.method != 0 or zlib.crc32(self.bytes_of(entry)) == entry.crc


def empty(name: str) -> Package:
    """A package of one empty layer, to be written with other bytes; its date is that of no file, 1980."""
    raw = name.encode("utf-8")
    flags = 0 if raw.isascii() else _UTF8
    return Package(b"", (Entry(name, raw, 0, 0, 0, 10, 10, flags, 0, 0x21, b"", b"", b"", 0, 0),), b"")


def layer_name(package: Path) -> str:
    """What the layer of a new package is called: without a colon, which some systems take for a drive."""
    return f"{package.stem.replace(':', '_')}.usdc"


def write_new(files: Mapping[str, bytes], part: Path) -> None:
    """Write a package of files by their names, the root layer first; their date is that of no file, 1980."""
    entries, start = [], 0
    for name, content in files.items():
        plain = empty(name).root
        entries.append(
            replace(plain, start=start, size=len(content), unpacked=len(content), crc=zlib.crc32(content))
        )
        start += len(content)
    whole = b"".join(files.values())
    write(Package(whole, tuple(entries), b""), next(iter(files.values())), part)


def read(path: Path) -> Package:
    """Read the directory of a package.

    FileError for what is no .usdz: not a zip, a compressed root layer, encrypted entries,
    names that lead outside, entries that overlap or end outside the file.
    """
    return parse(bytes(load(path)), str(path))


def parse(content: bytes, path: str) -> Package:
    """The same from its bytes; ``path`` names it in errors."""
    at = content.rfind(b"PK\5\6", max(0, len(content) - 65557))
    if at >= 0 and not content.startswith(b"PK"):
        raise FileError(
            f"{path}: other bytes stand in front of the package, so USD does not find it; cut them off."
        )
    if at < 0 or at + _END.size > len(content):
        raise FileError(f"{path}: no .usdz package (not a zip file, or cut off at the end).")
    _, disk, _, _, count, size, start, comment = _END.unpack_from(content, at)
    if disk or 0xFFFF in (count, disk) or 0xFFFFFFFF in (size, start) or start + size > at:
        raise FileError(f"{path}: its zip directory is damaged or a Zip64 one, which .usdz forbids.")
    entries, offset = [], start
    for number in range(count):
        try:
            entry, offset = _entry(content, offset, start)
        except (struct.error, ValueError) as error:
            raise FileError(f"{path}: entry {number + 1} of the package: {error}.") from None
        entries.append(entry)
    _check(path, entries)
    rest = content[at + _END.size :]
    return Package(content, tuple(entries), rest, len(rest) - comment)


def _entry(content: bytes, offset: int, limit: int) -> tuple[Entry, int]:
    (mark, made_by, needed, flags, method, time, date, crc, packed, size, name_size, extra_size,
     comment_size, _, internal, external, local) = _CENTRAL.unpack_from(content, offset)  # fmt: skip
    if mark != b"PK\1\2" or content[local : local + 4] != b"PK\3\4":
        raise ValueError("its record is damaged")
    after = offset + _CENTRAL.size
    raw_name = content[after : after + name_size]
    central_extra = content[after + name_size : after + name_size + extra_size]
    end = after + name_size + extra_size + comment_size
    name = raw_name.decode("utf-8" if flags & _UTF8 else "cp437")
    if method == 0 and packed != size:
        raise ValueError(f"{_title(name)} has two sizes, {packed} and {size} bytes; the directory is damaged")
    if flags & _ENCRYPTED:
        raise ValueError(f"{_title(name)} is encrypted")
    _, _, _, local_method, _, _, _, local_packed, _, local_name_size, local_extra_size = _LOCAL.unpack_from(
        content, local
    )
    named = local + _LOCAL.size
    if content[named : named + local_name_size] != raw_name:
        raise ValueError(f"{_title(name)} has another name in its own header")
    # USD goes by these, other programs by the directory; they must not see different files.
    if local_method != method or (local_packed != packed and not flags & _DESCRIPTOR):
        raise ValueError(f"{_title(name)} has another size in its own header")
    start = named + local_name_size + local_extra_size
    if start + packed > limit:
        raise ValueError(f"{_title(name)} ends outside the package")
    extra = content[named + local_name_size : start]
    comment = content[end - comment_size : end]
    return (
        Entry(name, raw_name, start, packed, crc, made_by, needed, flags, time, date,
              _without_padding(extra), _without_padding(central_extra), comment, internal, external,
              method, size),
        end,
    )  # fmt: skip


def _check(path: str, entries: list[Entry]) -> None:
    if not entries:
        raise FileError(f"{path}: the package is empty.")
    if PurePosixPath(entries[0].name).suffix.lower() not in (".usd", ".usda", ".usdc"):
        raise FileError(f"{path}: the package starts with {_title(entries[0].name)}, not with a USD layer.")
    if entries[0].method:
        raise FileError(
            f"{path}: {_title(entries[0].name)} is compressed, which .usdz forbids; pack it again without."
        )
    names = [entry.name for entry in entries]
    links = {e.name for e in entries if e.made_by >> 8 == _UNIX and (e.external >> 16) & 0o170000 == 0o120000}
    for name in names:
        parts = name.replace("\\", "/").split("/")
        if "\0" in name:
            raise FileError(
                f"{path}: entry {_title(name)} has a zero byte in its name, which no file can have."
            )
        if name in links:
            raise FileError(
                f"{path}: entry {_title(name)} is a link, which no package may have; pack its target."
            )
        if name.startswith(("/", "\\")) or ".." in parts or ":" in parts[0]:
            raise FileError(f"{path}: entry {_title(name)} leads outside the package.")
    if len(set(names)) != len(names):
        double = next(name for name in names if names.count(name) > 1)
        raise FileError(f"{path}: two entries are named {_title(double)}.")
    ordered = sorted(entries, key=lambda entry: entry.start)
    for one, other in pairwise(ordered):
        if one.start + one.size > other.start:
            raise FileError(f"{path}: entries {_title(one.name)} and {_title(other.name)} overlap.")


def _title(name: str) -> str:
    """An entry's name as people are told it: a damaged directory holds any, up to 65,535 characters."""
    return f"'{display_name(name)}'"


def _without_padding(extra: bytes) -> bytes:
    """An extra field without USD's padding; one that is not made of blocks stays as it is."""
    kept, at = b"", 0
    while at + _BLOCK.size <= len(extra):
        block, size = _BLOCK.unpack_from(extra, at)
        end = at + _BLOCK.size + size
        if end > len(extra):
            return extra
        if block != PADDING:
            kept += extra[at:end]
        at = end
    return kept + (extra[at:] if extra[at:].strip(b"\0") else b"")


def write(package: Package, root: bytes, part: Path) -> None:
    """Write the package to ``part`` with other bytes for its root layer."""
    directory, written = [], 0
    with part.open("wb") as sink:
        for entry in package.entries:
            data = root if entry is package.root else package.bytes_of(entry)
            crc = zlib.crc32(data) if entry is package.root else entry.crc
            flags = entry.flags & ~_DESCRIPTOR
            extra = entry.extra + _pad(written + _LOCAL.size + len(entry.raw_name) + len(entry.extra))
            size = entry.unpacked if entry.method else len(data)
            header = (b"PK\3\4", entry.needed, flags, entry.method, entry.time, entry.date, crc, len(data),
                      size, len(entry.raw_name), len(extra))  # fmt: skip
            record = (b"PK\1\2", entry.made_by, entry.needed, flags, entry.method, entry.time, entry.date,
                      crc, len(data), size, len(entry.raw_name), len(entry.central_extra),
                      len(entry.comment), 0, entry.internal, entry.external, written)  # fmt: skip
            directory.append(_CENTRAL.pack(*record) + entry.raw_name + entry.central_extra + entry.comment)
            local = _LOCAL.pack(*header) + entry.raw_name + extra
            sink.write(local)
            sink.write(data)
            written += len(local) + len(data)
        listing, count = b"".join(directory), len(directory)
        sink.write(listing)
        comment = len(package.comment) - max(package.junk, 0)
        sink.write(_END.pack(b"PK\5\6", 0, 0, count, count, len(listing), written, comment) + package.comment)


def _pad(unpadded: int) -> bytes:
    """An extra block that makes what follows start at a multiple of 64; none where it does already."""
    missing = -unpadded % ALIGNMENT
    if missing == 0:
        return b""
    if missing < _BLOCK.size:
        missing += ALIGNMENT
    return _BLOCK.pack(PADDING, missing - _BLOCK.size) + bytes(missing - _BLOCK.size)
