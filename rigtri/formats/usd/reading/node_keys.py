"""Keys of nodes, skins and clips of a USD rig: tuples with what of the stage each stands for."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any


def parts(key: Hashable) -> tuple[Any, ...]:
    """The parts of a key that this format has given; none where a node is new."""
    return key if isinstance(key, tuple) else ()


def kind(key: Hashable) -> str:
    """What a key stands for: ``prim``, ``joint``, ``skeleton``, ``root``, or "" where it is new."""
    return str(parts(key)[0]) if parts(key) else ""
