"""Finding and reading manifests: what they are called, which are manifests, and what is read of them."""

from __future__ import annotations

import glob
import json
import os
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, overload

from rigtri.errors import FileError, UsageError
from rigtri.model.dataclass import dataclass
from rigtri.pipeline.batch.hashes import seen_from
from rigtri.pipeline.batch.inputs import Entry
from rigtri.pipeline.batch.shards import Shard

NAME = "rigtri-batch.sqlite"
# Of this layout of the tables, and of manifests among other SQLite files.
VERSION = 1
APPLICATION = 0x52494742
_WITHOUT = "Without it a batch does everything again: with another --manifest, and --overwrite"


@dataclass(frozen=True)
class Known:
    """What a manifest knows about an output. made: hashes of what the last run that wrote it wrote."""

    status: str
    task: str
    read: dict[str, str]
    made: dict[str, str]
    deviation: float | None


def check(base: sqlite3.Connection, path: Path, *, empty: bool = False) -> None:
    """UsageError for a manifest of another version, FileError for another file. empty: may be a new one."""
    (version,) = base.execute("PRAGMA user_version").fetchone()
    (application,) = base.execute("PRAGMA application_id").fetchone()
    (tables,) = base.execute("SELECT count(*) FROM sqlite_master").fetchone()
    if empty and not tables and not version:
        return
    if application != APPLICATION:
        raise FileError(f"{path} is not a manifest of rigtri batch; give another --manifest")
    if version != VERSION:
        raise UsageError(
            f"{path} is a manifest of version {version}, and this rigtri knows version {VERSION}: use the "
            f"rigtri that wrote it. {_WITHOUT}"
        )


@contextmanager
def opened(path: Path, *, empty: bool = False) -> Iterator[sqlite3.Connection]:
    """A manifest for reading, also while a run writes it. FileError where it cannot be read.

    empty: it may have no tables yet.
    """
    if path.is_dir():
        raise FileError(f"{path} is a folder and no manifest")
    if not path.is_file():
        raise FileError(f"There is no manifest {path}")
    with sqlite_errors(path):
        base = sqlite3.connect(f"{path.resolve().as_uri()}?{_mode(path)}", uri=True, check_same_thread=False)
        try:
            base.execute("PRAGMA query_only=1")
            check(base, path, empty=empty)
            yield base
        finally:
            base.close()


def _mode(path: Path) -> str:
    """How SQLite is to open a manifest for reading."""
    path = path.resolve()
    if os.access(path, os.W_OK) and os.access(path.parent, os.W_OK):
        return "mode=rw"
    # Who may only read can neither lay out nor tidy up what reading a write-ahead log needs beside it; where
    # nothing stands in one, nobody writes, either.
    log = path.with_name(f"{path.name}-wal")
    return "mode=ro" if log.is_file() and log.stat().st_size > 0 else "mode=ro&immutable=1"


def manifest_path(path: Path, shard: Shard | None) -> Path:
    """Where the manifest of a part of a batch is: each has its own, for machines cannot share one."""
    if shard is None or shard.count == 1:
        return path
    return path.with_name(f"{path.stem}-{shard.numbers}-of-{shard.count}{path.suffix}")


def others_of(path: Path, own: Path) -> list[Path]:
    """The manifests that other parts of a batch have written, and the whole of it, if they are there."""
    found = path.parent.glob(f"{glob.escape(path.stem)}-*-of-*{glob.escape(path.suffix)}")
    return [other for other in (path, *sorted(found)) if other != own and other.is_file()]


def name_of(folder: str, entry: Entry) -> str:
    """What an entry's output is called in the manifests of a folder."""
    return writable(seen_from(folder, entry.target))


@overload
def writable(text: str) -> str: ...
@overload
def writable(text: None) -> None: ...
def writable(text: str | None) -> str | None:
    """Text that SQLite takes: names of files and joints may hold half of a surrogate pair."""
    return text and text.encode("utf-8", "backslashreplace").decode()


def look_up(base: sqlite3.Connection, output: str) -> Known | None:
    """What a manifest knows about an output, by the name that it has there."""
    row = base.execute(
        "SELECT status, task, read, made, deviation FROM files JOIN contents ON file=id WHERE output=?",
        (output,),
    ).fetchone()
    if row is None:
        return None
    status, task, read, made, deviation = row
    if not isinstance(deviation, float | None):  # SQLite takes any type in each column
        raise damaged()
    return Known(status, task, stored(read), stored(made), deviation)


def stored(text: str) -> dict[str, Any]:
    """What a manifest holds as JSON; sqlite3.DatabaseError where somebody has damaged it."""
    try:
        found = json.loads(text)
    except (ValueError, TypeError, RecursionError):
        found = None
    if not isinstance(found, dict):
        raise damaged()
    return found


def damaged() -> sqlite3.DatabaseError:
    """The error for a value that no batch has written."""
    return sqlite3.DatabaseError(f"a value in it is damaged. {_WITHOUT}")


@contextmanager
def sqlite_errors(path: Path) -> Iterator[None]:
    """SQLite's errors as errors of the file."""
    try:
        yield
    except sqlite3.Error as error:
        name = getattr(error, "sqlite_errorname", "")
        remedy = f". {_WITHOUT}" if name in ("SQLITE_NOTADB", "SQLITE_CORRUPT") else ""
        if name == "SQLITE_FULL" or name.startswith("SQLITE_IOERR"):
            remedy = "; make room on that disk and run the same command again, which skips what is done"
        raise FileError(f"{path}: the manifest cannot be used: {error}{remedy}") from error
    except UnicodeDecodeError as error:  # what SQLite says of a damaged layout holds the damaged bytes
        raise FileError(f"{path}: the manifest cannot be used: {damaged()}") from error
