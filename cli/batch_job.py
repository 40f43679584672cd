"""rigtri batch --emit-openjd: the batch as a job for a render farm, instead of doing it"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError

from .words import counted, plain

if TYPE_CHECKING:
    from rigtri.batch.entries import Entry

# What a job says itself, or what each of its tasks would write into.
_NOT_WITH = ("shard", "dask", "dry_run", "log", "as_json")


def refuse(values: dict[str, Any]) -> None:
    """UsageError for options that a job cannot carry out."""
    for name in _NOT_WITH:
        if values[name]:
            option = "--json" if name == "as_json" else f"--{name.replace('_', '-')}"
            raise UsageError(f"--emit-openjd and {option} do not go together")


def emit(values: dict[str, Any], entries: tuple[Entry, ...], manifest: Path) -> None:
    """Write the job's files, and say what there is to do with them."""
    from rigtri.batch import openjd
    from rigtri.outputs import as_file_error

    folder = Path(values["emit_openjd"])
    with as_file_error(manifest.parent):
        manifest.parent.mkdir(parents=True, exist_ok=True)
    parts = openjd.emit(folder, entries, [*_words(values), "--manifest", os.path.abspath(manifest)])
    if not values["quiet"]:
        what = f"{counted(len(entries), 'file')} in {counted(parts, 'part')}"
        click.echo(
            plain(f"{folder / openjd.TEMPLATE}: {what}; nothing else is done yet", one_line=True), err=True
        )


def _words(values: dict[str, Any]) -> Iterator[str]:
    """The command's options as a task is to have them."""
    yield from ("--spec", os.path.abspath(values["spec"]))
    for variable in values["variables"]:
        yield from ("--set", variable)
    for name in ("jobs", "timeout", "max_memory", "max_errors", "tolerance", "resources"):
        if values[name] is not None:
            yield from (f"--{name.replace('_', '-')}", str(values[name]))
    for name in ("fail_fast", "strict", "overwrite", "quiet"):
        if values[name]:
            yield f"--{name.replace('_', '-')}"
    if not values["verify"]:
        yield "--no-verify"
