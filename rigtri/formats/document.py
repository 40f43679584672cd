"""What a file that was read is to everybody else: its rig, and a way to write it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal, Protocol

from rigtri.files.staged_output import Companion as Companion
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import FileOptions
from rigtri.model.mesh import Mesh
from rigtri.model.options import options_of
from rigtri.model.rig import Rig
from rigtri.model.scene_facts import SceneFacts
from rigtri.model.spelling import described
from rigtri.report import Notice

GLTF_SUFFIXES = (".glb", ".gltf", ".vrm", ".vrma")
# What three.js makes of points with more joints than it has room for.
FOUR = "vertices with more than four joints are shown with the four that weigh most, or come first"
USD_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
# The warnings of what a file refers to, and that is not there or cannot be read.
MISSING = ("unresolved", "unread-layer")


@dataclass(frozen=True)
class ReadOptions(FileOptions):
    """How to read and write a file.

    from_stream: the source was a stream and has no folder; its relative paths stay as they are (USD).
    to_stream: the output goes to a stream, and stands where the source stood (USD).
    empty: read also a file without a skeleton (USD).
    beside: an option names the file, and --root is another file's (USD).
    """

    from_stream: bool = False
    to_stream: bool = False
    empty: bool = False
    beside: bool = False

    def __post_init__(self) -> None:
        for name, one in options_of(FileOptions).items():
            object.__setattr__(self, name, one.cased(getattr(self, name)))

    @property
    def relinks(self) -> bool:
        """Whether a .gltf in another folder refers to its files where they are."""
        return self.resources == "relink"

    @property
    def is_override(self) -> bool:
        """Whether the output is a layer above the source, and not the source edited."""
        return self.edit_target in ("new", "bare")


ReadOptions.__doc__ = f"{ReadOptions.__doc__ or ''}\nOptions:\n{described(FileOptions)}"


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

    @property
    def hidden(self) -> Mapping[str, Sequence[str]]:
        """By layer (USD), the prims on which what `write` wrote hides its opinions."""

    def meshes(self) -> Sequence[Mesh]:
        """All that is drawn, for measuring; read when it is called."""

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        """The same for bounding what joints move: of a very large mesh some points and boxes will do.

        closely: boxes of what each joint moves, from all points, instead of those the file states.
        """

    def scene_facts(self, *, closely: bool = False) -> SceneFacts:
        """What the file shows besides poses, for comparing.

        closely: also what costs reading: what materials, images and avatars are made of.
        """

    def embedded(self) -> Embedded:
        """All that it takes to show the file elsewhere."""

    def needed(self) -> Iterator[tuple[Path, str]]:
        """The files that what `write` writes will go on referring to, each with what it is, in words."""

    def reopen(self, part: Path) -> Document:
        """Read what `write` wrote, as it will be seen: an override over its source."""

    def write(self, rig: Rig, part: Path, target: Path) -> Sequence[Companion]:
        """Write the file as ``rig`` has it to ``part``, which will be renamed to ``target``.

        ``part`` lies in the folder of ``target``. What differs from the rig that was
        read is changed, all else is copied. Returns the files that must lie beside it.
        """
