"""The large files beside a .gltf are copied while its rig is still being read.

Starting, reading and planning take as long as copying some 100 MB; both at once take half.
Nothing is promised by it: a copy is a part (`rigtri.files.atomic_write`), which the writer takes where
it needs just that file there, and which is removed otherwise. No numpy here, so that copies
are under way before it is imported.
"""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from rigtri.errors import FileError, system_reason
from rigtri.files.atomic_write import discard_stale, fsync_while_writing, same_file, temp_path

# Smaller files are copied in no time. A .gltf with embedded data would be read twice for nothing.
FROM = 1 << 24
LONGEST_JSON = 1 << 22
# An interrupt is handled after so many bytes.
STEP = 1 << 26


class BackgroundCopies:
    """Copies that are under way, by their parts."""

    def __init__(self) -> None:
        self._copies: dict[str, _Copy] = {}

    def begin(self, file: Path, place: Path) -> None:
        """Begin to copy a file to the part of ``place``."""
        copy = _Copy(file, place)
        self._copies[os.path.realpath(copy.part)] = copy

    def take(self, source: Path, part: Path) -> bool:
        """Whether ``part`` is now a complete copy of ``source``, which is the caller's from here on."""
        copy = self._copies.pop(os.path.realpath(part), None)
        if copy is None:
            return False
        done = copy.complete() and copy.source == _identity(source)
        if not done:
            copy.drop()
        return done

    def drop(self) -> None:
        """Stop all copies that nobody has taken, and remove them."""
        while self._copies:
            self._copies.popitem()[1].drop()


@contextmanager
def copy_in_background(source: Path, target: Path, *, overwrite: bool = False) -> Iterator[BackgroundCopies]:
    """Begin to copy what a .gltf that becomes ``target`` in another folder will need there.

    Only plain files in the source's folder for which there is no other file yet. Whatever is
    wrong with any file is left to the one who reads it.
    """
    ahead = BackgroundCopies()
    try:
        with suppress(OSError, ValueError, RecursionError):
            if target.suffix.lower() == ".gltf" and (overwrite or not os.path.lexists(target)):
                for file in _large(source, target):
                    ahead.begin(file, target.parent / file.name)
        yield ahead
    finally:
        ahead.drop()


def _large(source: Path, target: Path) -> Iterator[Path]:
    """The large files of a .gltf that have to be copied, each once."""
    if source.suffix.lower() != ".gltf" or target.is_symlink() or same_file(source.parent, target.parent):
        return
    if source.stat().st_size > LONGEST_JSON:
        return
    gltf = json.loads(source.read_bytes())
    seen = {target.name}
    for name in _names(gltf):
        file = source.parent / name
        if name in seen or "\\" in name or ":" in name or Path(name).name != name:
            continue
        seen.add(name)
        large = file.is_file() and not file.is_symlink() and file.stat().st_size >= FROM
        if large and not os.path.lexists(target.parent / name):
            yield file


def _names(gltf: Any) -> Iterator[str]:
    for key in ("buffers", "images"):
        entries = gltf.get(key) if isinstance(gltf, dict) else None
        for entry in entries if isinstance(entries, list) else ():
            uri = entry.get("uri") if isinstance(entry, dict) else None
            if isinstance(uri, str) and uri[:5].lower() != "data:":
                yield unquote(uri)


def _identity(path: Path) -> tuple[int, int, int, int]:
    known = path.stat()
    return known.st_dev, known.st_ino, known.st_size, known.st_mtime_ns


class _Copy:
    """One file on its way to a part, in a thread of its own."""

    def __init__(self, file: Path, place: Path) -> None:
        discard_stale(place)
        self.source, self.part = _identity(file), temp_path(place)
        self._stop, self._done = threading.Event(), False
        self._thread = threading.Thread(target=self._run, args=(file,))
        self._thread.start()

    def _run(self, file: Path) -> None:
        with suppress(OSError, FileError):  # whoever needs the copy makes it again, and gets the error
            self._done = copy_file(file, self.part, self._stop)

    def complete(self) -> bool:
        """Wait for the end; whether all is there, under its name still."""
        self._thread.join()
        return self._done and self.part.is_file() and self.part.stat().st_size == self.source[2]

    def drop(self) -> None:
        self._stop.set()
        self._thread.join()
        with suppress(OSError):
            self.part.unlink(missing_ok=True)


def _by_kernel(source: int, target: int) -> int:
    """How many of the next bytes the kernel has copied; 0 at the end, or where it cannot."""
    with suppress(OSError):
        if hasattr(os, "copy_file_range"):
            return os.copy_file_range(source, target, STEP)
    return 0


def copy_file(file: Path, to: Path, stop: threading.Event | None = None) -> bool:
    """Copy a file, by the kernel where it can, the disk taking it meanwhile; False where it was stopped.

    FileError where it cannot be read, OSError where the copy cannot be written.
    """
    try:
        source = file.open("rb")
    except OSError as error:
        raise FileError(f"{file} cannot be read: {system_reason(error)}") from error
    size = os.fstat(source.fileno()).st_size
    with source, to.open("wb") as target, fsync_while_writing(target, large=size >= FROM):
        while not (stop and stop.is_set()) and _by_kernel(source.fileno(), target.fileno()):
            pass
        while not (stop and stop.is_set()):
            block = source.read(STEP >> 2)
            if not block:
                return True
            target.write(block)
    return False
