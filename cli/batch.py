"""rigtri batch

IN is a path, a pattern in quotes (** stands for all folders), or @LIST, a file with one of these in each
line. A crash or timeout is reported and does not affect the other files. A second run does only what is
new or changed: file, spec or version. Exit code 0 when all is done, 7 when some files failed, 130 when
interrupted.

\b
Example:
    rigtri batch --spec rig.yaml 'assets/**/*.glb' -O out/
    rigtri batch-report out/
    rigtri batch --convert-to usdz 'assets/**/*.glb' -O usd/
"""

from __future__ import annotations

import os
import sys
from contextlib import ExitStack, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import FileError, UsageError

from . import batch_engine, batch_job, ending, failures
from .batch_messages import Files, opened_log, print_selection, print_summary
from .build import assigned, set_option, spec_option, spec_strict_option, spec_tolerance_option
from .help_format import Command, option
from .option_types import Bytes, FilePath, Integer, Number
from .progress import Progress
from .shared_options import (
    READING,
    dry_run_option,
    json_option,
    quiet_option,
    shared,
    spec_reading_options,
)
from .terminal_text import plain

if TYPE_CHECKING:
    from rigtri.pipeline.batch.file_task import Task
    from rigtri.pipeline.batch.inputs import Found
    from rigtri.pipeline.batch.local_engine import Engine
    from rigtri.pipeline.batch.run import Plan, Run, Tasks
    from rigtri.pipeline.batch.shards import Shard

SOME_FAILED = 7
# What a conversion writes, without the dot.
CONVERTED = ("usda", "usdc", "usdz", "glb", "gltf")


@click.command("batch", cls=Command, help=__doc__)
@click.argument("inputs", metavar="IN…", nargs=-1)
@spec_option()
@set_option
@option(
    "--convert-to",
    type=click.Choice(CONVERTED),
    help="Instead of a spec: write each file in the other format, as rigtri convert does.",
    group="what",
)
@option(
    "-O",
    "--out-dir",
    metavar="DIR",
    type=FilePath(),
    help="Folder of the outputs, which keep the folder tree.",
    group="output",
)
@option(
    "--base",
    metavar="DIR",
    type=FilePath(),
    help="The folder whose tree is kept. [the fixed part of a pattern]",
    group="output",
    rare=True,
)
@option(
    "--job",
    metavar="FILE.jsonl",
    type=FilePath(),
    help="List of inputs, each with its own output and variables.",
    group="what",
)
@option(
    "--manifest",
    metavar="FILE.sqlite",
    type=FilePath(),
    help="File that records what was done. [rigtri-batch.sqlite in DIR]",
    group="output",
)
@option(
    "--log",
    metavar="FILE.jsonl",
    type=FilePath(),
    help="Add a line of JSON for each file.",
    group="output",
    rare=True,
)
@option("-j", "--jobs", type=Integer(1, 1024), help="Number of processes. [one per core]", group="how")
@option(
    "--timeout",
    type=Number(0, min_open=True),
    metavar="SECONDS",
    help="Time limit for one file.",
    group="safety",
)
@option(
    "--max-memory",
    type=Bytes(),
    metavar="SIZE",
    help="Memory limit for one file, e.g. 2G (Linux).",
    group="safety",
)
@option(
    "--dask",
    metavar="tcp://HOST:PORT",
    callback=batch_engine.address,
    help="Run on the workers of a Dask scheduler. [this machine]",
    group="how",
    rare=True,
)
@option(
    "--emit-openjd",
    metavar="DIR",
    type=FilePath(),
    help="Write a job for render farms (Open Job Description) instead.",
    group="output",
    rare=True,
)
@option(
    "--shard",
    metavar="i/n",
    help="Do the i-th of n parts. [of a SLURM array: its own part]",
    group="how",
    rare=True,
)
@option("--fail-fast", is_flag=True, help="Start no other file when one has failed.", group="safety")
@option(
    "--max-errors",
    type=Integer(0),
    metavar="N",
    help="Start no other file when more than N have failed.",
    group="safety",
)
@shared("verify")
@spec_strict_option
@spec_tolerance_option
@shared("resources", default=None, more="[as the spec says, else copy]")
@spec_reading_options
@dry_run_option
@option("--overwrite", is_flag=True, help="Replace outputs that this batch has not written.", group="safety")
@quiet_option
@json_option
def command(inputs: tuple[str, ...], **values: Any) -> None:
    try:
        sys.exit(run(inputs, values, _tasks(values)))
    except KeyboardInterrupt as error:  # before files are worked on, or after
        word, code = ending(error)
        with suppress(OSError):  # the terminal is gone
            click.echo(f"\n{word}: finished files are kept; run it again for the rest", err=True)
        sys.exit(code)


