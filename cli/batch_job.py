"""rigtri batch --emit-openjd: the batch as a job for a render farm, instead of doing it"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import UsageError

from .build import assigned
from .shared_options import READING
from .terminal_text import counted, plain

if TYPE_CHECKING:
    from rigtri.pipeline.batch.inputs import Entry
    from rigtri.pipeline.batch.run import Tasks

# What a job says itself, or what each of its tasks would write into.
_NOT_WITH = ("shard", "dask", "dry_run", "log", "as_json")


def refuse(values: dict[str, Any]) -> None:
    """UsageError for options that a job cannot carry out."""
    for name in _NOT_WITH:
        if values[name]:
            option = "--json" if name == "as_json" else f"--{name.replace('_', '-')}"
            raise UsageError(f"--emit-openjd and {option} do not go together")


def emit(values: dict[str, Any], entries: tuple[Entry, ...], manifest: Path, tasks: Tasks) -> None:
    """Write the job's files, and say what there is to do with them."""
    from rigtri.files.staged_output import as_file_error
    from rigtri.pipeline.batch import openjd

    folder = Path(values["emit_openjd"])
    with as_file_error(manifest.parent):
        manifest.parent.mkdir(parents=True, exist_ok=True)
    paths = {own: tasks(own).paths for own in {entry.variables: None for entry in entries}}
    beside = Path(values["job"] or ".").parent
    entries = tuple(replace(e, variables=_whole(e.variables, paths[e.variables], beside)) for e in entries)
    shared = _whole(assigned(values["variables"]).items(), frozenset().union(*paths.values()), Path())
    words = [*_words(values, shared), "--manifest", os.path.abspath(manifest)]
    parts = openjd.emit(folder, entries, words)
    if not values["quiet"]:
        what = f"{counted(len(entries), 'file')} in {counted(parts, 'part')}"
        click.echo(
            plain(f"{folder / openjd.TEMPLATE}: {what}; nothing else is done yet", one_line=True), err=True
        )


def _whole(
    variables: Iterable[tuple[str, str]], paths: frozenset[str], folder: Path
) -> tuple[tuple[str, str], ...]:
    """Variables, whole paths for those that are seen from a folder: a task begins in another one."""
    return tuple(
        (name, os.path.abspath(folder / text) if name in paths else text) for name, text in variables
    )


def _words(values: dict[str, Any], variables: Iterable[tuple[str, str]]) -> Iterator[str]:
    """The command's options as a task is to have them."""
    yield from ("--spec", os.path.abspath(values["spec"]))
    for name, text in variables:
        yield from ("--set", f"{name}={text}")
    for name in ("jobs", "timeout", "max_memory", "max_errors", "tolerance", "resources"):
        if values[name] is not None:
            yield from (f"--{name.replace('_', '-')}", str(values[name]))
    for name in ("fail_fast", "strict", "overwrite", "quiet", *READING):
        if values[name]:
            yield f"--{name.replace('_', '-')}"
    if not values["verify"]:
        yield "--no-verify"
