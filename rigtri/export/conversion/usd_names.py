"""Names that USD allows for the nodes of a rig: the same for the same rig, and each once in a file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rigtri.formats.usd.identifiers import identifier


class Names:
    """Identifiers that are given out once each, whatever their case: file systems may not tell them apart."""

    def __init__(self, taken: Sequence[str] = ()) -> None:
        self._taken = {word.lower() for word in taken}
        self._numbers: dict[str, int] = {}  # by word, the first that may be free

    def unique(self, name: str, otherwise: str = "node") -> str:
        """An identifier of ``name`` that no other has."""
        word = identifier(name, otherwise)
        found, number = word, self._numbers.get(word.lower(), 1)
        while found.lower() in self._taken:
            found, number = f"{word}_{number}", number + 1
        self._numbers[word.lower()] = number
        self._taken.add(found.lower())
        return found


def distinct(names: Sequence[str]) -> list[str]:
    """Names of which each is another: of those that are the same all but the first get a number.

    >>> distinct(["hip 1", "walk", "walk"])
    ['hip 1', 'walk', 'walk_1']
    """
    taken, before, found = set(names), set[str](), list[str]()
    numbers: dict[str, int] = {}  # by name, the first that may be free
    for name in names:
        one, number = name, numbers.get(name, 1)
        while one in before or (one != name and one in taken):
            one, number = f"{name}_{number}", number + 1
        numbers[name] = number
        taken.add(one)
        before.add(name)
        found.append(one)
    return found


def clip_titles(names: Sequence[str]) -> list[str]:
    """What clips are called in USD, by their names, of which some are empty or equal.

    >>> clip_titles(["walk", "", "walk"])
    ['walk', 'clip_1', 'walk_1']
    """
    return distinct([name or f"clip_{number}" for number, name in enumerate(names)])


def node_identifiers(names: Sequence[str], labels: Sequence[str]) -> list[str]:
    """The identifiers of the nodes of a rig, in order; those without a name go by their labels."""
    given = Names()
    # Names that are right as they are stay so, whoever stands before them.
    first: dict[str, int] = {}
    for k, name in enumerate(names):
        if name and identifier(name, "") == name and name.lower() not in first:
            first[name.lower()] = k
    kept = {k: given.unique(names[k]) for k in first.values()}
    return [
        kept[k] if k in kept else given.unique(name, f"node{label.replace('#', '_')}")
        for k, (name, label) in enumerate(zip(names, labels, strict=True))
    ]


def name_prim(prim: Any, name: str, word: str) -> None:
    """Give a prim its name as display name where its identifier ``word`` is another."""
    if name and name != word:
        prim.SetDisplayName(name)
