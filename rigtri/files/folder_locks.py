"""Locks by which threads of one process write into a folder one after the other."""

from __future__ import annotations

import os
import threading
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any
from weakref import WeakValueDictionary


class _FolderLocks:
    """Locks by folder. What is forked has no thread that could let go of them, and begins anew."""

    def __init__(self) -> None:
        self.forget()
        if hasattr(os, "register_at_fork"):
            os.register_at_fork(after_in_child=self.forget)

    def forget(self) -> None:
        self._guard = threading.Lock()
        self._by_folder: WeakValueDictionary[str, Any] = WeakValueDictionary()

    def of(self, folder: Path) -> AbstractContextManager[Any]:
        with self._guard:
            lock: AbstractContextManager[Any] = self._by_folder.setdefault(
                os.path.realpath(folder), threading.RLock()
            )
            return lock


_locks = _FolderLocks()


def folder_lock(folder: Path) -> AbstractContextManager[Any]:
    """What a thread holds while it writes into a folder.

    Parts bear the number of their process, and outputs in one folder share copies: one that is undone takes
    them away.
    """
    return _locks.of(folder)
