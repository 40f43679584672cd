"""What long commands show of how far they are: on a terminal alone, one line that goes when they are done."""

from __future__ import annotations

import io
import os
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from places import SAMPLES

import rigtri
from rigtri.cli import check, streams
from rigtri.cli.progress import Progress
from rigtri.formats import read
from rigtri.operations.add_controls import AddControlsOptions, add_controls
from rigtri.operations.bake.bake import BakeOptions, bake
from rigtri.operations.snap import SnapOptions, snap
from rigtri.progress import as_part, as_share, begin_stage, count_done, counted, report_progress
from rigtri.report import Report


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def on_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """A terminal from now on; pytest itself takes standard error between fixtures and tests."""
    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    monkeypatch.setattr("rigtri.cli.progress._PAUSE", 0.0)
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.delenv("NO_COLOR", raising=False)
    return shown


@pytest.mark.parametrize("quiet", [False, True])
def test_clips_of_one_file_are_counted_on_a_terminal(quiet: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with Progress("in/hero.glb", quiet=quiet):
        with as_part("step 2 of 7, bake"):
            begin_stage("edit")
            for done in range(3):
                count_done(done, 2, "clips")
        begin_stage("verify")
    shown = terminal.getvalue()
    assert ("hero.glb: step 2 of 7, bake: edit  \x1b[32m━━━━━━━━━━━━\x1b[0m" in shown) == (not quiet)
    assert ("1/2 clips" in shown) == ("hero.glb: verify" in shown) == (not quiet)
    assert shown.endswith("\r\x1b[K") or quiet
    assert "\n" not in shown


def test_a_line_is_never_wider_than_the_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    monkeypatch.setenv("COLUMNS", "70")
    monkeypatch.setenv("NO_COLOR", "1")
    with Progress("a_name_" * 30 + ".glb"):
        begin_stage("edit")
        count_done(3, 10, "clips")
    lines = [line.removeprefix("\x1b[K") for line in terminal.getvalue().split("\r")]
    assert max(map(len, lines)) < 70
    assert any("3/10 clips" in line for line in lines)
    assert "\x1b[3" not in terminal.getvalue()


def test_files_of_a_batch_have_a_bar_their_rate_and_their_errors(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with Progress(total=4) as progress:
        for failed in (False, True):
            progress.step(failed=failed)
    shown = terminal.getvalue()
    assert "2/4 files" in shown
    assert "1 error" in shown
    assert "━" in shown


class Steps:
    """Notes what it is told."""

    def __init__(self) -> None:
        self.stages: list[str] = []
        self.counts: list[tuple[float, int, str]] = []

    def stage(self, name: str) -> None:
        self.stages.append(name)

    def at(self, done: float, total: int, what: str) -> None:
        self.counts.append((done, total, what))


@pytest.mark.ci
def test_work_on_many_things_tells_how_many_are_done() -> None:
    """Before, 76 clips and 5,000 controls took minutes without a sign."""
    steps = Steps()
    with report_progress(steps):
        rig = add_controls(read(SAMPLES / "biped.glb").rig, options=AddControlsOptions(whole_character=True))
        assert steps.counts == [(k, 23, "controls") for k in range(24)]
        steps.counts.clear()
        rig = bake(rig, options=BakeOptions(to="controls"), report=Report())
        done = [round(done, 9) for done, *_ in steps.counts]
        assert {(total, what) for _, total, what in steps.counts} == {(2, "clips")}
        assert done == sorted(done)
        assert {0, 1, 2} <= set(done)
        assert len([part for part in done if 0 < part < 1]) > 10  # within one clip, too
        steps.counts.clear()
        snap(rig, options=SnapOptions(at=("walk@0.4",), to="fk", limbs="auto"), report=Report())
    assert steps.counts == [(k, 4, "limbs") for k in range(5)]


def test_an_edit_tells_its_stages_and_a_build_its_steps(tmp_path: Path) -> None:
    steps, spec = Steps(), tmp_path / "rig.yaml"
    spec.write_text("steps: [{do: orient-joints}, {do: strip}]")
    with report_progress(steps):
        rigtri.build(SAMPLES / "biped.glb", tmp_path / "out.glb", spec)
    parts = ("step 1 of 2, orient-joints: ", "step 2 of 2, strip: ")
    assert steps.stages == [f"{one}{stage}" for one in parts for stage in ("read", "edit", "write", "verify")]
    assert (0, 2, "clips") in steps.counts


def test_what_is_counted_within_a_count_is_a_part_of_one_of_its_things() -> None:
    steps = Steps()
    with report_progress(steps):
        for _ in counted("ab", "clips"):
            for _ in counted(range(4), "moments"):
                list(counted((), "rivets"))
    quarters = [0, 0.25, 0.5, 0.75, 1]
    assert steps.counts == [(k, 2, "clips") for k in (0, *quarters, 1, *(1 + part for part in quarters), 2)]
    steps.counts.clear()
    with report_progress(steps):  # a count that is broken off takes nothing with it
        for _ in counted("ab", "clips"):
            break
        count_done(1, 3, "limbs")
    assert steps.counts == [(0, 2, "clips"), (1, 3, "limbs")]


def test_shares_of_one_thing_follow_each_other() -> None:
    steps = Steps()
    with report_progress(steps), as_share(0, 0.5):
        assert steps.counts == []  # nothing is begun that this could be a share of
    with report_progress(steps):
        for _ in counted("a", "clips"):
            with as_share(0, 0.5):
                list(counted("ab", "moments"))
            with as_share(0.5, 1):
                list(counted("ab", "controls"))
    assert steps.counts == [(k, 1, "clips") for k in (0, 0, 0, 0.25, 0.5, 0.5, 0.5, 0.75, 1, 1)]


@pytest.mark.ci
def test_a_build_shows_every_pass_over_the_clips(tmp_path: Path) -> None:
    steps, spec = Steps(), tmp_path / "rig.yaml"
    spec.write_text("steps: [{do: add-twist, limbs: auto, split-weights: true}]")
    with report_progress(steps):
        rigtri.build(SAMPLES / "biped.glb", tmp_path / "out.glb", spec)
    named = [stage.partition(": ")[2] for stage in steps.stages]
    assert named == ["read", "edit", "write", "verify", "measure motion"]
    assert (8, 8, "bones") in steps.counts
    assert steps.counts[-1] == (2, 2, "clips")
    steps.counts.clear()
    with report_progress(steps):
        rigtri.convert(SAMPLES / "biped.glb", tmp_path / "out.usda")
    done = [done for done, total, _ in steps.counts if total == 2]  # another pass is over those that play
    assert [done[0], done[-1]] == [0, 2]
    assert sum(after < before for before, after in pairwise(done)) == 1  # written, then measured


def test_the_files_of_a_check_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with pytest.raises(SystemExit):
        check.command.main([str(SAMPLES / "arm.gltf"), str(SAMPLES / "hand.glb")])
    assert "check  \x1b[32m━━━━━━━━━━━━\x1b[0m" in terminal.getvalue()
    assert "1/2 files" in terminal.getvalue()


def test_the_bar_of_a_check_moves_within_one_file() -> None:
    steps = Steps()
    with report_progress(steps):
        for name in counted([SAMPLES / "arm.gltf"], "files"):
            rigtri.check(name)
    done = [done for done, *_ in steps.counts]
    assert done == sorted(done)
    assert len({round(part, 9) for part in done if 0 < part < 1}) > 10
    assert {(total, what) for _, total, what in steps.counts} == {(1, "files")}


@pytest.mark.skipif(os.name != "posix", reason="elsewhere consoles keep their streams")
def test_what_is_to_appear_at_once_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """PYTHONUNBUFFERED: before, the bar went only with the first line that was printed on its place."""
    out, into = os.pipe()
    os.set_blocking(out, False)
    with os.fdopen(out, "rb", buffering=0) as seen, os.fdopen(into, "wb", buffering=0) as end:
        stream = io.TextIOWrapper(end, "utf-8", write_through=True)
        for name in ("stdout", "stderr"):
            monkeypatch.setattr(sys, name, stream)
        streams.keep()
        sys.stderr.write("\x1b[K")
        assert seen.read() == b"\x1b[K"
        monkeypatch.undo()
        stream.detach()
