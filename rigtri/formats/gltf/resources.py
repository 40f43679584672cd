"""The files that a glTF refers to, when it moves to another folder.

Source: glTF 2.0 §2.8; docs/decisions.md.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from rigtri.errors import FileError
from rigtri.formats.document import Companion
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.gltf.uris import escape, file_of, is_data, is_file, is_there, lies_outside, why_absent
from rigtri.formats.vrm.bindings import Pointer
from rigtri.report import Notice


def uris(gltf: dict[str, Any]) -> Iterator[tuple[Pointer, str]]:
    """Every URI of a file, buffers, images and extensions, with its place in the JSON."""
    for key in ("buffers", "images", "extensions"):
        yield from _below(gltf.get(key), (key,))


def _below(value: Any, path: Pointer) -> Iterator[tuple[Pointer, str]]:
    if isinstance(value, dict):
        for key, child in value.items():
            if key == "uri" and isinstance(child, str):
                yield (*path, key), child
            elif key != "extras":
                yield from _below(child, (*path, key))
    elif isinstance(value, list):
        for number, child in enumerate(value):
            if isinstance(child, dict | list):
                yield from _below(child, (*path, number))


def files(gltf: dict[str, Any], source: Path) -> Iterator[tuple[Path, str]]:
    """The files that a glTF refers to, there or not, each with what it is."""
    for path, uri in uris(gltf):
        if uri and is_file(uri):
            with suppress(FileError):  # a name of no file, which reading reports where it matters
                where = _spelled(path)
                yield file_of(uri, source.parent, where, allow_external=True), f"{where} of {source}"


def names(gltf: dict[str, Any], source: Path) -> list[str]:
    """The files that a glTF refers to below its own folder, there or not, as paths from there."""
    found: dict[str, None] = {}
    for path, uri in uris(gltf):
        if uri and is_file(uri):
            with suppress(FileError):  # one outside, which reading reports where it matters
                file = file_of(uri, source.parent, _spelled(path))
                found[file.relative_to(source.parent).as_posix()] = None
    return list(found)


def accompany(gltf: dict[str, Any], source: Path, target: Path) -> list[Companion]:
    """Copies of the files that lie below the source's folder, for the target's folder.

    What is missing already stays missing. FileError for one that lies elsewhere:
    its copy would, too.
    """
    found: dict[str, Companion] = {}
    for path, uri in uris(gltf):
        if not is_file(uri) or not uri:
            continue
        where = f"{source}: {_spelled(path)}"
        file = file_of(uri, source.parent, where, allow_external=True)
        if not is_there(file) or Path(unquote(uri)).is_absolute():
            continue
        if lies_outside(uri, source.parent, where):
            raise FileError(
                f"{where}: '{uri}' lies outside the folder of the file, so its copy would lie outside the "
                "folder of the output. Refer to it where it is with --resources relink"
            )
        name = Path(os.path.normpath(unquote(uri))).as_posix()
        if (target.parent / name).resolve() != file.resolve():
            found.setdefault(name, Companion(name, file))
    return list(found.values())


def missing(gltf: dict[str, Any], source: Path) -> list[Notice]:
    """What a glTF refers to and does not have, except buffers: those are read, or need not be there."""
    return [
        Notice("file-missing", f"{_spelled(path)}: {why}; the output lacks it too")
        for path, why in absent(gltf, source)
    ]


def absent(gltf: dict[str, Any], source: Path) -> Iterator[tuple[Pointer, str]]:
    """The URIs, but of buffers, that lead to no plain file, by their place in the JSON: each with why."""
    for path, uri in uris(gltf):
        if path[0] == "buffers" or not uri or is_data(uri):
            continue
        try:
            file = file_of(uri, source.parent, _spelled(path), allow_external=True)
        except FileError as error:  # on a network, or a name of no file
            yield path, str(error).removeprefix(f"{_spelled(path)}: ")
        else:
            if not is_there(file):
                yield path, why_absent(uri, file, source)


def relink(draft: CopyOnWrite, source: Path, target: Path) -> None:
    """Point every relative URI at its old file, as seen from the target's folder."""
    for path, uri in list(uris(draft.gltf)):
        if not is_file(uri) or not uri or Path(unquote(uri)).is_absolute():
            continue
        file = source.parent.resolve() / unquote(uri)
        try:
            relative = os.path.relpath(file, target.parent.resolve())
        except ValueError:
            raise FileError(f"{source}: {_spelled(path)}: '{uri}' would be on another drive") from None
        draft.edit(*path[:-1])["uri"] = escape(Path(relative).as_posix())


def _spelled(path: Pointer) -> str:
    return ".".join(map(str, path))
