"""Where a URI of a glTF file leads: into the text itself, to a file nearby, or nowhere we go.

Source: glTF 2.0 §2.8 (URIs), §3.6.1 (buffers); RFC 2397 (data URIs).
"""

from __future__ import annotations

import base64
import binascii
import os
import re
from pathlib import Path
from urllib.parse import quote, unquote, unquote_to_bytes

from rigtri.errors import FileError

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")
_SURROGATE = re.compile("[\ud800-\udfff]")
_DRIVE = re.compile(r"[A-Za-z]:")
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
        raise FileError(f"{where}: the data URI is broken ({error}); export the file anew") from None


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
        raise FileError(f"{where}: '{_short(uri)}' is no file name")
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
        return f"'{name}' is no plain file but a folder, a device or a pipe; name a file instead"
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
    """A relative path, with forward slashes, as a URI."""
    return quote(name, safe="/!$&'()*+,;=@~-._")


def _short(uri: str) -> str:
    return uri if len(uri) <= 60 else f"{uri[:57]}..."
