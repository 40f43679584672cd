"""The command line, run in this process."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

import click
from click.testing import CliRunner

# Before 8.2 click keeps standard error apart only where it is told to, and has no output of both.
OLD_CLICK = "mix_stderr" in inspect.signature(CliRunner).parameters
_OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]*[a-z]")


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


@cache
def program() -> click.Group:
    """The group of all commands. Imported late: `conftest` says where this process finds rigtri."""
    found = import_module("rigtri.cli.main").program
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
    Exceptions that are no error of rigtri are raised. Messages may name options of this command, and those
    of others behind the name of theirs.
    """
    runner: Any = CliRunner(env=env, mix_stderr=False) if OLD_CLICK else CliRunner(env=env)
    result = runner.invoke(program(), [str(word) for word in words], input=stdin, prog_name="rigtri")
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    output = result.stdout + result.stderr if OLD_CLICK else result.output
    assert code is None or result.exit_code == code, output
    foreign = [*foreign_options(str(words[0]), result.stderr, words)] if words else []
    assert not foreign, f"{words[0]} has no {foreign}: {result.stderr}"
    return Ran(result.exit_code, result.stdout, result.stderr, output, result.stdout_bytes)


def foreign_options(command: str, text: str, given: Sequence[object]) -> Iterator[str]:
    """The options that a message of a command names, and neither it nor a command named before has.

    given: the words of the command line, which a message may repeat.
    """
    group = program()
    commands = group.list_commands(click.Context(group))
    for line in text.splitlines() if command in commands else ():
        for found in _OPTION.finditer(line):
            named = [
                each for each in commands if re.search(rf"(?<![\w-]){each}(?![\w-])", line[: found.start()])
            ]
            if found[0] not in {
                "--version",
                "--help",
                *map(str, given),
                *(flag for each in [command, *named] for flag in _flags(each)),
            }:
                yield found[0]


@cache
def _flags(command: str) -> frozenset[str]:
    found = program().get_command(click.Context(program()), command)
    assert found is not None
    return frozenset(flag for one in found.params for flag in (*one.opts, *one.secondary_opts))
