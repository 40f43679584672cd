"""Shells complete commands, options and their values."""

from __future__ import annotations

import click
import pytest
from click.testing import CliRunner


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_lines_for_a_shell_ask_rigtri(app: click.Group, shell: str) -> None:
    told = CliRunner().invoke(app, ["completion", shell])
    assert told.exit_code == 0
    assert f"_RIGTRI_COMPLETE={shell}_complete" in told.stdout


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("rigtri ori", "plain,orient-joints"),
        ("rigtri orient-joints --pre", "plain,--preset"),
        ("rigtri bake --to ", "plain,controls"),
    ],
)
def test_bash_gets_what_may_come_next(app: click.Group, words: str, wanted: str) -> None:
    asked: dict[str, str | None] = {
        "_RIGTRI_COMPLETE": "bash_complete",
        "COMP_WORDS": words,
        "COMP_CWORD": str(words.count(" ")),
    }
    told = CliRunner(env=asked).invoke(app, [], prog_name="rigtri")
    assert wanted in told.stdout.splitlines()


def test_a_shell_that_nobody_knows_is_a_usage_error(app: click.Group) -> None:
    told = CliRunner().invoke(app, ["completion", "csh"])
    assert told.exit_code == 2
    assert "'bash', 'zsh', 'fish'" in told.stderr
