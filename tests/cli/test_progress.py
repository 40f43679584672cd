"""What long commands show of how far they are: on a terminal alone, one line that goes when they are done."""

from __future__ import annotations

import io
import sys

import pytest
from places import SAMPLES

from rigtri.cli.progress import Progress
from rigtri.formats import read
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.snap import SnapOptions, snap
from rigtri.report import Report


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("quiet", [False, True])
def test_clips_of_one_file_are_counted_on_a_terminal(quiet: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", Terminal())
    monkeypatch.setattr("rigtri.cli.progress._PAUSE", 0.0)
    with Progress(quiet=quiet) as progress:
        for done in range(3):
            progress.at(done, 2, "clips")
    shown = sys.stderr.getvalue()  # type: ignore[attr-defined]
    assert ("1/2 clips" in shown) == (not quiet)
    assert shown.endswith("\r\x1b[K") or quiet
    assert "\n" not in shown


def test_bake_and_snap_tell_how_many_clips_and_limbs_are_done() -> None:
    """Before, 76 clips took minutes without a sign."""
    steps: list[tuple[int, int, str]] = []
    report = Report(on_progress=lambda *step: steps.append(step))
    rig = add_controls(read(SAMPLES / "biped.glb").rig, options=AddControlsOptions(whole_character=True))
    rig = bake(rig, options=BakeOptions(to="controls"), report=report)
    assert steps == [(0, 2, "clips"), (1, 2, "clips"), (2, 2, "clips")]
    steps.clear()
    snap(rig, options=SnapOptions(at=("walk@0.4",), to="fk", all_limbs=True), report=report)
    assert steps == [(k, 4, "limbs") for k in range(5)]
