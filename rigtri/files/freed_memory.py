"""Memory that was freed, given back to the system.

The C library keeps what was freed in small pieces, such as the arrays of 10,000 time samples, in case that
somebody asks for such pieces again; large arrays of numpy are no such pieces.
"""

from __future__ import annotations

import ctypes
import sys


def give_back() -> None:
    """Give back what the C library keeps; nothing where it has no call for that."""
    if sys.platform.startswith("linux"):  # on Windows there is no library of all names
        trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # glibc's alone
        if trim is not None:
            trim(0)
