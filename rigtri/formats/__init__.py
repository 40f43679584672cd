"""File formats. Each stands beside the operations; both know only the `Rig`.

The law of every format: an unchanged rig gives back the same bytes; in a
changed file every value, prim, property, image and buffer byte that the change
does not name is still there and equal, in the same order.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Literal, Protocol

from rigtri.errors import FileError, UsageError
from rigtri.files.text_files import check_no_pointer
from rigtri.model.records import Mesh
from rigtri.model.rig import Rig
from rigtri.report import Notice
from rigtri.verification.compare.scene_facts import Scenery
from rigtri.verification.diff.change import Change

GLTF_SUFFIXES = (".glb", ".gltf", ".vrm", ".vrma")
# What three.js makes of points with more joints than it has room for.
FOUR = "points with more than four joints are shown with the four that weigh most, or come first"
USD_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")


@dataclass(frozen=True)
class Options:
    """How to read and write. Each field says which format it is for; the other ignores it.

    lenient: repair what the format forbids where the meaning is clear (glTF).
    allow_external_paths: read what a file refers to outside its own folder (both).
    unknown_node_ext: what becomes of a node with an extension that may name its axes (glTF):
        ``freeze`` it, ``ignore`` the extension, or ``error``.
    root: the node whose hierarchy is the rig where there is no skin (both).
    relink: point a moved .gltf at its old resources instead of copying them (glTF).
    override: write bare opinions over the source (USD): "", "layer" or "stage".
    allow_rename: let joints of skeletons get other paths, which a split gives them (USD).
    bake_xform: rewrite plain Xform joints to translate, orient, scale (USD).
    from_stream: the source was a stream and has no folder; its relative paths stay as they are (USD).
    to_stream: the output goes to a stream, and stands where the source stood (USD).
    empty: read also a file without a skeleton (USD).
    """

    lenient: bool = False
    allow_external_paths: bool = False
    unknown_node_ext: str = "freeze"
    root: str | None = None
    relink: bool = False
    override: str = ""
    allow_rename: bool = False
    bake_xform: bool = False
    from_stream: bool = False
    to_stream: bool = False
    empty: bool = False


@dataclass(frozen=True)
class Companion:
    """A file that must lie beside the output: new bytes, or a copy of a file of the source.

    name: where, relative to the output's folder, with forward slashes.
    """

    name: str
    content: bytes | Path


@dataclass(frozen=True)
class Embedded:
    """What a page must carry to show a file: its content, and what else it draws of.

    kind: ``gltf`` for a .glb or .gltf, ``usd`` for one USD crate with all layers in it. files: by the
    name that the content has for each; a Path where a file is to be read. lacking: what a viewer will
    not find or draw, in words. decoders: what data of the file are compressed with, ``draco`` or ``meshopt``.
    """

    kind: Literal["gltf", "usd"]
    content: bytes | Path
    files: Mapping[str, bytes | Path]
    lacking: tuple[str, ...] = ()
    decoders: tuple[str, ...] = ()


class Document(Protocol):
    """A file that was read, together with everything in it that rigtri does not know."""

    @property
    def rig(self) -> Rig: ...

    @property
    def warnings(self) -> Sequence[Notice]:
        """What the reader noticed and could live with."""

    def meshes(self) -> Sequence[Mesh]:
        """All that is drawn, for measuring; read when asked for."""

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        """The same for bounding what joints move: of a very large mesh some points and boxes will do.

        closely: boxes of what each joint moves, from all points, instead of those the file states.
        """

    def scenery(self, *, closely: bool = False) -> Scenery:
        """What the file shows that no pose tells, for comparing.

        closely: also what costs reading: what materials, images and avatars are made of.
        """

    def embedded(self) -> Embedded:
        """All that is to be carried along to show the file elsewhere."""

    def needed(self) -> Iterator[tuple[Path, str]]:
        """The files that what `write` writes will go on referring to, each with what it is, in words."""

    def reopen(self, part: Path) -> Document:
        """Read what `write` wrote, as it will be seen: an override over its source."""

    def write(self, rig: Rig, part: Path, target: Path) -> Sequence[Companion]:
        """Write the file as ``rig`` wants it to ``part``, which will be renamed to ``target``.

        ``part`` lies in the folder of ``target``. What differs from the rig that was
        read is changed, all else is copied. Returns the files that must lie beside it.
        """


def read(path: Path | str, options: Options | None = None) -> Document:
    """Read a rig file; its suffix says the format. Raises FileError for anything unreadable."""
    path, options = Path(path), options or Options()
    suffix = path.suffix.lower()
    check_no_pointer(path)
    if suffix in GLTF_SUFFIXES:
        from rigtri.formats.gltf.document import GltfDocument

        document = GltfDocument.read(path, options)
        if options.root is not None:
            document.rig.find(options.root, "node")  # NameNotFoundError, whether a command needs it or not
        return document
    if suffix in USD_SUFFIXES:
        need_usd()
        from rigtri.formats.usd.document import UsdDocument

        return UsdDocument.read(path, options)
    known = " ".join((*GLTF_SUFFIXES, *USD_SUFFIXES))
    raise FileError(f"{path}: '{suffix}' is no format rigtri reads. It reads: {known}")


def _has(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except ModuleNotFoundError:
        return False


def need_usd() -> None:
    """UsageError where OpenUSD is not installed, as in programs that bring a Python of their own."""
    if not _has("pxr"):
        raise UsageError("USD files need OpenUSD; install it with: pip install usd-core")


def references(path: Path) -> list[str]:
    """The files below its own folder that a glTF refers to, there or not, as paths with forward slashes.

    None of USD, whose packages hold all that they need. FileError for a file that cannot be read.
    """
    if path.suffix.lower() not in GLTF_SUFFIXES:
        return []
    from rigtri.formats.gltf.container import open_container
    from rigtri.formats.gltf.resources import names

    return names(open_container(path).gltf, path)


def write_blank(path: Path, *, up: str = "Y", unit: float = 0.01) -> None:
    """Write a file without anything in it, to build a rig in; its suffix says the format.

    up: Y or Z, unit: how many metres 1 is (both USD; glTF has y up and metres).
    UsageError for a suffix of no format that can be empty.
    """
    suffix = path.suffix.lower()
    if suffix in (".glb", ".gltf"):
        from rigtri.formats.gltf.blank import write_blank as write_gltf

        write_gltf(path)
    elif suffix in USD_SUFFIXES:
        need_usd()
        from rigtri.formats.usd.blank import write_blank as write_usd

        write_usd(path, up, unit)
    else:
        known = " ".join((".glb", ".gltf", *USD_SUFFIXES))
        raise UsageError(f"{path.name}: a new file is one of {known}")


def output_suffixes(path: Path, options: Options) -> tuple[str, ...]:
    """What the name of an output of ``path`` may end with, by the first bytes alone; () for no rig file."""
    own = path.suffix.lower()
    try:
        with path.open("rb") as file:
            start = file.read(12)
    except OSError:
        return ()  # told when it is read
    if own in GLTF_SUFFIXES:
        if start.startswith(b"glTF") and len(start) == 12:
            return (".glb", ".vrm", ".vrma")
        # What is neither is told when it is read.
        return (".gltf",) if start.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{") else ()
    if own not in USD_SUFFIXES:
        return ()
    if options.override:
        return (".usda", ".usd", ".usdc")
    if own == ".usdz":
        return (own,)
    fits = (".usdc", ".usd") if start.startswith(b"PXR-USDC") else (".usda", ".usd")
    return fits if own in fits else (own, *fits)


def file_changes(before: Path, after: Path, options: Options, tolerance: float = 0.0) -> list[Change] | None:
    """How two files of one format differ as files; None where their formats are two.

    FileError where one of them cannot be taken apart.
    """
    suffixes = {before.suffix.lower(), after.suffix.lower()}
    if suffixes <= set(GLTF_SUFFIXES):
        from rigtri.verification.diff import gltf_file_diff as gltf

        return gltf.file_changes(before, after, options, tolerance)
    if suffixes <= set(USD_SUFFIXES):
        from rigtri.verification.diff import usd_file_diff as usd

        return usd.file_changes(before, after, options, tolerance)
    return None
