"""The installed program, run in this process."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.metadata import entry_points
from typing import Any

import click
from click.testing import CliRunner


@dataclass(frozen=True)
class Ran:
    """How a command ended and what it has printed."""

    exit_code: int
    stdout: str
    stderr: str
    output: str
    stdout_bytes: bytes

    @property
    def json(self) -> Any:
        """What ``--json`` has printed."""
        return json.loads(self.stdout)


def program() -> click.Group:
    """The installed program, found the way the shell finds it."""
    (script,) = entry_points(group="console_scripts", name="rigtri")
    found = script.load()
    assert isinstance(found, click.Group)
    return found


def cli(
    *words: object,
    code: int | None = None,
    stdin: bytes | str | None = None,
    env: Mapping[str, str | None] | None = None,
) -> Ran:
    """Run ``rigtri`` with these words (paths and numbers as they are).

    ``code`` is the exit code that it has to end with.
    Exceptions that are no error of rigtri are raised.
    """
    result = CliRunner(env=env).invoke(
        program(), [str(word) for word in words], input=stdin, prog_name="rigtri"
    )
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert code is None or result.exit_code == code, result.output
    return Ran(result.exit_code, result.stdout, result.stderr, result.output, result.stdout_bytes)
