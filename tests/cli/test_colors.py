"""Colours: on terminals, and where FORCE_COLOR asks for them; nowhere else."""

from __future__ import annotations

import re

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


@pytest.mark.ci
def test_json_has_none() -> None:
    for line in (["check", PAIR], ["verify", BIPED, BIPED], ["recognise", BIPED], ["diff", BIPED, PAIR]):
        assert ESCAPE not in cli(*line, "--json", env={"FORCE_COLOR": "1"}).stdout


def _without(text: str) -> str:
    return re.sub(r"\x1b\[\d+m", "", text)
