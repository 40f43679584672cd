"""One file whose source or output is elsewhere: fetched with what it refers to, done here, and sent."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from rigtri.errors import RigtriError, UsageError, kind_name
from rigtri.files.worker_process import CrashError
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.file_task import Assignment, OnReady, Record
from rigtri.pipeline.batch.hashes import Hashes
from rigtri.pipeline.batch.inputs import Entry


def is_elsewhere(entry: Entry) -> bool:
    return urls.is_url(entry.source) or urls.is_url(entry.target)


class RemoteAssignment:
    """An assignment, done in a folder of its own.

    folder: where the manifest is. references: what a file refers to, as paths below its folder. near: what
    does an assignment of files that are here.
    """

    def __init__(
        self,
        assignment: Assignment,
        folder: str,
        scratch: str,
        *,
        references: Callable[[str], list[str]],
        near: Callable[[Assignment, OnReady], Record],
        dry_run: bool,
    ) -> None:
        self._assignment, self._folder, self._scratch = assignment, folder, scratch
        self._references, self._near, self._dry_run = references, near, dry_run
        # The stores' own hashes of what was fetched.
        self._etags: dict[str, str] = {}
        self._hashes = Hashes()

    def done(self, on_ready: OnReady) -> Record:
        """Do it; ``on_ready`` as `rigtri.pipeline.batch.local_engine.Engine.run` has it."""
        entry = self._assignment.entry
        with tempfile.TemporaryDirectory(dir=self._scratch, prefix="rigtri-") as place:
            self._in, self._out = Path(place, "in"), Path(place, "out")
            try:
                here = Entry(self._source(entry.source), self._target(entry.target), entry.variables)
                away = urls.is_url(entry.target)
                record = self._near(
                    replace(self._assignment, entry=here),
                    lambda _, record: None if away else on_ready(self._assignment, self._renamed(record)),
                )
                renamed = self._renamed(record)
                if not away or self._dry_run or record.failed or not record.made:
                    return renamed
                on_ready(self._assignment, renamed)
                self._send(entry.target)
                return replace(renamed, made={name: urls.content_hash(name) for name in renamed.made})
            except CrashError:
                raise
            except RigtriError as error:
                return Record("error", kind_name(type(error)), self._text(str(error)), error.exit_code)

    def _source(self, source: str) -> str:
        """Where the source is here, with the files that it refers to; reading reports what is missing."""
        if not urls.is_url(source):
            return os.path.abspath(source)
        place = self._in / os.path.basename(source)
        self._etags[source] = urls.get(source, place)
        for name in self._references(str(place)):
            url = urls.join(urls.parent(source), name)
            try:
                self._etags[url] = urls.get(url, self._in / name)
            except urls.AbsentError:
                continue
        return str(place)

    def _target(self, target: str) -> str:
        return str(self._out / os.path.basename(target)) if urls.is_url(target) else target

    def _send(self, target: str) -> None:
        """What was made, the output itself last, so that it has all that it refers to."""
        main = self._out / os.path.basename(target)
        every = [path for path in sorted(self._out.rglob("*")) if path.is_file() and path != main]
        for path in every:
            url = urls.join(urls.parent(target), path.relative_to(self._out).as_posix())
            there = urls.content_hash(url, like="sha256")
            if there == self._hashes.of(path):
                continue
            if there and not self._assignment.overwrite:
                raise UsageError(
                    f"{url} exists and is another file than the one that {target} needs there; it is "
                    "replaced only with --overwrite"
                )
            urls.put(path, url)
        urls.put(main, target)

    def _renamed(self, record: Record) -> Record:
        """A record that speaks of the files where they are."""
        read = {self._name(name): value for name, value in record.read.items()}
        return replace(
            record,
            read={name: self._etags.get(name) or value for name, value in read.items()},
            made={self._name(name): value for name, value in record.made.items()},
            message=record.message and self._text(record.message),
            warnings=tuple(warning | {"text": self._text(warning["text"])} for warning in record.warnings),
        )

    def _folders(self) -> list[tuple[Path, str]]:
        entry = self._assignment.entry
        pairs = ((self._in, entry.source), (self._out, entry.target))
        return [(place, urls.parent(url)) for place, url in pairs if urls.is_url(url)]

    def _name(self, name: str) -> str:
        """What a manifest calls a file."""
        whole = Path(os.path.normpath(os.path.join(self._folder, name)))
        for place, folder in self._folders():
            if whole.is_relative_to(place):
                return urls.join(folder, whole.relative_to(place).as_posix())
        return name

    def _text(self, text: str) -> str:
        for place, folder in self._folders():
            text = text.replace(str(place), folder)
        return text