def run(inputs: tuple[str, ...], values: dict[str, Any], tasks: Tasks) -> int:
    """Run a batch with a command's options; its exit code."""
    from rigtri.pipeline.batch.manifest_lookup import manifest_path, opened, others_of
    from rigtri.pipeline.batch.manifest_writer import Manifest
    from rigtri.pipeline.batch.run import Run

    if values["emit_openjd"]:
        batch_job.refuse(values)
    out_dir = _folder(values["out_dir"])
    found = _found(inputs, values, out_dir, tasks)
    whole = _manifest(values, out_dir)
    if values["emit_openjd"]:
        batch_job.emit(values, found.entries, whole, tasks)
        return 0
    shard = _shard(values)
    folder = os.path.abspath(whole.parent)
    chosen = found.entries if shard is None else shard.of(found.entries, folder)
    if not values["quiet"]:
        print_selection(found, chosen, shard, values)
    own = manifest_path(whole, shard)
    with ExitStack() as stack:
        engine = stack.enter_context(batch_engine.engine(values, folder, chosen))
        part = str(shard) if shard else None
        new = not own.is_file()  # a new one is made when it has been seen that there is something to do
        kept = None if values["dry_run"] or new else stack.enter_context(Manifest(own, shard=part))
        known = [*([own] if kept is None else []), *others_of(whole, own)]
        others = [stack.enter_context(opened(path, empty=True)) for path in known if path.is_file()]
        engines = [engine]
        received = stack.enter_context(batch_engine.signals(engines, quiet=values["quiet"]))
        session = Run(tasks, folder, kept, others, overwrite=values["overwrite"])
        plan = session.plan(chosen, lambda: bool(received))
        if len(plan.assignments) > 1 and not plan.settled and not received:
            engines.append(batch_engine.local(values, folder, len(chosen), dry_run=True))
            _try_out(plan, engines[1], quiet=values["quiet"])
        log = stack.enter_context(opened_log(values["log"]))
        files = Files(log, part, as_json=values["as_json"])
        if new and not values["dry_run"]:
            own.parent.mkdir(parents=True, exist_ok=True)
            kept = stack.enter_context(Manifest(own, shard=part))
            session.keep(kept, chosen)
        _work(session, plan, engine, files, quiet=values["quiet"])
        if kept is not None:
            kept.end(dict(session.counts))
    left = len(chosen) - session.counts.total()
    if not values["quiet"]:
        print_summary(session, left, files.advice, values)
    failures.answered(click.get_current_context())
    return 128 + received[0] if received else SOME_FAILED if session.failures else 0


def _tasks(values: dict[str, Any]) -> Tasks:
    """What is done to each file: what the spec makes of it, by its own variables, or a conversion."""
    if values["convert_to"]:
        return _conversion(values)
    if not values["spec"]:
        raise UsageError("give a spec with --spec FILE, or a format with --convert-to")
    from rigtri.pipeline.rigspec.load import load

    shared = assigned(values["variables"])

    def task(own: tuple[tuple[str, str], ...]) -> Task:
        from rigtri.pipeline.batch.spec_task import SpecTask

        folders = {name: Path(values["job"]).parent for name, _ in own}
        spec = load(values["spec"], variables=shared | dict(own), folders=folders)
        words = {name: values[name] for name in ("strict", "tolerance", "resources", *READING)}
        return SpecTask(spec.limited(**words), values["verify"])

    return cache(task)


