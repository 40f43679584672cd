"""A cycle is noted at the node that waits, with the file's own place of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from rigs import chain

from rigtri.evaluation.dependency_graph import ControlCycleError
from rigtri.model.rig import Rig
from rigtri.verification.checks import cycle_check
from rigtri.verification.checks.cycle_check import check_cycles, title_and_pointer


class Noted:
    """What is added to findings."""

    def __init__(self) -> None:
        self.added: list[tuple[str, ...]] = []

    def add(self, *words: str) -> None:
        self.added.append(words)


@pytest.mark.parametrize(
    ("types", "at"),
    [
        ({1: "control"}, 1),
        ({0: "offset", 2: "constraint"}, 2),
        ({0: "twist", 1: "control"}, 0),
        ({1: "offset", 2: "group"}, 1),  # none waits: the first that has metadata
        ({}, 0),
        ({3: "control"}, 0),
    ],
)
def test_a_cycle_is_noted_once_at_a_node_that_waits(
    monkeypatch: pytest.MonkeyPatch, types: dict[int, str], at: int
) -> None:
    rig = chain((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0))
    rig = replace(rig, metadata={node: {"v": 1, "type": kind} for node, kind in types.items()})

    def refuse(_: Rig) -> None:
        raise ControlCycleError(rig, [0, 1, 2])

    monkeypatch.setattr(cycle_check, "refuse_cycles", refuse)
    found: Any = Noted()
    check_cycles(rig, "rule", found)
    ((rule, title, pointer, path),) = found.added
    assert (rule, title, pointer) == ("rule", f"node '{rig.names[at]}'", f"/nodes/{at}")
    assert path == "each of these needs the next: 'a' → 'b' → 'c' → 'a'"


def test_a_node_of_usd_is_pointed_at_by_its_path() -> None:
    rig = replace(chain((0, 0, 0), (1, 0, 0)), keys=("/r", "/r/b"))
    assert title_and_pointer(rig, 1) == ("node 'b'", f"<{rig.path(1)}>")


def test_a_rig_without_a_cycle_has_no_finding() -> None:
    found: Any = Noted()
    check_cycles(chain((0, 0, 0), (1, 0, 0)), "rule", found)
    assert not found.added
