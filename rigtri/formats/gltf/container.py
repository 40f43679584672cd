"""GLB and .gltf files as bytes: a JSON text, binary chunks, and nothing understood yet.

Source: glTF 2.0 §4 (GLB file format).
"""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Iterable, Mapping
from dataclasses import field
from pathlib import Path
from typing import Any

from rigtri.errors import FileError
from rigtri.files.mapped_file import load
from rigtri.formats.gltf.json_splice import splice
from rigtri.formats.gltf.json_style import Spelling, encode, parse_placed
from rigtri.model.dataclass import dataclass
from rigtri.report import Notice

MAGIC = b"glTF"
# So many bytes of what is no glTF are shown.
_SHOWN = 16
HEADER = struct.Struct("<4sII")
CHUNK = struct.Struct("<II")
JSON_CHUNK = 0x4E4F534A
BIN_CHUNK = 0x004E4942

Piece = bytes | bytearray | memoryview


@dataclass(frozen=True, eq=False)
class Container:
    """What a file holds: its JSON, and for a GLB its chunks in order, JSON and BIN included.

    chunks: (type, content) where content is a view into ``source``. ends: where members of the JSON's text
    end, by where they start, as far as known.
    """

    path: Path
    source: memoryview
    gltf: dict[str, Any]
    spelling: Spelling
    chunks: tuple[tuple[int, memoryview], ...] = ()
    notices: list[Notice] = field(default_factory=list)
    ends: Mapping[int, int] = field(default_factory=dict)

    @property
    def is_glb(self) -> bool:
        return bool(self.chunks)

    @property
    def binary(self) -> memoryview | None:
        """The content of the BIN chunk, which is the second one or is not there."""
        if len(self.chunks) > 1 and self.chunks[1][0] == BIN_CHUNK:
            return self.chunks[1][1]
        return None

    def pieces(self, gltf: dict[str, Any], binary: list[Piece] | None) -> list[Piece]:
        """The file with other JSON and, where given, another BIN chunk; all else as it was.

        Raises FileError for what the format cannot hold.
        """
        text = self._text(gltf)
        if not self.is_glb:
            return [text]
        body: list[Piece] = []
        for kind, content in self._chunks(text, binary):
            length = sum(map(len, content))
            padding = -length % 4 if kind in (JSON_CHUNK, BIN_CHUNK) else 0
            fill = b" " if kind == JSON_CHUNK else b"\0"
            body += [_packed(CHUNK, self.path, length + padding, kind), *content, fill * padding]
        total = HEADER.size + sum(map(len, body))
        return [_packed(HEADER, self.path, MAGIC, 2, total), *body]

    def _chunks(self, text: bytes, binary: list[Piece] | None) -> Iterable[tuple[int, list[Piece]]]:
        yield JSON_CHUNK, [text]
        if binary is not None:
            yield BIN_CHUNK, binary
        rest = self.chunks[2:] if binary is not None and self.binary is not None else self.chunks[1:]
        for kind, content in rest:
            yield kind, [content]

    @property
    def text(self) -> str:
        """The JSON as it was read."""
        content = self.chunks[0][1] if self.is_glb else self.source
        return str(content, "utf-8").removeprefix("\ufeff")

    def members(self) -> dict[str, tuple[str, Any]]:
        """The objects and lists of the JSON by their keys, each with its text, as far as known."""
        text, found = self.text, zip(self.gltf.items(), self.ends.items(), strict=False)
        return {
            key: (text[start:end], value)
            for (key, value), (start, end) in found
            if isinstance(value, dict | list)
        }

    def _text(self, gltf: dict[str, Any]) -> bytes:
        text = self.text
        # Spaces behind the JSON of a GLB are padding, and made anew.
        text = text.rstrip() if self.is_glb else text
        try:
            return encode(splice(text, self.gltf, gltf, self.spelling, self.ends))
        except RecursionError:
            raise FileError(f"{self.path}: the JSON is nested too deep to be written") from None
        except ValueError:
            raise FileError(
                f"{self.path}: a number in the JSON is too large to be read back; repair it first"
            ) from None


def _packed(layout: struct.Struct, path: Path, *values: Any) -> bytes:
    try:
        return layout.pack(*values)
    except struct.error:
        raise FileError(
            f"{path}: the result would be larger than the 4 GiB a GLB can hold; convert it to .gltf first"
        ) from None


def glb(text: bytes, binary: bytes | None) -> bytes:
    """A GLB of a JSON text and, where there is one, a BIN chunk."""
    chunks = [(JSON_CHUNK, text + b" " * (-len(text) % 4))]
    chunks += [] if binary is None else [(BIN_CHUNK, binary + bytes(-len(binary) % 4))]
    body = b"".join(CHUNK.pack(len(content), kind) + content for kind, content in chunks)
    return HEADER.pack(MAGIC, 2, HEADER.size + len(body)) + body


def write_blank(path: Path) -> None:
    """Write a .glb or .gltf with one empty scene, to build a rig in."""
    gltf = {"asset": {"version": "2.0", "generator": "rigtri"}, "scene": 0, "scenes": [{"name": "Scene"}]}
    if path.suffix.lower() == ".gltf":
        path.write_bytes(json.dumps(gltf, indent=2).encode() + b"\n")
    else:
        path.write_bytes(glb(json.dumps(gltf).encode(), None))


