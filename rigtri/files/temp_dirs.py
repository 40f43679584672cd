"""Temporary folders that are gone when their process is, however it ends.

All of a process lie in one of its own, which it keeps locked while it lives. A process that is killed cannot
remove it; the next one that needs such a folder does, for those that nobody holds any more. Where folders
cannot be locked (Windows) what a kill leaves stays.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import threading
from contextlib import suppress

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
    return tempfile.TemporaryDirectory(dir=root())


def root() -> str:
    """The folder that holds all others of this process."""
    with _guard:
        if not os.path.isdir(_ProcessFolders.root):  # the first, or what somebody has tidied away
            remove_stale()
            _ProcessFolders.root = _made()
        return _ProcessFolders.root


def adopt(place: str) -> None:
    """Let a folder of somebody who lives longer hold all temporary files of this process."""
    _ProcessFolders.root = tempfile.tempdir = place


def _made() -> str:
    """A new folder, locked, that goes at the end of this process."""
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


def remove_stale() -> None:
    """Remove the folders of processes that are no more."""
    with suppress(OSError), os.scandir(tempfile.gettempdir()) as found:
        for name in [entry.path for entry in found if entry.name.startswith(PREFIX)]:
            with suppress(OSError):  # somebody's who lives
                held = _hold(name)
                shutil.rmtree(name, ignore_errors=True)
                os.close(held)
