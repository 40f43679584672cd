"""What rigtri batch prints: which files it does, each as it is done, and a summary."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from typing import IO, TYPE_CHECKING, Any

import click

from rigtri.errors import FileError, system_reason

from .terminal_text import counted, plain, without_advice

if TYPE_CHECKING:
    from rigtri.pipeline.batch.file_task import Record
    from rigtri.pipeline.batch.inputs import Entry, Found
    from rigtri.pipeline.batch.run import Run
    from rigtri.pipeline.batch.shards import Shard

# Failures that are printed while a batch runs; the summary counts all, and the manifest has each.
MOST_SHOWN = 20
# Names missing in files that the summary lists.
MOST_MISSING = 10


def print_selection(
    found: Found, chosen: Sequence[Entry], shard: Shard | None, values: dict[str, Any]
) -> None:
    """Which files are not done, and why."""
    if found.left_out:
        text = f"{counted(found.left_out, 'file')} in {values['out_dir']} skipped: outputs are not inputs"
        click.echo(plain(text, one_line=True), err=True)
    if found.strange:
        text = f"{counted(found.strange, 'file')} that patterns match left out: no glTF, VRM or USD by name"
        click.echo(plain(text, one_line=True), err=True)
    if shard is not None:
        whose = "" if values["shard"] else " (of the SLURM array; --shard 1/1 does all)"
        click.echo(f"part {shard}{whose}: {len(chosen)} of {counted(len(found.entries), 'file')}", err=True)


class Files:
    """Prints each file as it is done: a line in the log, and on standard output with --json.

    advice: what to do about failures that were printed, in the order they came.
    """

    def __init__(self, log: IO[str] | None, shard: str | None, *, as_json: bool) -> None:
        self._log, self._shard, self._as_json = log, shard, as_json
        self._began = datetime.now(UTC).isoformat(timespec="seconds")
        self._failed = 0
        self.advice: dict[str, None] = {}

    def print_record(self, entry: Entry, record: Record) -> None:
        """A line for machines."""
        line = json.dumps(record.as_json(entry, self._began, self._shard), ensure_ascii=False)
        if self._log is not None:
            self._log.write(line + "\n")
            self._log.flush()
        if self._as_json:
            click.echo(line)

    def print_failure(self, entry: Entry, record: Record) -> None:
        """A line for people, without advice that other failures share."""
        self._failed += 1
        if self._failed <= MOST_SHOWN:
            text, advice = without_advice(str(record.message))
            self.advice |= dict.fromkeys(advice)
            line = text.strip().splitlines()[-1] if record.kind == "bug" else text
            where = "" if entry.source in line else f"{entry.source}: "
            click.echo(f"{record.status}: {plain(where + line, one_line=True)}", err=True)
        elif self._failed == MOST_SHOWN + 1:
            click.echo("more failures are counted in the summary", err=True)


def print_summary(session: Run, left: int, advice: Iterable[str], values: dict[str, Any]) -> None:
    """What became of all files. left: those that were not begun."""
    from rigtri.pipeline.batch.file_task import STATUSES

    counts = [f"{session.counts[status]} {status}" for status in STATUSES if session.counts[status]]
    words = [*counts, *([f"{left} not started"] if left else [])]
    text = ", ".join(words) or "nothing to do"
    click.echo(f"{counted(session.counts.total() + left, 'file')}: {text}", err=True)
    for what, count in session.missing.most_common(MOST_MISSING):
        click.echo(plain(f"in {count} of them: {what}", one_line=True), err=True)
    if len(session.missing) > MOST_MISSING:
        more = len(session.missing) - MOST_MISSING
        click.echo(f"{counted(more, 'more missing name')}; rigtri batch-report lists them", err=True)
    for line in advice:
        click.echo(line, err=True)
    if values["dry_run"]:
        click.echo("Nothing was written (--dry-run).", err=True)


@contextmanager
def opened_log(path: str | None) -> Iterator[IO[str] | None]:
    """The file that gets a line for each file.

    FileError where it cannot be written, or holds anything but JSON lines, which more lines would damage.
    """
    if path is None:
        yield None
        return
    try:
        with suppress(FileNotFoundError), open(path, "rb") as before:
            if before.read(1) not in (b"", b"{"):
                raise FileError(f"--log {path} holds something else than JSON lines, which it would add to")
        file = open(path, "a", encoding="utf-8", errors="backslashreplace")  # noqa: SIM115
    except OSError as error:
        raise FileError(f"--log {path} cannot be written: {system_reason(error)}") from error
    with file:
        yield file
