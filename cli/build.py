"""rigtri build

A step is an operation with its options, as the commands call them. Each step works on the result
of those before; OUT is written when all of them succeed and are verified, or not at all.

\b
Examples:
    rigtri build hero.glb --spec rig.yaml -o out.glb
    rigtri build --spec rig.yaml --explain
    rigtri build hero.glb --spec studio.yaml --set side=left -o out.glb --report out.json
"""

from __future__ import annotations

from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError
from rigtri.report import Report

from .editing import edit_request, run
from .help_format import Command, option
from .option_types import FilePath
from .printing import print_json
from .shared_options import (
    READING,
    dry_run_option,
    optional_target_option,
    output_options,
    report_option,
    shared,
    spec_reading_options,
)
from .terminal_text import plain

if TYPE_CHECKING:
    from rigtri.pipeline.edit import Outcome
    from rigtri.pipeline.rigspec.build import Built
    from rigtri.pipeline.rigspec.load import PlannedStep, Spec

spec_option = partial(
    option,
    "--spec",
    metavar="FILE",
    type=FilePath(dir_okay=False),
    help="The rig spec: YAML or JSON.",
    group="what",
)
set_option = option(
    "--set",
    "variables",
    multiple=True,
    metavar="NAME=VALUE",
    help="Set a variable of the spec.",
    group="what",
)
spec_tolerance_option = shared("tolerance", default=None, more="[as the spec says]")
spec_strict_option = shared("strict", more="[as the spec says]")


@click.command("build", cls=Command, help=__doc__)
@click.argument("source", metavar="[IN]", required=False, type=FilePath(allow_dash=True))
@optional_target_option
@spec_option(required=True)
@set_option
@option(
    "--explain",
    is_flag=True,
    help="Print the steps without writing OUT; with IN, also their results.",
    group="safety",
)
@spec_strict_option
@spec_tolerance_option
@spec_reading_options
@shared("verify")
@report_option("Write what was done, per step, joint and limb")
@dry_run_option
@shared("overwrite")
@output_options
def command(**values: Any) -> None:
    from rigtri.pipeline.rigspec.load import load

    spec = load(values["spec"], variables=assigned(values["variables"]), source=values["source"])
    words = {name: values[name] for name in ("strict", "tolerance", *READING)}
    spec = spec.limited(**words)
    edits = spec.model.edits
    values |= {"tolerance": edits.tolerance, "sidecar": edits.sidecar, "reading": spec.reading}
    if values["explain"]:
        _explain(values, spec)
        return
    if values["source"] is None or (values["output"] is None and not values["dry_run"]):
        raise UsageError("give the character and the file to write: IN -o OUT; or --explain")
    _run(values, spec)


def assigned(texts: tuple[str, ...]) -> dict[str, str]:
    """NAME=VALUE as names and values."""
    found = {}
    for text in texts:
        name, mark, value = text.partition("=")
        if not mark or not name:
            raise UsageError(f"--set {text}: give NAME=VALUE")
        found[name] = value
    return found


def _run(values: dict[str, Any], spec: Spec) -> None:
    from rigtri.pipeline.rigspec.build import build_file

    made: list[Built] = []

    def done(report: Report) -> Outcome:
        made.append(build_file(edit_request(values), spec, report))
        return made[0].outcome

    options = {"spec": values["spec"], "variables": assigned(values["variables"])}

    def steps() -> dict[str, Any]:
        return {"steps": steps_of(made[0])}

    run("build", values, done, options, lambda _: step_lines(made[0]), more=steps)


def steps_of(built: Built, *, places: bool = True) -> list[dict[str, Any]]:
    """The steps of a build for its report. places: also their positions in the spec."""
    return [
        _step_json(one.step, places) | {"summary": summary(one.step.do, one.report)} for one in built.done
    ]


def _step_json(one: PlannedStep, places: bool) -> dict[str, Any]:
    entry = {"step": one.number, "do": one.do, "options": one.given, "optional": one.optional}
    entry |= {"word": one.label.word} if one.label.word else {}
    return entry | ({"place": str(one.place)} if places else {})


def step_lines(built: Built) -> str:
    """A line for each step of a build."""
    return "\n".join(f"{_title(one.step)}: {summary(one.step.do, one.report)}" for one in built.done)


def summary(do: str, report: Report) -> str:
    """What a step did, in the words of its command."""
    for notice in report.warnings:
        if notice.code == "step-left-out":
            return "left out"
    words = import_module(f"rigtri.cli.{do.replace('-', '_')}").summary(report)
    assert isinstance(words, str)
    return words


def _explain(values: dict[str, Any], spec: Spec) -> None:
    """The steps as text; with IN, what each does there, measured but not written."""
    alone = values["source"] is None
    if alone and (values["report_path"] or values["output"]):
        raise UsageError("--explain without IN builds nothing: give IN, or leave out --report and -o")
    for one in () if values["quiet"] else spec.steps:  # beside JSON on standard output they would be none
        click.echo(plain(_line(one), one_line=True), err=values["as_json"])
    if not alone:
        _run(values | {"dry_run": True}, spec)
    elif values["as_json"]:
        from rigtri._version import __version__

        steps = [_step_json(one, places=True) for one in spec.steps]
        document = {"rigtri": __version__, "command": "build", "spec": values["spec"], "steps": steps}
        print_json(document)


def _title(one: PlannedStep) -> str:
    return f"{one.number}. {one.do}{f' ({one.label.word})' if one.label.word else ''}"


def _line(one: PlannedStep) -> str:
    options = "; ".join(f"{name} {_short(value)}" for name, value in one.given.items())
    can_miss = ", optional" if one.optional else ""
    return f"{_title(one)}{can_miss}{': ' if options else ''}{options} ({one.place})"


def _short(value: Any) -> str:
    if isinstance(value, list):
        apart = ", " if any(isinstance(part, list) for part in value) else " "
        return apart.join(_short(part) for part in value)
    if isinstance(value, dict):
        return " ".join(f"{name}={_short(part)}" for name, part in value.items())
    return str(value).lower() if isinstance(value, bool) else str(value)
