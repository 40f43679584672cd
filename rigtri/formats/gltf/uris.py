"""Where a URI of a glTF file leads: into the text itself, to a file nearby, or nowhere we go.

Then the files that a glTF refers to, when it moves to another folder.

Source: glTF 2.0 §2.8 (URIs), §3.6.1 (buffers); RFC 2397 (data URIs); docs/decisions.md.
"""

from __future__ import annotations

import base64
import binascii
import os
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote, unquote_to_bytes

from rigtri.errors import FileError
from rigtri.files.text_files import check_utf8_path
from rigtri.formats.document import Companion
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.formats.vrm.bindings import Pointer
from rigtri.report import Notice

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")
_SURROGATE = re.compile("[\ud800-\udfff]")
# Elsewhere than on Windows a:b.bin is a file like any other.
_DRIVE = re.compile(r"[A-Za-z]:" if os.name == "nt" else r"[A-Za-z]:[/\\]")
# The name of a buffer file that rigtri has put beside a .gltf; the digits are a hash of its content.
_OWN = re.compile(r"\.rigtri-[0-9a-f]{8}\.bin$")


def is_data(uri: str) -> bool:
    """Whether the data stand in the URI itself."""
    return uri[:5].lower() == "data:"


def is_file(uri: str) -> bool:
    """Whether a URI names a file: neither data nor something on a network."""
    return not is_data(uri) and not _SCHEME.match(uri)


def is_own(uri: str) -> bool:
    """Whether a URI names a buffer file that rigtri wrote."""
    return is_file(uri) and _OWN.search(uri) is not None


def decode_data(uri: str, where: str) -> bytes:
    """The bytes of a data URI. FileError where they are not what they claim to be."""
    head, comma, body = uri.partition(",")
    if not comma:
        raise FileError(f"{where}: the data URI has no data; its comma is missing")
    if not head.lower().endswith(";base64"):
        return unquote_to_bytes(body)
    try:
        return base64.b64decode(unquote(body) if "%" in body else body, validate=True)
    except (binascii.Error, ValueError) as error:
        raise FileError(f"{where}: the data URI is broken ({error}); export the file again") from None


def encode_data(content: bytes | bytearray, head: str = "data:application/octet-stream;base64") -> str:
    """A data URI with ``content``; ``head`` is all before the comma."""
    if not head.lower().endswith(";base64"):
        head += ";base64"
    return f"{head},{base64.b64encode(content).decode('ascii')}"


def file_of(uri: str, folder: Path, where: str, *, allow_external: bool = False) -> Path:
    """The file that a relative URI names. FileError for one outside ``folder`` or on a network.

    A file that an asset brings along must not be able to name any file of the
    machine; ``allow_external`` is the user saying that these may.
    """
    if not is_file(uri):
        raise FileError(f"{where}: rigtri fetches nothing from '{_short(uri)}'; put the file beside this one")
    name = unquote(uri)
    if "\0" in name or _SURROGATE.search(name):
        raise FileError(f"{where}: '{_short(uri)}' is not a file name")
    if not allow_external and lies_outside(uri, folder, where):
        raise FileError(
            f"{where}: '{_short(uri)}' lies outside the folder of the file. "
            "If you trust it, allow this with --allow-external-paths"
        )
    return _place(name, folder)


def _place(name: str, folder: Path) -> Path:
    """The file of a relative name, without steps down and up again: no folder need be there for them."""
    return folder / os.path.normpath(name) if name else folder


def lies_outside(uri: str, folder: Path, where: str) -> bool:
    """Whether the name of a file leads out of ``folder``. FileError for one that leads nowhere."""
    name = unquote(uri)
    try:
        return _leaves(name, _place(name, folder), folder)
    except (OSError, RuntimeError) as error:  # links in a circle, names that no disk can hold
        raise FileError(f"{where}: '{_short(uri)}' leads nowhere: {error}") from None


def why_absent(uri: str, path: Path, source: Path) -> str:
    """Why there is no plain file where a URI leads, and what to do; ``source`` names it."""
    name = _short(unquote(uri))
    try:
        other = path.exists()
    except OSError:
        other = False
    if other:
        return f"'{name}' is not a regular file but a folder, a device or a pipe; name a file instead"
    if "/" in name:
        return f"the file '{name}', as seen from the folder of {source.name}, is missing; put it there"
    return f"the file '{name}' is missing; put it beside {source.name}"


def is_there(path: Path) -> bool:
    """Whether a plain file lies there; a name that no disk can hold is of none."""
    try:
        return path.is_file()
    except OSError:
        return False


def _leaves(name: str, path: Path, folder: Path) -> bool:
    parts = re.split(r"[/\\]", os.path.normpath(name))
    if ".." in parts or name.startswith(("/", "\\")) or _DRIVE.match(name):
        return True
    # A link inside the folder may still lead out of it.
    return not path.resolve().is_relative_to(folder.resolve())


def escape(name: str) -> str:
    """A relative path, with forward slashes, as a URI; FileError for one that is not UTF-8."""
    check_utf8_path(name)
    return quote(name, safe="/!$&'()*+,;=@~-._")


def _short(uri: str) -> str:
    return uri if len(uri) <= 60 else f"{uri[:57]}..."


# --- the files that a glTF refers to


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
