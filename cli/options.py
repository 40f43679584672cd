"""Options that several commands share.

source_argument     every command
facing_option       what asks where a straight limb bends
output_option       what writes a file; target_option: of edits
reading_options     edits, inspect, verify, diff: --lenient, --allow-external-paths, --root
edit_options        edits: --overwrite, --dry-run, --report, --strict, --verify, --tolerance …
output_options      every command: --json, -q, -v
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from rigtri.limits import TOLERANCE

from . import failures
from .help_format import Option, option
from .option_types import FilePath, Tolerance

F = TypeVar("F", bound=Callable[..., Any])

source_argument = click.argument("source", metavar="IN", type=FilePath(allow_dash=True))


def output_option(words: str, metavar: str = "OUT", **more: Any) -> Callable[[F], F]:
    """-o OUT: the file that a command writes; ``more`` as click.option takes it."""
    more = {"type": FilePath(allow_dash=True)} | more
    return option("-o", "--output", "output", metavar=metavar, help=words, group="output", **more)


def needed_output(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
    """OUT, which only a dry run does without."""
    if value is None and not ctx.params.get("dry_run"):
        raise click.MissingParameter(ctx=ctx, param=param)
    return value


_IN_FORMAT = "The file to write, in the format of IN; - for standard output."
target_option = output_option(f"{_IN_FORMAT} Required unless --dry-run.", callback=needed_output)
optional_target_option = output_option(_IN_FORMAT)


def verify_option(
    words: str = "Compare source and result in every pose before OUT appears.",
) -> Callable[[F], F]:
    """Whether a result is measured."""
    return option(
        "--verify/--no-verify", default=True, show_default=True, help=words, group="safety", rare=True
    )


def tolerance_option(
    words: str = "Refuse a result that differs by more than this share of the bounding-box diagonal.",
) -> Callable[[F], F]:
    """How far a result may be off."""
    about: dict[str, Any] = {"type": Tolerance(), "default": TOLERANCE, "show_default": True, "help": words}
    return option("--tolerance", group="safety", rare=True, **about)


def strict_option(words: str = "Make any warning an error (5).") -> Callable[[F], F]:
    """Whether warnings are errors."""
    return option("--strict", is_flag=True, help=words, group="safety")


def report_option(words: str) -> Callable[[F], F]:
    """The file with what was done, for machines."""
    return option(
        "--report",
        "report_path",
        metavar="FILE.json",
        type=FilePath(dir_okay=False),
        help=f"{words}, with the measured deviation.",
        group="output",
    )


def overwrite_option(what: str = "OUT") -> Callable[[F], F]:
    """Whether a file that is there may be lost."""
    return option("--overwrite", is_flag=True, help=f"Replace {what} where it exists.", group="safety")


def preset_option(words: str) -> Callable[[F], F]:
    """The axes of another program."""
    from rigtri.operations.axis_presets import PRESETS

    values = {name: style.words for name, style in PRESETS.items()}
    return option("--preset", type=click.Choice(list(PRESETS)), help=words, group="what", values=values)


dry_run_option = option(
    "-n",
    "--dry-run",
    is_flag=True,
    is_eager=True,
    group="safety",
    help="Do everything except write the output.",
)


def reading_options(command: F) -> F:
    """How a difficult file is read."""
    for add in (
        option(
            "--root",
            metavar="NODE",
            help="Use this node and all below it as the rig, in a file without a skeleton.",
            group="joints",
            rare=True,
        ),
        option(
            "--lenient",
            is_flag=True,
            help="Read nodes that glTF forbids where the meaning is clear (matrix beside TRS).",
            group="safety",
            rare=True,
        ),
        option(
            "--allow-external-paths",
            is_flag=True,
            help="Read buffers and USD layers outside the folder of IN. Nothing is ever fetched.",
            group="safety",
            rare=True,
        ),
        option(
            "--allow-missing",
            is_flag=True,
            help="USD: leave out layers that are damaged. Missing ones always are, with a warning.",
            group="safety",
            rare=True,
        ),
    ):
        command = add(command)
    return command


allow_rename_option = Option(
    ["--allow-rename"],
    is_flag=True,
    help="USD: allow a split to rename joints, whose names are paths.",
    group="safety",
    rare=True,
)


scheme_option = option(
    "--scheme",
    "own",
    metavar="FILE",
    type=FilePath(path_type=Path),
    multiple=True,
    help="Try this naming scheme (.toml) before rigtri's own. Repeatable. RIGTRI_SCHEMES lists folders.",
    group="joints",
    rare=True,
)
json_option = option(
    "--json",
    "as_json",
    is_flag=True,
    is_eager=True,
    callback=failures.request_json,
    help="Print the result as JSON.",
    group="output",
)
quiet_option = option("-q", "--quiet", is_flag=True, group="output", help="Print only errors.")
no_warnings_option = option("-q", "--quiet", is_flag=True, group="output", help="Print no warnings.")


def output_options(command: F) -> F:
    """How much is printed, and in which form."""
    verbose = option(
        "-v", "--verbose", is_flag=True, group="output", help="More detail: each joint, mesh and clip."
    )
    for add in (verbose, quiet_option, json_option):
        command = add(command)
    return command


def extend_help(name: str, text: str) -> Callable[[click.Command], click.Command]:
    """Extend the help of a shared option for one command."""

    def extended(command: click.Command) -> click.Command:
        for each in command.params:
            if isinstance(each, click.Option) and each.name == name:
                each.help = f"{each.help} {text}"
        return command

    return extended


def edit_options(command: F) -> F:
    """What every edit of a file has in common."""
    for add in (
        option(
            "--resources",
            type=click.Choice(["copy", "relink"]),
            default="copy",
            show_default=True,
            help="For a .gltf that is written to another folder: copy its files, or link to them (what then "
            "lies outside its folder is read only with --allow-external-paths).",
            group="output",
            rare=True,
        ),
        option(
            "--edit-target",
            metavar="root|new|bare|LAYER",
            default="root",
            show_default=True,
            help="USD: the layer that gets the opinions and becomes OUT: the root layer, a new one over IN, "
            "which is its sublayer, the bare opinions alone, or a sublayer by its file name.",
            group="output",
            rare=True,
        ),
        tolerance_option(),
        verify_option(),
        strict_option(),
        report_option("Write what was done, per joint and limb"),
        option(
            "--sidecar",
            is_flag=True,
            help="Also write rigtri's metadata of OUT to a file beside it, OUT's name with .rig.json, "
            "for engines and exporters that drop extras.",
            group="output",
            rare=True,
        ),
        dry_run_option,
        overwrite_option(),
    ):
        command = add(command)
    return command
