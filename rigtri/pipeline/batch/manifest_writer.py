"""Writing the manifest: what was done, in an SQLite file that outlives any run and any kill.

One row for each output, and the hashes of all that was read and written for it. What is about
to appear is put down before it does (`ready`): whoever comes after a kill sees by the hash whether
it did. A run holds the writing transaction all the time but for the moment of a commit, so
that a second run on the same manifest is refused, and readers see the last commit.
"""

from __future__ import annotations

import json
import os
import sqlite3
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import Self

from rigtri.errors import UsageError
from rigtri.pipeline.batch.axis_summary import Axes
from rigtri.pipeline.batch.file_task import Record, reason
from rigtri.pipeline.batch.hashes import seen_from
from rigtri.pipeline.batch.inputs import Entry
from rigtri.pipeline.batch.manifest_lookup import (
    APPLICATION,
    VERSION,
    Known,
    check,
    damaged,
    look_up,
    name_of,
    sqlite_errors,
    stored,
    writable,
)

_TABLES = """
CREATE TABLE files(
    id INTEGER PRIMARY KEY, output TEXT NOT NULL UNIQUE, source TEXT NOT NULL, status TEXT NOT NULL,
    kind TEXT, reason TEXT, exit_code INTEGER NOT NULL, deviation REAL, seconds REAL, axes INTEGER,
    task TEXT NOT NULL, at REAL NOT NULL
);
CREATE TABLE contents(file INTEGER PRIMARY KEY, read TEXT NOT NULL, made TEXT NOT NULL, message TEXT);
CREATE TABLE warnings(
    file INTEGER NOT NULL, code TEXT NOT NULL, joint TEXT, text TEXT NOT NULL
);
CREATE TABLE skeletons(id INTEGER PRIMARY KEY, hash TEXT NOT NULL UNIQUE, joints TEXT NOT NULL);
CREATE TABLE axes(
    id INTEGER PRIMARY KEY, skeleton INTEGER NOT NULL, turns BLOB NOT NULL, UNIQUE(skeleton, turns)
);
CREATE TABLE ready(output TEXT PRIMARY KEY, task TEXT NOT NULL, record TEXT NOT NULL);
CREATE TABLE runs(
    id INTEGER PRIMARY KEY, rigtri TEXT NOT NULL, shard TEXT, began REAL NOT NULL, ended REAL, counts TEXT
);
"""
# With these a summary looks at no row of files but those that it shows; manifests of old get them, too.
_INDEXES = """
CREATE INDEX IF NOT EXISTS files_status ON files(status, kind);
CREATE INDEX IF NOT EXISTS files_deviation ON files(deviation);
CREATE INDEX IF NOT EXISTS files_seconds ON files(seconds);
CREATE INDEX IF NOT EXISTS files_axes ON files(axes);
CREATE INDEX IF NOT EXISTS warnings_file ON warnings(file);
CREATE INDEX IF NOT EXISTS warnings_code ON warnings(code, file);
"""