def _conversion(values: dict[str, Any]) -> Tasks:
    """Each file in the other format. UsageError for options that a conversion has no use for."""
    from rigtri.formats.document import ReadOptions
    from rigtri.limits import TOLERANCE
    from rigtri.pipeline.batch.convert_task import ConvertTask

    for name in ("spec", "variables", "resources", "emit_openjd"):
        if values[name]:
            flag = "--set" if name == "variables" else f"--{name.replace('_', '-')}"
            raise UsageError(f"--convert-to and {flag} do not go together")
    tolerance = TOLERANCE if values["tolerance"] is None else values["tolerance"]
    reading = ReadOptions(**{name: values[name] for name in READING})
    task = ConvertTask(f".{values['convert_to']}", values["verify"], values["strict"], tolerance, reading)

    def same_for_all(own: tuple[tuple[str, str], ...]) -> Task:
        if own:
            raise UsageError("variables are for a spec, and --convert-to has none")
        return task

    return same_for_all


def _folder(name: str | None) -> Path | str | None:
    """A folder that an option names: a path, or as text a URL."""
    from rigtri.pipeline.batch import urls

    return urls.without_secrets(name) if name and urls.is_url(name) else Path(name) if name else None


def _found(
    inputs: tuple[str, ...], values: dict[str, Any], out_dir: Path | str | None, tasks: Tasks
) -> Found:
    """The entries, which can go together; the spec is right for the first of them."""
    from rigtri.pipeline.batch import output_checks
    from rigtri.pipeline.batch.inputs import entries

    job, base = Path(values["job"]) if values["job"] else None, _folder(values["base"])
    suffix = f".{values['convert_to']}" if values["convert_to"] else ""
    found = entries(inputs, job=job, out_dir=out_dir, base=base, suffix=suffix, fits=tasks)
    task = tasks(found.entries[0].variables)
    if task.layers:
        found = entries(inputs, job=job, out_dir=out_dir, base=base, layers=True)
    converts = bool(suffix)
    output_checks.check(
        found.entries, layers=task.layers, beside=task.beside, relink=task.relink, converts=converts
    )
    kept = {"--log": values["log"], "--manifest": _manifest(values, out_dir)}
    lists = [word[1:] for word in inputs if word.startswith("@") and word != "@-"]
    reads = [*task.sources, *task.files(), *([job] if job else []), *map(Path, lists)]
    output_checks.check_nothing_lost(
        found.entries, {flag: Path(path) for flag, path in kept.items() if path}, reads
    )
    return found


def _manifest(values: dict[str, Any], out_dir: Path | str | None) -> Path:
    from rigtri.pipeline.batch.manifest_lookup import NAME

    if values["manifest"]:
        path = Path(values["manifest"])
        if not path.parent.is_dir():
            raise FileError(f"There is no folder {path.parent} to write --manifest {path.name} into")
        return path
    if isinstance(out_dir, str):
        raise UsageError(
            f"-O {out_dir} is remote: name a local file for its manifest with --manifest FILE.sqlite"
        )
    return (out_dir or Path(values["job"]).parent) / NAME


def _shard(values: dict[str, Any]) -> Shard | None:
    from rigtri.pipeline.batch.shards import of_slurm, parse

    return parse(values["shard"]) if values["shard"] else of_slurm(os.environ)


def _try_out(plan: Plan, engine: Engine, *, quiet: bool) -> None:
    from rigtri.pipeline.batch.run import try_out

    if (message := try_out(plan, engine)) and not quiet:
        click.echo(plain(message, one_line=True), err=True)


def _work(session: Run, plan: Plan, engine: Engine, files: Files, *, quiet: bool) -> None:
    """Do the files, and print each as it is done; what was done before is no progress."""
    with Progress(total=len(plan.assignments), quiet=quiet) as progress:
        for number, (entry, record) in enumerate(session.work(plan, engine)):
            files.print_record(entry, record)
            if record.failed:
                progress.clear()
                files.print_failure(entry, record)
            if number >= len(plan.settled):
                progress.step(failed=record.failed)