def open_container(
    path: Path, *, lenient: bool = False, content: bytes | None = None, like: Container | None = None
) -> Container:
    """Take a file apart. FileError, with the offset, where it is no glTF 2.0 or broken.

    lenient: ignore bytes behind the length that a GLB claims, and keys that stand twice.
    content: what the file would hold, where there is none at ``path``. like: what it was made of; both share
    the members of their JSON that are spelled alike.
    """
    known = {} if like is None else like.members()
    source = load(path) if content is None else memoryview(content)
    notices: list[Notice] = []
    if not len(source):
        raise FileError(f"{path}: the file is empty; copy or export it again")
    if bytes(source[:4]) != MAGIC:
        _check_beginning(path, bytes(source[:_SHOWN]))
        text, gltf, ends = _json(path, source, notices, known, lenient=lenient)
        return Container(path, source, gltf, Spelling.of(text), (), notices, ends)
    chunks = _split(path, source, notices, lenient=lenient)
    text, gltf, ends = _json(path, chunks[0][1], notices, known, lenient=lenient)
    # Spaces behind the JSON of a GLB are padding, not a habit.
    return Container(path, source, gltf, Spelling.of(text.rstrip()), tuple(chunks), notices, ends)


def _check_beginning(path: Path, start: bytes) -> None:
    """FileError for what is neither a GLB nor JSON, such as a picture or words."""
    first = start.removeprefix(b"\xef\xbb\xbf").lstrip()[:1]
    if first not in (b"", b"{", b"["):
        words = start.decode("ascii", "replace").lstrip().splitlines()[0]
        shown = f"'{words}'" if words.isprintable() and start.isascii() else f"the bytes {start[:4].hex(' ')}"
        raise FileError(
            f"{path}: this is not a glTF file: it begins with {shown}, where a "
            "GLB begins with 'glTF' and a .gltf with '{'. Give another file, or export it again"
        )


def _split(
    path: Path, source: memoryview, notices: list[Notice], *, lenient: bool
) -> list[tuple[int, memoryview]]:
    if len(source) < HEADER.size:
        raise FileError(f"{path}: the GLB ends after {len(source)} bytes, inside its header")
    _, version, length = HEADER.unpack_from(source)
    if version != 2:
        raise FileError(f"{path}: this is GLB version {version}, not 2; export it again as glTF 2.0")
    if length > len(source):
        raise FileError(
            f"{path}: the GLB is cut off: it should have {length} bytes and ends at offset {len(source)}. "
            "Copy or export it again"
        )
    if length < len(source):
        text = f"the GLB should end at offset {length}, but {len(source) - length} more bytes follow"
        if not lenient:
            raise FileError(f"{path}: {text}. Use --lenient to ignore them")
        notices.append(Notice("glb-length", f"{text}; they are ignored"))
    chunks = list(_walk(path, source[:length]))
    if not chunks or chunks[0][0] != JSON_CHUNK:
        raise FileError(f"{path}: the first chunk of the GLB, at offset {HEADER.size}, is not JSON")
    return chunks


def _walk(path: Path, source: memoryview) -> Iterable[tuple[int, memoryview]]:
    offset = HEADER.size
    while offset < len(source):
        if offset + CHUNK.size > len(source):
            raise FileError(f"{path}: the GLB has stray bytes at offset {offset}")
        size, kind = CHUNK.unpack_from(source, offset)
        offset += CHUNK.size
        if offset + size > len(source):
            raise FileError(
                f"{path}: a chunk of {size} bytes at offset {offset} reaches behind "
                f"the end of the GLB at {len(source)}"
            )
        yield kind, source[offset : offset + size]
        offset += size


def _json(
    path: Path,
    content: memoryview,
    notices: list[Notice],
    known: Mapping[str, tuple[str, Any]],
    *,
    lenient: bool,
) -> tuple[str, dict[str, Any], dict[int, int]]:
    try:
        text = str(content, "utf-8")
        if text.startswith("\ufeff"):
            text = text[1:]
            words = "The JSON starts with a byte order mark, which glTF forbids; a changed file has none"
            notices.append(Notice("byte-order-mark", words))
        gltf, ends = parse_placed(text, lenient=lenient, known=known)
    except RecursionError:
        raise FileError(f"{path}: the JSON is nested too deep") from None
    except UnicodeDecodeError as error:
        raise FileError(f"{path}: the JSON is not UTF-8 at offset {error.start}") from None
    except ValueError as error:
        reason = "a number has thousands of digits" if "set_int_max_str_digits" in str(error) else error
        raise FileError(f"{path}: this is not valid JSON: {reason}") from None
    if not isinstance(gltf, dict):
        raise FileError(f"{path}: the JSON is not an object, so this is not a glTF file")
    _check_version(path, gltf)
    return text, gltf, ends


def _check_version(path: Path, gltf: dict[str, Any]) -> None:
    asset = gltf.get("asset")
    if not isinstance(asset, dict) or not isinstance(asset.get("version"), str):
        raise FileError(f"{path}: 'asset.version' is missing, so this is not a glTF 2.0 file")
    for key in ("version", "minVersion"):
        version = asset.get(key, "2.0")
        if not isinstance(version, str) or not re.fullmatch(r"2\.[0-9]+", version):
            raise FileError(f"{path}: asset.{key} is {version!r}, not 2.x; export the file again as glTF 2.0")
