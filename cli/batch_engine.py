"""Who works for rigtri batch, and how an interrupt reaches it."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

import click

from . import heard

if TYPE_CHECKING:
    from rigtri.pipeline.batch.inputs import Entry
    from rigtri.pipeline.batch.local_engine import Engine


def address(ctx: click.Context, param: click.Parameter, value: str | None) -> str | None:
    """Where a scheduler may be: a host and a port, or one of this process."""
    if value is not None and not re.fullmatch(
        r"([a-z]+://)?(\[[0-9a-f:.]+\]|[^\s/:]+):[0-9]{1,5}|inproc://.+", value
    ):
        raise click.BadParameter(
            f"'{value}' is not a valid scheduler address: use tcp://HOST:PORT", ctx, param
        )
    return value


@contextmanager
def engine(values: dict[str, Any], folder: str, chosen: Sequence[Entry]) -> Iterator[Engine]:
    """Who does the work: processes of this machine, or a cluster, whose workers can do it."""
    most = 0 if values["fail_fast"] else values["max_errors"]
    options = {"dry_run": values["dry_run"], "max_errors": most}
    if not values["dask"]:
        yield local(values, folder, len(chosen), **options)
        return
    from rigtri.pipeline.batch.dask import Cluster

    with Cluster(values["dask"], folder, jobs=values["jobs"], **_limits(values), **options) as cluster:
        if chosen:
            cluster.check(chosen)
        yield cluster


def local(values: dict[str, Any], folder: str, files: int, **options: Any) -> Engine:
    from rigtri.pipeline.batch.local_engine import Local, processors

    jobs = max(1, min(values["jobs"] or processors(), files))
    return Local(jobs, folder, **_limits(values), **options)


def _limits(values: dict[str, Any]) -> dict[str, Any]:
    return {"seconds": values["timeout"], "memory": values["max_memory"]}


@contextmanager
def signals(engines: list[Engine], *, quiet: bool) -> Iterator[list[int]]:
    """Meanwhile an interrupt lets the files end that are begun, and a second one gives them up.

    engines: who does the work, then who tries whether it can be done, which writes nothing and is given up at
    once. Yields the signals that were received.
    """
    received: list[int] = []

    def receive(number: int, _frame: object) -> None:
        received.append(number)
        for place, engine in enumerate(engines):
            if place or len(received) > 1:
                engine.kill()
            else:
                engine.stop()
        if len(received) == 1 and not quiet:
            with suppress(OSError):  # nobody reads it
                os.write(2, b"\nstopping: started files are finished; interrupt again to abort them\n")

    kinds = heard()
    before: list[Any] = [signal.signal(kind, receive) for kind in kinds]
    try:
        yield received
    finally:
        for kind, old in zip(kinds, before, strict=True):
            signal.signal(kind, old)
