"""Where child processes look for modules: only where this one does."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

_guard = threading.Lock()


@contextmanager
def no_working_folder_in_children() -> Iterator[None]:
    """Processes that are started meanwhile look only where this one does by whole paths.

    multiprocessing starts them by ``python -c``, which looks first where it is started. Folders of this
    process that move with its working folder (the console's) are left out, and of PYTHONPATH those that
    it does not search itself.
    """
    with _guard:
        before, places = {name: os.environ.get(name) for name in ("PYTHONSAFEPATH", "PYTHONPATH")}, sys.path
        searched = {os.path.realpath(entry) for entry in places if os.path.isabs(entry)}
        named = filter(os.path.isabs, (before["PYTHONPATH"] or "").split(os.pathsep))
        whole = [entry for entry in named if os.path.realpath(entry) in searched]
        variables = {"PYTHONSAFEPATH": "1", "PYTHONPATH": os.pathsep.join(whole)}
        os.environ.update(variables)
        sys.path = [entry for entry in places if os.path.isabs(entry)]
        try:
            yield
        finally:
            sys.path = places
            for name, value in before.items():
                if value is None:
                    del os.environ[name]
                else:
                    os.environ[name] = value
