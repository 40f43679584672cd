"""Scene settings and what nodes show besides their pose, as plain facts: a name and a value each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field
from typing import Any

from rigtri.model.dataclass import dataclass

# In the names of facts that a clip states; a clip that only the second file has changes nothing visible.
IN_CLIP = " in clip "


@dataclass(frozen=True, eq=False)
class Reference:
    """A node that a fact names: the same as its partner. shows: it is meant for what it shows."""

    node: int
    shows: bool = False


@dataclass(frozen=True)
class SceneFacts:
    """Facts of a file: ``whole`` by name, ``nodes`` by node and name.

    A fact that is not there is None. Nodes are those that show something; what a node
    shows keeps its facts when it is moved to another. ``own`` are facts that a node keeps itself.
    """

    format: str = ""
    whole: Mapping[str, Any] = field(default_factory=dict)
    nodes: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)
    own: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)


def flat(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """A nested JSON value as facts; what is none to look at, names and extras, is left out.

    >>> list(flat({"type": "spot", "spot": {"outerConeAngle": 0.5}, "name": "key"}, "light"))
    [('light type', 'spot'), ('light spot outerConeAngle', 0.5)]
    """
    if isinstance(value, dict):
        for key, item in value.items():
            if key not in ("name", "extras"):
                yield from flat(item, f"{name} {key}")
    else:
        yield name, value
