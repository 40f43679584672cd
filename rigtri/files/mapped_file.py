"""Large files are mapped instead of read, and copied without passing through this process.

Source: mmap(2), copy_file_range(2).
"""

from __future__ import annotations

import errno
import mmap
import os
import stat
from pathlib import Path
from typing import BinaryIO

import numpy as np

from rigtri.errors import FileError, system_reason

# Smaller files are read: a mapped file dies with the process that truncates it.
MAP_FROM = 16 * 1024 * 1024
# Windows lets no file be replaced while it is mapped, and edits in place replace their source.
MAPS = os.name != "nt"
# So much is copied at a time; of what the kernel cannot copy, that much is in memory.
CHUNK = 1 << 25
# The kernel copies faster in few large steps; a step of all would delay an interrupt.
AT_ONCE = 1 << 30
# Shorter ranges are not worth a system call of their own.
WORTHWHILE = 1 << 18
# This kernel, or these file systems, cannot copy from file to file.
_CANNOT = (errno.ENOSYS, errno.EXDEV, errno.EINVAL, errno.EOPNOTSUPP, errno.EPERM, errno.EBADF)


class Mapped(mmap.mmap):
    """A mapped file that can still be reached as a file."""

    def __new__(cls, file: int) -> Mapped:
        mapped = super().__new__(cls, file, 0, access=mmap.ACCESS_READ)
        mapped.file = os.dup(file)
        mapped.start = _address(memoryview(mapped))
        return mapped

    file: int
    start: int

    def __del__(self) -> None:
        if hasattr(self, "file"):
            os.close(self.file)

    def forget(self) -> None:
        """Let go of the pages that were read; they are read again when they are needed."""
        if hasattr(mmap, "MADV_DONTNEED"):
            self.madvise(mmap.MADV_DONTNEED)


def load(path: Path) -> memoryview:
    """The bytes of a plain file, mapped instead of read where it is large. FileError where there is none."""
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # to open a pipe waits for whoever writes to it
            raise FileError(f"{path}: cannot be read: it is a folder, a device or a pipe")
        with path.open("rb", buffering=0) as file:
            if not MAPS or os.fstat(file.fileno()).st_size < MAP_FROM:
                return memoryview(file.read())
            return memoryview(Mapped(file.fileno()))
    except (OSError, ValueError) as error:
        raise FileError(f"{path}: cannot be read: {system_reason(error)}") from None


def pour(file: BinaryIO, piece: bytes | bytearray | memoryview) -> None:
    """Write bytes to a file. Ranges of mapped files are copied by the kernel, else chunk by chunk."""
    mapped = piece.obj if isinstance(piece, memoryview) else None
    if not isinstance(mapped, Mapped) or len(piece) < WORTHWHILE or not isinstance(piece, memoryview):
        file.write(piece)
        return
    for start in range(_copied(mapped, _address(piece) - mapped.start, len(piece), file), len(piece), CHUNK):
        file.write(piece[start : start + CHUNK])
        mapped.forget()


def _address(content: memoryview) -> int:
    return int(np.frombuffer(content, np.uint8).__array_interface__["data"][0])


def _copied(mapped: Mapped, start: int, size: int, file: BinaryIO) -> int:
    """How many bytes of a range the kernel has copied to the end of ``file``."""
    if not hasattr(os, "copy_file_range"):
        return 0
    file.flush()
    done = 0
    try:
        while done < size:
            step = min(size - done, AT_ONCE)
            count = os.copy_file_range(mapped.file, file.fileno(), step, offset_src=start + done)
            if count == 0:
                break
            done += count
    except OSError as error:
        if error.errno not in _CANNOT:
            raise
    file.seek(0, os.SEEK_END)
    return done
