"""Options that several commands share, and how results and messages are printed.

source_argument     every command
facing_option       what asks where a straight limb bends
output_option       what writes a file; target_option: of edits
reading_options     edits, inspect, verify, diff: --lenient, --allow-external-paths, --root
edit_options        edits: --overwrite, --dry-run, --report, --strict, --verify, --tolerance …
output_options      every command: --json, -q, -v
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from rigtri.bounds import fits, unfit
from rigtri.errors import FileError, RigtriError, UsageError

from . import failures
from .words import plain

if TYPE_CHECKING:
    from pathlib import Path

    from rigtri.formats import Options
    from rigtri.pipeline import Outcome
    from rigtri.report import Notice, Report
    from rigtri.steps.request import Request


class Tolerance(click.FloatRange):
    """A number from 0 on; nan and inf, with which anything passes, are none."""

    name = "number"

    def __init__(self) -> None:
        super().__init__(min=0)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is no number that differences can be compared with", param, ctx)
        return number


class Number(click.FloatRange):
    """A finite number that files can work with, within bounds as click.FloatRange has them."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = float(super().convert(value, param, ctx))
        if not fits(number):
            self.fail(unfit(number), param, ctx)
        return number


F = TypeVar("F", bound=Callable[..., Any])

TOLERANCE = 1e-5
# Warnings of one kind that are shown without -v.
MOST_ALIKE = 4
_USD_ONLY = ("override", "override_stage", "bake_xform", "allow_rename")


def direction(ctx: click.Context, param: click.Parameter, value: str | None) -> Any:
    """A direction: x,y,z or an axis name."""
    if value is None:
        return None
    from rigtri.ops import ups

    try:
        return ups.direction(value)
    except ValueError as error:
        raise click.BadParameter(str(error), ctx, param) from error


source_argument = click.argument("source", metavar="IN", type=click.Path(allow_dash=True))


def output_option(words: str, metavar: str = "OUT", **more: Any) -> Callable[[F], F]:
    """-o OUT: the file that a command writes; ``more`` as click.option takes it."""
    more = {"type": click.Path(allow_dash=True)} | more
    return click.option("-o", "--output", "target", metavar=metavar, help=words, **more)


