"""The files of added keys beside a .gltf, ``<stem>.rigtri-<hash>.bin``: which it has, which nobody needs."""

from __future__ import annotations

import json
import os
import re
from contextlib import suppress
from functools import lru_cache
from pathlib import Path, PurePath
from urllib.parse import unquote

# In JSON, with its quotes; it may be as long as the data that stand in it.
_URI = re.compile(rb'"uri"\s*:\s*("(?:[^"\\]++|\\.)*+")')
_OURS = re.compile(r"\.rigtri-[0-9a-f]{8}\.bin$")
# All that may refer to such a file, which a .gltf alone gets.
_GLTF = (".gltf", ".glb", ".vrm", ".vrma")


def added_buffers(path: Path, final: Path, *, every: bool) -> set[Path]:
    """Those of the .gltf ``final``, as ``path`` has it.

    every: those with the stem of another file, too. Where many write to one folder at a time, somebody may
    be about to refer to those.
    """
    if final.suffix.lower() != ".gltf" or not path.is_file():
        return set()
    names = {name for name in _buffer_names(str(path)) if not {*name} & {"/", "\\"}}
    return {final.parent / name for name in names if every or name.startswith(f"{final.stem}.rigtri-")}


def _buffer_names(path: str) -> tuple[str, ...]:
    """Those that a glTF refers to, as paths from its folder."""
    known = os.stat(path)
    return _names_in(path, known.st_ino, known.st_mtime_ns, known.st_size)


@lru_cache(maxsize=1 << 16)
def _names_in(path: str, *version: int) -> tuple[str, ...]:
    """Kept for a batch, which asks it of a whole folder after each file that it replaces there."""
    with open(path, "rb") as file:
        head = file.read(20)
        binary = head.startswith(b"glTF")
        text = file.read(int.from_bytes(head[12:16], "little")) if binary else head + file.read()
    found = []
    for uri in _URI.finditer(text):
        if uri[1].endswith(b'.bin"'):
            with suppress(ValueError):  # no JSON
                found.append(unquote(json.loads(uri[1])))
    return tuple(name for name in found if _OURS.search(name))


def remove_unnamed(buffers: set[Path], but: Path | None = None) -> None:
    """Remove those that no glTF beside them refers to, except ``but``; none where one cannot be read."""
    with suppress(OSError):
        for folder in {buffer.parent for buffer in buffers}:
            # No Path for each: a batch comes here once for each file of the folder.
            with os.scandir(folder) as found:
                files = [one.path for one in found if one.name.lower().endswith(_GLTF)]
            named = set[str]()
            for file in files:
                if but is None or file != str(but):
                    with suppress(FileNotFoundError):  # a part that has got its name meanwhile
                        named.update(_buffer_names(file))
            used = {PurePath(name).name for name in named}
            for buffer in buffers:
                if buffer.name not in used:
                    buffer.unlink(missing_ok=True)
