"""JSON values that know where they stand, so that a wrong one is an error with an address.

glTF files come from everywhere: a string where a number should be, an index
that points nowhere, a list in place of an object. Reading through `Value`
turns each of them into a FileError that names the place.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NoReturn

from rigtri.errors import FileError

# Nobody who draws the file has more than 32-bit numbers.
LARGEST = 3.4028235e38


class Value:
    """A JSON value and its place, e.g. ``hero.glb: nodes[3].rotation``."""

    __slots__ = ("raw", "where")

    def __init__(self, raw: Any, where: str) -> None:
        self.raw = raw
        self.where = where

    def fail(self, text: str) -> NoReturn:
        """Raise a FileError that begins with this place."""
        raise FileError(f"{self.where.removesuffix(':')}: {text}")

    def get(self, key: str) -> Value | None:
        """The value under ``key`` of an object, None where there is none. FileError for a non-object."""
        raw = self.object().get(key)
        return None if raw is None else Value(raw, self._below(key))

    def need(self, key: str) -> Value:
        """The value under ``key``. FileError where it is missing."""
        found = self.get(key)
        if found is None:
            self.fail(f"'{key}' is missing; repair the file with the program that wrote it")
        return found

    def object(self) -> dict[str, Any]:
        """This object, as it is. FileError for anything else."""
        if not isinstance(self.raw, dict):
            self.fail(f"an object should stand here, not {short_repr(self.raw)}")
        return self.raw

    def entries(self) -> list[Any]:
        """This list, as it is. FileError for anything else."""
        if not isinstance(self.raw, list):
            self.fail(f"a list should stand here, not {short_repr(self.raw)}")
        return self.raw

    def items(self) -> Iterator[Value]:
        """The values of a list."""
        for number, raw in enumerate(self.entries()):
            yield Value(raw, f"{self.where}[{number}]")

    def members(self) -> Iterator[tuple[str, Value]]:
        """Keys and values of an object."""
        for key, raw in self.object().items():
            yield key, Value(raw, self._below(key))

    def each(self, key: str) -> Iterator[Value]:
        """The values of the list under ``key``; nothing where there is none."""
        found = self.get(key)
        return iter(()) if found is None else found.items()

    def count(self, least: int = 0) -> int:
        """A whole number that is not below ``least``."""
        # 3.0 is the same number; some exporters write all numbers as floats.
        whole = isinstance(self.raw, float) and self.raw.is_integer()
        number = int(self.raw) if whole else self.raw
        if not isinstance(number, int) or isinstance(number, bool) or number < least:
            self.fail(f"a whole number of at least {least} should stand here, not {short_repr(self.raw)}")
        return number

    def natural(self, key: str, default: int | None = None) -> int:
        """The whole number under ``key``, 0 or more; quick, as files have thousands of them."""
        found = self.raw.get(key, default)
        if type(found) is int and found >= 0:
            return found
        return self.need(key).count()

    def index(self, among: int, kind: str) -> int:
        """An index of one of ``among`` things."""
        number = self.count()
        if number >= among:
            self.fail(f"there is no {kind} {number}, the file has {among}")
        return number

    def numbers(self, count: int) -> list[float]:
        """Exactly ``count`` numbers that 32 bits can hold."""
        raw = self.entries()
        if len(raw) != count or not all(type(x) is float or type(x) is int for x in raw):
            self.fail(f"{count} numbers should stand here, not {short_repr(raw)}")
        try:
            numbers = [float(x) for x in raw]
        except OverflowError:
            self.fail("a number here is too large")
        if not all(-LARGEST <= x <= LARGEST for x in numbers):
            self.fail("a number here is too large")
        return numbers

    def text(self) -> str:
        """A string."""
        if not isinstance(self.raw, str):
            self.fail(f"a text should stand here, not {short_repr(self.raw)}")
        return self.raw

    def _below(self, key: str) -> str:
        # 'file: nodes' but 'nodes[3].rotation'.
        return f"{self.where}{' ' if self.where.endswith(':') else '.'}{key}"


def name_in(raw: Mapping[str, Any]) -> str:
    """The name of an object, "" for one that has none, or none of text.

    JSON can escape halves of characters, which no other file can hold: they are read as U+FFFD.

    >>> name_in({"name": "hips"}), name_in({"name": 3}), name_in({"name": "a\\ud800"})
    ('hips', '', 'a\ufffd')
    """
    name = raw.get("name")
    if not isinstance(name, str):
        return ""
    return name if name.isprintable() else name.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def index_of(raw: Any, among: int) -> int | None:
    """The index of one of ``among`` things, for whom what is none is no error: then None.

    >>> index_of(3.0, 4), index_of(4, 4), index_of([3], 4), index_of(True, 4)
    (3, None, None, None)
    """
    is_one = type(raw) in (int, float) and 0 <= raw < among and raw == int(raw)
    return int(raw) if is_one else None


def object_in(holder: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    """The object under a key that nobody has checked; an empty one for anything else."""
    found = holder.get(key)
    return found if isinstance(found, dict) else {}


def object_at(among: Any, index: Any) -> dict[str, Any] | None:
    """The object at an index of a list that nobody has checked; None where there is none."""
    place = index_of(index, len(among)) if isinstance(among, list) else None
    found = None if place is None else among[place]
    return found if isinstance(found, dict) else None


def short_repr(raw: Any) -> str:
    """A value as Python writes it; of a long one only the start."""
    text = repr(raw)
    return text if len(text) <= 40 else f"{text[:37]}..."
