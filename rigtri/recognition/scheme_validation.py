"""Validating a user's naming scheme: all of its errors at once."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import Any

from rigtri.errors import did_you_mean
from rigtri.recognition.layout import BENDS, MIDDLE, SIDED

_TABLES = {"middle": MIDDLE, "sides": SIDED, "chains": tuple(BENDS)}
_TEXTS = ("title", "marks", "like")
_TO_DO = "give a text in quotes, several words apart by spaces"


def faults(
    table: Mapping[str, Any], known: Collection[str], read: Callable[[str, str], tuple[bool, str]]
) -> Iterator[str]:
    """A line for each fault: where, what, and what to do.

    known: the schemes that one can be like. read: whether names can say a word of a table, and how it
    would be written.
    """
    for key, value in table.items():
        if key in _TABLES:
            yield from _of_table(key, value, read)
        elif key not in _TEXTS:
            yield f"there is no '{key}'.{_near(key, (*_TEXTS, *_TABLES))}"
        elif not isinstance(value, str):
            yield f"'{key}' is {_kind(value)}: {_TO_DO}"
        elif key == "like" and value not in known:
            yield f"there is no scheme '{value}' to be like.{_near(value, sorted(known))}"
        elif key == "marks":
            yield from _of_words("'marks'", "marks", value, read)
    if "title" not in table:
        yield "'title' is missing: give it one, which evidence will say"


def _of_table(name: str, value: object, read: Callable[[str, str], tuple[bool, str]]) -> Iterator[str]:
    if not isinstance(value, dict):
        yield f"'{name}' is {_kind(value)}: make it a table, [{name}] with a line for each bone"
        return
    taken: dict[str, str] = {}
    for bone, text in value.items():
        where = f"[{name}] {bone}"
        if bone not in _TABLES[name]:
            yield f"{where}: there is no such bone here.{_near(bone, _TABLES[name])}"
        if not isinstance(text, str):
            yield f"{where} is {_kind(text)}: {_TO_DO}"
        else:
            yield from _of_words(where, name, text, read)
            for word in text.split():
                if taken.setdefault(word, bone) != bone:
                    yield f"{where}: '{word}' means {taken[word]} already, and a word means one bone"


def _of_words(
    where: str, table: str, text: str, read: Callable[[str, str], tuple[bool, str]]
) -> Iterator[str]:
    for word in text.split():
        can_be, better = read(table, word)
        if not can_be:
            hint = f"write '{better}'" if better else "sides and words like joint are set aside; leave it out"
            yield f"{where}: no name can say '{word}': {hint}"


def _near(word: str, known: Collection[str]) -> str:
    return did_you_mean(word, known) or f" There are {', '.join(known)}"


def _kind(value: object) -> str:
    """What a value of TOML is, in its terms."""
    kinds = {bool: "true or false", int: "a number", float: "a number", list: "a list", dict: "a table"}
    return "a text" if isinstance(value, str) else kinds.get(type(value), "a date")
