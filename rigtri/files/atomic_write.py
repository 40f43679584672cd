"""How a file appears: written beside its place, forced to disk, renamed. A kill leaves the old or the new."""

from __future__ import annotations

import errno
import glob
import os
import stat
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from rigtri.text import is_number

# While a large file is written, what is there is forced to disk this often, in seconds.
PAUSE = 0.02


def temp_path(path: Path) -> Path:
    """The part that becomes ``path``: hidden, in its folder, with its suffix, and whose it is."""
    return path.with_name(f".{path.stem}.part-{os.getpid()}{path.suffix}")


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """A part to write; after the block it is on the disk under the name ``path``, or gone."""
    part = temp_path(path)
    try:
        yield part
        commit(part, path)
    except BaseException:  # an interrupt too leaves no part; it goes on up
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def commit(part: Path, path: Path, *, synced: bool = False, named: bool = True) -> None:
    """Force a part to the disk and let it take the name, mode and owner of the file it replaces.

    synced: the disk has it already. named: force the name to the disk, too; else that is for the
    caller, by `fsync_folder`.
    """
    if not synced:
        fsync(part)
    inherit(path, part)  # afterwards, for it may be that nobody may write it then
    os.replace(part, path)
    if named:
        fsync_folder(path.parent)


def same_file(one: Path, other: Path) -> bool:
    """Whether two paths name one file, through links, hard links or letter case too, or one empty place."""
    try:
        return os.path.samefile(one, other)
    except (OSError, ValueError):  # one of them is not there, or is no name for a file at all
        pass
    try:
        return os.path.normcase(os.path.realpath(one)) == os.path.normcase(os.path.realpath(other))
    except (OSError, ValueError):
        return False


def fsync(path: Path) -> None:
    """Wait until the disk has a file."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())


@contextmanager
def fsync_while_writing(file: IO[bytes], *, large: bool) -> Iterator[None]:
    """While a large file is written, let the disk take it.

    Who syncs only at the end waits for the disk as long again as writing took.
    """
    if not large or not hasattr(os, "fdatasync"):
        yield
        return
    done = threading.Event()
    thread = threading.Thread(target=_fsync_until, args=(file.fileno(), done))
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def _fsync_until(file: int, done: threading.Event) -> None:
    with suppress(OSError):  # it comes again with the fsync that counts, and is raised then
        while not done.wait(PAUSE):
            os.fdatasync(file)


def inherit(old: Path, new: Path) -> None:
    """Give a new file the permissions of the old one, where there is one, and where we may its owner."""
    with suppress(OSError):  # some disks know no permissions
        known = old.stat()
        if hasattr(os, "chown") and (known.st_uid, known.st_gid) != (os.geteuid(), os.getegid()):
            with suppress(OSError):
                os.chown(new, known.st_uid, known.st_gid)
        os.chmod(new, stat.S_IMODE(known.st_mode))


def fsync_folder(folder: Path) -> None:
    """Force new names to the disk; some systems cannot, and have done it by themselves."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def resolve_link(path: Path) -> Path:
    """What a link leads to, through all links; anything else as it is. OSError for links in a circle."""
    if not path.is_symlink():
        return path
    try:
        return path.resolve()
    except RuntimeError:  # what Python before 3.13 raises
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP)) from None


def discard_stale(path: Path) -> None:
    """Remove parts of ``path`` that runs left which were killed."""
    for part, _ in stale_parts(path):
        part.unlink(missing_ok=True)


def stale_parts(path: Path, *, every: bool = False) -> list[tuple[Path, int]]:
    """Parts of ``path`` whose process is no more, with its number.

    every: nobody else writes ``path``, so that what still has the number is another process, or one
    that nobody has taken leave of.
    """
    return stale_files(path.parent, f".{path.stem}.part-", path.suffix, every=every)


def stale_files(folder: Path, start: str, end: str = "", *, every: bool = False) -> list[tuple[Path, int]]:
    """Files with the number of a process that is no more between ``start`` and ``end``; as `stale_parts`."""
    found = []
    for part in folder.glob(f"{glob.escape(start)}*{glob.escape(end)}"):
        owner = part.name[len(start) : len(part.name) - len(end)]
        # In a container numbers return soon: what bears ours was there before us.
        if is_number(owner) and (every or int(owner) == os.getpid() or not _runs(int(owner))):
            found.append((part, int(owner)))
    return found


def _runs(process: int) -> bool:
    if os.name != "posix":
        return True  # elsewhere os.kill would end the process it asks about
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
