"""How every command that writes a file runs: do it, write its report and what stands beside, tell it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import FileError, RigtriError, UsageError
from rigtri.report import Report

from .given_options import destination, given, read_options, refuse_given
from .help_format import Option
from .output_file import write_output
from .printing import print_joints, print_json, print_verification, print_warnings
from .progress import Progress
from .terminal_text import plain

if TYPE_CHECKING:
    from pathlib import Path

    from rigtri.files.staged_output import StagedOutput
    from rigtri.pipeline.edit import EditRequest, Outcome


_GLTF_ONLY = ("resources", "lenient", "unknown_node_ext", "vrm_constraints")
_USD_ONLY = ("edit_target", "bake_xform", "allow_rename", "allow_missing")


def run_edit(
    name: str,
    values: dict[str, Any],
    step: Callable[[Any, Report], Any],
    options: dict[str, Any],
    summary: Callable[[Report], str],
    besides: Callable[[Report], None] = lambda report: None,
    more: Callable[[], dict[str, Any]] = dict,
) -> Outcome:
    """Run an edit with a command's shared options; print and write its report.

    besides: writes what the command writes more. All files are there before anything is printed: where
    that fails, only the words are lost. more: for the report, as of `run`.
    """
    from rigtri.pipeline.edit import edit_file

    _check_format(values)
    request = replace(edit_request(values), ahead=click.get_current_context().obj)
    return run(name, values, lambda report: edit_file(request, step, report), options, summary, besides, more)


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
    output, quiet = values["output"], values["quiet"]
    if values["sidecar"] and output == "-":
        raise UsageError("--sidecar needs the name of a file; give OUT a name")
    check_side_files(values)
    report = Report()
    try:
        with Progress(str(values["source"] or values["output"]), quiet=quiet or values["as_json"]):
            outcome = done(report)
    except RigtriError:
        if not quiet:
            print_warnings(report.warnings, values["verbose"])
        raise
    document = _report_json(name, values, options, outcome) | more()
    if values["report_path"] is not None:
        write_output(json.dumps(document, indent=2, ensure_ascii=False) + "\n", values["report_path"])
    besides(report)
    if values["as_json"]:
        print_json(document)
    if not quiet:
        print_warnings(report.warnings, values["verbose"])
        if values["verbose"]:
            print_joints(report)
        click.echo(plain(summary(report)), err=True)
        print_verification(outcome, values)
    return outcome


def _report_json(
    command: str, values: dict[str, Any], options: dict[str, Any], outcome: Outcome
) -> dict[str, Any]:
    """The document that ``--report`` and ``--json`` give; schemas/report.schema.json describes it."""
    from rigtri._version import __version__

    verification, report = None, outcome.report
    if outcome.verification is not None:
        measured = {"tolerance": values["tolerance"], "unread": outcome.unread}
        verification = outcome.verification.as_json() | measured
    return {
        "rigtri": __version__,
        "command": command,
        "source": str(values["source"]),
        "target": values["output"],
        "written": outcome.written,
        "dry_run": values["dry_run"],
        "options": options,
        "joints": report.joints,
        "limbs": report.limbs,
        "added": report.added,
        "removed": report.removed,
        "warnings": [notice.as_record() for notice in report.warnings],
        "verification": verification,
        "seconds": {name: round(value, 4) for name, value in outcome.seconds.items()},
        **({"hides": outcome.hides} if outcome.hides else {}),
    }


def _check_format(values: dict[str, Any]) -> None:
    """Refuse what the format of IN gives no meaning to."""
    if str(values["source"]) == "-":
        return
    usd = str(values["source"]).lower().endswith((".usd", ".usda", ".usdc", ".usdz"))
    foreign = _GLTF_ONLY if usd else _USD_ONLY
    refuse_given(
        {f"--{name.replace('_', '-')}": name for name in foreign},
        f"means nothing for {'USD' if usd else 'glTF'} files",
    )


def copy_ahead(ctx: click.Context, values: dict[str, Any]) -> None:
    """Begin to copy the large files that OUT will need beside it, before anything slow is imported."""
    from pathlib import Path

    from rigtri.files.background_copy import copy_in_background

    named = "-" not in (str(values["source"]), destination(values))
    if named and not values["dry_run"] and values["resources"] != "relink":
        source, target = Path(values["source"]), Path(destination(values))
        ctx.obj = ctx.with_resource(copy_in_background(source, target, overwrite=values["overwrite"]))


def edit_request(values: dict[str, Any]) -> EditRequest:
    """What a command is to do to a file."""
    from rigtri.pipeline.edit import EditRequest

    def with_sidecar(outcome: Outcome, written: StagedOutput) -> None:
        from rigtri.pipeline.sidecar import add_sidecar

        add_sidecar(_sidecar(values), written, values.get("reading") or read_options(values))

    same = {name: values[name] for name in ("verify", "tolerance", "dry_run", "strict")}
    return EditRequest(
        values["source"],
        destination(values),
        read_options(values),
        overwrite=values["overwrite"] or values["output"] is None,
        side_files=tuple(path for path in _side_files(values).values() if str(path) != "-"),
        ready=with_sidecar if values["sidecar"] else None,
        **same,
    )


def _side_files(values: dict[str, Any]) -> dict[str, Path]:
    """What the command writes beside OUT, by the options that ask for it."""
    found = dict(_named_files(values, written=True))
    if values.get("sidecar") and values["output"] is not None:
        found["--sidecar"] = _sidecar(values)
    return found


def _named_files(values: dict[str, Any], *, written: bool) -> Iterator[tuple[str, Path]]:
    """The files that options of the command name beside OUT, to be written, or to be read."""
    from pathlib import Path

    for option in click.get_current_context().command.params:
        given = values.get(str(option.name))
        if not isinstance(option, Option) or option.name == "output" or given is None:
            continue
        if isinstance(option.type, click.Path) and (option.group == "output") == written:
            for path in given if option.multiple else [given]:
                yield max(option.opts, key=len), Path(path)


def _sidecar(values: dict[str, Any]) -> Path:
    """The file beside OUT that says what rigtri has stored in it."""
    from pathlib import Path

    from rigtri.export.rig_json import SUFFIX

    return Path(values["output"]).with_suffix(SUFFIX)


def check_side_files(values: dict[str, Any]) -> None:
    """Before anything is done: the files beside OUT can be written, and are none of the others.

    Only one of them, OUT or the result of --json can go to standard output.
    """
    from pathlib import Path

    from rigtri.files import staged_output
    from rigtri.files.atomic_write import same_file

    read = [("IN", Path(values["source"]))] if values["source"] else []
    read += _named_files(values, written=False)
    known = [(flag, path) for flag, path in read if str(path) != "-"]
    if destination(values) != "-":
        target = Path(destination(values))
        for flag, path in known:
            if flag != "IN" and same_file(target, path):
                raise UsageError(f"{target} is the file of {flag}; it would be lost. Give another name")
        known.append(("OUT", target))
    beside = _side_files(values)
    streamed = [f"{flag} -" for flag, path in beside.items() if str(path) == "-"]
    if destination(values) == "-" and not values["dry_run"]:
        streamed.insert(0, "-o -")
    streamed += ["--json"] if values["as_json"] else []
    if len(streamed) > 1:
        raise UsageError(
            f"{streamed[0]} and {streamed[1]} both use standard output; name a file for one of them"
        )
    for flag, path in beside.items():
        if str(path) == "-":
            continue
        if any(same_file(path, other) for _, other in known):
            raise UsageError(f"{flag} {path} names a file that is needed for something else")
        known.append((flag, path))
        path = staged_output.destination(path)
        if path.exists() and not values["overwrite"]:
            raise UsageError(f"{path} exists; it is replaced only with --overwrite")
        if why := staged_output.why_unwritable(path):
            raise FileError(f"{_written_as(flag, path)} cannot be written: {why}")


def _written_as(flag: str, path: Path) -> str:
    """What a file beside OUT is called: by its option where the user gave that, else by what it is."""
    ctx = click.get_current_context()
    named = given(ctx)
    if any(str(option.name) in named for option in ctx.command.params if flag in option.opts):
        return f"{flag} {path}"
    return f"{path}, which goes beside OUT unless {flag} names another place,"