def needed_output(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
    """OUT, which only a dry run does without."""
    if value is None and not ctx.params.get("dry_run"):
        raise click.MissingParameter(ctx=ctx, param=param)
    return value


_IN_FORMAT = "The file to write, in the format of IN; - for standard output."
target_option = output_option(f"{_IN_FORMAT} Needed but for --dry-run.", callback=needed_output)
optional_target_option = output_option(_IN_FORMAT)


def verify_option(
    words: str = "Compare source and result in every pose before OUT appears.",
) -> Callable[[F], F]:
    """Whether a result is measured."""
    return click.option("--verify/--no-verify", default=True, show_default=True, help=words)


def tolerance_option(
    words: str = "Refuse a result farther off than this share of the bounding-box diagonal.",
) -> Callable[[F], F]:
    """How far a result may be off."""
    return click.option("--tolerance", type=Tolerance(), default=TOLERANCE, show_default=True, help=words)


def strict_option(words: str = "Make any warning an error (5).") -> Callable[[F], F]:
    """Whether warnings are errors."""
    return click.option("--strict", is_flag=True, help=words)


def report_option(words: str) -> Callable[[F], F]:
    """The file with what was done, for machines."""
    return click.option(
        "--report",
        "report_path",
        metavar="FILE.json",
        type=click.Path(dir_okay=False),
        help=f"{words}, with the measured deviation.",
    )


def overwrite_option(what: str = "OUT") -> Callable[[F], F]:
    """Whether a file that is there may be lost."""
    return click.option("--overwrite", is_flag=True, help=f"Replace {what} where it exists.")


def preset_option(words: str) -> Callable[[F], F]:
    """The axes of another program."""
    from rigtri.ops.presets import PRESETS

    return click.option("--preset", type=click.Choice(list(PRESETS)), help=words)


dry_run_option = click.option(
    "-n", "--dry-run", is_flag=True, is_eager=True, help="Do all but write: report and measure."
)
facing_option = click.option(
    "--facing",
    callback=direction,
    metavar="AXIS|X,Y,Z",
    help="Where the character looks: knees bend forward, elbows back. glTF says +z, USD nothing.",
)


def reading_options(command: F) -> F:
    """What a reader may be told about a difficult file."""
    for option in (
        click.option(
            "--root",
            metavar="NODE",
            help="Take this node and all below it as the rig, in a file without a skeleton.",
        ),
        click.option(
            "--lenient",
            is_flag=True,
            help="Read nodes that glTF forbids where the meaning is clear (matrix beside TRS).",
        ),
        click.option(
            "--allow-external-paths",
            is_flag=True,
            help="Read buffers and USD layers outside the folder of IN. Nothing is ever fetched.",
        ),
    ):
        command = option(command)
    return command


def pole_options(command: F) -> F:
    """Where the pole vector of a limb stands."""
    for option in (
        click.option(
            "--method",
            type=click.Choice(["perpendicular", "ratio"]),
            default="perpendicular",
            show_default=True,
            help="Which point of the chord the direction starts at: nearest to the middle, or by lengths.",
        ),
        click.option(
            "--from",
            "origin",
            type=click.Choice(["middle", "root", "foot"]),
            default="middle",
            show_default=True,
            help="Where the distance is counted from; foot is that point of the chord.",
        ),
        click.option(
            "--reach",
            type=Number(min=0, min_open=True),
            help="Distance as a multiple of the limb's length. [0.5]",
        ),
        click.option(
            "--distance",
            type=Number(min=0, min_open=True),
            help="Distance in world units of the file.",
        ),
        click.option(
            "--reach-of",
            type=click.Choice(["limb", "chord"]),
            default="limb",
            show_default=True,
            help="What --reach multiplies: both bones, or root to end.",
        ),
        click.option(
            "--orientation",
            type=click.Choice(["world", "limb", "aim"]),
            default="world",
            show_default=True,
            help="The locator's axes: the world's, the limb's, or aiming at the middle joint.",
        ),
    ):
        command = option(command)
    return command


def turn_options(command: F) -> F:
    """What becomes of joints that may not turn freely."""
    for option in (
        click.option(
            "--on-nonuniform-scale",
            type=click.Choice(["snap", "skip", "split", "error"]),
            default="snap",
            show_default=True,
            help="A joint whose scale shears under its turn: nearest exact axes, leave it, hold its axes in "
            "a node of its own above it (USD: with --allow-rename), or stop.",
        ),
        click.option(
            "--allow-rename",
            is_flag=True,
            help="USD: a split may rename joints, whose paths name all that is above them.",
        ),
        click.option(
            "--on-constraint",
            type=click.Choice(["freeze", "error"]),
            default="freeze",
            show_default=True,
            help="A joint whose new axes would change what a VRM node constraint does: turn it as the "
            "constraint allows or not at all, and say so; or stop.",
        ),
    ):
        command = option(command)
    return command


def check_streams(before: str, after: str) -> None:
    """UsageError where both files are to come from standard input."""
    if before == after == "-":
        raise UsageError("standard input is one file; give - for one of the two and a name for the other")


def tell_root(source: str, root: str | None) -> None:
    """Say where --root changes nothing: of a glTF file all nodes are read, below a skin or not."""
    from rigtri.formats import GLTF_SUFFIXES

    if root is not None and source.lower().endswith(GLTF_SUFFIXES):
        where = plain(source, one_line=True)
        click.echo(f"warning: {where}: --root changes nothing here, all nodes of a glTF file count", err=True)


json_option = click.option(
    "--json",
    "as_json",
    is_flag=True,
    is_eager=True,
    callback=failures.want_json,
    help="Print the result as JSON.",
)
quiet_option = click.option("-q", "--quiet", is_flag=True, help="Say nothing but errors.")
no_warnings_option = click.option("-q", "--quiet", is_flag=True, help="Leave out the warnings.")


def output_options(command: F) -> F:
    """How much is said, and in which form."""
    verbose = click.option("-v", "--verbose", is_flag=True, help="Say more: each joint, each mesh and clip.")
    return json_option(quiet_option(verbose(command)))


def says_more(name: str, text: str) -> Callable[[click.Command], click.Command]:
    """Tell what else an option that commands share means for one of them."""

    def told(command: click.Command) -> click.Command:
        for option in command.params:
            if isinstance(option, click.Option) and option.name == name:
                option.help = f"{option.help} {text}"
        return command

    return told


def edit_options(command: F) -> F:
    """What every edit of a file has in common."""
    for option in (
        click.option(
            "--resources",
            type=click.Choice(["copy", "relink"]),
            default="copy",
            show_default=True,
            help="A .gltf that moves to another folder takes its files along, or points back (what then "
            "lies outside its folder is read only with --allow-external-paths).",
        ),
        click.option("--override", is_flag=True, help="USD: write only a layer of opinions over IN."),
        click.option(
            "--override-stage",
            is_flag=True,
            help="USD: write such a layer with IN as its sublayer and IN's metadata.",
        ),
        tolerance_option(),
        verify_option(),
        strict_option(),
        report_option("Write what was done, per joint and limb"),
        click.option(
            "--sidecar",
            is_flag=True,
            help="Also write what rigtri has stored in OUT as a file beside it, OUT's name with .rig.json, "
            "for engines and exporters that drop extras.",
        ),
        dry_run_option,
        overwrite_option(),
    ):
        command = option(command)
    return command


def read_options(values: dict[str, Any]) -> Options:
    """The format options among a command's values."""
    from rigtri.formats import Options

    if values.get("override") and values.get("override_stage"):
        raise UsageError("give --override or --override-stage, not both")
    override = "layer" if values.get("override") else ""
    return Options(
        lenient=values.get("lenient", False),
        allow_external_paths=values.get("allow_external_paths", False),
        root=values.get("root"),
        relink=values.get("resources") == "relink",
        override="stage" if values.get("override_stage") else override,
        unknown_node_ext=values.get("unknown_node_ext", "freeze"),
        bake_xform=values.get("bake_xform", False),
        allow_rename=values.get("allow_rename", False),
        empty=values.get("empty", False),
    )


def copy_ahead(ctx: click.Context, values: dict[str, Any]) -> None:
    """Begin to copy the large files that OUT will need beside it, before anything slow is imported."""
    from pathlib import Path

    from rigtri.ahead import begun

    named = "-" not in (str(values["source"]), str(values["target"]))
    if named and not values["dry_run"] and values["resources"] != "relink":
        source, target = Path(values["source"]), Path(values["target"])
        ctx.obj = ctx.with_resource(begun(source, target, overwrite=values["overwrite"]))


def with_target(values: dict[str, Any]) -> dict[str, Any]:
    """A command's values; of a run that writes nothing, and needs no OUT for that, with IN in its place."""
    unnamed = values["target"] is None
    return values | {"unnamed": unnamed, "target": values["source"] if unnamed else values["target"]}


def run_edit(
    name: str,
    values: dict[str, Any],
    step: Callable[[Any, Report], Any],
    options: dict[str, Any],
    summary: Callable[[Report], str],
    besides: Callable[[Report], None] = lambda report: None,
) -> Outcome:
    """Run an edit with a command's shared options; print and write its report.

    besides: writes what the command writes more. All files are there before anything is printed: where
    that fails, only the words are lost.
    """

    from rigtri.pipeline import edit

    values = with_target(values)
    _check_format(values)

    def done(report: Report) -> Outcome:
        return edit(
            values["source"],
            values["target"],
            step,
            options=read_options(values),
            report=report,
            overwrite=values["overwrite"] or values["unnamed"],
            verify=values["verify"],
            tolerance=values["tolerance"],
            dry_run=values["dry_run"],
            strict=values["strict"],
            side_files=side_files(values),
            ahead=click.get_current_context().obj,
        )

    return run(name, values, done, options, summary, besides)


def run(
    name: str,
    values: dict[str, Any],
    done: Callable[[Report], Outcome],
    options: dict[str, Any],
    summary: Callable[[Report], str],
    besides: Callable[[Report], None] = lambda report: None,
    more: Callable[[], dict[str, Any]] = dict,
) -> Outcome:
    """Do what writes a file, and tell and report it as every command does; more: for the report."""
    from rigtri.pipeline import report_json
    from rigtri.report import Report

    source, target, quiet = values["source"], values["target"], values["quiet"]
    if values["as_json"] and target == "-" and not values["dry_run"]:
        raise UsageError("--json and -o - both want standard output; use --report FILE.json")
    if values["sidecar"] and target == "-" and not values["unnamed"]:
        raise UsageError("--sidecar needs a file to stand beside; give OUT a name")
    check_side_files(values)
    report = Report()
    try:
        outcome = done(report)
    except RigtriError:
        if not quiet:
            tell_warnings(report.warnings, values["verbose"])
        raise
    document = report_json(
        name,
        str(source),
        str(target),
        options,
        outcome,
        tolerance=values["tolerance"],
        dry_run=values["dry_run"],
    )
    document |= more()
    _write_beside(values, document)
    besides(report)
    if values["as_json"]:
        click.echo(json.dumps(document, indent=2, ensure_ascii=False))
    if not quiet:
        tell_warnings(report.warnings, values["verbose"])
        if values["verbose"]:
            tell_joints(report)
        click.echo(plain(summary(report)), err=True)
        tell_verification(outcome, values)
    return outcome


def _check_format(values: dict[str, Any]) -> None:
    """Refuse what the format of IN gives no meaning to."""
    if str(values["source"]) == "-":
        return
    usd = str(values["source"]).lower().endswith((".usd", ".usda", ".usdc", ".usdz"))
    foreign = (
        {"--resources": "resources", "--lenient": "lenient", "--unknown-node-ext": "unknown_node_ext"}
        if usd
        else {f"--{name.replace('_', '-')}": name for name in _USD_ONLY}
    )
    refuse_given(foreign, f"means nothing for {'USD' if usd else 'glTF'} files")


def refuse_given(options: dict[str, str], why: str) -> None:
    """UsageError for the first of these options (flag → parameter) that the user gave."""
    given = _given(click.get_current_context())
    for flag, name in options.items():
        if name in given:
            raise UsageError(f"{flag} {why}")


def side_files(values: dict[str, Any]) -> tuple[Path, ...]:
    """The files that a command is to write beside OUT."""
    return tuple(_side_files(values).values())


def _side_files(values: dict[str, Any]) -> dict[str, Path]:
    from pathlib import Path

    flags = {"--report": "report_path", "--save-frames": "save_frames"}
    flags |= {"--spec-out": "spec_out", "--picture": "picture"}
    found = {flag: Path(values[name]) for flag, name in flags.items() if values.get(name) is not None}
    if values.get("sidecar") and not values.get("unnamed"):
        found["--sidecar"] = _sidecar(values)
    return found


def _sidecar(values: dict[str, Any]) -> Path:
    """The file beside OUT that says what rigtri has stored in it."""
    from pathlib import Path

    from rigtri.description import SUFFIX

    return Path(values["target"]).with_suffix(SUFFIX)


def _write_beside(values: dict[str, Any], document: dict[str, Any]) -> None:
    """The report; and what rigtri has stored in OUT as it is on disk, by the names that it has there."""
    from pathlib import Path

    from rigtri.description import description
    from rigtri.formats import read
    from rigtri.outputs import write_text

    if values["report_path"] is not None:
        write_text(Path(values["report_path"]), json.dumps(document, indent=2, ensure_ascii=False) + "\n")
    if not values["sidecar"] or values["dry_run"]:
        return
    reading = values.get("reading") or read_options(values)
    rig = read(Path(values["target"]), reading).rig
    write_text(_sidecar(values), json.dumps(description(rig), indent=2, ensure_ascii=False) + "\n")


def check_side_files(values: dict[str, Any]) -> None:
    """Before anything is done: the files beside OUT can be written, and are none of the others."""
    from pathlib import Path

    from rigtri.delivery import same_file
    from rigtri.outputs import destination

    names = {"like": "--like", "frames": "--frames", "edited": "--from", "described": "--rig"}
    read = {"IN": values["source"], **{flag: values.get(name) for name, flag in names.items()}}
    known = {flag: Path(given) for flag, given in read.items() if given and str(given) != "-"}
    if str(values["target"]) != "-":
        target = Path(values["target"])
        for flag, path in known.items():
            if flag != "IN" and same_file(target, path):
                raise UsageError(f"{target} is the file of {flag}; it would be lost. Give another name")
        known["OUT"] = target
    for flag, path in _side_files(values).items():
        if any(same_file(path, other) for other in known.values()):
            raise UsageError(f"{flag} {path} names a file that is needed for something else")
        known[flag] = path
        path = destination(path)
        if path.exists() and not values["overwrite"]:
            raise UsageError(f"{path} exists; it is replaced only with --overwrite")
        if path.is_dir() or not path.parent.is_dir() or not os.access(path.parent, os.W_OK):
            raise FileError(f"{flag} {path}: no file can be written there")


def tell_warnings(warnings: Iterable[Notice], verbose: bool = False) -> None:
    """The warnings; of many alike, unless ``verbose``, only the first few."""
    said: dict[str, int] = {}
    for notice in warnings:
        said[notice.code] = said.get(notice.code, 0) + 1
        if verbose or said[notice.code] <= MOST_ALIKE:
            click.echo(f"warning: {plain(notice.text, one_line=True)}", err=True)
    for code, count in said.items():
        if count > MOST_ALIKE and not verbose:
            click.echo(f"warning: {count - MOST_ALIKE} more of this kind ({code}); -v shows all", err=True)


def tell_joints(report: Report) -> None:
    """One line per joint: what became of it and why."""
    for entry in report.joints:
        words = [f"  {entry['joint']}: {entry['status']}"]
        if "degrees" in entry:
            words.append(f"{entry['degrees']:.3f}°")
        if "reason" in entry:
            words.append(f"({entry['reason']})")
        if "aims_at" in entry:
            words.append(f"aims at {entry['aims_at']}")
        elif "aim" in entry:
            words.append(f"aim: {entry['aim']}")
        if "up" in entry:
            words.append(f"up: {entry['up']}")
        click.echo(plain(" ".join(words), one_line=True), err=True)


def tell_verification(outcome: Outcome, values: dict[str, Any]) -> None:
    target = values["target"]
    where = "standard output" if target == "-" else target
    if outcome.verification is None:
        click.echo("The result was not compared with the source (--no-verify).", err=True)
    else:
        unread = len(outcome.unread)
        more = f"; {unread} meshes could not be read and were not measured" if unread else ""
        click.echo(plain(outcome.verification.summary() + more, one_line=True), err=True)
    if values.get("explain"):
        click.echo("Nothing was written (--explain).", err=True)
    elif values["unnamed"]:
        click.echo("No OUT was written (--dry-run).", err=True)
    elif values["dry_run"]:
        click.echo(f"{where} was not written (--dry-run).", err=True)
    else:
        click.echo(f"Wrote {where}", err=True)


def points(ctx: click.Context, param: click.Parameter, value: Any) -> Any:
    """Coordinates as three numbers; of many points each."""
    if value is None or isinstance(value, tuple):
        return None if value is None else tuple(_numbers(text, ctx, param) for text in value)
    return _numbers(value, ctx, param)


def _numbers(text: str, ctx: click.Context, param: click.Parameter) -> tuple[float, float, float]:
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise click.BadParameter(f"'{text}' is no point: give x,y,z", ctx, param) from None
    return x, y, z


def request(values: dict[str, Any]) -> Request:
    """What the user asks of the operation of this command."""
    from rigtri.steps.request import Request

    ctx = click.get_current_context()
    return Request(values, frozenset(_given(ctx)), read_options(values))


def _given(ctx: click.Context) -> list[str]:
    unsaid = (None, click.core.ParameterSource.DEFAULT)
    return [name for name in ctx.params if ctx.get_parameter_source(name) not in unsaid]


def given_options(ctx: click.Context) -> dict[str, Any]:
    """The options that the user gave, for the report."""
    quiet = ("source", "target", "as_json", "quiet", "verbose", "report_path")
    return {name: ctx.params[name] for name in _given(ctx) if name not in quiet}
