"""Temporary folders that are gone when their process is, however it ends.

All of a process lie in one of its own, which it keeps locked while it lives. A process that is killed cannot
remove it; the next one that needs such a folder does, for those that nobody holds any more. Where folders
cannot be locked (Windows) what a kill leaves stays.

`tempfile` is imported where it is needed: it brings archives along, and most runs make no temporary folder.
"""

from __future__ import annotations

import os
import threading
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import tempfile

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

PREFIX = "rigtri-tmp-"

_guard = threading.Lock()


class _ProcessFolders:
    """What is of this process."""

    root = ""


def folder() -> tempfile.TemporaryDirectory[str]:
    """A new folder, which is removed at the end of its context."""
    import tempfile

    return tempfile.TemporaryDirectory(dir=root())


def root() -> str:
    """The folder that holds all others of this process."""
    with _guard:
        if not os.path.isdir(_ProcessFolders.root):  # the first, or what somebody has tidied away
            import tempfile

            remove_stale(tempfile.gettempdir())
            _ProcessFolders.root = _made()
        return _ProcessFolders.root


def adopt(place: str) -> None:
    """Let a folder of somebody who lives longer hold all temporary files of this process."""
    import tempfile

    _ProcessFolders.root = tempfile.tempdir = place


def _made() -> str:
    """A new folder, locked, that goes at the end of this process."""
    import shutil
    import tempfile
    from multiprocessing.util import Finalize

    while True:
        place = tempfile.mkdtemp(prefix=PREFIX)
        try:
            _hold(place)
        except (BlockingIOError, FileNotFoundError):  # somebody who clears was faster
            continue
        except OSError:  # a file system without such locks: nobody can clear there either
            pass
        if os.path.isdir(place):
            # After multiprocessing has removed its own folder, which may be in there.
            Finalize(None, shutil.rmtree, args=(place, True), exitpriority=-200)
            return place


def _hold(place: str) -> int:
    """A descriptor that locks a folder until it is closed. BlockingIOError where somebody else does."""
    if fcntl is None:
        raise OSError("no locks of folders")
    held = os.open(place, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(held)
        raise
    return held


def remove_stale(place: str = "") -> None:
    """Remove the folders of processes that are no more.

    place: where they lie; "" for where the environment says that temporary files go.
    """
    named = filter(None, map(os.environ.get, ("TMPDIR", "TEMP", "TMP")))
    place = place or next(filter(os.path.isdir, named), "/tmp")
    with suppress(OSError), os.scandir(place) as found:
        for name in [entry.path for entry in found if entry.name.startswith(PREFIX)]:
            with suppress(OSError):  # somebody's who lives
                held = _hold(name)
                import shutil

                shutil.rmtree(name, ignore_errors=True)
                os.close(held)
