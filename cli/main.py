"""The group of all commands, and the one place where an error becomes words and an exit code."""

from __future__ import annotations

import io
import os
import sys
from importlib import import_module
from typing import Any

import click

from rigtri._version import __version__
from rigtri.errors import FileError, RigtriError

from . import COMPLETION, failures, ignore_interrupts, raise_interrupts, streams, terminal_text
from .catalogue import COMMANDS, GROUPS, similar_commands


class Program(click.Group):
    """Loads commands when they are called and tells errors in one line."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        module = import_module(f"rigtri.cli.{name.replace('-', '_')}")
        command = module.command
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        widest = max(map(len, COMMANDS))
        for title, commands in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(name.ljust(widest), words) for name, words in commands.items()])

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        name = args[0].lower().replace("_", "-")
        if name in COMMANDS or name.startswith("-"):
            return super().resolve_command(ctx, [name, *args[1:]])
        close = [f"'{known}'" for known in similar_commands(name)]
        hint = f" Did you mean {' or '.join(close)}?" if close else ""
        return ctx.fail(f"No such command '{args[0]}'.{hint}")

    def main(self, *args: Any, **extra: Any) -> Any:
        ours = not (args or extra)  # the process, which ends with this
        streams.hold()
        if ours:
            streams.keep()
        if os.environ.get(COMPLETION):  # it only reads: an interrupt may end it at any time
            import_module("rigtri.cli.bash_completion")
        else:
            raise_interrupts()
        try:
            return super().main(*args, **{"complete_var": COMPLETION, **extra})
        except OSError as error:  # of what is said before a command runs, such as --help
            failures.end(None, error)
        except SystemExit as ended:
            if not ended.code and streams.lost():
                # As of any file that cannot be written; 1 is an answer of check and mirror.
                if "--json" in sys.argv:  # of text who reads a part of it wants no more
                    terminal_text.echo_message(
                        "rigtri: standard output was closed before all of the report was written; "
                        "files are written all the same"
                    )
                sys.exit(FileError.exit_code)
            raise
        finally:
            if ours:
                ignore_interrupts()

    def make_context(self, *args: Any, **extra: Any) -> click.Context:
        with failures.exit_on_interrupt():
            return super().make_context(*args, **extra)

    def invoke(self, ctx: click.Context) -> Any:
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):
                # A name may hold half of a surrogate pair, or what the terminal's encoding has not.
                stream.reconfigure(errors="backslashreplace")
        try:
            with failures.exit_on_interrupt():
                return super().invoke(ctx)
        except click.ClickException as error:
            failures.misused(ctx, error)
        except (RigtriError, OSError, MemoryError) as error:
            failures.end(ctx, error)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        # Known before options are read, for that may fail.
        failures.request_json(ctx, None, "--json" in args)
        try:
            return super().parse_args(ctx, args)
        except click.UsageError as error:
            failures.misused(ctx, error)


@click.group(
    cls=Program,
    context_settings={
        "help_option_names": ["-h", "--help"],
        "auto_envvar_prefix": "RIGTRI",
        "max_content_width": 100,
    },
)
@click.version_option(__version__, "-V", "--version", prog_name="rigtri")
def program() -> None:
    """Re-orient joints and build rigs in glTF, VRM and USD files.

    Everything else in the file stays as it was: every edit is measured by skinning
    the source and the result, and refused when they differ.

    \b
    Start with:
        rigtri inspect hero.glb
        rigtri orient-joints hero.glb -o out.glb --aim x --up y
        rigtri verify hero.glb out.glb

    \b
    Then: rigtri COMMAND --help, or rigtri help COMMAND for all of its options.
    The pages that help names:
    https://github.com/rigtri/rigtri/blob/main/docs/index.md
    """
