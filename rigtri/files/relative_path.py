"""A path as seen from a folder, also where the two have no folder in common."""

from __future__ import annotations

import os
from pathlib import Path


def relative_path(path: Path | str, folder: Path | str) -> str:
    """A path as seen from a folder, with forward slashes; the whole path where it lies on another drive.

    >>> relative_path("/rigs/textures/skin.png", "/rigs/out")
    '../textures/skin.png'
    """
    try:
        found = os.path.relpath(path, folder)
    except ValueError:  # of Windows: no way leads from drive to drive, or to a network
        found = os.path.abspath(path)
    return found.replace(os.sep, "/")
