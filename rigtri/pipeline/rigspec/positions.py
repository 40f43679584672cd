"""A spec as plain values, and where in which file each of them stands."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import field
from typing import Any

from rigtri.model.dataclass import dataclass
from rigtri.pipeline.rigspec.errors import Fault, Place, SpecError

Keys = tuple[str | int, ...]

# Aliases of YAML let a small file stand for more values than memory holds.
MOST_VALUES = 100_000
MOST_DEEP = 64
# Digits of a number; what has more is a mistake, and some numbers have more than Python reads.
MOST_DIGITS = 40
TOO_MUCH = "more values, or deeper, than a spec can have"


@dataclass
class Spot:
    """Where a value stands; below: where the values in it do, by key or number.

    variable: the one that a text begins with.
    """

    place: Place
    below: dict[str | int, Spot] = field(default_factory=dict)
    variable: str = ""

    def at(self, key: str | int) -> Spot:
        """The spot of a value in this one; where nobody knows, this one's place."""
        return self.below.get(key) or Spot(self.place)

    def all(self, keys: Keys = ()) -> Iterator[tuple[Keys, Place]]:
        """The places of a value and of all in it, by the keys from there on."""
        yield keys, self.place
        for key, spot in self.below.items():
            yield from spot.all((*keys, key))


@dataclass
class Tree:
    """values: mappings, lists and scalars. spot: of all of them. labels: of each step, what to call it."""

    file: str
    values: Any
    spot: Spot
    labels: list[Label] = field(default_factory=list)

    @property
    def steps(self) -> list[Any]:
        """The steps as they are said, be they right or wrong."""
        steps = self.values.get("steps")
        return steps if isinstance(steps, list) else []

    def at(self, keys: Keys) -> Spot:
        """The spot of a value; of one that does not stand there, the nearest above it."""
        spot = self.spot
        for key in keys:
            spot = spot.at(key)
        return spot

    def place(self, keys: Keys) -> Place:
        """Where a value stands; of one that does not, the nearest above it."""
        return self.at(keys).place

    def under(self, keys: Keys) -> Iterator[tuple[Keys, Place]]:
        """The places of a value and all within it, by the keys from there on; none where there is none."""
        spot: Spot | None = self.spot
        for key in keys:
            spot = None if spot is None else spot.below.get(key)
        if spot is not None:
            yield from spot.all()


@dataclass(frozen=True)
class Label:
    """What a step is called: its number in the file, from 1, and its word of the braces that it has."""

    number: int
    word: str = ""


class Spots:
    """Makes the spots of one text, no more and no deeper than a spec can have."""

    def __init__(self, file: str, text: str) -> None:
        self._file, self._left = file, MOST_VALUES
        self._starts = [0]
        while (end := text.find("\n", self._starts[-1])) >= 0:
            self._starts.append(end + 1)

    def place(self, offset: int) -> Place:
        """The line and column of an offset in the text."""
        line = bisect_right(self._starts, offset)
        return Place(self._file, line, offset - self._starts[line - 1] + 1)

    def check_number(self, word: str, place: Place | int) -> None:
        """SpecError for a number that is longer than any that is meant."""
        if len(word) > MOST_DIGITS and word.lstrip("+-")[:1].isdecimal():
            place = self.place(place) if isinstance(place, int) else place
            text = f"a number of {len(word):,} characters; a spec has none of more than {MOST_DIGITS}"
            raise SpecError([Fault(place, "", text)])

    def check_text(self, text: str, place: Place | int) -> None:
        """SpecError for half of a surrogate pair, which an escape can write and no text of a file has."""
        if (half := next((each for each in text if "\ud800" <= each <= "\udfff"), None)) is not None:
            place = self.place(place) if isinstance(place, int) else place
            raise SpecError(
                [Fault(place, "", f"half of a surrogate pair (U+{ord(half):04X}) is no character")]
            )

    def spot(self, place: Place | int, depth: int) -> Spot:
        """A spot for one more value. SpecError when there are too many."""
        self._left -= 1
        place = self.place(place) if isinstance(place, int) else place
        if self._left < 0 or depth > MOST_DEEP:
            raise SpecError([Fault(place, "", TOO_MUCH)])
        return Spot(place)
