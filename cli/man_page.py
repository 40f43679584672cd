"""The manual page, made of the help of all commands."""

from __future__ import annotations

import inspect
from collections.abc import Iterator

import click

from rigtri._version import __version__

from .catalogue import GROUPS, page_of
from .help_format import WHOLE, option_groups

_EXIT = {
    "0": "done; of diff: nothing differs; of check: nothing worse than a warning",
    "1": "of check: errors; of diff: something differs; of mirror --check: something is not symmetric",
    "2": "the command line",
    "3": "a file that cannot be read or written",
    "4": "a name that is not there",
    "5": "geometry that does not define the result, or with --strict a warning",
    "6": "the result would look different",
    "7": "some files of a batch failed",
    "129, 130, 143": "hung up, interrupted, terminated",
}
_ENVIRONMENT = {
    "NO_COLOR, FORCE_COLOR": "No colours; or colours also where no terminal is.",
    "RIGTRI_SCHEMES": "Folders with naming schemes, as --scheme reads them.",
    "RIGTRI_COMMAND_OPTION": "The value of an option, such as RIGTRI_ORIENT_JOINTS_PRESET.",
}


def man_page(program: click.Group, root: click.Context) -> str:
    """The page in roff, for section 1."""
    lines = [f'.TH RIGTRI 1 "" "rigtri {__version__}" "User Commands"']
    lines += [".SH NAME", "rigtri \\- re-orient joints and build rigs in glTF, VRM and USD files"]
    lines += [".SH SYNOPSIS", ".B rigtri", "COMMAND [OPTIONS] [ARGS]"]
    lines += [".SH DESCRIPTION", *_paragraphs(program.help or "")]
    for title, commands in GROUPS.items():
        lines.append(f".SH {_text(title.upper())}")
        for name in commands:
            command = program.get_command(root, name)
            assert command is not None
            lines += _command(command, name, root)
    for title, items in (("EXIT STATUS", _EXIT), ("ENVIRONMENT", _ENVIRONMENT)):
        lines.append(f".SH {title}")
        for term, words in items.items():
            lines += [".TP", f".B {_text(term)}", _text(words)]
    return "\n".join(lines) + "\n"


def _command(command: click.Command, name: str, root: click.Context) -> Iterator[str]:
    with click.Context(command, info_name=name, parent=root) as ctx:
        ctx.meta[WHOLE] = True
        yield f".SS rigtri {_text(name)} {_text(' '.join(command.collect_usage_pieces(ctx)))}"
        yield from _paragraphs(command.help or "")
        for title, rows in option_groups(command, ctx):
            yield from (".PP", f".I {_text(title)}")
            for term, words in rows:
                yield from (".TP", f".B {_text(term.strip())}", _text(words))
        yield from (".PP", f"More about it: {_text(page_of(name))}")


def _paragraphs(text: str) -> Iterator[str]:
    """Paragraphs of a help text; those behind a \\b are as they are."""
    for paragraph in inspect.cleandoc(text).split("\n\n"):
        if paragraph.startswith("\b"):
            yield from (".PP", ".nf", *map(_text, paragraph.splitlines()[1:]), ".fi")
        else:
            yield from (".PP", _text(" ".join(paragraph.split())))


def _text(text: str) -> str:
    """A line of text as roff has it."""
    escaped = text.replace("\\", "\\e").replace("-", "\\-")
    return f"\\&{escaped}" if escaped.startswith((".", "'")) else escaped
