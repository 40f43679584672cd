"""Whether the tables and values of a crate (.usdc) can be what they claim, before usd-core believes them.

usd-core allocates what a crate claims, and follows its tables without looking: one
wrong byte costs gigabytes or never ends. Nothing here is kept; a crate that passes is
opened by usd-core.

Source: OpenUSD, pxr/usd/usd: crateFile.h, crateFile.cpp, integerCoding.cpp, crateDataTypes.h,
crateValueInliners.h (versions 0.4.0 to 0.13.0).
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import TypeVar

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.usd.crate import children, lz4
from rigtri.formats.usd.crate.children import NO_FIELD, Words
from rigtri.maths.arrays import Integers

MAGIC = b"PXR-USDC"
_BOOTSTRAP = struct.Struct("<8s8Bq")
_SECTION = struct.Struct("<16sqq")
# usd-core reads no older ones, in which less is packed.
_OLDEST = (0, 4, 0)
# From this version on the number of items of an array takes eight bytes.
_WIDE = (0, 7, 0)
_KINDS_OF_SPEC = 12
# A packed integer takes two bits of what LZ4 shrinks at most 255 times.
_MOST_INTEGERS = 4 * lz4.MOST

_ARRAY, _INLINED, _COMPRESSED = 1 << 63, 1 << 62, 1 << 61
_STRING, _TOKEN, _ASSET, _TIMES, _TIME_SAMPLES = 10, 11, 12, 48, 46
# Type → bytes of one item of an array; strings, tokens, paths and expressions are indices.
_SIZES = {
    1: 1, 2: 1, 3: 4, 4: 4, 5: 8, 6: 8, 7: 2, 8: 4, 9: 8, 10: 4, 11: 4, 12: 4, 13: 32, 14: 72, 15: 128,
    16: 32, 17: 16, 18: 8, 19: 16, 20: 8, 21: 4, 22: 8, 23: 24, 24: 12, 25: 6, 26: 12, 27: 32, 28: 16,
    29: 8, 30: 16, 56: 8, 57: 4,
}  # fmt: skip
# The same by number, 0 for other types.
_ITEM = np.array([_SIZES.get(kind, 0) for kind in range(256)])
# Type → bytes that one item takes at least, of those that start with a count.
_COUNTED = {31: 12, 40: 4, 41: 4, 45: 8, 48: 8, 49: 16, 50: 4, 58: 8}
# Lists of edits: a byte whose bits are the lists that follow, then each with its count.
_LISTS = {32: 4, 33: 4, 34: 4, 35: 8, 36: 4, 37: 8, 38: 4, 39: 8, 54: 8, 55: 8}
# Types of metadata alone: lists of edits, vectors of the file, words of Sdf, samples, payloads, relocates.
# For some of them as the value of an attribute pxr has no Python object.
_OF_METADATA = np.isin(np.arange(256), [*_LISTS, *range(40, 51), 52, 58])

T = TypeVar("T")


def check(content: memoryview, name: str) -> None:
    """FileError for a damaged crate; ``name`` is what to call it."""
    try:
        _Crate(content).check()
    except (ValueError, struct.error) as error:
        raise FileError(
            f"{name}: a damaged USD file: {error}. Export it again with the program that wrote it"
        ) from None


def is_cut_off(content: memoryview) -> bool:
    """Whether a crate ends before its table of contents, which stands last: USD refuses it by itself, too."""
    if len(content) < _BOOTSTRAP.size:
        return True
    _, *numbers = _BOOTSTRAP.unpack_from(content)
    return not 0 <= numbers[8] < len(content)


class _Crate:
    """The tables of a crate, read in the order in which they refer to each other."""

    def __init__(self, content: memoryview) -> None:
        self.content = content
        if len(content) < 88:
            raise ValueError("it is cut off in its first bytes")
        _, *numbers = _BOOTSTRAP.unpack_from(content)
        self.version = (numbers[0], numbers[1], numbers[2])
        self.sections = self._table_of_contents(numbers[8])

    def check(self) -> None:
        if self.version < _OLDEST:
            return
        texts = self._section("TOKENS", self._tokens) or []
        tokens = len(texts)
        strings = self._section("STRINGS", self._strings)
        if strings is not None:
            _below(strings, tokens, "string")
        known = 0 if strings is None else len(strings)
        fields = self._section("FIELDS", lambda at, end: self._fields(at, end, texts, known))
        count = 0 if fields is None else len(fields.names)
        sets = self._section("FIELDSETS", lambda at, end: self._field_sets(at, end, count))
        most, paths = self._section("PATHS", lambda at, end: self._paths(at, end, tokens)) or (0, None)
        specs = self._section("SPECS", lambda at, end: self._specs(at, end, most, sets))
        if fields is not None and paths is not None and specs is not None:
            children.check(self.content, paths, fields, specs)

    def _table_of_contents(self, at: int) -> dict[str, tuple[int, int]]:
        size = len(self.content)
        if not 0 <= at <= size - 8:
            raise ValueError("it is cut off: its table of contents is not there")
        count = self._number(at)
        if count * _SECTION.size > size - at - 8:
            raise ValueError("its table of contents claims more than the file holds")
        found: dict[str, tuple[int, int]] = {}
        for entry in range(count):
            raw, start, length = _SECTION.unpack_from(self.content, at + 8 + entry * _SECTION.size)
            name = raw.partition(b"\0")[0].decode("ascii", "replace")
            if start < 0 or length < 0 or start + length > size:
                raise ValueError(f"its section {name} ends outside the file")
            found.setdefault(name, (start, start + length))
        return found

    def _section(self, name: str, read: Callable[[int, int], T]) -> T | None:
        """What ``read`` makes of a section; its errors with the section's name."""
        if name not in self.sections:
            return None
        try:
            return read(*self.sections[name])
        except (ValueError, struct.error) as error:
            raise ValueError(f"section {name}: {error}") from None

    def _number(self, at: int) -> int:
        return int(struct.unpack_from("<Q", self.content, at)[0])

    def _tokens(self, at: int, end: int) -> list[bytes]:
        """The tokens, every one of which is there."""
        count, size = self._number(at), self._number(at + 8)
        packed = self._slice(at + 24, self._number(at + 16), end)
        if size > lz4.MOST * len(packed) + 16:
            raise ValueError("it claims more than it can hold")
        text = lz4.unpacked(bytes(packed), size)
        if len(text) != size:
            raise ValueError("it is shorter than it claims")
        if text.count(0) != count or (text and text[-1]):
            raise ValueError(f"it claims {count} tokens and has {text.count(0)}")
        return text.split(b"\0")[:-1]

    def _strings(self, at: int, end: int) -> Integers:
        count = self._number(at)
        return np.frombuffer(self._slice(at + 8, 4 * count, end), dtype="<u4").astype(np.int64)

    def _fields(self, at: int, end: int, tokens: list[bytes], strings: int) -> children.Fields:
        count, at = self._count(at, end)
        names, at = self._integers(at, end, count)
        _below(names, len(tokens), "name")
        packed = self._slice(at + 8, self._number(at), end)
        values = lz4.unpacked(bytes(packed), 8 * count) if count else b""
        if len(values) != 8 * count:
            raise ValueError("it has fewer values than it claims")
        words = np.frombuffer(values, dtype="<u8")
        if b"default" in tokens:  # the value of an attribute
            _check_kinds(words[names == tokens.index(b"default")])
        _check_values(self.content, words, self.version, len(tokens), strings)
        return children.Fields(names, words, tokens)

    def _field_sets(self, at: int, end: int, fields: int) -> Integers:
        count, at = self._count(at, end)
        sets, _ = self._integers(at, end, count)
        _below(sets[sets != NO_FIELD], fields, "field")
        if count and sets[-1] != NO_FIELD:
            raise ValueError("its last set does not end")
        return sets

    def _paths(self, at: int, end: int, tokens: int) -> tuple[int, children.Paths]:
        """How many paths there are, and their tree."""
        most, at = self._count(at, end)
        count, at = self._count(at, end)
        indices, at = self._integers(at, end, count)
        names, at = self._integers(at, end, count)
        jumps, at = self._integers(at, end, count)
        _below(indices, most, "path")
        _below(np.abs(_signed(names)), tokens, "name")
        return most, children.Paths(children.parents_of(_signed(jumps)), _signed(names), indices)

    def _specs(self, at: int, end: int, paths: int, sets: Integers | None) -> children.Specs:
        count, at = self._count(at, end)
        places, at = self._integers(at, end, count)
        fields, at = self._integers(at, end, count)
        kinds, at = self._integers(at, end, count)
        _below(places, paths, "path")
        if len(np.unique(places)) != count:
            raise ValueError("two specs have one path")
        sets = np.zeros(0, dtype=np.int64) if sets is None else sets
        _below(fields, len(sets), "set of fields")
        if (sets[fields[fields > 0] - 1] != NO_FIELD).any():
            raise ValueError("a set of fields starts within another")
        if not ((kinds > 0) & (kinds < _KINDS_OF_SPEC)).all():
            raise ValueError("a spec is of no known kind")
        return children.Specs(places, fields, kinds, sets)

    def _count(self, at: int, end: int) -> tuple[int, int]:
        """A number of packed integers, which can be that many, and where they start."""
        count = self._number(at)
        if count > _MOST_INTEGERS * (end - at):
            raise ValueError(f"it claims {count} entries, more than it can hold")
        return count, at + 8

    def _integers(self, at: int, end: int, count: int) -> tuple[Integers, int]:
        """Packed integers as unsigned 32-bit numbers, (count,), and where they end."""
        size = self._number(at)
        packed = self._slice(at + 8, size, end)
        if count == 0:
            return np.zeros(0, dtype=np.int64), at + 8 + size
        codes = (count * 2 + 7) // 8
        if 4 + codes > lz4.MOST * len(packed) + 16:
            raise ValueError("it claims more than it can hold")
        return _decoded(lz4.unpacked(bytes(packed), 4 + codes + 4 * count), count), at + 8 + size

    def _slice(self, at: int, size: int, end: int) -> memoryview:
        if at < 0 or size > end - at:
            raise ValueError("it claims more than it can hold")
        return self.content[at : at + size]


