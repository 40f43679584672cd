"""What an edit is expected to have changed, as the result is compared with it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rigs import chain, rig_of

from rigtri.pipeline import edit
from rigtri.report import Report
from rigtri.verification.compare.expected_result import _keyed


@pytest.fixture
def compared(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """A comparison that gives what it was asked for: reposed and kept rest pose, or ``same``."""
    monkeypatch.setattr(edit, "self_check", lambda document, again: "same")
    monkeypatch.setattr(edit, "ExpectedResult", lambda *given, **how: (how["reposed"], how["keeps_clips"]))
    monkeypatch.setattr(edit, "check_result", lambda expected, after, tolerance: expected)

    def run(report: Report, *, edited: bool = True, same: bool = False) -> Any:
        rig = chain((0, 0, 0), (1, 0, 0))
        document: Any = SimpleNamespace(rig=rig, reopen=lambda part: None)
        source, part = tmp_path / "in", tmp_path / "part"
        source.write_bytes(b"1234")
        part.write_bytes(b"1234" if same else b"1235")
        given = chain((0, 0, 0), (1, 0, 0)) if edited else rig
        *_, found = edit._compared(document, source, given, part, 1e-5, report)
        return found

    return run


@pytest.mark.parametrize(
    ("reposed", "rekeyed", "expected"),
    [
        (False, False, (False, True)),
        (True, False, (True, False)),
        (False, True, (True, True)),
        (True, True, (True, False)),
    ],
)
def test_another_rest_pose_or_other_keys_are_looked_at_as_poses(
    compared: Any, reposed: bool, rekeyed: bool, expected: tuple[bool, bool]
) -> None:
    report = Report()
    report.reposed, report.rekeyed = reposed, rekeyed
    assert compared(report) == expected
    assert compared(report, edited=False)[0] is False


def test_the_same_bytes_of_the_same_rig_are_not_read_again(
    compared: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert compared(Report(), edited=False, same=True) == "same"
    assert compared(Report(), edited=True, same=True) == (False, True)
    assert compared(Report(), edited=False, same=False) == (False, True)
    monkeypatch.setattr(edit, "_LARGE", 4)
    assert compared(Report(), edited=False, same=True) == (False, True)


def test_nodes_that_got_other_paths_are_known_by_those_that_they_have_now() -> None:
    """As in USD, whose keys are paths: below a prim that is renamed, or new, all have others."""
    rig = replace(rig_of([*"abc"], [-1, 0, 1], np.zeros((3, 3))), keys=("/a", "/a/b", "/a/b/c"))
    assert _keyed(rig, rig, rig) is rig
    held = replace(rig, names=("a", "x", "c"))
    after = replace(held, keys=("/a", "/a/x", "/a/x/c"))
    found = _keyed(rig, held, after)
    assert found.keys == after.keys
    assert found.names == ("a", "x", "c")
    new = rig_of(["a", "new", "b", "c"], [-1, 0, 1, 2], np.zeros((4, 3)))
    new = replace(new, keys=("/a", None, "/a/b", "/a/b/c"))
    read = replace(new, keys=("/a", "/a/new", "/a/new/b", "/a/new/b/c"))
    assert _keyed(rig, new, read).keys == ("/a", "/a/new/b", "/a/new/b/c")
