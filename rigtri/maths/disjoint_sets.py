"""Numbers that are joined, pair by pair, into sets: which of them belong together in the end.

Source: B. A. Galler and M. J. Fischer, "An improved equivalence algorithm", CACM 7(5), 1964; paths are
halved as they are followed.
"""

from __future__ import annotations

from collections.abc import Iterator


class DisjointSets:
    """Sets of numbers, each known by its leader; a number that was never joined leads itself."""

    def __init__(self) -> None:
        self._above: dict[int, int] = {}

    def __iter__(self) -> Iterator[int]:
        return iter(self._above)

    def leader(self, member: int) -> int:
        """The number that stands for the set of another, which is a member from now on."""
        above = self._above
        over = above.setdefault(member, member)
        while over != member:
            above[member] = member = above[over]
            over = above[member]
        return member

    def join(self, member: int, other: int) -> None:
        """Make the sets of two numbers one, which the leader of the first leads."""
        self._above[self.leader(other)] = self.leader(member)
