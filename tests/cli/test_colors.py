"""Colours: on terminals, and where FORCE_COLOR asks for them; nowhere else."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from places import SAMPLES
from program import cli

BIPED, PAIR = SAMPLES / "biped.glb", SAMPLES / "mirrored_pair.glb"
ESCAPE = "\x1b["
LINES = [
    (["inspect", BIPED], "\x1b[31mx"),
    (["recognise", BIPED], "\x1b[32m0.99\x1b[0m"),
    (["check", PAIR], "\x1b[33m  warning:\x1b[0m"),
    (["check", SAMPLES / "tail.glb"], "\x1b[32mnothing wrong\x1b[0m"),
    (["verify", BIPED, BIPED], "\x1b[32m  0\x1b[0m of the model's size"),
    (["verify", BIPED, SAMPLES / "hand.glb"], "\x1b[31mlost\x1b[0m"),
    (["diff", BIPED, SAMPLES / "tpose.glb"], "\x1b[33m"),
    (["dance"], "\x1b[31mrigtri:\x1b[0m No such command"),
    (["inspect", BIPED, "--root", "hips"], "\x1b[33mwarning:\x1b[0m"),
]


@pytest.mark.parametrize(
    ("line", "painted"), LINES, ids=lambda each: str(each[0]) if isinstance(each, list) else ""
)
def test_what_matters_has_a_colour_where_colours_are_requested(line: list[object], painted: str) -> None:
    whole = cli(*line, env={"FORCE_COLOR": "1", "NO_COLOR": None})
    assert painted in whole.stdout + whole.stderr
    for environment in ({"FORCE_COLOR": "1", "NO_COLOR": "1"}, {"FORCE_COLOR": None, "NO_COLOR": None}):
        plain = cli(*line, env=environment)
        assert ESCAPE not in plain.stdout + plain.stderr
        assert (plain.stdout, plain.exit_code) == (_without(whole.stdout), whole.exit_code)


QUIET = [
    ["inspect", BIPED],
    ["inspect", BIPED, "--matrices"],
    ["recognise", BIPED],
    ["check", BIPED],
    ["verify", BIPED, BIPED],
    ["diff", BIPED, PAIR],
    ["pose", BIPED, "--at", "walk@0.5"],
    ["explain", "0,0,0", "1,0,.1", "2,0,0"],
    ["mirror", PAIR, "--check"],
    ["orient-joints", BIPED, "--dry-run"],
    ["spec-init", BIPED, "-o", "rig.yaml"],
    ["build", "--spec", "rig.yaml", "--explain"],
]


@pytest.mark.parametrize("line", QUIET, ids=lambda line: str(line[0]))
def test_quiet_is_quiet_in_every_command(
    line: list[object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.yaml").write_text("steps: [{do: orient-joints}]")
    line = [*line, "--overwrite"] if line[0] == "spec-init" else line
    done = cli(*line, "-q", env={"FORCE_COLOR": "1", "NO_COLOR": None})
    assert (done.stdout, done.stderr) == ("", "")


def test_errors_of_a_quiet_run_have_no_colour() -> None:
    done = cli("inspect", "nowhere.glb", "-q", code=3, env={"FORCE_COLOR": "1", "NO_COLOR": None})
    assert done.stderr == "rigtri: There is no file nowhere.glb\n"


def test_json_has_none() -> None:
    for line in (["check", PAIR], ["verify", BIPED, BIPED], ["recognise", BIPED], ["diff", BIPED, PAIR]):
        assert ESCAPE not in cli(*line, "--json", env={"FORCE_COLOR": "1"}).stdout


def _without(text: str) -> str:
    return re.sub(r"\x1b\[\d+m", "", text)
