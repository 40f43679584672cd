"""Layers that an earlier stage still holds: pxr gives them to a later one, whatever their files are by then.

The root layer of a stage whose file was replaced gets another identifier: a later stage reads the file,
and the earlier one keeps what it has. Any other layer is read anew for the later stage and changes below
the earlier one, which can say nothing of its own file from then on.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path
from typing import Any
from weakref import WeakSet

from pxr import Ar, Sdf

from rigtri.errors import FileError
from rigtri.files.mapped_file import MAP_FROM, load
from rigtri.formats.usd.composition.layer_content import outer_file

State = tuple[int, ...]


class Held:
    """The layers of a stage, and which files they were read from.

    content: the bytes of the root layer's file, whatever becomes of it; none of a layer without a file.
    """

    def __init__(self, stage: Any) -> None:
        used = [layer for layer in stage.GetUsedLayers() if layer.realPath]
        root, file = stage.GetRootLayer(), outer_file(stage.GetRootLayer().realPath)
        self._states = {layer.identifier: _state(layer) for layer in used}
        self.content = load(file) if root.realPath and file.is_file() else memoryview(b"")
        self._root = "" if any(_lies_in(layer, root) for layer in used) else root.identifier
        self._replaced = self._set_aside = ""
        _ALL.add(self)

    def check(self, edited: Iterable[Any], *, stays: bool) -> None:
        """FileError where the file of an edited layer was replaced since, and what was read of it is not
        kept, or where another layer was read anew.

        stays: the output goes on reading the root layer's file, so no other may have taken its place.
        """
        for layer in edited:
            renew(layer)
        if replaced := self._replaced or (self._set_aside if stays else ""):
            raise FileError(
                f"{replaced} was written or replaced after this rig was read from it. Read it again"
            )

    def differs(self, layer: Any) -> bool:
        """Whether the file of a layer is another than the one that was read; one that is gone is none."""
        now = _state(layer)
        if not now or self._replaced or self._states.get(layer.identifier, now) == now:
            return False
        if layer.identifier != self._root or not self._is_touched(layer, now):
            return True
        self._states[layer.identifier] = now
        return False

    def _is_touched(self, layer: Any, now: State) -> bool:
        """Whether the root layer's file has another time and, as far as they are known, the same bytes."""
        same = self._states[layer.identifier][:3] == now[:3] and len(self.content) < MAP_FROM
        return same and bytes(load(outer_file(layer.realPath))) == self.content

    def keeps(self, layer: Any) -> bool:
        """Whether all that was read of a layer is still there, though its file is another one."""
        if layer.identifier != self._root or layer.realPath != self._root:
            return False
        # What pxr or this process has mapped goes with what is written over it, but not with its name.
        in_memory = bytes(self.content[: len(_TEXT)]) == _TEXT and len(self.content) < MAP_FROM
        return in_memory or self._states[self._root][:2] != _state(layer)[:2]

    def replace(self, layer: Any) -> None:
        self._replaced = _file(layer)

    def set_aside(self, file: str) -> None:
        """Note that the root layer has another identifier: the one it had is of no layer of the stage."""
        del self._states[self._root]
        self._set_aside, self._root = file, ""


def files_of(stage: Any) -> list[tuple[Any, State]]:
    """The layers of a stage, and what their files are like now."""
    return [(layer, _state(layer)) for layer in stage.GetUsedLayers() if layer.realPath]


@contextmanager
def reading(files: Sequence[tuple[Any, State]]) -> Iterator[None]:
    """Read what `files_of` gave; where that fails, FileError that says so if a file was written since."""
    try:
        yield
    except FileError:
        written = next((_file(layer) for layer, state in files if _state(layer) not in (state, ())), "")
        if written:
            raise FileError(f"{written} was written while it was read. Read it again") from None
        raise


_ALL: WeakSet[Held] = WeakSet()
_TEXT = b"#usda"


def renew(layer: Any) -> Any:
    """A layer as its file is now, also where a stage still holds what the file was before."""
    others = [held for held in list(_ALL) if held.differs(layer)]
    keeping = [held for held in others if held.keeps(layer)]
    for held in others:
        if held not in keeping:
            held.replace(layer)
    if keeping:
        file, identifier = _file(layer), layer.identifier
        layer.identifier = _free_identifier(Path(identifier))
        for held in keeping:
            held.set_aside(file)
        return Sdf.Layer.FindOrOpen(identifier)
    if others:
        layer.Reload(True)
    return layer


def _free_identifier(path: Path) -> str:
    """Beside the file, for the relative paths of the layer, but of no file."""
    names = (path.with_name(f"{path.stem}, as read before ({number}){path.suffix}") for number in count(1))
    return next(str(name) for name in names if not (name.exists() or Sdf.Layer.Find(str(name))))


def _lies_in(layer: Any, package: Any) -> bool:
    """Whether a layer lies in a package, and is not found once that has another name."""
    outer = str(Ar.SplitPackageRelativePathOuter(layer.realPath)[0])
    return bool(layer != package and outer == package.realPath)


def _file(layer: Any) -> str:
    return str(outer_file(layer.realPath))


def _state(layer: Any) -> State:
    """What a file has otherwise once it was replaced; of a layer in a package that of the package."""
    with suppress(OSError):
        found = outer_file(layer.realPath).stat()
        return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns
    return ()