def _decoded(raw: bytes, count: int) -> Integers:
    """Integers from their commonest difference, two-bit codes and the other differences."""
    codes_end = 4 + (count * 2 + 7) // 8
    if len(raw) < codes_end:
        raise ValueError("its integers are cut off")
    common = int.from_bytes(raw[:4], "little", signed=True)
    four = np.frombuffer(raw, dtype=np.uint8, count=codes_end - 4, offset=4)
    codes = ((four[:, np.newaxis] >> np.array([0, 2, 4, 6], dtype=np.uint8)) & 3).reshape(-1)[:count]
    sizes = np.array([0, 1, 2, 4])[codes]
    ends = codes_end + np.cumsum(sizes)
    if ends[-1] > len(raw):
        raise ValueError("its integers are cut off")
    content = np.frombuffer(raw, dtype=np.uint8)
    steps = np.full(count, common, dtype=np.int64)
    for code, kind in ((1, "<i1"), (2, "<i2"), (3, "<i4")):
        chosen = np.flatnonzero(codes == code)
        width = np.dtype(kind).itemsize
        places = (ends[chosen] - width)[:, np.newaxis] + np.arange(width)
        steps[chosen] = content[places].reshape(-1).view(kind)
    return np.asarray(np.cumsum(steps) & 0xFFFFFFFF, dtype=np.int64)


