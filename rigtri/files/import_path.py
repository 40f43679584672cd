"""Where Python looks for modules: never in the folder where somebody works, whose files come from anybody."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress

_guard = threading.Lock()


def leave_out_working_folder() -> None:
    """Let this process import nothing from its working folder, except where rigtri itself lies there."""
    with suppress(FileNotFoundError):  # a working folder that somebody has removed holds no modules
        here = os.path.realpath(os.getcwd())
        if here != os.path.realpath(os.path.join(__file__, "..", "..", "..")):
            sys.path[:] = [entry for entry in sys.path if os.path.realpath(entry) != here]


@contextmanager
def no_working_folder_in_children() -> Iterator[None]:
    """Processes that are started meanwhile look only where this one does by whole paths.

    multiprocessing starts them by ``python -c``, which looks first where it is started. Folders of this
    process that move with its working folder (the console's, or parts of PYTHONPATH) are left out.
    """
    with _guard:
        whole = filter(os.path.isabs, os.environ.get("PYTHONPATH", "").split(os.pathsep))
        variables = {"PYTHONSAFEPATH": "1", "PYTHONPATH": os.pathsep.join(whole)}
        before, places = {name: os.environ.get(name) for name in variables}, sys.path
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
