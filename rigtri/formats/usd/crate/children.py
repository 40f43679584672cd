"""Whether a crate has the children that its prims list, before usd-core looks for them.

usd-core takes the names of prims and properties from these lists; what is listed and not there has no name,
or ends the process.

Source: OpenUSD, pxr/usd/usd: crateFile.h (SpecType, path items), crateDataTypes.h; pxr/usd/sdf/schema.h.
"""

from __future__ import annotations

import numpy as np

from rigtri.maths.arrays import Integers
from rigtri.model.dataclass import dataclass

Words = np.ndarray[tuple[int, ...], np.dtype[np.uint64]]

# What ends a set of fields.
NO_FIELD = 0xFFFFFFFF
_VECTOR = 41
# The field that lists, the kinds of spec that it lists, and the sign of their names in the tree of paths.
_LISTS = (("primChildren", "prim", (6,), 1), ("properties", "property", (1, 8), -1))


@dataclass
class Paths:
    """The tree of paths: the parent, the name and the path of each place.

    parents: (n,) places, −1 at the top. names: (n,) tokens, negative for properties. indices: (n,).
    """

    parents: Integers
    names: Integers
    indices: Integers

    def places(self, paths: Integers) -> Integers:
        """Where paths stand in the tree, (m,); −1 for one that does not."""
        most = int(max(paths.max(initial=-1), self.indices.max(initial=-1))) + 1
        found = np.full(most, -1, dtype=np.int64)
        found[self.indices] = np.arange(len(self.indices))
        return found[paths]

    def text(self, place: int, tokens: list[bytes]) -> str:
        """A path in words."""
        found = ""
        while self.parents[place] >= 0:
            found = f"/{_text(tokens[abs(int(self.names[place]))])}{found}"
            place = int(self.parents[place])
        return found or "/"


def parents_of(jumps: Integers) -> Integers:
    """The parent of each place, (n,). ValueError where one is not reached once.

    jumps: (n,), -2 a leaf, -1 only a child, 0 only a sibling, n both, the sibling n on.
    """
    waiting: list[int] = []
    parents = [-1] * len(jumps)
    last = len(jumps) - 1
    for place, jump in enumerate(jumps.tolist()):
        if jump < -2 or jump > last - place or jump == 1:
            raise ValueError("its tree of paths is broken")
        if jump > 0:
            waiting.append(place + jump)
            parents[place + jump] = parents[place]
        elif jump == -2 and place < last and (not waiting or waiting.pop() != place + 1):
            raise ValueError("its tree of paths is broken")
        if place == last and (jump != -2 or waiting):
            raise ValueError("its tree of paths does not end")
        if jump != -2:
            parents[place + 1] = parents[place] if jump == 0 else place
    return np.array(parents, dtype=np.int64)


@dataclass
class Fields:
    """The fields of a crate: the token and the value of each. tokens: the texts of all."""

    names: Integers
    values: Words
    tokens: list[bytes]


@dataclass
class Specs:
    """The specs of a crate: path, set of fields and kind of each; sets: fields, each set with an end."""

    paths: Integers
    fields: Integers
    kinds: Integers
    sets: Integers


def check(content: memoryview, paths: Paths, fields: Fields, specs: Specs) -> None:
    """ValueError where a prim lists a prim or property that is not there."""
    places, count = paths.places(specs.paths), len(fields.tokens)
    for name, what, kinds, sign in _LISTS:
        if name.encode() not in fields.tokens:
            continue
        of_kind = places[np.isin(specs.kinds, kinds) & (places >= 0)]
        known = paths.parents[of_kind] * count + sign * paths.names[of_kind]
        owners, listed = _listed(content, fields, specs, places, fields.tokens.index(name.encode()))
        missing = np.flatnonzero(~np.isin(owners * count + listed, known))
        if len(missing):
            first = missing[0]
            below = paths.text(int(owners[first]), fields.tokens)
            child = _text(fields.tokens[int(listed[first])])
            raise ValueError(f"below <{below}> it lists a {what} '{child}' and has none")


def _listed(
    content: memoryview, fields: Fields, specs: Specs, places: Integers, token: int
) -> tuple[Integers, Integers]:
    """All that specs list by a field: the places of the specs and the tokens of what they list."""
    at = np.flatnonzero(specs.sets != NO_FIELD)
    at = at[fields.names[specs.sets[at]] == token]
    starts, of_spec = np.unique(specs.fields, return_inverse=True)
    values = np.zeros(len(starts), dtype=np.uint64)
    values[np.searchsorted(starts, at, side="right") - 1] = fields.values[specs.sets[at]]
    mine = values[of_spec]
    lists = (mine >> np.uint64(48) == _VECTOR) & (places >= 0)
    begins = (mine[lists] & np.uint64((1 << 48) - 1)).astype(np.int64)
    counts = _numbers(content, begins, 8)
    before = np.repeat(np.cumsum(counts) - counts, counts)
    offsets = np.arange(len(before)) - before
    found = _numbers(content, np.repeat(begins + 8, counts) + 4 * offsets, 4)
    if len(found) and int(found.max()) >= len(fields.tokens):
        raise ValueError(f"a prim lists name {int(found.max())} of {len(fields.tokens)}")
    return np.repeat(places[lists], counts), found


def _numbers(content: memoryview, places: Integers, size: int) -> Integers:
    """The unsigned numbers of so many bytes at places of the file."""
    raw = np.frombuffer(content, np.uint8)[places[:, np.newaxis] + np.arange(size)]
    return np.asarray(raw.view(f"<u{size}").reshape(-1), dtype=np.int64)


def _text(token: bytes) -> str:
    return token.decode("utf-8", "replace")
