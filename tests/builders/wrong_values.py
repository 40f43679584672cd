"""Wrong values, every position of a JSON document where they may stand, and what a reader says."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.formats import read

WRONG: list[Any] = [None, True, -1, 1.5, 1e30, "x", [], {}, [None], [-1], {"a": None}, 99, [[]]]


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The path of every value in a JSON."""
    if path:
        yield path
    for key, below in value.items() if isinstance(value, dict) else ():
        yield from places(below, (*path, key))
    for key, below in enumerate(value) if isinstance(value, list) else ():
        yield from places(below, (*path, key))


def refusal(path: Path) -> str:
    """Why the reader refuses a file, "" where it does not."""
    with warnings.catch_warnings():
        # A weird but legal number may overflow; it must not end in a traceback.
        warnings.simplefilter("ignore", RuntimeWarning)
        try:
            read(path).meshes()
        except FileError as error:
            return str(error)
    return ""