def _signed(values: Integers) -> Integers:
    return np.where(values >= 1 << 31, values - (1 << 32), values)


def _below(values: Integers, limit: int, what: str) -> None:
    if len(values) and int(values.max()) >= limit:
        raise ValueError(f"it names {what} {int(values.max())} of {limit}")


def _check_values(
    content: memoryview, values: Words, version: tuple[int, int, int], tokens: int, strings: int
) -> None:
    """ValueError for a value outside the file, or one that claims more items than it can have."""
    seen: set[int] = set()
    for kind, most in ((_STRING, strings), (_TOKEN, tokens), (_ASSET, tokens)):
        mine = values[(values >> np.uint64(48)) & np.uint64(0x80FF) == kind] & np.uint64(0xFFFFFFFF)
        if len(mine) and int(mine.max()) >= most:
            raise ValueError(f"a value names text {int(mine.max())} of {most}")
    _check_each(content, values, version, seen)


def _check_each(content: memoryview, values: Words, version: tuple[int, int, int], seen: set[int]) -> None:
    """The same for any values: plain arrays, which animations have thousands of, all at once."""
    kinds = (values >> np.uint64(48) & np.uint64(0xFF)).astype(np.int64)
    places = (values & np.uint64((1 << 48) - 1)).astype(np.int64)
    plain = (values >> np.uint64(61) == _ARRAY >> 61) & (places > 0) & (_ITEM[kinds] > 0) & (version >= _WIDE)
    starts, sizes = places[plain], _ITEM[kinds[plain]]
    if len(starts):
        _inside(content, int(starts.max()), 8)
        counts = np.frombuffer(content, np.uint8)[starts[:, np.newaxis] + np.arange(8)].view("<u8")[:, 0]
        wrong = counts > ((len(content) - 8 - starts) // sizes).astype(np.uint64)
        if wrong.any():
            raise ValueError(f"a value claims {int(counts[wrong][0])} items, more than the file holds")
    for value in values[~plain].tolist():
        _check_value(content, value, version, seen)


def _check_value(content: memoryview, value: int, version: tuple[int, int, int], seen: set[int]) -> None:
    kind, at = value >> 48 & 0xFF, value & (1 << 48) - 1
    if value & _INLINED or (value & _ARRAY and at == 0) or value in seen:
        return
    if kind not in _SIZES and kind not in _COUNTED and kind not in _LISTS and kind != _TIME_SAMPLES:
        return
    seen.add(value)
    if value & _ARRAY:
        _check_array(content, kind, at, bool(value & _COMPRESSED), version)
    elif kind in _COUNTED:
        _fits(content, at + 8, _number(content, at), _COUNTED[kind])
    elif kind in _LISTS:
        _fits(content, at + 9, _number(content, at + 1) if _lists(content, at) else 0, _LISTS[kind])
    elif kind == _TIME_SAMPLES:
        _check_samples(content, at, version, seen)


def _lists(content: memoryview, at: int) -> int:
    """Which lists follow, by the bits after the first, which makes the whole explicit."""
    _inside(content, at, 1)
    return content[at] & 0b1111110


def _check_array(
    content: memoryview, kind: int, at: int, compressed: bool, version: tuple[int, int, int]
) -> None:
    at += 4 if version < (0, 5, 0) else 0  # the number of dimensions, always one
    wide = version >= _WIDE
    _inside(content, at, 8 if wide else 4)
    count = int(struct.unpack_from("<Q" if wide else "<I", content, at)[0])
    at += 8 if wide else 4
    size = _SIZES.get(kind, 1)
    if not compressed or count < 16:
        _fits(content, at, count, size)
        return
    if kind in (7, 8, 9):
        _inside(content, at, 5)
        if content[at] == ord("t"):
            entries = int(struct.unpack_from("<I", content, at + 1)[0])
            _fits(content, at + 5, entries, size)
            at += 4 + entries * size
        at += 1
    packed = _number(content, at)
    _fits(content, at + 8, packed, 1)
    if count > 4 * lz4.MOST * packed + 64:
        raise ValueError(f"an array claims {count} items, more than it can hold")


def _check_samples(content: memoryview, at: int, version: tuple[int, int, int], seen: set[int]) -> None:
    """Times and values; each stands behind what it needs, by a jump from where the jump is written."""
    times = at + _jump(content, at)
    value = _number(content, times)
    fresh = value not in seen
    _check_value(content, value, version, seen)
    if fresh and value >> 48 & 0xFF == _TIMES and not value & _INLINED:
        _check_times(content, value & (1 << 48) - 1)
    start = times + 8
    start += _jump(content, start)
    count = _number(content, start)
    _fits(content, start + 8, count, 8)
    values = np.frombuffer(content[start + 8 : start + 8 + 8 * count], dtype="<u8")
    _check_kinds(values)
    _check_each(content, values, version, seen)


def _check_kinds(values: Words) -> None:
    """ValueError for the value of an attribute that is of no type that attributes have."""
    kinds = values >> np.uint64(48) & np.uint64(0xFF)
    if (wrong := kinds[_OF_METADATA[kinds]]).size:
        raise ValueError(f"an attribute has a value of type {int(wrong[0])}, which is of metadata alone")


def _check_times(content: memoryview, at: int) -> None:
    """In order: usd-core looks for a time by halves, and finds no value at some of those that it lists."""
    start, count = at + 8, _number(content, at)
    times = np.frombuffer(content[start : start + 8 * count], dtype="<f8")
    # One that is nan is refused with the path that has it.
    if (np.diff(times) <= 0).any():
        raise ValueError("the times of its samples are not in order")


def _jump(content: memoryview, at: int) -> int:
    _inside(content, at, 8)
    return int(struct.unpack_from("<q", content, at)[0])


def _number(content: memoryview, at: int) -> int:
    _inside(content, at, 8)
    return int(struct.unpack_from("<Q", content, at)[0])


def _fits(content: memoryview, at: int, count: int, size: int) -> None:
    _inside(content, at, 0)
    if count * size > len(content) - at:
        raise ValueError(f"a value claims {count} items, more than the file holds")


def _inside(content: memoryview, at: int, size: int) -> None:
    if at < 0 or at + size > len(content):
        raise ValueError("a value lies outside the file")
