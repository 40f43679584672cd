"""A changed copy of a glTF JSON in which only what is touched is copied."""

from __future__ import annotations

from typing import Any

from rigtri.errors import FileError


class CopyOnWrite:
    """The JSON to be written. What `edit` has not named is the very object that was read."""

    def __init__(self, gltf: dict[str, Any]) -> None:
        self.gltf = dict(gltf)
        self._copies: dict[int, Any] = {}

    @property
    def changed(self) -> bool:
        """Whether anything was touched."""
        return bool(self._copies)

    def edit(self, *path: str | int) -> Any:
        """The object or list at ``path``, free to be changed; it must be there."""
        holder: Any = self.gltf
        for key in path:
            holder = self._copied(holder, key)
        return holder

    def need(self, *path: str | int, empty: Any) -> Any:
        """Like `edit`, but where the last step leads nowhere ``empty`` is put there.

        FileError where something of another type stands there.
        """
        holder = self.edit(*path[:-1])
        if holder.get(path[-1]) is None:
            holder[path[-1]] = empty
        elif not isinstance(found := holder[path[-1]], type(empty)):
            where = ".".join(map(str, path))
            raise FileError(f"{where} needs an entry, but is {found!r:.40}: make it a list")
        return self._copied(holder, path[-1])

    def _copied(self, holder: Any, key: str | int) -> Any:
        child = holder[key]
        if id(child) not in self._copies:
            child = holder[key] = child.copy()
            # Kept here, so that no later object can get the same id.
            self._copies[id(child)] = child
        return child