class Manifest:
    """A manifest that one run writes. Its calls may come from any thread.

    Paths in it are seen from its folder, so that both may be moved together.
    """

    def __init__(self, path: Path, *, shard: str | None = None) -> None:
        """Open or make a manifest. UsageError for one of another version, FileError for no manifest."""
        from rigtri._version import __version__

        self.folder, self._lock = os.path.abspath(path.parent), threading.RLock()
        self._path = path
        new = not path.exists()
        with sqlite_errors(path):
            self._base = sqlite3.connect(path, timeout=0.0, isolation_level=None, check_same_thread=False)
            with ExitStack() as failing:
                if new:
                    failing.push(self._remove)
                failing.callback(self._base.close)
                check(self._base, path, empty=True)
                self._base.execute("PRAGMA journal_mode=WAL")
                self._base.execute("PRAGMA synchronous=NORMAL")
                self._begin()
                if not self._base.execute("PRAGMA user_version").fetchone()[0]:
                    for statement in _TABLES.split(";\n"):
                        self._base.execute(statement)
                    self._base.execute(f"PRAGMA application_id={APPLICATION}")
                    self._base.execute(f"PRAGMA user_version={VERSION}")
                for statement in _INDEXES.split(";\n"):
                    self._base.execute(statement)
                values = (__version__, shard, time.time())
                row = self._base.execute("INSERT INTO runs(rigtri, shard, began) VALUES (?, ?, ?)", values)
                self._run = row.lastrowid
                self._commit()
                failing.pop_all()

    def _remove(self, kind: type[BaseException] | None, *_: object) -> None:
        """Remove a new manifest that SQLite could not write; one that another run has just made is locked."""
        if kind is not None and issubclass(kind, sqlite3.Error):
            for ending in ("", "-wal", "-shm"):
                Path(f"{self._path}{ending}").unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        # What could not be written, as on a full disk, SQLite has rolled back, and its error is on the way.
        with self._lock, closing(self._base), sqlite_errors(self._path):
            if self._base.in_transaction:
                self._base.execute("COMMIT")

    def known(self, entry: Entry) -> Known | None:
        """What is known of an entry's output; None for a new one."""
        with self._lock, sqlite_errors(self._path):
            return look_up(self._base, self.name(entry))

    def name(self, entry: Entry) -> str:
        """What an entry's output is called here."""
        return name_of(self.folder, entry)

    def ready(self, entry: Entry, task: str, record: Record) -> None:
        """Put down what is about to appear, until `done` replaces it."""
        text = json.dumps(vars(record), default=_plain)
        with self._writing() as base:
            values = (self.name(entry), task, text)
            base.execute("INSERT OR REPLACE INTO ready VALUES (?, ?, ?)", values)

    def about_to_be(self) -> dict[str, tuple[str, Record]]:
        """What a killed run was about to let appear: task and record by output."""
        with self._lock, sqlite_errors(self._path):
            rows = self._base.execute("SELECT output, task, record FROM ready").fetchall()
            return {output: (task, _record(text)) for output, task, text in rows}

    def done(self, entry: Entry, task: str, record: Record) -> None:
        """Put down what became of an entry, in place of what was known of it."""
        output = self.name(entry)
        with self._writing() as base:
            axes = self._axes(base, record.axes)
            (number,) = base.execute(
                "INSERT INTO files(output, source, status, kind, reason, exit_code, deviation, seconds, "
                "axes, task, at) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT(output) DO UPDATE SET "
                "source=excluded.source, status=excluded.status, kind=excluded.kind, reason=excluded.reason, "
                "exit_code=excluded.exit_code, deviation=excluded.deviation, seconds=excluded.seconds, "
                "axes=excluded.axes, task=excluded.task, at=excluded.at RETURNING id",
                (
                    output,
                    writable(seen_from(self.folder, entry.source)),
                    record.status,
                    record.kind,
                    writable(reason(record, entry)),
                    record.exit_code,
                    record.deviation,
                    record.seconds.get("all"),
                    axes,
                    task,
                    time.time(),
                ),
            ).fetchone()
            # Of what failed the output of an earlier run may still be there.
            base.execute(
                "INSERT INTO contents VALUES (?, ?, ?, ?) ON CONFLICT(file) DO UPDATE SET "
                "read=excluded.read, message=excluded.message, "
                "made=CASE WHEN excluded.made='{}' THEN made ELSE excluded.made END",
                (number, json.dumps(record.read), json.dumps(record.made), writable(record.message)),
            )
            base.execute("DELETE FROM warnings WHERE file=?", (number,))
            base.executemany(
                "INSERT INTO warnings VALUES (?, ?, ?, ?)",
                [(number, w["code"], writable(w["joint"]), writable(w["text"])) for w in record.warnings],
            )
            base.execute("DELETE FROM ready WHERE output=?", (output,))

    def forget_ready(self, outputs: Iterable[str]) -> None:
        """What was to appear did not."""
        with self._writing() as base:
            base.executemany("DELETE FROM ready WHERE output=?", [(output,) for output in outputs])

    def end(self, counts: dict[str, int]) -> None:
        """Put down how the run ended."""
        with self._writing() as base:
            values = (time.time(), json.dumps(counts), self._run)
            base.execute("UPDATE runs SET ended=?, counts=? WHERE id=?", values)

    def _axes(self, base: sqlite3.Connection, axes: Axes | None) -> int | None:
        """The row of axes, made where they are new."""
        if axes is None:
            return None
        query = (
            "SELECT axes.id FROM axes JOIN skeletons ON skeletons.id=axes.skeleton WHERE hash=? AND turns=?"
        )
        values = (axes.skeleton, axes.turns)
        found = base.execute(query, values).fetchone()
        if found is None:
            base.execute(
                "INSERT OR IGNORE INTO skeletons(hash, joints) VALUES (?, ?)", (axes.skeleton, axes.joints)
            )
            found = base.execute(
                "INSERT INTO axes(skeleton, turns) SELECT id, ? FROM skeletons WHERE hash=? RETURNING id",
                (axes.turns, axes.skeleton),
            ).fetchone()
        return int(found[0])

    @contextmanager
    def _writing(self) -> Iterator[sqlite3.Connection]:
        with self._lock, sqlite_errors(self._path):
            yield self._base
            self._commit()

    def _commit(self) -> None:
        self._base.execute("COMMIT")
        self._begin()

    def _begin(self) -> None:
        try:
            self._base.execute("BEGIN IMMEDIATE")
        except sqlite3.OperationalError as error:
            if "locked" not in str(error):
                raise
            raise UsageError(
                f"{self._path}: another batch is writing this manifest; wait for it, or give another "
                "--manifest"
            ) from None


def _plain(value: Axes) -> dict[str, str]:
    """The axes of a record as text."""
    return {"joints": value.joints, "turns": value.turns.hex()}


def _record(text: str) -> Record:
    fields = stored(text)
    try:
        axes = fields.pop("axes")
        fields["warnings"] = tuple(fields["warnings"])
        record = Record(**fields, axes=axes and Axes(axes["joints"], bytes.fromhex(axes["turns"])))
    except (KeyError, TypeError, ValueError):
        raise damaged() from None
    if not all(isinstance(hashes, dict) for hashes in (record.seconds, record.read, record.made)):
        raise damaged()
    return record
