"""Who works for rigtri batch, and how it hears of an interrupt."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from rigtri.pipeline.batch.inputs import Entry
    from rigtri.pipeline.batch.local_engine import Engine


def address(ctx: click.Context, param: click.Parameter, value: str | None) -> str | None:
    """Where a scheduler may be: a host and a port, or one of this process."""
    if value is not None and not re.fullmatch(
        r"([a-z]+://)?(\[[0-9a-f:.]+\]|[^\s/:]+):[0-9]{1,5}|inproc://.+", value
    ):
        raise click.BadParameter(f"'{value}' is no address of a scheduler: give tcp://HOST:PORT", ctx, param)
    return value


@contextmanager
def engine(values: dict[str, Any], folder: str, chosen: Sequence[Entry]) -> Iterator[Engine]:
    """Who does the work: processes of this machine, or a cluster, whose workers can do it."""
    most = 0 if values["fail_fast"] else values["max_errors"]
    wanted = {"dry_run": values["dry_run"], "max_errors": most}
    if not values["dask"]:
        yield local(values, folder, len(chosen), **wanted)
        return
    from rigtri.pipeline.batch.dask import Cluster

    with Cluster(values["dask"], folder, jobs=values["jobs"], **_limits(values), **wanted) as cluster:
        if chosen:
            cluster.check(chosen)
        yield cluster


def local(values: dict[str, Any], folder: str, files: int, **wanted: Any) -> Engine:
    from rigtri.pipeline.batch.local_engine import Local, processors

    jobs = max(1, min(values["jobs"] or processors(), files))
    return Local(jobs, folder, **_limits(values), **wanted)


def _limits(values: dict[str, Any]) -> dict[str, Any]:
    return {"seconds": values["timeout"], "memory": values["max_memory"]}


@contextmanager
def signals(engines: list[Engine], *, quiet: bool) -> Iterator[list[int]]:
    """Meanwhile an interrupt lets the files end that are begun, and a second one gives them up.

    Gives the signals that were heard.
    """
    heard: list[int] = []

    def hear(number: int, _frame: object) -> None:
        heard.append(number)
        for engine in engines:
            if len(heard) > 1:
                engine.kill()
            else:
                engine.stop()
        if len(heard) == 1 and not quiet:
            os.write(2, b"\nending: files that are begun are finished; once more gives them up\n")

    kinds = [signal.SIGINT, signal.SIGTERM]
    before: list[Any] = [signal.signal(kind, hear) for kind in kinds]
    try:
        yield heard
    finally:
        for kind, old in zip(kinds, before, strict=True):
            signal.signal(kind, old)
