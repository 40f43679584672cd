"""Layers that an earlier stage still holds: pxr gives them to a later one, whatever their files are by then.

One that is read anew for the later stage changes below the earlier one, which can say nothing of its own file
from then on.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any
from weakref import WeakSet

from rigtri.errors import FileError
from rigtri.formats.usd.composition.layer_content import outer_file

State = tuple[int, ...]


class Held:
    """The layers of a stage, and which files they were read from."""

    def __init__(self, stage: Any) -> None:
        used = [layer for layer in stage.GetUsedLayers() if layer.realPath]
        self._states = {layer.identifier: _state(layer) for layer in used}
        self._replaced = ""
        _ALL.add(self)

    def check(self, layer: Any) -> None:
        """FileError where the file of a layer was replaced since, or any layer was read anew."""
        if replaced := self._replaced or ("" if self.is_as_read(layer) else _file(layer)):
            raise FileError(f"{replaced} was replaced after this rig was read from it. Read it again")

    def is_as_read(self, layer: Any) -> bool:
        """Whether the file of a layer is the one that was read, or is gone."""
        now = _state(layer)
        return not now or self._states.get(layer.identifier, now) == now

    def differs(self, layer: Any) -> bool:
        return not self._replaced and not self.is_as_read(layer)

    def replace(self, layer: Any) -> None:
        self._replaced = _file(layer)


_ALL: WeakSet[Held] = WeakSet()


def renew(layer: Any) -> None:
    """Read a layer anew whose file was replaced since it was read for a stage that still holds it."""
    others = [held for held in list(_ALL) if held.differs(layer)]
    for held in others:
        held.replace(layer)
    if others:
        layer.Reload(True)


def _file(layer: Any) -> str:
    return str(outer_file(layer.realPath))


def _state(layer: Any) -> State:
    """What a file has otherwise once it was replaced; of a layer in a package that of the package."""
    with suppress(OSError):
        found = outer_file(layer.realPath).stat()
        return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns
    return ()
