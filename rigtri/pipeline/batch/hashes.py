"""Hashes of files: what was read and what was written, whatever the times of files are."""

from __future__ import annotations

import hashlib
import os
import stat
import threading
from collections.abc import Iterable, Mapping
from pathlib import Path

from rigtri.errors import FileError
from rigtri.files.relative_path import relative_path
from rigtri.pipeline.batch import urls

# What stands for a file that is not there.
ABSENT = ""
# A file of which others may need the hash soon, as they may a texture, is worth remembering it.
_MANY = 4096
_KINDS = ((stat.S_ISDIR, "a folder"), (stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"))


class Hashes:
    """SHA-256 of files in hexadecimal; of a file that stays as it is only once. For several threads."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[tuple[int, int, int, int], str]] = {}
        self._lock = threading.Lock()

    def of(self, path: Path | str) -> str:
        """The hash of a file, `ABSENT` where there is no plain file. OSError where it cannot be read."""
        name = os.fspath(path)
        try:
            state = _state(name)
            known = self._known.get(name)
            if known is not None and known[0] == state:
                return known[1]
            with open(name, "rb") as file:
                found = hashlib.file_digest(file, "sha256").hexdigest()
        except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
            return ABSENT
        with self._lock:
            if len(self._known) >= _MANY:
                self._known.clear()
            self._known[name] = state, found
        return found

    def now(self, name: str, folder: str, like: str) -> str:
        """The hash of a file, by its name as seen from ``folder``, of the kind that ``like`` is."""
        return urls.content_hash(name, like) if urls.is_url(name) else self.of(os.path.join(folder, name))

    def of_all(self, paths: Iterable[Path | str], folder: str) -> dict[str, str]:
        """The hashes of files, by their names as seen from ``folder``."""
        return {seen_from(folder, os.fspath(path)): self.of(path) for path in paths}

    def same(self, known: Mapping[str, str], folder: str) -> bool:
        """Whether all of these files are what they were."""
        try:
            return all(self.now(name, folder, value) == value for name, value in known.items())
        except (OSError, FileError):
            return False


def seen_from(folder: str, path: str) -> str:
    """A path as a manifest in ``folder`` has it: relative with forward slashes, whole elsewhere."""
    if urls.is_url(path):
        return path
    return relative_path(os.path.abspath(path), folder)


def no_file(path: str) -> str:
    """Why there is no plain file to read at a path, in words; "" where there is one."""
    try:
        mode = os.stat(path).st_mode
    except OSError as error:
        if os.path.islink(path) and isinstance(error, FileNotFoundError):
            return f"{path} is a link to {os.readlink(path)}, and that is not there"
        return f"there is no such file to read: {path}"
    if stat.S_ISREG(mode):
        return ""
    what = next((word for is_one, word in _KINDS if is_one(mode)), "a device")
    return f"{path} is not a regular file but {what}"


def newer(paths: Iterable[Path], moment: int) -> bool:
    """Whether one of these files was written after a moment (nanoseconds), so that a hash comes too late."""
    for path in paths:
        try:
            if os.stat(path).st_mtime_ns >= moment:
                return True
        except OSError:
            continue
    return False


def _state(name: str) -> tuple[int, int, int, int]:
    known = os.stat(name)
    if not stat.S_ISREG(known.st_mode):  # to open a pipe is to wait for its other end
        raise FileNotFoundError(name)
    return known.st_dev, known.st_ino, known.st_size, known.st_mtime_ns
